"""Band systems of NO."""

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
from plasmapyro.radiation.nitrogen import NITROGEN_MASS

CONSTANTS = "gas/diatomic_oxygen"
# [kg], of 16O (G. Audi, A. H. Wapstra, C. Thibault, Nucl. Phys. A 729 (2003) 337)
OXYGEN_MASS = 15.9949146196 * ATOMIC_MASS
REDUCED_MASS = NITROGEN_MASS * OXYGEN_MASS / (NITROGEN_MASS + OXYGEN_MASS)
NO_NUCLEAR_EXCHANGE = 0  # different nuclei: the nuclear spin does not enter
BETA_CENTRE = 1.4e-10  # [m], of the power series of the transition moment
BETA_RANGE = (1.15e-10, 1.62e-10)  # [m], where the series is used; held beyond
BETA_LEVELS = (19, 22)  # v' up to which the constants are used, and number of levels
GROUND_LEVELS = (30, 36)  # the same of v''; B reaches beyond 650 nm only into v'' > 18


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
    above v' = 0 and v'' = 3. ASSUME: the moments do not change with rotation. ASSUME: the bands 3d-3p (F, H,
    H' to C, D; 0.97-1.07 um) stay out for want of strengths: by analogy with sodium they are 0.7 times as
    bright as this system at 5000 K and 1.9 times at 8000 K.
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


def _ground(highest_level, count):
    """Symmetry, and terms, waves and flags of X2Pi as from `rovibration`, counted from X2Pi1/2."""
    values = state_constants(CONSTANTS, "NO", "X2Pi")
    term, wave, bound = rovibration(values, REDUCED_MASS, highest_level, count)
    symmetry = ElectronicState(1, 0.5, 1, "", spin_orbit=values["spin_orbit"])
    return symmetry, (term + values["spin_orbit"] / 2, wave, bound)


def beta_moment(radius):
    r"""Electronic transition moment of NO B-X, :math:`R_e(r) = \sum_k a_k (r - 1.4\,\AA)^k`.

    Parameters
    ----------
    radius : (R,) [m]

    Returns
    -------
    (R,) [e a0]

    Notes
    -----
    Source: fitted to the band moments of S. Chauveau et al., JQSRT 72 (2002) 503, see
    `data/molecules/nitric_oxide_beta_moment.yml`. Deviation: held constant outside 1.15-1.62 Angstrom,
    where the published bands give no hold.
    """
    table = tables.load("molecules/nitric_oxide_beta_moment")
    x = (np.clip(radius, *BETA_RANGE) - BETA_CENTRE) / 1e-10
    return np.polynomial.Polynomial(table["coefficient"])(x)


def beta_lines(wavenumber_range):
    """Every line of NO B2Pi - X2Pi with its quantum numbers, none dropped.

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
    Source: constants of K. P. Huber, G. Herzberg, Constants of Diatomic Molecules (1979); moment as
    `beta_moment`. In 650-1250 nm only tails of the system: v' = 6-12 into v'' = 22-30, whose strengths
    come from r > 1.6 Angstrom and are good to a factor of two.
    """
    values = state_constants(CONSTANTS, "NO", "B2Pi")
    upper = rovibration(values, REDUCED_MASS, *BETA_LEVELS)
    ground, lower = _ground(*GROUND_LEVELS)
    return system_lines(
        ElectronicState(1, 0.5, 1, "", spin_orbit=values["spin_orbit"]),
        upper,
        ground,
        lower,
        transition_moments(upper[1], lower[1], beta_moment(RADIUS)),
        wavenumber_range,
        NO_NUCLEAR_EXCHANGE,
    )


def nitric_oxide_beta(wavenumber_range, *, lost_fraction, reference_temperature):
    """Line list of the beta system of NO, B2Pi - X2Pi.

    Parameters
    ----------
    wavenumber_range, lost_fraction, reference_temperature
        As in `nitrogen.nitrogen_first_positive`.

    Returns
    -------
    LineList
        Component 'NO beta', species 'NO', ascending wavenumber. Energies above X2Pi1/2 (v = 0, J = 1/2).

    Raises
    ------
    ValueError
        As `nitrogen.nitrogen_first_positive`.

    Notes
    -----
    Source: as `beta_lines`. Strengths uncertain by a factor of two in the near infrared.
    """
    lines, decay = beta_lines(wavenumber_range)
    return line_list("NO beta", "NO", lines, decay, lost_fraction, reference_temperature)


def infrared_lines(wavenumber_range):
    """Every line of the vibration-rotation overtones of NO X2Pi, changes of v by five and more.

    Parameters
    ----------
    wavenumber_range : (2,) [m-1]
        Lowest and highest, vacuum.

    Returns
    -------
    lines, decay
        As from `diatomic_states.system_lines`; decay by these overtones only.

    Notes
    -----
    Source: constants as `beta_lines`; moments of S. Chauveau et al., JQSRT 72 (2002) 503, v' <= 22.
    ASSUME: the moments do not change with rotation.
    """
    moment = tabulated_moments("molecules/nitric_oxide_infrared_moment")
    ground, terms = _ground(len(moment) - 1, len(moment))
    term, wave, bound = terms
    count = moment.shape[1]
    return system_lines(
        ground,
        terms,
        ground,
        (term[:count], wave[..., :count], bound[:count]),
        moment[:, :, None],
        wavenumber_range,
        NO_NUCLEAR_EXCHANGE,
    )


def nitric_oxide_infrared(wavenumber_range, *, lost_fraction, reference_temperature):
    """Line list of the high overtones of NO X2Pi.

    Parameters
    ----------
    wavenumber_range, lost_fraction, reference_temperature
        As in `nitrogen.nitrogen_first_positive`.

    Returns
    -------
    LineList
        Component 'NO infrared', species 'NO', ascending wavenumber. Energies above X2Pi1/2 (v = 0, J = 1/2).

    Raises
    ------
    ValueError
        As `nitrogen.nitrogen_first_positive`.

    Notes
    -----
    Source: as `infrared_lines`. Strengths uncertain by a factor of two.
    """
    lines, decay = infrared_lines(wavenumber_range)
    return line_list("NO infrared", "NO", lines, decay, lost_fraction, reference_temperature)
