"""Pseudo-transient continuation: one full Newton step of the flow per pseudo-time step.

Each step solves the induction equation for the present temperature and takes one Newton step of the implicit
Euler equations with a local step ``dt = CFL h / (|u| + 200 m/s)``, either of flow and induction together
(`coupled`), or of the flow with frozen Joule heating and Lorentz force (Picard). The Courant number grows
while the changes stay small and falls when they do not; at a large one the step is Newton's for the steady
equations.

Residuals are relative: divided by that of gas at rest under the feed, and the heating and force of the first
step (`Problem.rest_residual`).
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from plasmapyro.flow.physics import AXIAL, LOG_TEMPERATURE, RADIAL, REFERENCE_VELOCITY
from plasmapyro.flow.properties import OutsideTable

log = logging.getLogger(__name__)

# Trust region of one step: rms and largest change of ln T and of u/100 m/s.
RMS_LOG_TEMPERATURE, RMS_VELOCITY = 0.25, 2.0
LARGEST_LOG_TEMPERATURE, LARGEST_VELOCITY = 0.5, 4.0
REJECTED_LOG_TEMPERATURE, REJECTED_VELOCITY = 0.5, 4.0
HALVINGS = 6
HOT_SPOT = 0.95  # of the highest temperature of the property table, at a node
TABLE_MARGIN = 1.002  # iterates stay this factor inside the property table
# From here on a step is Newton's for a frozen coupling, and Anderson's method takes over from
# under-relaxation.
ACCELERATED_COURANT = 500.0
ACCELERATION_DEPTH = 5
STALL_STEPS, STALL_SHARE = 8, 0.3
CYCLE_SHARE, CYCLE_COURANT, LEAST_SHARE = 0.7, 1000.0, 0.25
SLOW_COURANT = 30.0  # the largest with which a march begins again
EXTINGUISHED = 3000.0  # [K]: no air plasma below; its conductivity is under 0.1 S/m
# A plasma that shrinks conducts less, and at prescribed Joule power the coil current then runs away.
RUNAWAY = 2.2  # coil current over that of the first step


class NotConverged(RuntimeError):
    """The flow did not reach a steady state; the message says where and how far it came."""


class Extinguished(NotConverged):
    """The plasma went out on the way to a steady state."""


class Unbalanced(NotConverged):
    """A steady state whose balances do not close on its mesh."""


@dataclass(frozen=True)
class Schedule:
    """How to march: Courant number from `first_courant` up to `largest_courant`, at most `steps` steps.

    The number grows by `growth` while the rms change of ln T is below `growth_limit`. `relaxation`: share of
    the new Joule heating and force in each step; at large Courant number the Picard map has a factor near -1,
    which 0.5-0.6 removes. Converged when the largest velocity change [m/s] and the largest relative
    temperature change are below their tolerances at `converged_courant` or more; `converged_courant` = inf
    means: take exactly `steps` steps. `confirmed`: the state after the converged step must pass the same test
    itself; the step that measures it is not taken.
    """

    first_courant: float
    largest_courant: float
    steps: int
    growth: float = 1.5
    growth_limit: float = 0.12
    relaxation: float = 0.6
    velocity_tolerance: float = 0.2
    temperature_tolerance: float = 2e-3
    converged_courant: float = 1000.0
    confirmed: bool = False
    least_courant: float = 0.05
    patience: int = 0
    linear_tolerance: float = 0.0

    def reached_by(self, step):
        """Whether `step` shows a converged state."""
        return (
            step.velocity_change < self.velocity_tolerance
            and step.temperature_change < self.temperature_tolerance
            and step.courant >= self.converged_courant
        )

    def nearly_reached_by(self, step):
        """Whether the Jacobian that `step` was made with also serves the next one, the last but the check."""
        return (
            self.confirmed
            and step.velocity_change < self.velocity_tolerance
            and step.temperature_change < 10 * self.temperature_tolerance
            and step.courant >= self.largest_courant / 2
        )

    def next_courant(self, step):
        """Courant number after an accepted `step`: larger while the mean changes are small."""
        if step.rms_heat < self.growth_limit and step.rms_speed < 2.5 * self.growth_limit:
            calm = step.rms_heat < 0.2 * self.growth_limit
            return min(step.courant * self.growth * (1.5 if calm else 1.0), self.largest_courant)
        return step.courant * (0.7 if step.rms_heat > 0.15 else 1.0)


@dataclass(frozen=True)
class Step:
    """What one pseudo-time step did; see the contract 'flow' for the first four numbers.

    `residual` belongs to the state the step starts from, relative to gas at rest; the changes are those of
    the full Newton step there. `rms_heat`, `rms_speed`: root mean square of the changes of ln T and of u/100
    m/s over the nodes.
    """

    residual: float
    velocity_change: float
    temperature_change: float
    courant: float
    rms_heat: float
    rms_speed: float


@dataclass(frozen=True)
class Result:
    """A state, the steps that led to it, and the function that gives its Coupling and coil amplitude [A]."""

    state: np.ndarray
    steps: tuple
    couple: Callable

    @cached_property
    def _coupled(self):
        return self.couple()

    @property
    def coupling(self):
        return self._coupled[0]

    @property
    def current(self):
        return self._coupled[1]


def march(problem, state, power, schedule, label):
    """`Result` of marching `state` towards the steady flow at Joule power `power`.

    NotConverged: plasma extinguished, Courant number fallen to nothing, or not converged within
    `schedule.steps`.

    Parameters
    ----------
    problem : Problem
    state : (problem.space.size,) array
    power : float [W]
    schedule : Schedule
    label : str
        Names the run in log records and errors.
    """
    space = problem.space
    courant, coupling, steps, memory = schedule.first_courant, None, [], []
    passed, scale, first_current, share, factors = False, None, None, 1.0, None
    for number in range(1, schedule.steps + 1):
        if schedule.linear_tolerance:
            coupling = target = None  # the factors they hold, before new ones are made
        try:
            target, current = problem.couple(state, power)
        except OutsideTable as fault:
            raise NotConverged(f"{label}: step {number} starts outside the gas table: {fault}") from None
        accelerate = not schedule.linear_tolerance and courant >= ACCELERATED_COURANT
        relaxed = coupling is not None and not accelerate and not schedule.linear_tolerance
        coupling = _blend(coupling, target, schedule.relaxation) if relaxed else target
        scale = scale or problem.rest_residual(coupling)
        points = problem.points(state, coupling, courant)
        if not (steps and schedule.nearly_reached_by(steps[-1])):
            factors = None  # the memory, before new ones are made
        try:
            factors = factors or problem.factors(state, points)
            update, residual = problem.newton_update(
                state, points, target, schedule.linear_tolerance, factors
            )
        except (ArithmeticError, OutsideTable) as fault:
            raise NotConverged(
                f"{label}: step {number} of the flow failed at CFL {courant:.3g}: {fault}"
            ) from None
        residual /= scale
        step = _measured(space, update, residual, courant)
        steps.append(step)
        first_current = first_current or current
        _watch(space, state, step, current, first_current, f"{label}: step {number}")
        if passed and schedule.reached_by(step):
            known = replace(target, tangent=None), current  # without the factors
            return Result(state, tuple(steps), partial(tuple, known))
        if schedule.patience and number > schedule.patience:
            before = steps[-1 - STALL_STEPS].residual
            if residual > STALL_SHARE * before and not schedule.reached_by(step):
                raise NotConverged(
                    f"{label}: stalls at step {number}, residual {residual:.2e} against {before:.2e} "
                    f"{STALL_STEPS} steps before, last change {step.velocity_change:.3g} m/s and "
                    f"{step.temperature_change:.2e} in T at CFL {step.courant:.3g}"
                    + (_at_an_end(problem, state) or "; the flow is unsteady")
                )
        new = None
        if step.rms_heat <= REJECTED_LOG_TEMPERATURE and step.rms_speed <= REJECTED_VELOCITY:
            if accelerate:
                memory = [*memory, (state, update)][-ACCELERATION_DEPTH - 1 :]
                update = _accelerated(memory)
            share = _share(share, steps)
            new = _applied(problem, state, share * _damping(step) * update)
        if new is None:
            courant *= 0.4
        else:
            state = new
            passed = schedule.reached_by(step)
            if passed and not schedule.confirmed:
                return _result(problem, state, power, steps)
            courant = schedule.next_courant(step)
        if courant < schedule.least_courant:
            raise NotConverged(
                f"{label}: no acceptable step at CFL {courant:.2g} (step {number}, residual {residual:.2e}, "
                f"last change {step.velocity_change:.3g} m/s and {step.temperature_change:.2e} in T)"
                + _at_an_end(problem, state)
            )
    if np.isfinite(schedule.converged_courant):
        raise NotConverged(
            f"{label}: not converged in {schedule.steps} steps; residual {residual:.2e}, last change "
            f"{step.velocity_change:.3g} m/s and {step.temperature_change:.2e} in T at CFL {step.courant:.3g}"
        )
    return _result(problem, state, power, steps)


def march_or_slower(problem, state, power, schedule, label):
    """As `march`; where that fails once more from the same state, in smaller steps."""
    try:
        return march(problem, state, power, schedule, label)
    except NotConverged as fault:
        first = min(SLOW_COURANT, schedule.first_courant / 5)
        log.info("%s; again from CFL %g", fault, first)
    return march(problem, state, power, replace(schedule, first_courant=first), label)


def _at_an_end(problem, state):
    """What to add to a message where the temperature is held at an end of the property table; else ''.

    Between nodes that are somewhat below its end a quadratic element reaches it: a hot spot on coarse cells.
    """
    low, high = problem.properties.low, problem.properties.high
    temperature = np.exp(state[problem.space.field(LOG_TEMPERATURE)])
    if temperature.max() > HOT_SPOT * high:
        return (
            f"; the hottest gas, {temperature.max():.0f} K, reaches the end of the gas table, {high:g} K: "
            "is the mesh too coarse (flow.start.mesh_factor)?"
        )
    if temperature.min() < low * TABLE_MARGIN * (1 + 1e-9):
        return f"; the coldest gas reaches the end of the gas table, {low:g} K"
    return ""


def _measured(space, update, residual, courant):
    """The Step of a Newton update."""
    heat = update[space.field(LOG_TEMPERATURE)]
    axial, radial = update[space.field(AXIAL)], update[space.field(RADIAL)]
    return Step(
        residual=residual,
        velocity_change=float(max(np.abs(axial).max(), np.abs(radial).max()) * REFERENCE_VELOCITY),
        temperature_change=float(np.abs(heat).max()),
        courant=courant,
        rms_heat=float(np.sqrt(np.mean(heat**2))),
        rms_speed=float(np.sqrt(np.mean(axial**2 + radial**2))),
    )


def _watch(space, state, step, current, first_current, where):
    """Log the step; raise NotConverged if the state is hopeless."""
    hottest = float(np.exp(state[space.field(LOG_TEMPERATURE)].max()))
    log.info(
        "%s, CFL %.3g, residual %.2e, change %.3g m/s, %.2e in T, Tmax %.0f K, coil %.1f A",
        where, step.courant, step.residual, step.velocity_change, step.temperature_change, hottest, current,
    )  # fmt: skip
    if not np.isfinite(step.rms_heat + step.rms_speed):
        raise NotConverged(f"{where} of the flow is not finite; residual {step.residual:.2e}")
    if hottest < EXTINGUISHED:
        raise Extinguished(
            f"{where}: plasma extinguished; hottest gas {hottest:.0f} K, residual {step.residual:.2e}"
        )
    if current > RUNAWAY * first_current:
        raise Extinguished(
            f"{where}: plasma extinguished; the coil current ran away from {first_current:.0f} A to "
            f"{current:.0f} A, hottest gas {hottest:.0f} K"
        )


def _damping(step):
    """Factor that keeps the rms changes inside the trust region."""
    heat, speed = max(step.rms_heat, 1e-300), max(step.rms_speed, 1e-300)
    return min(1.0, RMS_LOG_TEMPERATURE / heat, RMS_VELOCITY / speed)


def _share(share, steps):
    """Share of Newton's step to take: halved while the residual is no smaller than two steps before.

    At large Courant number that is a cycle of two states around a front that is thinner than a cell.
    """
    cycles = len(steps) > 2 and steps[-1].residual > CYCLE_SHARE * steps[-3].residual
    if cycles and steps[-3].courant >= CYCLE_COURANT:
        return max(share / 2, LEAST_SHARE)
    return min(2 * share, 1.0)


def _applied(problem, state, update):
    """State after a clipped update, halved until T lies inside the property table; None if it never does."""
    space, heat = problem.space, problem.space.field(LOG_TEMPERATURE)
    limits = np.full(space.size, np.inf)
    limits[space.field(AXIAL)] = limits[space.field(RADIAL)] = LARGEST_VELOCITY
    limits[heat] = LARGEST_LOG_TEMPERATURE
    clipped = update.copy()
    clipped[heat] = _conducted(problem.properties, state[heat], update[heat])
    clipped = np.clip(clipped, -limits, limits)
    low, high = problem.properties.low * TABLE_MARGIN, problem.properties.high / TABLE_MARGIN
    for _ in range(HALVINGS):
        new = state + clipped
        new[heat] = np.clip(new[heat], np.log(low), np.log(high))
        # Quadratic elements can leave the range between nodes that are inside it.
        temperature = problem.temperature_at_points(new)
        if temperature.min() > problem.properties.low and temperature.max() < problem.properties.high:
            return new
        clipped = clipped / 2
    return None


def _conducted(properties, log_temperature, change):
    """Change of ln T that has the effect of a Newton update `change` of it on the heat-flux potential S.

    Conduction is linear in S: S + S' change is where Newton's method wants the gas to be, even where kappa
    grows a hundredfold on the way, as beside a cold wall. What would cool below S = 0 decays to it instead.
    """
    potential, conductivity = properties.heat_flux_potential(np.exp(log_temperature))
    step = conductivity * np.exp(log_temperature) * change
    falling = potential * np.exp(np.minimum(step, 0.0) / potential)
    reached = properties.temperature_of(np.where(step > 0, potential + step, falling))
    # What is held stays to the last digit.
    return np.where(change == 0.0, 0.0, np.log(reached) - log_temperature)


def _accelerated(memory):
    """Anderson's update from the last pairs (state x_k, update f_k).

    With the differences dX, dF of successive pairs:  f - (dX + dF) g,  g = argmin |f - dF g|.
    Source: Walker and Ni, SIAM J. Numer. Anal. 49 (2011) 1715, section 2.
    """
    states, updates = (np.array(column) for column in zip(*memory, strict=True))
    if len(updates) == 1:
        return updates[0]
    state_steps, update_steps = np.diff(states, axis=0).T, np.diff(updates, axis=0).T
    weights = np.linalg.lstsq(update_steps, updates[-1], rcond=1e-8)[0]
    return updates[-1] - (state_steps + update_steps) @ weights


def _blend(old, new, share):
    """Under-relaxed heating and force of two couplings."""
    mixed = {
        name: (1 - share) * getattr(old, name) + share * getattr(new, name)
        for name in ("joule_heating", "force_axial", "force_radial")
    }
    return replace(new, **mixed)


def _result(problem, state, power, steps):
    return Result(state, tuple(steps), partial(problem.couple, state, power))
