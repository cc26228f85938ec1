import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from small_laboratory import SLIT_FWHM

from plasmapyro import cli
from plasmapyro.claims import published_experiment as published
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.radiation.levels import vibrational


@pytest.fixture(scope="module")
def library(laboratory):
    return gas_library("80kW", laboratory.radiation, laboratory.variations, fwhm=SLIT_FWHM)


@pytest.fixture(scope="module")
def reader(response):
    return published.Reader(response, 0.85, 0.3)


def test_without_gas_the_reading_is_the_truth(reader, library):
    error = reader.error(
        library.wavelength, np.zeros(library.wavelength.size), np.array([900.0, 1300.0, 1900.0])
    )
    assert np.abs(error).max() < 2e-5  # of the curve in steps of 5 K


def test_half_the_emittance_errs_as_twice_the_gas(response, reader, library):
    half = published.Reader(response, 0.425, 0.3)
    spectrum = library.base
    assert half.error(library.wavelength, spectrum, 1300.0) == pytest.approx(
        reader.error(library.wavelength, 2 * spectrum, 1300.0), rel=1e-9
    )


def test_the_power_behind_errors_is_found_again(reader, library, monkeypatch):
    spectrum = library.base * library.power_factor(np.log(73 / 80))
    thresholds = tuple((t, abs(reader.error(library.wavelength, spectrum, t)[0])) for t in (1120.0, 1350.0))
    monkeypatch.setattr(published, "THRESHOLDS", thresholds)
    with np.errstate(all="ignore"):
        assert published.implied_powers(library, reader) == pytest.approx(73e3, rel=2e-3)


def test_an_explanation_by_more_power_needs_that_power(reader, library, monkeypatch):
    spectrum = library.base * library.power_factor(0.2)
    thresholds = tuple((t, abs(reader.error(library.wavelength, spectrum, t)[0])) for t in (1120.0, 1350.0))
    monkeypatch.setattr(published, "THRESHOLDS", thresholds)
    with np.errstate(all="ignore"):
        rows = {row["id"]: row for row in published.explain(library, reader, 0.85)}
    assert rows["P_eff"]["amplitude"] == pytest.approx(0.2, abs=0.01)
    assert min(rows.values(), key=lambda row: row["misfit"])["misfit"] < 0.03


def test_the_tables_hold_what_was_computed(library, reader, monkeypatch):
    spectrum = library.base * library.power_factor(np.log(73 / 80))
    thresholds = tuple((t, abs(reader.error(library.wavelength, spectrum, t)[0])) for t in (1120.0, 1350.0))
    monkeypatch.setattr(published, "THRESHOLDS", thresholds)
    with np.errstate(all="ignore"):
        text = published.as_text(library, reader)
        rows = published.explain(library, reader, 0.85)
    found = [float(word) for word in re.findall(r"off at .* K \| ([\d.]+) kW", text)]
    assert found == pytest.approx([73.0, 73.0], abs=0.2)
    for row in rows:
        (line,) = (each for each in text.splitlines() if each.startswith(f"| {row['name']} |"))
        assert published.AMPLITUDES[row["id"]](row["amplitude"]) in line
        assert ("not enough" in line) == (row["misfit"] > published.POORLY)
        assert line.endswith(f"| {row['line']:.1f} | {row['hump']:.1f} |")


def test_the_rule_takes_a_simulation_that_the_efficiency_implies():
    rule = (Path(__file__).resolve().parents[2] / "workflow/rules/diagnosis.smk").read_text("utf-8")
    (words,) = re.findall(r"EFFICIENCY_KW = \((\d+), (\d+)\)", rule)
    assert tuple(1e3 * float(word) for word in words) == published.EFFICIENCY


def test_another_vibrational_temperature_keeps_the_number_of_molecules():
    energy = np.array([0.0, 1.7e5, 3.4e5, 5.0e5])  # [m-1]
    lines = SimpleNamespace(upper_vibration=(energy, energy))
    factor = vibrational(lines, 6000.0, 0.8)
    population = np.exp(-1.438776877e-2 * energy / 6000.0)
    assert np.sum(population * factor) == pytest.approx(np.sum(population), rel=1e-4)
    assert (np.diff(factor) < 0).all()
    assert np.allclose(vibrational(lines, 6000.0, 1.0), 1.0, rtol=1e-12)


@pytest.mark.parametrize("broken", ["test", "radiance", "out"])
def test_the_command_refuses_bad_input_with_one_message(tmp_path, capsys, record, broken):
    record().to_netcdf(tmp_path / "test.nc")
    (tmp_path / "file").write_text("taken")
    options = {"test": "test.nc", "radiance": "empty", "out": "new"}
    options[broken] = {"test": "absent.nc", "radiance": "empty", "out": "file"}[broken]
    (tmp_path / "empty").mkdir()
    arguments = [
        "diagnose",
        str(tmp_path / options["test"]),
        *("--radiance", str(tmp_path / options["radiance"])),
        *("--instrument", str(tmp_path)),
        *("--out", str(tmp_path / options["out"])),
    ]
    assert cli.main(arguments) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and "Traceback" not in message
    assert not (tmp_path / "new").exists()
