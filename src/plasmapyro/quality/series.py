"""Numbers that several rules take from a record: runs, steps, falls."""

import numpy as np
from scipy.ndimage import median_filter

from plasmapyro.instrument.spectrometer import NORMAL_MAD

SIDE = 6  # blocks on each side of a step: enough to fit a line and to tell its scatter
MOST_BLOCKS = 3000


def blocks(time, values, begin, end, least=0.0):
    """Means (..., n) of a record over blocks and their times (n,); no NaN.

    At most `MOST_BLOCKS`, none shorter than `least` [s].
    """
    held = (time >= begin) & (time <= end) & np.isfinite(values).all(axis=tuple(range(values.ndim - 1)))
    time, values = time[held], values[..., held]
    if time.size < 2:
        return time, values
    size = max(least, (time[-1] - time[0]) / MOST_BLOCKS)
    number = np.unique(np.floor((time - time[0]) / size), return_inverse=True)[1] if size > 0 else None
    if number is None or number[-1] == time.size - 1:
        return time, values
    count = np.bincount(number)
    mean = np.array([np.bincount(number, row) / count for row in values.reshape(-1, time.size)])
    return np.bincount(number, time) / count, mean.reshape(*values.shape[:-1], count.size)


def medians(rows):
    """Median (n,) of what is finite in each of some rows (n, m), NaN without any."""
    found, good = np.full(len(rows), np.nan), np.isfinite(rows).any(axis=1)
    found[good] = np.nanmedian(rows[good], axis=1)
    return found


def longest_run(same):
    """Index of the first sample and number of samples of the longest run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(same, dtype=int), [0]])))
    if not edges.size:
        return 0, 0
    begins, lengths = edges[::2], edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return int(begins[longest]), int(lengths[longest])


def steps(values):
    r"""Height (n,) of the step between samples, over and above the slopes of the record on either side of it.

    .. math:: H_i = x_{i+2} - x_{i-1} - \tfrac32 (b_- + b_+)

    with the slopes b of lines through `SIDE` samples up to i - 1 and from i + 2 on, 0 near the ends, and the
    same over the usual scatter of such heights. A bend of the record, where only the slope changes, gives
    none.
    """
    height = np.zeros(values.size)
    if values.size < 4 * SIDE:
        return height, height
    place = np.arange(SIDE) - (SIDE - 1) / 2
    slope = np.convolve(values, place[::-1] / np.sum(place**2), mode="valid")  # of values[i : i + SIDE]
    inner = np.arange(SIDE, values.size - SIDE - 1)
    before, after = slope[inner - SIDE], slope[inner + 2]
    height[inner] = known = values[inner + 2] - values[inner - 1] - 1.5 * (before + after)
    scatter = NORMAL_MAD * np.median(np.abs(known - np.median(known)))
    usual = np.maximum(np.maximum(scatter, _scatter(height)), 1e-12)
    # A sharp bend between two samples cannot be told from a step of one sample's slope.
    known = np.where(np.abs(known) > 3 * np.maximum(np.abs(before), np.abs(after)), known, 0.0)
    # All three places from which a step is seen must show it: a bend shows its slope at one side only.
    three = np.stack([known[:-2], known[1:-1], known[2:]])
    alike = np.abs(np.sign(three).sum(axis=0)) == 3
    height[inner[1:-1]] = np.where(alike, np.sign(three[1]) * np.abs(three).min(axis=0), 0.0)
    height[inner[[0, -1]]] = 0.0
    return height, height / usual


def widened(places, reach):
    """Where True lies within `reach` samples."""
    return np.lib.stride_tricks.sliding_window_view(np.pad(places, reach), 2 * reach + 1).any(axis=1)


def _scatter(height):
    """Scatter of the heights around each place (n,), without those that a step at it makes itself."""
    reach = 6 * SIDE
    padded = np.pad(height, reach, constant_values=np.nan)
    near = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1).copy()
    near[:, reach - SIDE : reach + SIDE + 1] = np.nan
    middle = np.nanmedian(near, axis=1, keepdims=True)
    return NORMAL_MAD * np.nanmedian(np.abs(near - middle), axis=1)


def fall(time, values, length):
    """Span of time in which a signal begins to fall for good, and its relative drop; None if none stands out.

    `time`, `values` (n,): means over intervals of `length` [s]. The end of the plasma lies between both ends
    [s].
    """
    lit = values.size if (values > 0).all() else int(np.argmin(values > 0))
    # until it is dark, and what follows counts as less than any light
    time, values = time[: lit + 2 * SIDE], values[: lit + 2 * SIDE]
    values = np.maximum(values, FAINT / 10 * values.max(initial=0.0))
    if time.size < 6:
        return None
    usual = np.diff(time) / np.median(np.diff(time))
    drop = -np.diff(np.log(values)) / np.maximum(usual, 1.0)  # in a step, where samples are missing too
    change = np.abs(np.diff(drop))
    # A cooling surface goes on falling, and faster in the logarithm: the first large drop is the one.
    clear = max(LEAST_DROP, MANY * NORMAL_MAD * np.median(change), drop.max() / 3)
    # Faint light is noisier than bright: it must stand out where it is, too.
    around = median_filter(np.append(change, change[-1]), 2 * SIDE + 1, mode="nearest")
    fell = (drop >= clear) & (drop >= MANY * NORMAL_MAD * around) & (values[:-1] > FAINT * values.max())
    if not fell.any():
        return None
    place = int(np.argmax(fell))
    first = max(place - 1, 0)
    return time[first] - length / 2, time[place + 1] + length / 2, -np.expm1(-drop[place])


FAINT = 0.01  # [1] of the brightest: what falls there is noise of a surface that is still cold
LEAST_DROP, MANY = 0.03, 4.0  # of the logarithm in one step; over the usual change between such steps
