"""Samples that stand out from their neighbours in time and the others of their bin: no fit takes these."""

import warnings
from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.fit.noise import CLIP, LEAST_IN_GROUP
from plasmapyro.record import binning

NEIGHBOURS = 7  # samples in time that an outlier is held against
MEDIAN_ERROR = 1.15  # [1] of a sample less the median of seven, itself among them, over that of a sample
MOST_HIT = 0.1  # [1] of the channels of one sample: where more stand out it is no hit
MOST_IN_BIN = 0.3  # [1] of the samples of a channel in one bin, likewise


def slow_part(scaled, chosen, phase):
    """Running medians (t, C) over `NEIGHBOURS` chosen samples of the same phase: what is no outlier.

    Parameters
    ----------
    scaled : (t, C), NaN where nothing was measured
    chosen : (t,) bool
    phase : (t,) int
    """
    result = np.zeros(scaled.shape)
    for one in np.unique(phase[chosen]):
        place = np.flatnonzero(chosen & (phase == one))
        width = min(NEIGHBOURS, 2 * ((place.size - 1) // 2) + 1)
        half = width // 2
        first = np.clip(np.arange(place.size) - half, 0, place.size - width)
        windows = scaled[place][first[:, None] + np.arange(width)]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # a channel without a sample
            result[place] = np.nan_to_num(np.nanmedian(windows, axis=1))
    return result


def outliers(scaled, chosen, phase):
    """Samples (t, C) that stand out from their neighbours in time, alone among the channels.

    What stands out in many channels at once is light, not a hit: it stays.

    Parameters
    ----------
    scaled : (t, C)
        Residuals over their standard deviations; NaN where nothing was measured.
    chosen : (t,) bool
    phase : (t,) int
        Neighbours are of the same phase.
    """
    apart = np.abs(np.nan_to_num(scaled - slow_part(scaled, chosen, phase))) > CLIP * MEDIAN_ERROR
    apart &= chosen[:, None]
    alone = apart.sum(axis=1) <= max(1, MOST_HIT * scaled.shape[1])
    return apart & alone[:, None]


def line_in_bins(values, time, index, count):
    """Straight line through what is finite of the samples (t, C) of each of `count` bins, at each sample; the
    mean where there are fewer than `LEAST_IN_GROUP`, 0 outside bins.

    A temperature that runs otherwise within a bin than the model's makes a line, and no hits at its ends.
    """
    mean, number = binning.mean_in_bins(values, index, count)
    place = np.maximum(index, 0)
    seen = np.where(np.isfinite(values), time[:, None], np.nan)
    away = time[:, None] - binning.mean_in_bins(seen, index, count)[0][place]
    both = binning.mean_in_bins(values * away, index, count)[0]
    square = binning.mean_in_bins(np.where(np.isfinite(values), away**2, np.nan), index, count)[0]
    slope = np.where(number >= LEAST_IN_GROUP, both / np.maximum(square, 1e-300), 0.0)
    line = mean[place] + slope[place] * away
    return np.where(index[:, None] >= 0, np.nan_to_num(line), 0.0)


def crowded(hit, index, count):
    """Samples (t, C) of those of `count` bins in which too many are hit: that is a misfit."""
    share, number = binning.mean_in_bins(hit.astype(float), index, count)
    wrong = (share > MOST_IN_BIN) & (number >= LEAST_IN_GROUP)
    return np.where(index[:, None] >= 0, wrong[index], False)


def without_outliers(instrument, expected, hit):
    """The instrument with samples that were hit, or are missing, replaced by what is expected of them.

    They do not count as samples; left out altogether they would move the mean time of their bin.

    Parameters
    ----------
    instrument : Instrument
    expected : (t, C)
        Samples as the model and the others of their bin make expect.
    hit : (t, C) bool
    """
    clean = np.isfinite(instrument.raw) & ~hit
    filled = np.where(clean, instrument.raw, expected)
    value, _ = binning.mean_in_bins(filled, instrument.raw_bin, instrument.value.shape[0])
    _, number = binning.mean_in_bins(
        np.where(clean, instrument.raw, np.nan), instrument.raw_bin, instrument.value.shape[0]
    )
    return replace(instrument, value=np.where(number > 0, value, np.nan), number=number)
