"""Relative error and its limit on curves whose crossing is known."""

import numpy as np
import pytest

from plasmapyro.analysis.error import error_limit, relative_error

TEMPERATURE = np.arange(500.0, 2501.0, 5.0)


def test_error_is_a_fraction_of_the_truth():
    assert relative_error(1100.0, 1000.0) == pytest.approx(0.1, rel=1e-15, abs=0)
    assert np.isnan(relative_error(np.nan, 1000.0))


def test_limit_of_a_decaying_error_is_found():
    error = 0.01 * np.exp(-(TEMPERATURE - 1234.0) / 100.0)
    limit, status = error_limit(TEMPERATURE, error, 0.01)
    # linear interpolation of exp over 5 K: (5/100)**2/8 * 100 K = 0.03 K at most
    assert limit == pytest.approx(1234.0, abs=0.04)
    assert status == 0


def test_a_lucky_zero_crossing_below_does_not_count():
    error = np.where(TEMPERATURE < 900, 0.005, 0.01 * (1400.0 / TEMPERATURE) ** 3)
    limit, _ = error_limit(TEMPERATURE, error, 0.01)
    assert limit == pytest.approx(1400.0, abs=0.02)


def test_a_reading_too_low_is_no_crossing():
    error = np.where(TEMPERATURE < 1500, 0.03 - 0.02 * (TEMPERATURE - 500) / 1000, -0.05)
    limit, status = error_limit(TEMPERATURE, error, 0.02)
    assert status == 0
    assert limit == pytest.approx(1000.0, abs=1e-9)


def test_no_reading_counts_as_an_infinite_error():
    error = np.where(TEMPERATURE < 1000, np.nan, 0.001)
    limit, status = error_limit(TEMPERATURE, error, 0.01)
    assert status == 0
    assert limit == 1000  # nothing is known of 995 K to 1000 K, so nothing is promised


def test_limits_outside_the_range_are_flagged_not_invented():
    curves = np.stack([np.full(TEMPERATURE.size, 0.001), np.full(TEMPERATURE.size, 0.5)])
    limit, status = error_limit(TEMPERATURE, curves, 0.01)
    assert status.tolist() == [-1, 1]
    assert np.isnan(limit).all()
