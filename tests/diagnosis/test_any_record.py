"""Records of all kinds: short and long, sparse and cut off, of one instrument or with no calibration. Each is
diagnosed, or refused at once in one sentence."""

import numpy as np
import pytest
from small_laboratory import OFF, temperature_of

from plasmapyro.diagnosis import command
from plasmapyro.page.stage import write_page
from plasmapyro.record import binning

SPARSE = {"start": -4.0, "end": 56.0, "off": 50.0, "frame": 4.0}  # fifteen spectra
SHORT = {"start": -4.0, "end": 26.0, "off": 20.0, "rise_time": 3.0, "period": 0.1, "frame": 0.5}
HOURS = {"start": -60.0, "end": 7500.0, "off": 7200.0, "rise_time": 600.0, "period": 2.0, "frame": 40.0}


@pytest.fixture(scope="module")
def run(laboratory):
    """Diagnoses a test as the command does, and makes its page."""

    def diagnose(test, **changes):
        given = {
            "calibration": laboratory.calibration,
            "variations": {"80kW": laboratory.variations},
            "response": laboratory.response,
        } | changes
        inputs = command.Inputs(
            radiation=laboratory.radiation,
            spectrometer_calibration=None,
            origin="synthetic",
            digests={},
            **given,
        )
        result = command.diagnose_test(test, inputs, draws=200)
        command.check(result.report)
        assert "<html" in write_page(result.report, result.residual_map, result.temperature)
        return result

    return diagnose


def few_pixels(test):
    return test.isel(wavelength=slice(None, None, 8))


def without_pyrometer(test):
    return test.drop_dims("time")


def test_a_slope_between_bands_that_nobody_knows_is_left_aside_and_said(record, run, caplog):
    test = without_pyrometer(record(**SPARSE)).assign_attrs(emittance_slope=1.02)
    run(test, response=None, calibration=None)
    assert "emittance_slope is left aside" in caplog.text


@pytest.mark.parametrize(
    ("settings", "change"),
    [
        (SPARSE, lambda test: test),
        (SPARSE, without_pyrometer),
        (SHORT, lambda test: test),
        (HOURS, few_pixels),
        ({"end": 100.0}, lambda test: test),  # the record ends before the plasma
        ({"end": 100.0}, lambda test: test.assign_attrs(plasma_off_time=1e4)),
        ({"end": 120.3}, lambda test: test),  # ... and just after it
        ({"start": 0.0}, lambda test: test),  # nothing before the injection
        ({"frame": 10.0}, lambda test: test),
        ({}, lambda test: test.isel(wavelength=slice(None, None, 25))),
        ({}, lambda test: test.assign_attrs(emittance_uncertainty=0.0)),
        ({}, without_pyrometer),
    ],
    ids=(
        "sparse",
        "sparse, no pyrometer",
        "short",
        "hours",
        "ends early",
        "plasma goes on",
        "ends with the plasma",
        "starts at the injection",
        "long exposures",
        "few pixels",
        "emittance known",
        "no pyrometer",
    ),
)
@pytest.mark.filterwarnings("ignore:constrained_layout")
def test_a_sound_record_of_any_length_and_density_shows_nothing_wrong(run, record, settings, change):
    result = run(change(record(**settings)))
    assert result.report["verdict"]["status"] == "null"
    assert result.report["base"]["chi2"] / result.report["base"]["dof"] == pytest.approx(1.0, abs=0.3)
    time = result.temperature["time_bin"].values
    off, rise_time = settings.get("off", OFF), settings.get("rise_time", 12.0)
    hot = (time > 3 * rise_time) & (time < off)
    error = result.temperature["base_temperature"].values - temperature_of(time, off, rise_time)
    assert np.abs(error[hot]).max() < 8.0  # emittance 6 %, gain 2 %: some 3 K


def test_too_few_spectra_are_left_aside_and_said(run, record, caplog):
    result = run(record().isel(spectrum_time=[60, 61]))
    assert result.report["dataset"]["instruments"] == ["pyrometer"]
    assert "the spectrometer is left out: 2 samples, 5 needed" in caplog.text


def test_six_long_exposures_are_diagnosed(run, record):
    """Frames of 20 s: one before the injection, four with the plasma, one after it."""
    slow = record(frame=20.0)
    assert 6 <= slow.sizes["spectrum_time"] < 10
    report = run(slow).report
    assert report["dataset"]["instruments"] == ["pyrometer", "spectrometer"]
    assert report["verdict"]["status"] == "null"


def test_without_variations_of_the_gas_what_needs_them_is_not_looked_for(run, record):
    report = run(few_pixels(record()), variations={}).report
    assert {row["id"] for row in report["show"]["line_hump"]["tracks"]} == {"P_eff", "path"}


def test_a_record_without_any_noise_is_fitted_to_its_last_digits(run, record):
    temperature = run(few_pixels(record(noise=0.0))).temperature
    time = temperature["time_bin"].values
    hot = (time > 36) & (time < OFF)
    error = temperature["base_temperature"].values - temperature_of(time)
    assert np.abs(error[hot]).max() < 8.0  # what emittance and gains leave open


def test_without_a_calibration_of_the_pyrometer_the_spectra_are_diagnosed(run, record):
    assert run(record(), calibration=None).report["dataset"]["instruments"] == ["spectrometer"]


@pytest.mark.parametrize(
    ("settings", "change", "words"),
    [
        ({}, lambda test: test.isel(spectrum_time=[60]).drop_dims("time"), "5 sound samples .* holds 1 of"),
        ({}, lambda test: test.isel(spectrum_time=[]), "spectrum_time: holds no sample"),
        ({"start": 125.0, "end": 200.0}, without_pyrometer, "none lit by it"),
        ({"start": 125.0, "end": 200.0}, lambda test: test, "0 samples in the reference window"),
        ({}, lambda test: test.isel(wavelength=slice(5)), "5 usable pixels of the spectrometer lie within"),
        ({}, lambda test: test.assign(signal_wide=-test.signal_wide), "are sign and dark level right"),
    ],
    ids=["one spectrum", "no spectrum", "plasma off", "plasma off, bands", "five pixels", "sign"],
)
def test_what_cannot_be_diagnosed_is_refused_in_one_sentence(run, record, settings, change, words):
    test = change(record(**settings))
    for name in test.variables:
        test[name].attrs.setdefault("units", "A")
    with pytest.raises(ValueError, match=words):
        run(test)


def test_pyrometer_signals_without_their_calibration_are_refused(run, record):
    bands = record().drop_dims("spectrum_time").drop_vars("wavelength")
    with pytest.raises(ValueError, match=r"calibration\.nc of the pyrometer is needed"):
        run(bands, calibration=None)


def test_two_hours_are_divided_into_a_few_hundred_bins_and_twenty_seconds_into_forty():
    assert binning.time_edges(-60.0, 7500.0, 0.0, 7200.0).size < 300
    edges = binning.time_edges(-4.0, 26.0, 0.0, 20.0)
    assert ((edges >= 0) & (edges <= 20)).sum() > 20
    assert {0.0, 20.0} <= set(edges)


def test_a_long_record_is_averaged_over_neighbours_of_one_phase(record):
    from plasmapyro.record.record import record_of

    whole = record_of(record(), {"pyrometer": None}).instrument("pyrometer")
    short = binning.thinned(whole, OFF, 50)
    assert short.time.size < 60 and binning.thinned(whole, OFF, 1000) is whole
    group = binning.groups(whole.time, (0.0, OFF), 50)
    for switch in (0.0, OFF):
        assert not set(group[whole.time < switch]) & set(group[whole.time > switch])
    np.testing.assert_allclose(short.value[3], whole.value[group == 3].mean(axis=0), rtol=1e-12)
    assert short.integration_time == pytest.approx(whole.integration_time + 6 * 0.5, rel=1e-9)
