"""Noise that is found where a fit lags behind the temperature, or where most frames are faint."""

import numpy as np
import pytest

from plasmapyro.diagnosis.fit import noise
from plasmapyro.diagnosis.fit.coloured import coloured


@pytest.fixture
def random():
    return np.random.default_rng(5)


def test_a_temperature_that_lags_behind_is_no_noise_of_a_band(random):
    """A slow pyrometer on a surface that cools: what both bands share has a memory, their noise has none."""
    count, sigma = 400, 0.002
    lag = 0.02 * np.sin(np.linspace(0, 40, count)) + 0.06 * np.linspace(0, 1, count) ** 8
    relative = np.stack([lag, 1.1 * lag], axis=1) + sigma * random.standard_normal((count, 2))
    level = np.exp(-np.linspace(0, 4, count))[:, None] * [1.0, 0.5]
    law, memory, *_ = noise._of_bands(
        relative * level, level, 0 * level, np.ones(count, dtype=bool), np.zeros(count, dtype=int), 1.0
    )
    assert memory == 0.0
    # 400 differences that share samples: 9 % of a variance; the lag is not the same in both bands.
    assert np.sqrt(law[2]) == pytest.approx(sigma, rel=0.2)


def test_faint_frames_do_not_hide_the_gain_of_bright_ones(random):
    """Errors stated 15 % too large, as they are while the law of the noise holds the gain: faint frames
    would take all of it away."""
    count, sigma, time, period = 500, 0.003, 0.7, 0.4
    keep = np.exp(-period / time)
    gain, steps = np.zeros(count), random.standard_normal(count)
    for place in range(1, count):
        gain[place] = keep * gain[place - 1] + sigma * np.sqrt(1 - keep**2) * steps[place]
    error = np.where(np.arange(count) < 350, 2e-4, 0.009)
    level = gain + error * random.standard_normal(count)
    found = coloured(
        level, level, (1.15 * error) ** 2, np.ones(count, dtype=bool), np.zeros(count, dtype=int), period, 6.0
    )
    # 350 frames that share samples: some 8 % of a standard deviation; a mean of all frames finds none.
    assert np.sqrt(found.between(period)) == pytest.approx(sigma * np.sqrt(1 - keep), rel=0.2)


def test_what_is_smooth_from_sample_to_sample_is_no_longer_memory_than_it_is(random):
    """A sight line that shakes with 0.7 s, at 60 Hz: its third differences from sample to sample are a
    thousandth of what exponential memories have, and so sure that only the longest of these came near."""
    count, size, period, time = 9000, 2.4e-3, 0.017, 0.7
    knots = np.arange(0.0, count * period + 1, time / 8)
    keep = np.exp(-1 / 8)
    value = np.zeros(knots.size)
    for at in range(1, knots.size):
        value[at] = keep * value[at - 1] + np.sqrt(1 - keep**2) * random.standard_normal()
    shared = size * np.interp(np.arange(count) * period, knots, value)
    bands = shared + 2e-4 * random.standard_normal((2, count))
    whole = np.ones(count, dtype=bool)
    found = coloured(*bands, np.zeros(count), whole, np.zeros(count, dtype=int), period, 6.0)
    # Two hundred memories long: 10 %, and what smooth noise loses below its knots.
    assert np.sqrt(found.total) == pytest.approx(size, rel=0.25)


def test_rounded_samples_that_stand_still_do_not_say_that_there_is_no_noise(random):
    """Noise of ten steps on a hot surface, of a tenth of one on the gas before: that shows nothing,
    and would outweigh all that does."""
    count, sigma, step = 3000, 0.003, 3e-4
    cold = np.arange(count) < 500
    level = np.where(cold, 30.2 * step, 1.0)[:, None] * [1.0, 0.8]
    written = step * np.round(level * (1 + sigma * random.standard_normal((count, 2))) / step)
    whole, rounded = np.ones(count, dtype=bool), np.full((count, 2), step**2 / 12)
    gas = np.where(cold[:, None], level, 0.0)
    law, *_ = noise._of_bands(written - level, level, gas, whole, cold.astype(int), 1.0, rounded)
    # 2500 differences that share samples.
    assert np.sqrt(law[2]) == pytest.approx(sigma, rel=0.15)
