"""Noise before all else: what bands share is flicker of the gas, the rest is the instrument's."""

from itertools import combinations, product

import numpy as np

NORMAL_MAD = 1.4826  # standard deviation of a normal law over its median absolute deviation
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
    r"""Noise of the signals of C bands, :math:`\sigma^2 = a^2 + b^2 S^2`.

    Blocks of second differences of S over its running median; the covariance of each band with the others,
    which is the gas's, is taken off, then a and b follow by non-negative least squares.

    Parameters
    ----------
    signals : (C, n) array
    block : int
        Samples per estimate.

    Returns
    -------
    floor : (C,) ndarray, unit of the signals
    relative : (C,) ndarray [1]

    Raises
    ------
    ValueError
        If there are fewer than four blocks, or a signal has no noise.
    """
    from scipy.optimize import nnls

    level = np.stack([smoothed(row, 11) for row in signals])
    count = signals.shape[1] // block
    if count < 4:
        raise ValueError(f"the noise needs {4 * block} samples; got {signals.shape[1]}")
    bend = signals[:, :-2] - 2 * signals[:, 1:-1] + signals[:, 2:]
    parts = np.array_split(np.arange(bend.shape[1]), count)
    bands = range(len(signals))
    floor, relative = np.zeros((2, len(signals)))
    found = np.full((len(signals), count), np.nan)
    scale = np.stack([[np.median(np.abs(row[part])) for part in parts] for row in level])
    for place, part in enumerate(parts):
        each = bend[:, part] / scale[:, place, None]
        for band, own in enumerate(each):
            shared = [(variance(own + it) - variance(own - it)) / 4 for it in np.delete(each, band, axis=0)]
            found[band, place] = max(variance(own) - max(np.mean(shared or 0.0), 0.0), 0.0) / 6
    for band in bands:
        good = np.isfinite(found[band]) & (found[band] > 0) & (scale[band] > 0)
        if not good.any():
            raise ValueError("a signal has no noise at all; give the record as measured, not interpolated")
        inverse = scale[band, good].min() / scale[band, good]
        weight = 1 / np.maximum(found[band, good], np.median(found[band, good]))
        design = np.stack([inverse**2, np.ones(good.sum())], axis=1) * weight[:, None]
        (square, constant), _ = nnls(design, found[band, good] * weight)
        floor[band] = np.sqrt(square) * scale[band, good].min()
        relative[band] = np.sqrt(constant)
    return floor, relative


def flicker(time, signals, chosen):
    r"""Flicker of the gas from what each two bands share where only gas is seen.

    .. math:: \langle \ln S_i(t)\,\ln S_j(t + k\Delta)\rangle = \sigma_f^2\,e^{-k\Delta/\tau_f},\quad i \ne j

    Parameters
    ----------
    time : (n,) array [s]
    signals : (C, n) array
    chosen : sequence of (n,) bool arrays
        Windows without surface, each detrended by a straight line.

    Returns
    -------
    standard_deviation : float [1]
    correlation_time : float [s]
        NaN for both if no window holds 30 samples, or the bands share nothing (one band: with none).
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
