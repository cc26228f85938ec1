"""Records without a plasma, and options that mean nothing."""

import shutil

import laboratory
import numpy as np
import pytest

from plasmapyro import cli, io
from plasmapyro.readers.stage import check_test
from plasmapyro.record import onset

LAMP = """attributes:
  condition: none
  origin: synthetic
  pyrometer_integration_time: 0.01
  spectrometer_fwhm: 4e-9
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A calibration, raw and made, and a furnace of 1500 K as raw files of a test without plasma."""
    place = tmp_path_factory.mktemp("lamp")
    laboratory.calibration_folder(place / "calibration")
    assert cli.main(["calibrate", str(place / "calibration"), "--out", str(place / "lab")]) == 0
    lamp = laboratory.test_folder(place / "lamp")
    described = (lamp / "test.yaml").read_text()
    (lamp / "test.yaml").write_text(LAMP + described[described.index("\npyrometer:") + 1 :])
    wide, narrow = laboratory.signals(1500.0) * 1e9
    rows = "".join(f"{i / 4};{wide:.4f};{narrow:.4f}\n" for i in range(80))
    (lamp / "pyrometer.csv").write_text("Time [s];S1 [nA];S2 [nA]\n" + rows)
    light = laboratory.blackbody_radiance(laboratory.WAVELENGTH, 1500.0)
    for index, path in enumerate(sorted((lamp / "spectrometer").iterdir())):
        path.write_text(laboratory.spectrum(laboratory.raw(light, 0.5, index), 0.5))
    return place


def correct(place, out, *more):
    words = ["correct", place / "lamp", "--instrument", place / "lab", "--out", out, "--draws", 20, *more]
    return cli.main([str(word) for word in words])


def test_a_furnace_is_read_without_window_injection_and_emittance(place, tmp_path, capsys):
    assert check_test(place / "lamp") == []
    assert correct(place, tmp_path / "t.nc") == 0
    found = io.read(tmp_path / "t.nc", "correction")
    assert (found.corrected_status == 0).all() and (found.spectrum_status == 0).all()
    # 2 K: the quadratic curve of the pyrometer; 1 K: noise of one count.
    np.testing.assert_allclose(found.corrected_temperature, 1500.0, atol=2.0)
    np.testing.assert_allclose(found.scaled_temperature, 1500.0, atol=1.0)
    np.testing.assert_allclose(found.apparent_emittance, 1.0, atol=0.01)
    assert not found.reference_radiance.any() and not found.reference_signal.any()
    assert cli.main(["check", str(place / "lamp")]) == 0
    assert "no plasma: nothing is subtracted" in capsys.readouterr().out


def test_the_joint_estimate_needs_a_plasma(place, tmp_path, capsys):
    assert correct(place, tmp_path / "t.nc", "--estimator", "joint") == 2
    assert "follows the light of a plasma" in capsys.readouterr().err


def test_only_a_record_without_condition_may_lack_the_window(place, tmp_path):
    described = (place / "lamp" / "test.yaml").read_text()
    try:
        (place / "lamp" / "test.yaml").write_text(described.replace("condition: none", "condition: 90kW"))
        found = "\n".join(check_test(place / "lamp"))
    finally:
        (place / "lamp" / "test.yaml").write_text(described)
    for name in ("injection_time", "plasma_off_time", "emittance", "reference_window"):
        assert f"attribute {name}: m" in found


def test_a_spectrometer_that_does_not_reach_the_pivot_takes_another_and_says_so(
    place, tmp_path, capsys, caplog
):
    lab = tmp_path / "lab"
    words = ["calibrate", str(place / "calibration"), "--out", str(lab), "--fit-range-nm", "800", "950"]
    assert cli.main(words) == 0
    pixels = io.read(lab / "spectrometer_calibration.nc", "spectrometer_calibration")
    inside = (pixels.wavelength.values > 800e-9) & (pixels.wavelength.values < 950e-9)
    np.testing.assert_array_equal(pixels.pixel_status == 0, inside)
    assert (pixels.pixel_status.values[~inside] >= 5).all()  # masked, or left out
    assert correct(place, tmp_path / "t.nc", "--instrument", lab, "--normalisation-nm", 1030) == 2
    said = capsys.readouterr().err
    assert (
        "no usable pixel within 2 nm" in said
        and "usable are 800.96 to 949.46 nm" in said
        and "--normalisation-nm" in said
    )
    for own in ((), ("--normalisation-nm", 900)):
        assert correct(place, tmp_path / "t.nc", "--instrument", lab, *own) == 0
        found = io.read(tmp_path / "t.nc", "correction")
        np.testing.assert_allclose(found.spectrometer_temperature, 1500.0, atol=5.0)
        assert 800e-9 < found.attrs["normalisation_wavelength"] < 950e-9
        assert ("no usable pixel at 1030 nm" in caplog.text) == (not own)
        caplog.clear()


SENSELESS = (
    ("--saturation-counts", "nan"),
    ("--saturation-counts", "inf"),
    ("--saturation-counts", "0"),
    ("--least-net-counts", "-1e9"),
    ("--least-net-counts", "nan"),
    ("--signal-uncertainty", "-0.01"),
    ("--signal-uncertainty", "1.01"),
    ("--signal-uncertainty", "nan"),
    ("--source-temperature-uncertainty-k", "inf"),
    ("--source-temperature-uncertainty-k", "-3"),
    ("--instrument-range-k", "2073", "973"),
    ("--instrument-range-k", "973", "nan"),
    ("--instrument-range-k", "-973", "2073"),
    ("--fit-range-nm", "950", "800"),
    ("--fit-range-nm", "0", "800"),
)


@pytest.mark.parametrize("words", SENSELESS, ids=" ".join)
def test_calibrate_refuses_options_that_mean_nothing(place, tmp_path, capsys, words):
    try:
        status = cli.main(["calibrate", str(place / "calibration"), "--out", str(tmp_path / "lab"), *words])
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert words[0] in capsys.readouterr().err
    assert not (tmp_path / "lab").exists()


def test_a_calibration_of_a_falling_range_is_refused(place, tmp_path, capsys):
    shutil.copytree(place / "lab", tmp_path / "lab")
    path = tmp_path / "lab" / "calibration.nc"
    wrong = io.read(path, "calibration").load()
    wrong["instrument_range"] = ("bound", wrong.instrument_range.values[::-1].copy())
    path.unlink()
    io.write(wrong, path, "calibration")
    assert correct(place, tmp_path / "t.nc", "--instrument", tmp_path / "lab") == 2
    assert "instrument_range must be two rising temperatures [K]; got 2073, 973" in capsys.readouterr().err


def test_what_a_fast_logger_sees_in_the_window_may_be_harmless():
    time = np.arange(0, 5, 1e-3)
    noise = 1e-4 * np.random.default_rng(4).standard_normal((2, time.size))
    for height, word in ((3e-4, onset.HARMLESS), (1e-2, onset.SHOWS)):
        growth = height * (time / 5) ** 3
        signals = np.array([[1.0], [0.5]]) * (1 + np.stack([growth, growth / 2]) + noise)
        found = onset.attributes("seen", time, signals, (0.0, 5.0), 5.0)
        assert found["seen_reference_verdict"] == word
        # The mean of the growth over the window is a fourth of it.
        assert found["seen_reference_bias"][0] == pytest.approx(height / 4, rel=0.1)


def test_signals_of_zero_have_no_trend():
    assert onset.trend(np.arange(9.0), np.zeros(9), (0.0, 8.0)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("path", "density", "rule"), [(3e-4, 1.0, "path_length"), (0.1, 1e-6, "ideal_gas")])
def test_radiance_says_a_sight_line_that_no_tunnel_has(tmp_path, capsys, monkeypatch, path, density, rule):
    from plasmapyro.commands import radiance
    from plasmapyro.sightline.stage import equilibrium_sightline

    distance = np.linspace(0.0, path, 30)
    line = equilibrium_sightline(distance, np.full(30, 6000.0), np.full(30, 5000.0))
    line["number_density"] = line.number_density * density
    io.write(line, tmp_path / "line.nc", "sightline")

    def stop(*_, **__):
        raise ValueError("far enough")

    monkeypatch.setattr(radiance, "line_of_sight_radiance", stop)
    assert cli.main(["radiance", str(tmp_path / "line.nc"), "--out", str(tmp_path / "r.nc")]) == 2
    said = capsys.readouterr().err
    assert (
        f"line.nc: the {'path' if rule == 'path_length' else 'number densities'}" in said
        and f"[{rule}]" in said
    )
