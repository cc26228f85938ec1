"""Temperatures of the pyrometer: status, order of the reasons, Monte Carlo against linear propagation."""

import numpy as np
import pytest

from plasmapyro.experiment import correction
from plasmapyro.experiment.correction import (
    Reading,
    _ranked_temperature,
    budget_of,
    read_corrected,
    read_measured,
    temperature_uncertainty,
)
from plasmapyro.instrument.calibration import quadratic_ratio, scaled
from plasmapyro.record import status
from plasmapyro.record.budget import combined

COEFFICIENT = np.array([0.40, 0.12, -0.003])
COVARIANCE = np.diag([1e-6, 2e-6, 2e-6])
FIT, INSTRUMENT = np.array([973.0, 1773.0]), np.array([973.0, 2073.0])
SLOPE_RTOL = 1e-4  # of central differences over a tenth of an uncertainty
MONTE_CARLO_RTOL = 0.04  # 3 sigma of a spread from 10000 draws, and curvature


def pair(temperature, narrow=1.0):
    ratio = quadratic_ratio(np.atleast_1d(temperature), COEFFICIENT, FIT)
    return np.stack([ratio * narrow, np.full(ratio.size, narrow)])


def reading(slope=1.0, u=0.01, variation=0.0, covariance=COVARIANCE, slope_uncertainty=0.0):
    limits = u, variation, 2.0, 0.5
    return Reading(COEFFICIENT, FIT, INSTRUMENT, slope, *limits, covariance, slope_uncertainty)


def measured(signals, saturated=False, slope=1.0):
    return read_measured(reading(slope), signals, np.full(signals.shape[1], saturated))


def corrected(signals, gas=0.0, uncertainty=1e-6, injected=True, saturated=False, slope=1.0):
    clean = signals - gas
    shape = clean.shape
    states = np.full(shape[1], injected), np.full(shape[1], saturated)
    return read_corrected(reading(slope), signals, clean, np.full(shape, uncertainty), *states)


def test_known_temperatures_come_back():
    temperature, state = measured(pair([1000.0, 1500.0, 1900.0]))
    np.testing.assert_allclose(temperature, [1000, 1500, 1900], rtol=1e-12)
    assert state.tolist() == [status.VALID, status.VALID, status.EXTRAPOLATED]


def test_every_absent_reading_says_why():
    signals = np.array([[0.1, 5.0, np.nan, -1.0], [1.0, 1.0, 1.0, 1.0]])
    temperature, state = measured(signals)
    assert np.isnan(temperature).all()
    assert state.tolist() == [status.BELOW, status.ABOVE, status.MISSING, status.NO_SIGNAL]


def test_gas_removed_gives_the_temperature_of_the_surface():
    gas = np.array([[0.05], [0.01]])
    temperature, state = corrected(pair([1200.0, 1500.0]) + gas, gas)
    np.testing.assert_allclose(temperature, [1200, 1500], rtol=1e-12)
    assert (state == status.VALID).all()


def test_gas_above_half_of_a_signal_is_said_and_the_value_kept():
    gas = np.array([[0.6], [0.1]])
    temperature, state = corrected(pair([1200.0]) + gas, gas)
    assert temperature[0] == pytest.approx(1200, rel=1e-12) and state[0] == status.GAS_DOMINATED


def test_signal_within_its_uncertainty_is_no_signal():
    for size, expected in ((0.15, status.VALID), (0.25, status.NO_SIGNAL)):
        temperature, state = corrected(pair([1200.0]), uncertainty=size)
        assert state[0] == expected and np.isnan(temperature[0]) == (expected != status.VALID)


def test_reasons_have_their_order():
    signals = pair([1200.0, 1200.0, 2500.0])
    signals[0, 0] = np.nan
    _, state = corrected(signals)
    assert state.tolist() == [status.MISSING, status.VALID, status.ABOVE]
    temperature, state = corrected(signals, injected=False)
    assert (state == status.NOT_INJECTED).all() and np.isnan(temperature).all()


def test_a_saturated_sample_has_no_temperature_and_says_so():
    for read in (measured, corrected):
        temperature, state = read(pair([1200.0]), saturated=True)
        assert np.isnan(temperature[0]) and state[0] == status.SATURATED


def test_a_selective_surface_is_read_with_its_slope():
    selective = pair([1200.0, 1500.0]) * np.array([[1.04], [1.0]])
    for read in (measured, corrected):
        np.testing.assert_allclose(read(selective, slope=1.04)[0], [1200, 1500], rtol=1e-12)
        assert (read(selective)[0] > np.array([1240, 1540])).all()  # d ln T / d ln ratio is about 1


def spread_of(
    signals, gas, gas_uncertainty=0.0, variation=0.0, u=0.01, covariance=COVARIANCE, draws=10000, slope=(1, 0)
):
    of_gas = np.broadcast_to(gas, signals.shape), np.full(signals.shape, gas_uncertainty)
    read = reading(slope[0], u, variation, covariance, slope[1])
    return temperature_uncertainty(read, signals, *of_gas, draws, np.random.default_rng(3))


def linear(temperature, gas, gas_uncertainty=0.0, variation=0.0, u=0.01, covariance=COVARIANCE):
    """First-order propagation, written out from the ratio (S1 - G1)/(S2 - G2)."""
    clean = pair(temperature)[:, 0]
    total, x = clean + gas, scaled(temperature, FIT)
    ratio = clean[0] / clean[1]
    own = sum((u * total[band] / clean[band]) ** 2 for band in (0, 1))
    mean = sum((gas_uncertainty / clean[band]) ** 2 for band in (0, 1))
    common = (variation * (gas[0] / clean[0] - gas[1] / clean[1])) ** 2
    basis = np.array([1, x, x**2])
    slope = (COEFFICIENT[1] + 2 * COEFFICIENT[2] * x) * 2 / (FIT[1] - FIT[0])
    return np.sqrt(ratio**2 * (own + mean + common) + basis @ covariance @ basis) / slope


@pytest.mark.parametrize(
    "part",
    [
        {"u": 0.01},
        {"u": 0.0, "gas_uncertainty": 0.004},
        {"u": 0.0, "variation": 0.05},
        {"u": 0.0, "covariance": 4 * COVARIANCE},
        {"u": 0.005, "gas_uncertainty": 0.002, "variation": 0.03},
    ],
    ids=["signals", "mean", "gas", "calibration", "all"],
)
def test_monte_carlo_agrees_with_linear_propagation_and_the_budget_with_both(part):
    gas = np.array([0.2, 0.05])
    settings = {"covariance": 0 * COVARIANCE} | part
    found = spread_of(pair([1400.0]) + gas[:, None], gas[:, None], **settings)
    expected = linear(1400.0, gas, **settings)
    assert found[0] == pytest.approx(expected, rel=MONTE_CARLO_RTOL)
    assert combined(of_parts(gas, **settings))[0] == pytest.approx(expected, rel=SLOPE_RTOL)


def of_parts(gas, gas_uncertainty=0.0, variation=0.0, u=0.01, covariance=COVARIANCE, monte_carlo=None):
    signals, means = pair([1400.0]) + gas[:, None], np.full((2, 1), gas_uncertainty)
    read = reading(1.0, u, variation, covariance)
    return budget_of(read, signals, np.broadcast_to(gas[:, None], signals.shape), means, monte_carlo)


def test_each_input_has_its_own_row_and_a_curved_one_grows_to_monte_carlo():
    gas = np.array([0.2, 0.05])
    rows = {one.name: one for one in of_parts(gas, 0.002, 0.03)}
    assert (
        rows["signal of the wide band"].contribution[0]
        > 0
        > rows["signal of the narrow band"].contribution[0]
    )
    alone = linear(1400.0, gas, variation=0.03, u=0.0, covariance=0 * COVARIANCE)
    found = abs(rows["brightness of the gas since the reference"].contribution[0])
    assert found == pytest.approx(alone, rel=SLOPE_RTOL)
    whole = combined(of_parts(gas, 0.002, 0.03))
    for factor, expected in ((1.05, 1.0), (2.0, 2.0)):  # as validated, or not
        grown = of_parts(gas, 0.002, 0.03, monte_carlo=factor * whole)
        np.testing.assert_allclose(combined(grown), expected * whole, rtol=1e-12)


def test_an_uncertain_slope_counts_as_an_uncertain_ratio():
    calm = {"u": 0.0, "covariance": 0 * COVARIANCE}
    found = spread_of(pair([1400.0]) * np.array([[1.05], [1.0]]), 0.0, slope=(1.05, 0.021), **calm)
    expected = linear(1400.0, np.zeros(2), **{**calm, "u": 0.02 / np.sqrt(2)})  # 2 % of the ratio
    assert found[0] == pytest.approx(expected, rel=MONTE_CARLO_RTOL)


def test_gas_of_the_colour_of_the_surface_cancels_when_it_varies():
    surface = pair([1400.0])
    found = spread_of(2 * surface, surface, variation=0.05, u=0.0, covariance=0 * COVARIANCE)
    assert found[0] < 1e-6


def test_a_long_record_takes_the_draws_of_samples_like_its_own(monkeypatch):
    """Samples from mere gas to a bright surface, half of them after the gas has gone."""
    random, kelvin = np.random.default_rng(1), np.linspace(700.0, 1700.0, 3000)
    gas = np.array([[0.2], [0.05]]) * (np.arange(3000) % 2)
    signals = (pair(kelvin) + gas) * (1 + 0.003 * random.standard_normal((2, 3000)))
    whole = spread_of(signals, gas, variation=0.01, draws=1000)
    monkeypatch.setattr(correction, "MOST_DRAWN", 1000)
    some = spread_of(signals, gas, variation=0.01, draws=1000)
    assert (np.isnan(some) != np.isnan(whole)).mean() < 0.01  # about where too many draws have no temperature
    both = np.isfinite(some) & np.isfinite(whole)
    # A thousand draws tell an uncertainty to 2.5 %, twice; where gas is left it doubles between samples.
    assert np.std(np.log(some[both] / whole[both])) < 0.1 and both.mean() > 0.9
    assert np.abs(np.median(np.log(some[both] / whole[both]))) < 0.01


def test_hopeless_sample_has_no_uncertainty_instead_of_a_small_one():
    gas = np.array([[40.0], [40.0]])
    assert np.isnan(spread_of(pair([1100.0]) + gas, gas)[0])


def test_missing_sample_has_none_and_leaves_its_neighbours_alone():
    signals = pair([1300.0, 1300.0, 1300.0])
    signals[1, 1] = np.nan
    found = spread_of(signals, 0.0)
    assert np.isnan(found).tolist() == [False, True, False]


def test_a_draw_without_a_ratio_keeps_its_side():
    wide, narrow = np.array([-1.0, 1.0, -1.0, np.nan]), np.array([1.0, -1.0, -1.0, 1.0])
    found = _ranked_temperature(wide, narrow, COEFFICIENT[None], FIT)
    np.testing.assert_array_equal(found, [-np.inf, np.inf, np.inf, np.nan])
