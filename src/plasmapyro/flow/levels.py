"""Coarser meshes: a cheap way to another condition, and the solutions that the error estimate compares."""

import logging
from dataclasses import dataclass, replace

import numpy as np

from plasmapyro.flow.case import moved, problem_of
from plasmapyro.flow.continuation import NotConverged, Schedule, march, march_or_slower
from plasmapyro.flow.dataset import setup_of
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
# Start and growth of the Courant number from a guess that the next coarser mesh corrected: Newton's method at
# once; and from one that only the coarsest did.
NEAR, FAR = {"first_courant": 2000.0, "growth": 6.0}, {"first_courant": RESTART_COURANT, "growth": 2.25}
# From a guess that is nearly a solution: no growth, so that the first Jacobian may serve the next step.
CLOSE = {"first_courant": LARGEST_COURANT}
COARSEST = 2  # level of the coarsest mesh


def level_factors(mesh_factor, mesh_ratio):
    """Mesh factors of the levels, the finest first; of that one alone without a ratio."""
    return [mesh_factor * mesh_ratio**level for level in range(COARSEST + 1 if mesh_ratio else 1)]


@dataclass(frozen=True)
class Solution:
    """A steady state of a problem."""

    problem: Problem
    state: np.ndarray


def coarse_way(known, coarser, case, origin, target):
    """Solutions at `target` on coarser meshes by level, and a first guess for the mesh of `known`.

    The coarsest mesh is followed from `origin` to `target`. What changed there, added to the solution of the
    next finer mesh at `origin`, is a guess for that mesh at `target`: what only it resolves stays in it.

    NotConverged: on the coarsest mesh.

    Parameters
    ----------
    known : Solution at `origin`
    coarser : mapping of level -> Solution at `origin`
        Those that are known; the coarsest is solved where it is missing, others are left out.
    case : Case
    origin, target : Condition
    """
    if origin == target:
        return dict(coarser), known.state
    here = coarser.get(COARSEST) or solved_on(COARSEST, known, case, origin, COARSE_BEGIN)
    label = f"{case.label}, coarse mesh"
    problem, result = follow(
        here.problem, here.state, case.air, origin, target, case.power_step, COARSE_END, label
    )
    there = Solution(problem, result.state)
    found, schedule = {COARSEST: there}, replace(COARSER, **NEAR)
    for level in sorted(coarser.keys() - found.keys(), reverse=True):
        problem = moved(coarser[level].problem, case.air, target)
        guess = changed(coarser[level], here, there, problem)
        try:
            state = march(problem, guess, target.numerical_power, schedule, case.on_level(level)).state
        except NotConverged as fault:
            log.info("%s; left out of the way", fault)
            break
        here, there = coarser[level], Solution(problem, state)
        found[level] = there
    return found, changed(known, here, there, moved(known.problem, case.air, target))


def changed(known, here, there, problem):
    """First guess for `problem`: a known state plus the change from `here` to `there` on a coarser mesh.

    Where a wall becomes adiabatic or cold, its layer is not the same on two meshes: the state `there` itself.
    """
    if known.problem.adiabatic_walls != problem.adiabatic_walls:
        return transfer(there.state, there.problem, problem)
    guess = known.state + carried(there.state - here.state, there.problem, problem)
    guess[problem.fixed] = problem.values[problem.fixed]
    return guess


def solved_on(level, known, case, condition, schedule=COARSER):
    """Solution on a coarser mesh: cells `mesh_ratio`^level times those of `known`, same condition."""
    mesh = case.meshes(case.setup.mesh_factor * case.mesh_ratio**level)
    problem = problem_of(mesh, case.setup, case.air, condition, 2, known.problem.limiter)
    guess = transfer(known.state, known.problem, problem)
    label, power = case.on_level(level), condition.numerical_power
    return Solution(problem, march_or_slower(problem, guess, power, schedule, label).state)


def estimated_error(known, coarser, case, condition):
    """Error of the temperature at the nodes [K] and observed order, from coarser meshes (level -> Solution).

    None if the first coarser mesh has no steady solution; order NaN if the second has none.
    """
    found = []
    for level in range(1, COARSEST + 1):
        try:
            found.append(coarser.get(level) or solved_on(level, known, case, condition))
        except NotConverged as fault:
            if not found:
                log.warning("%s: no error estimate: %s", case.label, fault)
                return None
            log.warning("%s: error estimate from two meshes only: %s", case.label, fault)
    error, order = mesh_error(known, found, case.mesh_ratio)
    log.info("%s: observed order of the temperature %.2f", case.label, order)
    return error, order


def state_variables(solutions):
    """Variables of contract 'flow' that hold the solutions on coarser meshes by level, for `known_levels`."""
    levels = sorted(solutions.keys() - {0})
    if not levels:
        return {}
    states = [solutions[level].state for level in levels]
    return {
        "solver_state_mesh": (
            "solver_dof", np.repeat(np.array(levels, dtype=np.int8), [len(state) for state in states]),
        ),
        "solver_state": ("solver_dof", np.concatenate(states)),
    }  # fmt: skip


def known_levels(dataset, known, case, condition):
    """Solutions on coarser meshes, by level, that a flow dataset holds besides the one that is `known`.

    Empty where it holds none, or those of another torch or other meshes.
    """
    found = {}
    if not case.mesh_ratio or "solver_state" not in dataset or setup_of(dataset) != case.setup:
        return found
    for level, factor in enumerate(level_factors(case.setup.mesh_factor, case.mesh_ratio)):
        state = dataset.solver_state.values[dataset.solver_state_mesh.values == level]
        if level and len(state):
            mesh = case.meshes(factor)
            problem = problem_of(mesh, case.setup, case.air, condition, 2, known.problem.limiter)
            if problem.space.size == len(state):
                found[level] = Solution(problem, state)
    return found
