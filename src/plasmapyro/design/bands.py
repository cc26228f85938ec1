"""Filters and detectors of a pyrometer, as means over bins of wavelength."""

import numpy as np
from scipy.special import ndtr

from plasmapyro.checks import positive
from plasmapyro.instrument.response import layered_efficiency, silicon_absorption
from plasmapyro.radiation.slit import FWHM_PER_SIGMA

SHAPES = ("box", "gaussian")


def transmittance(edges, centre, fwhm, shape):
    r"""Mean transmittance (..., B) [1] of filters (...) in each bin between edges (B + 1,) [m], peak 1.

    A box passes the share of the bin that it covers; a Gaussian is integrated over the bin, :math:`\bar\tau =
    \frac{\sqrt{2\pi}\sigma}{\Delta\lambda}[\Phi(x_2) - \Phi(x_1)]`.
    """
    if shape not in SHAPES:
        raise ValueError(f"filter shape must be one of {', '.join(SHAPES)}; got {shape!r}")
    centre = positive("centre", centre, "m")[..., None]
    fwhm = positive("fwhm", fwhm, "m")[..., None]
    size = np.diff(edges)
    if shape == "box":
        low = np.maximum(edges[:-1], centre - fwhm / 2)
        return np.clip(np.minimum(edges[1:], centre + fwhm / 2) - low, 0.0, None) / size
    sigma = fwhm / FWHM_PER_SIGMA
    return np.sqrt(2 * np.pi) * sigma * np.diff(ndtr((edges - centre) / sigma), axis=-1) / size


def efficiency(name, wavelength, detectors, silicon, silicon_thickness):
    r"""Modelled quantum efficiency (B,) [1] of a detector of the table 'instrument/detectors'.

    Silicon absorbs in one layer, :math:`\eta = \eta_0 (1 - e^{-\alpha d})`, zero where its table ends; the
    compounds pass a band with error-function edges, :math:`\eta = \eta_0 [\Phi(x_{on}) - \Phi(x_{off})]`.
    Source: certificates of the tables. ASSUME: no curve of a real detector; limits are the makers' nominal
    ones.
    """
    row = detector_row(name, detectors)
    peak = detectors["efficiency"][row]
    if name == "silicon":
        inside = (wavelength >= silicon["wavelength"][0]) & (wavelength <= silicon["wavelength"][-1])
        result = np.zeros(wavelength.shape)
        alpha = silicon_absorption(
            wavelength[inside], silicon["wavelength"], silicon["absorption_coefficient"]
        )
        result[inside] = peak * layered_efficiency(alpha, silicon_thickness, silicon_thickness)[0]
        return result
    on, off, sigma = (detectors[key][row] for key in ("cut_on", "cut_off", "edge_sigma"))
    return peak * (ndtr((wavelength - on) / sigma) - ndtr((wavelength - off) / sigma))


def detector_row(name, detectors):
    """Row of a detector in its table; ValueError with the known names otherwise."""
    known = list(detectors["detector"])
    if name not in known:
        raise ValueError(f"detector must be one of {', '.join(known)}; got {name!r}")
    return known.index(name)


def air_loss(edges, bands):
    r"""Weak-line bound on what room air absorbs in each bin (B,) [m-1]: :math:`W / \Delta\tilde\nu`.

    `bands`: table 'instrument/air_bands', with the equivalent width W [m-1 per m of path].
    """
    middle, loss = (edges[1:] + edges[:-1]) / 2, np.zeros(edges.size - 1)
    for first, last, equivalent in zip(bands["first"], bands["last"], bands["equivalent_width"], strict=True):
        inside = (middle >= first) & (middle <= last)
        loss[inside] += equivalent / (1 / first - 1 / last)
    return loss
