"""Wavelengths in air and in vacuum."""

import numpy as np

from plasmapyro.checks import within

LOWEST, HIGHEST = 170e-9, 2.6e-6  # [m] of the dispersion formula (230 nm to 1.69 um), with margins
ITERATIONS = 3  # each gains four digits


def air_index(wavelength):
    r"""Refractive index of standard air (15 C, 101 325 Pa, dry, 450 ppm CO2).

    .. math:: n - 1 = \frac{0.05792105}{238.0185 - \sigma^2} + \frac{0.00167917}{57.362 - \sigma^2}

    Source: P. E. Ciddor, Appl. Opt. 35, 1566 (1996), eq. 1. Valid 230 nm to 1.69 um. Beyond, where
    spectrometers have pixels and little signal, it is extrapolated: at 170 nm it may be off by 1e-5
    (0.002 nm). ASSUME: a laboratory differs from standard air by less than 5 % in density, which moves a
    wavelength by less than 0.02 nm.

    ValueError: outside the validity.

    Parameters
    ----------
    wavelength : array_like [m]
        In vacuum, 170 nm to 2.6 um; :math:`\sigma` is its inverse in um-1.

    Returns
    -------
    ndarray [1]
    """
    squared = (1e-6 / within("wavelength", wavelength, LOWEST, HIGHEST, "m")) ** 2
    return 1 + 0.05792105 / (238.0185 - squared) + 0.00167917 / (57.362 - squared)


def vacuum_wavelength(wavelength_air):
    """Wavelength in vacuum [m] of a wavelength in standard air [m] (see `air_index`)."""
    wavelength_air = within("wavelength_air", wavelength_air, LOWEST, HIGHEST / 1.001, "m")
    vacuum = wavelength_air * 1.0003
    for _ in range(ITERATIONS):
        vacuum = wavelength_air * air_index(vacuum)
    return np.asarray(vacuum)


def air_wavelength(wavelength):
    """Wavelength in standard air [m] of a wavelength in vacuum [m] (see `air_index`)."""
    return np.asarray(wavelength, dtype=float) / air_index(wavelength)
