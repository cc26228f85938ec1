"""Noise before all else: what bands share is flicker of the gas, the rest is the instrument's."""

from itertools import combinations, product

import numpy as np

from plasmapyro.instrument.spectrometer import NORMAL_MAD
from plasmapyro.record.rounding import rounding

THIRD_DIFFERENCES = 20.0  # variance of third differences of white noise over its own: 1 + 9 + 9 + 1
ITERATIONS, SMALLEST_SHARE = 10, 1e-3  # of the weights of the groups, and least model
# two standard errors of a covariance by medians, of third differences, which are not independent
CHANCE = 5.0
LARGEST_SHARED = 1.5  # of the lesser variance: beyond, it is no common flicker but a common course
LEAST_ALIKE = 12  # samples that tell a variance
LEAST_SHOWN = 60  # samples that show what noise a signal has
STILL = 1000  # samples of one value that err alike; of as many that move the error of rounding is gone
ERROR_OF_MAD = 1.17  # relative standard error of it, of one normal value
LEAST_BLOCKS = 100  # of samples that may stand together
LAGS = 4  # samples over which the decay of the flicker is read


def variance(values):
    """Robust variance about zero, NaN ignored; NaN where nothing else is left."""
    size = np.abs(values[np.isfinite(values)])
    return (NORMAL_MAD * np.median(size)) ** 2 if size.size else np.nan


def smoothed(signal, samples):
    """Running median over an odd number of samples, gaps bridged."""
    from scipy.ndimage import median_filter

    good = np.isfinite(signal)
    index = np.arange(signal.size)
    return median_filter(np.interp(index, index[good], signal[good]), samples, mode="nearest")


def signal_noise(signals, block):
    r"""Noise of the signals of C bands, :math:`\sigma^2 = a^2 + b^2 S^2`: floors a (C,) and shares b (C,).

    Third differences, to which a steep course is small, of samples of like S (a running median), `block` per
    estimate; the covariance of each band with the others, which is the gas's, is taken off, then a and b
    follow by non-negative least squares. ValueError if there are fewer than four blocks, or a signal has no
    noise.
    """
    from scipy.optimize import nnls

    if signals.shape[1] < 4 * block:
        raise ValueError(f"the noise needs {4 * block} samples; got {signals.shape[1]}")
    level = np.stack([smoothed(row, 11) for row in signals])[:, 1:-2]
    bend = np.diff(signals, 3, axis=1)
    floor, relative = np.zeros((2, len(signals)))
    for band, row in enumerate(level):
        scale, found, count = [], [], []
        for part in alike(row, bend[band]):
            size = np.median(np.abs(level[:, part]), axis=1)
            own, *others = np.roll(bend[:, part] / np.where(size > 0, size, 1.0)[:, None], -band, axis=0)
            whole = variance(own)
            rest = whole - np.mean([shared(own, it) for it in others] or [0.0])
            scale.append(size[band])
            count.append(part.size)
            found.append(max(rest, whole / own.size) / THIRD_DIFFERENCES)
        scale, found, count = np.array([scale, found, count])
        # Samples that stand still show none but may err by half a step.
        still = rounding(signals[band]).variance(scale, STILL) / np.where(scale > 0, scale, np.inf) ** 2
        found = np.where(found > 0, found, still)
        good = np.isfinite(found) & (found > 0) & (scale > 0)
        if not good.any():
            raise ValueError("a signal has no noise at all; give the record as measured, not interpolated")
        least, found = scale[good].min(), found[good]
        design = np.stack([(least / scale[good]) ** 2, np.ones(good.sum())], axis=1)
        model = found
        for _ in range(ITERATIONS):  # each variance is known to a share of itself, not of what was found
            weight = np.sqrt(count[good]) / model
            both, _ = nnls(design * weight[:, None], found * weight)
            model = np.maximum(design @ both, SMALLEST_SHARE * found)
        floor[band], relative[band] = np.sqrt(both) * [least, 1.0]
    return floor, relative


def standing_together(residual):
    r"""Noise (C,) per sample of residuals (C, n) such that means over samples err by their part of it.

    .. math:: \sigma = \max_B \sqrt B\,\sigma(\overline r_B)

    over blocks of B = 1, 2, 4 ... samples, robustly, NaN ignored. Of samples that move together, as in 1/f
    noise, a mean is known less well than of as many that do not. What lies within two standard errors of a
    :math:`\sigma(\overline r_B)` is white.
    """
    good = np.isfinite(residual)
    total, number = (np.cumsum(rows, axis=1) for rows in (np.where(good, residual, 0.0), good))
    size, found = 1, []
    while size == 1 or residual.shape[1] >= LEAST_BLOCKS * size:
        held, count = (np.diff(rows[:, size - 1 :: size], prepend=0) for rows in (total, number))
        chance = 1 + (2 * ERROR_OF_MAD / np.sqrt(held.shape[1]) if size > 1 else 0.0)
        whole = np.where(count > 0, held / np.sqrt(np.maximum(count, 1)), np.nan)
        found.append(NORMAL_MAD * np.nanmedian(np.abs(whole), axis=1) / chance)
        size *= 2
    return np.max(found, axis=0)


def floor_of(signals):
    """Noise (C,) of signals (C, n) without light; 0 where a record shows none or is too short to."""
    if signals.shape[1] < LEAST_SHOWN:
        return np.zeros(len(signals))
    try:
        return signal_noise(signals, LEAST_ALIKE)[0]
    except ValueError:  # a signal without any noise
        return np.zeros(len(signals))


def shared(one, other):
    """Variance that two rows of as many values have in common; 0 where it is no more than chance.

    What both share in full is no more than the variance of either; the same noise in each is.
    """
    own, its = variance(one), variance(other)
    found = (variance(one + other) - variance(one - other)) / 4
    chance = CHANCE * np.sqrt((own * its + found**2) / one.size)
    least = min(own, its)
    return min(found, least) if chance < found < LARGEST_SHARED * least else 0.0


def alike(level, bend):
    """Indices of samples in groups: of levels (n,) none is twice another one, or all are in the noise.

    `bend`: third differences (n,) there.
    """
    order = np.argsort(level, kind="stable")
    order = order[np.isfinite(bend[order])]
    least = (
        4 * np.sqrt(np.nan_to_num(variance(bend[order[:LEAST_ALIKE]])) / THIRD_DIFFERENCES)
        + np.finfo(float).tiny
    )
    height, groups, first = np.maximum(level[order], least), [], 0
    while first < order.size:
        last = np.searchsorted(height, 2 * height[first], side="right")
        groups.append(order[first:last])
        first = last
    return [one for one in groups if one.size >= LEAST_ALIKE] or [order]


def flicker(time, signals, chosen):
    r"""Flicker of the gas from what each two bands share where only gas is seen: its size [1] and time [s].

    .. math:: \langle \ln S_i(t)\,\ln S_j(t + k\Delta)\rangle = \sigma_f^2\,e^{-k\Delta/\tau_f},\quad i \ne j

    in the windows `chosen` (n,), each detrended by a straight line. NaN for both if no window holds 30
    samples, or the bands share nothing (one band: with none).
    """
    total, pairs = np.zeros(LAGS), np.zeros(LAGS)
    step = np.median(np.diff(time))
    for window in chosen:
        inside = window & (signals > 0).all(axis=0)
        if inside.sum() < 30:
            continue
        rest = [_detrended(time[inside], np.log(row[inside])) for row in signals]
        for (one, other), lag in product(combinations(rest, 2), range(LAGS)):
            products = one[: one.size - lag] * other[lag:]
            total[lag] += products.sum() + (other[: other.size - lag] * one[lag:]).sum()
            pairs[lag] += 2 * products.size
    if not pairs.all() or total[0] <= 0:
        return np.nan, np.nan
    shared = total / pairs
    ratio = np.clip(shared[1:].sum() / shared[:-1].sum(), 0.05, 0.98)
    return float(np.sqrt(shared[0])), float(-step / np.log(ratio))


def _detrended(time, values):
    return values - np.polynomial.Polynomial.fit(time, values, 1)(time)
