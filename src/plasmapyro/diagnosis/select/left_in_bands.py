"""What a final fit leaves in the samples of a few bands, which its bins swallow."""

import numpy as np

from plasmapyro.diagnosis.fit.base import phase_of, raw_residuals
from plasmapyro.diagnosis.select.jumps import largest_jump
from plasmapyro.diagnosis.select.leftover import CLEAR, LEAST, STEP_STANDS, gains_of_frames
from plasmapyro.diagnosis.select.periodic import chance_of_peak
from plasmapyro.diagnosis.select.structures import SHORTEST_PERIOD

BY_CHANCE = 1e-4  # with which noise may repeat
STEP, WAVE = "left_step_pyrometer", "left_wave_pyrometer"
NAMES = {
    STEP: "a step of the bands of the {source} from one sample to the next",
    WAVE: "what repeats within seconds in the bands of the {source}",
}


def names(instruments):
    """Names of what is left, by id, in the words of the first of the instruments that has few bands."""
    source = next((one.source for one in instruments if one.channels < LEAST), "pyrometer")
    return {identity: name.format(source=source) for identity, name in NAMES.items()}


def left_in_bands(model, solution):
    """`STEP` if all bands of an instrument of few change from one sample to the next, `WAVE` if something
    repeats faster than `structures` look for, else None; of tests with a plasma."""
    if not model.plasma:
        return None
    samples = raw_residuals(model, solution)
    for instrument, weigher, found in zip(model.instruments, solution.weighers, samples, strict=True):
        if instrument.channels >= LEAST:
            continue
        time, residual = instrument.raw_moment.mean(axis=1), found[0]
        gain, error = gains_of_frames(instrument, *found, weigher.weight)
        period, phase = float(np.median(np.diff(time))), phase_of(time, model.off)
        told = np.isfinite(gain) & (error < CLEAR)
        for which in (1, 2):
            own = told & (phase == which)
            if largest_jump(gain[own], error[own], period)[0] > STEP_STANDS:
                return STEP
        weight = (weigher.weight / np.maximum(instrument.number, 1))[np.maximum(instrument.raw_bin, 0)]
        white = (residual - _of_the_gas(residual, found[2], weight)) * np.sqrt(weight)
        sound = np.isfinite(white).all(axis=1)
        for which in (1, 2):
            own = sound & (phase == which)
            if _repeats(white[own], time[own], period):
                return WAVE
    return None


def _of_the_gas(residual, gas, weight):
    """What the brightness of the gas may make of residuals (t, C): a torch ripples by per cents with its
    rectifier, and sampling folds that down. After the plasma there is none."""
    both = np.sum(weight * gas * np.nan_to_num(residual), axis=1)
    return gas * (both / np.maximum(np.sum(weight * gas**2, axis=1), 1e-300))[:, None]


def _repeats(white, time, period):
    """Whether white residuals (t, C) at times (t,), of a band or of all together, hold a wave."""
    if not time.size:
        return False
    place = np.round((time - time[0]) / period).astype(int)
    values = np.zeros((place[-1] + 1, white.shape[1]))
    values[place] = white - np.median(white, axis=0)
    series = [*values.T, values.sum(axis=1)]
    chance = min(chance_of_peak(one, period, SHORTEST_PERIOD)[0] for one in series)
    return chance * len(series) < BY_CHANCE
