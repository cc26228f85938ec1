"""Stages of the flow group: one cold start, and each condition from it by continuation."""

import logging
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from plasmapyro.checks import non_negative, positive
from plasmapyro.flow.balances import balances
from plasmapyro.flow.condition import Condition
from plasmapyro.flow.continuation import Extinguished, NotConverged, Schedule, march
from plasmapyro.flow.dataset import Setup, mesh_of, setup_of, state_from, to_dataset
from plasmapyro.flow.geometry import Torch, build_mesh
from plasmapyro.flow.initial import hot_torch, transfer
from plasmapyro.flow.mesh_error import mesh_error
from plasmapyro.flow.problem import Problem
from plasmapyro.flow.properties import gas_properties

log = logging.getLogger(__name__)

START_LIMITERS = (0.2, 0.1)  # viscosity limiter of the two parts of the start on linear elements
# Formation of the torch vortex: above CFL 6 the frozen Joule heating overheats single spots.
FORMATION = Schedule(1.0, 6.0, 60, relaxation=0.5, converged_courant=np.inf)
SETTLING = Schedule(
    6.0,
    2000.0,
    200,
    growth=1.3,
    growth_limit=0.08,
    relaxation=0.5,
    velocity_tolerance=5.0,
    temperature_tolerance=0.1,
    converged_courant=30.0,
)
# Quadratic elements on the start mesh, only a first guess for the final mesh.
UPGRADE = Schedule(
    10.0, 3000.0, 60, velocity_tolerance=20.0, temperature_tolerance=0.1, converged_courant=100.0
)
# From one condition to a near one Newton's method converges from the first step. A small Courant number would
# follow the growth of the unsteady shear layer of the cold sheath instead, and lose the solution.
RESTART_COURANT, LARGEST_COURANT = 200.0, 1e5
PATIENCE = 18
LINEAR_TOLERANCE = 1e-2
LEAST_RESTART_COURANT = 80.0  # a restart that needs smaller steps started too far away
# Part of the way to another condition: only the last part has to be steady.
UNDER_WAY = Schedule(
    RESTART_COURANT,
    LARGEST_COURANT,
    30,
    velocity_tolerance=20.0,
    temperature_tolerance=0.1,
    converged_courant=300.0,
    least_courant=LEAST_RESTART_COURANT,
    patience=PATIENCE,
    linear_tolerance=LINEAR_TOLERANCE,
)
TRIES = 2  # known solutions from which a condition is tried
LEAST_PART = 1 / 8  # of the first part of the way: where a state cannot be continued further
MASS_BAR, ENERGY_BAR = 5e-3, 2e-2  # worst imbalance of a solution that is handed on
# Coarser meshes of the error estimate: only as steady as the estimate needs.
COARSER = Schedule(
    50.0,
    LARGEST_COURANT,
    30,
    velocity_tolerance=2.0,
    temperature_tolerance=1e-2,
    least_courant=5.0,
    patience=PATIENCE,
    linear_tolerance=LINEAR_TOLERANCE,
)


def cold_start(
    gas,
    *,
    torch,
    wall_temperature,
    numerical_power,
    chamber_pressure,
    mass_flow_rate,
    coil_frequency,
    probe_temperature,
    mesh_factor,
    start_mesh_factor,
    viscosity_limiter,
    velocity_tolerance,
    temperature_tolerance,
    largest_step_count,
):
    """Steady flow at a reference condition, from a hot first guess; no swirl, no radiation loss.

    Linear elements on a mesh of their own first (cheap, forgiving), then Taylor-Hood elements on the final
    mesh.

    Parameters
    ----------
    gas : Dataset, contract 'gas'
    torch : mapping
        Fields of `geometry.Torch`: lengths [m], and the shape of the probe.
    wall_temperature : float [K]
        Of all walls but the probe's, and of the gas at the inlet.
    numerical_power : float [W]
        Joule power; the coil current follows from it.
    chamber_pressure : float [Pa]
    mass_flow_rate : float [kg s-1]
    coil_frequency : float [Hz]
    probe_temperature : float [K]
        Of the probe wall.
    mesh_factor, start_mesh_factor : float [1]
        Multiply the cell sizes of the final mesh and of the start mesh.
    viscosity_limiter : float [1]
        Coefficient of the limiter that acts behind the torch exit, >= 0; see `physics`.
    velocity_tolerance : float [m s-1]
    temperature_tolerance : float [1]
        Largest change that Newton's method would still make to the state that is returned.
    largest_step_count : int

    Returns
    -------
    Dataset, contract 'flow'

    Raises
    ------
    ValueError
        An argument out of range.
    NotConverged
        No steady state reached; nothing is returned.
    """
    setup = Setup(
        Torch(**{**torch, "coil_positions": tuple(float(z) for z in torch["coil_positions"])}),
        float(positive("wall_temperature", wall_temperature, "K")),
        float(positive("mesh_factor", mesh_factor, "1")),
    )
    reference = Condition(
        numerical_power, chamber_pressure, mass_flow_rate, coil_frequency, probe_temperature
    )
    power = reference.numerical_power
    limiter = float(non_negative("viscosity_limiter", viscosity_limiter, "1"))
    air = Air(gas, None, setup.wall_temperature)
    label = f"cold start {power / 1e3:g} kW"
    coarse_mesh = build_mesh(setup.torch, positive("start_mesh_factor", start_mesh_factor, "1"))
    coarse = _problem(coarse_mesh, setup, air, reference, 1)
    state = hot_torch(coarse)
    for start_limiter, schedule in zip(START_LIMITERS, (FORMATION, SETTLING), strict=True):
        limited = coarse.with_limiter(start_limiter)
        state = march(limited, state, power, schedule, f"{label}, linear elements").state
    # One change at a time: linear to quadratic on one mesh, then the finer mesh.
    source = coarse
    if setup.mesh_factor < start_mesh_factor:
        source = _problem(coarse_mesh, setup, air, reference, 2, limiter)
        state = transfer(state, coarse, source)
        state = march(source, state, power, UPGRADE, f"{label}, start mesh").state
    fine = _problem(build_mesh(setup.torch, setup.mesh_factor), setup, air, reference, 2, limiter)
    state = transfer(state, source, fine)
    final = Schedule(
        10.0,
        LARGEST_COURANT,
        largest_step_count,
        velocity_tolerance=velocity_tolerance,
        temperature_tolerance=temperature_tolerance,
        confirmed=True,
        linear_tolerance=LINEAR_TOLERANCE,
    )
    result = march(fine, state, power, final, label)
    return _finished(fine, setup, reference, result, label)


def condition(
    gas,
    start,
    *,
    neighbours=(),
    emission=None,
    numerical_power,
    chamber_pressure,
    mass_flow_rate,
    coil_frequency,
    probe_temperature,
    swirl_angle,
    radiation_factor,
    viscosity_limiter,
    power_step,
    error_mesh_ratio,
    velocity_tolerance,
    temperature_tolerance,
    largest_step_count,
):
    """Steady flow at one condition, continued from the nearest known solution.

    All quantities move together from the known solution to the condition, in parts small enough that none
    changes the power by much more than `power_step`, nor another quantity by more than its step in
    `condition.STEP`. A part that fails is halved, down to `LEAST_PART`. If the way from the nearest solution
    fails, the next nearest is tried; `start`, itself a cold start, is one of those known.

    Parameters
    ----------
    gas : Dataset, contract 'gas'
        The one `start` was computed with.
    start : Dataset, contract 'flow'
        Result of `cold_start`; torch, probe, wall temperature and mesh are taken from it.
    neighbours : sequence of Dataset, contract 'flow'
        Other known solutions; those of another torch, probe or mesh are interpolated.
    emission : Dataset, contract 'net_emission', optional
        Needed where `radiation_factor` is not zero.
    swirl_angle : float [rad]
        Between the gas that enters and the axis.
    radiation_factor : float [1]
        Multiplies the net emission; 0 for no loss.
    power_step : float [W]
    error_mesh_ratio : float [1]
        Ratio of the cell sizes of the meshes of the error estimate, > 1; 0 for no estimate.
    others : as in `cold_start`

    Returns
    -------
    Dataset, contract 'flow'

    Raises
    ------
    ValueError
        As `cold_start`; a radiation factor without `emission`.
    NotConverged
        No way led to a steady state; the message says for each how far it led, and where the plasma went
        out if it did.
    """
    target = Condition(
        numerical_power,
        chamber_pressure,
        mass_flow_rate,
        coil_frequency,
        probe_temperature,
        swirl_angle,
        radiation_factor,
    )
    limiter = float(non_negative("viscosity_limiter", viscosity_limiter, "1"))
    power_step = float(positive("power_step", power_step, "W"))
    final = Schedule(
        RESTART_COURANT,
        LARGEST_COURANT,
        largest_step_count,
        velocity_tolerance=velocity_tolerance,
        temperature_tolerance=temperature_tolerance,
        confirmed=True,
        least_courant=LEAST_RESTART_COURANT,
        patience=PATIENCE,
        linear_tolerance=LINEAR_TOLERANCE,
    )
    setup = setup_of(start)
    air = Air(gas, emission, setup.wall_temperature)
    mesh = mesh_of(start, setup)
    label = f"condition {target.describe()}"
    known = sorted((*neighbours, start), key=lambda one: Condition.of(one).parts_to(target, power_step))
    faults = []
    for one in known[:TRIES]:
        origin = Condition.of(one)
        problem = _problem(mesh, setup, air, origin, 2, limiter)
        state = _known_state(one, setup, problem, gas)
        try:
            problem, result = _follow(problem, state, air, origin, target, power_step, final, label)
            return _finished(problem, setup, target, result, label, air, error_mesh_ratio)
        except NotConverged as fault:
            log.info("%s", fault)
            faults.append(fault)
    kind = Extinguished if all(isinstance(fault, Extinguished) for fault in faults) else NotConverged
    raise kind("\n".join(map(str, faults)))


@dataclass(frozen=True)
class Air:
    """The gas tables of all conditions: contract 'gas', contract 'net_emission' or None, wall temperature."""

    gas: xr.Dataset
    emission: xr.Dataset | None
    wall_temperature: float

    def properties(self, condition):
        """GasProperties at a condition."""
        return gas_properties(
            self.gas,
            condition.chamber_pressure,
            self.wall_temperature,
            self.emission,
            condition.radiation_factor,
        )


def _problem(mesh, setup, air, condition, order, limiter=0.0):
    return Problem(
        mesh,
        setup.torch,
        air.properties(condition),
        frequency=condition.coil_frequency,
        mass_flow_rate=condition.mass_flow_rate,
        wall_temperature=setup.wall_temperature,
        probe_temperature=condition.probe_temperature,
        swirl_angle=condition.swirl_angle,
        order=order,
        limiter=limiter,
    )


def _known_state(dataset, setup, problem, gas):
    """State of `problem` from a flow dataset, interpolated if it stands on another mesh."""
    own = setup_of(dataset)
    if own == setup:
        return state_from(dataset, problem)
    air = Air(gas, None, own.wall_temperature)
    plain = replace(Condition.of(dataset), radiation_factor=0.0)
    source = _problem(mesh_of(dataset, own), own, air, plain, 2)
    return transfer(state_from(dataset, source), source, problem)


def _follow(problem, state, air, origin, target, power_step, final, label):
    """Problem at `target` and its Result, from a state at `origin`, by parts."""
    first = 1 / max(int(np.ceil(origin.parts_to(target, power_step) - 1e-9)), 1)
    share, part, here = 0.0, first, origin
    while True:
        ahead = share + part if share + part < 1 - 1e-9 else 1.0
        there = origin.towards(target, ahead)
        moved = problem.at(
            air.properties(there),
            mass_flow_rate=there.mass_flow_rate,
            frequency=there.coil_frequency,
            probe_temperature=there.probe_temperature,
            swirl_angle=there.swirl_angle,
        )
        guess = state.copy()
        guess[moved.fixed] = moved.values[moved.fixed]
        schedule = final if ahead == 1.0 else UNDER_WAY
        try:
            result = march(
                moved, guess, there.numerical_power, schedule, f"{label}, at {ahead:.3g} of the way"
            )
        except NotConverged as fault:
            part /= 2
            if part < LEAST_PART * first:
                out = isinstance(fault, Extinguished)
                found = "the plasma goes out" if out else "no steady flow was found"
                raise type(fault)(
                    f"{label}: {found} between {here.describe()} and {there.describe()}, on the way from "
                    f"{origin.describe()}: {fault}"
                ) from None
            log.info("%s: part halved after: %s", label, fault)
            continue
        if ahead == 1.0:
            return moved, result
        share, state, here = ahead, result.state, there
        part = min(2 * part, first)


def _finished(problem, setup, condition, result, label, air=None, error_mesh_ratio=0.0):
    """Check the balances, estimate the error, make the dataset."""
    balance = balances(problem, result.state, result.coupling)
    if abs(balance.mass_imbalance) > MASS_BAR or abs(balance.energy_imbalance) > ENERGY_BAR:
        raise NotConverged(
            f"{label}: converged, but mass is off by {balance.mass_imbalance:.2%} and energy by "
            f"{balance.energy_imbalance:.2%} (limits {MASS_BAR:.1%}, {ENERGY_BAR:.1%}); refine the mesh"
        )
    log.info(
        "%s: %d steps, mass imbalance %.3f %%, energy imbalance %.3f %%",
        label, len(result.steps), 100 * balance.mass_imbalance, 100 * balance.energy_imbalance,
    )  # fmt: skip
    error = None
    if error_mesh_ratio:
        error = _mesh_error(problem, setup, air, condition, result.state, error_mesh_ratio, label)
    return to_dataset(problem, setup, condition, result, balance, error)


def _mesh_error(problem, setup, air, condition, state, ratio, label):
    """Error of the temperature at the nodes [K] and observed order, from coarser meshes.

    A coarser mesh without a steady solution is left out; None if there is no other.
    """
    if not ratio > 1:
        raise ValueError(f"error_mesh_ratio must be 0 or > 1; got {ratio:g}")
    coarser, source, guess = [], problem, state
    for power in (1, 2):
        mesh = build_mesh(setup.torch, setup.mesh_factor * ratio**power)
        other = _problem(mesh, setup, air, condition, 2, problem.limiter)
        guess = transfer(guess, source, other)
        where = f"{label}, mesh {ratio**power:.3g} times as coarse"
        try:
            guess = march(other, guess, condition.numerical_power, COARSER, where).state
        except NotConverged as fault:
            log.info("%s: no error estimate from this mesh: %s", label, fault)
            break
        coarser.append((other, guess))
        source = other
    if not coarser:
        return None
    error, order = mesh_error(problem, state, coarser, ratio)
    log.info("%s: observed order of the temperature %.2f", label, order)
    return error, order
