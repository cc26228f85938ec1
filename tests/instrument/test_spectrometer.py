"""Calibration of the spectrometer: round trips, linearity, masks, noise."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.instrument import spectrometer
from plasmapyro.instrument.stage import spectrometer_calibration
from plasmapyro.radiation.planck import blackbody_radiance

FLOAT_RTOL = 1e-12
WAVELENGTH = np.linspace(750e-9, 1030e-9, 400)
RATE = 1e-6 * np.linspace(2.0, 0.2, 400)  # [count s-1 / (W m-2 sr-1 m-1)] of an invented device
DARK = np.full(400, 2000.0)
SETTINGS = {
    "source_temperature_uncertainty": 3.0,
    "saturation_counts": 65000.0,
    "least_net_counts": 10.0,
    "noise_block": 40,
}


def lamp(integration_time=0.5, counts=None):
    light = RATE * blackbody_radiance(WAVELENGTH, 1773.0) * integration_time
    return xr.Dataset(
        {
            "calibration_counts": ("wavelength", DARK + light if counts is None else counts),
            "calibration_background": ("wavelength", DARK),
        },
        {"wavelength": WAVELENGTH},
        {"source_temperature": 1773.0, "integration_time": integration_time},
    )


def test_factor_is_the_inverse_of_the_sensitivity():
    calibrated = spectrometer_calibration(lamp(), **SETTINGS)
    contracts.check(contracts.label(calibrated, "spectrometer_calibration"), "spectrometer_calibration")
    np.testing.assert_allclose(calibrated.calibration_factor, 1 / RATE, rtol=FLOAT_RTOL)
    assert (calibrated.pixel_status == 0).all()


def test_integration_time_cancels():
    short, long = (spectrometer_calibration(lamp(time), **SETTINGS) for time in (0.1, 0.8))
    np.testing.assert_allclose(short.calibration_factor, long.calibration_factor, rtol=1e-11)


def test_radiance_of_another_source_comes_back():
    radiance = blackbody_radiance(WAVELENGTH, 1400.0)
    calibrated = spectrometer_calibration(lamp(), **SETTINGS)
    counts = DARK + RATE * radiance * 2.0
    found = spectrometer.measured_radiance(counts, DARK, calibrated.calibration_factor.values, 2.0)
    np.testing.assert_allclose(found, radiance, rtol=1e-9)  # small counts on a large background


def test_bad_pixels_are_flagged_and_hold_no_factor():
    counts = lamp().calibration_counts.values.copy()
    counts[10], counts[20], counts[30] = 65535, DARK[20] + 5, np.nan
    calibrated = spectrometer_calibration(lamp(counts=counts), **SETTINGS)
    bad = {10: spectrometer.SATURATED, 20: spectrometer.NO_SIGNAL, 30: spectrometer.MISSING}
    for index, status in bad.items():
        assert calibrated.pixel_status[index] == status
        assert np.isnan(calibrated.calibration_factor[index])
    assert np.isfinite(calibrated.calibration_factor).sum() == 397


def test_noise_is_found_under_a_steep_smooth_signal():
    generator = np.random.default_rng(3)
    level = np.repeat([1.0, 5.0], 2000)
    values = 1e4 * np.exp(-np.linspace(0, 3, 4000)) + level * generator.standard_normal((4, 4000))
    found = spectrometer.local_noise(values, 200)
    assert found[:, 300:1700].mean() == pytest.approx(1.0, rel=0.05)  # 4 x 7 blocks of 200
    assert found[:, 2300:3700].mean() == pytest.approx(5.0, rel=0.05)


def test_a_spike_and_a_gap_do_not_move_the_noise():
    values = np.random.default_rng(3).standard_normal(1000)
    spiked = values.copy()
    spiked[500] += 1e6
    spiked[200:204] = np.nan
    clean, found = spectrometer.local_noise(values, 100), spectrometer.local_noise(spiked, 100)
    np.testing.assert_allclose(found, clean, rtol=0.15)  # a few of 100 ranks


@pytest.mark.parametrize("rest", [1, 3, 24])
def test_a_rest_of_a_block_has_the_noise_of_its_neighbour(rest):
    """The median of three differences is below a tenth of the true one in one spectrum of fifty: fits then
    hung on the last pixels."""
    values = np.random.default_rng(5).standard_normal((400, 202 + rest))
    found = spectrometer.local_noise(values, 50)
    assert found.min() > 0.4  # a median of 50 differences, four standard deviations of 14 %
    gap = np.where((np.arange(202 + rest) > 60) & (np.arange(202 + rest) < 98), np.nan, values)
    assert spectrometer.local_noise(gap, 50).min() > 0.4
    assert np.isnan(spectrometer.local_noise(np.full(40, np.nan), 10)).all()


def test_noise_of_counts_reaches_the_factor():
    generator = np.random.default_rng(4)
    counts = lamp().calibration_counts.values + 20 * generator.standard_normal(400)
    calibrated = spectrometer_calibration(lamp(counts=counts), **SETTINGS)
    expected = 20 / (lamp().calibration_counts.values - DARK)
    ratio = calibrated.calibration_factor_uncertainty.values / expected
    assert np.median(ratio) == pytest.approx(1, abs=0.15)


@pytest.mark.parametrize("name", ["source_temperature", "integration_time"])
def test_missing_attribute_is_named(name):
    bare = lamp()
    del bare.attrs[name]
    with pytest.raises(ValueError, match=f"lacks the attributes {name}"):
        spectrometer_calibration(bare, **SETTINGS)


def test_calibration_without_a_usable_pixel_is_refused():
    with pytest.raises(ValueError, match="no usable pixel.*of 400, 400 are saturated"):
        spectrometer_calibration(lamp(counts=np.full(400, 65535.0)), **SETTINGS)


def test_too_few_pixels_for_a_noise_estimate_are_refused():
    with pytest.raises(ValueError, match="three samples"):
        spectrometer.local_noise([1.0, 2.0], 10)
