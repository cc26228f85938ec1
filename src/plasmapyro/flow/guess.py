"""A first guess from solutions of an earlier run, on meshes of the paper's torch, in air.

It shortens the way to a solution, not the test that it is one. Kept are, for each mesh of the error estimate,
the coarsest of which is that of the minimal run, the mean state over the powers, all its principal modes, in
quanta of each field (3 cm/s, 0.03 % of T, 0.3 Pa), and their amplitudes at each power.
Without it 60 kW takes 16 steps of Newton's method on coarser meshes and 8 on the final one; with it 2 and 2.
"""

import json
from dataclasses import asdict

import numpy as np

from plasmapyro.tables import arrays

NAME = "flow/first_guess"
SAME_VERTEX = 1e-6  # [m]: vertices are kept in single precision
STENCIL = 4  # powers of the interpolation
QUANTA = (3e-4, 3e-4, 3e-4, 3e-3)  # of the fields of a state


def guessed(problem, setup, gas, condition):
    """State of `problem` close to its solution at a Condition; None where none is known.

    Parameters
    ----------
    problem : Problem of quadratic elements at the condition
    setup : Setup
    gas : Dataset, contract 'gas'
    condition : Condition
    """
    known, here = arrays(NAME), condition.numerical_power
    level, power = _level_of(problem.mesh.p, known), known["power"]
    if level is None or not is_known(setup, gas, condition):
        return None
    first = np.clip(np.searchsorted(power, here) - STENCIL // 2, 0, len(power) - STENCIL)
    near = power[first : first + STENCIL]
    weights = [np.prod((here - near[near != one]) / (one - near[near != one])) for one in near]
    amplitude = weights @ known[f"amplitude_{level}"][first : first + STENCIL]
    state = known[f"mean_{level}"] + amplitude @ known[f"modes_{level}"]
    state *= _quantum(state.size, problem.mesh.p.shape[1])
    state[problem.fixed] = problem.values[problem.fixed]
    return state


def is_known(setup, gas, condition):
    """Whether states of this torch and gas are kept at the condition, or at powers around it."""
    known = arrays(NAME)
    low, high = known["power"][[0, -1]]
    return told(setup, gas, condition) == known["told"] and low <= condition.numerical_power <= high


def gathered(power, states, said, vertices):
    """What `guessed` reads.

    Parameters
    ----------
    power : (P,) [W] increasing
    states : sequence of (P, size)
        By level.
    said : str
        `told` of all.
    vertices : sequence of (2, V) [m]
        By level.
    """
    found = {"power": power, "told": said}
    for level, (own, points) in enumerate(zip(states, vertices, strict=True)):
        scaled = own / _quantum(own.shape[1], points.shape[1])
        mean = np.round(scaled.mean(axis=0))
        share, size, modes = np.linalg.svd(scaled - mean, full_matrices=False)
        quanta = {"mean": mean.astype(np.int16), "modes": np.round(modes * size[:, None]).astype(np.int16)}
        quanta |= {"amplitude": share, "vertices": points.astype(np.float32)}
        found |= {f"{name}_{level}": values for name, values in quanta.items()}
    return found


def told(setup, gas, condition):
    """All that a state depends on besides the power and the mesh, as text."""
    given = [asdict(setup), gas.attrs.get("gas", "air"), asdict(condition)]
    del given[0]["mesh_factor"], given[-1]["numerical_power"]
    return json.dumps(given, sort_keys=True)


def _level_of(vertices, known):
    """The level whose mesh has these vertices; None for none."""
    for name, there in known.items():
        if name.startswith("vertices_") and there.shape == vertices.shape:
            if np.abs(vertices - there).max() <= SAME_VERTEX:
                return name.removeprefix("vertices_")
    return None


def _quantum(size, vertices):
    """The quantum of each unknown: three fields at all nodes, the pressure at the vertices."""
    nodes = (size - vertices) // 3
    return np.repeat(QUANTA, (nodes, nodes, nodes, vertices))
