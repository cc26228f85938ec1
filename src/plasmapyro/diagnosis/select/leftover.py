"""What a final fit leaves in many channels at once, whatever it looks like."""

import numpy as np

from plasmapyro.diagnosis.fit.base import phase_of
from plasmapyro.diagnosis.fit.noise import slow_part

DRAWS, SEED = 5, 7  # of noise, whose largest singular value is the one to be expected
LARGER = 1.1  # [1] over that: residuals of 60 tests without a fault stay below 1.05
LEAST = 10  # channels of an instrument that has patterns
SHORT = 0.1  # [1] of the record: what lasts no longer is a moment
STANDS = 6.0, 2.5  # usual distances, and standard deviations of the noise, by which frames stand out
FEWEST, LEAST_SHARE = 3, 0.05  # how many of them must, and of all: of a normal law 0.012 lie so far
LEAST_APART = 0.01  # [1] of the light: less is a path or a gas that is not quite followed
FRAMES, MOMENT, PATTERN = "left_frames", "left_moment", "left_pattern"
NAMES = {
    FRAMES: "frames of the spectrometer that are brighter or fainter than their neighbours",
    MOMENT: "what the spectrometer saw for a moment",
    PATTERN: "a pattern over wavelength that comes and goes",
}


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
    scatter = 1.4826 * np.median(apart / expected)
    return apart > np.maximum(max(STANDS[0] * scatter, STANDS[1]) * expected, LEAST_APART)


def left_over(model, solution):
    """`MOMENT` or `PATTERN` if a spectrometer leaves one beyond noise, `FRAMES` if some stand out, else None.

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
    for instrument, residual, value, weigher in zip(
        model.instruments, solution.residual, solution.prediction, solution.weighers, strict=True
    ):
        if instrument.channels >= LEAST:
            count = standing_out(residual, value, weigher, phase_of(instrument.time, model.off)).sum()
            if count >= max(FEWEST, LEAST_SHARE * len(value)):
                return FRAMES
    return None
