"""Tests that hide nothing, of samples, gases and instruments unlike the shipped ones, show nothing wrong."""

import numpy as np
import pytest
from small_laboratory import temperature_of

from plasmapyro.diagnosis.fit import noise

COLD = {"height": 450.0, "rise_time": 60.0, "period": 0.05, "noise": 0.5}  # 800 K: the gas outshines it
PORED = {"drop": 400.0, "noise": 0.2, "period": 0.05}  # [K s-1/2]: an ablator
RESTLESS = {"flicker": 0.02, "noise": 0.2}


@pytest.mark.parametrize(
    "settings",
    [COLD, PORED, RESTLESS, COLD | {"frame": 13.0}, PORED | {"frame": 13.0}],
    ids=["cold", "ablator", "1/f", "cold, long exposures", "ablator, long exposures"],
)
def test_nothing_is_wrong_with_a_sound_test_of_another_kind(diagnosed, settings):
    found = diagnosed(**settings)
    assert found.report["verdict"]["status"] == "null"
    assert found.report["base"]["converged"] and found.report["base"]["adequate"]
    result = found.temperature
    time = result.time_bin.values
    hot = (time > 80) & ((time < 119) | (time > 122))
    shape = {name: value for name, value in settings.items() if name in ("height", "rise_time", "drop")}
    truth = temperature_of(time[hot], **shape)
    inside = (result.base_temperature_low.values[hot] <= truth) & (
        truth <= result.base_temperature_high.values[hot]
    )
    assert inside.mean() > 0.9


def test_noise_of_channels_of_unlike_sensitivity_is_found_from_few_frames():
    """18 frames, channels whose counts are worth 1 to 100: grouped by light, the loud ones would be hits."""
    random = np.random.default_rng(1)
    factor, pixels = np.geomspace(1, 100, 200), np.full(200, 3.0)
    level = np.abs(np.sin(np.arange(200))) * 500 + np.zeros((18, 1))
    law = np.array([240.0, 0.3, 0.0])
    sigma = np.sqrt(noise.sample_variance(*law, level, factor, pixels))
    sample = sigma * random.standard_normal(level.shape)
    found = noise._fit_variance(np.diff(sample, axis=0), level[1:], factor, pixels)
    ratio = noise.sample_variance(*found, level, factor, pixels) / sigma**2
    # 3400 differences know a variance to 2.4 %, and share it between two terms.
    assert np.all(np.abs(ratio - 1) < 0.15)


def test_a_few_faint_frames_tell_the_read_noise_amid_many_bright_ones():
    """In each channel the faintest sixth held bright frames too: its clipped variance was that of the faint
    ones, its mean light that of the bright ones, and the read noise came out near zero."""
    random = np.random.default_rng(2)
    level = np.concatenate([np.full(8, 30.0), np.geomspace(30, 3e4, 14), np.full(120, 3.4e4)])
    level = level[:, None] * np.linspace(0.7, 1.3, 150)
    law, one = np.array([25.0, 0.3, 0.0]), np.ones(150)
    sigma = np.sqrt(noise.sample_variance(*law, level, one, one))
    sample = sigma * random.standard_normal(level.shape)
    found = noise._fit_variance(np.diff(sample, axis=0), (level[1:] + level[:-1]) / 2, one, one)
    ratio = noise.sample_variance(*found, level, one, one) / sigma**2
    assert np.all(np.abs(ratio - 1) < 0.2)  # where bright and faint meet, differences are of both
