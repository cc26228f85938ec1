"""Reference window and corrected signals on cases solved by hand."""

import numpy as np
import pytest

from plasmapyro.experiment.signals import (
    corrected_signal,
    corrected_signal_uncertainty,
    reference_signal,
    shared_scatter,
)
from plasmapyro.record.phases import phases

FLOAT_RTOL = 1e-12
TIME = np.arange(-5.0, 20.0, 0.1)


def test_reference_is_the_mean_of_the_window_only():
    signal = np.where((TIME >= 0) & (TIME <= 6), 3.0, 100.0)
    mean, uncertainty = reference_signal(TIME, signal, (0.0, 6.0))
    assert (mean, uncertainty) == (3.0, 0.0)


def test_missing_samples_are_left_out():
    signal = np.where(np.arange(TIME.size) % 2, np.nan, 2.0)
    assert reference_signal(TIME, signal, (0.0, 6.0))[0] == 2.0


def test_the_gas_scatters_as_both_signals_do_in_the_window():
    one, other = np.random.default_rng(1).standard_normal((2, 60))
    time, level = np.arange(60.0), np.where(np.arange(60) < 30, 1.2, 0.8)
    shared = np.sqrt(0.04 * 60 / 59)
    assert shared_scatter(time, np.array([3 * level, level]), (0.0, 59.0)) == pytest.approx(shared)
    assert shared_scatter(time, np.array([10 + one, 10 + other]), (0.0, 59.0)) == 0.0
    assert shared_scatter(time, np.array([level - 1, level]), (0.0, 59.0)) == 0.0  # no light at all


def test_uncertainty_of_independent_samples_is_the_standard_error():
    time, generator = np.arange(400.0), np.random.default_rng(6)
    found = [reference_signal(time, row, (0.0, 399.0)) for row in generator.standard_normal((300, 400))]
    means, uncertainties = np.array(found).T
    assert means.std() == pytest.approx(0.05, rel=0.13)  # 1/sqrt(400); 3 sigma of 300 repeats
    assert uncertainties.mean() == pytest.approx(0.05, rel=0.08)  # negative chance correlation is cut at 0


def test_slow_flicker_widens_the_uncertainty_as_it_widens_the_scatter_of_means():
    time, generator, memory = np.arange(600.0), np.random.default_rng(7), 0.8
    rows = generator.standard_normal((300, 600)) * np.sqrt(1 - memory**2)
    for index in range(1, 600):
        rows[:, index] += memory * rows[:, index - 1]
    means, uncertainties = np.array([reference_signal(time, row, (0.0, 599.0)) for row in rows]).T
    assert uncertainties.mean() == pytest.approx(means.std(), rel=0.15)
    assert uncertainties.mean() > 2.5 / np.sqrt(600)  # sqrt((1 + r)/(1 - r)) = 3 for r = 0.8


def test_window_without_samples_is_refused():
    with pytest.raises(ValueError, match="reference window 30 to 36 s holds 0 samples, 3 needed"):
        reference_signal(TIME, TIME, (30.0, 36.0))


def test_gas_is_taken_away_only_while_the_plasma_is_on():
    time = np.array([-1.0, 0.0, 5.0, 10.0, 10.1])
    injected, shining = phases(time, 0.0, 10.0)
    corrected = corrected_signal(np.full((2, 5), 5.0), [2.0, 3.0], injected, shining)
    np.testing.assert_array_equal(corrected, [[np.nan, 3, 3, 3, 5], [np.nan, 2, 2, 2, 5]])


def test_the_same_light_added_to_everything_cancels():
    injected, shining = phases(TIME, 0.0, 15.0)
    signal = 1 + np.maximum(TIME - 6, 0)
    bright = signal + np.where(shining, 7.0, 0.0)
    pair = [
        corrected_signal(row, reference_signal(TIME, row, (0.0, 6.0))[0], injected, shining)
        for row in (signal, bright)
    ]
    before_end = injected & shining
    np.testing.assert_allclose(pair[0][before_end], pair[1][before_end], atol=1e-12)


def test_uncertainties_add_in_squares_and_the_gas_counts_only_while_on():
    found = corrected_signal_uncertainty(
        np.array([[300.0, 300.0]]), np.array([100.0]), np.array([2.0]), np.array([True, False]), 0.01, 0.06
    )
    np.testing.assert_allclose(found, [[7.0, 3.0]], rtol=FLOAT_RTOL)  # 3, 2 and 6; then 3 alone
