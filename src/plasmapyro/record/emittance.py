"""What is known of an emittance: its slope between two bands, its table, its course over wavelength; and how
far the level and the ratio of a pyrometer alone may be off."""

import numpy as np

from plasmapyro.radiation.bandsignal import two_bands
from plasmapyro.radiation.planck import blackbody_radiance

PIVOT = 0.95e-6  # [m] ASSUME: where the stated emittance holds
PER_MICRON = 1e6  # [m-1]: unit of slopes over wavelength
UNTOLD = 0.1  # [1] of the level of the emissivity, where a test states no uncertainty
UNTOLD_SLOPE = 0.01  # [1] of the emittance in the wide band over that in the narrow one: 0.1 per um
ANY_LEVEL = 3.0  # of the logarithm of a level that is not known
# ASSUME: dirt, a misplaced sample, a field that is not filled, a window left out of the calibration.
# [1] that a pyrometer alone does not see the light that calibration and emittance say
THROUGHPUT_CHANCE = 0.2
THROUGHPUT_WIDTH = 0.3  # [1] standard deviation of its logarithm then
GOING_ON = 0.5  # [1] ASSUME: share of the variance of a course whose slope and bend go on
# ASSUME: metals, whose emittance falls by some per cent from band to band; a gain; an amplifier near its end.
RATIO_CHANCE = 0.2  # [1] that the ratio of the bands of a pyrometer alone is not the one that is stated
RATIO_WIDTH = 0.05  # [1] standard deviation of its logarithm then
# ASSUME: metals (Hagen & Rubens: root of T to T); what reflects less may change by less.
EXPONENT = 0.5  # [1] standard, of the emittance of what reflects all, over the temperature
HOT = 1600.0  # [K] of the surface whose light weights the bands


def tilt(slope, response):
    r"""Slope b [m-1] of the emittance over wavelength that gives the bands, wide over narrow, a ratio s.

    .. math:: \varepsilon(\lambda) = \varepsilon\,[1 + b\,(\lambda - \lambda_0)], \qquad
              s = \frac{1 + b\,(\bar\lambda_1 - \lambda_0)}{1 + b\,(\bar\lambda_2 - \lambda_0)}

    with the mean wavelengths of the light of a hot surface in the bands; 0 for a grey surface.
    """
    if slope == 1:
        return 0.0
    wavelength = two_bands(response, "a slope of the emittance")["wavelength"].values
    light = blackbody_radiance(wavelength, HOT)
    wide, narrow = (
        np.trapezoid(weight * (wavelength - PIVOT), wavelength) / np.trapezoid(weight, wavelength)
        for weight in (light * response[f"responsivity_{band}"].values for band in ("wide", "narrow"))
    )
    return float((1 - slope) / (slope * narrow - wide))


def tilt_uncertainty(slope, uncertainty, response):
    """Standard uncertainty [m-1] of the `tilt` of a ratio of bands that is uncertain by so much [1]."""
    return abs(tilt(slope + uncertainty, response) - tilt(slope, response)) if uncertainty else 0.0


def relative_emittance(wavelength, tilt):
    """Emittance (...) at wavelengths (...) [m] over the stated one, see `tilt`."""
    return 1 + tilt * (np.asarray(wavelength) - PIVOT)


def mean_emittance(attributes, wavelength):
    """Emittance (...) [1] that a test or a source states, at wavelengths (...) [m]: one number, or a table.

    Between the points of a table its logarithm is straight; beyond its ends it stays.
    """
    if "emittance_wavelength" not in attributes:
        return np.full(np.shape(wavelength), float(attributes["emittance"]))
    points, values = (np.asarray(attributes[f"emittance_{one}"]) for one in ("wavelength", "table"))
    return np.exp(np.interp(wavelength, points, np.log(values)))


def with_temperature(kelvin, emittance):
    r"""Standard uncertainty (t,) [1] of the logarithm of an emittance that is told where the surface is
    hottest, at temperatures (t,) [K]: it may follow them, the more the more it reflects.

    .. math:: u = \frac{1}{2} (1 - \varepsilon) \ln\frac{T_{max}}{T}

    >>> with_temperature(np.array([1000.0, 1500.0]), 0.3).round(3).tolist()
    [0.142, 0.0]
    """
    return EXPONENT * (1 - emittance) * np.log(np.nanmax(kelvin) / kelvin)


def smooth(wavelength, length):
    """Covariance (N, N) of what is smooth over a length [m]: of variance 1, and squared exponential."""
    return np.exp(-(((wavelength[:, None] - wavelength) / length) ** 2) / 2)


def course(wavelength, shape, length):
    r"""Covariance (N, N) of the logarithm of an emissivity over wavelength about its stated level.

    .. math:: \frac{u_1^2}{2} (P K P^T + Q K Q^T), \quad
              K_{ij} = \frac{1}{2} \Bigl[e^{-(x_i - x_j)^2/2} + x_i x_j + \frac{3}{4} x_i^2 x_j^2\Bigr], \quad
              x = (\lambda - \bar\lambda)/\ell

    P takes the mean over the wavelengths off, Q the value in their middle: what is stated of the level is
    stated of one or the other, as likely. Half of K is smooth and forgets itself over the length; in the
    other half the slope and the bend that such a course has at one place go on.

    Without the second half a surface that is tilted or curved over 500 nm, but hardly rough, was too likely
    one of another temperature: 95 % intervals held 51 to 85 % of them.

    Parameters
    ----------
    wavelength : (N,) array [m]
    shape : float [1], u1
    length : float [m], l
    """
    x = np.append(0.0, (wavelength - np.mean(wavelength)) / length)  # the middle comes first
    going = np.outer(x, x) + 0.75 * np.outer(x**2, x**2)
    whole = (1 - GOING_ON) * smooth(x, 1.0) + GOING_ON * going
    number = np.size(wavelength)
    less_middle = np.column_stack([-np.ones(number), np.eye(number)])
    less_mean = np.column_stack([np.zeros(number), np.eye(number) - 1 / number])
    return shape**2 / 2 * sum(less @ whole @ less.T for less in (less_mean, less_middle))
