"""Line lists of atoms and atomic ions: NIST levels and probabilities, widths from the levels."""

import re
from dataclasses import dataclass

import numpy as np

from plasmapyro import tables
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.gas.species import particle_mass
from plasmapyro.radiation.broadening import (
    mean_square_radius,
    natural_hwhm,
    resonance_hwhm,
    van_der_waals_hwhm,
)
from plasmapyro.radiation.lines import WIDTH_REFERENCE_TEMPERATURE, LineList

PERTURBER_POLARISABILITY = 1.10e-30  # [m3] of the nitrogen atom; CRC Handbook (O 0.80, N2 1.74)
TABLE_RANGE = (650e-9, 1250e-9)  # [m], vacuum wavelengths of the line tables of each atom
WHOLE_RANGE = (650e-9, 2500e-9)  # [m], with the table of infrared lines
LEVEL_MATCH = 20.0  # [m-1]; rounding between two issues of the same level table
MULTIPLET_MATCH = 0.02  # [1]; a line belongs to a multiplet of equal terms within 2 % of its wavelength
ORBITALS = "spdfgh"
STARK_LABELS = ("lower_orbital", "lower_term", "upper_orbital", "upper_term")


@dataclass(frozen=True)
class Atom:
    """What the lists need to know of an atom.

    `limits` maps the core term to its ionisation limit [m-1], `core_charge` is that of the core the outer
    electron sees; `stark` names the table of Stark widths, for electrons of `stark_density` [m-3], and the
    system in it whose law serves lines that are not in it.
    """

    system: str
    species: str
    table: str
    ground_degeneracy: float
    limits: dict
    core_charge: int
    stark: tuple
    stark_density: float


def _limits(words):
    """Limit [m-1] by core term."""
    return {term: float(value) for term, value in zip(words[::2], words[1::2], strict=True)}


# Ionisation limits: NIST ASD, weighted over the fine structure of the core. Two core levels of Ar I:
# lines name that of theirs, the lower is taken.
ATOMS = {
    row["system"]: Atom(
        row["system"],
        row["species"],
        row["table"],
        int(row["ground degeneracy"]),
        _limits(row["ionisation limits [m-1]"].split()),
        int(row["core charge"]),
        (row["Stark widths"], row["of"]),
        float(row["electrons [m-3]"]),
    )
    for row in tables.rows("radiation/atoms.csv")
}
ACCURACY = {
    "AAA": 0.003,
    "AA": 0.01,
    "A+": 0.02,
    "A": 0.03,
    "B+": 0.07,
    "B": 0.1,
    "C+": 0.18,
    "C": 0.25,
    "D+": 0.4,
    "D": 0.5,
    "E": 1.0,
}  # [1], relative, of NIST's classes; E means more than 50 %
ACCURACY_TEMPERATURE = 8000.0  # [K], where lines are weighed for the uncertainty of the system
ION_WIDTH_EXPONENT = -2.0  # [1], Stark width against binding, n^4 (Griem 1974), where too few are tabulated
FEWEST_MULTIPLETS = 4  # for a fit with a free exponent


def ionisation_limit(atom, configuration, energy):
    """Limit [m-1] a level converges to: that of its core term, or the lowest above it if none is given."""
    core = re.search(r"\((\d[SPD])\*?\)", configuration)
    if core and atom.limits.get(core[1], 0.0) > energy:
        return atom.limits[core[1]]
    return min(limit for limit in atom.limits.values() if limit > energy)


def _orbital(configuration):
    """Outer orbital of a NIST configuration: '3p' of '2s2.2p2.(3P).3p', '2p' of '2s.2p4' and '2p3'."""
    return re.search(r"(?:^|\.)(\d[spdfgh])\d*$", configuration)[1]


def _decays(table, energies):
    """Decay, decay to the ground term and degeneracy of the level at each energy; 0, 0, 1 if unlisted."""
    index = np.abs(table["energy"][:, None] - energies).argmin(axis=0)
    listed = np.abs(table["energy"][index] - energies) < LEVEL_MATCH
    return (
        np.where(listed, table["decay"][index], 0.0),
        np.where(listed, table["decay_to_ground_term"][index], 0.0),
        np.where(listed, table["degeneracy"][index], 1.0),
    )


def _griem_power_laws(name, system, density):
    """Multiplets of one system: labels, wavelength [m], HWHM in wavelength per density [m4], exponent."""
    table = tables.load(f"radiation/{name}")
    mine = table["system"] == system
    cold, hot = mine & (table["temperature"] == 5e3), mine & (table["temperature"] == 2e4)
    labels = list(zip(*(table[name][cold] for name in STARK_LABELS), strict=True))
    exponent = np.log(table["hwhm"][hot] / table["hwhm"][cold]) / np.log(4.0)
    reference = np.sqrt(table["hwhm"][hot] * table["hwhm"][cold]) / density
    return labels, table["wavelength_air"][cold], reference, exponent


def _tabulated_widths(atom, labels, wavenumber, upper_binding):
    """Stark widths [m2] and exponents of lines, NaN if not tabulated, and those of each multiplet found."""
    width = np.full(len(wavenumber), np.nan)
    power = np.full(len(wavenumber), np.nan)
    found = []
    griem = _griem_power_laws(atom.stark[0], atom.system, atom.stark_density)
    for label, place, value, rise in zip(*griem, strict=True):
        near = np.abs(wavenumber * place - 1) < MULTIPLET_MATCH
        members = np.flatnonzero(near & np.array([one == label for one in labels]))
        width[members] = value * wavenumber[members] ** 2
        power[members] = rise
        if members.size:
            found.append((upper_binding[members[0]], value / place**2, rise))
    return width, power, found


def stark_widths(atom, labels, wavenumber, upper_binding):
    r"""Stark half widths (L,) [m2] per electron density at 10 kK, and their temperature exponents (L,) [1].

    Tabulated multiplets: power law through Griem's 5000 K and 20000 K values (within 2 % of the one at 10000
    K). All other lines: the power law in the binding energy of the upper level

    .. math:: \ln w_S = a - b \ln \tilde E_u

    fitted to the tabulated multiplets of the system, with their median exponent; b = 2 where fewer than four
    are tabulated (the ions). `labels`: of each line lower orbital and term, upper orbital and term.

    Source: Griem (1974), appendix IV. The fit scatters by a factor of about 1.4. ASSUME: C I, Ar I and Si I
    broaden like N I and C II like N II at equal binding, for want of a table.
    """
    width, power, _ = _tabulated_widths(atom, labels, wavenumber, upper_binding)
    like = ATOMS[atom.stark[1]]
    levels = _levels(like)
    fitted = _tabulated_widths(like, levels.labels, levels.wavenumber, levels.binding["upper"])[2]
    binding, known, rises = np.array(fitted).T
    if len(known) < FEWEST_MULTIPLETS:
        slope, offset = ION_WIDTH_EXPONENT, np.mean(np.log(known) - ION_WIDTH_EXPONENT * np.log(binding))
    else:
        slope, offset = np.polyfit(np.log(binding), np.log(known), 1)
    unknown = np.isnan(width)
    width[unknown] = np.exp(offset + slope * np.log(upper_binding[unknown]))
    power[unknown] = np.median(rises)
    return width, power


@dataclass(frozen=True)
class _Levels:
    """Lines of an atom and what their configurations say: binding [m-1], orbital by side, Stark labels."""

    table: dict
    wavenumber: np.ndarray
    binding: dict
    orbital: dict
    labels: list


def _levels(atom, infrared=False):
    table = tables.load(f"radiation/lines_{atom.table}").columns
    if infrared:
        more = tables.load("radiation/lines_infrared")
        own = more["system"] == atom.system
        table = {name: np.concatenate([column, more[name][own]]) for name, column in table.items()}
    binding, orbital = {}, {}
    for side in ("upper", "lower"):
        energy, configuration = table[f"{side}_energy"], table[f"{side}_configuration"]
        limits = [ionisation_limit(atom, *level) for level in zip(configuration, energy, strict=True)]
        binding[side] = np.array(limits) - energy
        orbital[side] = [_orbital(word) for word in configuration]
    terms = {side: [word.rstrip("*") for word in table[f"{side}_term"]] for side in ("upper", "lower")}
    labels = list(zip(orbital["lower"], terms["lower"], orbital["upper"], terms["upper"], strict=True))
    return _Levels(table, table["upper_energy"] - table["lower_energy"], binding, orbital, labels)


def _multiplets(table):
    """Number of the multiplet of each line (L,): lines between the same two terms share it."""
    words = [table[f"{side}_{what}"] for side in ("upper", "lower") for what in ("configuration", "term")]
    return np.unique(["|".join(row) for row in zip(*words, strict=True)], return_inverse=True)[1]


def line_uncertainty(accuracy, emission):
    """Relative uncertainty [1] of a sum of lines (L,), their errors one: NIST's classes by emission."""
    return float(np.average([ACCURACY[word] for word in accuracy], weights=emission))


def atomic_lines(system, infrared=False):
    """`LineList` of an atom or atomic ion from 650 to 1250 nm.

    Source: NIST Atomic Spectra Database (lines, decays); widths as in `broadening`. ASSUME: every neutral
    perturber broadens like a nitrogen atom (van der Waals widths of N, O and N2 differ by 20 %); decays that
    NIST does not list are left out of natural widths; charge exchange does not broaden lines of ions.

    ValueError: for another system.

    Parameters
    ----------
    system : str
        In `ATOMS`: 'N I', 'O I', 'N II', 'O II', 'Ar I', 'Si I', 'C I' or 'C II'.
    infrared : bool
        Whether those from 1250 to 2500 nm come along.
    """
    if system not in ATOMS:
        raise ValueError(f"atomic system must be one of {', '.join(ATOMS)}; got {system!r}")
    atom = ATOMS[system]
    levels = _levels(atom, infrared)
    table, binding, wavenumber = levels.table, levels.binding, levels.wavenumber
    decay_table = tables.load(f"radiation/decay_{atom.table}")
    mass, perturber = particle_mass(atom.species), particle_mass("N")
    radius, decay, resonance = {}, {}, {}
    for side in ("upper", "lower"):
        energy = table[f"{side}_energy"]
        momentum = [ORBITALS.index(word[1]) for word in levels.orbital[side]]
        # An electron at a core of charge Z: r scales with 1/Z at equal n, and n2 = Z2 R/E.
        charge = atom.core_charge
        radius[side] = mean_square_radius(binding[side] / charge**2, momentum) / charge**2
        decay[side], to_ground, degeneracy = _decays(decay_table, energy)
        exchanged = to_ground if charge == 1 else np.zeros_like(to_ground)
        resonance[side] = resonance_hwhm(energy, exchanged, degeneracy, atom.ground_degeneracy)
    stark, exponent = stark_widths(atom, levels.labels, wavenumber, binding["upper"])
    emission = table["upper_degeneracy"] * table["einstein_a"] * wavenumber
    emission = emission * np.exp(-SECOND_RADIATION * table["upper_energy"] / ACCURACY_TEMPERATURE)
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
        family=_multiplets(table),
        strength_uncertainty=np.array([ACCURACY[word] for word in table["accuracy"]]),
        origin=tables.weakest((tables.load(f"radiation/lines_{atom.table}").origin, decay_table.origin)),
        relative_uncertainty=line_uncertainty(table["accuracy"], emission),
    )
