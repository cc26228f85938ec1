"""Planck's law and integrals over narrow bins, independent of the package under test."""

import numpy as np
import scipy

# CODATA 2018 values, exact by the definition of the SI.
H = 6.62607015e-34
C = 299792458.0
K = 1.380649e-23


def planck(wavelength, temperature):
    """Blackbody radiance [W m-2 sr-1 m-1] through the photon energy in units of kT."""
    energy = H * C / (np.asarray(wavelength) * K * np.asarray(temperature))
    return 2 * H * C * C / np.asarray(wavelength) ** 5 / np.expm1(energy)


def between(share, first, second):
    """Spectrum at a share of the way from one to another, linear in the logarithms."""
    low, high = (np.log(np.maximum(one, 1e-30)) for one in (first, second))
    return np.exp((1 - share) * low + share * high)


def bins(low, high, size):
    """Edges (B+1,) and centres (B,) of equal bins of at most `size` between two wavelengths [m]."""
    edges = np.linspace(low, high, int(np.ceil((high - low) / size)) + 1)
    return edges, (edges[1:] + edges[:-1]) / 2


def bin_mean(wavelength, radiance, edges):
    """Mean of a piecewise linear spectrum over each bin; the integral is kept exactly, lines included."""
    if edges[0] < wavelength[0] or edges[-1] > wavelength[-1]:
        raise ValueError(
            f"the spectrum covers {wavelength[0] * 1e9:g} to {wavelength[-1] * 1e9:g} nm;"
            f" {edges[0] * 1e9:g} to {edges[-1] * 1e9:g} nm are needed"
        )
    slices = np.diff(wavelength) * (radiance[1:] + radiance[:-1]) / 2
    total = np.concatenate([[0.0], np.cumsum(slices)])
    place = np.clip(np.searchsorted(wavelength, edges) - 1, 0, wavelength.size - 2)
    step = edges - wavelength[place]
    slope = (radiance[place + 1] - radiance[place]) / (wavelength[place + 1] - wavelength[place])
    return np.diff(total[place] + step * (radiance[place] + slope * step / 2)) / np.diff(edges)


def band(response_wavelength, responsivity):
    """Edges (B+1,), centres (B,) and quadrature weights (B,) [m] of a band: responsivity times bin."""
    edges, centres = bins(response_wavelength[0], response_wavelength[-1], 0.25e-9)
    response = scipy.interpolate.CubicSpline(response_wavelength, responsivity)
    return edges, centres, response(centres) * np.diff(edges)


def through_slit(edges, radiance, pixels, fwhm):
    """Bin means of a spectrum as pixels with a Gaussian slit function see it."""
    sigma = fwhm / np.sqrt(8 * np.log(2))
    seen = np.empty(pixels.size)
    for index, centre in enumerate(pixels):
        first, last = np.searchsorted(edges, [centre - 6 * sigma, centre + 6 * sigma])
        first, last = max(first - 1, 0), min(last, edges.size - 1)
        weight = np.diff(scipy.special.erf((edges[first : last + 1] - centre) / (np.sqrt(2) * sigma)))
        seen[index] = np.sum(weight * radiance[first:last]) / weight.sum()
    return seen
