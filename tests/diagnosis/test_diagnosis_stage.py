import json

import numpy as np
import pytest
import xarray as xr
from small_laboratory import OFF, temperature_of

from plasmapyro import contracts
from plasmapyro.diagnosis import command
from plasmapyro.diagnosis.catalogue import EFFECTS

LOSS = 0.03  # of window E at the end, some 20 standard deviations


def worst(dataset, name):
    time = dataset["time_bin"].values
    hot = (time > 20) & (time < OFF - 3)
    return np.abs(dataset[name].values - temperature_of(time))[hot]


def test_nothing_wrong_is_called_nothing_wrong(diagnosed):
    result = diagnosed()
    assert result.report["verdict"]["status"] == "null"
    assert result.report["verdict"]["named"] == []
    assert result.report["base"]["chi2"] / result.report["base"]["dof"] == pytest.approx(1.0, abs=0.1)
    assert worst(result.temperature, "base_temperature").max() < 8.0  # emittance 6 %, gain 2 %: some 3 K


def test_the_interval_is_as_wide_as_the_error(diagnosed):
    temperature = diagnosed().temperature
    time = temperature["time_bin"].values
    hot = (time > 20) & (time < OFF - 3)
    width = (temperature["base_temperature_high"] - temperature["base_temperature_low"]).values[hot] / 3.92
    error = temperature["base_temperature"].values[hot] - temperature_of(time)[hot]
    # Errors of neighbours are alike, so the mean square is no better known than within a factor of a few.
    assert 0.1 < np.mean((error / width) ** 2) < 6.0


def test_a_deposit_on_a_window_is_named_with_its_size(diagnosed):
    report = diagnosed(window_loss=LOSS).report
    assert report["verdict"]["named"] == ["winE"]
    best = report["candidates"][0]
    assert best["id"] == "winE"
    assert abs(best["amplitude"] - LOSS) < 3.5 * best["standard_error"]
    assert report["gain"]["heldout_log_score"] > 10
    assert report["extended"]["applied"]
    assert "winE" in report["extended"]["configuration"]


def test_without_its_name_the_deposit_is_something_unknown_or_a_near_relation(diagnosed):
    verdict = diagnosed(without=("winE",), window_loss=LOSS).report["verdict"]
    assert verdict["status"] != "null"
    relations = {"winE_sl", "winD", "winD_sl", "eps_ox", "eps_T", "edge_s"}
    assert verdict["status"] in ("unknown", "named+unknown") or set(verdict["named"]) & relations


def test_a_fringe_is_something_that_the_catalogue_lacks(diagnosed):
    report = diagnosed(fringe=0.006).report
    assert report["verdict"]["status"] in ("unknown", "named+unknown")
    assert "pattern" in report["discrepancy"]["class"]


def test_an_error_of_the_ratio_costs_kelvin_and_is_found(diagnosed):
    report = diagnosed(ratio_error=0.04).report
    entry = next(row for row in report["candidates"] if row["id"] == "phi")
    assert entry["gain_chi2"] > 20
    assert abs(entry["temperature_shift"]["paper"]) > 20
    assert set(report["verdict"]["named"]) & {"phi", "edge1", "edge2", "resp_long"}


def test_the_report_honours_its_schema_and_survives_json(diagnosed):
    for result in (diagnosed(), diagnosed(window_loss=LOSS), diagnosed(fringe=0.006)):
        assert command.check(json.loads(json.dumps(result.report, allow_nan=False))) == result.report


def test_the_datasets_honour_their_contracts(diagnosed):
    result = diagnosed(window_loss=LOSS)
    contracts.check(contracts.label(result.residual_map, "residual_map"), "residual_map")
    contracts.check(contracts.label(result.temperature, "diagnosis_temperature"), "diagnosis_temperature")
    before, after = (
        result.residual_map["radiance_residual"].sel(model=m).values for m in ("base", "extended")
    )
    assert np.nanmean(after**2) < np.nanmean(before**2)


def test_probabilities_add_up(diagnosed):
    for result in (diagnosed(), diagnosed(window_loss=LOSS)):
        assert sum(result.report["verdict"]["probability"].values()) == pytest.approx(1.0, abs=1e-3)


def test_what_stays_invisible_is_said_in_kelvin(diagnosed):
    limits = diagnosed().report["limits"]
    assert {row["id"] for row in limits} == set(EFFECTS)
    hidden = [row["temperature_prior"] for row in limits if row["invisible"]]
    assert hidden == sorted(hidden, reverse=True)


def test_one_instrument_is_enough_to_run(record, laboratory):
    from plasmapyro.diagnosis.stage import diagnose

    test = record().drop_dims("spectrum_time").drop_vars("wavelength")
    with np.errstate(all="ignore"):
        result = diagnose(
            test,
            laboratory.radiation,
            laboratory.powers,
            laboratory.variations,
            laboratory.response,
            laboratory.calibration,
            draws=200,
        )
    assert result.report["dataset"]["instruments"] == ["pyrometer"]
    command.check(result.report)


def test_an_unknown_condition_or_effect_is_refused(record, laboratory):
    inputs = command.Inputs(
        laboratory.radiation,
        laboratory.powers,
        {},
        laboratory.response,
        laboratory.calibration,
        None,
        "synthetic",
        {},
    )
    with pytest.raises(ValueError, match="condition must name one of 60kW"):
        command.diagnose_test(record().assign_attrs(condition="1MW"), inputs)
    with pytest.raises(ValueError, match="exclude must name effects"):
        command.diagnose_test(record(), inputs, without=("gremlins",))


def test_files_are_written_all_or_none(diagnosed, tmp_path):
    result = diagnosed(window_loss=LOSS)

    def broken(*_):
        raise RuntimeError("no page")

    with pytest.raises(RuntimeError, match="no page"):
        command.write_all(result, tmp_path / "out", page=broken)
    assert list(tmp_path.iterdir()) == []
    command.write_all(result, tmp_path / "out", page=lambda *_: "<html></html>")
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"diagnosis.json", "residual_map.nc", "temperature.nc", "index.html"}
    with xr.open_dataset(tmp_path / "out/temperature.nc") as stored:
        assert stored.attrs["origin"] == "synthetic"
        assert stored.attrs["terms"] == "winE"


def test_the_exit_status_tells_a_finding_only_if_asked(diagnosed):
    assert command.exit_status(diagnosed().report, True) == 0
    assert command.exit_status(diagnosed(window_loss=LOSS).report, True) == 3
    assert command.exit_status(diagnosed(window_loss=LOSS).report, False) == 0
