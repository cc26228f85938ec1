"""Band systems of NO."""

from plasmapyro.constants import ATOMIC_MASS
from plasmapyro.radiation.diatomic_rotation import ElectronicState
from plasmapyro.radiation.diatomic_states import (
    line_list,
    rovibration,
    state_constants,
    system_lines,
    tabulated_moments,
)
from plasmapyro.radiation.nitrogen import NITROGEN_MASS

CONSTANTS = "gas/diatomic_oxygen"
# [kg], of 16O (G. Audi, A. H. Wapstra, C. Thibault, Nucl. Phys. A 729 (2003) 337)
OXYGEN_MASS = 15.9949146196 * ATOMIC_MASS
REDUCED_MASS = NITROGEN_MASS * OXYGEN_MASS / (NITROGEN_MASS + OXYGEN_MASS)
NO_NUCLEAR_EXCHANGE = 0  # different nuclei: the nuclear spin does not enter


def eleven_thousand_angstrom_lines(wavenumber_range):
    """Every line of NO D2Sigma+ - A2Sigma+ with its quantum numbers, none dropped.

    Parameters
    ----------
    wavenumber_range : (2,) [m-1]
        Lowest and highest, vacuum.

    Returns
    -------
    lines, decay
        As from `diatomic_states.system_lines`; decay into A only.

    Notes
    -----
    Source: constants of K. P. Huber, G. Herzberg, Constants of Diatomic Molecules (1979), whose energies
    count from X2Pi1/2, the lowest level; moments of S. Chauveau, M.-Y. Perrin, P. Riviere, A. Soufiani,
    JQSRT 72 (2002) 503, strengths uncertain by 30 %. ASSUME: v' <= 5, as published: at 8000 K a tenth of
    the molecules in D would lie above. ASSUME: populations in equilibrium although D and A predissociate
    above v' = 0 and v'' = 3. ASSUME: the moments do not change with rotation.
    """
    moment = tabulated_moments("molecules/nitric_oxide_11000_moment")
    sigma = ElectronicState(0, 0.5, 1, "")
    upper = state_constants(CONSTANTS, "NO", "D2Sigma+")
    lower = state_constants(CONSTANTS, "NO", "A2Sigma+")
    return system_lines(
        sigma,
        rovibration(upper, REDUCED_MASS, moment.shape[0] - 1, moment.shape[0]),
        sigma,
        rovibration(lower, REDUCED_MASS, moment.shape[1] - 1, moment.shape[1]),
        moment[:, :, None],
        wavenumber_range,
        NO_NUCLEAR_EXCHANGE,
    )


def nitric_oxide_11000(wavenumber_range, *, lost_fraction, reference_temperature):
    """Line list of the 11000 Angstrom system of NO, D2Sigma+ - A2Sigma+.

    Parameters
    ----------
    wavenumber_range, lost_fraction, reference_temperature
        As in `nitrogen.nitrogen_first_positive`.

    Returns
    -------
    LineList
        Component 'NO 11000 A', species 'NO', ascending wavenumber. Energies above X2Pi1/2 (v = 0, J = 1/2).

    Raises
    ------
    ValueError
        As `nitrogen.nitrogen_first_positive`.

    Notes
    -----
    Source: as `eleven_thousand_angstrom_lines`. Strengths uncertain by 30 %.
    """
    lines, decay = eleven_thousand_angstrom_lines(wavenumber_range)
    return line_list("NO 11000 A", "NO", lines, decay, lost_fraction, reference_temperature)
