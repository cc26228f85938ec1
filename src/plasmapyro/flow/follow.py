"""The way from one condition to another on one mesh, by parts.

A part that fails is gone again with the viscosity limiter of the chamber raised to `HELD_LIMITER`, which is
lowered to its own value where the way ends; a part that fails all the same is halved, down to `LEAST_PART`.
"""

import logging

import numpy as np

from plasmapyro.flow.case import moved
from plasmapyro.flow.continuation import Extinguished, NotConverged, Schedule, march

log = logging.getLogger(__name__)

# From one condition to a near one Newton's method converges from the first step. A small Courant number would
# follow the growth of the unsteady shear layer of the cold sheath instead, and lose the solution.
RESTART_COURANT, LARGEST_COURANT = 200.0, 1e5
LEAST_RESTART_COURANT = 80.0  # a restart that needs smaller steps started too far away
PATIENCE = 18
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
# The cold sheath is unsteady in the chamber at high flow; more viscosity there carries the state along.
HELD_LIMITER, LIMITER_RATIO = 0.15, 2.8
LEAST_PART = 1 / 8  # of the first part of the way: where a state cannot be continued further


def follow(problem, state, air, origin, target, power_step, final, label):
    """Problem at `target` and its Result, from a state at `origin`.

    Parameters
    ----------
    problem, state : Problem at `origin` and its solution
    air : Air
    origin, target : Condition
    power_step : float [W]
        See `Condition.parts_to`.
    final : Schedule
        Of the last part.
    label : str

    Raises
    ------
    NotConverged
        Names the two conditions between which the flow is lost.
    """
    first = 1 / max(int(np.ceil(origin.parts_to(target, power_step) - 1e-9)), 1)
    share, part, here = 0.0, first, origin
    limiter, held, lost = problem.limiter, problem.limiter, False
    while True:
        ahead = share + part if share + part < 1 - 1e-9 else 1.0
        there = origin.towards(target, ahead)
        trial = moved(problem.with_limiter(held), air, there)
        guess = state.copy()
        guess[trial.fixed] = trial.values[trial.fixed]
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
            if part < LEAST_PART * first:
                out = isinstance(fault, Extinguished)
                found = "the plasma goes out" if out else "no steady flow was found"
                raise type(fault)(
                    f"{label}: {found} between {here.describe()} and {there.describe()}, on the way from "
                    f"{origin.describe()}: {fault}"
                ) from None
            log.info("%s: part halved after: %s", label, fault)
            continue
        share, here = ahead, there
        part = min(2 * part, first)


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
