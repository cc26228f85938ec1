"""The table of Planck curves gives what the fits without it give, from any spectrometer."""

import numpy as np
import pytest

from plasmapyro.experiment import curves, spectra
from plasmapyro.radiation.planck import blackbody_radiance

RANGE = (600.0, 3500.0)
# relative: 2e-11 of the largest, and a curve varies by e^(2 REACH) = 55, twice over in the corners
SERIES = 5e-9
SETTLED = 1e-6  # relative; both iterations end at 1e-7


@pytest.mark.parametrize("ends", [(750e-9, 1030e-9), (200e-9, 1100e-9), (900e-9, 1700e-9)])
@pytest.mark.parametrize("temperature", [700.0, 1500.0, 3400.0])
def test_curves_of_the_table_are_black_bodies(ends, temperature):
    wavelength = np.linspace(*ends, 200)
    table = curves.local_curves(wavelength, temperature)
    for place in (-0.97, -0.3, 0.0, 0.6, 0.97):
        found = np.polynomial.chebyshev.chebval(place, table.coefficient)
        there = table.temperature(place)
        body = blackbody_radiance(wavelength, there) / blackbody_radiance(table.anchor, there)
        np.testing.assert_allclose(found, body, rtol=SERIES)
        assert table.place(there) == pytest.approx(place, abs=1e-12)


@pytest.mark.parametrize("ends", [(750e-9, 1030e-9), (200e-9, 1100e-9)])
@pytest.mark.parametrize("temperature", [900.0, 1600.0, 3000.0])
def test_fits_in_the_table_are_those_without_it(ends, temperature):
    generator, wavelength = np.random.default_rng(5), np.linspace(*ends, 400)
    body = 0.8 * blackbody_radiance(wavelength, temperature)
    noise = 0.02 * body + 1e-3 * body.max()
    drawn = body + noise * generator.standard_normal((30, 400))
    usable = generator.random(400) > 0.1
    pivot = wavelength >= ends[1] - 20e-9
    table = curves.local_curves(wavelength, temperature * 1.02)
    every = np.broadcast_to(usable, drawn.shape)
    found = curves.fit_normalised_near(table, drawn, usable, pivot, temperature * 1.02)
    expected = spectra.fit_normalised(wavelength, drawn, every, pivot, RANGE, np.array([1300.0]))
    assert np.isfinite(found).sum() > 20
    inside = np.isfinite(found)
    np.testing.assert_allclose(found[inside], expected[inside], rtol=SETTLED)
    found, scale = curves.fit_scaled_near(table, drawn, noise, usable, temperature * 1.02)
    expected, factor = spectra.fit_scaled(
        wavelength, drawn, np.tile(noise, (30, 1)), every, RANGE, np.array([1300.0])
    )
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found, expected, rtol=SETTLED)
    np.testing.assert_allclose(scale, factor, rtol=40 * SETTLED)  # L goes as T^(c_2 / lambda T)


def test_what_leaves_the_table_is_none():
    wavelength = np.linspace(200e-9, 1100e-9, 300)
    table = curves.local_curves(wavelength, 1500.0)
    far = blackbody_radiance(wavelength, 2500.0)[None]
    usable, pivot = np.ones(300, dtype=bool), wavelength > 1090e-9
    assert np.isnan(curves.fit_normalised_near(table, far, usable, pivot, 1500.0)).all()
    assert np.isnan(np.array(curves.fit_scaled_near(table, far, far[0], usable, 1500.0))).all()
    assert np.isnan(curves.fit_normalised_near(table, -far, usable, pivot, 1500.0)).all()


@pytest.mark.parametrize("temperature", [650.0, 1000.0, 1700.0, 3200.0])
def test_the_nearest_trial_is_a_neighbour(temperature):
    wavelength = np.linspace(750e-9, 1030e-9, 100)
    trials = spectra.trial_curves(wavelength, RANGE)
    body = 0.3 * blackbody_radiance(wavelength, temperature)
    (found,) = spectra.nearest_trial(trials, body, 0.01 * body.max() + 0 * body, np.ones(100, dtype=bool))
    spacing = np.diff(1 / trials[0]).max()
    assert abs(1 / found - 1 / temperature) <= spacing
