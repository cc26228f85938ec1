"""Line lists of the nitrogen and oxygen atom: NIST levels and probabilities, widths from the levels."""

import re
from dataclasses import dataclass

import numpy as np

from plasmapyro import tables
from plasmapyro.gas.species import MASS, SPECIES
from plasmapyro.radiation.broadening import (
    mean_square_radius,
    natural_hwhm,
    resonance_hwhm,
    van_der_waals_hwhm,
)
from plasmapyro.radiation.lines import WIDTH_REFERENCE_TEMPERATURE, LineList

PERTURBER_POLARISABILITY = 1.10e-30  # [m3] of the nitrogen atom; CRC Handbook (O 0.80, N2 1.74)
TABLE_RANGE = (650e-9, 1250e-9)  # [m], vacuum wavelengths of the line tables
STARK_DENSITY = 1e22  # [m-3], of Griem's tables
LEVEL_MATCH = 20.0  # [m-1]; rounding between two issues of the same level table
MULTIPLET_MATCH = 0.02  # [1]; a line belongs to a multiplet of equal terms within 2 % of its wavelength
ORBITALS = "spdfgh"
STARK_LABELS = ("lower_orbital", "lower_term", "upper_orbital", "upper_term")


@dataclass(frozen=True)
class Atom:
    """What the lists need to know of an atom; `limits` maps the core term to its ionisation limit [m-1]."""

    system: str
    species: str
    table: str
    ground_degeneracy: float
    limits: dict


# Ionisation limits: NIST ASD; cores 3P, 1D of N II and 4S, 2D, 2P of O II, weighted over fine structure.
ATOMS = {
    "N I": Atom("N I", "N", "nitrogen", 4, {"3P": 11722570.0, "1D": 13254190.0}),
    "O I": Atom("O I", "O", "oxygen", 9, {"4S": 10983702.0, "2D": 13665600.0, "2P": 15030600.0}),
}


def ionisation_limit(atom, configuration, energy):
    """Limit [m-1] a level converges to: that of its core term, or the lowest above it if none is given."""
    core = re.search(r"\((\d[SPD])\*?\)", configuration)
    if core and atom.limits[core[1]] > energy:
        return atom.limits[core[1]]
    return min(limit for limit in atom.limits.values() if limit > energy)


def _orbital(configuration):
    """Outer orbital of a NIST configuration: '3p' of '2s2.2p2.(3P).3p', '2p' of '2s.2p4'."""
    return re.search(r"\.(\d[spdfgh])\d*$", configuration)[1]


def _decays(table, energies):
    """Decay, decay to the ground term and degeneracy of the level at each energy; 0, 0, 1 if unlisted."""
    index = np.abs(table["energy"][:, None] - energies).argmin(axis=0)
    listed = np.abs(table["energy"][index] - energies) < LEVEL_MATCH
    return (
        np.where(listed, table["decay"][index], 0.0),
        np.where(listed, table["decay_to_ground_term"][index], 0.0),
        np.where(listed, table["degeneracy"][index], 1.0),
    )


def _griem_power_laws(table, system):
    """Multiplets of one system: labels, wavelength [m], HWHM in wavelength per density [m4], exponent."""
    mine = table["system"] == system
    cold, hot = mine & (table["temperature"] == 5e3), mine & (table["temperature"] == 2e4)
    labels = list(zip(*(table[name][cold] for name in STARK_LABELS), strict=True))
    exponent = np.log(table["hwhm"][hot] / table["hwhm"][cold]) / np.log(4.0)
    reference = np.sqrt(table["hwhm"][hot] * table["hwhm"][cold]) / STARK_DENSITY
    return labels, table["wavelength_air"][cold], reference, exponent


def stark_widths(atom, labels, wavenumber, upper_binding):
    r"""Stark half widths per electron density at 10 kK, and their temperature exponents.

    Tabulated multiplets: power law through Griem's 5000 K and 20000 K values (within 2 % of the one at
    10000 K). All other lines: the power law in the binding energy of the upper level

    .. math:: \ln w_S = a - b \ln \tilde E_u

    fitted to the tabulated multiplets of the system, with their median exponent.

    Parameters
    ----------
    atom : Atom
    labels : list of (lower orbital, lower term, upper orbital, upper term)
    wavenumber, upper_binding : (L,) [m-1]

    Returns
    -------
    tuple of ndarray (L,) : [m2], [1]

    Notes
    -----
    Source: Griem (1974), appendix IV. The fit scatters by a factor of about 1.4.
    """
    table = tables.load("radiation/stark_griem")
    multiplets, wavelength, reference, exponent = _griem_power_laws(table, atom.system)
    width = np.full(len(wavenumber), np.nan)
    power = np.full(len(wavenumber), np.nan)
    fitted = []
    for label, place, value, rise in zip(multiplets, wavelength, reference, exponent, strict=True):
        near = np.abs(wavenumber * place - 1) < MULTIPLET_MATCH
        members = np.flatnonzero(near & np.array([found == label for found in labels]))
        width[members] = value * wavenumber[members] ** 2
        power[members] = rise
        if members.size:
            fitted.append((upper_binding[members[0]], value / place**2, rise))
    binding, known, rises = np.array(fitted).T
    slope, offset = np.polyfit(np.log(binding), np.log(known), 1)
    unknown = np.isnan(width)
    width[unknown] = np.exp(offset + slope * np.log(upper_binding[unknown]))
    power[unknown] = np.median(rises)
    return width, power


def atomic_lines(system):
    """Line list of an atom in the range of its table (650-1250 nm).

    Parameters
    ----------
    system : 'N I' or 'O I'

    Returns
    -------
    LineList

    Raises
    ------
    ValueError
        For another system.

    Notes
    -----
    Source: NIST Atomic Spectra Database (lines, decays); widths as in `broadening`.
    ASSUME: every neutral perturber broadens like a nitrogen atom (van der Waals widths of N, O and N2
    differ by 20 %); decays that NIST does not list are left out of natural widths.
    """
    if system not in ATOMS:
        raise ValueError(f"atomic system must be one of {', '.join(ATOMS)}; got {system!r}")
    atom = ATOMS[system]
    table = tables.load(f"radiation/lines_{atom.table}")
    decay_table = tables.load(f"radiation/decay_{atom.table}")
    mass, perturber = MASS[SPECIES.index(atom.species)], MASS[SPECIES.index("N")]
    wavenumber = table["upper_energy"] - table["lower_energy"]
    radius, decay, resonance, binding, orbital = {}, {}, {}, {}, {}
    for side in ("upper", "lower"):
        energy, configuration = table[f"{side}_energy"], table[f"{side}_configuration"]
        limits = [ionisation_limit(atom, *level) for level in zip(configuration, energy, strict=True)]
        binding[side] = np.array(limits) - energy
        orbital[side] = [_orbital(word) for word in configuration]
        momentum = [ORBITALS.index(word[1]) for word in orbital[side]]
        radius[side] = mean_square_radius(binding[side], momentum)
        decay[side], to_ground, degeneracy = _decays(decay_table, energy)
        resonance[side] = resonance_hwhm(energy, to_ground, degeneracy, atom.ground_degeneracy)
    terms = {side: [word.rstrip("*") for word in table[f"{side}_term"]] for side in ("upper", "lower")}
    labels = list(zip(orbital["lower"], terms["lower"], orbital["upper"], terms["upper"], strict=True))
    stark, exponent = stark_widths(atom, labels, wavenumber, binding["upper"])
    return LineList(
        component=system,
        species=atom.species,
        wavenumber=wavenumber,
        upper_energy=table["upper_energy"],
        lower_energy=table["lower_energy"],
        upper_degeneracy=table["upper_degeneracy"],
        lower_degeneracy=table["lower_degeneracy"],
        einstein_a=table["einstein_a"],
        natural_hwhm=natural_hwhm(decay["upper"], decay["lower"]),
        stark_hwhm=stark,
        stark_exponent=exponent,
        van_der_waals_hwhm=van_der_waals_hwhm(
            radius["upper"],
            radius["lower"],
            PERTURBER_POLARISABILITY,
            mass * perturber / (mass + perturber),
            WIDTH_REFERENCE_TEMPERATURE,
        ),
        resonance_hwhm=resonance["upper"] + resonance["lower"],
        origin=tables.weakest((table.origin, decay_table.origin)),
    )
