"""A spectrum seen through a spectrometer with a Gaussian slit function."""

import numpy as np

from plasmapyro.checks import increasing, positive

FWHM_PER_SIGMA = 2 * np.sqrt(2 * np.log(2))
REACH = 5.0  # standard deviations; leaves out 6e-7 of the slit function


def slit_wavelengths(wavelength, fwhm, samples_per_fwhm=5):
    """Coarse axis [m] on which the slit function lies within the spectrum: `REACH` sigma from either end.

    ValueError if the spectrum is too short for one slit function, or too coarse.
    """
    wavelength = increasing("wavelength", wavelength, "m")
    margin = REACH * _sigma(wavelength, fwhm)
    first, last = wavelength[0] + margin, wavelength[-1] - margin
    if last <= first:
        raise ValueError(
            f"slit fwhm must be below {(wavelength[-1] - wavelength[0]) * FWHM_PER_SIGMA / (2 * REACH):g} m"
            f" for this spectrum; got {float(fwhm):g} m"
        )
    return np.linspace(first, last, int((last - first) / fwhm * samples_per_fwhm) + 1)


def through_slit(wavelength, radiance, wavelength_slit, fwhm):
    r"""Convolve a spectrum with a Gaussian of constant width in wavelength.

    .. math:: L_{slit}(\lambda) = \frac{\int L(\lambda')\, e^{-(\lambda'-\lambda)^2/2s^2}\, d\lambda'}
              {\int e^{-(\lambda'-\lambda)^2/2s^2}\, d\lambda'}, \qquad s = \mathrm{FWHM}/2.3548

    Source: Fagnani et al., sec. 4.2 (FWHM 0.75 nm).
    Deviation: their sec. 3.3 prints 0.75 um; 0.75 nm is meant.

    ValueError if the slit function at a wanted wavelength reaches beyond the spectrum, or is narrower than
    the grid.

    Parameters
    ----------
    wavelength : (G,) [m]
        Increasing, fine enough for the spectrum.
    radiance : (..., G)
    wavelength_slit : (K,) [m]
        Where the result is wanted; as from `slit_wavelengths`.
    fwhm : float [m]

    Returns
    -------
    ndarray (..., K)
        The mean of a constant is the constant (both integrals by the same trapezoidal rule).
    """
    wavelength = increasing("wavelength", wavelength, "m")
    sigma = _sigma(wavelength, fwhm)
    tolerance = 1e-9 * wavelength[-1]
    if wavelength_slit[0] - REACH * sigma < wavelength[0] - tolerance or (
        wavelength_slit[-1] + REACH * sigma > wavelength[-1] + tolerance
    ):
        raise ValueError(
            f"slit view must stay {REACH * sigma:g} m inside [{wavelength[0]:g}, {wavelength[-1]:g}] m;"
            f" got [{wavelength_slit[0]:g}, {wavelength_slit[-1]:g}] m"
        )
    weight = np.gradient(wavelength)
    first = np.searchsorted(wavelength, wavelength_slit - REACH * sigma)
    last = np.searchsorted(wavelength, wavelength_slit + REACH * sigma)
    result = np.empty((*np.shape(radiance)[:-1], len(wavelength_slit)))
    for k, (low, high) in enumerate(zip(first, last, strict=True)):
        kernel = weight[low:high] * np.exp(-(((wavelength[low:high] - wavelength_slit[k]) / sigma) ** 2) / 2)
        # einsum, not @: the bytes must not depend on the number of BLAS threads.
        result[..., k] = np.einsum("...g,g->...", radiance[..., low:high], kernel / kernel.sum())
    return result


def _sigma(wavelength, fwhm):
    """Standard deviation of a slit function [m]; refuses one narrower than the grid."""
    sigma = float(positive("fwhm", fwhm, "m")) / FWHM_PER_SIGMA
    coarsest = np.max(np.diff(wavelength))
    if coarsest > sigma:
        raise ValueError(f"slit fwhm must be > {FWHM_PER_SIGMA * coarsest:g} m on this grid; got {fwhm:g} m")
    return sigma
