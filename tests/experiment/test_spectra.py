"""Planck fits of spectra: round trips, invariances, uncertainties, refusals."""

import numpy as np
import pytest

from plasmapyro.experiment import spectra
from plasmapyro.radiation.planck import blackbody_radiance

WAVELENGTH = np.linspace(750e-9, 1030e-9, 281)
ALL = np.ones((1, 281), dtype=bool)
START = np.array([1300.0])  # [K]
PIVOT = WAVELENGTH >= 1029.5e-9
RANGE = (600.0, 3500.0)
SETTLED = 1e-6  # relative; the iteration ends at 1e-7


def body(temperature, scale=0.85):
    return scale * blackbody_radiance(WAVELENGTH, np.atleast_1d(np.asarray(temperature, float))[:, None])


def rows(mask, count):
    return np.broadcast_to(mask, (count, mask.shape[1]))


@pytest.mark.parametrize("fit", ["normalised", "scaled"])
def test_known_temperatures_come_back_from_anywhere(fit):
    truth = np.array([650.0, 900.0, 1600.0, 3300.0])
    radiance = body(truth)
    if fit == "normalised":
        found = spectra.fit_normalised(WAVELENGTH, radiance, rows(ALL, 4), PIVOT, RANGE, START)
    else:
        found, scale = spectra.fit_scaled(WAVELENGTH, radiance, 0.01 * radiance, rows(ALL, 4), RANGE, START)
        np.testing.assert_allclose(scale, 0.85, rtol=1e-4)
    np.testing.assert_allclose(found, truth, rtol=SETTLED)


def test_grey_factor_changes_the_scale_and_nothing_else():
    full, half = body(1500.0, 1.0), body(1500.0, 0.5)
    noise = 0.01 * full
    both = [spectra.fit_scaled(WAVELENGTH, row, noise, ALL, RANGE, START) for row in (full, half)]
    np.testing.assert_allclose(both[0][0], both[1][0], rtol=SETTLED)
    np.testing.assert_allclose(both[0][1], 2 * both[1][1], rtol=1e-5)
    pair = [spectra.fit_normalised(WAVELENGTH, row, ALL, PIVOT, RANGE, START)[0] for row in (full, half)]
    assert pair[0] == pytest.approx(pair[1], rel=SETTLED)


def test_masked_pixels_do_not_enter():
    spoilt, mask = body(1400.0), ALL.copy()
    spoilt[0, 50:60], mask[0, 50:60] = np.nan, False
    spoilt[0, 100], mask[0, 100] = 1e20, False
    assert spectra.fit_normalised(WAVELENGTH, spoilt, mask, PIVOT, RANGE, START)[0] == pytest.approx(
        1400, rel=SETTLED
    )
    found, _ = spectra.fit_scaled(WAVELENGTH, spoilt, 0.01 * body(1400.0), mask, RANGE, START)
    assert found[0] == pytest.approx(1400, rel=SETTLED)


def test_an_error_of_the_pivot_moves_the_normalised_fit_and_hardly_the_scaled_one():
    wrong = body(1600.0)
    wrong[0, PIVOT] *= 1.01
    pivoted = spectra.fit_normalised(WAVELENGTH, wrong, ALL, PIVOT, RANGE, START)[0] - 1600
    scaled = spectra.fit_scaled(WAVELENGTH, wrong, 0.01 * body(1600.0), ALL, RANGE, START)[0][0] - 1600
    assert -20 < pivoted < -5 and abs(scaled) < 1


def test_minimum_is_a_minimum():
    generator = np.random.default_rng(11)
    noisy = body(1300.0) * (1 + 0.05 * generator.standard_normal((1, 281)))
    found = spectra.fit_normalised(WAVELENGTH, noisy, ALL, PIVOT, RANGE, START)[0]

    def misfit(temperature):
        curve = spectra.normalised(body(temperature), ALL, PIVOT)
        return np.sum((spectra.normalised(noisy, ALL, PIVOT) - curve) ** 2)

    assert misfit(found) < min(misfit(found * (1 + sign * 1e-4)) for sign in (1, -1))


def test_scatter_of_repeated_fits_is_the_least_possible():
    """Gauss-Markov: the covariance of the best fit is (J^T S^-1 J)^-1, J by differences over 2 K."""
    generator, truth = np.random.default_rng(12), body(1300.0)
    noise = np.linspace(0.01, 0.1, 281) * truth
    noisy = truth + noise * generator.standard_normal((1500, 281))
    temperature, scale = spectra.fit_scaled(
        WAVELENGTH, noisy, rows(noise, 1500), rows(ALL, 1500), RANGE, START
    )
    jacobian = np.concatenate([(body(1301.0) - body(1299.0)) / 2, body(1300.0, 1.0)]) / noise
    least = np.sqrt(np.diag(np.linalg.inv(jacobian @ jacobian.T)))
    assert temperature.std() == pytest.approx(least[0], rel=0.06)  # 3 sigma of 1500 repeats
    assert scale.std() == pytest.approx(least[1], rel=0.06)
    assert temperature.mean() == pytest.approx(1300, abs=4 * least[0] / np.sqrt(1500))


def test_temperature_outside_the_range_is_none():
    radiance = body([500.0, 4500.0])
    assert np.isnan(spectra.fit_normalised(WAVELENGTH, radiance, rows(ALL, 2), PIVOT, RANGE, START)).all()
    temperature, scale = spectra.fit_scaled(WAVELENGTH, radiance, radiance, rows(ALL, 2), RANGE, START)
    assert np.isnan(temperature).all() and np.isnan(scale).all()


def test_pivot_without_light_gives_none():
    dark = body(1300.0)
    dark[0, PIVOT] = -1.0
    assert np.isnan(spectra.fit_normalised(WAVELENGTH, dark, ALL, PIVOT, RANGE, START)[0])
    hidden = ALL & ~PIVOT
    assert np.isnan(spectra.fit_normalised(WAVELENGTH, body(1300.0), hidden, PIVOT, RANGE, START)[0])
