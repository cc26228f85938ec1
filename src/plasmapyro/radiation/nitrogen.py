"""Band systems of N2 and N2+."""

import numpy as np

from plasmapyro import tables
from plasmapyro.constants import ATOMIC_MASS
from plasmapyro.radiation.diatomic_rotation import ElectronicState
from plasmapyro.radiation.diatomic_states import (
    RADIUS,
    line_list,
    rovibration,
    state_constants,
    system_lines,
    tabulated_moments,
    transition_moments,
)

CONSTANTS = "gas/diatomic_nitrogen"
# [kg], of 14N (G. Audi, A. H. Wapstra, C. Thibault, Nucl. Phys. A 729 (2003) 337)
NITROGEN_MASS = 14.0030740048 * ATOMIC_MASS
NITROGEN_SPIN = 1  # [1], of 14N

# [m-1], lambda of N2 A3Sigma_u+ (K. P. Huber, G. Herzberg, Constants of Diatomic Molecules, 1979)
A_SPIN_SPIN = -133.0
A_HIGHEST_LEVEL, A_COUNT = 20, 30  # v'' up to which the constants are used, and up to the dissociation limit
B_HIGHEST_LEVEL, B_COUNT = 21, 22  # v' as far as the constants and the published probabilities go
MOMENT_CENTRE = 1.25e-10  # [m], of the power series of the transition moment
MOMENT_RANGE = (0.98e-10, 1.9e-10)  # [m], where the series is used; held beyond


def first_positive_moment(radius):
    r"""Electronic transition moment of N2 B-A, :math:`R_e(r) = \sum_k a_k (r - 1.25\,\AA)^k`.

    Parameters
    ----------
    radius : (R,) [m]

    Returns
    -------
    (R,) [e a0]

    Notes
    -----
    Source: inverted from the band strengths of C. O. Laux, C. H. Kruger, JQSRT 48 (1992) 9 (v' <= 13),
    see `data/molecules/nitrogen_first_positive_moment.yml`. Deviation: held constant outside 0.98-1.9
    Angstrom, where the series has no support.
    """
    table = tables.load("molecules/nitrogen_first_positive_moment")
    x = (np.clip(radius, *MOMENT_RANGE) - MOMENT_CENTRE) / 1e-10
    return np.polynomial.Polynomial(table["coefficient"])(x)


def first_positive_states():
    """Terms, wave functions and bound flags of N2 B3Pi_g and of A3Sigma_u+, as from `rovibration`."""
    mass = NITROGEN_MASS / 2
    return (
        rovibration(state_constants(CONSTANTS, "N2", "B3Pi_g"), mass, B_HIGHEST_LEVEL, B_COUNT),
        rovibration(state_constants(CONSTANTS, "N2", "A3Sigma_u+"), mass, A_HIGHEST_LEVEL, A_COUNT),
    )


def first_positive_lines(wavenumber_range):
    """Every line of N2 B3Pi_g - A3Sigma_u+ with its quantum numbers, none dropped.

    Parameters
    ----------
    wavenumber_range : (2,) [m-1]
        Lowest and highest, vacuum.

    Returns
    -------
    lines, decay
        As from `diatomic_states.system_lines`.

    Notes
    -----
    Source: constants of R. R. Laher, F. R. Gilmore, J. Phys. Chem. Ref. Data 20 (1991) 685.
    ASSUME: v' = 13 ... 21 radiate as in equilibrium although collisionless nitrogen predissociates there:
    in a gas in equilibrium the inverse process refills them. Their width is taken as radiative.
    """
    upper, lower = first_positive_states()
    spin_orbit = state_constants(CONSTANTS, "N2", "B3Pi_g")["spin_orbit"]
    return system_lines(
        ElectronicState(1, 1.0, 1, "g", spin_orbit=spin_orbit),
        upper,
        ElectronicState(0, 1.0, 1, "u", spin_spin=A_SPIN_SPIN),
        lower,
        transition_moments(upper[1], lower[1], first_positive_moment(RADIUS)),
        wavenumber_range,
        NITROGEN_SPIN,
    )


def nitrogen_first_positive(wavenumber_range, *, lost_fraction, reference_temperature):
    r"""Line list of the first positive system of N2, B3Pi_g - A3Sigma_u+.

    Potentials by RKR, vibration by sinc-DVR for every N, rotation and spin by diagonalising the case (a)
    Hamiltonians (27 branches), probabilities from :math:`\langle v'N'|R_e|v''N''\rangle`.

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
        Component 'N2 1P', species 'N2', ascending wavenumber. Energies above X1Sigma_g+ (v = 0, J = 0).

    Raises
    ------
    ValueError
        Range not increasing, fraction outside (0, 1], temperature not > 0.

    Notes
    -----
    Source: as `first_positive_lines`; checked against the lifetimes and probabilities of C. O. Laux,
    C. H. Kruger, JQSRT 48 (1992) 9.
    """
    lines, decay = first_positive_lines(wavenumber_range)
    return line_list("N2 1P", "N2", lines, decay, lost_fraction, reference_temperature)


def meinel_lines(wavenumber_range):
    """Every line of N2+ A2Pi_u - X2Sigma_g+ with its quantum numbers, none dropped.

    Parameters
    ----------
    wavenumber_range : (2,) [m-1]
        Lowest and highest, vacuum.

    Returns
    -------
    lines, decay
        As from `diatomic_states.system_lines`.

    Notes
    -----
    Source: constants of R. R. Laher, F. R. Gilmore, J. Phys. Chem. Ref. Data 20 (1991) 685; moments of
    S. Chauveau, M.-Y. Perrin, P. Riviere, A. Soufiani, JQSRT 72 (2002) 503, strengths uncertain by 30 %.
    ASSUME: the moments do not change with rotation. ASSUME: no spin-rotation splitting of X (0.01 N cm-1).
    """
    moment = tabulated_moments("molecules/nitrogen_ion_meinel_moment")
    mass = NITROGEN_MASS / 2  # less half an electron: 2e-5
    upper_values = state_constants(CONSTANTS, "N2+", "A2Pi_u")
    lower_values = state_constants(CONSTANTS, "N2+", "X2Sigma_g+")
    return system_lines(
        ElectronicState(1, 0.5, 1, "u", spin_orbit=upper_values["spin_orbit"]),
        rovibration(upper_values, mass, moment.shape[0] - 1, moment.shape[0]),
        ElectronicState(0, 0.5, 1, "g"),
        rovibration(lower_values, mass, moment.shape[1] - 1, moment.shape[1]),
        moment[:, :, None],
        wavenumber_range,
        NITROGEN_SPIN,
    )


def nitrogen_ion_meinel(wavenumber_range, *, lost_fraction, reference_temperature):
    """Line list of the Meinel system of N2+, A2Pi_u - X2Sigma_g+.

    Parameters
    ----------
    wavenumber_range, lost_fraction, reference_temperature
        As in `nitrogen_first_positive`.

    Returns
    -------
    LineList
        Component 'N2+ Meinel', species 'N2+', ascending wavenumber. Energies above X2Sigma_g+ (v = 0, N = 0).

    Raises
    ------
    ValueError
        As `nitrogen_first_positive`.

    Notes
    -----
    Source: as `meinel_lines`. Strengths uncertain by 30 %.
    """
    lines, decay = meinel_lines(wavenumber_range)
    return line_list("N2+ Meinel", "N2+", lines, decay, lost_fraction, reference_temperature)
