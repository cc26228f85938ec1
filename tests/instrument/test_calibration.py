"""Calibration of the pyrometer: exact cases, Monte Carlo against linear propagation, refusals."""

import numpy as np
import pytest
import xarray as xr
from two_bands import RESPONSE

from plasmapyro import contracts
from plasmapyro.instrument import calibration
from plasmapyro.instrument.pyrometer import blackbody_signal, invert_ratio
from plasmapyro.instrument.stage import pyrometer_calibration

FLOAT_RTOL = 1e-12
MANY = 20000
MONTE_CARLO_RTOL = 0.03  # three times the 1 % scatter of a spread from MANY draws, and curvature
SOURCE = np.arange(973.0, 1774.0, 50.0)
SENSITIVITY = {"wide": 0.315e-8, "narrow": 1e-8}
SETTINGS = {
    "source_temperature_uncertainty": 3.0,
    "signal_uncertainty": 0.01,
    "instrument_range": (973.0, 2073.0),
    "calibration_temperature": np.arange(400.0, 3001.0, 10.0),
    "draws": 4000,
    "seed": 5,
}


def band(temperature, name):
    return blackbody_signal(temperature, RESPONSE.wavelength.values, RESPONSE[f"responsivity_{name}"].values)


def points(source=SOURCE, true=None, wide_error=0.0):
    true = source if true is None else true
    return xr.Dataset(
        {
            "source_temperature": ("calibration_point", source),
            "signal_wide": ("calibration_point", SENSITIVITY["wide"] * band(true, "wide") * (1 + wide_error)),
            "signal_narrow": ("calibration_point", SENSITIVITY["narrow"] * band(true, "narrow")),
        }
    )


@pytest.fixture(scope="module")
def calibrated():
    return pyrometer_calibration(RESPONSE, points(), **SETTINGS)


def test_result_honours_its_contract(calibrated):
    contracts.check(contracts.label(calibrated, "calibration"), "calibration")


def test_sensitivities_of_perfect_points_come_back(calibrated):
    assert float(calibrated.sensitivity_ratio) == pytest.approx(0.315, rel=FLOAT_RTOL)
    assert calibrated.absolute_sensitivity.values == pytest.approx([0.315e-8, 1e-8], rel=FLOAT_RTOL, abs=0)
    assert np.abs(calibrated.model_residual).max() < FLOAT_RTOL


def test_wide_signal_off_by_two_percent_moves_the_ratio_by_two_percent():
    calibrated = pyrometer_calibration(RESPONSE, points(wide_error=0.02), **SETTINGS)
    assert float(calibrated.sensitivity_ratio) == pytest.approx(0.315 * 1.02, rel=FLOAT_RTOL)
    expected = [0.315e-8 * 1.02, 1e-8]
    assert calibrated.absolute_sensitivity.values == pytest.approx(expected, rel=FLOAT_RTOL, abs=0)


def test_model_curve_inverts_to_the_source_temperature(calibrated):
    temperature, status = invert_ratio(
        calibrated.point_ratio.values,
        calibrated.calibration_temperature.values,
        calibrated.calibration_ratio.values,
    )
    assert (status == 0).all()
    np.testing.assert_allclose(temperature, SOURCE, rtol=2e-5)  # 10 K steps of a smooth curve: 20 mK


def test_quadratic_fit_has_negligible_residuals_as_printed(calibrated):
    assert np.abs(calibrated.fit_residual).max() < 0.002


def test_uncertainty_of_the_temperature_is_about_the_printed_one_and_a_half_percent(calibrated):
    inside = calibrated.calibration_temperature.sel(calibration_temperature=slice(980, 1770))
    relative = calibrated.temperature_uncertainty.sel(calibration_temperature=inside) / inside
    assert 0.012 < relative.min() and relative.max() < 0.018


def test_extrapolated_fit_reads_eighteen_kelvin_low_at_the_top_of_the_range(calibrated):
    true_ratio = 0.315 * band(2073.0, "wide") / band(2073.0, "narrow")
    temperature, status = calibration.invert_quadratic(
        true_ratio,
        calibrated.fit_coefficient.values,
        calibrated.fit_range.values,
        calibrated.instrument_range.values,
    )
    assert float(temperature) == pytest.approx(2073 - 18, abs=2)
    assert status == calibration.EXTRAPOLATED


def test_curves_of_the_fit_stop_at_the_instrument_range(calibrated):
    readable = np.isfinite(calibrated.fitted_ratio)
    inside = (calibrated.calibration_temperature >= 973) & (calibrated.calibration_temperature <= 2073)
    assert (readable == inside).all()


def test_same_seed_same_bytes_other_seed_not():
    first, again, other = (
        pyrometer_calibration(RESPONSE, points(), **{**SETTINGS, "seed": seed}) for seed in (5, 5, 6)
    )
    xr.testing.assert_identical(first, again)
    assert not first.temperature_uncertainty.equals(other.temperature_uncertainty)


def test_covariance_of_the_fit_is_the_scatter_of_repeated_calibrations():
    generator = np.random.default_rng(8)
    bias = 3.0 * generator.standard_normal((MANY, 1))
    true = band(SOURCE, "wide") / band(SOURCE, "narrow")
    step = 0.1
    slope = np.log(
        band(SOURCE + step, "wide")
        / band(SOURCE + step, "narrow")
        * band(SOURCE - step, "narrow")
        / band(SOURCE - step, "wide")
    ) / (2 * step)
    noise = generator.standard_normal((2, MANY, SOURCE.size)) * 0.01
    ratios = true * np.exp(slope * bias) * (1 + noise[0]) / (1 + noise[1])
    covariance = calibration.point_covariance(slope, 3.0, 0.01, 2)
    _, predicted, _ = calibration.fit_quadratic(SOURCE, true, covariance)
    _, predicted_factor = calibration.fit_sensitivity(true, true, covariance)
    repeated = np.array([calibration.fit_quadratic(SOURCE, row, covariance)[0] for row in ratios[:3000]])
    found = np.cov(repeated.T)
    scale = np.sqrt(np.outer(np.diag(predicted), np.diag(predicted)))
    np.testing.assert_allclose(found / scale, predicted / scale, atol=0.08)  # 3 sigma of 3000 refits
    factors = np.exp(np.log(ratios / true).mean(axis=1))
    assert factors.std() == pytest.approx(predicted_factor, rel=MONTE_CARLO_RTOL)


def test_uncertainties_of_the_sensitivities_are_those_of_the_means(calibrated):
    def uncertainty(value, count):
        slope = (np.log(value(SOURCE + 0.1)) - np.log(value(SOURCE - 0.1))) / 0.2
        return np.sqrt(count * 0.01**2 / SOURCE.size + (3.0 * slope.mean()) ** 2)

    ratio = uncertainty(lambda source: band(source, "wide") / band(source, "narrow"), 2)
    assert float(calibrated.sensitivity_ratio_uncertainty) == pytest.approx(0.315 * ratio, rel=1e-6)
    for name in ("wide", "narrow"):
        own = uncertainty(lambda source, name=name: band(source, name), 1)
        found = calibrated.absolute_sensitivity_uncertainty / calibrated.absolute_sensitivity
        assert float(found.sel(band=name)) == pytest.approx(own, rel=1e-6)


def test_tabulated_fit_passes_where_the_residuals_say(calibrated):
    between = np.interp(SOURCE[1:-1], calibrated.calibration_temperature, calibrated.fitted_ratio)
    residual = calibrated.point_ratio.values[1:-1] / between - 1
    np.testing.assert_allclose(residual, calibrated.fit_residual[1:-1], atol=1e-5)  # 10 K steps


def test_monte_carlo_agrees_with_linear_propagation():
    coefficient, fit_range = np.array([0.40, 0.12, -0.003]), (973.0, 1773.0)
    covariance = np.diag([1e-6, 2e-6, 4e-6])
    temperature = np.array([1100.0, 1500.0])
    found = calibration.reading_uncertainty(
        temperature, coefficient, covariance, fit_range, 0.01, MANY, np.random.default_rng(4)
    )
    x = calibration.scaled(temperature, fit_range)
    ratio = coefficient @ np.stack([x**0, x, x**2])
    slope = (coefficient[1] + 2 * coefficient[2] * x) * 2 / (fit_range[1] - fit_range[0])
    linear = np.sqrt(2 * (0.01 * ratio) ** 2 + np.diag(covariance) @ np.stack([x**0, x**2, x**4])) / slope
    np.testing.assert_allclose(found, linear, rtol=MONTE_CARLO_RTOL)


@pytest.mark.parametrize("second", [-0.01, 0.0, 0.02])
def test_quadratic_goes_there_and_back(second):
    coefficient, fit_range = np.array([0.4, 0.12, second]), (1000.0, 1800.0)
    temperature = np.linspace(1000, 2000, 21)
    ratio = calibration.quadratic_ratio(temperature, coefficient, fit_range)
    found, status = calibration.invert_quadratic(
        ratio, coefficient, fit_range, (1000.0 - 1e-6, 2000.0 + 1e-6)
    )
    np.testing.assert_allclose(found, temperature, rtol=FLOAT_RTOL)
    assert set(status[temperature > 1800]) == {calibration.EXTRAPOLATED}
    assert set(status[(temperature > 1001) & (temperature < 1799)]) == {calibration.VALID}


def test_an_exact_quadratic_is_recovered():
    coefficient, fit_range = np.array([0.4, 0.12, -0.01]), (1000.0, 1800.0)
    temperature = np.linspace(*fit_range, 7)
    found, _, span = calibration.fit_quadratic(
        temperature, calibration.quadratic_ratio(temperature, coefficient, fit_range), np.eye(7)
    )
    np.testing.assert_allclose(found, coefficient, rtol=1e-10)  # condition number of a 7-point fit
    assert span.tolist() == list(fit_range)


def test_readings_beyond_the_instrument_have_a_status_and_no_value():
    coefficient, ranges = np.array([0.4, 0.12, -0.003]), ((973.0, 1773.0), (973.0, 2073.0))
    wanted = np.array([900.0, 1000.0, 1900.0, 2200.0])
    ratio = np.append(calibration.quadratic_ratio(wanted, coefficient, ranges[0]), [50.0, np.nan])
    temperature, status = calibration.invert_quadratic(ratio, coefficient, *ranges)
    assert status.tolist() == [-1, 0, 2, 1, 1, 0]
    assert np.isnan(temperature).tolist() == [True, False, False, True, True, True]


def test_points_below_the_fit_but_within_the_instrument_are_extrapolated_too():
    coefficient = np.array([0.4, 0.12, -0.003])
    ratio = calibration.quadratic_ratio(1050.0, coefficient, (1173.0, 1773.0))
    _, status = calibration.invert_quadratic(ratio, coefficient, (1173.0, 1773.0), (973.0, 2073.0))
    assert status == calibration.EXTRAPOLATED


def test_a_draw_off_the_parabola_keeps_its_side():
    concave, convex = np.array([0.4, 0.1, -0.05]), np.array([0.4, 0.1, 0.05])
    span = (1000.0, 2000.0)
    assert calibration.invert_quadratic_freely(0.6, concave, span) == np.inf
    assert calibration.invert_quadratic_freely(0.2, convex, span) == -np.inf


def test_spread_is_the_standard_deviation_and_survives_few_lost_draws():
    draws = np.random.default_rng(2).normal(3.0, 2.0, (MANY, 1))
    assert calibration.spread(draws)[0] == pytest.approx(2.0, rel=MONTE_CARLO_RTOL)
    few, many = draws.copy(), draws.copy()
    few[: MANY // 10], many[: MANY // 4] = np.inf, np.inf
    assert np.isfinite(calibration.spread(few)[0]) and np.isnan(calibration.spread(many)[0])


def test_fit_that_turns_over_inside_the_range_is_refused():
    bent = points(true=np.minimum(SOURCE, 1500.0))
    with pytest.raises(ValueError, match="must rise over the instrument range; it does not at 2073 K"):
        pyrometer_calibration(RESPONSE, bent, **SETTINGS)


def test_three_points_are_refused():
    with pytest.raises(ValueError, match="needs four different temperatures; got 3"):
        pyrometer_calibration(RESPONSE, points(SOURCE[:3]), **SETTINGS)


def test_missing_signal_is_refused():
    holed = points()
    holed["signal_narrow"][3] = np.nan
    with pytest.raises(ValueError, match=r"signal_narrow must be > 0 A; got nan A at index \(3,\)"):
        pyrometer_calibration(RESPONSE, holed, **SETTINGS)


def test_the_ends_of_the_range_are_read():
    """1 + x / 2 with x from -1 to 1 between 1000 and 2000 K: 0.75 and 1.25 are 1250 and 1750 K exactly."""
    temperature, status = calibration.invert_quadratic(
        np.array([0.7499, 0.75, 1.25, 1.2501]), np.array([1.0, 0.5, 0.0]), (1000.0, 2000.0), (1250.0, 1750.0)
    )
    np.testing.assert_array_equal(temperature, [np.nan, 1250.0, 1750.0, np.nan])
    np.testing.assert_array_equal(
        status, [calibration.BELOW, calibration.VALID, calibration.VALID, calibration.ABOVE]
    )
