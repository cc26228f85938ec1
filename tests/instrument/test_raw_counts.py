"""Raw counts become linear rates: round trips through an invented sensor, then limits and refusals."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.instrument import raw_counts, spectrometer
from plasmapyro.instrument.line_lamp import find_lines, lamp_lines
from plasmapyro.instrument.shape import compare, planck_shape
from plasmapyro.instrument.stage import calibrate_exposures
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.slit import FWHM_PER_SIGMA

PIXELS = 1200
WAVELENGTH = np.linspace(200e-9, 1100e-9, PIXELS)
GAIN = 3e-7 * np.exp(-(((WAVELENGTH - 700e-9) / 250e-9) ** 2))  # [count s-1 / (W m-2 sr-1 m-1)]
MASKED = [2, 3, -2, -1]
CURVE = (1.002, -4e-7, -6e-12)  # relative response: 3 % low at 50 000 counts
OFFSET = 2180.0
FLOAT_RTOL = 1e-9
DARK_RTOL = 5e-4  # the light's own curvature moves the dark scale by 1e-5; weak pixels have 5 % light


def current(generator):
    """Dark current of each pixel [count s-1]: 5 % pattern, three hot pixels, none where masked."""
    dark = 1000 * (1 + 0.05 * generator.standard_normal(PIXELS))
    dark[[400, 700, 900]] *= 3
    dark[[0, 1, 2, 3, -4, -3, -2, -1]] = 0
    return dark


def sensor(radiance, time, dark, generator=None, noise=0.0):
    """Counts of the invented sensor; the response curve is applied to the true signal by iteration."""
    lit = np.where(dark > 0, GAIN * radiance, 0.0)
    true = np.minimum((lit + dark) * time, 80000.0)
    signal = true.copy()
    for _ in range(50):
        signal = true * np.polynomial.polynomial.polyval(signal, CURVE)
    spread = noise * generator.standard_normal(PIXELS) if noise else 0.0
    return np.minimum(OFFSET + signal + spread, 64000.0)


def exposures(times=(0.2, 1.0), drift=(1.0, 1.0), noise=0.0, temperature=2800.0):
    generator = np.random.default_rng(5)
    dark = current(generator)
    light = blackbody_radiance(WAVELENGTH, temperature)
    lit = [
        sensor(light, time, dark * scale, generator, noise) for time, scale in zip(times, drift, strict=True)
    ]
    black = [sensor(0 * light, time, dark, generator, noise) for time in times]
    return xr.Dataset(
        {
            "exposure_counts": (("exposure", "wavelength"), np.stack(lit)),
            "exposure_dark": (("exposure", "wavelength"), np.stack(black)),
            "exposure_time": ("exposure", np.array(times)),
            "source_radiance": ("wavelength", light),
            "source_radiance_uncertainty": ("wavelength", np.full(PIXELS, 0.01)),
        },
        {"wavelength": WAVELENGTH},
    )


SETTINGS = {
    "linearity_coefficients": CURVE,
    "linearity_uncertainty": 0.002,
    "masked_pixels": MASKED,
    "dim_range": (200e-9, 300e-9),
    "saturation_counts": 63000.0,
    "hot_threshold": 12.0,
    "least_net_counts": 50.0,
    "transmittance": 1.0,
    "noise_block": 60,
}


def calibrated(data, **changes):
    """Calibration with the settings, or others; what is None is not stated."""
    settings = SETTINGS | changes
    run = {name: settings.pop(name) for name in ("saturation_counts", "least_net_counts", "noise_block")}
    stated = {name: value for name, value in settings.items() if value is not None}
    return calibrate_exposures(data.assign_attrs(stated), **run)


def test_linearity_dark_and_exposures_are_undone():
    found = calibrated(exposures(noise=1e-6))
    contracts.check(contracts.label(found, "spectrometer_calibration"), "spectrometer_calibration")
    lit = found.pixel_status.values == spectrometer.USABLE
    assert lit.sum() > 800
    np.testing.assert_allclose(found.calibration_factor.values[lit], 1 / GAIN[lit], rtol=DARK_RTOL)
    assert np.isnan(found.calibration_factor.values[~lit]).all()
    assert found.source_temperature == pytest.approx(2800, abs=1)
    hotter = 2800 + float(found.source_temperature_uncertainty)
    middle = WAVELENGTH[lit][lit.sum() // 2]
    change = blackbody_radiance(middle, hotter) / blackbody_radiance(middle, 2800.0)
    assert change == pytest.approx(1.01, abs=2e-4)  # the 1 % of the certificate


def test_a_dark_current_that_drifts_is_measured_from_its_pattern():
    data = exposures(drift=(0.92, 1.05), noise=2.0)
    found = calibrated(data)
    np.testing.assert_allclose(found.dark_scale, [0.92, 1.05], atol=0.03)
    plain = calibrated(data, **{"dim_range": None})
    band = (WAVELENGTH > 350e-9) & (WAVELENGTH < 420e-9) & (found.pixel_status.values == 0)
    wrong = [np.median(np.abs(c.calibration_factor.values * GAIN - 1)[band]) for c in (found, plain)]
    assert wrong[0] < 0.5 * wrong[1]


def test_saturated_pixels_come_from_the_short_exposure():
    data = exposures(times=(0.2, 4.0), noise=1e-6)
    clipped = data.exposure_counts.values[1] >= 63000
    assert clipped.sum() > 100
    found = calibrated(data)
    good = clipped & (found.pixel_status.values == 0)
    assert good.sum() > 100
    np.testing.assert_allclose(found.calibration_factor.values[good], 1 / GAIN[good], rtol=DARK_RTOL)
    alone = calibrated(data.isel(exposure=[1]))
    assert (alone.pixel_status.values[clipped] == spectrometer.SATURATED).all()


def test_hot_and_masked_pixels_are_flagged():
    found = calibrated(exposures(noise=1e-6))
    assert (found.pixel_status.values[[400, 700, 900]] == spectrometer.HOT).all()
    assert (found.pixel_status.values[MASKED] == spectrometer.MASKED).all()
    assert (found.pixel_status.values == spectrometer.HOT).sum() == 3


def test_a_filter_before_the_source_divides_out():
    data = exposures(noise=1e-6)
    filtered = data.copy(deep=True)
    filtered["source_radiance"] = data.source_radiance * 10
    found = calibrated(filtered, **{"transmittance": 0.1})
    direct = calibrated(data)
    np.testing.assert_allclose(found.calibration_factor, direct.calibration_factor, rtol=FLOAT_RTOL)


def test_uncertainty_has_a_part_per_pixel_and_a_common_one():
    found = calibrated(exposures(noise=5.0))
    lit = (found.pixel_status.values == 0) & (WAVELENGTH > 500e-9) & (WAVELENGTH < 900e-9)
    error = (found.calibration_factor.values * GAIN - 1)[lit] / found.calibration_factor_uncertainty.values[
        lit
    ]
    assert np.std(error) == pytest.approx(1, abs=0.15)
    np.testing.assert_allclose(found.calibration_factor_common.values[lit], np.hypot(0.01, 0.002), rtol=0.02)


def test_scale_of_the_dark_is_unbiased_and_its_uncertainty_right():
    generator = np.random.default_rng(1)
    pattern = 1000 + 50 * generator.standard_normal(300)
    found = []
    for _ in range(300):
        light = 0.9 * pattern + 300 + 20 * generator.standard_normal(300)
        found.append(
            raw_counts.dark_scale(light, pattern + 20 * generator.standard_normal(300), np.full(300, True))
        )
    scale, uncertainty = np.array(found).T
    assert scale.mean() == pytest.approx(0.9, abs=0.01)  # ordinary regression gives 0.9 / 1.16
    assert np.std(scale) == pytest.approx(np.median(uncertainty), rel=0.3)


def test_no_pattern_is_refused():
    with pytest.raises(ValueError, match="30 dim pixels"):
        raw_counts.dark_scale(np.arange(20.0), np.arange(20.0), np.full(20, True))
    wave = np.tile([1.0, -1.0], 50)
    with pytest.raises(ValueError, match="no pattern"):
        raw_counts.dark_scale(-wave, wave, np.full(100, True))


def test_a_polynomial_out_of_its_range_is_refused():
    with pytest.raises(ValueError, match="linearity polynomial gives"):
        raw_counts.linear_signal([1e6], CURVE)
    with pytest.raises(ValueError, match="masked pixels"):
        raw_counts.baseline(np.ones(4), [])


def test_no_usable_pixel_is_refused_with_the_reasons():
    data = exposures()
    data["exposure_counts"] = data.exposure_counts * 0 + 64000.0
    with pytest.raises(ValueError, match="no usable pixel.*saturated"):
        calibrated(data, **{"dim_range": None})


def test_certificate_is_interpolated_as_a_planckian():
    points = np.array([250, 300, 350, 400, 500, 600, 700, 800, 900, 1100]) * 1e-9
    grid = np.linspace(260e-9, 1090e-9, 77)
    found = raw_counts.certified_source(grid, points, blackbody_radiance(points, 3000.0))
    np.testing.assert_allclose(found, blackbody_radiance(grid, 3000.0), rtol=1.5e-3)  # beyond Wien's limit
    assert np.isnan(raw_counts.certified_source(np.array([200e-9, 1200e-9]), points, np.ones(10))).all()


@pytest.mark.parametrize("temperature", [1200.0, 3200.0])
def test_shape_temperature_of_a_black_body_is_its_temperature(temperature):
    light = 7.0 * blackbody_radiance(WAVELENGTH, temperature)
    shape = planck_shape(WAVELENGTH, light, (750e-9, 900e-9))
    assert shape.temperature == pytest.approx(temperature, abs=0.05)
    assert shape.scale == pytest.approx(7.0, rel=1e-3)
    other = compare(WAVELENGTH, light, blackbody_radiance(WAVELENGTH, temperature + 50), (750e-9, 900e-9))
    assert other.temperature_difference == pytest.approx(-50, abs=0.1)
    assert other.residual < 1e-5


def test_a_spectrum_without_such_a_shape_is_refused():
    with pytest.raises(ValueError, match="no shape of a black body"):
        planck_shape(WAVELENGTH, WAVELENGTH**-20, (750e-9, 900e-9))
    with pytest.raises(ValueError, match="needs 10 samples"):
        planck_shape(WAVELENGTH, np.full(PIXELS, np.nan), (750e-9, 900e-9))


def lamp(shift, fwhm, generator):
    grid = np.linspace(200e-9, 1100e-9, 2000)
    sigma = fwhm / FWHM_PER_SIGMA
    light = sum(4000 * np.exp(-(((grid - line - shift) / sigma) ** 2) / 2) for line in lamp_lines()[1])
    return grid, light + 5 * generator.standard_normal(grid.size)


def test_lamp_lines_are_found_where_they_were_put():
    grid, light = lamp(0.25e-9, 1.2e-9, np.random.default_rng(2))
    found = find_lines(grid, light, expected_fwhm=1.3e-9, search=1.0e-9, least_signal_to_noise=50)
    shift = np.array([line.wavelength - line.certified for line in found])
    assert len(found) >= 12
    np.testing.assert_allclose(shift, 0.25e-9, atol=0.02e-9)
    width = np.array([line.fwhm for line in found])
    np.testing.assert_allclose(width, 1.2e-9, rtol=0.05)


def test_saturated_lines_are_left_out_and_a_dark_spectrum_is_refused():
    grid, light = lamp(0.0, 1.2e-9, np.random.default_rng(2))
    light[np.abs(grid - 763.72e-9) < 1e-9] = np.nan
    found = find_lines(grid, light, expected_fwhm=1.3e-9, search=1.0e-9, least_signal_to_noise=50)
    assert not [line for line in found if abs(line.certified - 763.72e-9) < 0.1e-9]
    noise = np.random.default_rng(3).standard_normal(grid.size)
    with pytest.raises(ValueError, match="Hg.Ar. lamp"):
        find_lines(grid, noise, expected_fwhm=1.3e-9, search=1.0e-9, least_signal_to_noise=50)


def test_the_lamp_table_holds_the_well_known_lines():
    species, line = lamp_lines()
    for name, vacuum in (("Hg I", 253.7283), ("Hg I", 435.9560), ("Hg I", 546.2268), ("Ar I", 763.7208)):
        near = np.argmin(np.abs(line - vacuum * 1e-9))
        assert species[near] == name
        assert line[near] == pytest.approx(vacuum * 1e-9, abs=1.5e-13)
