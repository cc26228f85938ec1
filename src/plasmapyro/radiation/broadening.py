"""Widths of atomic and molecular lines: thermal motion, decay, electrons, neutrals, resonance."""

import numpy as np

from plasmapyro.checks import non_negative, positive
from plasmapyro.constants import (
    BOHR_RADIUS,
    BOLTZMANN,
    ELECTRON_MASS,
    ELEMENTARY_CHARGE,
    LIGHT_SPEED,
    PLANCK,
    RYDBERG,
    VACUUM_PERMITTIVITY,
)
from plasmapyro.radiation.lines import VAN_DER_WAALS_EXPONENT, WIDTH_REFERENCE_TEMPERATURE, once

COULOMB_SQUARE = ELEMENTARY_CHARGE**2 / (4 * np.pi * VACUUM_PERMITTIVITY)  # e^2/(4 pi eps0) [J m]
CLASSICAL_RADIUS = COULOMB_SQUARE / (ELECTRON_MASS * LIGHT_SPEED**2)  # of the electron [m]
LINDHOLM = 8.08  # [1], impact theory of a r^-6 frequency shift


def doppler_sigma(temperature, mass):
    r"""Relative standard deviation of the wavenumber by thermal motion.

    .. math:: \sigma = \sqrt{k T / m c^2}

    Source: Griem, Spectral Line Broadening by Plasmas (1974), section I.1.

    ValueError if an argument is not > 0.

    Parameters
    ----------
    temperature : array_like [K]
    mass : array_like [kg]
        Of the radiating particle.

    Returns
    -------
    ndarray [1]
        Times the wavenumber it is the standard deviation of the Gaussian profile; the same for every
        line of a species, hence constant on a logarithmic wavenumber axis.
    """
    temperature = positive("temperature", temperature, "K")
    mass = positive("mass", mass, "kg")
    return np.sqrt(BOLTZMANN * temperature / mass) / LIGHT_SPEED


def natural_hwhm(upper_decay, lower_decay):
    r"""Half width [m-1] by the finite life of both levels, of their decays [s-1] by all lines together.

    .. math:: \gamma_{nat} = \frac{A_u + A_l}{4 \pi c}

    Source: Griem (1974), section I.1; Laux et al., Plasma Sources Sci. Technol. 12 (2003) 125, table 3.
    """
    upper_decay = non_negative("upper_decay", upper_decay, "s-1")
    lower_decay = non_negative("lower_decay", lower_decay, "s-1")
    return (upper_decay + lower_decay) / (4 * np.pi * LIGHT_SPEED)


def mean_square_radius(binding, angular_momentum):
    r"""Mean square distance [m2] of the outer electron from the core, hydrogen-like; never below a_0^2.

    .. math:: \langle r^2 \rangle = \frac{n^2}{2} \left(5 n^2 + 1 - 3 l (l+1)\right) a_0^2,
              \qquad n^2 = R_\infty / \tilde E

    with the energy E [m-1] > 0 below the ionisation limit the level belongs to. The formula turns negative
    for levels that are not hydrogen-like. Source: Bates and Damgaard (1949), as used by Laux et al. (2003),
    section 3.
    """
    square = RYDBERG / positive("binding", binding, "m-1")
    orbital = np.asarray(angular_momentum)
    radius = square / 2 * (5 * square + 1 - 3 * orbital * (orbital + 1))
    return np.maximum(radius, 1.0) * BOHR_RADIUS**2


def van_der_waals_hwhm(upper_radius, lower_radius, polarisability, reduced_mass, temperature):
    r"""Half width [m2] = [m-1 per m-3] per neutral perturber, impact theory with Unsold's :math:`C_6`.

    .. math:: \gamma_W = \frac{8.08}{4 \pi c} \left( \frac{e^2 \alpha}{4 \pi \varepsilon_0 \hbar}
              \left| \langle r_u^2 \rangle - \langle r_l^2 \rangle \right| \right)^{2/5} \bar v^{3/5},
              \qquad \bar v = \sqrt{8 k T / \pi \mu}

    with the mean square radii [m2] of the levels, the polarisability (volume) [m3] of the perturber and the
    reduced mass [kg] of radiator and perturber. Source: Unsold (1955), section 82; Griem (1974), chapter II.
    """
    shift = COULOMB_SQUARE * polarisability * np.abs(upper_radius - lower_radius) * 2 * np.pi / PLANCK
    speed = np.sqrt(8 * BOLTZMANN * temperature / (np.pi * reduced_mass))
    return LINDHOLM / (4 * np.pi * LIGHT_SPEED) * shift**0.4 * speed**0.6


def resonance_hwhm(wavenumber, decay, degeneracy, ground_degeneracy):
    r"""Half width [m2] = [m-1 per m-3] a level contributes by exchange with unexcited atoms of its kind.

    .. math:: w_R = \frac{3 r_e}{8 \pi} \frac{f}{\tilde\nu_R} \sqrt{g_0 / g},
              \qquad f = \frac{A}{8 \pi^2 r_e c\, \tilde\nu_R^2} \frac{g}{g_0}

    of the resonance line from the level to the ground term, whose wavenumber is the level's energy [m-1] and
    whose decay is A [s-1], 0 where there is no such line. To be added for both levels of a line. Source:
    Griem (1974), section II.4, in the form of Laux et al. (2003), equation 18.
    """
    wavenumber = positive("wavenumber", wavenumber, "m-1")
    weight = degeneracy / ground_degeneracy
    unit_decay = 8 * np.pi**2 * CLASSICAL_RADIUS * LIGHT_SPEED * wavenumber**2
    return 3 * CLASSICAL_RADIUS / (8 * np.pi) * decay * weight / unit_decay / wavenumber / np.sqrt(weight)


def lorentz_hwhm(lines, temperature, electron_density, neutral_density, own_density, electron_temperature):
    """Lorentz half widths [m-1] of a line list in one gas state, summed as `LineList` defines it.

    Densities [m-3] of the electrons, of all neutral particles, and of the radiating species;
    `electron_temperature` [K] for the Stark widths. Source: Griem (1974): widths of independent Lorentz
    mechanisms add. ASSUME: Stark widths are the electron-impact ones (isolated lines, linear in the electron
    density); ion broadening (below 10 % at 1e22 m-3) and line shifts are left out.
    """
    ratio = float(temperature) / WIDTH_REFERENCE_TEMPERATURE
    hot = float(electron_temperature) / WIDTH_REFERENCE_TEMPERATURE
    natural, stark, neutral, resonance = (
        once(values)
        for values in (lines.natural_hwhm, lines.stark_hwhm, lines.van_der_waals_hwhm, lines.resonance_hwhm)
    )
    width = natural
    if stark.any():
        width = width + stark * electron_density * hot**lines.stark_exponent
    if neutral.any():
        width = width + neutral * neutral_density * ratio**VAN_DER_WAALS_EXPONENT
    if resonance.any():
        width = width + resonance * own_density
    return np.broadcast_to(width, len(lines))
