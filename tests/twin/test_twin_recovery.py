"""From the twin's raw files to temperatures, judged by the sealed truth that the chain never saw."""

import numpy as np
import pytest
from test_twin import GAS
from twin import campaign
from two_bands import RESPONSE

from plasmapyro.experiment.stage import correct_pyrometer, correct_spectra
from plasmapyro.instrument.stage import pyrometer_calibration, spectrometer_calibration
from plasmapyro.record import status

SEED = 11


@pytest.fixture(scope="module")
def calibration():
    return pyrometer_calibration(
        RESPONSE,
        campaign.calibration_points(RESPONSE, SEED),
        source_temperature_uncertainty=3.0,
        signal_uncertainty=0.01,
        instrument_range=(973.0, 2073.0),
        calibration_temperature=np.arange(400.0, 3001.0, 20.0),
        draws=500,
        seed=1,
    )


@pytest.fixture(scope="module")
def recorded():
    return campaign.record(campaign.Scene(condition="90kW"), RESPONSE, [(1.0, GAS)], SEED)


@pytest.fixture(scope="module")
def pyrometer(recorded, calibration):
    return correct_pyrometer(
        recorded[0],
        calibration,
        signal_uncertainty=0.01,
        gas_variation=0.03,
        detection_level=2.0,
        least_surface_share=0.5,
        draws=300,
        seed=2,
    )


@pytest.fixture(scope="module")
def spectrometer(recorded):
    calibrated = spectrometer_calibration(
        campaign.spectrometer_counts(SEED),
        source_temperature_uncertainty=3.0,
        saturation_counts=65000.0,
        least_net_counts=50.0,
        noise_block=50,
    )
    return correct_spectra(
        recorded[0],
        calibrated,
        reference_time=2.0,
        normalisation_wavelength=1030e-9,
        normalisation_half_width=0.375e-9,
        temperature_range=(600.0, 3500.0),
        saturation_counts=65000.0,
        gas_variation=0.03,
        least_signal_to_noise=10.0,
        noise_block=50,
        draws=25,
        seed=3,
    )


def test_sensitivity_ratio_is_found_within_its_uncertainty(calibration):
    error = float(calibration.sensitivity_ratio) - 0.315
    assert abs(error) < 3 * float(calibration.sensitivity_ratio_uncertainty)
    assert np.abs(calibration.model_residual).max() < 0.015  # printed: within 1.5 %


def test_corrected_temperature_is_closer_to_the_truth_than_the_measured_one(recorded, pyrometer):
    truth = recorded[1].surface_temperature
    both = np.isfinite(pyrometer.measured_temperature) & np.isfinite(pyrometer.corrected_temperature)
    heating = both & (pyrometer.time > 0) & (pyrometer.time < 40)
    assert int(heating.sum()) > 150
    before = np.abs(pyrometer.measured_temperature - truth)[heating]
    after = np.abs(pyrometer.corrected_temperature - truth)[heating]
    assert float(after.mean()) < 0.2 * float(before.mean())


def test_measured_temperature_falls_from_the_top_of_the_range_then_rises(pyrometer):
    heating = (pyrometer.time > 0) & (pyrometer.time < 60)
    reading = pyrometer.measured_temperature[heating].values
    states = pyrometer.measured_status[heating].values
    assert states[0] == status.ABOVE
    shown = reading[np.isfinite(reading)]
    lowest = int(np.argmin(shown))
    assert shown[:3].mean() > 1600 > 1300 > shown[lowest]
    assert shown[-1] > shown[lowest] + 200


def test_corrected_temperature_errs_as_its_uncertainty_says(recorded, pyrometer):
    valid = (pyrometer.corrected_status == status.VALID) & (pyrometer.time < 299)
    pull = (pyrometer.corrected_temperature - recorded[1].surface_temperature) / (
        pyrometer.corrected_temperature_uncertainty
    )
    # The twin's readings scatter by 0.3 %, less than the stated 1 %: the pulls must be below one.
    assert float(np.abs(pull[valid]).mean()) < 1
    assert float((np.abs(pull[valid]) > 3).mean()) < 0.01


def test_spectra_find_the_temperature_and_the_emittance(recorded, spectrometer):
    truth = recorded[1].exposure_temperature
    usable = spectrometer.spectrum_status == status.VALID
    assert not usable[(spectrometer.spectrum_time < 14)].any()
    assert usable[(spectrometer.spectrum_time > 24) & (spectrometer.spectrum_time < 298)].all()
    for name, limit in (("spectrometer_temperature", 4.0), ("scaled_temperature", 4.0)):
        pull = (spectrometer[name] - truth) / spectrometer[f"{name}_uncertainty"]
        assert float(np.abs(pull[usable]).median()) < limit / 2, name
    hot = usable & (truth > 1400)
    error = np.abs(spectrometer.scaled_temperature - truth)[hot]
    assert float(error.max()) < 10  # a source bias of 3 K and the mean over the exposure
    np.testing.assert_allclose(spectrometer.apparent_emittance[hot], 0.85, atol=0.02)


def test_both_instruments_agree_when_the_sample_is_hot(pyrometer, spectrometer):
    steady = spectrometer.sel(spectrum_time=slice(100, 290))
    other = pyrometer.corrected_temperature.sel(time=slice(100, 290))
    assert float(steady.spectrometer_temperature.mean()) == pytest.approx(float(other.mean()), rel=0.015)
