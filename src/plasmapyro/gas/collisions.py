"""Collision integrals of the eleven species of air plasma.

Every integral here is a reduced cross-section, Q(l,s) = pi sigma^2 Omega(l,s)* [m2], in the convention
in which it equals pi sigma^2 for rigid spheres. The tables hold Q/pi.
"""

from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from scipy.interpolate import PchipInterpolator

from plasmapyro import tables
from plasmapyro.constants import BOLTZMANN, ELEMENTARY_CHARGE, VACUUM_PERMITTIVITY
from plasmapyro.gas.species import CHARGE, ELECTRON, IONS, NEUTRALS, SPECIES

NEUTRAL_BSTAR, NEUTRAL_CSTAR = 1.15, 0.92
ION_NEUTRAL_BSTAR, ION_NEUTRAL_CSTAR = 1.20, 0.85
"""B* and C* of heavy pairs. ASSUME: constants, as recommended by Wright et al. (2005)."""


@dataclass(frozen=True)
class HeavyIntegrals:
    """Pairs of heavy species: Q11, Q22 [m2], A*, B* and C* [1], each (points, 10, 10)."""

    q11: np.ndarray
    q22: np.ndarray
    astar: np.ndarray
    bstar: np.ndarray
    cstar: np.ndarray


@dataclass(frozen=True)
class ElectronIntegrals:
    """Electrons with heavy species (points, 10) and with electrons (points,), all [m2]."""

    q11: np.ndarray
    q12: np.ndarray
    q13: np.ndarray
    q14: np.ndarray
    q15: np.ndarray
    q22_electrons: np.ndarray
    q23_electrons: np.ndarray
    q24_electrons: np.ndarray


def _curves(abscissa, ordinates):
    """Monotone cubics (points, columns) in (ln x, ln y), continued by their end tangents as power laws."""
    x, y = np.log(abscissa), np.log(ordinates)
    inside = PchipInterpolator(x, y)
    slope = inside.derivative()
    edges = [(x[k], y[k], slope(x[k])) for k in (0, -1)]

    def evaluate(value):
        at = np.log(value)[:, None]
        result = inside(np.clip(at[:, 0], x[0], x[-1]))
        for (edge, level, tangent), out in zip(edges, (at < x[0], at > x[-1]), strict=True):
            if out.any():
                result = np.where(out, level + tangent * (at - edge), result)
        return np.exp(result)

    return evaluate


@cache
def _pair_curves(name):
    """Pairs of one table of `data/gas` by the temperatures they are given at: (first, second, curves).

    Numbers of the species (pairs,), and function temperature (points,) -> columns of the table as
    (columns, points, pairs).
    """
    table = tables.load(f"gas/{name}")
    columns = [c for c in table.columns if c not in ("first", "second", "temperature", "uncertainty")]
    groups = {}
    for pair in dict.fromkeys(zip(table["first"], table["second"], strict=True)):
        rows = (table["first"] == pair[0]) & (table["second"] == pair[1])
        groups.setdefault(tuple(table["temperature"][rows]), {})[pair] = [table[c][rows] for c in columns]
    found = []
    for temperature, pairs in groups.items():
        first, second = np.array([[SPECIES.index(one) for one in pair] for pair in pairs]).T
        values = np.transpose(list(pairs.values()), (2, 1, 0))  # temperature, column, pair
        curves = _curves(temperature, values.reshape(len(temperature), -1))
        found.append((first, second, partial(_by_column, curves, values.shape[1:])))
    return found


def _by_column(curves, shape, temperature):
    return np.moveaxis(curves(temperature).reshape(-1, *shape), 1, 0)


@cache
def _coulomb_curves(kind):
    """Names, and curves of T*^2 Q/(pi lambda_D^2) in ln T*, for attractive or repulsive pairs."""
    table = tables.load("gas/collisions_coulomb")
    rows = table["kind"] == kind
    reduced = np.log(table["reduced_temperature"][rows])
    values = {name: table[f"reduced_omega{name}"][rows] for name in ("11", "22", "14", "15", "24")}
    bstar, cstar, estar = (table[name][rows] for name in ("bstar", "cstar", "estar"))
    values["12"] = cstar * values["11"]
    values["13"] = (5 * cstar - bstar) / 4 * values["11"]
    values["23"] = estar * values["22"]
    return tuple(values), _logarithmic_curves(reduced, np.transpose(list(values.values())))


def _logarithmic_curves(x, y):
    """Monotone cubics (..., columns) in ln T*, continued by straight lines (the Coulomb logarithm)."""
    inside = PchipInterpolator(x, y)
    tangent = (y[-1] - y[-2]) / (x[-1] - x[-2])

    def evaluate(at):
        return inside(np.clip(at, x[0], x[-1])) + tangent * np.maximum(at - x[-1], 0)[..., None]

    return evaluate


def debye_length(temperature, electron_density):
    r"""Debye length [m] with electrons and ions screening; temperature [K], electron density [m-3] > 0.

    .. math:: \lambda_D = \sqrt{\frac{\epsilon_0 k T}{2 n_e e^2}}

    Source: Mason, Munn & Smith, Phys. Fluids 10 (1967) 1827. ASSUME: ions screen like electrons (singly
    charged, same temperature), as in Mutation++.
    """
    energy = VACUUM_PERMITTIVITY * BOLTZMANN * temperature
    return np.sqrt(energy / (2 * electron_density * ELEMENTARY_CHARGE**2))


def coulomb_integrals(kind, temperature, electron_density):
    r"""Collision integrals of the screened Coulomb potential.

    With :math:`T^* = \lambda_D/b`, :math:`b = e^2/(4\pi\epsilon_0 kT)`, the table holds
    :math:`T^{*2} Q^{(l,s)}/\pi\lambda_D^2`, so that :math:`Q = \pi b^2 \times` table. Below the table
    (T* < 0.1, denser than any state here) its first entry is used, above it the logarithm continues.

    Source: Mason, Munn & Smith (1967) and Devoto (1973), see `data/gas/collisions_coulomb.yml`.
    Q12 = C* Q11, Q13 = (5 C* - B*) Q11 / 4 and Q23 = E* Q22 by definition of B*, C*, E*.

    Parameters
    ----------
    kind : {"attractive", "repulsive"}
    temperature : ndarray [K]
    electron_density : ndarray [m-3]
        > 0.

    Returns
    -------
    dict of ndarray [m2]
        Q(l,s), keys "11", "12", "13", "14", "15", "22", "23", "24".
    """
    distance = ELEMENTARY_CHARGE**2 / (4 * np.pi * VACUUM_PERMITTIVITY * BOLTZMANN * temperature)
    reduced = np.log(debye_length(temperature, electron_density) / distance)
    names, curves = _coulomb_curves(kind)
    values = np.moveaxis(np.pi * distance[..., None] ** 2 * curves(reduced), -1, 0)
    return dict(zip(names, values, strict=True))


def heavy_integrals(temperature, electron_density):
    """Collision integrals of all pairs of heavy species, at temperatures (points,) [K].

    Source: neutral pairs Wright et al. (2005), ion-neutral Levin & Wright (2004), ion-ion
    `coulomb_integrals`. ASSUME: beyond the ends of a table a power law with the end's slope.
    """
    size = ELECTRON
    shape = (temperature.size, size, size)
    q11, q22 = np.empty(shape), np.empty(shape)
    bstar, cstar = np.full(shape, NEUTRAL_BSTAR), np.full(shape, NEUTRAL_CSTAR)
    for table in ("collisions_neutral", "collisions_ion_neutral"):
        for i, k, curves in _pair_curves(table):
            omega11, omega22 = curves(temperature)
            q11[:, i, k] = q11[:, k, i] = np.pi * omega11
            q22[:, i, k] = q22[:, k, i] = np.pi * omega22
    ions = slice(len(NEUTRALS), len(NEUTRALS) + len(IONS))
    neutral = slice(0, len(NEUTRALS))
    bstar[:, ions, neutral] = bstar[:, neutral, ions] = ION_NEUTRAL_BSTAR
    cstar[:, ions, neutral] = cstar[:, neutral, ions] = ION_NEUTRAL_CSTAR
    charged = coulomb_integrals("repulsive", temperature, electron_density)
    q11[:, ions, ions] = charged["11"][:, None, None]
    q22[:, ions, ions] = charged["22"][:, None, None]
    bstar[:, ions, ions] = ((5 * charged["12"] - 4 * charged["13"]) / charged["11"])[:, None, None]
    cstar[:, ions, ions] = (charged["12"] / charged["11"])[:, None, None]
    return HeavyIntegrals(q11, q22, q22 / q11, bstar, cstar)


def electron_integrals(temperature, electron_density):
    """Collision integrals of electrons with every species, at temperatures (points,) [K].

    Source: neutrals Wright et al. (2005), charged `coulomb_integrals`. ASSUME: Q14 = Q15 = Q13 for neutrals,
    for which no B*, C* of higher order are published (Magin & Degrez 2004).
    """
    values = {name: np.empty((temperature.size, ELECTRON)) for name in ("11", "12", "13", "14", "15")}
    for i, _, curves in _pair_curves("collisions_electron_neutral"):
        omega11, _, bstar, cstar = curves(temperature)
        q11 = np.pi * omega11
        values["11"][:, i] = q11
        values["12"][:, i] = cstar * q11
        for name in ("13", "14", "15"):
            values[name][:, i] = (5 * cstar - bstar) / 4 * q11
    attractive = coulomb_integrals("attractive", temperature, electron_density)
    for name, array in values.items():
        array[:, CHARGE[:ELECTRON] > 0] = attractive[name][:, None]
    repulsive = coulomb_integrals("repulsive", temperature, electron_density)
    return ElectronIntegrals(
        *(values[name] for name in ("11", "12", "13", "14", "15")),
        *(repulsive[name] for name in ("22", "23", "24")),
    )
