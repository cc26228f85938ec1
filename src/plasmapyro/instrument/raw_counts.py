"""From raw counts to linear count rates: baseline, dark, linearity, bad pixels, exposures."""

import numpy as np

from plasmapyro.checks import increasing, positive
from plasmapyro.instrument.spectrometer import NORMAL_MAD, local_noise

ROUNDS = 5  # of outlier rejection; it settles in two or three
REJECTED = 4.0  # standard deviations
AROUND = 10  # pixels on either side that make the surroundings of one


def linear_signal(signal, coefficients):
    r"""Signal [count] of a detector with its non-linearity taken out.

    .. math:: U_{lin} = U / \sum_k a_k U^k

    with the relative response in rising powers (K,) [count^-k], as spectrometer makers state it; (1,) for
    none. The signal is that above the electrical baseline, dark charge included: the converter sees both.
    ValueError if the polynomial is not within 0.5 and 1.5 over the signals: it does not hold there.

    Source: the correction of the makers' programs (Ocean Optics, OOINLCorrect), seventh order there.
    Deviation: those subtract the dark spectrum first; dark charge fills the same wells as light.
    """
    signal = np.asarray(signal, dtype=float)
    response = np.polynomial.polynomial.polyval(signal, np.asarray(coefficients, dtype=float))
    wrong = np.isfinite(signal) & ~((response > 0.5) & (response < 1.5))
    if wrong.any():
        at = signal[wrong].flat[0]
        raise ValueError(
            f"the linearity polynomial gives {response[wrong].flat[0]:g} at {at:g} count;"
            " it must lie in 0.5 to 1.5"
        )
    return signal / response


def baseline(counts, masked):
    """Electrical baseline [count]: the mean of the masked pixels (indices) of (..., W) raw counts."""
    masked = np.asarray(masked, dtype=int)
    if masked.size == 0:
        raise ValueError("masked pixels: at least one is needed for the electrical baseline")
    return np.mean(np.asarray(counts, dtype=float)[..., masked], axis=-1, keepdims=True)


def dark_scale(light, dark, dim):
    r"""How much the dark current changed between a dark exposure and one in light, and its uncertainty [1].

    The dark current differs from pixel to pixel in a fixed pattern. In the `dim` pixels (W,), of little or
    smooth light, that pattern is all that varies from pixel to pixel, and its amplitude gives the scale:

    .. math:: \Delta^2 U_{light} = s\,\Delta^2 U_{dark} + noise

    solved by orthogonal regression, since both exposures, (W,) [count] above the baseline and of the same
    integration time, are equally noisy. ValueError: fewer than 30 usable triples of pixels, or no pattern.
    (1, 0) is not assumed anywhere: the uncertainty tells whether the pattern was strong enough.

    The common remedies (a dark close in time, masked pixels) do not see a sensor that warms up between both
    exposures; a degree changes the current by 8 to 10 %. ASSUME: the pattern scales as a whole, i.e. all
    pixels have the same activation energy.
    """
    light, dark, dim = np.broadcast_arrays(light, dark, dim)
    inner = dim[:-2] & dim[1:-1] & dim[2:] & np.isfinite(_curvature(light) + _curvature(dark))
    y, x = _curvature(light)[inner], _curvature(dark)[inner]
    if x.size < 30:
        raise ValueError(f"dark_scale needs 30 dim pixels with both neighbours; got {x.size}")
    for _ in range(ROUNDS):
        scale = _orthogonal_slope(x, y)
        residual = y - scale * x
        spread = NORMAL_MAD * np.median(np.abs(residual))
        kept = np.abs(residual) <= REJECTED * max(spread, np.finfo(float).tiny)
        if kept.all() or kept.sum() < 30:
            break
        x, y = x[kept], y[kept]
    scale = _orthogonal_slope(x, y)
    # Neighbouring second differences share pixels: about 1/3 of them are independent.
    uncertainty = np.std(y - scale * x) / np.sqrt(np.sum(x**2) / 3)
    return float(scale), float(uncertainty)


def _curvature(values):
    values = np.asarray(values, dtype=float)
    return values[1:-1] - (values[2:] + values[:-2]) / 2


def _orthogonal_slope(x, y):
    xx, yy, xy = np.sum(x * x), np.sum(y * y), np.sum(x * y)
    if not xy > 0:
        raise ValueError(
            "the dark exposure shows no pattern that the other shares; give `dark_scale` a value"
        )
    return (yy - xx + np.hypot(yy - xx, 2 * xy)) / (2 * xy)


def hot_pixels(dark, threshold):
    """Pixels (W,) whose dark signal [count] lies far above that of their neighbours.

    `threshold` [1] in standard deviations of the pattern of its surroundings (robust).
    """
    dark = np.asarray(dark, dtype=float)
    padded = np.pad(dark, AROUND, mode="reflect")
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * AROUND + 1)
    level = np.nanmedian(around, axis=-1)
    spread = NORMAL_MAD * np.nanmedian(np.abs(dark - level))
    return dark - level > positive("threshold", threshold, "1") * spread


def net_rate(light, dark, *, integration_time, coefficients, masked, dim, noise_block):
    r"""Linear count rate of the light alone, with its uncertainty.

    .. math:: r = \frac{f(U - b) - s f(U_d - b_d)}{\Delta t}

    with the linearisation `f` (`linear_signal`), the baselines `b` and the dark scale `s` (`dark_scale`;
    without `dim` pixels the dark is taken as it is). No light reaches the `masked` pixels; without them the
    baseline is left to the dark. `noise_block` is the number of pixels per noise estimate.

    Returns the rate (W,) [count s-1], its standard uncertainty (W,) from noise, independent between pixels,
    that from the dark scale, common to all, and the scale [1].
    """
    time = float(positive("integration_time", integration_time, "s"))
    above, below = (above_baseline(values, coefficients, masked) for values in (light, dark))
    scale, uncertainty = (1.0, 0.0) if dim is None else dark_scale(above, below, dim)
    rate = (above - scale * below) / time
    return rate, local_noise(rate, noise_block), np.abs(uncertainty * below / time), scale


def above_baseline(counts, coefficients, masked):
    """Linear signal (..., W) [count] above the electrical baseline, dark charge included.

    `masked`: pixels that no light reaches. Without any no baseline is taken off; light less dark still loses
    it, the linearity sees it as signal.
    """
    counts = np.asarray(counts, dtype=float)
    return linear_signal(counts - baseline(counts, masked) if len(masked) else counts, coefficients)


def combined(rates, noise, usable):
    """Mean rate and noise (W,) [count s-1] of exposures (E, W), weighted with their noise, of usable pixels.

    NaN where no exposure is usable.
    """
    good = usable & np.isfinite(rates) & (noise > 0)
    weight = np.where(good, 1 / np.where(good, noise, 1.0) ** 2, 0.0)
    total = weight.sum(axis=0)
    lit = total > 0
    mean = np.sum(weight * np.where(good, rates, 0.0), axis=0) / np.where(lit, total, 1.0)
    return np.where(lit, mean, np.nan), np.where(lit, 1 / np.sqrt(np.where(lit, total, 1.0)), np.nan)


def certified_source(wavelength, certificate_wavelength, certificate_value):
    r"""Spectral radiance or irradiance (W,) of a certified lamp between the points (C,) of its certificate.

    Interpolates :math:`\ln(E\lambda^5)` linearly in :math:`1/\lambda`, in which a Planckian in Wien's limit
    is a straight line; NaN outside. Source: the usual interpolation of FEL certificates; J. H. Walker et al.,
    NBS Special Publication 250-20 (1987), sec. 5, takes the same form with a polynomial for the emissivity of
    tungsten.
    """
    points = increasing("certificate_wavelength", certificate_wavelength, "m")
    value = np.log(positive("certificate_value", certificate_value, "W") * points**5)
    wavelength = np.asarray(wavelength, dtype=float)
    inside = (wavelength >= points[0]) & (wavelength <= points[-1])
    found = np.exp(np.interp(-1 / wavelength, -1 / points, value)) / wavelength**5
    return np.where(inside, found, np.nan)
