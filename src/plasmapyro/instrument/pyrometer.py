"""What a two-colour ratio pyrometer makes of a spectrum: band signals, their ratio, a temperature."""

import numpy as np
from scipy.integrate import trapezoid

from plasmapyro.checks import increasing
from plasmapyro.radiation.planck import blackbody_radiance


def band_signal(wavelength, responsivity, radiance):
    r"""Relative band signal :math:`\int \tilde R\,L_\lambda\,d\lambda`, by the trapezoidal rule.

    Parameters
    ----------
    wavelength : (W,) array [m], strictly increasing
    responsivity : (W,) array [1], normalised to a peak of 1
    radiance : (..., W) array [W m-2 sr-1 m-1]

    Returns
    -------
    (...) ndarray [W m-2 sr-1]

    Notes
    -----
    Source: Fagnani et al., eq. 1 without throughput and gain, which are the sensitivity of the band.
    """
    return trapezoid(responsivity * radiance, wavelength, axis=-1)


def blackbody_signal(temperature, wavelength, responsivity):
    """Band signal of a black body, on the wavelengths of the response.

    Parameters
    ----------
    temperature : (...) array [K], > 0
    wavelength : (R,) array [m]
    responsivity : (R,) array [1]

    Returns
    -------
    (...) ndarray [W m-2 sr-1]
    """
    radiance = blackbody_radiance(wavelength, np.asarray(temperature, dtype=float)[..., None])
    return band_signal(wavelength, responsivity, radiance)


def signal_ratio(signal_wide, signal_narrow):
    """Ratio of the band signals, NaN where either is not > 0 (a ratio of noise is no ratio).

    Parameters
    ----------
    signal_wide, signal_narrow : (...) arrays, same unit

    Returns
    -------
    (...) ndarray [1]

    Notes
    -----
    Source: Fagnani et al., eq. 4.
    """
    wide, narrow = np.broadcast_arrays(
        np.asarray(signal_wide, dtype=float), np.asarray(signal_narrow, dtype=float)
    )
    good = (wide > 0) & (narrow > 0)
    return np.divide(wide, narrow, out=np.full(wide.shape, np.nan), where=good)


def invert_ratio(ratio, calibration_temperature, calibration_ratio):
    r"""Temperature a pyrometer would report for a signal ratio, :math:`H_c^{-1}(\rho)`.

    Interpolates 1/T linearly in ln(ratio), which is exact in the Wien limit for two narrow bands,
    and never extrapolates.

    Parameters
    ----------
    ratio : (...) array [1], > 0 or NaN
    calibration_temperature : (C,) array [K], strictly increasing
    calibration_ratio : (C,) array [1], strictly increasing

    Returns
    -------
    temperature : (...) ndarray [K]
        NaN exactly where `status` is not 0 or the ratio is NaN.
    status : (...) int8 ndarray
        0 within the calibration, -1 below it, +1 above it; 0 for NaN.

    Raises
    ------
    ValueError
        If a calibration array does not increase strictly.

    Notes
    -----
    Source: Fagnani et al., eq. 6.
    """
    temperature = increasing("calibration_temperature", calibration_temperature, "K")
    nodes = increasing("calibration_ratio", calibration_ratio, "1")
    ratio = np.asarray(ratio, dtype=float)
    status = np.where(ratio < nodes[0], -1, np.where(ratio > nodes[-1], 1, 0)).astype("int8")
    inside = np.where(status == 0, ratio, np.nan)
    return 1 / np.interp(np.log(inside), np.log(nodes), 1 / temperature), status
