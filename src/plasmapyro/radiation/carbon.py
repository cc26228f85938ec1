"""Band systems of CN and C2, for gas that holds carbon from an ablating wall."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.constants import ATOMIC_MASS
from plasmapyro.radiation.diatomic_rotation import ElectronicState
from plasmapyro.radiation.diatomic_states import (
    line_list,
    moments_of_probabilities,
    rovibration,
    state_constants,
    system_lines,
    tabulated_probabilities,
)
from plasmapyro.radiation.nitrogen import NITROGEN_MASS

CONSTANTS = "gas/diatomic_carbon"
CARBON_MASS = 12.0 * ATOMIC_MASS  # [kg], of 12C, by definition
CARBON_SPIN = 0  # [1], of 12C; C2 has no antisymmetric levels. CN does not ask.
REDUCED_MASS = {
    "CN": CARBON_MASS * NITROGEN_MASS / (CARBON_MASS + NITROGEN_MASS),
    "C2": CARBON_MASS / 2,
}


@dataclass(frozen=True)
class BandSystem:
    """A transition between two states of `CONSTANTS`: their names and symmetries, and the probabilities."""

    species: str
    upper: str
    upper_symmetry: dict
    lower: str
    lower_symmetry: dict
    probabilities: str


_TRIPLET_PI_U = {"orbital": 1, "spin": 1.0, "reflection": 1, "inversion": "u"}
SYSTEMS = {
    "CN red": BandSystem(
        "CN",
        "A2Pi",
        {"orbital": 1, "spin": 0.5, "reflection": 1, "inversion": ""},
        "X2Sigma+",
        {"orbital": 0, "spin": 0.5, "reflection": 1, "inversion": ""},
        "molecules/cyanogen_red_probability",
    ),
    "C2 Phillips": BandSystem(
        "C2",
        "A1Pi_u",
        {"orbital": 1, "spin": 0.0, "reflection": 1, "inversion": "u"},
        "X1Sigma_g+",
        {"orbital": 0, "spin": 0.0, "reflection": 1, "inversion": "g"},
        "molecules/carbon_phillips_probability",
    ),
    "C2 Ballik-Ramsay": BandSystem(
        "C2",
        "b3Sigma_g-",
        {"orbital": 0, "spin": 1.0, "reflection": -1, "inversion": "g"},
        "a3Pi_u",
        _TRIPLET_PI_U,
        "molecules/carbon_ballik_ramsay_probability",
    ),
    "C2 Swan": BandSystem(
        "C2",
        "d3Pi_g",
        {"orbital": 1, "spin": 1.0, "reflection": 1, "inversion": "g"},
        "a3Pi_u",
        _TRIPLET_PI_U,
        "molecules/carbon_swan_probability",
    ),
}


def carbon_lines(component, wavenumber_range):
    """Every line of a system of CN or C2 with its quantum numbers, none dropped.

    Parameters
    ----------
    component : str
        In `SYSTEMS`.
    wavenumber_range : (2,) [m-1]
        Lowest and highest, vacuum.

    Returns
    -------
    lines, decay
        As from `diatomic_states.system_lines`; decay by this system only. Lines between levels that do not
        exist in C2 have weight zero.

    Notes
    -----
    Source: constants of K. P. Huber, G. Herzberg (1979), see `data/gas/diatomic_carbon.yml`; probabilities
    of D. Babou, P. Riviere, M.-Y. Perrin, A. Soufiani, JQSRT 110 (2009) 89, of the Swan system of J. S. A.
    Brooke et al., JQSRT 124 (2013) 11. ASSUME: the moments do not change with rotation, spins do not
    interact but with the orbit, and states do not perturb each other (they do, by up to 10 cm-1 in C2).
    """
    system = SYSTEMS[component]
    probability = tabulated_probabilities(system.probabilities)
    mass = REDUCED_MASS[system.species]
    states, values = [], []
    sides = ((system.upper, system.upper_symmetry), (system.lower, system.lower_symmetry))
    for (name, symmetry), count in zip(sides, probability.shape, strict=True):
        constants = state_constants(CONSTANTS, system.species, name)
        values.append(rovibration(constants, mass, count - 1, count))
        states.append(ElectronicState(**symmetry, spin_orbit=constants["spin_orbit"]))
    moment = moments_of_probabilities(probability, states[0], values[0][0], states[1], values[1][0])
    return system_lines(
        states[0], values[0], states[1], values[1], moment[:, :, None], wavenumber_range, CARBON_SPIN
    )


def carbon_bands(component, wavenumber_range, *, lost_fraction, reference_temperature):
    """Line list of a system of CN or C2.

    Parameters
    ----------
    component : 'CN red', 'C2 Phillips', 'C2 Ballik-Ramsay' or 'C2 Swan'
    wavenumber_range, lost_fraction, reference_temperature
        As in `nitrogen.nitrogen_first_positive`.

    Returns
    -------
    LineList
        Species 'CN' or 'C2', ascending wavenumber. Energies above X (v = 0, N = 0).

    Raises
    ------
    ValueError
        As `nitrogen.nitrogen_first_positive`.

    Notes
    -----
    Source: as `carbon_lines`.
    """
    lines, decay = carbon_lines(component, wavenumber_range)
    exist = lines["upper_degeneracy"] > 0
    lines = {name: column[exist] for name, column in lines.items()}
    species = SYSTEMS[component].species
    return line_list(component, species, lines, decay, lost_fraction, np.asarray(reference_temperature))
