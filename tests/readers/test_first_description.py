"""`plasmapyro init` describes what laboratories leave in a folder so that `check` takes it."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import samples
from test_laboratory_habits import HABITS, ROWS, STAMPS, rows

from plasmapyro import cli
from plasmapyro.readers.guess import describe
from plasmapyro.readers.stage import check_test, read_test
from plasmapyro.readers.text import Refusal

ROOT = Path(__file__).resolve().parents[2]
RTOL = 1e-12
WIDE, NARROW = (50 + np.arange(ROWS)) * 1e-9, (30 + np.arange(ROWS) / 2) * 1e-9  # [A], of `rows`


def described(place, **files):
    """The test in a new folder of raw files as its guessed description reads it, and the questions."""
    place.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        path = place / name.replace("__", ".")
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    guess = describe(place)
    (place / "test.yaml").write_text(guess.text, encoding="utf-8")
    assert check_test(place) == []
    return read_test(place), guess.questions


def same_signals(test):
    np.testing.assert_allclose(test.signal_wide, WIDE, rtol=RTOL)
    np.testing.assert_allclose(test.signal_narrow, NARROW, rtol=RTOL)


@pytest.mark.parametrize("habit", HABITS)
def test_tables_of_many_habits_are_described_so_that_they_can_be_read(tmp_path, habit):
    test, questions = described(tmp_path / "t", log__csv=HABITS[habit])
    same_signals(test)
    np.testing.assert_allclose(test.time, np.arange(ROWS), rtol=RTOL)
    assert any("is 'S1' in nA?" in words for words in questions)


def ranged(gain_of, unit="V"):
    """Volts of an amplifier that changes its range after the seventh row, with the gains of its channels."""
    lines = [f"Time [s];U1 wide [{unit}];U2 narrow [{unit}];{gain_of}"]
    for i in range(ROWS):
        gain = 1e6 if i < 7 else 1e5
        cells = (f"{one * gain * (1e3 if unit == 'mV' else 1):.9g}" for one in (WIDE[i], NARROW[i]))
        lines.append(";".join([str(i), *cells, f"{gain:g}"]))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("unit", ["V", "mV"])
@pytest.mark.parametrize("name", ["Gain [V/A]", "Verst\u00e4rkung", "Amp Range"])
def test_volts_of_an_amplifier_that_changes_its_range_are_divided_by_its_gain(tmp_path, name, unit):
    test, questions = described(tmp_path / "t", log__csv=ranged(name, unit))
    same_signals(test)
    assert any("volts per ampere?" in words for words in questions)
    place = tmp_path / "t" / "log.csv"
    place.write_text(place.read_text(encoding="utf-8").replace("100000", "0"), encoding="utf-8")
    assert "is not above 0" in check_test(tmp_path / "t")[0]


def test_a_gain_that_changes_beside_amperes_is_asked_for(tmp_path):
    codes = ranged("Gain", "A").replace("1e+06", "2").replace("100000", "1")
    assert any("'Gain' goes from 1 to 2" in words for words in described(tmp_path / "t", log__csv=codes)[1])


TABLES = {  # what stands above the header, the names, delimiter and decimal sign
    "tabulators, decimal commas": ("", ["t", "S1", "S2"], "\t", ","),
    "commas": ("", ["Time [s]", "Wide [nA]", "Narrow [nA]"], ",", "."),
    "a preamble in German": (
        "Messung 7\n\n",
        ["Zeit (s)", "Kanal breit (nA)", "Kanal schmal (nA)"],
        ";",
        ",",
    ),
    "blanks behind a comment sign": ("# ", ["time", "ch1", "ch2"], "  ", "."),
    "bars, channels by size": ("", ["sec", "one (nA)", "other (nA)"], "|", "."),
    "Spanish letters": ("", ["Tiempo (s)", "Se\u00f1al ancha (nA)", "Se\u00f1al estrecha (nA)"], ";", ","),
}


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.parametrize("order", [[0, 1, 2], [0, 2, 1]])
def test_names_units_and_marks_are_found(tmp_path, name, order):
    above, header, mark, sign = TABLES[name]
    text = above + mark.join(header[i] for i in order) + "\n"
    for i in range(ROWS):
        cells = [f"{i:.1f}", f"{50 + i:.2f}", f"{30 + i / 2:.2f}"]
        text += mark.join(cells[i] for i in order).replace(".", sign) + "\n"
    test, questions = described(tmp_path / "t", data__txt=text.encode("latin-1"))
    same_signals(test)
    assert any("larger one" in words for words in questions) == (name == "bars, channels by size")


@pytest.mark.parametrize("case", STAMPS)
def test_dates_and_times_of_day_are_found(tmp_path, case):
    test, _ = described(tmp_path / "t", a__csv=rows(stamp=STAMPS[case][2]))
    np.testing.assert_allclose(test.time, np.arange(ROWS), atol=1e-6)
    same_signals(test)


def test_a_date_that_may_be_read_in_two_ways_is_asked_for(tmp_path):
    text = rows(stamp=lambda i: f"02/03/2026 23:59:{i + 10:02d}")
    test, questions = described(tmp_path / "t", a__csv=text)
    assert any("day and month may be exchanged" in words for words in questions)
    np.testing.assert_allclose(test.time, np.arange(ROWS), atol=1e-6)


def test_date_and_time_in_two_columns_and_channels_of_the_tunnel(tmp_path):
    lines = ["Datum;Uhrzeit;S1 (nA);S2 (nA);P_el (kW);p (mbar);mdot (g/s)"]
    for i in range(ROWS):
        narrow = f"{30 + i / 2}".replace(".", ",")
        lines.append(f"25.10.2026;10:00:{i:02d},5;{50 + i},0;{narrow};90,0;50,1;16")
    test, _ = described(tmp_path / "t", a__csv="\n".join(lines) + "\n")
    same_signals(test)
    assert float(test.electric_power[3]) == 90e3 and float(test.mass_flow_rate[3]) == pytest.approx(0.016)
    assert float(test.chamber_pressure[3]) == pytest.approx(5010)


@pytest.mark.parametrize("form", samples.FORMS)
def test_spectra_of_every_program_are_found_with_their_dark(tmp_path, form):
    place = samples.spectra(tmp_path / "t", form)
    test, questions = described(place, a__csv=samples.table(header="t [s],S1 [nA],S2 [nA]"))
    np.testing.assert_array_equal(test.counts[1], samples.COUNTS + 10)
    np.testing.assert_array_equal(test.background_counts, samples.DARK)
    np.testing.assert_allclose(np.diff(test.spectrum_time), 2.0)
    assert any("spectrometer_fwhm" in words for words in questions)


def test_tables_of_spectra_burst_logs_and_parts_of_a_record_are_found(tmp_path):
    test, _ = described(
        tmp_path / "m",
        frames__csv="t,800,801,802\n1,110,111,112\n2,112,113,114\n",
        dark__csv="t,800,801,802\n1,1,2,3\n",
        log__log=samples.log(),
    )
    assert test.counts.shape == (2, 3) and test.background_counts.values.tolist() == [1, 2, 3]
    assert test.signal_wide.values[3] == 803
    lines = samples.table().splitlines(keepends=True)
    test, _ = described(
        tmp_path / "p", run_9__csv="".join(lines[:9]), run_10__csv=lines[0] + "".join(lines[9:])
    )
    same_signals(test)


def test_channels_of_a_tdms_file_are_found_by_name(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    (tmp_path / "t").mkdir()
    timing = {"wf_increment": 1.0, "unit_string": "nA"}
    with nptdms.TdmsWriter(tmp_path / "t" / "a.tdms") as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("pyro", name, values * 1e9, timing)
                for name, values in (("wide", WIDE), ("narrow", NARROW))
            ]
        )
    same_signals(described(tmp_path / "t")[0])


def test_the_example_described_anew_is_read_as_before(tmp_path, capsys):
    place = tmp_path / "my_test"
    shutil.copytree(ROOT / "docs" / "example" / "my_test", place)
    told = read_test(place)
    assert cli.main(["init", str(place)]) == 2
    assert "exists already, and nothing is overwritten" in capsys.readouterr().err
    (place / "test.yaml").unlink()
    assert cli.main(["init", str(place)]) == 0
    said = capsys.readouterr().out
    assert "it can be read; next: plasmapyro check" in said and "? attributes.emittance" in said
    guessed = read_test(place)
    for name in ("time", "signal_wide", "signal_narrow", "counts", "background_counts"):
        np.testing.assert_array_equal(guessed[name], told[name])
    assert guessed.attrs["plasma_off_time"] == pytest.approx(50, abs=0.5)  # the plateau ends at 50 s
    assert guessed.attrs["reference_window"][1] < 6.5  # the surface begins to shine at 6 s
    assert cli.main(["check", str(place)]) == 0
    marked = (place / "test.yaml").read_text().count("  # ?")
    assert f"{marked} guesses of `init` are still marked" in capsys.readouterr().out and marked > 5
    (place / "test.yaml").write_text((place / "test.yaml").read_text().replace("  # ?", "  #"))
    assert cli.main(["check", str(place)]) == 0
    assert "guesses" not in capsys.readouterr().out


@pytest.mark.parametrize("content", [b"", b"\x00\x01\x02", b"hello\n", b"1;2;3\n4;5;6\n", b"a;b\nx;y\n"])
def test_a_folder_without_signals_is_refused_and_left_alone(tmp_path, content, capsys):
    (tmp_path / "x.csv").write_bytes(content)
    with pytest.raises(Refusal, match="nothing looks like signals"):
        describe(tmp_path)
    assert cli.main(["init", str(tmp_path)]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["x.csv"]


def test_names_of_others_are_no_yaml(tmp_path):
    header = "time [s];S1: {a} # \"x\" [nA];S2 'y' [nA]"
    test, _ = described(tmp_path / "t", a__csv=rows("{time};{wide};{narrow}", header=header))
    same_signals(test)
    (tmp_path / "t" / "b\nattributes: {}.csv").write_text("x;y1;y2\n1;2;3\n2;3;4\n")
    (tmp_path / "t" / "b\nattributes: {}2.csv").write_text("t;s1;s2\n1;2;3\n2;3;4\n3;4;5\n4;5;6\n")
    assert all(
        line.startswith("#") for line in describe(tmp_path / "t").text.split("attributes:\n")[0].splitlines()
    )


@pytest.mark.parametrize("stamp", ["14:02:10.50", "2026-05-04 14:02:10.50", "10.5"])
def test_the_zero_of_a_burst_log_is_asked_for_as_the_log_writes_it(tmp_path, stamp):
    text = samples.log().replace("14:02:", stamp.removesuffix("10.50").removesuffix("10.5"))
    test, _ = described(tmp_path / "t", a__log=text)
    first = text.partition(" UC")[0] if ":" in stamp else stamp
    assert f'  zero: "{first}"  # ? what shall be 0' in (tmp_path / "t" / "test.yaml").read_text()
    assert test.time.values[0] == 0.0


IN_NAMES = {  # name of a file, and the line of `time` that is proposed
    "run3_{ms:06d}ms_{i:03d}.txt": '{from: name, name: "run#_*ms_#.txt", unit: ms, marks: end}',
    "spec_{s:.1f}s.txt": '{from: name, name: "spec_*s.txt", unit: s, marks: end}',
    "t={s:.2f}.txt": '{from: name, name: "t=*.txt", unit: s, marks: end}',
    "IR_20260501_1000{i:02d}_{i:03d}.txt": (
        '{from: name, name: "IR_*_#.txt", format: "%Y%m%d_%H%M%S", zero: "20260501_100000", marks: end}'
    ),
    "10-00-{i:02d} probe.txt": (
        '{from: name, name: "* probe.txt", format: "%H-%M-%S", zero: "10-00-00", marks: end}'
    ),
    "spec_100ms_{i:04d}.txt": None,  # the exposure
    "spec_{i:04d}s1.txt": None,
}


@pytest.mark.parametrize("name", IN_NAMES)
def test_times_that_stand_in_the_names_of_files_are_proposed(tmp_path, name):
    body = samples.spectrum("spectrasuite").replace(b"Date:", b"Day:")
    for i in range(4):
        (tmp_path / name.format(i=i, s=0.5 + i, ms=500 + 1000 * i)).write_bytes(body)
    guess = describe(tmp_path)
    proposed = IN_NAMES[name]
    assert f"time: {proposed or '{from: order'}" in guess.text
    assert any("the names hold times" in words for words in guess.questions) == bool(proposed)
