"""What can be wrong with single samples, as bits, and how two of the faults show in the samples."""

import numpy as np
from scipy.ndimage import median_filter

from plasmapyro.instrument.spectrometer import NORMAL_MAD, local_noise
from plasmapyro.record.rounding import rounding

SATURATED, MASKED, LOST, STUCK, CLIPPED, SPIKED, UNLIT, RELIT = (1 << bit for bit in range(8))
MEANINGS = {
    SATURATED: "at or beyond the stated limit of the detector or its converter",
    MASKED: "in a pixel that its calibration cannot use",
    LOST: "not recorded",
    STUCK: "the same as before, over and over, in all channels",
    CLIPPED: "at or near a ceiling that nothing states, flat or approached more and more slowly",
    SPIKED: "far beyond all its neighbours: pick-up, or a number that stands for none",
    UNLIT: "before the plasma burned, or of another test in the same log",
    RELIT: "after the end of the plasma, from where the light grows again: no surface that cools",
}
REPEATED, TOGETHER = 0.05, 0.9  # [1] of all samples; of the repeats of a band beyond chance, those of both
LONGEST = 10  # samples; runs of equal ones up to here are left alone
CHANCE = 1e-6  # of a longer run in a record without a fault
BIN, SPAN, FEW = 0.1, 3, 4  # of the logarithm of a channel; bins that a slope takes; samples of one
LEAST_SLOPE, SOUND_SLOPE = 0.85, 0.93  # of the usual slope of one logarithm over the other
OF_GAS = 0.75, 1.25  # [1] of the gas that was taken out, between which it may be
RULES = 0.3  # share of the surface in a signal from which on its slope is looked at
SPIKE, SHARE = 12.0, 0.02  # deviations, and share of the level, by which a spike leaves its neighbours
STEPS = 2.5  # of a converter or of digits: noise below a step moves single samples by one or two
BENT, MOST_BENT = 3.0, 50.0  # times what a Gaussian slit lets a logarithm bend; where it overflows
DEAD = 3.0  # times the light of a dead pixel that both neighbours have
MOST_SHARP, OFTEN = 0.02, 0.2  # [1] of all samples that may be so; of those of a pixel that then never counts
WIDEST, AROUND = 3, 51  # samples of a spike; second differences whose median is the scatter
MAD = NORMAL_MAD / np.sqrt(1.5)  # deviations of normal samples per median of their second differences
# share of bends that turn back: 0.73 for noise, 0.67 for slow flicker, 0 for a smooth curve
ALTERNATING = 0.25
FIRST, DIMMEST = 3, 1e-3  # samples of the light at the end; share of it that other light must add
PAUSE = 10  # usual steps
GROWN, HELD = 0.1, 4  # by which the light since the end must fade, and grow again; samples for which it does


def _run_lengths(same):
    """Length (t,) of the run of equal samples that each belongs to; `same` (t - 1,): as the one before."""
    begin = np.flatnonzero(np.concatenate([[True], ~same]))
    length = np.diff(np.append(begin, same.size + 1))
    return np.repeat(length, length)


def _longest_by_chance(same, lengths):
    """Longest run (t,) that neighbours which happen to be equal explain: they are, with a coarse converter.

    More of them before a faint light than before a bright one, whose noise is more than a step: those on
    either side of the run count, if the record as a whole does not have more.
    """
    outside = lengths[1:] <= LONGEST
    whole = same[outside].mean() if outside.any() else 0.0
    begin = np.flatnonzero(np.concatenate([[True], ~same]))
    end = np.append(begin[1:], lengths.size)
    total = np.append(0, np.cumsum(same))  # of the pairs before a sample
    first, last = np.maximum(begin - 1, 0), np.minimum(end - 1, same.size)
    low, high = np.maximum(first - AROUND, 0), np.minimum(last + AROUND, same.size)
    equal = total[first] - total[low] + total[high] - total[last]
    near = equal / np.maximum(first - low + high - last, 1)
    share = np.repeat(np.maximum(near, whole), end - begin)
    with np.errstate(divide="ignore"):
        return np.maximum(LONGEST, np.log(CHANCE / lengths.size) / np.log(np.minimum(share, 1 - 1e-9)))


def _noisy(values):
    """Whether a series (t,) is a measurement: noise bends to and fro, also on a rise; a formula does not."""
    step = np.diff(values[np.isfinite(values)], 2)
    step = step[step != 0]
    return step.size > LONGEST and np.mean(step[1:] * step[:-1] < 0) > ALTERNATING


def least_change(values):
    """Least change (C,) from one of values (t, C) to the next, a converter's step; 0 where none changes."""
    change = np.abs(np.diff(values, axis=0))
    step = np.min(change, axis=0, where=change > 0, initial=np.inf)
    return np.where(step < np.inf, step, 0.0)


def stuck(values, changing=False):
    """Samples (t,) that repeat the last one in all channels for longer than chance: a logger that hangs.

    `values` (t, C), NaN where missing; the light is known to be `changing`: a record that never does is stuck
    throughout. The first sample of such a run is a measurement and is not among them. Never in part of a
    record without noise, nor within some steps of the lowest level of a channel: there is nothing to see.
    """
    values = np.asarray(values, dtype=float)
    seen = np.isfinite(values).any(axis=0)
    if len(values) <= LONGEST or not seen.any():
        return np.zeros(len(values), dtype=bool)
    values = values[:, seen]
    with np.errstate(invalid="ignore"):
        same = (values[1:] == values[:-1]).all(axis=1)
    lengths = _run_lengths(same)
    if changing and same.all():
        return np.append(False, same)
    if lengths.max() <= LONGEST or not _noisy(values.mean(axis=1)):
        return np.zeros(len(values), dtype=bool)
    dark = np.nanmin(values, axis=0) + STEPS * least_change(values)
    long = (lengths > _longest_by_chance(same, lengths)) & (values > dark).all(axis=1)
    return long & np.append(False, same)


def asked_again(values):
    """Samples (t,) that a logger took again before the instrument gave a new one.

    `values` (t, 2): bands behind a plasma, that repeat at once and often, and then jump by more than the
    steps of a converter; rounding makes one of them do so without the other, and changes it by a step. The
    first of equal ones is a measurement and is not among them; nothing is told at the lowest level of a band.
    """
    above = (values > np.nanmin(values, axis=0, initial=np.inf)).all(axis=1)[1:]
    same = (values[1:] == values[:-1]) & above[:, None]
    both, count = same.all(axis=1), max(above.sum(), 1)
    share = same.sum(axis=0) / count
    chance = share.prod()
    least = max(LONGEST / count, REPEATED, chance + TOGETHER * (share.max() - chance))
    often = both.sum() / count > least and np.count_nonzero(both[1:] & ~both[:-1]) > LONGEST
    if not often:
        return np.zeros(len(values), dtype=bool)
    change, step = np.abs(np.diff(values, axis=0)), least_change(values)
    after = np.median(change[1:][both[:-1] & ~both[1:]], axis=0)
    return np.append(False, both & (after > STEPS * step).all())


def clipped(values):
    """Samples (t, C) at the highest value of their channel, where a run longer than chance reaches it."""
    values = np.asarray(values, dtype=float)
    result = np.zeros(values.shape, dtype=bool)
    for channel, row in enumerate(values.T):
        if row.size <= LONGEST or not np.isfinite(row).any() or np.nanmax(row) == np.nanmin(row):
            continue
        at_top = row == np.nanmax(row)
        if at_top.sum() <= LONGEST:
            continue
        same = row[1:] == row[:-1]
        lengths = _run_lengths(same)
        if (lengths > _longest_by_chance(same, lengths))[at_top].any() and _noisy(row):
            result[:, channel] = at_top
    return result


def spiked(values):
    """Samples (t, C), up to three in a row, far above, or below, both neighbours on either side of them.

    A step or a bend of the record is none: it has one side in common with its neighbours.
    """
    result = np.zeros(np.shape(values), dtype=bool)
    for channel, row in enumerate(np.asarray(values, dtype=float).T):
        known = np.flatnonzero(np.isfinite(row))
        found, row = np.zeros(known.size, dtype=bool), row[known]
        if row.size < AROUND:
            continue
        rest = np.abs(row[1:-1] - (row[:-2] + row[2:]) / 2)
        # Mirrored at the ends: half a window of copies of the last one would be no median of many.
        scatter = MAD * np.pad(median_filter(rest, AROUND, mode="reflect"), 1, mode="edge")
        written = rounding(row)
        step = np.interp(row, written.level, written.step) if written.level.size else np.zeros(row.size)
        for width in range(1, WIDEST + 1):
            count = row.size - width - 3
            beside = np.stack([row[at : at + count] for at in (0, 1, width + 2, width + 3)])
            inside = np.stack([row[at : at + count] for at in range(2, width + 2)])
            least = np.maximum(SPIKE * scatter[2 : count + 2], SHARE * np.abs(np.median(beside, axis=0)))
            least = np.maximum(least, STEPS * step[2 : count + 2])
            far = inside.min(axis=0) - beside.max(axis=0) > least
            far |= beside.min(axis=0) - inside.max(axis=0) > least
            for at in range(2, width + 2):
                found[at : at + count] |= far
        result[known, channel] = found
    return result


def sharper(values, wavelength, slit):
    r"""Samples (t, P) of pixels that show what no light behind the slit does: rays, hot and dead pixels.

    .. math:: \ln y_i - \ln\max(y_{i-m}, y_{i+n}) \le \frac{m n h^2}{2 s^2}

    for pixels h apart behind a Gaussian slit of standard deviation s: of a mixture of Gaussians no logarithm
    bends down more than that of one. With m and n 1, or one of them 2, for hits of two pixels. Three times as
    much is let pass, for slits that are triangles, or are stated too wide. A dead pixel has less than a third
    of both its neighbours, each of two that lie side by side less than a ninth.

    Parameters
    ----------
    values : (t, P) array, calibrated, NaN where there is none
    wavelength : (P,) array [m]
    slit : float [m], full width at half maximum

    Returns
    -------
    (t, P) bool; none where more than `MOST_SHARP` of all would be: the slit is another one. All of a pixel
    that is so `OFTEN`: what it adds to a brighter light is there as well.
    """
    found = np.zeros(values.shape, dtype=bool)
    if values.shape[1] < AROUND:
        return found
    sure = SPIKE * local_noise(values, AROUND - 1)
    bend = BENT * (np.gradient(wavelength) / slit) ** 2 * 4 * np.log(2)
    for left, right in ((1, 1), (1, 2), (2, 1)):
        inside = slice(left, values.shape[1] - right)
        beside = np.stack([values[:, : -left - right], values[:, left + right :]])
        allowed = np.exp(np.minimum(bend[inside] * left * right, MOST_BENT)) * np.maximum(
            beside.max(axis=0), 0
        )
        found[:, inside] |= values[:, inside] - allowed > sure[:, inside]
        dead = beside.min(axis=0) / DEAD ** (left * right)
        found[:, inside] |= dead - values[:, inside] > sure[:, inside]
    found &= found.mean() < MOST_SHARP
    return found | (found.mean(axis=0) > OFTEN)


def without_rays(values, wavelength, slit):
    """Samples (t, P) as of `sharper`; what lies beside them in the place of those that it finds."""
    beside = (np.roll(values, -WIDEST, axis=1) + np.roll(values, WIDEST, axis=1)) / 2
    return np.where(sharper(values, wavelength, slit), beside, values)


def rounded(values, gas):
    """Samples (t, 2) where one of two channels bends away from the other, see `_bent`, however bright the gas
    of the moment is: a window that fogs, or a gas that drifts, leaves more or less than was taken out."""
    found = [_bent(values, share * gas) for share in (1.0, *OF_GAS)]
    return found[0] & np.all([one.any(axis=0) for one in found], axis=0)


def _bent(values, gas):
    r"""Samples (t, 2) where one of two channels bends away from the other: near its end, without a plateau.

    .. math:: \frac{d \ln S_c}{d \ln S_o} < 0.85 \text{ of what it is below}

    at the top of channel c over the other one o: all above the level where its slope falls below
    `SOUND_SLOPE` for good. A surface brightens in both bands by powers of its temperature whose quotient
    changes by some per cent over the range. `gas` (t, 2): how much of the signals is light of the gas, NaN
    where nobody knows.
    """
    own = values - gas
    good = (own > RULES * values).all(axis=1) & (own > 0).all(axis=1)
    result = np.zeros(values.shape, dtype=bool)
    for channel in range(2 if good.any() else 0):
        level, other = np.log(own[good][:, [channel, 1 - channel]]).T
        place = np.floor((other - other.max()) / BIN).astype(int)
        bins, count = np.unique(place, return_counts=True)
        rows = [[np.median(row[place == one]) for row in (level, other)] for one in bins[count >= FEW]]
        if len(rows) < 4 * SPAN:
            continue
        height, width = (np.array(rows)[SPAN:] - np.array(rows)[:-SPAN]).T
        slope, usual = height / width, np.median(height / width)
        if slope[-1] < LEAST_SLOPE * usual:
            last = np.flatnonzero(slope >= SOUND_SLOPE * usual)[-1]
            bent = values[good, channel][level > rows[last + SPAN][0]]
            result[:, channel] = values[:, channel] >= np.min(bent, initial=np.inf)
    return result


def relit(time, value, off):
    """Samples (t,) from the first on where light that had faded after the end of the plasma grows again.

    By a tenth, by `SPIKE` deviations and by a thousandth of the light at the end, for `HELD` samples in a
    row: a lamp, or the next test of a log that runs on. A surface without a plasma cools; light that has not
    faded by a tenth says that the plasma burns on, and the stated end is wrong. Where the log paused before
    the light grew, all behind the pause is of another test; if it paused at the end, the light before counts.

    Parameters
    ----------
    time : (t,) array [s]
    value : (t, C) array
        NaN where there is none.
    off : float [s]
        End of the plasma.
    """
    found = np.zeros(time.size, dtype=bool)
    known = np.flatnonzero(np.isfinite(value).any(axis=1))
    paused, begin = pauses(time[known]), int(np.searchsorted(time[known], off, "right"))
    if 0 < begin < known.size and paused[begin - 1]:
        begin = max(begin - FIRST, 0)
    after, paused = known[begin:], paused[begin:]
    if after.size < FIRST + HELD + 1:
        return found
    held = np.isfinite(value[after])
    first = np.nan_to_num(value[after[:FIRST]]).sum(axis=0) / np.maximum(held[:FIRST].sum(axis=0), 1)
    weight = held @ first**2
    if not (weight > 0).all():
        return found
    share = np.nan_to_num(value[after]) @ first / weight
    scatter = MAD * np.median(np.abs(share[1:-1] - (share[:-2] + share[2:]) / 2))
    least = np.minimum.accumulate(median_filter(share, 2 * WIDEST + 1, mode="nearest"))  # no dropout
    most = least + np.maximum(np.maximum(GROWN * least, SPIKE * scatter), DIMMEST)
    grown = (share > most) & ((least < 1 - GROWN) | (np.append(0, np.cumsum(paused)) > 0))
    grown = np.lib.stride_tricks.sliding_window_view(grown, HELD).all(axis=1)
    if SPIKE * scatter < 1 and grown.any():  # else there was no light at the end
        place = np.argmax(grown)
        found[after[max(np.flatnonzero(paused[:place]) + 1, default=place)] :] = True
    return found


def pauses(time):
    """Between which samples (t - 1,) a log paused: for ten of its usual steps, and a second at least."""
    step = np.diff(time)
    return step > max(PAUSE * np.median(step), 1.0) if step.size else step > 0
