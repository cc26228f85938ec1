"""How noisy each instrument is, from what neighbours in time do not share once the base model is taken away."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from plasmapyro.diagnosis import binning
from plasmapyro.diagnosis.inference import Noise

CLIP = 4.5  # standard deviations beyond which a sample is left out
ROUNDS = 3
LEVELS = 6  # groups of samples by signal, per channel
LARGEST_MEMORY = 0.9  # autocorrelation of neighbours that is believed
LEAST_MEMORY = 0.04  # smaller ones count as none
START_RELATIVE = 0.004  # [1] noise of the first fit: of the value
START_CONSTANT = 0.05  # [1] and of the gas
START_FLICKER = 0.01


@dataclass(frozen=True)
class NoiseModel:
    r"""Variance of one sample :math:`a f^2/N + b f S/N + c S^2` of N pixels with the factor f, its memory from
    sample to sample (lag-1), the variance of the brightness of the gas and the memory of that; `tail`: samples
    beyond 4 standard deviations over what a normal law has."""

    constant: float
    linear: float
    quadratic: float
    memory: float
    flicker: float
    flicker_memory: float
    tail: float


def first_guess(model, gas):
    """Noise for the first fit, from round numbers."""
    result = []
    for one, own in zip(model.instruments, gas, strict=True):
        level = np.median(own[own.max(axis=1) > 0], axis=0)
        variance = (START_RELATIVE * np.nan_to_num(one.value)) ** 2 + (START_CONSTANT * level) ** 2
        variance = np.where(np.isfinite(one.value), variance, np.inf)
        result.append(Noise(variance, np.full(one.value.shape[0], START_FLICKER**2)))
    return result


def differences(values, chosen):
    """First and second-neighbour differences of consecutive chosen samples (t, ...): V1 and V2 of [1, 2] steps."""
    one = np.flatnonzero(chosen[1:] & chosen[:-1])
    two = np.flatnonzero(chosen[2:] & chosen[1:-1] & chosen[:-2])
    return values[one + 1] - values[one], values[two + 2] - values[two], one


def clipped_variance(values, axis=None):
    """Variance about zero of what lies within `CLIP` robust standard deviations; NaN-aware."""
    centre = np.nanmedian(np.abs(values), axis=axis, keepdims=True) * 1.4826
    kept = np.where(np.abs(values) <= CLIP * np.maximum(centre, 1e-300), values, np.nan)
    return np.nanmean(kept**2, axis=axis)


def estimate(instrument, residual, prediction, gas, injection_phase):
    """Noise model of one instrument from residuals of its samples.

    Parameters
    ----------
    instrument : Instrument
    residual, prediction, gas : (t, C) of the raw samples; NaN where not used
    injection_phase : (t,) int, phase of each sample: differences are not taken across phases

    Returns
    -------
    NoiseModel, and residuals with the flicker of the gas taken out (t, C).
    """
    used = (instrument.raw_bin >= 0) & np.isfinite(residual).any(axis=1)
    same = np.zeros(used.size, dtype=bool)
    same[1:] = injection_phase[1:] == injection_phase[:-1]
    flicker, flicker_memory, residual = _flicker(instrument, residual, prediction, gas, used, same)
    one, two, place = differences(residual, used)
    whole = same[place + 1]
    one, level = one[whole], (prediction[place + 1] + prediction[place])[whole] / 2
    pixels = np.ones(instrument.channels) if instrument.pixel_edges is None else np.diff(instrument.pixel_edges)
    factor = np.ones(instrument.channels) if instrument.factor is None else instrument.factor
    constant, linear, quadratic = _fit_variance(one, level, factor, pixels, instrument.kind)
    sigma = np.sqrt(sample_variance(constant, linear, quadratic, level, factor, pixels))
    scaled = one / (np.sqrt(2) * sigma)
    memory = _memory(residual, prediction, used, (constant, linear, quadratic), factor, pixels)
    # Differences of neighbours that remember each other are smaller than those of strangers.
    swell = 1 / (1 - memory)
    tail = np.mean(np.abs(scaled) > 4) / 6.334e-5
    found = NoiseModel(
        constant * swell, linear * swell, quadratic * swell, memory, flicker, flicker_memory, float(tail)
    )
    return found, residual


def _flicker(instrument, residual, prediction, gas, used, same):
    """Variance and memory of the brightness of the gas; residuals without it."""
    share = np.nanmedian(gas / np.maximum(prediction, 1e-300), axis=1)
    bright = used & (share > 0.5)
    if bright.sum() < 8:
        bright = used & (share > 0.05)
    if bright.sum() < 8:
        return 0.0, 0.0, residual
    weight = gas / np.maximum(prediction, 1e-300) ** 2
    filled = np.nan_to_num(residual)
    level = np.sum(weight * filled, axis=1) / np.maximum(np.sum(weight * gas, axis=1), 1e-300)
    one, two, place = differences(level, bright)
    own = same[place + 1]
    first, second = clipped_variance(one[own]), clipped_variance(two)
    if instrument.channels == 2:
        # What the two bands do not share is their own noise, not the gas.
        apart = filled[:, 0] / np.maximum(gas[:, 0], 1e-300) - filled[:, 1] / np.maximum(gas[:, 1], 1e-300)
        own_one, own_two, _ = differences(apart, bright)
        first = max(first - clipped_variance(own_one[own]) / 4, 1e-12)
        second = max(second - clipped_variance(own_two) / 4, 1e-12)
    memory = float(np.clip(second / first - 1, 0.0, LARGEST_MEMORY))
    if instrument.channels > 2:
        shine = used & (share > 0.02)
        residual = residual - np.where(shine, level, 0.0)[:, None] * gas
    else:
        residual = np.where((share > 0.02)[:, None], residual - level[:, None] * gas * 0.0, residual)
    return float(first / (2 * (1 - memory))), memory, residual


def sample_variance(constant, linear, quadratic, level, factor, pixels):
    """Variance (t, C) of single samples of some level."""
    level = np.maximum(level, 0.0)
    return (constant * factor**2 + linear * factor * level) / pixels + quadratic * level**2


def _fit_variance(difference, level, factor, pixels, kind):
    """Non-negative a, b, c of `NoiseModel` from differences of neighbours (d, C)."""
    rows, variances = [], []
    for channel in range(difference.shape[1]):
        good = np.isfinite(difference[:, channel])
        if good.sum() < 8:
            continue
        own, at = difference[good, channel], level[good, channel]
        edges = np.quantile(at, np.linspace(0, 1, LEVELS + 1))
        for low, high in zip(edges[:-1], edges[1:], strict=True):
            inside = (at >= low) & (at <= high)
            if inside.sum() < 6:
                continue
            mean = at[inside].mean()
            f, n = factor[channel], pixels[channel]
            linear = f * mean / n if kind == "spectrometer" else 0.0
            rows.append((f**2 / n, linear, mean**2))
            variances.append(clipped_variance(own[inside]) / 2)
    rows, variances = np.array(rows), np.array(variances)
    scale = np.maximum(rows.max(axis=0), 1e-300)
    solution = np.zeros(3)
    weight = 1 / np.maximum(variances, 1e-300)
    for _ in range(ROUNDS):
        solution, _ = nnls(rows / scale * weight[:, None], variances * weight)
        fitted = rows / scale @ solution
        weight = 1 / np.maximum(fitted, 1e-3 * variances)
    return solution / scale


def _memory(residual, prediction, used, law, factor, pixels):
    """Autocorrelation of neighbours, from steps of one and two samples."""
    sigma = np.sqrt(sample_variance(*law, prediction, factor, pixels))
    one, two, _ = differences(residual / sigma, used)
    first, second = clipped_variance(one), clipped_variance(two)
    memory = float(np.clip(second / first - 1, -0.5, LARGEST_MEMORY))
    return memory if memory > LEAST_MEMORY else 0.0


def on_bins(model_noise, instrument, prediction):
    """`Noise` of the bins of an instrument, from that of its samples."""
    factor = np.ones(instrument.channels) if instrument.factor is None else instrument.factor
    pixels = np.ones(instrument.channels) if instrument.pixel_edges is None else np.diff(instrument.pixel_edges)
    one = sample_variance(
        model_noise.constant, model_noise.linear, model_noise.quadratic, prediction, factor, pixels
    )
    samples = np.maximum(instrument.number, 1)
    variance = one / samples * (1 + model_noise.memory) / (1 - model_noise.memory)
    mean_samples = np.maximum(instrument.number.max(axis=1), 1)
    memory = model_noise.flicker_memory
    # Variance of the mean of n samples with geometric memory (exact).
    n = mean_samples
    shared = (1 + memory) / (1 - memory) - 2 * memory * (1 - memory**n) / (n * (1 - memory) ** 2)
    flicker = model_noise.flicker / n * shared
    return Noise(np.where(np.isfinite(instrument.value), variance, np.inf), flicker)


def without_outliers(instrument, residual, sigma):
    """The instrument with samples beyond `CLIP` standard deviations left out of its bins."""
    clean = np.isfinite(instrument.raw) & ~(np.abs(residual) > CLIP * sigma)
    raw = np.where(clean, instrument.raw, np.nan)
    value, number = binning.mean_in_bins(raw, instrument.raw_bin, instrument.value.shape[0])
    return replace(instrument, value=value, number=number, raw_clean=clean)
