"""Continuous absorption of air plasma: free electrons at ions and neutrals, and photoionisation.

Every function gives an absorption coefficient with stimulated emission counted as negative absorption;
the emission coefficient is that times the black body (Kirchhoff), the gas being in equilibrium. Arguments
are wavenumbers (W,) [m-1], the temperature [K], number densities [m-3] and partition functions [1] of atoms.
"""

import re
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import kve

from plasmapyro import tables
from plasmapyro.constants import BOLTZMANN, ELECTRON_MASS, LIGHT_SPEED, PLANCK, RYDBERG, SECOND_RADIATION
from plasmapyro.radiation.atoms import ATOMS
from plasmapyro.radiation.broadening import COULOMB_SQUARE
from plasmapyro.radiation.opacity import boltzmann_population

IONISATION_TEMPERATURE = RYDBERG * SECOND_RADIATION  # [K], Rydberg energy over k
LARGEST_THRESHOLD_SHIFT = 2.2e5  # [m-1] = 0.02 Ry; calculated and observed term are the same up to here
TABLES = {"N": "nitrogen", "O": "oxygen"}
# [m-1], O- 2P3/2 to O 3P2, and fine structure of O- 2P (D. M. Neumark et al., Phys. Rev. A 32 (1985) 1890)
ELECTRON_AFFINITY = 1178464.5
NEGATIVE_ION_SPLITTING = 17713.0


def _photon_ratio(wavenumber, temperature):
    return SECOND_RADIATION * wavenumber / temperature


def _interpolator(axes, values, **options):
    from scipy.interpolate import RegularGridInterpolator  # 0.4 s, which light from a table does not cost

    return RegularGridInterpolator(axes, values, **options)


@cache
def _gaunt_table():
    table = tables.load("radiation/gaunt_free_free")
    gamma, ratio = np.unique(table["gamma_squared"]), np.unique(table["photon_ratio"])
    values = table["gaunt_factor"].reshape(len(gamma), len(ratio))
    return _interpolator((np.log(gamma), np.log(ratio)), values)


def gaunt_factor(wavenumber, temperature):
    """Maxwell-averaged free-free Gaunt factor (W,) [1] of a unit charge, at wavenumbers (W,) [m-1].

    160-39000 K; h nu / k T within 0.1-1000, ValueError outside; interpolated in the logarithms of both.
    Source: de Avillez and Breitschwerdt, Astron. Astrophys. 580 (2015) A124.
    """
    ratio = _photon_ratio(wavenumber, temperature)
    gamma = np.full_like(ratio, IONISATION_TEMPERATURE / temperature)
    return _gaunt_table()(np.column_stack([np.log(gamma), np.log(ratio)]))


def electron_ion_absorption(wavenumber, temperature, electron_density, ion_density):
    r"""Free-free absorption (W,) [m-1] of electrons at singly charged ions of all kinds together.

    .. math:: \kappa = \frac43 \sqrt{\frac{2\pi}{3 m k T}}\,
              \left(\frac{e^2}{4\pi\varepsilon_0}\right)^3
              \frac{n_e n_i\, g_{ff}}{m\, h\, c\, \nu^3} \left(1 - e^{-h\nu/kT}\right)

    Source: Rybicki and Lightman, Radiative Processes in Astrophysics, eq. 5.18a, in SI.
    """
    ratio = _photon_ratio(wavenumber, temperature)
    front = 4 / 3 * np.sqrt(2 * np.pi / (3 * ELECTRON_MASS * BOLTZMANN * temperature)) * COULOMB_SQUARE**3
    frequency = LIGHT_SPEED * wavenumber
    density = electron_density * ion_density * gaunt_factor(wavenumber, temperature)
    return front * density / (ELECTRON_MASS * PLANCK * LIGHT_SPEED * frequency**3) * -np.expm1(-ratio)


@cache
def _neutral_table(species):
    table = tables.load(f"radiation/free_free_{TABLES[species]}")
    temperature, wavelength = np.unique(table["temperature"]), np.unique(table["wavelength"])
    values = table["coefficient"].reshape(len(temperature), len(wavelength))
    return _interpolator(
        (np.log(temperature), np.log(wavelength)), np.log(values), bounds_error=False, fill_value=None
    )


def electron_atom_absorption(species, wavenumber, temperature, electron_density, atom_density):
    r"""Free-free absorption (W,) [m-1] of electrons at nitrogen or oxygen atoms, `species` 'N' or 'O'.

    .. math:: \kappa = k_{ff}(T, \lambda)\; n_{atom}\; n_e k T

    Linear in the logarithms of temperature, wavelength and coefficient. Source: Ramsbottom, Bell and
    Berrington, J. Phys. B 25 (1992) 1443 (N); John, Mon. Not. R. Astron. Soc. 172 (1975) 305 (O). The tables
    hold stimulated emission already. ASSUME: beyond their temperatures (N 1800-12600 K, O 1000-15000 K) the
    power law of the last interval goes on: below them there are no free electrons, above them the ions rule.
    """
    points = np.column_stack([np.full_like(wavenumber, np.log(temperature)), -np.log(wavenumber)])
    coefficient = np.exp(_neutral_table(species)(points))
    return coefficient * atom_density * electron_density * BOLTZMANN * temperature


@cache
def _molecule_cross_section():
    table = tables.load("gas/collisions_electron_neutral")
    mine = (table["first"] == "N2") | (table["second"] == "N2")
    return np.log(table["temperature"][mine]), np.pi * table["omega11"][mine]


def electron_nitrogen_molecule_absorption(wavenumber, temperature, electron_density, molecule_density):
    r"""Free-free absorption of electrons at nitrogen molecules, from the momentum-transfer cross-section.

    .. math:: j_\nu = n_e n\, \frac{2 e^2}{3\pi c^3\, 4\pi\varepsilon_0}
              \left(\frac{2kT}{m}\right)^{3/2} \frac{2}{\sqrt\pi}\,
              Q_{11}(T)\, a^2 K_2(a)\, e^{-a}, \qquad a = \frac{h\nu}{2kT}

    and :math:`\kappa = j_\nu/B_\nu`. It is the Larmor radiation of the velocity change, with the factor
    :math:`(1 - h\nu/2E)\sqrt{1 - h\nu/E}` for electrons of energy E that give up a good part of it; its
    average over a Maxwellian is the Bessel function, 2 at long waves.

    Source: V. A. Kas'yanov and A. N. Starostin, Sov. Phys. JETP 21 (1965) 193; cross-section: the
    collision integral of Wright et al., AIAA J. 43 (2005) 2558, the average over :math:`E^2 e^{-E/kT}`.
    ASSUME: one cross-section for all electrons. For O atoms this agrees with the quantal table within a
    quarter; for N atoms, whose negative ion is nearly bound, that table is far higher, and the resonance
    of N2 at 2 eV may raise this one likewise. Below 1 % of first positive light.

    Parameters
    ----------
    wavenumber : (W,) [m-1]
    temperature : float [K]
        500-20000 K within the table; the cross-section keeps its end values beyond.
    electron_density, molecule_density : float [m-3]

    Returns
    -------
    ndarray (W,) [m-1]
    """
    logarithm, integral = _molecule_cross_section()
    cross_section = np.interp(np.log(temperature), logarithm, integral)
    ratio = _photon_ratio(wavenumber, temperature)
    speed = (2 * BOLTZMANN * temperature / ELECTRON_MASS) ** 1.5 * 2 / np.sqrt(np.pi)
    larmor = 2 * COULOMB_SQUARE / (3 * np.pi * LIGHT_SPEED**3)
    frequency = LIGHT_SPEED * wavenumber
    # B_nu = 2 h nu^3/c^2 e^-x/(1 - e^-x), and K_2(a) e^-a = kve(2, a) e^-x: the exponentials cancel.
    per_blackbody = -np.expm1(-ratio) * LIGHT_SPEED**2 / (2 * PLANCK * frequency**3)
    emission = electron_density * molecule_density * larmor * speed * cross_section
    return emission * (ratio / 2) ** 2 * kve(2, ratio / 2) * per_blackbody


@dataclass(frozen=True)
class BoundFree:
    """Photoionisation of one atom on a wavenumber axis: level energies, weights, cross-sections."""

    species: str
    energy: np.ndarray
    degeneracy: np.ndarray
    cross_section: np.ndarray


@cache
def _observed_terms(species):
    """Mean energy [m-1] of the terms in the line table of an atom: (core, orbital, term) -> energy."""
    atom = ATOMS[f"{species} I"]
    table = tables.load(f"radiation/lines_{atom.table}")
    levels = {}
    for side in ("upper", "lower"):
        names = (f"{side}_configuration", f"{side}_term", f"{side}_energy", f"{side}_degeneracy")
        for configuration, term, energy, degeneracy in zip(*(table[name] for name in names), strict=True):
            core = re.search(r"\((\d[SPD])\*?\)\.(\d+[spdfg])$", configuration)
            if core:
                levels.setdefault((core[1], core[2], term), {})[energy] = degeneracy
    return {name: np.average(list(e), weights=list(e.values())) for name, e in levels.items()}


def bound_free(species, wavenumber):
    """Photoionisation cross-sections of the excited levels of an atom on a wavenumber axis.

    Source: TOPbase (Cunto et al., Astron. Astrophys. 275 (1993) L5). Deviation: each cross-section is moved
    in photon energy by the difference of the observed (NIST) and the calculated binding of its term, where
    the term is in the line table; the population uses the observed one. Below a threshold TOPbase gives the
    mean of the crowded series members (n > 10): kept, as no line list holds them.

    ValueError: outside the range the tables were trimmed to.

    Parameters
    ----------
    species : 'N' or 'O'
    wavenumber : (W,) [m-1]
        Ascending, within the tables (vacuum wavelengths 0.63-2.5 um).

    Returns
    -------
    BoundFree
        Cross-sections (levels, W) [m2], 0 below the first tabulated photon.
    """
    atom = ATOMS[f"{species} I"]
    table = tables.load(f"radiation/photoionisation_{TABLES[species]}")
    lowest, highest = 0.0364 * RYDBERG, 0.1465 * RYDBERG
    if wavenumber[0] < lowest or wavenumber[-1] > highest:
        raise ValueError(
            f"wavelength must lie in [{1 / highest:.4g}, {1 / lowest:.4g}] m, the photoionisation tables;"
            f" got [{1 / wavenumber[-1]:.4g}, {1 / wavenumber[0]:.4g}] m"
        )
    limit = min(atom.limits.values())
    observed = _observed_terms(species)
    starts = np.flatnonzero(np.r_[True, np.diff(table["binding"]) != 0])
    energies, weights, rows = [], [], []
    for first, last in zip(starts, np.r_[starts[1:], len(table["binding"])], strict=True):
        calculated = table["binding"][first]
        key = (table["parent"][first], table["orbital"][first], table["term"][first])
        shift = limit - observed.get(key, limit - calculated) - calculated
        if abs(shift) > LARGEST_THRESHOLD_SHIFT:
            shift = 0.0
        photon, section = table["photon"][first:last] + shift, table["cross_section"][first:last]
        rows.append(np.interp(wavenumber, photon, section, left=0.0, right=section[-1]))
        energies.append(limit - calculated - shift)
        weights.append(table["degeneracy"][first])
    return BoundFree(species, np.array(energies), np.array(weights), np.array(rows))


def free_bound_absorption(bound_free, wavenumber, temperature, number_density, partition_function):
    r"""Absorption (W,) [m-1] by photoionisation of excited levels of an atom, on the axis of `bound_free`.

    .. math:: \kappa = \left(1 - e^{-h\nu/kT}\right) \sum_i n_i \sigma_i(\nu)

    Its emission is the recombination (free-bound) continuum. Source: Laux et al. (2003); TOPbase
    cross-sections hold no stimulated emission.
    """
    population = boltzmann_population(
        bound_free.energy, bound_free.degeneracy, temperature, number_density, partition_function
    )
    # einsum, not @: the bytes must not depend on the number of BLAS threads.
    total = np.einsum("i,iw->w", population, bound_free.cross_section)
    return total * -np.expm1(-_photon_ratio(wavenumber, temperature))


def negative_oxygen_density(temperature, electron_density, atom_density, partition_function):
    r"""Density [m-3] of O- in Saha equilibrium with electrons, of their temperature, and oxygen atoms.

    .. math:: n_- = n_e n_O \frac{Q_-}{2 Q_O} \left(\frac{h^2}{2 \pi m k T}\right)^{3/2} e^{E_A/kT},
              \qquad Q_- = 4 + 2 e^{-\Delta/kT}

    Source: M. N. Saha, Phil. Mag. 40 (1920) 472. ASSUME: O- is in equilibrium with e- and O; at 50 mbar
    collisions destroy it within microseconds. It is no species of the composition: 1e-5 of the electrons.
    """
    weight = 4 + 2 * np.exp(-SECOND_RADIATION * NEGATIVE_ION_SPLITTING / temperature)
    wave = PLANCK**2 / (2 * np.pi * ELECTRON_MASS * BOLTZMANN * temperature)
    affinity = np.exp(SECOND_RADIATION * ELECTRON_AFFINITY / temperature)
    return electron_density * atom_density * weight / (2 * partition_function) * wave**1.5 * affinity


def photodetachment_cross_section(wavenumber):
    """Photodetachment cross-section (W,) [m2] of O- at wavenumbers (W,) [m-1].

    Linear between the measured points, 0 below the threshold (848.6 nm); ValueError beyond the table (640.8
    nm). Source: L. C. Lee, G. P. Smith, J. Chem. Phys. 70 (1979) 1727; 10 % on the plateau. ASSUME: ions and
    atoms of all fine-structure levels have the threshold of O- 2P3/2 to O 3P2.
    """
    table = tables.load("radiation/photodetachment_oxygen")
    photon = np.r_[ELECTRON_AFFINITY, table["photon"] / (PLANCK * LIGHT_SPEED)]
    if np.max(wavenumber) > photon[-1]:
        raise ValueError(
            f"wavelength must be >= {1 / photon[-1]:.4g} m, the photodetachment table;"
            f" got {1 / np.max(wavenumber):.4g} m"
        )
    return np.interp(wavenumber, photon, np.r_[0.0, table["cross_section"]], left=0.0)


def photodetachment_absorption(wavenumber, temperature, electron_density, atom_density, partition_function):
    r"""Absorption (W,) [m-1] by photodetachment of O-; its emission is that of radiative attachment.

    .. math:: \kappa = n_-\, \sigma(\nu) \left(1 - e^{-h\nu/kT}\right)

    Source: as `negative_oxygen_density` and `photodetachment_cross_section`.
    """
    density = negative_oxygen_density(temperature, electron_density, atom_density, partition_function)
    cross_section = photodetachment_cross_section(wavenumber)
    return density * cross_section * -np.expm1(-_photon_ratio(wavenumber, temperature))
