"""Radiometric calibration of a spectrometer with a blackbody source."""

import numpy as np

from plasmapyro.checks import positive
from plasmapyro.radiation.planck import blackbody_radiance

USABLE, NO_SIGNAL, SATURATED, MISSING, HOT, MASKED, LEFT_OUT = range(7)  # pixel status
STATUS = dict(enumerate("usable no_signal saturated missing hot masked left_out".split()))
NORMAL_MAD = 1.4826  # standard deviation of a normal law over its median absolute deviation


def pixel_status(counts, background, saturation, least_net):
    """Which pixels (..., W) can be used: `USABLE`, `NO_SIGNAL`, `SATURATED`, `MISSING` (0 to 3).

    Raw counts from `saturation` on are clipped by the converter; net counts up to `least_net` are no signal.
    """
    counts, background = np.broadcast_arrays(counts, background)
    status = np.full(counts.shape, USABLE, dtype="int8")
    status[counts - background <= least_net] = NO_SIGNAL
    status[(counts >= saturation) | (background >= saturation)] = SATURATED
    status[~np.isfinite(counts) | ~np.isfinite(background)] = MISSING
    return status


def calibration_factor(wavelength, counts, background, source_temperature, integration_time):
    r"""Spectral radiance per count rate, (W,) [W m-2 sr-1 m-1 s count-1]; NaN without net counts.

    .. math:: f_\lambda = \frac{L^{bb}_\lambda(T_s)}{(U_\lambda - U_{\lambda,bg}) / \Delta t}

    Source: Fagnani et al., eq. 9. ASSUME: counts proportional to radiance and integration time.

    A black body at 1773 K that gives 1000 counts above the background in 0.1 s at 1 um:

    >>> factor = calibration_factor(np.array([1e-6]), [1200.0], [200.0], 1773.0, 0.1)
    >>> f"{factor[0]:.4g} W m-2 sr-1 m-1 s per count"
    '3.563e+06 W m-2 sr-1 m-1 s per count'
    """
    net = np.asarray(counts, dtype=float) - np.asarray(background, dtype=float)
    rate = np.where(net > 0, net, np.nan) / float(positive("integration_time", integration_time, "s"))
    return blackbody_radiance(wavelength, source_temperature) / rate


def measured_radiance(counts, background, factor, integration_time):
    r"""Spectral radiance (..., W) [W m-2 sr-1 m-1] in front of the spectrometer; NaN in unusable pixels.

    .. math:: L_\lambda = \frac{U_\lambda - U_{\lambda,bg}}{\Delta t}\,f_\lambda

    with the `factor` of `calibration_factor`. Source: Fagnani et al., eq. 8.

    >>> f"{measured_radiance(np.array([1500.0]), 500.0, 4e6, 2.0)[0]:.3g} W m-2 sr-1 m-1"
    '2e+09 W m-2 sr-1 m-1'
    """
    time = float(positive("integration_time", integration_time, "s"))
    return (np.asarray(counts, dtype=float) - background) / time * factor


def local_noise(values, block):
    r"""Standard deviation (..., W) of the noise along the last axis, from second differences in blocks.

    .. math:: \hat\sigma = 1.4826\,\mathrm{median}|y_{i-1} - 2y_i + y_{i+1}| / \sqrt6

    A smooth signal cancels in the second difference, a single spike does not move the median. The estimates
    of blocks of so many samples are joined linearly; blocks that hold fewer than half of that, at an end or
    beside a gap, take their neighbours': of three differences the median is next to nothing now and then.
    NaN where no three neighbours are finite. Deviation: the paper states no noise model; this one asks
    nothing of the maker. ASSUME: noise independent from pixel to pixel; where lines vary within three pixels
    it comes out too large.
    """
    values = np.asarray(values, dtype=float)
    count = values.shape[-1]
    if count < 3 or block < 3:
        raise ValueError(f"local_noise needs three samples and blocks of three; got {count} and {block}")
    curvature = np.abs(values[..., :-2] - 2 * values[..., 1:-1] + values[..., 2:])
    edges = np.arange(0, curvature.shape[-1], block)
    centres = (edges + np.append(edges[1:], curvature.shape[-1]) - 1) / 2 + 1
    parts = np.split(curvature.reshape(-1, curvature.shape[-1]), edges[1:], axis=-1)
    level = np.stack([_median(part) for part in parts], axis=-1)
    number = np.stack([np.isfinite(part).sum(axis=-1) for part in parts], axis=-1)
    enough = number >= np.clip(number.max(axis=-1, keepdims=True), 1, block / 2)
    joined = np.full((len(level), count), np.nan)
    for row, own, kept in zip(joined, level, enough, strict=True):
        if kept.any():
            row[:] = np.interp(np.arange(count), centres[kept], own[kept])
    return joined.reshape(values.shape) * NORMAL_MAD / np.sqrt(6)


def _median(part):
    """Median over the last axis of what is finite; NaN if nothing is."""
    part = np.sort(part, axis=-1)  # NaN last
    number = np.isfinite(part).sum(axis=-1)
    pick = [
        np.take_along_axis(part, rank[..., None] // 2, -1)[..., 0]
        for rank in (np.maximum(number - 1, 0), number)
    ]
    return np.where(number > 0, (pick[0] + pick[1]) / 2, np.nan)
