"""What a surface of uneven or changing temperature adds to the light, to second order."""

import numpy as np

from plasmapyro.checks import non_negative, positive
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.radiation.planck import blackbody_radiance


def planck_derivatives(wavelength, temperature):
    r"""Planck's law with its first two derivatives by the temperature.

    .. math:: \frac{B'}{B} = \frac{x}{T} a, \qquad
              \frac{B''}{B} = \Big(\frac{x}{T}\Big)^2 a (2a - 1) - \frac{2x}{T^2} a, \qquad
              x = \frac{c_2}{\lambda T},\ a = \frac1{1 - e^{-x}}

    Parameters
    ----------
    wavelength : array_like [m], > 0
    temperature : array_like [K], > 0; broadcasts against `wavelength`

    Returns
    -------
    radiance, first, second : ndarrays [W m-2 sr-1 m-1, per K, per K2]
    """
    radiance = blackbody_radiance(wavelength, temperature)
    x = SECOND_RADIATION / (wavelength * temperature)
    a = -1 / np.expm1(-x)
    first = x / temperature * a
    second = (x / temperature) ** 2 * a * (2 * a - 1) - 2 * first / temperature
    return radiance, radiance * first, radiance * second


def footprint_variance(footprint_diameter, edge_drop, edge_radius):
    r"""Mean drop and variance of the temperature within a round footprint about the centre of a disc.

    .. math:: T(r) = T_0 - \Delta\,(r/R)^2 \;\Rightarrow\;
              T_0 - \bar T = \frac{\Delta}{2}\Big(\frac{d}{2R}\Big)^2, \qquad
              \sigma_T^2 = \frac{\Delta^2}{12}\Big(\frac{d}{2R}\Big)^4

    Parameters
    ----------
    footprint_diameter : float [m], >= 0
        14 mm for the pyrometer, 10 mm for the spectrometer of the paper.
    edge_drop : float [K]
        Temperature of the centre less that at the radius R.
    edge_radius : float [m], > 0

    Returns
    -------
    mean_drop : float [K], below the temperature of the centre
    variance : float [K2]

    Notes
    -----
    Source: Fagnani et al., sec. 3 (diameters of the probing areas); the mean over a disc of a parabola.
    ASSUME: a parabola, and equal weight over the footprint.
    """
    share = float(non_negative("footprint_diameter", footprint_diameter, "m")) / (
        2 * float(positive("edge_radius", edge_radius, "m"))
    )
    return edge_drop * share**2 / 2, (edge_drop * share**2) ** 2 / 12


def exposure_variance(time, temperature, integration_time):
    r"""Variance of the temperature within each exposure, :math:`(\dot T\,\Delta t)^2 / 12`.

    Parameters
    ----------
    time : (t,) array [s], strictly increasing
    temperature : (t,) array [K]
    integration_time : float [s], >= 0

    Returns
    -------
    (t,) ndarray [K2]
    """
    span = float(non_negative("integration_time", integration_time, "s"))
    return (np.gradient(temperature, time) * span) ** 2 / 12
