"""Where a light begins to fall for good: the end of the plasma, or a sample that is gone."""

import numpy as np
import pytest

from plasmapyro.quality.series import fall

TIME = np.arange(0.5, 90.0)  # [s], means of 1 s


def test_a_sample_that_is_gone_is_seen_where_it_is_dark_behind_the_end():
    """Without a sample there is noise about zero behind the end, whose logarithm had stopped the search."""
    light = np.where(TIME < 55, 1000.0 * -np.expm1(-TIME / 15), 30.0)
    light[TIME > 80] = 0.2 * np.random.default_rng(1).standard_normal((TIME > 80).sum())
    first, last, drop = fall(TIME, light, 1.0)
    assert first <= 55 <= last and drop == pytest.approx(0.97, abs=0.01)


def test_noise_of_a_surface_that_is_still_cold_is_no_end():
    light = 3500.0 * (-np.expm1(-TIME / 15)) ** 6
    light[TIME > 80] *= np.exp(-0.3 * (TIME[TIME > 80] - 80))
    light[:5] = 1.0, 1.1, 1.35, 0.65, 1.0
    first, last, _ = fall(TIME, light, 1.0)
    assert first <= 80 <= last


def test_a_sample_that_leaves_the_view_in_the_plasma_falls_to_the_dark_at_once():
    light = 1000.0 * -np.expm1(-TIME / 15)
    light[TIME > 55] = 0.2 * np.random.default_rng(3).standard_normal((TIME > 55).sum())
    light[TIME == 55.5] = -0.1
    first, last, drop = fall(TIME, light, 1.0)
    assert first <= 55 <= last and drop > 0.99
