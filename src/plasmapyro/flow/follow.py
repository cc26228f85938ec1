"""The way from one condition to another on one mesh, by parts that are halved where they fail."""

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
    while True:
        ahead = share + part if share + part < 1 - 1e-9 else 1.0
        there = origin.towards(target, ahead)
        trial = moved(problem, air, there)
        guess = state.copy()
        guess[trial.fixed] = trial.values[trial.fixed]
        schedule = final if ahead == 1.0 else UNDER_WAY
        try:
            result = march(
                trial, guess, there.numerical_power, schedule, f"{label}, at {ahead:.3g} of the way"
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
            return trial, result
        share, state, here = ahead, result.state, there
        part = min(2 * part, first)
