"""The way from one condition to another on one mesh, by parts.

A part that fails is gone again with the viscosity limiter of the chamber raised to `HELD_LIMITER`, which is
lowered to its own value where the way ends; a part that fails all the same is halved, down to `LEAST_PART`.
Where the branch of solutions ends there, the last state is marched in small pseudo-time steps a whole part
further on: it settles to another steady flow, or the plasma goes out.
"""

import logging
from dataclasses import replace

import numpy as np

from plasmapyro.flow.case import moved
from plasmapyro.flow.continuation import Extinguished, NotConverged, Schedule, march
from plasmapyro.flow.physics import AXIAL, RADIAL

log = logging.getLogger(__name__)

# From one condition to a near one Newton's method converges from the first step. A small Courant number would
# follow the growth of the unsteady shear layer of the cold sheath instead, and lose the solution.
RESTART_COURANT, LARGEST_COURANT = 200.0, 1e5
LEAST_RESTART_COURANT = 80.0  # a restart that needs smaller steps started too far away
PATIENCE = 12
LINEAR_TOLERANCE = 1e-2
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
# Beyond the end of a branch: small steps follow the fall to another one. From 70 kW and 30 g/s down the hot
# core of the torch collapses within 20 steps, and 50 more settle a flow of 7000 K.
FALLING = Schedule(
    5.0,
    20.0,
    150,
    velocity_tolerance=5.0,
    temperature_tolerance=0.06,
    converged_courant=20.0,
    least_courant=0.5,
    linear_tolerance=LINEAR_TOLERANCE,
)
FALLEN = replace(UNDER_WAY, first_courant=50.0, least_courant=10.0)
# The cold sheath is unsteady in the chamber at high flow; more viscosity there carries the state along.
HELD_LIMITER, LIMITER_RATIO = 0.15, 2.8
LEAST_PART = 1 / 4  # of the first part of the way: where a state cannot be continued further


def follow(problem, state, air, origin, target, power_step, final, label):
    """Problem at `target` and its Result, from a state at `origin`.

    `power_step` [W]: see `Condition.parts_to`; `final`: schedule of the last part. NotConverged names the two
    conditions between which the flow is lost, and what became of it beyond.
    """
    first = 1 / max(int(np.ceil(origin.parts_to(target, power_step) - 1e-9)), 1)
    share, part, here = 0.0, first, origin
    limiter, held, lost, fallen = problem.limiter, problem.limiter, False, False
    while True:
        ahead = share + part if share + part < 1 - 1e-9 else 1.0
        there = origin.towards(target, ahead)
        trial = moved(problem.with_limiter(held), air, there)
        guess = _fed(trial, state, here, there)
        where = f"{label}, at {ahead:.3g} of the way"
        try:
            if ahead == 1.0:
                return _arrived(trial, guess, there.numerical_power, limiter, final, where)
            state = march(trial, guess, there.numerical_power, UNDER_WAY, where).state
        except NotConverged as fault:
            if held < HELD_LIMITER and not lost:
                log.info("%s: limiter %g on the way after: %s", label, HELD_LIMITER, fault)
                try:
                    state = _held(moved(problem, air, here), state, here.numerical_power, where)
                    held = HELD_LIMITER
                    continue
                except NotConverged as again:
                    log.info("%s", again)
                    lost = True
            part /= 2
            if part >= LEAST_PART * first:
                log.info("%s: part halved after: %s", label, fault)
                continue
            if fallen or ahead == 1.0:
                raise _lost(label, origin, here, there, fault) from None
            ahead = min(share + first, 1.0)
            beyond = origin.towards(target, ahead)
            log.info("%s: in small steps to %s after: %s", label, beyond.describe(), fault)
            trial = moved(problem.with_limiter(held), air, beyond)
            try:
                state = _fallen(trial, _fed(trial, state, here, beyond), beyond.numerical_power, where)
            except NotConverged as end:
                raise _lost(label, origin, here, there, fault, end) from None
            log.warning(
                "%s: the flow jumps to another steady state between %s and %s",
                label, here.describe(), there.describe(),
            )  # fmt: skip
            there, part, fallen = beyond, first, True
        share, here = ahead, there
        part = min(2 * part, first)


def _lost(label, origin, here, there, fault, end=None):
    """The error that names the conditions between which the flow is lost; `end`: what came of it beyond."""
    last = end or fault
    found = "the plasma goes out" if isinstance(last, Extinguished) else "no steady flow was found"
    beyond = f"; in small steps beyond, {end}" if end else ""
    return type(last)(
        f"{label}: {found} between {here.describe()} and {there.describe()}, on the way from "
        f"{origin.describe()}: {fault}{beyond}"
    )


def _fed(problem, state, here, there):
    """First guess for a Problem at `there` from a state at `here`: speeds that carry the new feed.

    The speed of the cold gas is that of the feed, as the mass flow over the pressure.
    """
    ratio = there.mass_flow_rate / here.mass_flow_rate * here.chamber_pressure / there.chamber_pressure
    guess = state.copy()
    if ratio != 1.0:
        for field in (AXIAL, RADIAL):
            guess[problem.space.field(field)] *= ratio
    guess[problem.fixed] = problem.values[problem.fixed]
    return guess


def _fallen(problem, guess, power, where):
    """State after a fall from `guess`."""
    state = march(problem, guess, power, FALLING, f"{where}, in small steps").state
    return march(problem, state, power, FALLEN, f"{where}, after the fall").state


def _held(problem, state, power, where):
    """State at the same condition with `HELD_LIMITER`."""
    limiter = problem.limiter
    while limiter < HELD_LIMITER:
        limiter = min(max(limiter, HELD_LIMITER / LIMITER_RATIO**2) * LIMITER_RATIO, HELD_LIMITER)
        held = problem.with_limiter(limiter)
        state = march(held, state, power, UNDER_WAY, f"{where}, limiter {limiter:.3g}").state
    return state


def _arrived(problem, guess, power, limiter, final, where):
    """Problem with `limiter` and its Result, from a guess found with a larger limiter or the same."""
    while problem.limiter > limiter:
        guess = march(problem, guess, power, UNDER_WAY, f"{where}, limiter {problem.limiter:.3g}").state
        problem = problem.with_limiter(max(limiter, problem.limiter / LIMITER_RATIO))
    return problem, march(problem, guess, power, final, where)
