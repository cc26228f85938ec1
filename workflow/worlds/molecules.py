"""Band systems: own vibrational functions, own eigenvectors between Hund's cases (a) and (b), Boltzmann
populations.

N2 first positive: moments of Chauveau et al. (2002). N2+ Meinel: an ab initio moment (see its certificate)
between vibrational functions in Hulburt-Hirschfelder potentials. NO D-A, 3p-3s of an electron around NO+:
the Coulomb approximation of Bates and Damgaard (1949) for the moment, the same potentials for its Franck-
Condon factors.
"""

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.integrate import quad
from scipy.special import hyperu

from worlds.angular import three_j_square_root
from worlds.gas import C2, DALTON, LIGHT, MASS, PLANCK, RYDBERG, bound, states, table, vibrational

SYSTEMS = {
    "N2 1P": ("N2", "B3Pg", "A3Su"),
    "N2+ Meinel": ("N2+", "A2Pu", "X2Sg"),
    "NO 11000 A": ("NO", "D2S", "A2S"),
}
# Share of the nuclear spins in lower levels of even and odd N: 14N has I = 1.
SPINS = {"N2 1P": (1 / 3, 2 / 3), "N2+ Meinel": (2 / 3, 1 / 3), "NO 11000 A": (1.0, 1.0)}
SPIN_SPIN = {"A3Su": -1.33}  # lambda [cm-1], Huber and Herzberg (1979)
HIGHEST = {"N2 1P": 18, "N2+ Meinel": 14, "NO 11000 A": 5}  # v of the upper state
MOST_J, FAINT = 150, 1e-4
MOMENT = 2.0261e-6  # A [s-1] = MOMENT sigma^3 [cm-3] R^2 [(e a0)^2]; Whiting et al. (1980)


@dataclass(frozen=True)
class Bands:
    """Rotational lines: wavenumber and energies [cm-1] above the ground level, `strength` = weight times A
    [s-1]."""

    wavenumber: np.ndarray
    strength: np.ndarray
    vibration: np.ndarray  # energy of the upper level without rotation, with its electronic part
    rotation: np.ndarray
    upper: np.ndarray  # v of the upper state


def hulburt_hirschfelder(state, distance, reduced):
    r"""Potential [cm-1] at distances [angstrom] (Hulburt and Hirschfelder, J. Chem. Phys. 9 (1941) 61).

    .. math:: U = D\left[(1-e^{-x})^2 + c x^3 e^{-2x}(1 + b x)\right], \quad x = \frac{\omega_e}{2\sqrt{B_e
    D}} \frac{r - r_e}{r_e}
    """
    be = PLANCK / (8 * np.pi**2 * LIGHT * reduced * DALTON * (state["re_angstrom"] * 1e-10) ** 2) / 100
    depth = (
        state["we"] ** 2 / (4 * state["wexe"])
        if state["depth"] < 1.7e4
        else state["depth"] + vibrational(state, 0)
    )
    a1 = -1 - state["ae"] * state["we"] / (6 * be**2)
    a2 = 1.25 * a1**2 - 2 * state["wexe"] / (3 * be)
    a0 = state["we"] ** 2 / (4 * be)
    root = np.sqrt(depth / a0)
    c = 1 + a1 * root
    b = 2 - (7 / 12 - depth * a2 / a0) / c
    x = state["we"] / (2 * np.sqrt(be * depth)) * (distance / state["re_angstrom"] - 1)
    return depth * ((1 - np.exp(-x)) ** 2 + c * x**3 * np.exp(-2 * x) * (1 + b * x))


@cache
def vibrations(molecule, name, count):
    """Grid [angstrom] and vibrational functions (count, r) of a state, by Colbert and Miller's (1992) DVR."""
    state, step = states(molecule)[name], 0.006
    reduced = MASS["N"] / 2 if molecule.startswith("N2") else MASS["N"] * MASS["O"] / (MASS["N"] + MASS["O"])
    distance = np.arange(0.80, 2.10, step)
    kinetic = PLANCK / (8 * np.pi**2 * LIGHT * reduced * DALTON * (step * 1e-10) ** 2) / 100
    apart = np.subtract.outer(np.arange(distance.size), np.arange(distance.size))
    with np.errstate(divide="ignore"):
        energy = kinetic * (-1.0) ** apart * np.where(apart == 0, np.pi**2 / 3, 2 / apart**2.0)
    energy += np.diag(np.minimum(hulburt_hirschfelder(state, distance, reduced), 2e5))
    return distance, np.linalg.eigh(energy)[1].T[:count]


@cache
def coulomb_moment(upper, lower):
    """Radial moment [a0] of np -> ns with effective quantum numbers, Coulomb functions cut at small radii."""

    def wave(n, orbital, r):
        return (
            np.exp(-r / n)
            * (2 * r / n) ** (orbital + 1)
            * hyperu(orbital + 1 - n, 2 * orbital + 2, 2 * r / n)
        )

    begin = 0.6  # [a0]: within the core the asymptotic functions are not used
    norm = [quad(lambda r, n=n, o=o: wave(n, o, r) ** 2, begin, 80)[0] for n, o in ((upper, 1), (lower, 0))]
    mixed = quad(lambda r: wave(upper, 1, r) * wave(lower, 0, r) * r, begin, 80)[0]
    return abs(mixed) / np.sqrt(norm[0] * norm[1])


@cache
def moments(system):
    """Moments (v', v'') [e a0] of a band system."""
    if system == "N2 1P":
        result = np.zeros((19, 18))
        for row in table("first_positive_moment"):
            result[int(row["v_upper"]), int(row["v_lower"])] = row["moment_e_a0"]
        return result
    molecule, upper, lower = SYSTEMS[system]
    distance, high = vibrations(molecule, upper, HIGHEST[system] + 1)
    low = vibrations(molecule, lower, 14)[1]
    if system == "N2+ Meinel":
        rows = table("meinel_moment")
        moment = np.interp(distance, [r["distance_angstrom"] for r in rows], [r["moment_e_a0"] for r in rows])
    else:
        numbers = [np.sqrt(RYDBERG / (74721.7 - energy)) for energy in (53084.7 + 209.3, 43965.7 + 234.2)]
        moment = coulomb_moment(*numbers) / np.sqrt(3) * np.ones(distance.size)
    return np.abs((high * moment) @ low.T)


class Levels(NamedTuple):
    """Rotational levels of one v: energies (j, i) [cm-1] without the vibrational part, vectors
    (j, Omega, i), Omega, and whether there is such a level."""

    j: np.ndarray
    value: np.ndarray
    vector: np.ndarray
    omega: np.ndarray
    real: np.ndarray

    def at(self, rows):
        """Those of some J."""
        return Levels(self.j[rows], self.value[rows], self.vector[rows], self.omega, self.real[rows])


def _terms(state, v, j):
    """`Levels` from the operator N^2."""
    spin, lam = (state["multiplicity"] - 1) / 2, state["lambda"]
    sigma = np.arange(-spin, spin + 1)
    omega = lam + sigma
    b = state["be"] - state["ae"] * (v + 0.5)
    square = j[:, None] * (j[:, None] + 1)
    n2 = np.zeros((j.size, sigma.size, sigma.size))
    for k in range(sigma.size):
        n2[:, k, k] = square[:, 0] - omega[k] ** 2 + spin * (spin + 1) - sigma[k] ** 2 + lam**2
        if k:
            n2[:, k, k - 1] = n2[:, k - 1, k] = -np.sqrt(
                np.maximum(square[:, 0] - omega[k] * omega[k - 1], 0)
                * (spin * (spin + 1) - sigma[k] * sigma[k - 1])
            )
    energy = b * n2 - state["de"] * n2 @ n2
    fine = state["spin_orbit"] * lam * sigma + 2 / 3 * SPIN_SPIN.get(state["state"], 0) * (
        3 * sigma**2 - spin * (spin + 1)
    )
    energy += np.diag(fine)
    missing = np.abs(omega)[None, :] > j[:, None]  # no such component at this J: out of the way
    energy[:, np.arange(sigma.size), np.arange(sigma.size)] += np.where(missing, 1e7, 0.0)
    value, vector = np.linalg.eigh(energy)
    return Levels(j, value, np.where(missing[:, :, None], 0.0, vector), omega, value < 5e6)


def amplitudes(upper, lower):
    """Amplitudes (j, i, k) between `Levels`; (2J''+1) times their squares add up to 1 over J'' and k."""
    total, q = 0.0, int(upper.omega[0] - lower.omega[0])
    for k in range(upper.omega.size):  # the spin looks on: Sigma stays
        element = three_j_square_root(upper.j, upper.omega[k], lower.j, q)
        total = total + upper.vector[:, k, :, None] * lower.vector[:, k, None, :] * element[:, None, None]
    return total


@cache
def lines(system):
    """All rotational lines of a system between 650 and 1250 nm."""
    molecule, upper, lower = SYSTEMS[system]
    high, low, moment = states(molecule)[upper], states(molecule)[lower], moments(system)
    zero = vibrational(next(iter(states(molecule).values())), 0)
    j = np.arange(MOST_J) + (high["multiplicity"] - 1) / 2 % 1
    found = []
    for v in range(min(HIGHEST[system], bound(high)[-1]) + 1):
        above = _terms(high, v, j)
        for w in range(min(moment.shape[1], bound(low)[-1] + 1)):
            origin = high["te"] + vibrational(high, v) - low["te"] - vibrational(low, w)
            if not 7500 < origin < 16500 or moment[v, w] == 0:
                continue
            below = _terms(low, w, j)
            for step in (-1, 0, 1):
                rows = slice(max(0, -step), j.size - max(0, step))
                partner = slice(rows.start + step, rows.stop + step)
                pair = above.at(rows), below.at(partner)
                found.append(_branch(system, high, v, zero, origin, moment[v, w], *pair))
    parts = [np.concatenate(part) for part in zip(*found, strict=True)]
    kept = parts[1] * np.exp(-C2 * (parts[2] + parts[3] - high["te"]) / 9000) > FAINT * 1e3
    return Bands(*(part[kept] for part in parts))


def _branch(system, high, v, zero, origin, moment, upper, lower):
    """Lines of one change of J: arrays (wavenumber, strength, vibration, rotation, v)."""
    amplitude = amplitudes(upper, lower)
    wavenumber = origin + upper.value[:, :, None] - lower.value[:, None, :]
    share = (2 * lower.j + 1)[:, None, None] * amplitude**2
    n = np.rint(lower.j[:, None] - (lower.omega.size - 1) / 2 + np.arange(lower.omega.size)).astype(int)
    spins = np.where(n % 2 == 0, *SPINS[system])[:, None, :]
    doubling = 2 if high["lambda"] > 0 else 1
    probability = MOMENT * np.maximum(wavenumber, 0) ** 3 * moment**2
    strength = (2 * upper.j + 1)[:, None, None] * doubling * spins * share * probability
    use = upper.real[:, :, None] & lower.real[:, None, :] & (wavenumber > 8000) & (wavenumber < 15385)
    use &= upper.value[:, :, None] + vibrational(high, v) < high["depth"] + vibrational(high, 0)
    vibration = high["te"] + vibrational(high, v) - zero + 0 * wavenumber
    return (
        wavenumber[use],
        strength[use],
        vibration[use],
        np.broadcast_to(upper.value[:, :, None], wavenumber.shape)[use],
        np.full(use.sum(), v),
    )


def strengths(system, temperature, factor, vibration=1.0):
    """Power of each line per molecule over the partition sum [W sr-1]; `factor` per upper v, `vibration` the
    vibrational temperature over that of the gas."""
    found = lines(system)
    ground = states(SYSTEMS[system][0])[SYSTEMS[system][1]]["te"]
    boltzmann = ground + (found.vibration - ground) / vibration + found.rotation
    return (
        1.98644586e-23
        / (4 * np.pi)
        * factor[found.upper.astype(int)]
        * found.wavenumber
        * found.strength
        * np.exp(-C2 * boltzmann / temperature)
    )
