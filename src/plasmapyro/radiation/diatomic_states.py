"""Electronic states of the molecules by name: constants, term values, wave functions, lines."""

import numpy as np

from plasmapyro import tables
from plasmapyro.constants import BOLTZMANN, STANDARD_ATMOSPHERE
from plasmapyro.gas.partition import ROTATION, VIBRATION
from plasmapyro.radiation.diatomic_curves import potential_curve, vibrational_states
from plasmapyro.radiation.diatomic_lines import EINSTEIN_FACTOR, STEPS, orbital_doubling, transition_lines
from plasmapyro.radiation.diatomic_rotation import rotational_levels
from plasmapyro.radiation.lines import VAN_DER_WAALS_EXPONENT, WIDTH_REFERENCE_TEMPERATURE

# [m]; 3.7 points per wave at 40000 cm-1 of kinetic energy of N2; halving the step moves levels by < 0.01 cm-1
RADIUS = np.arange(0.85e-10, 2.8e-10, 0.013e-10)
# J; N2 B v = 0 reaches its centrifugal barrier there, and what lies above is under 1e-4 of the emission
HIGHEST_ROTATION = 200

# ASSUME: half width of 0.05 cm-1 per atmosphere at 296 K, typical of N2 and of diatomics in air, falling as
# T^-0.7 at constant pressure. At 50 mbar and 8000 K this is 0.5 % of the Doppler width: of no consequence.
_REFERENCE_HWHM = 5.0 / (STANDARD_ATMOSPHERE / (BOLTZMANN * 296.0))  # [m2]
COLLISION_HWHM = _REFERENCE_HWHM * (WIDTH_REFERENCE_TEMPERATURE / 296.0) ** VAN_DER_WAALS_EXPONENT  # [m2]

ROUNDING = 1e-6  # [m-1]; the eigenvalue of a level at zero may come out this far below


def state_constants(table_name, species, state):
    """Spectroscopic constants of an electronic state, such as 'B3Pi_g' of 'N2' in 'gas/diatomic_nitrogen'.

    The row of the table (SI) with, in addition, the ascending coefficients `vibration` of G(v + 1/2) and
    `rotation` of B(v + 1/2) and the energy `origin` of v = 0 above v = 0 of the first state of the species,
    all [m-1].
    """
    table = tables.load(table_name)
    rows = np.flatnonzero(table["species"] == species)
    row = rows[table["state"][rows] == state][0]

    def coefficients(signs, row):
        return np.array([sign * table[name][row] for name, sign in signs.items() if name in table.columns])

    values = {name: column[row] for name, column in table.columns.items()}
    values["vibration"] = coefficients(VIBRATION, row)
    values["rotation"] = coefficients(ROTATION, row)
    if "origin" not in values:
        zero_point = [ladder(coefficients(VIBRATION, which))(0.5) for which in (row, rows[0])]
        values["origin"] = values["minimum"] + zero_point[0] - zero_point[1]
    return values


def ladder(vibration):
    """Vibrational energy G(x), x = v + 1/2, as a polynomial, from its ascending coefficients."""
    return np.polynomial.Polynomial(np.concatenate(([0.0], vibration)))


def rovibration(values, reduced_mass, highest_level, count, *, waves=True):
    r"""Term values and wave functions of an electronic state.

    Vibration follows the constants up to `highest_level` and the potential beyond; rotation and its
    stretching follow the potential:

    .. math:: E_v(N) = T_0 + G(v) - G(0) + E^{DVR}_{vN} - E^{DVR}_{v0}

    Source: as `diatomic_curves`.

    Parameters
    ----------
    values : dict
        As from `state_constants`.
    reduced_mass : float [kg]
    highest_level : int
        Last v for which the constants hold.
    count : int
        Number of vibrational levels.
    waves : bool
        Whether wave functions are wanted.

    Returns
    -------
    term : (v, N) [m-1]
        Above v = 0 of the ground state; N = 0 ... HIGHEST_ROTATION + 1.
    wave : (N, R, v) [1] or None
        On `RADIUS`.
    bound : (v, N) bool
    """
    vibration = ladder(values["vibration"])
    depth = values["limit"] - values["origin"] + vibration(0.5)
    potential = potential_curve(
        RADIUS, values["vibration"], values["rotation"], reduced_mass, highest_level, depth
    )
    rotation_number = np.arange(HIGHEST_ROTATION + 2)
    energy, wave, bound = vibrational_states(
        RADIUS, potential, reduced_mass, rotation_number, count, waves=waves
    )
    known = np.minimum(np.arange(count), highest_level)
    term = values["origin"] + (energy - energy[0, known]) + (vibration(known + 0.5) - vibration(0.5))
    return term.T, wave, bound.T


def transition_moments(upper_wave, lower_wave, electronic):
    r"""Moments :math:`\langle v' N' | R_e(r) | v'' N'' \rangle` (3, v', v'', N'') [e a0].

    The steps N' - N'' are -1, 0, 1. Of waves (N, R, v) as from `vibrational_states` and `electronic` (R,) [e
    a0]; 0 where N' would leave the table.
    """
    weighted = lower_wave * electronic[:, None]
    count = len(lower_wave)
    moments = np.zeros((len(STEPS), upper_wave.shape[2], lower_wave.shape[2], count))
    for index, step in enumerate(STEPS):
        low = np.arange(max(0, -step), count - max(0, step))
        product = np.swapaxes(upper_wave[low + step], 1, 2) @ weighted[low]
        moments[index][:, :, low] = np.moveaxis(product, 0, 2)
    return moments


def moments_of_probabilities(probability, upper_state, upper_term, lower_state, lower_term):
    r"""Band moments (v', v'') [e a0] that give the probabilities [s-1] of rotationless bands.

    .. math:: R_{v'v''}^2 = A_{v'v''} / (K\, g\, \tilde\nu_{v'v''}^3)

    with K and g of `diatomic_lines.transition_lines` and terms as from `rovibration`; 0 where the upper level
    lies below the lower.
    """
    origin = upper_term[:, None, 0] - lower_term[None, :, 0]
    factor = EINSTEIN_FACTOR * orbital_doubling(upper_state, lower_state)
    return np.sqrt(np.where(origin > 0, probability / (factor * np.abs(origin) ** 3), 0.0))


def system_lines(upper_state, upper, lower_state, lower, moment, wavenumber_range, nuclear_spin):
    """Every line of a system, and the decay of its upper vibrational levels.

    Parameters
    ----------
    upper_state, lower_state : ElectronicState
    upper, lower : tuple
        Terms, waves and bound flags as from `rovibration`.
    moment : (3, v', v'', N'') or broadcastable [e a0]
        ASSUME: J' and J'' stand for N' and N'' there (Herman-Wallis effect to first order).
    wavenumber_range : (2,) [m-1]
        Lowest and highest, vacuum.
    nuclear_spin : int [1]

    Returns
    -------
    lines : dict of (L,) arrays
        As from `diatomic_lines.transition_lines`, with `upper_rotation` and `lower_rotation`, the parts of
        the energies above the rotationless vibrational level [m-1].
    decay : (v',) [s-1]
        Total probability of the vibrational levels without rotation.
    """
    momentum = np.arange(HIGHEST_ROTATION + 1) + upper_state.spin % 1
    moment = np.broadcast_to(moment, (len(STEPS), len(upper[0]), len(lower[0]), HIGHEST_ROTATION + 2))
    lines = transition_lines(
        rotational_levels(upper_state, momentum, upper[0], upper[2]),
        rotational_levels(lower_state, momentum, lower[0], lower[2]),
        moment[..., : len(momentum)],
        wavenumber_range,
        nuclear_spin,
    )
    for side, term in (("upper", upper[0]), ("lower", lower[0])):
        lines[f"{side}_rotation"] = lines[f"{side}_energy"] - term[lines[f"{side}_v"].astype(int), 0]
    origin = np.maximum(upper[0][:, None, 0] - lower[0][None, :, 0], 0.0)
    decay = (EINSTEIN_FACTOR * origin**3 * moment[STEPS.index(0), :, :, 0] ** 2).sum(axis=1)
    return lines, decay * orbital_doubling(upper_state, lower_state)
