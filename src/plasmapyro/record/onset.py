"""Does the surface already show in the reference window, and from when on?"""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, stdtrit

LEAST_SAMPLES = 8  # in a window; fewer tell no trend from scatter
SIGNIFICANT = 4.0  # standard deviations; reached by chance in 1 of 16 000 windows
ABSENT = 2.0  # standard deviations below which a trend is taken as none
POWERS = (3, 6, 12, 24)  # of time: light of a heating surface grows faster than the square, soon far faster
CANDIDATES = 60  # ends of windows that are tried
LASTING = 3  # windows in a row that must show the surface
PROPOSED = 0.7  # of the way to the onset: the growth is then 0.7^6, a tenth of what is just seen

CLEAN, DRIFTS, SHOWS, UNKNOWN = "clean", "gas_drifts", "surface_shows", "too_few_samples"
HARMLESS = "harmless"  # seen, for a fast logger sees anything, and smaller than matters
LEAST_BIAS = 1e-3  # [1] of the mean: a tenth of a signal's uncertainty, 1.4 K at 1600 K and equal shares


class Trend(NamedTuple):
    """Growth of a signal over a window."""

    growth: float  # from begin to end, unit of the signal
    deviations: float  # growth over its standard uncertainty
    bias: float  # what the growth adds to the mean of the window


class Verdict(NamedTuple):
    """What a window holds besides a constant gas."""

    word: str  # CLEAN, DRIFTS, SHOWS or UNKNOWN
    bias: tuple  # (2,) share of the growth in the mean of each band


def trend(time, values, window):
    r"""Least-squares growth as that power of time which leaves least, its uncertainty widened for flicker.

    .. math:: S = a + b u^p, \quad u = \frac{t - t_0}{t_1 - t_0}, \qquad
              u^2(b) = \frac{s^2}{\sum (u^p - \overline{u^p})^2}\,\frac{1 + r_1}{1 - r_1}

    with the lag-one correlation r_1 (>= 0) of the residuals, p among `POWERS`, of at least `LEAST_SAMPLES`
    samples. s of few samples is uncertain itself: as Student's distribution has it, chance passes
    `SIGNIFICANT` of the uncertainties that are given as rarely as of normal ones.
    """
    share = (time - window[0]) / (window[1] - window[0])
    found = []
    for growing in (share**power for power in POWERS):
        centred, rest = growing - growing.mean(), values - values.mean()
        power = np.sum(centred**2)
        growth = np.sum(centred * rest) / power
        rest = rest - growth * centred
        found.append((np.sum(rest**2), growth, power, growing.mean(), rest))
    noise, growth, power, mean, rest = min(found, key=lambda one: one[0])
    memory = np.clip(np.sum(rest[1:] * rest[:-1]) / noise, 0.0, 0.99) if noise > 0 else 0.0
    uncertainty = np.sqrt(noise / (time.size - 2) / power * (1 + memory) / (1 - memory))
    uncertainty *= stdtrit(time.size - 3, ndtr(SIGNIFICANT)) / SIGNIFICANT
    # A signal without any noise; one of zeros has neither growth nor uncertainty.
    floor = np.finfo(float).eps * np.abs(values).max() / np.sqrt(power) + np.finfo(float).tiny
    return Trend(float(growth), float(growth / max(uncertainty, floor)), float(growth * mean))


def verdict(time, signals, window):
    """`Verdict` whether a window (2,) [s] of signals (2, t) holds the gas alone.

    A surface adds light to both bands in another ratio than the gas. A gas that brightens as a whole leaves
    the ratio alone, and so does its flicker: the ratio is the sharper test. Deviation: the paper chooses its
    window by eye.
    """
    inside = (time >= window[0]) & (time <= window[1]) & np.isfinite(signals).all(axis=0)
    inside &= (signals > 0).all(axis=0)
    if inside.sum() < LEAST_SAMPLES:
        return Verdict(UNKNOWN, (np.nan, np.nan))
    time, (wide, narrow) = time[inside], signals[:, inside]
    bands = [trend(time, row, window) for row in (wide, narrow)]
    ratio = abs(trend(time, np.log(wide / narrow), window).deviations)
    levels = [band.deviations for band in bands]
    bias = tuple(float(band.bias / row.mean()) for band, row in zip(bands, (wide, narrow), strict=True))
    changed = ratio > SIGNIFICANT and max(levels) > ABSENT
    rising = min(levels) > SIGNIFICANT and ratio > ABSENT
    if (changed or rising) and min(levels) > -SIGNIFICANT:
        return Verdict(SHOWS, bias)
    if max(ratio, *np.abs(levels)) > SIGNIFICANT:
        return Verdict(DRIFTS, bias)
    return Verdict(CLEAN, bias)


def onset(time, signals, begin, end):
    """First time [s] at which the surface shows, in windows that grow from `begin`, and a window to propose.

    NaN and None if it does not show until `end` (plasma off). The window reaches up to `PROPOSED` of the way
    to the onset; None, too, if too few samples would remain.
    """
    ends = time[(time > begin) & (time <= end)]
    if ends.size < LEAST_SAMPLES:
        return np.nan, None
    ends = ends[LEAST_SAMPLES - 1 :] if time[time >= begin][0] > begin else ends[LEAST_SAMPLES - 2 :]
    picks = np.unique(np.geomspace(1, ends.size, CANDIDATES).astype(int)) - 1
    shown = 0
    for index, stop in enumerate(ends[picks]):
        shown = shown + 1 if verdict(time, signals, (begin, stop)).word == SHOWS else 0
        if shown == LASTING:
            first = float(ends[picks[index - LASTING + 1]])
            proposed = [float(begin), float(begin + PROPOSED * (first - begin))]
            held = ((time >= proposed[0]) & (time <= proposed[1])).sum()
            return first, proposed if held >= LEAST_SAMPLES else None
    return np.nan, None


def attributes(instrument, time, signals, window, end):
    """Attributes, begun by the name of an instrument, that tell of its reference window (2,) [s].

    `_reference_verdict`; `_reference_bias` [1] (wide, narrow) if there are samples enough; `_surface_onset`
    [s] and `_proposed_window` [s, s] if the surface shows at all before `end`, plasma off.
    """
    found = verdict(time, signals, window)
    first, proposed = onset(time, signals, window[0], end)
    # In a window that is mostly surface the growth has another shape: the growing windows see it begin.
    within = found.word != UNKNOWN and first < window[1]
    word = SHOWS if within else found.word
    if word in (SHOWS, DRIFTS) and max(np.abs(found.bias)) < LEAST_BIAS:
        word = HARMLESS
    words = {f"{instrument}_reference_verdict": word}
    if found.word != UNKNOWN:
        words[f"{instrument}_reference_bias"] = [float(share) for share in found.bias]
    if np.isfinite(first):
        words[f"{instrument}_surface_onset"] = first
    if proposed is not None:
        words[f"{instrument}_proposed_window"] = proposed
    return words
