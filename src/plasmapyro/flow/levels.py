"""Coarser meshes: a cheap way to another condition, and the solutions that the error estimate compares."""

import logging
from dataclasses import dataclass, replace

import numpy as np

from plasmapyro.flow.case import problem_of
from plasmapyro.flow.continuation import NotConverged, Schedule, march
from plasmapyro.flow.evaluate import carried, transfer
from plasmapyro.flow.follow import LARGEST_COURANT, LINEAR_TOLERANCE, PATIENCE, RESTART_COURANT, follow
from plasmapyro.flow.mesh_error import mesh_error
from plasmapyro.flow.problem import Problem

log = logging.getLogger(__name__)

# Coarser meshes of the error estimate: only as steady as the estimate needs.
COARSER = Schedule(
    150.0,
    LARGEST_COURANT,
    30,
    velocity_tolerance=2.0,
    temperature_tolerance=2e-2,
    least_courant=5.0,
    patience=PATIENCE,
    linear_tolerance=LINEAR_TOLERANCE,
)
# Where the coarse way begins: what is left of its error is small against the change along the way.
COARSE_BEGIN = replace(COARSER, velocity_tolerance=5.0, temperature_tolerance=0.1)
COARSE_END = replace(COARSER, first_courant=RESTART_COURANT)
SLOW_COURANT = 30.0  # where a coarse mesh is not reached at the first try
COARSEST = 2  # level of the coarsest mesh


def level_factors(mesh_factor, mesh_ratio):
    """Mesh factors of the levels, the finest first; of that one alone without a ratio."""
    return [mesh_factor * mesh_ratio**level for level in range(COARSEST + 1 if mesh_ratio else 1)]


@dataclass(frozen=True)
class Solution:
    """A steady state of a problem."""

    problem: Problem
    state: np.ndarray


def coarse_way(known, case, origin, target):
    """Solution at `target` on the coarsest mesh, and a first guess for the mesh of `known`.

    The coarse mesh is solved at `origin` and followed to `target`. The guess is the known state plus the
    change of the coarse one: what only the fine mesh resolves stays in it.

    Parameters
    ----------
    known : Solution at `origin`
    case : Case
    origin, target : Condition

    Raises
    ------
    NotConverged
    """
    same = origin == target
    here = solved_on(COARSEST, known, case, origin, COARSER if same else COARSE_BEGIN)
    if same:
        return here, known.state
    label = f"{case.label}, coarse mesh"
    problem, result = follow(
        here.problem, here.state, case.air, origin, target, case.power_step, COARSE_END, label
    )
    there = Solution(problem, result.state)
    return there, known.state + carried(there.state - here.state, there.problem, known.problem)


def solved_on(level, known, case, condition, schedule=COARSER):
    """Solution on a coarser mesh: cells `mesh_ratio`^level times those of `known`, same condition."""
    factor = case.mesh_ratio**level
    mesh = case.meshes(case.setup.mesh_factor * factor)
    problem = problem_of(mesh, case.setup, case.air, condition, 2, known.problem.limiter)
    guess = transfer(known.state, known.problem, problem)
    label = f"{case.label}, mesh {factor:.3g} times as coarse"
    power = condition.numerical_power
    try:
        return Solution(problem, march(problem, guess, power, schedule, label).state)
    except NotConverged as fault:
        log.info("%s; again from CFL %g", fault, SLOW_COURANT)
    schedule = replace(schedule, first_courant=SLOW_COURANT)
    return Solution(problem, march(problem, guess, power, schedule, label).state)


def estimated_error(known, coarsest, case, condition):
    """Error of the temperature at the nodes [K] and observed order, from coarser meshes.

    Parameters
    ----------
    known : Solution at `condition`
    coarsest : Solution or None
        On the coarsest mesh, where it is known already.
    case : Case
    condition : Condition

    Returns
    -------
    error, order; None if the first coarser mesh has no steady solution; order NaN if the second has none
    """
    try:
        coarser = [solved_on(1, known, case, condition)]
    except NotConverged as fault:
        log.warning("%s: no error estimate: %s", case.label, fault)
        return None
    try:
        coarser.append(coarsest or solved_on(COARSEST, known, case, condition))
    except NotConverged as fault:
        log.warning("%s: error estimate from two meshes only: %s", case.label, fault)
    error, order = mesh_error(known, coarser, case.mesh_ratio)
    log.info("%s: observed order of the temperature %.2f", case.label, order)
    return error, order
