"""What a final fit leaves in many channels at once, whatever it looks like."""

import itertools
import warnings

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.optimize import brentq
from scipy.special import chdtri

from plasmapyro.diagnosis.fit.base import phase_of, raw_residuals
from plasmapyro.diagnosis.fit.outliers import slow_part
from plasmapyro.diagnosis.select.two_levels import two_kinds

DRAWS, SEED = 5, 7  # of noise, whose largest singular value is the one to be expected
LARGER = 1.1  # [1] over that: residuals of 60 tests without a fault stay below 1.05
LEAST = 10  # channels of an instrument that has patterns
SHORT = 0.1  # [1] of the record: what lasts no longer is a moment
BOXES = (1, 2, 4), (1, 2, 3)  # bins of time, and channels, that a line may light for a moment
HIT = 4.0  # standard deviations: what one bin of one channel shows beyond counts as no more
LEAST_USUAL = 0.5  # standard deviations: a fit that follows its noise leaves half of it
LINE_STANDS = 6.5  # usual sums of such boxes: of tests without a fault they stay below 5
STANDS = 6.0, 1.5  # usual distances, and standard deviations of the noise, by which frames stand out
FEWEST, LEAST_SHARE = 3, 0.05  # how many of them must, and of all: of a normal law 0.012 lie so far
ALIKE, LEAST_ALIKE = 0.4, 8  # logarithm of the noise of frames that are held against each other, how many
LEAST_APART = 0.01  # [1] of the light: less is a path or a gas that is not quite followed
GAS_OF_FRAME, CLEAR = 0.02, 0.01  # [1]: how far the gas of one frame may flicker; error of a gain that tells
STEEP = 5.0  # times the usual error of a gain: beside light that changes so fast steps are none
UNFOLLOWED = 0.05  # [1], of what light changes by from frame to frame
SIDES, LONGEST_SIDE = (3, 6, 12), 12.0  # frames before and after a step, and how long they may last [s]
USUAL_REACH = 40  # frames to both sides, at least, whose steps are the usual ones, as far as there
LEAST_USUAL_STEPS = 20  # are; and how many there must be
ENDS = 8  # frames at either end of a phase that tell none: there paths bend, and splines miss some of it
STEP_STANDS = 6.0  # standard deviations of frames, or usual steps: 0.2 % of simulated gains that wander pass
MEDIAN = chdtri(1, 0.5)  # of the square of a standard normal number
LEAST_FRAMES = 20  # frames that tell whether they are of two kinds
FRAMES, MOMENT, PATTERN, STEP = "left_frames", "left_moment", "left_pattern", "left_step"
NAMES = {
    STEP: "a step of the gain of the spectrometer from one frame to the next",
    FRAMES: "frames of the spectrometer that are brighter or fainter than their neighbours",
    MOMENT: "what the spectrometer saw for a moment",
    PATTERN: "a pattern over wavelength that comes and goes",
}
OF_BANDS = {
    STEP: "a step of the gain of all bands of the {source} from one sample to the next",
    FRAMES: "samples of the {source} that are brighter or fainter in all bands than their neighbours",
    MOMENT: "what the bands of the {source} saw for a moment",
    PATTERN: "a pattern over the bands of the {source} that comes and goes",
}


def names(instruments):
    """Names of what is left, by id, in the words of the first of the instruments that has patterns."""
    source = next((one.source for one in instruments if one.channels >= LEAST), "spectrometer")
    if source == "spectrometer":
        return NAMES
    return {identity: name.format(source=source) for identity, name in OF_BANDS.items()}


def whitened(model, solution):
    """Whitened residuals (n, C) per instrument, NaN where nothing was measured."""
    result = []
    for instrument, residual, weigher in zip(
        model.instruments, solution.residual, solution.weighers, strict=True
    ):
        z = weigher.root(residual[..., None]).reshape(residual.shape)
        result.append(np.where(np.isfinite(instrument.value), z, np.nan))
    return result


def leading(z):
    """Leading pattern of residuals (n, C).

    Returns
    -------
    time_weight : (n,)
    channel_weight : (C,)
    size, expected : float
        Its singular value, and the largest of noise.
    """
    generator = np.random.default_rng(SEED)
    u, s, v = np.linalg.svd(np.nan_to_num(z), full_matrices=False)
    draws = [np.linalg.svd(generator.standard_normal(z.shape), compute_uv=False)[0] for _ in range(DRAWS)]
    return u[:, 0], v[0], float(s[0]), float(np.max(draws))


def brightest_box(z, phase):
    """Largest sum of residuals (n, C) over a few bins of a phase and a few channels, over usual ones: lines
    that flash are too few to be the leading pattern."""
    best, z = 0.0, np.clip(np.nan_to_num(z), -HIT, HIT)
    for size in itertools.product(*BOXES):
        if size[0] > z.shape[0] or size[1] > z.shape[1]:
            continue
        sums = np.abs(sliding_window_view(z, size).sum(axis=(2, 3)))
        phases = sliding_window_view(phase, size[0])
        sums = sums[phases[:, 0] == phases[:, -1]]
        if sums.size:
            usual = max(1.4826 * np.median(sums), LEAST_USUAL * np.sqrt(np.prod(size)))
            best = max(best, float(sums.max() / usual))
    return best


def standing_out(residual, prediction, weigher, phase):
    """Frames (n,) bool whose light as a whole is brighter or fainter than that of their neighbours.

    Residuals and predictions (n, C), phases (n,). Noise that all channels share is as large as it is, but
    two kinds of frames are no noise.
    """
    information = np.maximum(np.sum(weigher.weight * prediction**2, axis=1), 1e-300)
    whole = np.sum(weigher.weight * prediction * np.nan_to_num(residual), axis=1) / information
    shared = (weigher.shared @ prediction[..., None])[..., 0] / information[:, None]  # (n, r)
    expected = np.sqrt(1 / information + np.sum(shared**2, axis=1))
    usual = slow_part(whole[:, None], np.ones(whole.size, dtype=bool), phase)[:, 0]
    apart = np.abs(whole - usual)
    # Frames of a gas that flickers are not held against those of a surface that does not.
    near = np.abs(np.log(expected[:, None] / expected)) < ALIKE
    scatter = np.array([1.4826 * np.median((apart / expected)[own]) for own in near])
    scatter = np.where(near.sum(axis=1) < LEAST_ALIKE, np.maximum(scatter, 1.0), scatter)
    return apart > np.maximum(np.maximum(STANDS[0] * scatter, STANDS[1]) * expected, LEAST_APART)


def gains_of_frames(instrument, residual, value, gas, weight):
    """Gain (t,) [1] of all light of each frame and its standard deviation, the brightness of its gas free.

    Residuals, predictions and light of the gas (t, C) of the frames; `weight` (n, C) of their bins. NaN where
    a frame was not used. Where light changes fast, a fit misses some of it.
    """
    own = weight[np.maximum(instrument.raw_bin, 0)]
    own = own / np.maximum(instrument.number, 1)[np.maximum(instrument.raw_bin, 0)]
    own = np.where(np.isfinite(residual), own, 0.0)
    left = np.nan_to_num(residual)
    of_gas = np.sum(own * gas**2, axis=1) + GAS_OF_FRAME**-2.0
    both, of_all = np.sum(own * gas * value, axis=1), np.sum(own * value**2, axis=1)
    information = np.where(own.any(axis=1), of_all - both**2 / of_gas, np.nan)
    score = np.sum(own * value * left, axis=1) - both / of_gas * np.sum(own * gas * left, axis=1)
    change = np.gradient(np.log(np.maximum(value.sum(axis=1), 1e-300)))
    return score / information, np.hypot(information**-0.5, UNFOLLOWED * change)


def largest_step(gain, error, period):
    """Largest step of a gain (t,) of one phase, over its standard deviation, and the frame it begins with.

    Straight lines through the frames on both sides end apart by it; what bends slowly shows none. Where steps
    of noise are usually larger than by the errors (t,) alone, they count by that.
    """
    best, place, error = 0.0, None, np.hypot(error, _flickers(gain, error))
    for side in SIDES:
        if side > SIDES[0] and side * period > LONGEST_SIDE or gain.size < 2 * side + LEAST_USUAL_STEPS:
            continue
        away = np.arange(side) + 0.5
        bent = away - away.mean()
        end = 1 / side - away.mean() * bent / np.sum(bent**2)  # of a line, at the middle
        law = np.concatenate([-end[::-1], end])
        gains, errors = (sliding_window_view(one, 2 * side) for one in (gain, error))
        steps = np.abs(gains @ law) / np.sqrt(errors**2 @ law**2)
        # A fit rings about a surface that jumps, as some do.
        about = sliding_window_view(np.pad(np.nan_to_num(error), 2 * side, mode="edge"), 6 * side)
        steps[(errors.max(axis=1) >= CLEAR) | (about.max(axis=1) > STEEP * np.nanmedian(error))] = np.nan
        if not np.isfinite(steps).any():
            continue
        reach = max(USUAL_REACH, 4 * side)
        about = sliding_window_view(np.pad(steps, reach, constant_values=np.nan), 2 * reach + 1)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # nothing there
            usual = 1.4826 * np.nanmedian(about, axis=1)
        steps = np.nan_to_num(steps / np.maximum(usual, 1.0))
        steps[:ENDS] = steps[-ENDS:] = 0.0
        if steps.max() > best:
            best, place = float(steps.max()), int(steps.argmax()) + side
    return best, place


def _flickers(gain, error):
    r"""By how much [1] a gain (t,) flickers from frame to frame besides its errors (t,), as 1/f noise does:
    half of the differences d are smaller than a normal law of variance :math:`2 s^2 + \sum\sigma^2` has them.

    Where errors fall with time, as those of a brightening surface do, the usual step is that of early frames.
    """
    told = np.flatnonzero(np.isfinite(gain) & (error < CLEAR))
    if told.size < LEAST_USUAL_STEPS:
        return 0.0
    square = np.diff(gain[told]) ** 2
    noise = error[told][1:] ** 2 + error[told][:-1] ** 2

    def more(flicker):
        return np.median(square / (noise + 2 * flicker**2)) - MEDIAN

    return brentq(more, 0.0, CLEAR) if more(0.0) > 0 > more(CLEAR) else 0.0


def left_over(model, solution):
    """`MOMENT` or `PATTERN` if an instrument of many channels leaves one beyond noise, `FRAMES` if some stand
    out or they are of two kinds, `STEP` if its gain has one, else None.

    Notes
    -----
    The largest singular value of noise lies within a per cent of :math:`\\sqrt n + \\sqrt C`
    (I. M. Johnstone, Ann. Stat. 29 (2001) 295): a test for any pattern, where `structures` look for some.
    """
    for instrument, z in zip(model.instruments, whitened(model, solution), strict=True):
        if instrument.channels < LEAST:
            continue
        time, _, size, expected = leading(z)
        if size > LARGER * expected:
            lasting = 1 / np.sum(time**4)  # samples that share the pattern, about
            return MOMENT if lasting < SHORT * time.size else PATTERN
        if model.plasma and brightest_box(z, phase_of(instrument.time, model.off)) > LINE_STANDS:
            return MOMENT
    for instrument, residual, value, weigher in zip(
        model.instruments, solution.residual, solution.prediction, solution.weighers, strict=True
    ):
        if instrument.channels >= LEAST:
            count = standing_out(residual, value, weigher, phase_of(instrument.time, model.off)).sum()
            if count >= max(FEWEST, LEAST_SHARE * len(value)):
                return FRAMES
    if not model.plasma:
        return None
    return _of_frames(model, solution)


def _of_frames(model, solution):
    """`FRAMES` if the frames of an instrument of many channels are of two kinds, `STEP` if their gain has a
    step: bins, noise and gains that wander would swallow it."""
    samples = raw_residuals(model, solution)
    for instrument, weigher, found in zip(model.instruments, solution.weighers, samples, strict=True):
        if instrument.channels < LEAST:
            continue
        time = instrument.raw_moment.mean(axis=1)
        gain, error = gains_of_frames(instrument, *found, weigher.weight)
        period, phase = float(np.median(np.diff(time))), phase_of(time, model.off)
        if _two_kinds(gain, error, phase):
            return FRAMES
        if any(
            largest_step(gain[own], error[own], period)[0] > STEP_STANDS
            for own in (phase == which for which in np.unique(phase))
        ):
            return STEP
    return None


def _two_kinds(gain, error, phase):
    """Whether gains (t,) of frames are of two kinds, beside their neighbours; of those that tell it."""
    told = np.isfinite(gain) & (error < CLEAR)
    apart = gain - slow_part(np.where(told, gain, np.nan)[:, None], told, phase)[:, 0]
    told &= error < 1.4826 * np.median(np.abs(apart[told])) if told.any() else False
    return told.sum() >= LEAST_FRAMES and two_kinds(apart[told], error[told] ** 2)
