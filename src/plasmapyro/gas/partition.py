"""Internal partition functions of the species of air, carbon, argon and silicon from their levels."""

from functools import cache

import numpy as np
from numpy.polynomial import Chebyshev

from plasmapyro import tables
from plasmapyro.checks import positive
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.gas.species import SPECIES, TRACES

ATOMS = ("N", "O", "N+", "O+", "C", "C+", "Ar", "Ar+", "Si")
HOMONUCLEAR = ("N2", "O2", "N2+", "O2+", "C2")
DIATOMIC_TABLES = {
    "N2": ("gas/diatomic_nitrogen",),
    "N2+": ("gas/diatomic_nitrogen", "gas/diatomic_ion_excited"),
    "O2": ("gas/diatomic_oxygen",),
    "O2+": ("gas/diatomic_oxygen", "gas/diatomic_ion_excited"),
    "NO": ("gas/diatomic_oxygen",),
    "NO+": ("gas/diatomic_oxygen",),
    "CN": ("gas/diatomic_carbon",),
    "C2": ("gas/diatomic_carbon",),
}
# Columns of the tables, with the signs of their terms as printed.
VIBRATION = {"we": 1, "wexe": -1, "weye": 1, "weze": 1, "weae": 1}
ROTATION = {"be": 1, "alphae": -1, "gammae": 1, "deltae": 1, "epsilone": 1}
ODD_ONLY = ("X3Sigma_g-",)  # 16O2 has no nuclear spin: its ground state has odd rotation only
HIGHEST_VIBRATION = 100
HIGHEST_ROTATION = 400
BLOCK = 2_000_000  # elements of one block of exponentials, 16 MB
# ln Q of more temperatures than so many is a polynomial in ln T, 1e-12 from the sum over 200 to 15000 K.
MANY, DEGREE, COLDEST = 100, 48, 200.0


def partition_function(species, temperature):
    r"""Internal partition function, :math:`Q = \sum_i g_i \exp(-E_i/kT)`.

    Energies count from the lowest level of the species. Weights hold electron spin and rotation; the
    nuclear-spin weight is divided by the total nuclear degeneracy, so that a homonuclear diatomic
    approaches :math:`kT/2B` and a heteronuclear one :math:`kT/B` times its electronic weight.

    Source: levels as `atomic_levels` and `diatomic_levels`. Against the level sums behind NASA-9 (those of
    `equilibrium.composition`): within 0.5 % to 6000 K. Above, the states left out or estimated tell: at 8000
    and 10000 K N2+ is 1.3 and 2.3 % low, O2+ 0.4 and 1.6 %, all others below 1.2 %; at 15000 K NO and O2+ are
    7.5 % low, N2+ is 4.6 % high. CN and C2 agree with the sums behind NASA-7 within 0.3 and 1.3 % to 6000 K.

    ValueError: unknown species, or temperature not > 0.

    Parameters
    ----------
    species : str
        A name in `species.SPECIES` or `species.TRACES`.
    temperature : array_like [K]
        > 0; the level lists serve to 15000 K.

    Returns
    -------
    ndarray [1]
        Shape of `temperature`.
    """
    if species not in SPECIES + TRACES:
        raise ValueError(f"species must be one of {', '.join(SPECIES + TRACES)}; got {species!r}")
    temperature = positive("temperature", temperature, "K")
    if species == "e-":
        return np.full(temperature.shape, 2.0)
    if temperature.size <= MANY or temperature.min() < COLDEST or not np.ptp(temperature):
        return _sum_of_levels(species, temperature.ravel()).reshape(temperature.shape)
    ends = np.log([temperature.min(), temperature.max()])
    smooth = Chebyshev.interpolate(lambda x: np.log(_sum_of_levels(species, np.exp(x))), DEGREE, ends)
    return np.exp(smooth(np.log(temperature)))


def _sum_of_levels(species, temperature):
    """Partition function at each temperature (n,), level by level."""
    energy, weight = atomic_levels(species) if species in ATOMS else diatomic_levels(species)
    inverse = SECOND_RADIATION / temperature
    total = np.zeros(inverse.shape)
    step = max(1, BLOCK // max(1, inverse.size))
    for first in range(0, energy.size, step):
        part = slice(first, first + step)
        total += np.exp(-inverse[:, None] * energy[part]) @ weight[part]
    return total


def two_temperature_partition_function(species, temperature, excitation_temperature):
    r"""Internal partition function with rotation at one temperature and all else at another.

    .. math:: Q = \sum_i g_i \exp\left(-\frac{E_{ve,i}}{kT_{ve}} - \frac{E_{rot,i}}{kT}\right)

    :math:`E_{rot}` is the energy of a level above the rotationless vibronic level it belongs to, spin
    splitting included; atoms have none, and the temperature does not matter to them.

    Source: C. Park, Nonequilibrium Hypersonic Aerothermodynamics (1990), section 1.3, for the two
    temperatures; levels as `partition_function`.

    ValueError: unknown species, or a temperature not > 0.

    Parameters
    ----------
    species : str
        A name in `species.SPECIES` or `species.TRACES`.
    temperature : float [K]
        Of translation and rotation, > 0.
    excitation_temperature : float [K]
        Of vibration and electronic excitation, > 0.

    Returns
    -------
    float [1]
        At equal temperatures that of `partition_function`.
    """
    if species not in SPECIES + TRACES:
        raise ValueError(f"species must be one of {', '.join(SPECIES + TRACES)}; got {species!r}")
    temperature = positive("temperature", temperature, "K")
    excitation_temperature = positive("excitation_temperature", excitation_temperature, "K")
    if species == "e-":
        return 2.0
    if species in ATOMS:
        return float(partition_function(species, excitation_temperature))
    energy, weight = diatomic_levels(species)
    rotation = diatomic_rotation_energy(species)
    exponent = (energy - rotation) / excitation_temperature + rotation / temperature
    return float(np.sum(np.exp(-SECOND_RADIATION * exponent) * weight))


@cache
def atomic_levels(species):
    """Energies [m-1] above the ground level and degeneracies [1] of the levels of one of `ATOMS`.

    Source: NIST Atomic Spectra Database, see `data/gas/levels_*.yml`. ASSUME: the sum ends with the levels
    observed (n about 12 for N, 19 for O), those above the ionisation limit included; the Rydberg levels
    beyond, up to the cut-off by the plasma (n about 40 at 50 mbar), would add 0.6 % to Q of N at 10000 K.
    """
    table = tables.load("gas/levels_" + species.replace("+", "_plus"))
    return _sealed(table["energy"], table["degeneracy"])


def diatomic_levels(species):
    r"""Rovibronic levels of a diatomic species, one of `DIATOMIC_TABLES`.

    .. math:: E = T + A\Lambda\Sigma + G(v) + B_v F - D F^2, \qquad D = 4 B_e^3/\omega_e^2

    with :math:`F = J(J+1) - \Omega^2` where :math:`\Lambda > 0` (Hund's case a), else :math:`F = N(N+1)`.

    Source: Herzberg, Spectra of Diatomic Molecules (1950), chapters III and V; constants of Laher & Gilmore
    (1991) and Huber & Herzberg (1979), see `data/gas/diatomic_*.yml`. T counts from the lower component of a
    ground state split by spin and orbit (X2Pi1/2 of NO and O2+). ASSUME: quasi-bound levels count up to the
    centrifugal barrier of a Morse potential of the same depth (they live long enough to take part). ASSUME:
    multiplets split by spin-orbit interaction only, Sigma states not at all; nuclear-spin alternation
    averages out above 100 K, except that the ground state of O2 has odd rotation only.

    Returns
    -------
    tuple of ndarray
        Energy [m-1] above the lowest level, and statistical weight [1].
    """
    energy, weight, _ = _diatomic_levels(species)
    return energy, weight


def diatomic_rotation_energy(species):
    """Part of the energies of `diatomic_levels` above the rotationless vibronic level [m-1], same order.

    Spin splitting counts as rotation, so that a level below the centre of its multiplet has a negative part.
    """
    return _diatomic_levels(species)[2]


@cache
def _diatomic_levels(species):
    """Energy, weight and rotational part of the energy of the levels of a diatomic species."""
    states = [state for name in DIATOMIC_TABLES[species] for state in _states(name, species)]
    # All energies relative to v = 0 of the ground state, without its rotation and spin splitting.
    parts = zip(*(_state_levels(state, states[0], species) for state in states), strict=True)
    energy, weight, rotation = (np.concatenate(part) for part in parts)
    return _sealed(energy - energy.min(), weight, rotation)


def _states(name, species):
    """Electronic states of a species in a table, as dicts of its columns."""
    table = tables.load(name)
    rows = np.flatnonzero(table["species"] == species)
    return [{key: column[row] for key, column in table.columns.items()} for row in rows]


def _vibration(state, v):
    """G(v) [m-1]."""
    return _series(state, VIBRATION, v, 1)


def _series(state, signs, v, first):
    """Sum of the terms of a state in powers of v + 1/2, the lowest of which is `first` [m-1]."""
    terms = enumerate(signs.items(), start=first)
    return sum(sign * state.get(name, 0.0) * (v + 0.5) ** power for power, (name, sign) in terms)


def _state_levels(state, ground, species):
    """Energies [m-1], weights and rotational parts of the energies [m-1] of one electronic state."""
    v = np.arange(HIGHEST_VIBRATION)
    vibration, rotation = _vibration(state, v), _series(state, ROTATION, v, 0)
    if "origin" in state:
        band = state["origin"] + vibration - vibration[0]
    else:
        band = state["minimum"] + vibration - _vibration(ground, 0)
    if state is not ground:
        spin = (ground["multiplicity"] - 1) / 2
        band = band - abs(ground["spin_orbit"]) * ground["lambda"] * spin
    rising = np.diff(vibration, prepend=-np.inf) > 0
    bound = np.logical_and.accumulate(rising & (rotation > 0) & (band < state["limit"]))
    band, rotation = band[bound, None], rotation[bound, None]
    stretching = 4 * state["be"] ** 3 / state["we"] ** 2
    depth = state["limit"] - band[0, 0] + vibration[0]
    spin = (state["multiplicity"] - 1) / 2
    symmetry = 2 if species in HOMONUCLEAR else 1
    energies, weights, rotations = [], [], []
    for projection in np.arange(-spin, spin + 1):
        if state["lambda"] == 0:
            j = np.arange(HIGHEST_ROTATION, dtype=float)
            offset, degeneracy = 0.0, 2 * j + 1
            if state["state"] in ODD_ONLY:
                degeneracy = symmetry * degeneracy * (j % 2)
        else:
            omega = abs(state["lambda"] + projection)
            j = omega + np.arange(HIGHEST_ROTATION)
            offset, degeneracy = omega**2, 2 * (2 * j + 1)
        turns = j * (j + 1) - offset
        energy = band + rotation * turns - stretching * turns**2
        energy = energy + state["spin_orbit"] * state["lambda"] * projection
        barrier = state["limit"] - depth + _barrier(state["we"], state["be"], depth, np.maximum(turns, 0))
        kept = (np.diff(energy, axis=1, prepend=-np.inf) > 0) & (energy < barrier) & (degeneracy > 0)
        energies.append(energy[kept])
        weights.append(np.broadcast_to(degeneracy / symmetry, energy.shape)[kept])
        rotations.append((energy - band)[kept])
    return np.concatenate(energies), np.concatenate(weights), np.concatenate(rotations)


def _barrier(we, be, depth, turns):
    """Largest energy [m-1], from the bottom, that the rotating Morse oscillator of `depth` still holds."""
    distance = np.linspace(1.0, 8.0, 400)[:, None]  # in units of the equilibrium distance
    steepness = we / (2 * np.sqrt(be * depth))
    morse = depth * (1 - np.exp(-steepness * (distance - 1))) ** 2
    effective = morse + be * turns / distance**2
    # The maximum beyond the well; where no well is left the curve only falls and nothing is held.
    well = np.argmin(np.where(np.diff(effective, axis=0) > 0, 0, 1), axis=0)
    beyond = np.where(np.arange(distance.size)[:, None] >= well, effective, -np.inf).max(axis=0)
    held = (np.diff(effective, axis=0) > 0).any(axis=0)
    return np.where(held, beyond, -np.inf)


def _sealed(*arrays):
    """The arrays, made read-only since they are cached."""
    for array in arrays:
        array.flags.writeable = False
    return arrays
