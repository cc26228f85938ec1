"""Line lists of the electronic band systems of molecular nitrogen."""

import numpy as np

from plasmapyro import tables
from plasmapyro.constants import ATOMIC_MASS, BOLTZMANN, LIGHT_SPEED, STANDARD_ATMOSPHERE
from plasmapyro.radiation.diatomic_curves import potential_curve, vibrational_states
from plasmapyro.radiation.diatomic_lines import EINSTEIN_FACTOR, STEPS, strong_enough, transition_lines
from plasmapyro.radiation.diatomic_rotation import ElectronicState, rotational_levels
from plasmapyro.radiation.lines import (
    VAN_DER_WAALS_EXPONENT,
    WIDTH_REFERENCE_TEMPERATURE,
    LineList,
)

CONSTANTS = "gas/diatomic_nitrogen"
NITROGEN_MASS = (
    14.0030740048 * ATOMIC_MASS
)  # [kg], 14N (Audi, Wapstra & Thibault, Nucl. Phys. A 729 (2003) 337)
NITROGEN_SPIN = 1  # [1], 14N
A_SPIN_SPIN = (
    -133.0
)  # [m-1], lambda of N2 A3Sigma_u+ (Huber & Herzberg, Constants of Diatomic Molecules, 1979)
MOMENT_CENTRE = 1.25e-10  # [m], of the power series of the transition moment
MOMENT_RANGE = (0.98e-10, 1.9e-10)  # [m], where the series is used; held beyond

RADIUS = np.arange(
    0.85e-10, 2.8e-10, 0.013e-10
)  # [m], 24 points per wave at 40000 cm-1; levels move < 0.01 cm-1
HIGHEST_ROTATION = (
    200  # J; B v = 0 reaches its centrifugal barrier there, and above is under 1e-4 of the emission
)
UPPER_COUNT = 22  # v' of B: as far as the constants and the published arrays of probabilities go
LOWER_COUNT = 30  # v'' of A, up to the dissociation limit
A_HIGHEST_LEVEL = 20  # v'' of A up to which the constants are used

# ASSUME: half width of 0.05 cm-1 per atmosphere at 296 K, typical of N2 and of diatomics in air, falling as
# T^-0.7 at constant pressure. At 50 mbar and 8000 K this is 0.5 % of the Doppler width: of no consequence.
_REFERENCE_HWHM = 5.0 / (STANDARD_ATMOSPHERE / (BOLTZMANN * 296.0))  # [m2]
COLLISION_HWHM = _REFERENCE_HWHM * (WIDTH_REFERENCE_TEMPERATURE / 296.0) ** VAN_DER_WAALS_EXPONENT  # [m2]


def constants(name):
    """Spectroscopic constants of a state of N2 or N2+.

    Parameters
    ----------
    name : str
        As in the table: 'A3Sigma_u+', 'B3Pi_g', ...

    Returns
    -------
    dict
        Row of the table `gas/diatomic_nitrogen` (SI), and the ascending coefficients `vibration` of
        G(v + 1/2) and `rotation` of B(v + 1/2) [m-1] added.
    """
    table = tables.load(CONSTANTS)
    row = int(np.flatnonzero(table["state"] == name)[0])
    values = {key: column[row] for key, column in table.columns.items()}
    values["vibration"] = np.array(
        [values["we"], -values["wexe"], values["weye"], values["weze"], values["weae"]]
    )
    values["rotation"] = np.array(
        [values["be"], -values["alphae"], values["gammae"], values["deltae"], values["epsilone"]]
    )
    return values


def rovibration(name, highest_level, count):
    r"""Potential, levels and wave functions of a state of N2 or N2+.

    Term values above v = 0 of the ground state follow the constants up to `highest_level` and the potential
    beyond; rotation and its stretching follow the potential,

    .. math:: E_v(N) = T_0 + G(v) - G(0) + E^{DVR}_{vN} - E^{DVR}_{v0}

    Parameters
    ----------
    name : str
    highest_level : int
        Last v of which the constants are used.
    count : int
        Number of vibrational levels.

    Returns
    -------
    term : (v, N) [m-1]
        N = 0 ... HIGHEST_ROTATION + 1.
    wave : (N, R, v) [1]
        On `RADIUS`.
    bound : (v, N) bool

    Notes
    -----
    Source: R. R. Laher, F. R. Gilmore, J. Phys. Chem. Ref. Data 20 (1991) 685 (constants).
    """
    values = constants(name)
    vibration = np.polynomial.Polynomial(np.concatenate(([0.0], values["vibration"])))
    depth = values["limit"] - values["origin"] + vibration(0.5)
    mass = NITROGEN_MASS / 2
    potential = potential_curve(RADIUS, values["vibration"], values["rotation"], mass, highest_level, depth)
    energy, wave, bound = vibrational_states(RADIUS, potential, mass, np.arange(HIGHEST_ROTATION + 2), count)
    level = np.arange(count)
    correction = (
        vibration(np.minimum(level, highest_level) + 0.5) - energy[0, np.minimum(level, highest_level)]
    )
    term = values["origin"] - vibration(0.5) + energy + correction
    return term.T, wave, bound.T


def transition_moments(upper_wave, lower_wave, electronic):
    r"""Moments :math:`\langle v' N' | R_e(r) | v'' N'' \rangle` with N' - N'' = -1, 0, 1.

    Parameters
    ----------
    upper_wave, lower_wave : (N, R, v) [1]
        As from `vibrational_states`.
    electronic : (R,) [e a0]

    Returns
    -------
    (3, v', v'', N'') [e a0]
        Zero where N' would leave the table.
    """
    weighted = lower_wave * electronic[:, None]
    count = len(lower_wave)
    moments = np.zeros((len(STEPS), upper_wave.shape[2], lower_wave.shape[2], count))
    for index, step in enumerate(STEPS):
        low = np.arange(max(0, -step), count - max(0, step))
        product = np.swapaxes(upper_wave[low + step], 1, 2) @ weighted[low]
        moments[index][:, :, low] = np.moveaxis(product, 0, 2)
    return moments


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


def first_positive_lines(wavenumber_range):
    """Every line of N2 B3Pi_g - A3Sigma_u+ with its quantum numbers, none dropped.

    Parameters
    ----------
    wavenumber_range : (2,) [m-1]
        Lowest and highest, vacuum.

    Returns
    -------
    lines : dict of (L,) arrays
        As from `diatomic_lines.transition_lines`.
    decay : (v',) [s-1]
        Total probability of the vibrational levels of B without rotation.

    Notes
    -----
    Source: constants of R. R. Laher, F. R. Gilmore, J. Phys. Chem. Ref. Data 20 (1991) 685.
    ASSUME: v' = 13 ... 21 radiate as in equilibrium although collisionless nitrogen predissociates there:
    in a gas in equilibrium the inverse process refills them. Their width is taken as radiative.
    ASSUME: J' and J'' stand for N' and N'' in the transition moments (Herman-Wallis effect to first order).
    """
    upper_state = ElectronicState(1, 1.0, 1, "g", spin_orbit=constants("B3Pi_g")["spin_orbit"])
    lower_state = ElectronicState(0, 1.0, 1, "u", spin_spin=A_SPIN_SPIN)
    upper_term, upper_wave, upper_bound = rovibration("B3Pi_g", UPPER_COUNT - 1, UPPER_COUNT)
    lower_term, lower_wave, lower_bound = rovibration("A3Sigma_u+", A_HIGHEST_LEVEL, LOWER_COUNT)
    moment = transition_moments(upper_wave, lower_wave, first_positive_moment(RADIUS))
    momentum = np.arange(HIGHEST_ROTATION + 1)
    lines = transition_lines(
        rotational_levels(upper_state, momentum, upper_term, upper_bound),
        rotational_levels(lower_state, momentum, lower_term, lower_bound),
        moment[..., : len(momentum)],
        wavenumber_range,
        NITROGEN_SPIN,
    )
    origin = np.maximum(upper_term[:, None, 0] - lower_term[None, :, 0], 0.0)
    decay = (EINSTEIN_FACTOR * origin**3 * moment[STEPS.index(0), :, :, 0] ** 2).sum(axis=1)
    return lines, decay


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
    natural = decay[lines["upper_v"].astype(int)] / (4 * np.pi * LIGHT_SPEED)
    return line_list("N2 1P", "N2", lines, natural, lost_fraction, reference_temperature)


def line_list(component, species, lines, natural_hwhm, lost_fraction, reference_temperature):
    """The strong lines of a dictionary of lines as the engine's `LineList`; arguments as above."""
    keep = strong_enough(lines, reference_temperature, lost_fraction)
    names = (
        "wavenumber",
        "upper_energy",
        "lower_energy",
        "upper_degeneracy",
        "lower_degeneracy",
        "einstein_a",
    )
    return LineList(
        component,
        species,
        **{name: lines[name][keep] for name in names},
        natural_hwhm=natural_hwhm[keep],
        van_der_waals_hwhm=COLLISION_HWHM,
        origin="published",
    )
