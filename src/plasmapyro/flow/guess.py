"""A first guess from solutions of an earlier run, on the mesh of the paper's torch, in air.

It shortens the way to a solution, not the test that it is one. Kept are the mean state over the powers, all
its principal modes, in quanta of each field (3 cm/s, 0.03 % of T, 0.3 Pa), their amplitudes at each power;
for the cold start also its states on coarser meshes.
Without it 60 kW takes 16 steps of Newton's method on coarser meshes and 8 on the final one; with it 6 and 2.
"""

import json
from dataclasses import asdict

import numpy as np

from plasmapyro.tables import arrays

NAME = "flow/first_guess"
SAME_VERTEX = 1e-6  # [m]: vertices are kept in single precision
STENCIL = 4  # powers of the interpolation
QUANTA = (3e-4, 3e-4, 3e-4, 3e-3)  # of the fields of a state


def guessed(level, problem, setup, gas, condition):
    """State of `problem` close to its solution at a Condition; None where none is known.

    Parameters
    ----------
    level : int
        Of the mesh: 0 is the finest; on the coarser ones states are known at one power.
    problem : Problem of quadratic elements at the condition
    setup : Setup
    gas : Dataset, contract 'gas'
    condition : Condition
    """
    known, vertices, power = arrays(NAME), problem.mesh.p, condition.numerical_power
    there = known.get(f"vertices_{level}", np.empty(0))
    if vertices.shape != there.shape or told(setup, gas, condition) != known["told"]:
        return None
    if np.abs(vertices - there).max() > SAME_VERTEX:
        return None
    if level:
        state = 1.0 * known[f"state_{level}"] if power == known["power_of_levels"] else None
    else:
        state = _between(known, power)
    if state is None:
        return None
    state *= _quantum(state.size, vertices.shape[1])
    state[problem.fixed] = problem.values[problem.fixed]
    return state


def _between(known, here):
    """State on the finest mesh at a power, in quanta; None outside of the known ones."""
    power = known["power"]
    if not power[0] <= here <= power[-1]:
        return None
    first = np.clip(np.searchsorted(power, here) - STENCIL // 2, 0, len(power) - STENCIL)
    near = power[first : first + STENCIL]
    weights = [np.prod((here - near[near != one]) / (one - near[near != one])) for one in near]
    return known["mean"] + weights @ known["amplitude"][first : first + STENCIL] @ known["modes"]


def gathered(power, states, said, power_of_levels, vertices, coarser):
    """What `guessed` reads.

    Parameters
    ----------
    power, states : (P,) [W] increasing, (P, size)
    said : str
        `told` of all.
    power_of_levels : float [W]
    vertices : sequence of (2, V) [m]
        Of the finest mesh, then of the coarser ones.
    coarser : sequence of (size,)
        States on the coarser ones.
    """
    scaled = states / _quantum(states.shape[1], vertices[0].shape[1])
    mean = np.round(scaled.mean(axis=0))
    share, size, modes = np.linalg.svd(scaled - mean, full_matrices=False)
    found = {"mean": mean.astype(np.int16), "modes": np.round(modes * size[:, None]).astype(np.int16)}
    found |= {"amplitude": share, "power": power, "told": said, "power_of_levels": power_of_levels}
    found |= {f"vertices_{level}": points.astype(np.float32) for level, points in enumerate(vertices)}
    for level, state in enumerate(coarser, start=1):
        quanta = state / _quantum(state.size, vertices[level].shape[1])
        found[f"state_{level}"] = np.round(quanta).astype(np.int16)
    return found


def told(setup, gas, condition):
    """All that a state depends on besides the power, as text."""
    conditions = {name: value for name, value in asdict(condition).items() if name != "numerical_power"}
    return json.dumps([asdict(setup), gas.attrs.get("gas", "air"), conditions], sort_keys=True)


def _quantum(size, vertices):
    """The quantum of each unknown: three fields at all nodes, the pressure at the vertices."""
    nodes = (size - vertices) // 3
    return np.repeat(QUANTA, (nodes, nodes, nodes, vertices))
