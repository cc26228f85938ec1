"""Readings and errors of a pyrometer, against Wien's law and shot noise."""

import numpy as np
import pytest

from plasmapyro.constants import ELEMENTARY_CHARGE, LIGHT_SPEED, PLANCK, SECOND_RADIATION
from plasmapyro.design import budget
from plasmapyro.design.bands import transmittance
from plasmapyro.radiation.planck import blackbody_radiance

EDGES = np.linspace(600e-9, 1300e-9, 1401)
RECEIVER = budget.Receiver(1e-8, 1e-6, 50.0, 0.0)
SIZES = budget.Uncertainties(0.01, 0.0, 1273.0, 0.05, 1e5, 0.0, 0.2)
CENTRES, WIDTH = (850e-9, 1000e-9), 2e-9
WIEN_RTOL = 3e-3  # bands 2 nm wide, exp(-C2 / lambda T) at 1200 K: 6e-6, grid of 240 temperatures
READ_RTOL = 2e-5  # linear interpolation in 1/T


def signal(centres=CENTRES, gas=0.0, resistance_area=1e30, air=None):
    responses = transmittance(EDGES, np.array([centres]), np.full((1, len(centres)), WIDTH), "box")
    spectrum = np.full((1, EDGES.size - 1), gas)
    loss = np.zeros(EDGES.size - 1) if air is None else air
    return budget.currents(responses, EDGES, spectrum, RECEIVER, [resistance_area], loss, 1500.0)


def contrast(some, sizes=SIZES, gas=0.0):
    return budget.contrast(some, sizes, gas, 1500.0)


def parts(some, temperature=(1200.0,), emittance=(0.5,), sizes=SIZES):
    given = temperature, emittance, RECEIVER, sizes
    return budget.errors(some, contrast(some, sizes), some.gas, *given)[:, 0, 0, 0, :]


def test_without_gas_the_reading_is_the_truth():
    some = signal()
    black = budget.at_temperature(some.black, [900.0, 1500.0, 2400.0])
    got = budget.read(some, contrast(some), 0.3 * black, 0.3)[0]
    np.testing.assert_allclose(got, [900.0, 1500.0, 2400.0], rtol=READ_RTOL)


def test_half_the_emittance_is_twice_the_gas():
    both = [parts(signal(gas=g), emittance=(e,))[0] for g, e in ((1e6, 0.3), (2e6, 0.6))]
    np.testing.assert_allclose(*both, rtol=1e-12)
    assert both[0] > 1e-4


def test_the_sensitivity_is_that_of_wien():
    some = signal()
    got = budget.sensitivity(some.black, contrast(some), 1200.0)[0]
    wien = SECOND_RADIATION / 1200.0 * (1 / CENTRES[0] - 1 / CENTRES[1])
    assert got == pytest.approx(wien, rel=WIEN_RTOL)


def test_a_slope_of_the_emittance_shifts_the_reading_as_wien_says():
    # d ln(rho) = slope (l1 - l2), d ln(rho) / d ln(T) = C2 / T (1/l1 - 1/l2)
    error = parts(signal())[budget.SOURCES.index("emittance"), 0]
    assert error == pytest.approx(1e5 * CENTRES[0] * CENTRES[1] * 1200.0 / SECOND_RADIATION, rel=WIEN_RTOL)


def test_one_band_needs_the_emittance_and_pays_for_it():
    error = parts(signal(CENTRES[1:]))[budget.SOURCES.index("emittance"), 0]
    assert error == pytest.approx(0.05 * CENTRES[1] * 1200.0 / SECOND_RADIATION, rel=WIEN_RTOL)


def test_noise_is_shot_noise_when_nothing_else_makes_noise():
    some = signal(CENTRES[1:])
    current = 0.5 * budget.at_temperature(some.black, [1200.0])[0, 0, 0]
    error = parts(some)[budget.SOURCES.index("noise"), 0]
    shot = np.sqrt(2 * ELEMENTARY_CHARGE * RECEIVER.bandwidth / current)
    assert error == pytest.approx(shot * CENTRES[1] * 1200.0 / SECOND_RADIATION, rel=WIEN_RTOL)


def test_the_photocurrent_of_a_perfect_detector_counts_photons():
    some = signal(CENTRES[1:])
    power = blackbody_radiance(CENTRES[1], 1500.0) * WIDTH * RECEIVER.throughput
    photons = power * CENTRES[1] / (PLANCK * LIGHT_SPEED)
    got = budget.at_temperature(some.black, [1500.0])[0, 0, 0]
    assert got == pytest.approx(ELEMENTARY_CHARGE * photons, rel=1e-3, abs=0)


def test_johnson_noise_adds_to_shot_noise():
    quiet, loud = (parts(signal(resistance_area=value))[1, 0] for value in (1e30, 1e-8))
    assert loud > 2 * quiet


def test_calibration_counts_each_band_once():
    error = parts(signal())[budget.SOURCES.index("calibration"), 0]
    wien = SECOND_RADIATION / 1200.0 * (1 / CENTRES[0] - 1 / CENTRES[1])
    assert error == pytest.approx(np.sqrt(2) * 0.01 / wien, rel=WIEN_RTOL)


def test_air_that_absorbs_alike_in_both_bands_costs_nothing():
    even = parts(signal(air=np.full(EDGES.size - 1, 1e-3)))[budget.SOURCES.index("air"), 0]
    uneven = parts(signal(air=np.where(EDGES[1:] > 0.9e-6, 1e-3, 0.0)))[budget.SOURCES.index("air"), 0]
    wien = SECOND_RADIATION / 1200.0 * (1 / CENTRES[0] - 1 / CENTRES[1])
    assert even < 1e-12 and uneven == pytest.approx(1e-3 / wien, rel=WIEN_RTOL)


def test_three_bands_of_equal_worth_are_weighted_without_the_emittance():
    some = signal((850e-9, 925e-9, 1000e-9))
    weights = contrast(some)
    assert weights.sum() == pytest.approx(0, abs=1e-12)
    got = budget.read(some, weights, 0.2 * budget.at_temperature(some.black, [1500.0]), 0.2)[0]
    np.testing.assert_allclose(got, 1500.0, rtol=READ_RTOL)


def test_a_third_band_where_the_gas_is_weak_lowers_its_weight_where_it_shines():
    some = signal((850e-9, 925e-9, 1000e-9))
    calm = contrast(some)
    shining = contrast(some, SIZES, np.diag([100.0, 0.0, 0.0])[None])
    assert abs(shining[0, 0]) < 0.01 * abs(calm[0, 0])


def test_gas_that_swamps_the_surface_counts_as_no_reading():
    assert parts(signal(gas=1e14), temperature=(1000.0,))[0, 0] == budget.NO_READING
