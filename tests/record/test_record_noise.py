"""Noise and flicker of made signals are found again."""

import numpy as np
import pytest

from plasmapyro.estimate.observations import HUBER, robust_sum, robust_weight
from plasmapyro.record.noise import flicker, signal_noise, standing_together, variance

TIME = np.arange(0, 400, 0.1)


def ornstein_uhlenbeck(random, deviation, correlation):
    memory = np.exp(-0.1 / correlation)
    kicks = random.standard_normal(TIME.size) * deviation
    path = [kicks[0]]
    for kick in kicks[1:]:
        path.append(memory * path[-1] + np.sqrt(1 - memory**2) * kick)
    return np.array(path)


def made(seed, relative, floor, gas_flicker):
    random = np.random.default_rng(seed)
    level = np.stack(
        [np.interp(TIME, [0, 200, 400], [1, 1, 100]), np.interp(TIME, [0, 200, 400], [2, 2, 300])]
    )
    gas = np.exp(ornstein_uhlenbeck(random, gas_flicker, 0.3))
    clean = level * np.where(TIME < 200, gas, 1.0)
    noise = random.standard_normal((2, 2, TIME.size))
    return clean * (1 + np.array(relative)[:, None] * noise[0]) + np.array(floor)[:, None] * noise[1]


def test_noise_of_each_band_is_told_from_flicker_that_both_share():
    floor, relative = signal_noise(made(1, (0.01, 0.005), (0.0, 0.0), 0.03), 50)
    assert relative == pytest.approx([0.01, 0.005], rel=0.12)
    # Taken for noise, the flicker, seen at the lower level only, would be a floor of 1.4 % of it.
    assert (floor < 0.004 * np.array([1.0, 2.0])).all()


def test_floor_and_relative_noise_are_told_apart_by_the_level():
    floor, relative = signal_noise(made(2, (0.01, 0.01), (0.05, 0.1), 0.0), 50)
    assert relative == pytest.approx([0.01, 0.01], rel=0.2)
    assert floor == pytest.approx([0.05, 0.1], rel=0.2)


def test_flicker_and_its_time_come_from_what_the_bands_share():
    signals = made(3, (0.02, 0.02), (0.0, 0.0), 0.015)
    deviation, correlation = flicker(TIME, signals, [TIME < 100, (TIME >= 100) & (TIME < 200)])
    assert deviation == pytest.approx(0.015, rel=0.15)
    assert correlation == pytest.approx(0.3, rel=0.35)


def test_without_flicker_or_window_nothing_is_claimed():
    silent = made(4, (0.01, 0.01), (0.0, 0.0), 0.0)
    deviation, _ = flicker(TIME, silent, [TIME < 200])
    assert np.isnan(deviation) or deviation < 0.002
    assert np.isnan(flicker(TIME, silent, [TIME < 1])[0])


def test_few_samples_are_refused():
    with pytest.raises(ValueError, match="needs 200 samples; got 100"):
        signal_noise(np.ones((2, 100)), 50)
    with pytest.raises(ValueError, match="a signal has no noise at all"):
        signal_noise(np.ones((2, 400)), 50)


def test_samples_that_stand_together_count_as_fewer():
    """The mean of many such values is known as of (1 - m)/(1 + m) as many, m: memory per step."""
    random = np.random.default_rng(6)
    white = random.standard_normal(TIME.size)
    joined = np.stack([white, ornstein_uhlenbeck(random, 1.0, 0.4)])
    joined[:, 500:700] = np.nan
    own, together = standing_together(joined)
    assert own == pytest.approx(1.0, abs=0.05)  # three standard errors of a median of 3800
    memory = np.exp(-0.1 / 0.4)
    # blocks of 32, two standard errors of 125 less than found
    assert 0.7 < together / np.sqrt((1 + memory) / (1 - memory)) < 1.0


def test_variance_does_not_see_outliers():
    values = np.random.default_rng(5).standard_normal(10000)
    values[:200] = 1e6
    assert variance(values) == pytest.approx(1.0, rel=0.1)


def test_huber_joins_smoothly_and_ignores_missing():
    below, above = robust_sum(np.array([HUBER - 1e-6])), robust_sum(np.array([HUBER + 1e-6]))
    assert above - below == pytest.approx(2e-6 * HUBER, rel=1e-4, abs=0)
    assert robust_sum(np.array([3.0, np.nan])) == pytest.approx(4.5, abs=1e-12)
    np.testing.assert_allclose(robust_weight(np.array([1.0, -8.0, np.nan])), [1.0, 0.5, 0.0], rtol=1e-12)
