"""Series of Andor's program, and an emittance over wavelength, in folders of our own making."""

import json
import re
import shutil

import numpy as np
import pytest

from plasmapyro import cli, io
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.readers.andor import read_series
from plasmapyro.readers.guess import describe
from plasmapyro.readers.stage import check_test, read_test
from plasmapyro.readers.text import Refusal
from plasmapyro.refraction import vacuum_wavelength

AIR = np.linspace(520.0, 990.0, 300)  # [nm]
VACUUM = vacuum_wavelength(AIR * 1e-9)
TABLE = [[500, 0.60], [650, 0.52], [800, 0.38], [1000, 0.27]]
HEADER = "Date and Time:  Mon Nov 21 20:41:16.000 2022\nData Type:  Counts\nExposure Time (secs):  {}\n"
HEADER += "Kinetic Cycle Time (secs):  {}\nNumber in Kinetics Series:  {}\n\n"
CALIBRATION = f"""origin: synthetic
spectrometer:
  format: andor
  source: {{temperature_k: 1173.15, temperature_uncertainty_k: 1, emittance: {TABLE}}}
  exposures:
    - {{light: hot.asc, baseline: dark.asc}}
"""
WHITE = 0.04  # of the brightest pixel
TEST = """attributes:
  condition: none
  origin: synthetic
  spectrometer_fwhm: 5e-9
  emittance: {}
  emittance_uncertainty: 0.04
spectrometer:
  file: light.asc
  format: andor
  quantity: counts
  background: dark.asc
"""


def series(path, light, exposure, frames=6, seed=0):
    """Write an export: baseline of 297 counts, shot and read noise."""
    random = np.random.default_rng(seed)
    counts = (
        297 + light * exposure + random.standard_normal((frames, AIR.size)) * np.sqrt(9 + light * exposure)
    )
    rows = [
        ",".join([f"{w:.5f}", *(f"{c:.0f}" for c in column), ""])
        for w, column in zip(AIR, np.minimum(counts, 65535).T, strict=True)
    ]
    path.write_text(HEADER.format(exposure, exposure, frames) + "\n".join(rows) + "\n")


def emissivity():
    points, values = np.array(TABLE).T
    return np.exp(np.interp(VACUUM, points * 1e-9, np.log(values)))


def furnace(kelvin):
    """Count rate of the sample: some thousand counts in 0.1 s at 1173 K."""
    body = emissivity() * blackbody_radiance(VACUUM, kelvin)
    return 6e4 * body / (emissivity() * blackbody_radiance(VACUUM, 1173.15)).max()


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    place = tmp_path_factory.mktemp("furnace")
    for name in ("calibration", "test"):
        (place / name).mkdir()
        series(place / name / "dark.asc", 0 * AIR, 1.0, seed=1)
    (place / "calibration/calibration.yaml").write_text(CALIBRATION)
    series(place / "calibration/hot.asc", furnace(1173.15), 0.1, seed=2)
    (place / "test/test.yaml").write_text(TEST.format(TABLE))
    series(place / "test/light.asc", furnace(973.15), 1.0, seed=3)
    assert cli.main(["calibrate", str(place / "calibration"), "--out", str(place / "lab")]) == 0
    return place


def correct(place, out):
    words = ["correct", place / "test", "--instrument", place / "lab", "--out", out]
    return cli.main([str(word) for word in words])


def diagnosed(place, out):
    words = ["diagnose", place / "test", "--instrument", place / "lab", "--out", out]
    assert cli.main([str(word) for word in words]) == 0
    report = json.loads((out / "diagnosis.json").read_text())
    return report["verdict"], io.read(out / "temperature.nc", "diagnosis_temperature")


def test_a_furnace_gives_temperature_and_emissivity(place, tmp_path, capsys):
    assert check_test(place / "test") == []
    assert cli.main(["check", str(place / "test"), "--instrument", str(place / "lab")]) == 0
    assert correct(place, tmp_path / "t.nc") == 0
    found = io.read(tmp_path / "t.nc", "emissivity_estimate")
    assert (found.spectral_status == 0).all()
    off = found.spectral_temperature.values - 973.15
    # What the light leaves open, some 3 K, the prior closes at the truth; 2 K: shot noise of 20 counts.
    assert np.abs(off).max() < 2.0 and (found.spectral_temperature_uncertainty < 8).all()
    expected = np.interp(found.emissivity_wavelength, VACUUM, emissivity())
    low, high = found.emissivity_interval.values
    assert ((low < expected) & (high > expected)).all()
    said = capsys.readouterr().out
    assert "gives the same light: what is stated of the emissivity decides" in said


def test_faint_light_of_the_room_asks_for_an_impossible_emissivity(place, tmp_path, capsys):
    """White light of a lamp, 4 % of that of the surface: no line, and a free course takes its colour up."""
    kept = (place / "test/light.asc").read_text()
    lamp = blackbody_radiance(VACUUM, 2800.0) / blackbody_radiance(VACUUM, 2800.0).max()
    series(place / "test/light.asc", furnace(973.15) + WHITE * furnace(973.15).max() * lamp, 1.0, seed=3)
    assert correct(place, tmp_path / "t.nc") == 0
    _, temperature = diagnosed(place, tmp_path / "out")
    (place / "test/light.asc").write_text(kept)
    found = io.read(tmp_path / "t.nc", "emissivity_estimate")
    assert (found.spectral_status == 9).all() and np.isnan(found.spectral_temperature).all()
    assert "of its stated uncertainties off at" in capsys.readouterr().err
    assert (temperature.recommended_status == 9).all() and temperature.attrs["recommended"] == "none"


def test_fainter_light_of_the_room_is_said_and_taken_out(place, tmp_path, capsys):
    """40 counts of a diode's phosphor: no impossible emissivity, but 18 K where 7 K are stated."""
    kept = (place / "test/light.asc").read_text()
    lamp = 40 * np.exp(-(((AIR - 560) / 60) ** 2))
    series(place / "test/light.asc", furnace(973.15) + lamp, 1.0, seed=3)
    assert correct(place, tmp_path / "t.nc") == 0
    verdict, temperature = diagnosed(place, tmp_path / "out")
    (place / "test/light.asc").write_text(kept)
    assert "which holds light like that of a white diode in the view" in verdict["sentences"][0]
    np.testing.assert_allclose(temperature.recommended_temperature, 973.15, atol=5.0)
    found = io.read(tmp_path / "t.nc", "emissivity_estimate")
    assert (found.spectral_status == 0).all() and abs(found.attrs["lamp_cost"]) > 5.0
    assert np.abs(found.spectral_temperature - 973.15).max() < 5.0
    assert "other light, most like that of a white diode" in capsys.readouterr().err


@pytest.fixture
def under_a_lamp(place, tmp_path):
    """Corrects the test with a lamp's light of some width [nm] on it."""
    kept = (place / "test/light.asc").read_text()

    def corrected(width):
        light = furnace(973.15) + 3e3 * np.exp(-(((AIR - 611) / width) ** 2))
        series(place / "test/light.asc", light, 1.0, seed=3)
        assert correct(place, tmp_path / "t.nc") == 0
        return io.read(tmp_path / "t.nc", "emissivity_estimate")

    yield corrected
    (place / "test/light.asc").write_text(kept)


def test_light_of_a_lamp_in_the_room_is_no_temperature(under_a_lamp, capsys):
    found = under_a_lamp(30)
    assert (found.spectral_status == 9).all() and np.isnan(found.spectral_temperature).all()
    words = capsys.readouterr().err
    assert (
        "are not the light of a hot surface" in words and "more light (as bright as a black body of" in words
    )


def test_a_line_of_a_lamp_is_said_and_left_out(under_a_lamp, capsys):
    found = under_a_lamp(3)  # as narrow as the slit
    assert "narrow light at 61" in capsys.readouterr().err
    assert (found.spectral_status == 0).all()
    assert np.abs(found.spectral_temperature - 973.15).max() < 2.0


def test_several_series_lie_on_the_clock_of_their_headers(place, tmp_path):
    folder = tmp_path / "day"
    (folder / "spectrometer").mkdir(parents=True)
    facts = (place / "test/test.yaml").read_text()
    (folder / "test.yaml").write_text(facts.replace("file: light.asc", "folder: spectrometer"))
    (folder / "dark.asc").write_text((place / "test/dark.asc").read_text())
    for name, clock in (("a", "20:43:16"), ("b", "20:41:16")):  # in time, not by name
        path = folder / "spectrometer" / f"{name}.asc"
        series(path, furnace(973.15), 1.0, seed=3)
        path.write_text(path.read_text().replace("20:41:16", clock))
    test = read_test(folder)
    np.testing.assert_allclose(test.spectrum_time, np.r_[0.5 + np.arange(6.0), 120.5 + np.arange(6.0)])


DAY = {
    873.15: ("20:41:16", 1.0),
    973.15: ("20:43:36", 1.0),
    1073.15: ("20:47:01", 1.0),
    1223.15: ("20:49:16", 0.1),
}
SLIT = 10.0  # [nm] standard deviation: another temperature moves the edges of the response by per cents
CROWD = 6.0  # [K]: 0.5 % of a bin's error at another temperature, and what the prior leaves open


def side_by_side(place, lab, temperatures):
    """A folder with series at several temperatures, and the calibration, all seen through a slit."""
    kernel = np.exp(-(((AIR[:, None] - AIR) / SLIT) ** 2) / 2)
    through = lambda light: kernel @ light / kernel.sum(axis=1)  # noqa: E731
    for name in ("calibration", "test", "test/spectra"):
        (lab / name).mkdir()
    for name in ("calibration", "test"):
        (lab / name / "dark.asc").write_text((place / "test/dark.asc").read_text())
    (lab / "calibration/calibration.yaml").write_text(CALIBRATION)
    series(lab / "calibration/hot.asc", through(furnace(1173.15)), 0.1, seed=2)
    facts = TEST.format(TABLE).replace("file: light.asc", "folder: spectra").replace("5e-9", "24e-9")
    (lab / "test/test.yaml").write_text(facts)
    for kelvin in temperatures:
        clock, exposure = DAY[kelvin]
        path = lab / "test/spectra" / f"{kelvin:.0f}.asc"
        series(path, through(furnace(kelvin)), exposure, seed=int(kelvin))
        path.write_text(path.read_text().replace("20:41:16", clock))
    assert cli.main(["calibrate", str(lab / "calibration"), "--out", str(lab / "lab")]) == 0
    return [str(lab / "test"), "--instrument", str(lab / "lab"), "--out"]


def test_temperatures_side_by_side_come_out_each_by_itself(place, tmp_path):
    words = side_by_side(place, tmp_path, DAY)
    assert cli.main(["correct", *words, str(tmp_path / "t.nc")]) == 0
    found = io.read(tmp_path / "t.nc", "emissivity_estimate")
    off = found.spectral_temperature.values - np.repeat(list(DAY), 6)
    assert np.abs(off).max() < CROWD
    low, high = found.spectral_temperature_interval.values - found.spectral_temperature.values
    assert ((low < -off) & (-off < high)).all()
    # One exposure for all: what the series of 1 s lost of their digits is less than their noise.
    assert read_test(tmp_path / "test").attrs["spectrometer_integration_time"] == 0.1


def test_nothing_is_wrong_with_temperatures_side_by_side(place, tmp_path):
    words = side_by_side(place, tmp_path, list(DAY)[:3])
    assert cli.main(["diagnose", *words, str(tmp_path / "out")]) == 0
    found = json.loads((tmp_path / "out/diagnosis.json").read_text())
    assert found["verdict"]["status"] == "null"
    history = found["posterior"]["temperature"]
    off = np.array(history["value"]) - np.repeat(list(DAY)[:3], 6)
    assert np.all(np.abs(off) < 1.96 * np.array(history["sigma"]))
    assert max(history["sigma"]) < 10.0  # the pauses, in which nothing is seen, are no part of the history


def test_other_exposures_need_a_dark(place, tmp_path):
    side_by_side(place, tmp_path, list(DAY)[2:])
    path = tmp_path / "test/test.yaml"
    path.write_text(path.read_text().replace("  background: dark.asc\n", ""))
    assert "other exposure than" in "\n".join(check_test(tmp_path / "test"))


def test_frames_have_their_times_and_the_table_its_wavelengths(place):
    test = read_test(place / "test")
    np.testing.assert_allclose(test.spectrum_time, 0.5 + np.arange(6.0))
    assert test.attrs["spectrometer_integration_time"] == 1.0
    np.testing.assert_allclose(test.attrs["emittance_table"], [0.60, 0.52, 0.38, 0.27])
    np.testing.assert_allclose(test.attrs["emittance_wavelength"], [5e-7, 6.5e-7, 8e-7, 1e-6])


def test_a_single_frame_has_a_temperature_and_a_page(place, tmp_path):
    (tmp_path / "test").mkdir()
    series(tmp_path / "test/light.asc", furnace(973.15), 1.0, frames=1, seed=4)
    for name in ("dark.asc", "test.yaml"):
        shutil.copy(place / "test" / name, tmp_path / "test")
    words = ["correct", str(tmp_path / "test"), "--instrument", str(place / "lab"), "--out"]
    assert cli.main([*words, str(tmp_path / "t.nc")]) == 0
    found = io.read(tmp_path / "t.nc", "emissivity_estimate").spectral_temperature.values
    assert found == pytest.approx([973.15], abs=5)


def test_the_header_may_stand_below_the_table(place, tmp_path):
    header, _, rows = (place / "test/light.asc").read_text().partition("\n\n")
    (tmp_path / "kin.asc").write_text(f"{rows}\n\n{header}\n")
    found, known = read_series(tmp_path / "kin.asc"), read_series(place / "test/light.asc")
    for name in found._fields:
        np.testing.assert_array_equal(getattr(found, name), getattr(known, name))
    assert "format: andor" in describe(tmp_path).text


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("secs):  1.0\nKin", "secs):  -1\nKin", "no number > 0"),
        ("520.00000,", "620.00000,", "no scale of wavelengths"),
        ("\n990.00000,", "\n990.00000,3x,", "line 306: is no row of as many numbers"),
        ("\n990.00000,", "\n990.00000,3,", "no row of as many numbers"),
    ],
)
def test_a_damaged_series_is_refused(place, tmp_path, old, new, words):
    text = (place / "test/light.asc").read_text()
    assert old in text
    (tmp_path / "x.asc").write_text(text.replace(old, new, 1))
    with pytest.raises(Refusal, match=words):
        read_series(tmp_path / "x.asc")


def test_an_exposure_that_no_header_tells_is_stated(place, tmp_path):
    for name in ("light.asc", "dark.asc"):
        text = (place / "test" / name).read_text()
        (tmp_path / name).write_text(text.replace("Exposure Time", "Exposed"))
    facts = (place / "test/test.yaml").read_text()
    (tmp_path / "test.yaml").write_text(facts)
    assert "headers of the spectra do not tell it: state it" in "\n".join(check_test(tmp_path))
    (tmp_path / "test.yaml").write_text(
        facts.replace("ibutes:", "ibutes:\n  spectrometer_integration_time: 1.0")
    )
    assert check_test(tmp_path) == []
    np.testing.assert_array_equal(read_test(tmp_path).counts, read_test(place / "test").counts)
    neither = (tmp_path / "light.asc").read_text().replace("Kinetic Cycle Time", "Cycle")
    (tmp_path / "light.asc").write_text(neither)
    with pytest.raises(Refusal, match="states no exposure time"):
        read_series(tmp_path / "light.asc")


@pytest.mark.parametrize(
    "wrong",
    [
        "[[800, 0.4]]",
        "[[800, 0.4], [700, 0.5]]",
        "[[700, 0.4], [800, 1.5]]",
        "[1, 2]",
        "[[0.7, 0.4], [0.8, 0.3]]",
    ],
)
def test_a_table_of_emittance_that_means_nothing_is_refused(place, tmp_path, wrong):
    for name in ("light.asc", "dark.asc"):
        (tmp_path / name).write_text((place / "test" / name).read_text())
    (tmp_path / "test.yaml").write_text(TEST.format(wrong))
    assert "attributes.emittance must" in "\n".join(check_test(tmp_path))


def test_what_a_longer_exposure_saturates_is_not_scaled_out_of_sight(place, tmp_path):
    """Beyond the 65 000 of the commands, and at no plateau: ten times less it would pass for light."""
    side_by_side(place, tmp_path, list(DAY)[:2])
    folder = tmp_path / "test/spectra"
    first, second = sorted(folder.iterdir())
    header, _, rows = first.read_text().partition("\n\n")
    header = header.replace("(secs):  1.0", "(secs):  10.0").replace("(secs):  0.1", "(secs):  1.0")
    table = [row.split(",") for row in rows.splitlines()]
    table[40][1:7] = [f"{65100 + k}" for k in range(6)]
    first.write_text(header + "\n\n" + "\n".join(map(",".join, table)) + "\n")
    test = read_test(tmp_path / "test")
    assert test.attrs["exposures_joined"] == 1
    lost = np.isnan(test.counts.values)
    assert lost.sum() == 6 and lost[:, 40].sum() == 6


@pytest.mark.parametrize(
    ("exposure", "words"),
    [(2000, "all are saturated: take it again"), (200, r"no usable pixel; 2\d\d pixels are saturated")],
    ids=["all", "all but a few"],
)
def test_spectra_beyond_the_converter_are_said_to_be_saturated(place, tmp_path, capsys, exposure, words):
    shutil.copytree(place / "test", tmp_path / "test")
    series(tmp_path / "test/light.asc", furnace(1173.15), exposure)
    given = ["correct", tmp_path / "test", "--instrument", place / "lab", "--out", tmp_path / "t.nc"]
    assert cli.main([str(word) for word in given]) == 2
    assert re.search(words, capsys.readouterr().err)


def test_several_exposures_before_a_bent_scale_are_refused(place, tmp_path, capsys):
    words = side_by_side(place, tmp_path, DAY)
    path = tmp_path / "lab/spectrometer_calibration.nc"
    calibration = io.read(path, "spectrometer_calibration")
    bent = calibration.drop_dims("linearity_power").assign(
        linearity_coefficient=("linearity_power", [1.0, 1e-7])
    )
    io.write(bent, path, "spectrometer_calibration")
    assert cli.main(["correct", *words, str(tmp_path / "t.nc")]) == 2
    assert "several exposures" in capsys.readouterr().err and not (tmp_path / "t.nc").exists()
