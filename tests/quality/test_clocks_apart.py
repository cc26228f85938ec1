"""Of instruments that contradict each other none is called valid, nor what a wrong clock moves too far."""

import shutil
from pathlib import Path

import laboratory
import numpy as np
import pytest
import xarray as xr
from try_mistakes import EXAMPLE, run

from plasmapyro import cli, contracts
from plasmapyro.commands.calibrate import CURVE, RESPONSE
from plasmapyro.commands.correct import PYROMETER, SPECTROMETER, by_reference
from plasmapyro.instrument.stage import band_response, calibrate_exposures, pyrometer_calibration
from plasmapyro.quality import agreement, late
from plasmapyro.quality.catalogue import agreed
from plasmapyro.quality.rule import Case
from plasmapyro.readers.calibration import read_exposures, read_points
from plasmapyro.record import status


@pytest.fixture(scope="module")
def correct(tmp_path_factory):
    """A function: seconds that the spectra are late -> `Case` of the invented test."""
    folder = laboratory.calibration_folder(tmp_path_factory.mktemp("raw") / "calibration")
    response = band_response(**RESPONSE)
    stated = {"instrument_range": (973.0, 2073.0), "calibration_temperature": CURVE, "draws": 100, "seed": 1}
    errors = {"source_temperature_uncertainty": 3.0, "signal_uncertainty": 0.01}
    read = {"saturation_counts": 65000.0, "least_net_counts": 50.0, "noise_block": 50}
    calibrations = {
        PYROMETER: pyrometer_calibration(response, read_points(folder), **errors, **stated),
        SPECTROMETER: calibrate_exposures(read_exposures(folder), **read),
    }
    options = cli.parser(["correct"]).parse_args(["correct", "", "--instrument", str(folder)])

    def made(late=0.0, drift=0.0, bend=0.0, every=1):
        test = laboratory.made().isel(spectrum_time=slice(0, None, every))
        for name in ("signal_wide", "signal_narrow"):
            test[name] *= 1 - bend * test[name] / test[name].max()
        dark, moment = test.background_counts, test.spectrum_time
        test["counts"] = (test.counts - dark) * (1 + drift * moment / 60) + dark
        test = test.transpose("spectrum_time", ...)
        test = test.assign_coords(spectrum_time=moment + late)
        test = contracts.label(test, "test")
        return Case(Path(), test, response=response, result=by_reference(test, calibrations, options))

    return made


@pytest.mark.parametrize("by", [-8.0, -3.0, -0.6, 0.4, 0.7])
def test_an_offset_is_measured_and_said(correct, by):
    case = correct(by)
    found = late.clocks(case, 2.0).late
    assert found == pytest.approx(by, abs=0.03)
    said = agreement.clocks_apart(case)
    assert f"the spectra are {abs(found):.2g} s {'late' if found > 0 else 'early'} against" in said.saw
    assert f"move the spectra by {-found:+.2g} s" in said.remedy


def test_six_spectra_tell_an_offset_of_two_seconds(correct):
    """Eight had been needed: fits 8 stated uncertainties off were valid."""
    case = correct(2.0, every=4)
    assert (case.result.spectrum_status == status.VALID).sum() == 6
    assert late.clocks(case, 2.0).late == pytest.approx(2.0, abs=0.05)
    (told,) = agreed([case.result], case.test, case.response)
    assert far(case.result).any() and not far(told).any()
    assert late.clocks(correct(0.0, every=4), 0.0) is None


def test_an_offset_that_moves_no_temperature_by_two_uncertainties_is_measured_and_not_said(correct):
    case = correct(0.2)
    assert late.clocks(case, 0.0).late == pytest.approx(0.2, abs=0.03)
    assert late.clocks(case, 2.0) is None and agreement.clocks_apart(case) is None


@pytest.mark.parametrize("wrong", [{}, {"drift": 0.05}, {"drift": -0.05}, {"bend": 0.05}])
def test_true_clocks_are_passed_also_where_a_window_drifts_or_a_band_bends(correct, wrong):
    case = correct(**wrong)
    assert late.clocks(case, 0.0) is None and agreement.clocks_apart(case) is None
    (same,) = agreed([case.result], case.test, case.response)
    assert same.equals(case.result)


def far(result):
    """Valid spectra more than three of their uncertainties off the truth (S,)."""
    error = result.scaled_temperature - laboratory.temperature(result.spectrum_time)
    return ((result.spectrum_status == 0) & (abs(error) > 3 * result.scaled_temperature_uncertainty)).values


def test_what_a_late_clock_moves_beyond_its_uncertainty_is_not_valid(correct):
    case = correct(0.7)
    (told,) = agreed([case.result], case.test, case.response)
    assert far(case.result).sum() >= 2 and not far(told).any()
    odd = told.spectrum_status.values == status.CONTRADICTED
    assert np.isnan(told.scaled_temperature.values[odd]).all()
    assert np.isnan(told.spectrometer_temperature_uncertainty.values[odd]).all()
    assert (told.spectrum_status == status.VALID).sum() >= 4  # the plateau does not care for the hour
    # Its 20 K cover what the offset moves.
    assert told.corrected_temperature.equals(case.result.corrected_temperature)


def test_correct_takes_neither_of_two_clocks_for_right(tmp_path):
    shutil.copytree(EXAMPLE, tmp_path / "case")
    described = tmp_path / "case/my_test/test.yaml"
    described.write_text(described.read_text().replace("first: 2.0", "first: 2.6"))
    out = tmp_path / "out.nc"
    words = ["--no-html", "--estimator", "reference", "--draws", "50", "--out", out]
    status_of_exit, said = run("correct", tmp_path / "case/my_test", *words)
    assert status_of_exit == 0 and "[clocks_apart]" in said
    with xr.open_dataset(out, decode_times=False) as found:
        assert "s late against the pyrometer" in found.recommended_because
        odd = found.spectrum_status == status.CONTRADICTED
        assert odd.any() and np.isnan(found.scaled_temperature[odd]).all()


def pair(apart, error=20.0):
    """Two instruments that differ at the middle spectrum of five, and a joint estimate beside them."""
    fast, slow = np.arange(0.0, 10.5, 0.5), np.arange(1.0, 10.0, 2.0)
    kelvin = {"time": np.full(fast.size, 1600.0), "spectrum_time": np.full(slow.size, 1600.0)}
    kelvin["spectrum_time"][2] += apart
    rows = {}
    for name, state in late.TEMPERATURES.items():
        axis = "spectrum_time" if name == "scaled_temperature" else "time"
        rows[name] = axis, kelvin[axis].copy()
        rows[f"{name}_uncertainty"] = axis, np.full(kelvin[axis].size, error)
        rows[state] = axis, np.zeros(kelvin[axis].size, dtype="int8")
    rows["corrected_status"][1][10] = status.NO_SIGNAL  # at 5 s
    rows["relative_error"] = "time", np.zeros(fast.size)
    both = xr.Dataset(rows, {"time": fast, "spectrum_time": slow})
    joint = ["surface_temperature", "surface_temperature_uncertainty", "estimate_status"]
    return [both.drop_vars(joint), both[joint]]


def test_of_instruments_that_disagree_none_is_valid_there():
    first, joint = agreed(pair(100.0), None)
    assert first.spectrum_status.values.tolist() == [0, 0, status.CONTRADICTED, 0, 0]
    for part, name in ((first, "corrected"), (joint, "surface")):
        state = part[late.TEMPERATURES[f"{name}_temperature"]].values
        odd = state == status.CONTRADICTED
        assert np.isnan(part[f"{name}_temperature"].values[odd]).all()
        assert np.isin(state[~odd], (status.VALID, status.NO_SIGNAL)).all()
        assert part.time.values[odd].tolist() == [4.5, 5.0, 5.5][:: 2 if name == "corrected" else 1]
    assert np.isnan(first.relative_error.values).sum() == 2
    first, joint = agreed(pair(84.0), None)  # hypot(20, 20) = 28.3
    assert not np.isnan(first.scaled_temperature).any() and (joint.estimate_status == 0).all()
