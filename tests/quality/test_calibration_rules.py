"""A calibration that contradicts itself is refused by name, and taken only by name."""

import laboratory
import numpy as np
import pytest
import xarray as xr

from plasmapyro import cli, io
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.instrument.stage import band_response
from plasmapyro.quality.catalogue import OF_CALIBRATION
from plasmapyro.quality.rule import Case, look


def said(**held):
    return {found.rule.name: found.words for found in look(Case("lab", **held), OF_CALIBRATION)}


@pytest.fixture(scope="module")
def response():
    return band_response(**RESPONSE)


def points(factor=1.0, row=4):
    kelvin = np.arange(1000.0, 1801.0, 100.0)
    wide, narrow = laboratory.signals(kelvin)
    wide[row] *= factor
    values = {"source_temperature": kelvin, "signal_wide": wide, "signal_narrow": narrow}
    return xr.Dataset({name: ("calibration_point", row) for name, row in values.items()})


def test_a_level_may_be_a_quarter_off_and_not_more(response):
    # exp(0.25) = 1.284
    for factor in (1.27, 1 / 1.27):
        assert said(points=points(factor), response=response) == {}
    for factor, words in ((1.30, "+30%"), (1 / 1.30, "-23%")):
        found = said(points=points(factor), response=response)["levels_leave_curve"]
        assert f"at 1400 K signal_wide of the calibration points is {words} off" in found


def test_a_ratio_may_be_four_per_cent_off_and_not_more():
    for off, count in ((0.039, 0), (-0.041, 1)):
        calibration = xr.Dataset(
            {
                "model_residual": ("calibration_point", [0.0, off, 0.01]),
                "source_temperature": ("calibration_point", [1000.0, 1200.0, 1400.0]),
                "sensitivity_ratio": 0.3,
            }
        )
        found = said(calibration=calibration)
        assert len(found) == count
        assert all(
            "at 1200 K the ratio of the calibration points is -4.1% off" in words for words in found.values()
        )


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ("S2 [nA]", "the narrow band is 1e+03 times as sensitive"),
        ("S1 [nA]", "the wide band is 1e+03 times"),
    ],
)
def test_one_band_in_another_unit_is_refused_by_name(tmp_path, capsys, column, words):
    """Nothing but the ratio tells it: by itself each band is as Planck's law wants it."""
    folder = laboratory.calibration_folder(tmp_path / "calibration")
    table = folder / "points.csv"
    table.write_text(table.read_text().replace(column, column.replace("nA", "uA")))
    command = ["calibrate", str(folder), "--out", str(tmp_path / "lab")]
    assert cli.main(command) == 2
    said = capsys.readouterr().err
    assert words in said and "[bands_unlike]" in said and "see whether both signals are in the unit" in said
    assert cli.main([*command, "--accept", "bands_unlike"]) == 0


def exposures(second=1.0, net=1000.0):
    light = net * (1 + np.linspace(0, 1, 50))
    counts = np.stack([light, second * light / 2]) + 500.0
    noise = np.random.default_rng(2).standard_normal((2, 50))
    return xr.Dataset(
        {
            "exposure_counts": (("exposure", "wavelength"), counts + noise),
            "exposure_dark": (("exposure", "wavelength"), np.full((2, 50), 500.0)),
            "exposure_time": ("exposure", [0.2, 0.1]),
        }
    )


def test_exposures_of_one_source_give_one_rate_and_are_brighter_than_the_dark():
    assert said(exposures=exposures()) == {}
    assert said(exposures=exposures(1.09)) == {}
    found = said(exposures=exposures(1.12))
    assert (
        "exposures 1 and 2 of one source give count rates that differ by a factor of 1.12"
        in found["rates_disagree"]
    )
    assert (
        "exposure 1 of the source is darker than its dark in 100%"
        in said(exposures=exposures(net=-200.0))["source_dark"]
    )


@pytest.mark.parametrize("name", ["exposure_counts", "exposure_dark"])
def test_pixels_that_one_exposure_lacks_contradict_nothing(name):
    data = exposures()
    data[name][1, 4:9] = np.nan
    assert said(exposures=data) == {}


@pytest.mark.parametrize(("lost", "factor"), [(0, "inf"), (1, "0")])
def test_a_dark_that_holds_the_light_leaves_no_rate(lost, factor):
    data = exposures()
    data.exposure_dark[lost] = data.exposure_counts[lost]
    assert f"differ by a factor of {factor};" in said(exposures=data)["rates_disagree"]


def test_calibrate_refuses_by_name_and_goes_on_by_name(tmp_path, capsys):
    folder = laboratory.calibration_folder(tmp_path / "raw")
    described = folder / "calibration.yaml"
    described.write_text(described.read_text().replace("unit: degC", "unit: K"))
    words = ["calibrate", str(folder), "--out", str(tmp_path / "lab")]
    assert cli.main(words) == 2
    refused = capsys.readouterr().err
    assert "[points_leave_curve]" in refused and "[levels_leave_curve]" in refused and "--accept" in refused
    assert "see whether source_temperature is in the unit stated (degC or K)" in refused
    assert not (tmp_path / "lab").exists()
    assert cli.main(["check", str(folder)]) == 2
    assert cli.main([*words, "--accept", "points_leave_curve"]) == 2
    assert cli.main([*words, "--accept", "points_leave_curve", "levels_leave_curve"]) == 0
    assert (tmp_path / "lab" / "calibration.nc").exists()


def test_check_takes_the_responses_that_calibrate_takes(tmp_path, capsys):
    """Points that a pyrometer of other bands measured: the narrow one 60 nm further to the red."""
    folder = laboratory.calibration_folder(tmp_path / "raw")
    response = band_response(**RESPONSE)
    own = response.copy()
    moved = np.interp(response.wavelength - 60e-9, response.wavelength, response.responsivity_narrow)
    own["responsivity_narrow"] = response.responsivity_narrow.copy(data=moved)
    io.write_labelled([(tmp_path / "own.nc", io.labelled(own, "response", [], {}))])
    words = ["check", str(folder), "--response", str(tmp_path / "own.nc")]
    assert cli.main(["check", str(folder)]) == 0
    assert cli.main(words) == 2 and "[points_leave_curve]" in capsys.readouterr().err
    assert cli.main(["calibrate", *words[1:], "--out", str(tmp_path / "lab")]) == 2
    assert cli.main(["check", str(tmp_path), *words[2:]]) == 2
    assert "--response is of a calibration" in capsys.readouterr().err
