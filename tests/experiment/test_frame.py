"""One exposure: errors of the calibration factor, failed fits."""

import numpy as np
import pytest

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.experiment.frame import factor_errors, fit_frame, fitted_curve
from plasmapyro.experiment.spectra import trial_curves
from plasmapyro.instrument.scale import scale_draws
from plasmapyro.radiation.planck import blackbody_radiance

WAVELENGTH = np.linspace(750e-9, 1030e-9, 50)
RANGE = (600.0, 3500.0)
TRIALS = trial_curves(WAVELENGTH, RANGE)
MANY = 20000


def test_source_and_counting_add_in_squares():
    pixel = np.full(50, 0.02)
    draws = factor_errors(WAVELENGTH, 1773.0, 3.0, pixel, MANY, np.random.default_rng(1))
    source = 3.0 * SECOND_RADIATION / (WAVELENGTH * 1773.0**2)  # Wien: d ln L / dT
    every = np.sqrt(source**2 + 0.02**2 + 2 * 0.008**2)
    np.testing.assert_allclose(draws.std(axis=0), every, rtol=0.02)  # 4 sigma of MANY
    # Only the source and the scale move two pixels together.
    apart = WAVELENGTH[40] - WAVELENGTH[10]
    scale = 0.008**2 * sum(np.exp(-0.5 * (apart / length) ** 2) for length in (60e-9, 200e-9))
    together = np.corrcoef(draws[:, 10], draws[:, 40])[0, 1]
    expected = (source[10] * source[40] + scale) / every[10] / every[40]
    assert together == pytest.approx(expected, abs=0.03)


def test_unusable_pixels_add_no_noise_to_the_draws():
    draws = factor_errors(WAVELENGTH, 1773.0, 0.0, np.full(50, np.nan), MANY, np.random.default_rng(1))
    assert draws.std() == pytest.approx(0.008 * np.sqrt(2), rel=0.02)


def test_the_scale_is_smooth_and_costs_as_much_as_a_tilt_of_it():
    """A tilt d of ln L over the range is d T^2 / c2 over the difference of the inverse wavelengths: Wien."""
    draws = scale_draws(WAVELENGTH, MANY, np.random.default_rng(1))
    assert np.abs(np.diff(draws, axis=1)).max() < 0.15 * np.abs(draws).max()
    inverse = 1 / WAVELENGTH
    slope = np.polyfit(inverse - inverse.mean(), draws.T, 1)[0]
    kelvin = slope.std() * 1600.0**2 / SECOND_RADIATION
    found = fit_frame(
        WAVELENGTH,
        blackbody_radiance(WAVELENGTH, 1600.0),
        1e-4 * blackbody_radiance(WAVELENGTH, 1600.0),
        np.zeros(50),
        np.ones(50, dtype=bool),
        np.arange(50) == 49,
        TRIALS,
        RANGE,
        0.03,
        draws[:400],
        np.zeros((400, 1)),
        np.random.default_rng(2),
    )
    assert found.scaled_temperature_uncertainty == pytest.approx(kelvin, rel=0.15)  # 400 draws, weights


def test_uncertainty_is_half_the_central_interval_of_the_draws():
    """Uniform draws: 0.683 of their half width, where a standard deviation would be 0.577 of it."""
    count = 400
    warmer = np.linspace(-10.0, 10.0, count)[:, None]
    brighter = 0.1 * np.random.default_rng(3).permutation(np.linspace(-1, 1, count))[:, None]
    clean = blackbody_radiance(WAVELENGTH, 1500.0)
    factor = (1 + brighter) * blackbody_radiance(WAVELENGTH, 1500.0 + warmer) / clean - 1
    found = fit_frame(
        WAVELENGTH,
        clean,
        1e-9 * clean,
        0 * clean,
        np.ones(50, dtype=bool),
        WAVELENGTH > 1020e-9,
        TRIALS,
        RANGE,
        0.0,
        factor,
        np.zeros((count, 1)),
        np.random.default_rng(1),
    )
    spreads = [found.temperature_uncertainty, found.scaled_temperature_uncertainty, found.scale_uncertainty]
    np.testing.assert_allclose(spreads, [6.827, 6.827, 0.06827], rtol=0.01)  # one draw in 400 is 0.4 %


@pytest.mark.parametrize(("temperature", "noise"), [(500.0, 0.01), (900.0, 3.0)])
def test_failed_fit_or_one_without_an_uncertainty_gives_nothing_at_all(temperature, noise):
    body = blackbody_radiance(WAVELENGTH, temperature)
    found = fit_frame(
        WAVELENGTH,
        body,
        noise * body,
        0 * body,
        np.ones(50, dtype=bool),
        WAVELENGTH > 1020e-9,
        TRIALS,
        RANGE,
        0.0,
        np.zeros((100, 1)),
        np.zeros((100, 1)),
        np.random.default_rng(1),
    )
    assert np.isnan(found).all()


def test_curve_of_no_temperature_is_empty():
    usable = np.ones((2, 50), dtype=bool)
    curve = fitted_curve(WAVELENGTH, np.array([np.nan, 1500.0]), usable, WAVELENGTH > 1029e-9)
    assert np.isnan(curve[0]).all() and curve[1, -1] == pytest.approx(1, rel=1e-12)
    assert np.isnan(fitted_curve(WAVELENGTH, np.full(2, np.nan), usable, WAVELENGTH > 1029e-9)).all()
