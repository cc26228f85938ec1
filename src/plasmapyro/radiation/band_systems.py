"""The band systems of N2, N2+, NO, CN and C2: one table, and how a row of it becomes lines."""

import re
from dataclasses import dataclass

import numpy as np

from plasmapyro import tables
from plasmapyro.constants import ATOMIC_MASS, LIGHT_SPEED
from plasmapyro.radiation.diatomic_lines import strong_enough
from plasmapyro.radiation.diatomic_rotation import ElectronicState
from plasmapyro.radiation.diatomic_states import (
    COLLISION_HWHM,
    RADIUS,
    ROUNDING,
    moments_of_probabilities,
    rovibration,
    state_constants,
    system_lines,
    transition_moments,
)
from plasmapyro.radiation.lines import BAND, LineList

# [kg], of 14N and 16O (G. Audi, A. H. Wapstra, C. Thibault, Nucl. Phys. A 729 (2003) 337) and of 12C
ATOM_MASS = {"N": 14.0030740048 * ATOMIC_MASS, "O": 15.9949146196 * ATOMIC_MASS, "C": 12.0 * ATOMIC_MASS}
NUCLEAR_SPIN = {"N": 1, "O": 0, "C": 0}  # [1], of the same
# Nuclei of a species and the table of its states. The electron that an ion lacks is 2e-5 of the mass.
MOLECULES = {
    "N2": ("NN", "gas/diatomic_nitrogen"),
    "N2+": ("NN", "gas/diatomic_nitrogen"),
    "NO": ("NO", "gas/diatomic_oxygen"),
    "CN": ("CN", "gas/diatomic_carbon"),
    "C2": ("CC", "gas/diatomic_carbon"),
}
TERM_SYMBOL = re.compile(r"[A-Za-z]p?(\d)(Sigma|Pi|Delta)(?:_([gu]))?([+-]?)")
ORBITAL = {"Sigma": 0, "Pi": 1, "Delta": 2}


@dataclass(frozen=True)
class State:
    """An electronic state: term symbol, spin-spin constant [m-1], and where its levels do not follow the
    table of moments, the last v for which the constants hold and the number of levels."""

    symbol: str
    levels: tuple | None = None
    spin_spin: float = 0.0


@dataclass(frozen=True)
class Series:
    r"""Electronic transition moment :math:`R_e(r) = \sum_k a_k (r - r_0)^k` of a table with a_k.

    Deviation: held constant outside `support`, where the published bands give no hold.
    """

    table: str
    centre: float  # [m]
    support: tuple  # [m]

    def __call__(self, radius):
        """Moment (R,) [e a0] at distances (R,) [m]."""
        x = (np.clip(radius, *self.support) - self.centre) / 1e-10
        return np.polynomial.Polynomial(tables.load(self.table)["coefficient"])(x)


@dataclass(frozen=True)
class BandSystem:
    """A system of bands: its states, the moments or probabilities of its bands, and what is known of them.

    Parameters
    ----------
    name : str
        Species and usual name: 'N2 1P'.
    upper, lower : State
    moments : Series or str
        Moment against distance, or the name of a table of bands (upper_v, lower_v and either moment [e a0] or
        einstein_a [s-1]). ASSUME: moments of bands do not change with rotation.
    uncertainty : float [1]
        Relative, of the strength of the whole system: the certificates of its tables say why.
    faint : bool
        Below 0.3 % of the light of air at 50 mbar.
    """

    name: str
    upper: State
    lower: State
    moments: Series | str
    uncertainty: float
    faint: bool = False

    @property
    def species(self):
        """The molecule that radiates."""
        return self.name.split()[0]

    def levels(self, state, count=None):
        """Symmetry, and terms, waves and bound flags as from `rovibration`, above the lowest level.

        `count` levels with constants that hold for all of them, unless the state says otherwise.
        """
        values = state_constants(MOLECULES[self.species][1], self.species, state.symbol)
        highest, count = state.levels or (count - 1, count)
        waves = isinstance(self.moments, Series)  # moments of bands have theirs in them
        term, wave, bound = rovibration(values, reduced_mass(self.species), highest, count, waves=waves)
        symmetry = electronic_state(state, values["spin_orbit"])
        if values["origin"] == 0:  # the tables count from the lowest component of the ground state
            term = term + values["spin_orbit"] * symmetry.orbital * symmetry.spin
        return symmetry, (term, wave, bound)

    def lines(self, wavenumber_range):
        """Every line of the system in a range (2,) [m-1, vacuum] with its quantum numbers, none dropped.

        Source: constants of R. R. Laher, F. R. Gilmore, J. Phys. Chem. Ref. Data 20 (1991) 685 (nitrogen) and
        K. P. Huber, G. Herzberg, Constants of Diatomic Molecules (1979); moments as `SYSTEMS` says.
        Potentials by RKR, vibration by sinc-DVR for every N, rotation and spin by diagonalising the case (a)
        Hamiltonians (27 branches of N2 1P). ASSUME: spins interact with the orbit alone (in A of N2 with each
        other); states do not perturb each other (they do, by up to 10 cm-1 in C2). ASSUME: levels that
        predissociate (N2 B above v' = 12, NO D above v' = 0 and A above v'' = 3) are populated as in
        equilibrium: in such a gas the inverse process refills them.

        ValueError: range not increasing.

        Returns
        -------
        lines, decay
            As from `diatomic_states.system_lines`; decay by this system only. Lines between levels that do
            not exist in C2 have weight zero.
        """
        if isinstance(self.moments, Series):
            (upper, up), (lower, low) = self.levels(self.upper), self.levels(self.lower)
            moment = transition_moments(up[1], low[1], self.moments(RADIUS))
        else:
            column, values = bands(self.moments)
            count = values.shape[1]
            upper, up = self.levels(self.upper, len(values))
            same = self.lower == self.upper
            lower, (term, _, bound) = (upper, up) if same else self.levels(self.lower, count)
            low = (term[:count], None, bound[:count])
            if column == "einstein_a":
                values = moments_of_probabilities(values, upper, up[0], lower, low[0])
            moment = values[:, :, None]
        nuclear_spin = NUCLEAR_SPIN[MOLECULES[self.species][0][0]]
        return system_lines(upper, up, lower, low, moment, wavenumber_range, nuclear_spin)

    def line_list(self, wavenumber_range, *, lost_fraction, reference_temperature):
        """The strong ones of the lines, as the engine takes them.

        ValueError: range not increasing, fraction outside (0, 1], temperature not > 0.

        Parameters
        ----------
        wavenumber_range : (2,) [m-1]
            Lowest and highest, vacuum.
        lost_fraction : float [1]
            Optically thin emission in the range that dropped lines may carry, at each reference temperature.
        reference_temperature : (T,) [K]

        Returns
        -------
        LineList
            Ascending wavenumber; energies above the lowest level of the species. Natural width of the
            vibrational level without rotation, collisions as `COLLISION_HWHM`.
        """
        lines, decay = self.lines(wavenumber_range)
        keep = strong_enough(lines, reference_temperature, lost_fraction)
        kept = {name: column[keep] for name, column in lines.items()}
        kept["lower_energy"][np.abs(kept["lower_energy"]) < ROUNDING] = 0.0
        kept["natural_hwhm"] = decay[kept["upper_v"].astype(int)] / (4 * np.pi * LIGHT_SPEED)
        kept["family"] = BAND * kept["upper_v"] + kept["lower_v"]
        return self.assembled(kept)

    def assembled(self, columns):
        """The LineList of columns `OF_LINES` of lines of this system."""
        return LineList(
            self.name,
            self.species,
            **{name: columns[name] for name in OF_LINES},
            van_der_waals_hwhm=COLLISION_HWHM,
            origin="published",
            relative_uncertainty=self.uncertainty,
        )


OF_LINES = (  # what tells the lines of a system apart
    "wavenumber",
    "einstein_a",
    *(f"{side}_{what}" for side in ("upper", "lower") for what in ("energy", "degeneracy", "rotation")),
    "natural_hwhm",
    "family",
)


def reduced_mass(species):
    """Reduced mass of a diatomic species [kg]."""
    first, second = (ATOM_MASS[atom] for atom in MOLECULES[species][0])
    return first * second / (first + second)


def electronic_state(state, spin_orbit):
    """Symmetry of a state as its term symbol says, with its fine structure [m-1]."""
    multiplicity, orbital, inversion, reflection = TERM_SYMBOL.fullmatch(state.symbol).groups()
    return ElectronicState(
        ORBITAL[orbital],
        (int(multiplicity) - 1) / 2,
        -1 if reflection == "-" else 1,
        inversion or "",
        spin_orbit=spin_orbit,
        spin_spin=state.spin_spin,
    )


def bands(table_name):
    """What a table says of its bands: 'moment' [e a0] or 'einstein_a' [s-1], and the values (v', v'').

    Bands that it leaves out are zero.
    """
    table = tables.load(table_name)
    column = "moment" if "moment" in table.columns else "einstein_a"
    upper, lower = table["upper_v"].astype(int), table["lower_v"].astype(int)
    values = np.zeros((upper.max() + 1, lower.max() + 1))
    values[upper, lower] = table[column]
    return column, values


def _numbers(words):
    """Numbers of a cell, None for an empty one."""
    return tuple(map(float, words.split())) or None


def _state(row, side):
    """The upper or the lower state of a row of `band_systems.csv`."""
    levels = _numbers(row[f"{side} levels"])
    return State(row[side], levels and tuple(map(int, levels)), float(row[f"{side} spin-spin [m-1]"] or 0))


def _system(row):
    """The system of a row of `band_systems.csv`."""
    moments, place = row["moments"], _numbers(row["centre and support [m]"])
    return BandSystem(
        row["name"],
        _state(row, "upper"),
        _state(row, "lower"),
        moments if place is None else Series(moments, place[0], place[1:]),
        float(row["uncertainty"]),
        row["faint"] == "yes",
    )


SYSTEMS = {row["name"]: _system(row) for row in tables.rows("radiation/band_systems.csv")}
