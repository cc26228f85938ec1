"""Air in local thermodynamic equilibrium from own partition sums: mass action, quasi-neutrality, pressure."""

import csv
from functools import cache
from pathlib import Path

import numpy as np

DATA = Path(__file__).with_name("data")
# CODATA 2018
PLANCK, LIGHT, BOLTZMANN, ELECTRON, CHARGE = (
    6.62607015e-34,
    299792458.0,
    1.380649e-23,
    9.1093837015e-31,
    1.602176634e-19,
)
VACUUM, DALTON, RYDBERG = 8.8541878128e-12, 1.66053906660e-27, 109737.31568  # RYDBERG [cm-1]
C2 = 100 * PLANCK * LIGHT / BOLTZMANN  # second radiation constant [K cm]
MASS = {"N": 14.003, "O": 15.995, "N2": 28.006, "O2": 31.990, "NO": 29.998, "e-": ELECTRON / DALTON}  # [u]
MASS |= {f"{one}+": MASS[one] for one in ("N", "O", "N2", "O2", "NO")}
# Dissociation and ionisation energies [cm-1]: Huber and Herzberg (1979), NIST ASD, NIST WebBook.
DISSOCIATION = {"N2": 78714.0, "O2": 41268.6, "NO": 52400.0}
IONISATION = {"N": 117225.7, "O": 109837.02, "N2": 125667.0, "O2": 97348.0, "NO": 74721.7}
MOLECULES = {"N2": (2, 0), "O2": (0, 2), "NO": (1, 1)}  # atoms of N and of O
NITROGEN_OVER_OXYGEN = 0.7808 / 0.2095
LARGEST_N = 6  # principal quantum number up to which levels of atoms count: the next are cut by the plasma


@cache
def table(name):
    """Rows of a data table as dicts; numbers are numbers."""
    with (DATA / f"{name}.csv").open(encoding="utf-8") as file:
        return tuple({key: _number(value) for key, value in row.items()} for row in csv.DictReader(file))


def _number(text):
    try:
        return float(text)
    except ValueError:
        return text


def vibrational(state, v):
    """Term value G(v) [cm-1] above the potential minimum, of a row of `states`."""
    x = v + 0.5
    signs = {"we": 1, "wexe": -1, "weye": 1, "weze": 1, "we5": 1, "we6": 1}
    return sum(sign * state[key] * x ** (power + 1) for power, (key, sign) in enumerate(signs.items()))


def bound(state):
    """Vibrational quantum numbers below the dissociation limit, as far as the term values rise."""
    v = np.arange(60)
    term = vibrational(state, v)
    falls = np.flatnonzero((np.diff(term) <= 0) | (term[1:] - term[0] > state["depth"]))
    return v[: falls[0] + 1 if falls.size else 60]


@cache
def states(molecule):
    """Electronic states of a molecule by name."""
    return {row["state"]: row for row in table("states") if row["molecule"] == molecule}


def molecule_sum(molecule, temperature):
    """Internal partition function: rotation as a classical rotor with its first quantum correction."""
    total, ground = 0.0, states(molecule)
    zero = vibrational(next(iter(ground.values())), 0)
    symmetry = 1 if molecule.startswith("NO") else 2
    for state in ground.values():
        v = bound(state)
        rotor = np.maximum(state["be"] - state["ae"] * (v + 0.5), 0.2 * state["be"])
        energy = state["te"] + vibrational(state, v) - zero
        turning = temperature[:, None] / (C2 * rotor) + 1 / 3
        # Rotation must not carry a level over the limit: the classical rotor is cut there.
        room = np.maximum(state["depth"] - vibrational(state, v) + vibrational(state, 0), 0) * 1.15
        cut = 1 - np.exp(-C2 * room / temperature[:, None])
        total = total + state["weight"] / symmetry * (
            turning * cut * np.exp(-C2 * energy / temperature[:, None])
        ).sum(axis=1)
    return total


@cache
def levels(atom):
    """Weights and energies [cm-1] of a neutral atom's levels."""
    rows = [row for row in table("levels") if row["species"] == f"{atom} I"]
    return np.array([[2 * row["j"] + 1, row["energy_per_cm"]] for row in rows]).T


# Lowest terms of the ions: weight, energy [cm-1] (NIST ASD).
ION_TERMS = {
    "N+": [
        (1, 0),
        (3, 48.7),
        (5, 130.8),
        (5, 15316.2),
        (1, 32688.8),
        (5, 46784.6),
        (15, 92244.0),
        (9, 109220.0),
    ],
    "O+": [(4, 0), (6, 26810.6), (4, 26830.6), (4, 40468.0), (2, 40470.0), (12, 119900.0)],
}


def partition(species, temperature):
    """Internal partition function of a species at temperatures (t,) [K]."""
    temperature = np.asarray(temperature, dtype=float)
    if species == "e-":
        return np.full(temperature.shape, 2.0)
    if species in ("N", "O"):
        weight, energy = levels(species)
    elif species in ION_TERMS:
        weight, energy = np.array(ION_TERMS[species], dtype=float).T
    else:
        return molecule_sum(species, temperature)
    return (weight * np.exp(-C2 * energy / temperature[:, None])).sum(axis=1)


def _free(species, temperature):
    """Logarithm of translational times internal partition function per volume [m-3]."""
    mass = MASS[species] * DALTON
    return 1.5 * np.log(2 * np.pi * mass * BOLTZMANN * temperature / PLANCK**2) + np.log(
        partition(species, temperature)
    )


def composition(temperature, pressure):
    r"""Number densities [m-3] of the eleven species of air at temperatures (t,) [K] and one pressure [Pa].

    Mass action, :math:`\prod n^\nu = \prod Q^\nu e^{-E/kT}`, with Newton's method in the logarithms of
    :math:`n_N, n_O, n_e`; from hot to cold, each from the solution before it.
    """
    temperature = np.asarray(temperature, dtype=float)
    free = {name: _free(name, temperature) for name in MASS}
    made = {}  # species: (N, O, electrons released), logarithm of the mass-action constant
    for name, (n, o) in MOLECULES.items():
        binding = C2 * DISSOCIATION[name] / temperature
        bond = free[name] - n * free["N"] - o * free["O"] + binding
        made[name] = (n, o, 0, bond)
        ion = free[f"{name}+"] - n * free["N"] - o * free["O"] + binding - C2 * IONISATION[name] / temperature
        made[f"{name}+"] = (n, o, 1, ion + free["e-"])
    for name, (n, o) in {"N": (1, 0), "O": (0, 1)}.items():
        made[name] = (n, o, 0, np.zeros_like(temperature))
        ion = free[f"{name}+"] + free["e-"] - free[name] - C2 * IONISATION[name] / temperature
        made[f"{name}+"] = (n, o, 1, ion)
    counts = np.array([one[:3] for one in made.values()], dtype=float)
    constants = np.array([one[3] for one in made.values()])
    result = np.empty((len(made) + 1, temperature.size))
    guess = np.log([0.7, 0.2, 0.1]) + np.log(pressure / (BOLTZMANN * temperature.max()))
    for index in np.argsort(-temperature):
        guess = _solve(counts, constants[:, index], pressure / (BOLTZMANN * temperature[index]), guess)
        heavy = _heavy(counts, constants[:, index], guess)
        result[:, index] = np.append(heavy, np.exp(guess[2]))
    return dict(zip([*made, "e-"], result, strict=True))


def _heavy(counts, constant, unknown):
    return np.exp(
        np.clip(
            constant + counts[:, 0] * unknown[0] + counts[:, 1] * unknown[1] - counts[:, 2] * unknown[2],
            -300,
            200,
        )
    )


def _solve(counts, constant, total, unknown):
    for _ in range(400):
        heavy, electrons = _heavy(counts, constant, unknown), np.exp(unknown[2])
        ratio = counts[:, 0] - NITROGEN_OVER_OXYGEN * counts[:, 1]
        slopes = counts * [1, 1, -1] * heavy[:, None]
        charge = counts[:, 2] @ heavy
        wrong = np.array([heavy.sum() + electrons - total, ratio @ heavy, np.log(charge / electrons) * total])
        jacobian = np.array(
            [
                slopes.sum(axis=0) + [0, 0, electrons],
                ratio @ slopes,
                (counts[:, 2] @ slopes / charge - [0, 0, 1]) * total,
            ]
        )
        step = np.linalg.solve(jacobian, wrong)
        unknown = unknown - np.clip(step, -1.5, 1.5)
        if np.abs(step).max() < 1e-11:
            return unknown
    raise ValueError(f"no equilibrium of air at {total:.3g} m-3")
