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
        """Every line of the system with its quantum numbers, none dropped.

        Parameters
        ----------
        wavenumber_range : (2,) [m-1]
            Lowest and highest, vacuum.

        Returns
        -------
        lines, decay
            As from `diatomic_states.system_lines`; decay by this system only. Lines between levels that do
            not exist in C2 have weight zero.

        Raises
        ------
        ValueError
            Range not increasing.

        Notes
        -----
        Source: constants of R. R. Laher, F. R. Gilmore, J. Phys. Chem. Ref. Data 20 (1991) 685 (nitrogen) and
        K. P. Huber, G. Herzberg, Constants of Diatomic Molecules (1979); moments as `SYSTEMS` says.
        Potentials by RKR, vibration by sinc-DVR for every N, rotation and spin by diagonalising the case (a)
        Hamiltonians (27 branches of N2 1P). ASSUME: spins interact with the orbit alone (in A of N2 with each
        other); states do not perturb each other (they do, by up to 10 cm-1 in C2). ASSUME: levels that
        predissociate (N2 B above v' = 12, NO D above v' = 0 and A above v'' = 3) are populated as in
        equilibrium: in such a gas the inverse process refills them.
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

        Raises
        ------
        ValueError
            Range not increasing, fraction outside (0, 1], temperature not > 0.
        """
        lines, decay = self.lines(wavenumber_range)
        keep = strong_enough(lines, reference_temperature, lost_fraction)
        kept = {name: column[keep] for name, column in lines.items()}
        kept["lower_energy"][np.abs(kept["lower_energy"]) < ROUNDING] = 0.0
        names = (
            "wavenumber",
            "einstein_a",
            *(f"{side}_{what}" for side in ("upper", "lower") for what in _BOTH),
        )
        return LineList(
            self.name,
            self.species,
            **{name: kept[name] for name in names},
            natural_hwhm=decay[kept["upper_v"].astype(int)] / (4 * np.pi * LIGHT_SPEED),
            van_der_waals_hwhm=COLLISION_HWHM,
            family=BAND * kept["upper_v"] + kept["lower_v"],
            origin="published",
            relative_uncertainty=self.uncertainty,
        )


_BOTH = ("energy", "degeneracy", "rotation")  # of either level of a line


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


SYSTEMS = {
    system.name: system
    for system in (
        # C. O. Laux, C. H. Kruger, JQSRT 48 (1992) 9, whose probabilities end at v' = 21; A up to its limit,
        # with constants up to v'' = 20 and lambda of Huber & Herzberg (1979).
        BandSystem(
            "N2 1P",
            State("B3Pi_g", (21, 22)),
            State("A3Sigma_u+", (20, 30), spin_spin=-133.0),
            Series("molecules/nitrogen_first_positive_moment", 1.25e-10, (0.98e-10, 1.9e-10)),
            uncertainty=0.1,
        ),
        # S. Chauveau, M.-Y. Perrin, P. Riviere, A. Soufiani, JQSRT 72 (2002) 503.
        # ASSUME: no spin-rotation splitting of X (0.01 N cm-1).
        BandSystem(
            "N2+ Meinel",
            State("A2Pi_u"),
            State("X2Sigma_g+"),
            "molecules/nitrogen_ion_meinel_moment",
            uncertainty=0.3,
        ),
        # As Meinel. ASSUME: v' <= 5, as published: at 8000 K a tenth of the molecules in D would lie above.
        # ASSUME: the bands 3d-3p (F, H, H' to C, D; 0.97-1.07 um) stay out for want of strengths: by analogy
        # with sodium they are 0.7 times as bright as this system at 5000 K and 1.9 times at 8000 K.
        BandSystem(
            "NO 11000 A",
            State("D2Sigma+"),
            State("A2Sigma+"),
            "molecules/nitric_oxide_11000_moment",
            uncertainty=0.3,
        ),
        # Fitted to the moments of Chauveau et al. In 650-1250 nm only tails: v' = 6-12 into v'' = 22-30,
        # whose strengths come from r > 1.6 Angstrom and are good to a factor of two.
        BandSystem(
            "NO beta",
            State("B2Pi", (19, 22)),
            State("X2Pi", (30, 36)),
            Series("molecules/nitric_oxide_beta_moment", 1.4e-10, (1.15e-10, 1.62e-10)),
            uncertainty=1.0,
            faint=True,
        ),
        # Chauveau et al., v' <= 22: overtones, changes of v by five and more.
        BandSystem(
            "NO infrared",
            State("X2Pi", (22, 23)),
            State("X2Pi", (22, 23)),
            "molecules/nitric_oxide_infrared_moment",
            uncertainty=1.0,
            faint=True,
        ),
        # D. Babou, P. Riviere, M.-Y. Perrin, A. Soufiani, JQSRT 110 (2009) 89; Swan of J. S. A. Brooke et
        # al., JQSRT 124 (2013) 11.
        BandSystem(
            "CN red", State("A2Pi"), State("X2Sigma+"), "molecules/cyanogen_red_probability", uncertainty=0.1
        ),
        BandSystem(
            "C2 Phillips",
            State("A1Pi_u"),
            State("X1Sigma_g+"),
            "molecules/carbon_phillips_probability",
            uncertainty=0.15,
        ),
        BandSystem(
            "C2 Ballik-Ramsay",
            State("b3Sigma_g-"),
            State("a3Pi_u"),
            "molecules/carbon_ballik_ramsay_probability",
            uncertainty=0.2,
        ),
        BandSystem(
            "C2 Swan", State("d3Pi_g"), State("a3Pi_u"), "molecules/carbon_swan_probability", uncertainty=0.1
        ),
    )
}
