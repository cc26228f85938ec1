"""Limits at which readers take a sample for lost, and switches of what is done to it."""

from datetime import datetime, timedelta

import numpy as np
import pytest
import samples

from plasmapyro.readers import ocean
from plasmapyro.readers.calibration import read_exposures
from plasmapyro.readers.stage import check_test, read_test
from plasmapyro.refraction import vacuum_wavelength

WITHOUT_PYROMETER = samples.SPECTRA


def folder(tmp_path, parts=WITHOUT_PYROMETER, number=3):
    return samples.spectra(samples.folder(tmp_path / "t", parts), "spectrasuite", number)


def test_counts_from_the_stated_saturation_on_are_lost(tmp_path):
    place = folder(tmp_path, WITHOUT_PYROMETER + f"  saturation_counts: {samples.COUNTS[12]:g}\n")
    test = read_test(place)
    assert np.isnan(test.counts.values[0]).tolist() == [False] * 12 + [True] * 12
    assert test.saturated.values[0].tolist() == [0] * 12 + [1] * 12
    assert test.attrs["clipped_samples"] == int(np.isnan(test.counts.values).sum())


def test_a_plateau_has_five_pixels_and_more_than_4096_counts():
    for length, level, lost in ((5, 4097.0, 5), (4, 4097.0, 0), (5, 4096.0, 0), (6, 60000.0, 6)):
        counts = np.full(20, 3000.0) + np.arange(20) % 3
        counts[7 : 7 + length] = level
        assert ocean.clipped(counts).sum() == lost


def test_times_by_order_are_first_and_period(tmp_path):
    parts = WITHOUT_PYROMETER.replace("first: 0.5, period: 1.0", "first: -0.25, period: 2.5")
    np.testing.assert_allclose(read_test(folder(tmp_path, parts)).spectrum_time, [-0.25, 2.25, 4.75])


@pytest.mark.parametrize(("marks", "shift"), [("begin", 0.6), ("middle", 0.0), ("end", -0.6)])
def test_dates_mark_begin_middle_or_end_of_an_exposure_of_two_averages(tmp_path, marks, shift):
    parts = WITHOUT_PYROMETER.replace(
        "{from: order, first: 0.5, period: 1.0}",
        f'{{from: date, zero: "2013-02-13 09:53:30", marks: {marks}}}',
    )
    np.testing.assert_allclose(
        read_test(folder(tmp_path, parts)).spectrum_time, 10 + 2 * np.arange(3) + shift
    )


def test_a_dark_may_be_averaged_more_often_than_its_spectra_not_less(tmp_path):
    place = folder(tmp_path)
    twice = read_test(place)
    dark = place / "dark.txt"
    words = dark.read_bytes()
    dark.write_bytes(words.replace(b"Averaged: 2", b"Averaged: 20"))
    np.testing.assert_array_equal(read_test(place).background_counts, twice.background_counts)
    dark.write_bytes(words.replace(b"Averaged: 2", b"Averaged: 1"))
    assert any("averages 1, but 2 in frame_0000.txt" in words for words in check_test(place))


def test_a_tunnel_file_is_asked_for_at_the_times_of_the_pyrometer_only(tmp_path):
    parts = samples.CSV + "tunnel:\n  zero: 1.0\n  columns:\n    time: {name: t, unit: s}\n"
    parts += "    mass_flow_rate: {name: m, unit: g/min, scale: 2}\n"
    test = read_test(
        samples.folder(
            tmp_path / "t", parts, pyrometer__csv=samples.table(), tunnel__csv="t,m\n1,60\n5,180\n"
        )
    )
    # 60 g/min twice are 2 g/s; the zero of the tunnel is one second later.
    np.testing.assert_allclose(test.mass_flow_rate[:5], [0.002, 0.003, 0.004, 0.005, 0.006], rtol=1e-12)
    assert np.isnan(test.mass_flow_rate[5:]).all()
    late = read_test(
        samples.folder(
            tmp_path / "late", parts, pyrometer__csv=samples.table(), tunnel__csv="t,m\n3,60\n9,180\n"
        )
    )
    assert np.isnan(late.mass_flow_rate[:2]).all() and late.mass_flow_rate[2] == pytest.approx(0.002)


def test_a_table_of_spectra_is_sorted_by_wavelength_and_its_dark_averaged(tmp_path):
    place = samples.folder(
        tmp_path / "t",
        "spectrometer:\n  file: s.csv\n  quantity: counts\n  unit: count\n  background: d.csv\n"
        "  time_unit: ms\n  zero: 1.5\n",
        s__csv="t,802,800\n2000,12,10\n3000,22,20\n",
        d__csv="t,802,800\n0,3,1\n1,5,3\n",
    )
    text = (place / "test.yaml").read_text()
    (place / "test.yaml").write_text(
        text.replace("  spectrometer_fwhm", "  spectrometer_integration_time: 0.5\n  spectrometer_fwhm")
    )
    assert check_test(place) == []
    test = read_test(place)
    np.testing.assert_allclose(test.spectrum_time, [0.5, 1.5])
    np.testing.assert_allclose(test.wavelength, vacuum_wavelength(np.array([800e-9, 802e-9])), rtol=1e-12)
    np.testing.assert_array_equal(test.counts, [[10, 12], [20, 22]])
    np.testing.assert_array_equal(test.background_counts, [2, 4])


def test_a_file_that_begins_when_the_last_one_ends_is_named(tmp_path):
    described = samples.CSV.replace("pyrometer:\n", "pyrometer:\n  file: [a.csv, b.csv]\n")
    files = {"a__csv": "t,S1,S2\n0,1,1\n1,2,2\n", "b__csv": "t,S1,S2\n1,2,2\n2,3,3\n"}
    (message,) = check_test(samples.folder(tmp_path / "t", described, **files))
    assert "b.csv: begins at 1 s, when a.csv ends at 1 s" in message


@pytest.mark.parametrize(("stated", "limit"), [(60000.0, 50000.0), (40000.0, 40000.0), (None, 50000.0)])
def test_a_plateau_of_a_source_is_the_limit_unless_a_lower_one_is_stated(tmp_path, stated, limit):
    counts = samples.COUNTS.copy()
    counts[8:15] = 50000.0
    (tmp_path / "light.txt").write_bytes(samples.spectrum("spectrasuite", counts))
    (tmp_path / "dark.txt").write_bytes(samples.spectrum("spectrasuite", samples.DARK))
    words = "" if stated is None else f"  saturation_counts: {stated:g}\n"
    (tmp_path / "calibration.yaml").write_text(
        "origin: synthetic\nspectrometer:\n  source: {temperature_k: 1500, temperature_uncertainty_k: 2}\n"
        "  exposures: [{light: light.txt, dark: dark.txt}]\n" + words
    )
    assert read_exposures(tmp_path).attrs["saturation_counts"] == limit


@pytest.mark.parametrize(
    "parts", [WITHOUT_PYROMETER, WITHOUT_PYROMETER.replace("  background: dark.txt\n", "")]
)
def test_a_spectrum_that_is_a_link_to_itself_is_refused(tmp_path, parts):
    place = folder(tmp_path, parts)
    (place / "spectrometer" / "frame_0009.txt").symlink_to("frame_0009.txt")
    found = "\n".join(check_test(place))
    assert "frame_0009.txt" in found


NAMED = {
    "seconds": ("{time:g}s.txt", "name: '*s.txt'", (0.5, 2.25, 10.5)),
    "counter and comma": ("{place}_t{time:.2f}.txt", "name: '#_t*.txt'", (-1.5, 0.25, 2.0)),
    "milliseconds": ("s{ms:.0f}.txt", "name: 's*.txt', unit: ms, zero: '500'", (0.0, 1.25, 9.5)),
    "a date": (
        "spec_{date:%Y%m%d-%H%M%S.%f}.txt",
        "name: 'spec_*.txt', format: '%Y%m%d-%H%M%S', zero: '20260502-095959.5'",
        (0.5, 1.75, 61.0),
    ),
}


@pytest.mark.parametrize("habit", NAMED)
@pytest.mark.parametrize(("marks", "shift"), [("begin", 0.6), ("end", -0.6)])
def test_times_stand_in_the_names_of_files(tmp_path, habit, marks, shift):
    name, stated, times = NAMED[habit]
    words = f"{{from: name, {stated}, marks: {marks}}}"
    place = folder(tmp_path, WITHOUT_PYROMETER.replace("{from: order, first: 0.5, period: 1.0}", words))
    for number, (path, time) in enumerate(
        zip(sorted((place / "spectrometer").iterdir()), times, strict=True)
    ):
        date = datetime(2026, 5, 2, 9, 59, 59, 500_000) + timedelta(seconds=time)
        new = name.format(time=time, ms=1000 * time + 500, date=date, place=9 - number)
        path.rename(path.with_name(new.replace(".", ",", 1) if "comma" in habit else new))
    np.testing.assert_allclose(read_test(place).spectrum_time, np.array(times) + shift, atol=1e-6)


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ("name: 'x*.txt', marks: end", "no time in the name as 'x*.txt' and `format` or `unit` say"),
        ("name: 's.txt', marks: end", "must hold one * for the time"),
        ("name: '*.txt'", "marks"),
        ("name: '*.txt', marks: end, unit: furlong", "is not a unit of time"),
        ("name: '*.txt', marks: end, format: '%H:%M:%S'", "zero"),
        (
            "name: '*.txt', marks: end, format: '%H:%M:%S', zero: noon",
            "is not read as the times in the names",
        ),
    ],
)
def test_what_a_name_does_not_tell_is_asked(tmp_path, stated, words):
    changed = WITHOUT_PYROMETER.replace("{from: order, first: 0.5, period: 1.0}", f"{{from: name, {stated}}}")
    assert words in " ".join(check_test(folder(tmp_path, changed)))
