"""Whether the pixels of a spectrometer are of several kinds in turn, which their bins average away."""

import numpy as np
from scipy.ndimage import uniform_filter1d

from plasmapyro.diagnosis.fit.build import MOST_SPECTRA
from plasmapyro.diagnosis.select.periodic import chance_of_peak
from plasmapyro.record.binning import LEAVE_OUT_OFF, thinned
from plasmapyro.record.inputs import has_plasma

LONGEST = 32  # pixels: read-out chains take turns faster, slower fringes are looked for in the bins
BY_CHANCE = 1e-6  # with which noise may repeat: of 444 tests of equal pixels the least chance is 0.0015
CHAINS = 2.0 ** np.arange(1, 6)  # pixels, after which read-out chains have had their turn
FLAT_FIELD = 0.003  # [1] ASSUME: fringes of a thin sensor that a calibration does not quite take out
LEAST_LIGHT = 0.02  # [1] of the most: the noise of darker frames is that of the read-out
PIXELS = "pixels_pattern"
NAMES = {PIXELS: "pixels of the spectrometer that are brighter and fainter in turn"}


def in_turn(record):
    """`PIXELS` if those of a test with a plasma are of several kinds in turn, else None."""
    frames = record.instrument("spectrometer")
    if frames is None or not has_plasma(record.attributes):
        return None
    return PIXELS if chance_of_kinds(frames, record.off) < BY_CHANCE else None


def chance_of_kinds(frames, off):
    """Probability that noise lets what pixels show of the surface repeat within `LONGEST` of them; 1 for
    fringes within what a flat field leaves.

    The light of the surface is what goes, in each pixel, with that of the whole frame, beside what is there
    while the plasma burns: neither lines nor the calibration of single pixels repeat.

    Parameters
    ----------
    frames : record.Instrument with pixels
    off : float [s], end of the plasma
    """
    frames = thinned(frames, off, MOST_SPECTRA)
    usable = np.isfinite(frames.sound).mean(axis=0) > 0.5
    light, half = frames.sound[:, usable], frames.integration_time / 2
    whole = np.isfinite(light).mean(axis=1) > 0.9
    told = whole & (frames.time > half) & (np.abs(frames.time - off) > half + LEAVE_OUT_OFF)
    if told.sum() <= 2 or light.shape[1] <= 2 * LONGEST:
        return 1.0
    light = np.nan_to_num(light[told])
    level = np.median(light, axis=0)
    total = np.median(light[:, level > 0] / level[level > 0], axis=1)
    root = np.maximum(total, LEAST_LIGHT * total.max())[:, None] ** -0.5
    courses = np.stack([total, frames.time[told] < off], axis=1)
    surface = np.linalg.lstsq(root * courses, root * light, rcond=None)[0][0]
    surface = np.interp(np.arange(usable.size), np.flatnonzero(usable), surface)  # gaps stay where they are
    local = uniform_filter1d(surface, LONGEST + 1, mode="nearest")
    apart = np.where((local > 0) & usable, surface / np.where(local > 0, local, 1.0) - 1, 0.0)
    chance, period = chance_of_peak(apart, 1.0, LONGEST)
    waves = apart.size / period
    in_turn = np.abs(waves - apart.size / CHAINS).min() < 1
    height = 2 * np.abs(np.mean(apart * np.exp(2j * np.pi * np.arange(apart.size) / period)))
    return chance if in_turn or height > FLAT_FIELD else 1.0
