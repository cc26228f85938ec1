"""Fewer numbers with the same information: bins in time and wavelength."""

from dataclasses import replace

import numpy as np

from plasmapyro.record import flags

LEAVE_OUT_BEFORE = 1.0  # [s] before injection, while the probe swings in
LEAVE_OUT_OFF = 0.25  # [s] on either side of the end, which is stated by hand, while the plasma dies
LONG = (400.0, 1600.0)  # [s] of a phase, beyond which bins are 4 and 16 times as long
STEPS = ((5.0, 0.5), (20.0, 1.0), (60.0, 2.0), (100.0, 4.0))  # after injection: up to [s], bin [s]
BEFORE_OFF = ((2.0, 0.5), (4.0, 1.0))  # backwards from the end of the plasma, which a clock may move
STEPS_OFF = ((3.0, 0.5), (12.0, 1.0), (40.0, 2.0))  # after it
LEAST_BIN = 0.3  # [1] of a step: what is left is added to the bin before it
LAST_STEP, LAST_STEP_OFF, PRE_STEP = 8.0, 5.0, 4.0  # [s] from there to `LONG`
SHORT = 30.0  # [s] of an exposure; all steps of a shorter one shrink with it
PIXEL_BIN = 2.0e-9  # [m] where the spectrum of the gas is smooth
LINE_CHANGE = 1.0  # [1], of the light in a bin: where the gas changes by more, bins are finer
FINEST_PER_FWHM = 1.0
PAUSE = 20.0  # steps in time between two series, of which the exposures may differ by a factor of ten
GAP = 1.5  # steps from pixel to pixel, beyond which some are missing


def series(time):
    """Number (t,) of the series of each sample: those further apart than `PAUSE` steps are of two."""
    step = np.diff(time)
    return np.append(0, np.cumsum(step > PAUSE * np.median(step))) if step.size else np.zeros(time.size, int)


def time_edges(start, end, injection, off):
    """Edges (n+1,) [s] of bins from before injection to the end; finer where things happen.

    `injection` and `off` are among them where the record holds them.
    """
    scale = min(1.0, (off - injection) / SHORT)
    edges = [injection - LEAVE_OUT_BEFORE - _before(injection - LEAVE_OUT_BEFORE - start)]
    during, after = (*STEPS, *_long(LAST_STEP)), (*STEPS_OFF, *_long(LAST_STEP_OFF))
    for first, last, steps in ((injection, min(off, end), during), (off, end, after)):
        if last > first:
            edges.append(_graded(first, last, [(reach * scale, step * scale) for reach, step in steps]))
    if injection < off < end:
        coarse, reach = edges[1], BEFORE_OFF[-1][0] * scale
        fine = _graded(0.0, reach, [(reach * scale, step * scale) for reach, step in BEFORE_OFF])
        edges[1] = np.append(coarse[coarse < off - (1 + LEAST_BIN) * reach], off - fine)
    return np.unique(np.round(np.concatenate(edges), 9))


def _long(step):
    """Steps (up to [s], bin [s]) that grow with a long phase: two hours are divided into some 150."""
    return [(reach, step * 4**power) for power, reach in enumerate((*LONG, np.inf))]


def _before(span):
    """Distances (n,) [s] of edges from the injection backwards; the last one lies beyond the span."""
    edges = [0.0]
    for reach, step in _long(PRE_STEP):
        while edges[-1] < min(reach, span) - 1e-9:
            edges.append(edges[-1] + step)
    return np.array(edges)


def _graded(first, last, steps):
    """Edges from `first` to `last` in growing steps; the last bin is stretched to end there."""
    edges = [first]
    for reach, step in steps:
        while edges[-1] < min(first + reach, last) - 1e-9:
            edges.append(edges[-1] + step)
            own = step
    edges = [edge for edge in edges if edge < last - LEAST_BIN * own]
    return np.array([*edges, last])


def membership(begin, finish, edges, injection, off):
    """Bin of each sample (t,); -1 for those that straddle an event, lie in a gap or outside.

    `begin`, `finish` (t,) [s]: of the integration of each sample; `edges` (n+1,) [s].
    """
    middle = (begin + finish) / 2
    index = np.searchsorted(edges, middle, side="right") - 1
    index[(middle < edges[0]) | (middle >= edges[-1])] = -1
    for event, before, after in ((injection, LEAVE_OUT_BEFORE, 0.0), (off, LEAVE_OUT_OFF, LEAVE_OUT_OFF)):
        index[(finish > event - before + 1e-9) & (begin < event + after - 1e-9)] = -1
    return index


def pixel_edges(wavelength, gas, fwhm):
    """First pixels (P+1,) of the wavelength bins: fine where the gas has structure, none across a gap.

    `gas` (W,): its spectrum as the pixels (W,) [m] see it; `fwhm` [m] of the slit.
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


def finite_mean(rows):
    """Mean over the first axis of what is finite; NaN without any."""
    good = np.isfinite(rows)
    with np.errstate(invalid="ignore"):
        return np.where(good, rows, 0.0).sum(axis=0) / good.sum(axis=0)


def groups(time, switches, most):
    """Group (t,) of each sample, at most about `most` of them, none across a switch."""
    size = int(np.ceil(time.size / most))
    phase = (time >= switches[0]).astype(int) + (time > switches[1])
    start = np.searchsorted(phase, phase)  # first sample of the same phase
    place = (np.arange(time.size) - start) // size
    new = np.append(True, (np.diff(place) != 0) | (np.diff(phase) != 0))
    return np.cumsum(new) - 1


def thinned(instrument, off, most):
    """An instrument of a record with neighbours averaged to at most about `most` samples.

    The same one if it is short enough. No group straddles the injection, nor `off` [s], the end of the
    plasma. A mean is flagged as its samples are; it is over the sound ones, and the time is theirs.
    """
    if instrument.time.size <= most:
        return instrument
    group = groups(instrument.time, (0.0, off), most)
    count = np.bincount(group)
    value, number = mean_in_bins(instrument.sound, group, count.size)
    flag = np.zeros(value.shape, dtype=instrument.flag.dtype)
    np.bitwise_or.at(flag, group, instrument.flag)
    # Of samples near a limit those with low noise are left: their mean would be too low.
    flag[number > 0] &= flags.SATURATED | flags.CLIPPED
    step = float(np.median(np.diff(instrument.time)))
    return replace(
        instrument,
        time=np.bincount(group, instrument.time) / count,
        integration_time=instrument.integration_time + (count.max() - 1) * step,
        value=value,
        flag=flag,
    )
