"""Noise before all else: what both bands share is flicker of the gas, the rest is the instrument's."""

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
    r"""Noise of the signals of both bands, :math:`\sigma^2 = a^2 + b^2 S^2`.

    Blocks of second differences of S over its running median; the covariance of the two bands, which is
    the gas's, is taken off, then a and b follow by non-negative least squares.

    Parameters
    ----------
    signals : (2, n) array [A]
    block : int
        Samples per estimate.

    Returns
    -------
    floor : (2,) ndarray [A]
    relative : (2,) ndarray [1]

    Raises
    ------
    ValueError
        If there are fewer than four blocks.
    """
    from scipy.optimize import nnls

    level = np.stack([smoothed(row, 11) for row in signals])
    count = signals.shape[1] // block
    if count < 4:
        raise ValueError(f"the noise needs {4 * block} samples; got {signals.shape[1]}")
    bend = signals[:, :-2] - 2 * signals[:, 1:-1] + signals[:, 2:]
    parts = np.array_split(np.arange(bend.shape[1]), count)
    floor, relative = np.zeros(2), np.zeros(2)
    found = np.full((2, count), np.nan)
    scale = np.stack([[np.median(np.abs(row[part])) for part in parts] for row in level])
    for place, part in enumerate(parts):
        one, other = (bend[band, part] / scale[band, place] for band in (0, 1))
        shared = (variance(one + other) - variance(one - other)) / 4
        for band, own in enumerate((one, other)):
            found[band, place] = max(variance(own) - max(shared, 0.0), 0.0) / 6
    for band in (0, 1):
        good = np.isfinite(found[band]) & (found[band] > 0) & (scale[band] > 0)
        inverse = scale[band, good].min() / scale[band, good]
        weight = 1 / np.maximum(found[band, good], np.median(found[band, good]))
        design = np.stack([inverse**2, np.ones(good.sum())], axis=1) * weight[:, None]
        (square, constant), _ = nnls(design, found[band, good] * weight)
        floor[band] = np.sqrt(square) * scale[band, good].min()
        relative[band] = np.sqrt(constant)
    return floor, relative


def flicker(time, signals, chosen):
    r"""Flicker of the gas from what the two bands share where only gas is seen.

    .. math:: \langle \ln S_1(t)\,\ln S_2(t + k\Delta)\rangle = \sigma_f^2\,e^{-k\Delta/\tau_f}

    Parameters
    ----------
    time : (n,) array [s]
    signals : (2, n) array [A]
    chosen : sequence of (n,) bool arrays
        Windows without surface, each detrended by a straight line.

    Returns
    -------
    standard_deviation : float [1]
    correlation_time : float [s]
        NaN for both if no window holds 30 samples, or the bands share nothing.
    """
    total, pairs = np.zeros(LAGS), np.zeros(LAGS)
    step = np.median(np.diff(time))
    for window in chosen:
        inside = window & (signals > 0).all(axis=0)
        if inside.sum() < 30:
            continue
        rest = [_detrended(time[inside], np.log(row[inside])) for row in signals]
        for lag in range(LAGS):
            products = rest[0][: rest[0].size - lag] * rest[1][lag:]
            total[lag] += products.sum() + (rest[1][: rest[1].size - lag] * rest[0][lag:]).sum()
            pairs[lag] += 2 * products.size
    if not pairs.all() or total[0] <= 0:
        return np.nan, np.nan
    shared = total / pairs
    ratio = np.clip(shared[1:].sum() / shared[:-1].sum(), 0.05, 0.98)
    return float(np.sqrt(shared[0])), float(-step / np.log(ratio))


def _detrended(time, values):
    return values - np.polynomial.Polynomial.fit(time, values, 1)(time)
