"""`check`, `calibrate` and `correct`, from raw files to temperatures of known truth."""

import re
from pathlib import Path

import laboratory
import numpy as np
import pytest
import xarray as xr
import yaml

from plasmapyro import cli, io
from plasmapyro.commands import calibrate, joint
from plasmapyro.diagnosis.command import LIMITS
from plasmapyro.experiment.stage import PIVOT
from plasmapyro.record import status

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def shelf(tmp_path_factory):
    """Raw calibration, the calibration made of it, and tests of both instruments and of each alone."""
    place = tmp_path_factory.mktemp("shelf")
    laboratory.calibration_folder(place / "raw")
    assert cli.main(["calibrate", str(place / "raw"), "--out", str(place / "lab")]) == 0
    laboratory.test_file(place / "both.nc")
    laboratory.test_file(place / "pyrometer.nc", spectrometer=False)
    laboratory.test_file(place / "spectrometer.nc", pyrometer=False)
    return place


def corrected(shelf, name, out, *words):
    arguments = ["correct", str(shelf / name), "--instrument", str(shelf / "lab"), "--out", str(out)]
    return cli.main([*arguments, "--draws", "20", *words])


def test_raw_counts_give_the_factor_of_the_detector(shelf):
    found = io.read(shelf / "lab" / "spectrometer_calibration.nc", "spectrometer_calibration")
    lit = found.pixel_status.values == 0
    assert lit[1:-1].all() and not lit[[0, -1]].any()
    # Four standard deviations: a count of noise in 2000 net ones. The polynomial is 2 %.
    np.testing.assert_allclose(found.calibration_factor[lit] * laboratory.GAIN, 1, rtol=2.5e-3)
    assert found.attrs["origin"] == "synthetic"


def test_points_in_celsius_give_the_pyrometer(shelf):
    found = io.read(shelf / "lab" / "calibration.nc", "calibration")
    np.testing.assert_allclose(found.source_temperature[0], 973.15, rtol=1e-12)
    assert float(found.sensitivity_ratio) == pytest.approx(1, rel=1e-5)
    np.testing.assert_allclose(found.absolute_sensitivity, laboratory.SENSITIVITY, rtol=1e-5)


@pytest.mark.parametrize("name", ["both.nc", "pyrometer.nc", "spectrometer.nc"])
def test_the_true_temperature_comes_out(shelf, tmp_path, capsys, name):
    assert corrected(shelf, name, tmp_path / "t.nc") == 0
    found = io.read(tmp_path / "t.nc", "correction")
    said = capsys.readouterr().out
    if name != "spectrometer.nc":
        late = (found.time.values > 20) & (found.time.values <= 50)
        truth = laboratory.temperature(found.time.values)[late]
        # 0.1 % of a signal is 1.5 K; the quadratic calibration curve errs by 3 K.
        np.testing.assert_allclose(found.corrected_temperature[late], truth, atol=10)
        early = (found.time.values > 14) & (found.time.values < 18)
        read = found.measured_temperature.values - laboratory.temperature(found.time.values)
        assert (found.measured_status[early] == status.ABOVE).all() or (read[early] > 15).all()
        assert "corrected_temperature: " in said and "valid" in said
    if name != "pyrometer.nc":
        late = found.spectrum_time.values > 20
        truth = laboratory.temperature(found.spectrum_time.values)[late]
        np.testing.assert_allclose(found.scaled_temperature[late], truth, rtol=2e-3)
        np.testing.assert_allclose(found.apparent_emittance[late], laboratory.EMITTANCE, rtol=0.006)
        assert "spectrometer_temperature: " in said
    assert found.attrs["origin"] == "synthetic"
    best = "emissivity" if name == "spectrometer.nc" else "joint"  # spectra alone: no surface need be grey
    assert '"estimator": "all"' in found.attrs["configuration"]
    assert found.attrs["recommended"] == best and found.attrs["recommended_because"] in said
    best, time = found.recommended_temperature.values, found.time.values
    late = np.isfinite(best) & (time > 20)
    pull = (best - laboratory.temperature(time))[late] / found.recommended_temperature_uncertainty[late]
    assert late.sum() >= 20 and float(np.abs(pull).max()) < 3
    squares = (found.temperature_contribution**2).sum("input_quantity")[late]
    np.testing.assert_allclose(np.sqrt(squares), found.recommended_temperature_uncertainty[late], rtol=0.01)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("filter_transmittance: 0.5", "filter_transmittance: 0.25", 0.5),
        ("filter_transmittance: 0.5", "filter_transmittance: 0.5\n  window_transmittance: 0.8", 1 / 0.8),
        ("temperature_k: 1700,", "temperature_k: 1700, emittance: 0.9,", 0.9),
    ],
)
def test_what_stands_in_the_light_scales_the_factor(shelf, tmp_path, old, new, expected):
    place = laboratory.calibration_folder(tmp_path / "raw")
    words = (place / "calibration.yaml").read_text()
    assert old in words
    (place / "calibration.yaml").write_text(words.replace(old, new))
    assert cli.main(["calibrate", str(place), "--out", str(tmp_path / "lab")]) == 0
    found, plain = (
        io.read(folder / "lab" / "spectrometer_calibration.nc", "spectrometer_calibration")
        for folder in (tmp_path, shelf)
    )
    ratio = (found.calibration_factor / plain.calibration_factor).values[1:-1]
    np.testing.assert_allclose(ratio, expected, rtol=1e-12)


def line_lamp(place, shift=0.2):
    """Files of a Hg(Ar) lamp whose lines [nm in air] lie off by `shift`, 1.2 nm wide."""
    grid = np.linspace(380.0, 900.0, 1500)
    lines = [435.833, 546.074, 696.543, 706.722, 738.398, 763.511, 826.452, 842.465]
    light = sum(4000 * np.exp(-4 * np.log(2) * ((grid - line - shift) / 1.2) ** 2) for line in lines)
    generator = np.random.default_rng(3)
    for name, counts in (("lines", light), ("lines_dark", 0 * light)):
        body = "".join(
            f"{w:.3f}\t{c:.2f}\n"
            for w, c in zip(grid, counts + 5 * generator.standard_normal(1500), strict=True)
        )
        words = laboratory.FILE.format(time=1e5, body=body).replace(": 150", ": 1500")
        (place / f"{name}.txt").write_text(words)
    described = place / "calibration.yaml"
    described.write_text(
        described.read_text() + "  line_lamp: {light: lines.txt, dark: lines_dark.txt, fwhm_nm: 1.3}\n"
    )


def test_a_window_before_the_test_only_dims_the_pyrometer(shelf, tmp_path):
    place = laboratory.calibration_folder(tmp_path / "raw")
    words = (place / "calibration.yaml").read_text()
    (place / "calibration.yaml").write_text(
        words.replace("file: points.csv", "file: points.csv\n  window_transmittance: 0.8")
    )
    assert cli.main(["calibrate", str(place), "--out", str(tmp_path / "lab")]) == 0
    found, plain = (io.read(folder / "lab" / "calibration.nc", "calibration") for folder in (tmp_path, shelf))
    ratio = found.absolute_sensitivity / plain.absolute_sensitivity
    np.testing.assert_allclose(ratio, 0.8, rtol=1e-6)  # weights of points follow their signals
    np.testing.assert_allclose(found.sensitivity_ratio, plain.sensitivity_ratio, rtol=1e-6)


def test_a_line_lamp_tells_wavelengths_and_width(tmp_path, capsys):
    place = laboratory.calibration_folder(tmp_path / "raw")
    line_lamp(place)
    assert cli.main(["calibrate", str(place), "--out", str(tmp_path / "lab")]) == 0
    said = re.search(r"(\d+) lines of Hg and Ar, off by (\S+) nm .*width (\S+) nm", capsys.readouterr().out)
    assert int(said.group(1)) >= 4
    assert float(said.group(2)) == pytest.approx(0.2, abs=0.02)
    assert float(said.group(3)) == pytest.approx(1.2, rel=0.05)
    (place / "lines.txt").unlink()
    assert cli.main(["check", str(place)]) == 2
    assert "lines.txt: no such file" in capsys.readouterr().err


def test_leaving_the_linearity_out_would_be_seen(shelf, tmp_path):
    """With the polynomial dropped from the calibration the level is off by some per cent."""
    path = shelf / "lab" / "spectrometer_calibration.nc"
    bare = io.read(path, "spectrometer_calibration").drop_vars(["linearity_coefficient", "masked_pixel"])
    io.write(bare, tmp_path / "lab" / path.name, "spectrometer_calibration")
    words = ["correct", str(shelf / "spectrometer.nc"), "--instrument", str(tmp_path / "lab"), "--draws", "3"]
    assert cli.main([*words, "--out", str(tmp_path / "t.nc")]) == 0
    found = io.read(tmp_path / "t.nc", "correction").sel(spectrum_time=39.0)
    assert abs(float(found.apparent_emittance) / laboratory.EMITTANCE - 1) > 0.01


def test_the_same_call_gives_the_same_bytes(shelf, tmp_path):
    for name in ("a.nc", "b.nc"):
        assert corrected(shelf, "both.nc", tmp_path / name) == 0
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_a_window_with_the_surface_in_it_is_refused_unless_wanted(shelf, tmp_path, capsys):
    late = ["--reference-window", "0", "14"]
    assert corrected(shelf, "pyrometer.nc", tmp_path / "t.nc", *late) == 2
    said = capsys.readouterr().err
    assert "the surface already shows" in said and "--keep-window" in said
    proposed = re.search(r"--reference-window (\S+) (\S+) \[surface_in_window\]\n", said).groups()
    assert 2 < float(proposed[1]) < 7 and not (tmp_path / "t.nc").exists()
    assert corrected(shelf, "pyrometer.nc", tmp_path / "kept.nc", *late, "--keep-window") == 0
    assert corrected(shelf, "pyrometer.nc", tmp_path / "good.nc", "--reference-window", *proposed) == 0
    kept, good = (io.read(tmp_path / f"{name}.nc", "correction") for name in ("kept", "good"))
    assert kept.attrs["pyrometer_reference_verdict"] == "surface_shows"
    assert (good.corrected_status == status.VALID).sum() > (kept.corrected_status == status.VALID).sum()


@pytest.mark.parametrize(("opens", "rule"), [(3.0, "dark_in_window"), (5.5, "dark_reference")])
def test_a_window_that_a_shutter_darkens_is_refused_unless_wanted(tmp_path, shelf, capsys, opens, rule):
    """Its gas would be left in: temperatures 500 K off at 18 stated, or stated to 900 K."""
    test = io.read(shelf / "pyrometer.nc", "test")
    closed = (test.time > (1.0 if opens < 5 else -2.0)) & (test.time < opens)
    dark = 1e-13 * np.random.default_rng(1).standard_normal((2, test.time.size))
    for band, row in zip(("signal_wide", "signal_narrow"), dark, strict=True):
        test[band] = test[band].where(~closed, row)
    io.write(test, tmp_path / "test.nc", "test")
    words = ["correct", str(tmp_path / "test.nc"), "--instrument", str(shelf / "lab"), "--draws", "200"]
    words += ["--out", str(tmp_path / "t.nc")]
    assert cli.main(words) == 2
    said = capsys.readouterr().err
    assert f"[{rule}]" in said and "--keep-window" in said and not (tmp_path / "t.nc").exists()
    assert cli.main([*words, "--keep-window"]) == 0
    found = io.read(tmp_path / "t.nc", "correction")
    for name in ("corrected", "measured"):
        error = found[f"{name}_temperature_uncertainty"]
        assert float(error.max()) < (2073.15 - 973.15) / np.sqrt(12)
        assert (np.isfinite(error) == np.isfinite(found[f"{name}_temperature"])).all()
    dark = "times as bright as in the reference window" in found.attrs["recommended_because"]
    assert dark == (rule == "dark_reference")


def test_spectra_alone_judge_the_window_as_well(tmp_path, shelf, capsys):
    test = laboratory.made(pyrometer=False)
    times = np.arange(0.25, 60.0, 0.5)
    light = laboratory.EMITTANCE * laboratory.blackbody_radiance(
        laboratory.WAVELENGTH, laboratory.temperature(times)[:, None]
    )
    light += 3e8 * (times <= 50)[:, None]
    counts = np.array([laboratory.raw(row, 0.5, 10 + i) for i, row in enumerate(light)])
    test = test.drop_vars(["counts", "spectrum_time"]).assign_coords(spectrum_time=times)
    test["counts"] = (("spectrum_time", "wavelength"), counts)
    io.write(test, tmp_path / "test.nc", "test")
    words = ["correct", str(tmp_path / "test.nc"), "--instrument", str(shelf / "lab"), "--draws", "3"]
    assert cli.main([*words, "--out", str(tmp_path / "a.nc")]) == 0
    capsys.readouterr()
    late = ["--reference-window", "0", "12", "--reference-time", "3"]
    assert cli.main([*words, "--out", str(tmp_path / "b.nc"), *late]) == 2
    assert "% to that of the longer wavelengths; try --reference-window 0 " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("test", "words", "message"),
    [
        ("both.nc", ["--instrument", "nowhere"], "nowhere: no such folder"),
        ("both.nc", ["--instrument", str(ROOT / "docs")], "calibration.nc: no such file"),
        ("both.nc", ["--out", "lab/x.nc"], "lies in a folder that is read"),
        ("both.nc", ["--out", "both.nc"], "is an input or another output"),
        ("absent", [], "absent: no such folder"),
        ("both.nc", ["--reference-window", "-3", "2"], "must lie between injection"),
        ("both.nc", ["--normalisation-nm", "1200"], "no usable pixel within 2 nm of the wavelength at which"),
        ("both.nc", ["--reference-time", "40"], "is not inside the reference window"),
    ],
)
def test_bad_input_is_one_message_and_no_file(shelf, monkeypatch, capsys, test, words, message):
    monkeypatch.chdir(shelf)
    before = sorted(shelf.rglob("*"))
    defaults = {"--instrument": "lab", "--out": "t.nc"}
    given = [word for key, value in defaults.items() if key not in words for word in (key, value)]
    assert cli.main(["correct", test, *given, *words]) == 2
    said = capsys.readouterr()
    assert said.err.count("plasmapyro: ") == 1 and message in said.err and "Traceback" not in said.err
    assert sorted(shelf.rglob("*")) == before


@pytest.mark.parametrize("word", ["--draws=1", "--gas-variation=2", "--seed=-1", "--estimator=magic"])
def test_impossible_options_are_refused_before_anything_is_read(word, capsys):
    with pytest.raises(SystemExit) as end:
        cli.main(["correct", "nothing", "--instrument", "x", "--out", "y", word])
    assert end.value.code == 2
    assert word.split("=")[0] in capsys.readouterr().err


def test_a_file_of_effects_that_holds_none_of_a_test_is_said(shelf, tmp_path, capsys):
    file = tmp_path / "terms.yaml"
    file.write_text("condition:\n  effects:\n  - {id: power, amplitude: -0.07}\n")
    words = ["--estimator", "reference", "--with", str(file)]
    assert corrected(shelf, "pyrometer.nc", tmp_path / "t.nc", *words) == 0
    assert f"{file} holds no effect of a test: nothing is taken out" in capsys.readouterr().err


def test_the_joint_estimator_gives_a_temperature_near_the_subtraction(shelf, tmp_path):
    assert corrected(shelf, "both.nc", tmp_path / "j.nc", "--estimator", "joint") == 0
    assert corrected(shelf, "both.nc", tmp_path / "r.nc") == 0
    joint = io.read(tmp_path / "j.nc", "joint_estimate")
    paper = io.read(tmp_path / "r.nc", "correction").corrected_temperature
    late = paper.time > paper.time[-1] - 5
    difference = (joint.surface_temperature - paper).where(late).mean()
    assert abs(difference) < 3 * joint.surface_temperature_uncertainty.where(late).mean() + 25
    assert joint.attrs["origin"] == "synthetic"


def test_the_joint_estimator_takes_spectra_alone_with_their_emissivity(shelf, tmp_path, capsys):
    asked, same = tmp_path / "j.nc", tmp_path / "e.nc"
    assert corrected(shelf, "spectrometer.nc", asked, "--estimator", "joint") == 0
    assert corrected(shelf, "spectrometer.nc", same, "--estimator", "emissivity") == 0
    with xr.open_dataset(asked) as one, xr.open_dataset(same) as other:
        assert np.array_equal(one.spectral_temperature, other.spectral_temperature, equal_nan=True)
        assert np.isfinite(one.spectral_temperature).any()


def test_check_says_what_is_there(shelf, capsys):
    assert cli.main(["check", str(shelf / "both.nc")]) == 0
    said = capsys.readouterr()
    for words in ("256 samples, -4 to 59.75 s, one per 0.25 s", "30 spectra", "150 pixels", "0 to 5 s"):
        assert words in said.out
    assert said.err == ""
    assert cli.main(["check", str(shelf / "raw")]) == 0
    assert "calibrate the pyrometer and spectrometer" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda test: test.isel(time=slice(0, 100)),
            "time ends at 20.75 s, the plasma at 50 s; is a file cut off",
        ),
        (lambda test: test.isel(time=slice(28, None)), "time begins at 3 s, the injection is at 0 s"),
        (lambda test: test.isel(time=np.r_[0:120, 180:256]), "time has 1 gaps, the first from 25.75 to 41 s"),
        (lambda test: test.assign(signal_wide=1e6 * test.signal_wide), "A, more than a photodiode gives"),
        (lambda test: test.isel(spectrum_time=slice(0, 9)), "spectrum_time ends at 17 s"),
    ],
)
def test_check_says_what_is_doubtful(tmp_path, capsys, change, message):
    io.write(change(laboratory.made()), tmp_path / "test.nc", "test")
    assert cli.main(["check", str(tmp_path / "test.nc")]) == 0
    said = capsys.readouterr().err
    assert message in said and said.startswith("plasmapyro: warning: ")


def test_check_says_everything_that_is_wrong_at_once(shelf, tmp_path, capsys):
    test = laboratory.made()
    test.attrs["reference_window"], test.attrs["emittance"] = [5.0, 0.0], 1.2
    del test.attrs["spectrometer_fwhm"]
    io.write(test, tmp_path / "bad.nc", "test")
    assert cli.main(["check", str(tmp_path / "bad.nc")]) == 2
    said = capsys.readouterr().err
    for words in ("3 faults", "reference_window", "emittance: 1.2", "spectrometer_fwhm: missing"):
        assert words in said


@pytest.mark.parametrize(
    ("old", "new", "messages"),
    [
        ("filter_transmittance: 0.5", "filter_transmittance: 50", ["must be at most 1; got 50"]),
        ("long.txt", "lang.txt", ["lang.txt: no such file"]),
        ("dark: long_dark.txt", "dark: short_dark.txt", ["integration times differ", "0.1 s and 0.2 s"]),
        ("[0, -1]", "[0, -1.5]", ["masked_pixels must be a list of whole numbers"]),
        ("[0, -1]", "[400]", ["not all of [400] exist among 150"]),
        ("unit: degC", "unit: furlong", ["is not a unit of source_temperature"]),
        ("temperature_k: 1700", "temprature_k: 1700", ["temperature_k is missing", "did you mean"]),
        ("origin: synthetic", "origin: invented", ["origin must be one of"]),
        ("S2}", "S1}", ["stands 2 times"]),
    ],
)
def test_a_bad_calibration_folder_is_named(tmp_path, capsys, old, new, messages):
    place = laboratory.calibration_folder(tmp_path / "raw")
    described = place / "calibration.yaml"
    if new == "S1}":
        (place / "points.csv").write_text((place / "points.csv").read_text().replace("S2", "S1"))
    assert old in described.read_text()
    described.write_text(described.read_text().replace(old, new, 1))
    for words in (["check", str(place)], ["calibrate", str(place), "--out", str(tmp_path / "lab")]):
        assert cli.main(words) == 2
        said = capsys.readouterr().err
        assert all(message in said for message in messages), said
    assert not (tmp_path / "lab").exists()


def test_counts_linearised_twice_are_refused(shelf, tmp_path, capsys):
    test = laboratory.made(pyrometer=False)
    test.attrs["counts_linearised"] = 1
    io.write(test, tmp_path / "test.nc", "test")
    words = ["correct", str(tmp_path / "test.nc"), "--instrument", str(shelf / "lab")]
    assert cli.main([*words, "--out", str(tmp_path / "t.nc")]) == 2
    assert "linearised already" in capsys.readouterr().err


def test_defaults_are_those_of_the_main_job():
    config = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())
    options = vars(cli.parser().parse_args(["correct", "t", "--instrument", "i", "--out", "o"]))
    pyrometer, spectrometer = (config["experiment"][name] for name in ("pyrometer", "spectrometer"))
    for name in ("signal_uncertainty", "gas_variation", "detection_level", "least_surface_share", "seed"):
        assert options[name] == pyrometer[name]
    for name in ("gas_variation", "saturation_counts", "least_signal_to_noise", "noise_block_pixels"):
        assert options[name] == spectrometer[name]
    assert options["temperature_range_k"] == spectrometer["temperature_range_k"]
    assert options["normalisation_nm"] is None
    assert pytest.approx(1e9 * PIVOT) == spectrometer["normalisation_wavelength_nm"]
    words = ["diagnose", "t", "--radiance", "r", "--instrument", "i", "--out", "o"]
    assert vars(cli.parser().parse_args(words))["saturation_counts"] == spectrometer["saturation_counts"]
    assert {name: pyrometer[name] for name in LIMITS} == LIMITS
    scale = {"um": 1e-6, "nm": 1e-9, "s": 1.0, "k": 1.0}
    for key, value in config["experiment"]["joint_estimate"].items():
        name, _, unit = key.rpartition("_")
        found = joint.SETTINGS.get(key, joint.SETTINGS.get(name, options.get(key)))
        assert found == pytest.approx(
            value * (1 if key in (*joint.SETTINGS, *options) else scale[unit]), abs=0
        )
    response = {k: v for k, v in config["instrument"]["response"].items() if k != "silicon_table"}
    for key, value in response.items():
        name, unit = key.rsplit("_", 1)
        assert calibrate.RESPONSE[name] == pytest.approx(value * scale[unit], rel=1e-12)
    options = vars(cli.parser().parse_args(["calibrate", "f", "--out", "o"]))
    for name in ("source_temperature_uncertainty_k", "signal_uncertainty", "instrument_range_k"):
        assert options[name] == config["instrument"]["calibration"][name]
    for name in ("saturation_counts", "least_net_counts"):
        assert options[name] == config["instrument"]["spectrometer"][name]
