"""Fewer numbers with the same information: bins in time and wavelength."""

import numpy as np

LEAVE_OUT_BEFORE = 1.0  # [s] before injection, while the probe swings in
LEAVE_OUT_AFTER_OFF = 0.25  # [s] while the plasma dies
STEPS = ((20.0, 1.0), (60.0, 2.0), (100.0, 4.0), (np.inf, 8.0))  # after injection: up to [s], bin [s]
STEPS_OFF = ((3.0, 0.5), (12.0, 1.0), (40.0, 2.0), (np.inf, 5.0))  # after the end of the plasma
PRE_STEP = 4.0  # [s]
PIXEL_BIN = 2.0e-9  # [m] where the spectrum of the gas is smooth
LINE_CHANGE = 1.0  # [1], of the light in a bin: where the gas changes by more, bins are finer
FINEST_PER_FWHM = 1.0
GAP = 1.5  # steps from pixel to pixel, beyond which some are missing


def time_edges(start, end, injection, off):
    """Edges (n+1,) [s] of bins from before injection to the end; finer where things happen.

    Parameters
    ----------
    start, end, injection, off : float [s]
        Of the record, and the two events.

    Returns
    -------
    ndarray [s], with `injection` and `off` among them where the record holds them.
    """
    edges = [np.arange(injection - LEAVE_OUT_BEFORE, start - PRE_STEP, -PRE_STEP)[::-1]]
    for first, last, steps in ((injection, min(off, end), STEPS), (off, end, STEPS_OFF)):
        if last > first:
            edges.append(_graded(first, last, steps))
    return np.unique(np.round(np.concatenate(edges), 9))


def _graded(first, last, steps):
    """Edges from `first` to `last` in growing steps; the last bin is stretched to end there."""
    edges = [first]
    for reach, step in steps:
        while edges[-1] < min(first + reach, last) - 1e-9:
            edges.append(edges[-1] + step)
    edges = [edge for edge in edges if edge < last - 0.3 * step]
    return np.array([*edges, last])


def membership(begin, finish, edges, injection, off):
    """Bin of each sample (t,); -1 for those that straddle an event, lie in a gap or outside.

    Parameters
    ----------
    begin, finish : (t,) arrays [s]
        Of the integration of each sample.
    edges : (n+1,) array [s]
    """
    middle = (begin + finish) / 2
    index = np.searchsorted(edges, middle, side="right") - 1
    index[(middle < edges[0]) | (middle >= edges[-1])] = -1
    for event, before, after in ((injection, LEAVE_OUT_BEFORE, 0.0), (off, 0.0, LEAVE_OUT_AFTER_OFF)):
        index[(finish > event - before + 1e-9) & (begin < event + after - 1e-9)] = -1
    return index


def pixel_edges(wavelength, gas, fwhm):
    """First pixels (P+1,) of the wavelength bins: fine where the gas has structure, none across a gap.

    Parameters
    ----------
    wavelength : (W,) array [m]
    gas : (W,) array
        Spectrum of the gas as the pixels see it.
    fwhm : float [m] of the slit
    """
    steepness = np.abs(np.gradient(np.log(np.maximum(gas, 1e-6 * gas.max()))))
    cost = np.cumsum(np.maximum(np.gradient(wavelength) / PIXEL_BIN, steepness / LINE_CHANGE))
    before = np.concatenate([[0.0], cost])  # of all pixels before each: a bin may be a single pixel
    finest = FINEST_PER_FWHM * fwhm
    edges = [0]
    step = np.diff(wavelength)
    gap = np.append(False, step > GAP * np.median(step))
    for pixel in range(1, wavelength.size):
        wide = wavelength[pixel] - wavelength[edges[-1]] >= finest * (1 - 1e-6)
        if gap[pixel] or wide and before[pixel] - before[edges[-1]] + 1e-9 >= 0.75:
            edges.append(pixel)
    edges.append(wavelength.size)
    return np.array(edges)


def mean_in_bins(values, index, count):
    """Mean (count, ...) of the samples (t, ...) of each bin over what is finite, and their number."""
    keep = index >= 0
    values, index = values[keep], index[keep]
    finite = np.isfinite(values)
    total = np.zeros((count, *values.shape[1:]))
    number = np.zeros((count, *values.shape[1:]))
    np.add.at(total, index, np.where(finite, values, 0.0))
    np.add.at(number, index, finite)
    with np.errstate(invalid="ignore"):
        return np.where(number > 0, total / np.maximum(number, 1), np.nan), number
