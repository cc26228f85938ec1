"""Band signals: a spectrum, or lines and a continuum without any grid, weighted with a response."""

import numpy as np

from plasmapyro.checks import increasing

BANDS = ("wide", "narrow")  # S_1 and S_2 of the paper
UNSEEN = 1e-3  # [1], of the integrated response that may lie outside the spectrum


def bands_of(response):
    """Names of the bands of a dataset of contract 'response': `BANDS`, or those of a radiometer."""
    return list(map(str, response.band.values)) if "responsivity" in response else list(BANDS)


def responsivities(response):
    """Responsivities (R,) [1] of the bands of a dataset of contract 'response', in `bands_of` order."""
    if "responsivity" in response:
        return list(response.responsivity.values)
    return [response[f"responsivity_{band}"].values for band in BANDS]


def two_bands(response, what):
    """`response` of a two-colour pyrometer; else ValueError: `what` cannot take another."""
    if "responsivity" in response:
        names = ", ".join(bands_of(response))
        raise ValueError(f"{what} needs the wide and the narrow band of a two-colour pyrometer; got {names}")
    return response


def respond(wavelength, response_wavelength, responsivity):
    """Responsivity [1] at a wavelength [m]: linear between the points (R,) of a table, 0 outside it.

    ValueError if `response_wavelength` does not increase.
    """
    response_wavelength = increasing("response_wavelength", response_wavelength, "m")
    return np.interp(wavelength, response_wavelength, responsivity, left=0.0, right=0.0)


def require_cover(wavelength_range, response_wavelength, responsivity, what):
    """Refuse a spectral range that leaves out part of a band.

    ValueError if more than `UNSEEN` of the integral of the response lies outside the range; says the range
    needed.
    """
    inside = np.clip(response_wavelength, *wavelength_range)
    whole = np.trapezoid(responsivity, response_wavelength)
    seen = np.trapezoid(respond(inside, response_wavelength, responsivity), inside)
    if seen < (1 - UNSEEN) * whole:
        support = response_wavelength[np.asarray(responsivity) > 0]
        raise ValueError(
            f"wavelength_range must cover the {what} band, [{support[0]:g}, {support[-1]:g}] m;"
            f" got [{wavelength_range[0]:g}, {wavelength_range[1]:g}] m"
        )


def band_signal(wavelength, responsivity, radiance):
    r"""Relative signal of a spectrum in a band, :math:`S / \Theta k = \int \tilde R\, L_\lambda\, d\lambda`.

    Source: Fagnani et al., eq. 1 without throughput and gain, which are the sensitivity of the band.

    Parameters
    ----------
    wavelength : (W,) [m]
        Increasing.
    responsivity : (W,) [1]
        There, normalised to a peak of 1; as from `respond`.
    radiance : (..., W) [W m-2 sr-1 m-1]

    Returns
    -------
    ndarray (...) [W m-2 sr-1]
        Trapezoidal rule.

    Examples
    --------
    A band of 200 nm with straight flanks in light of 1 W m-2 sr-1 per nm:

    >>> wavelength = np.array([0.9e-6, 1.0e-6, 1.1e-6])
    >>> f"{band_signal(wavelength, np.array([0.0, 1.0, 0.0]), 1e9):.1f} W m-2 sr-1"
    '100.0 W m-2 sr-1'
    """
    return np.trapezoid(responsivity * radiance, wavelength, axis=-1)


def gridless_signal(
    lines, continuum_wavelength, continuum, wavelength_range, response_wavelength, responsivity
):
    r"""Signal [W m-2 sr-1] of optically thin gas without resolving a line.

    .. math:: S = \sum_l \tilde R(\lambda_l)\, L_l + \int \tilde R\, L_c\, d\lambda

    `lines`: pairs of wavelength (L,) [m] and radiance by line (L,) [W m-2 sr-1], which counts within the
    range; continuum (W,) [W m-2 sr-1 m-1], linear between its points. Source: thin limit of the transfer
    equation. Lines are taken as narrow against the response.
    """
    total = 0.0
    for wavelength, radiance in lines:
        inside = (wavelength >= wavelength_range[0]) & (wavelength <= wavelength_range[1])
        weight = respond(wavelength[inside], response_wavelength, responsivity)
        total += np.sum(radiance[inside] * weight)
    nodes = np.union1d(continuum_wavelength, response_wavelength)
    first = max(wavelength_range[0], response_wavelength[0])
    last = min(wavelength_range[1], response_wavelength[-1])
    nodes = nodes[(nodes >= first) & (nodes <= last)]
    middle = (nodes[1:] + nodes[:-1]) / 2
    # The product of two straight lines is a parabola between nodes: Simpson's rule is exact.
    values = [
        np.interp(x, continuum_wavelength, continuum) * respond(x, response_wavelength, responsivity)
        for x in (nodes, middle)
    ]
    return total + np.sum(np.diff(nodes) * (values[0][1:] + values[0][:-1] + 4 * values[1])) / 6
