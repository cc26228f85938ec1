"""What laboratories write into tables: remarks, dates, several files of one record."""

import numpy as np
import pytest
import samples

from plasmapyro.readers import clock
from plasmapyro.readers.spectrometer import natural, number_form
from plasmapyro.readers.stage import check_test, read_test

RTOL = 1e-12
ROWS = 20
STAMPED = samples.CSV.replace("{name: t, unit: s}", "{name: t, format: '%d.%m.%Y %H:%M:%S'}").replace(
    "pyrometer:\n", "pyrometer:\n  zero: '25.10.2026 01:59:30'\n"
)


def rows(form="{time};{wide};{narrow};", stamp=None, header="t;S1;S2;Kommentar", count=ROWS):
    """A table with semicolons and a column of remarks, empty in all rows but the fourth."""
    lines = [header]
    for i in range(count):
        time = f"{i:.1f}" if stamp is None else stamp(i)
        lines.append(form.format(time=time, wide=f"{50 + i:.2f}", narrow=f"{30 + i / 2:.2f}"))
    return "\n".join(lines) + "\n"


def read(tmp_path, text, described=samples.CSV, **more):
    return read_test(samples.folder(tmp_path / "t", described, pyrometer__csv=text, **more))


def faults(tmp_path, text, described=samples.CSV, **more):
    return check_test(samples.folder(tmp_path / "t", described, pyrometer__csv=text, **more))


HABITS = {
    "a column of remarks that is empty": rows(),
    "a remark in one row": rows().replace("3.0;53.00;31.50;", "3.0;53.00;31.50;window wiped"),
    "remarks left out with their delimiter": rows("{time};{wide};{narrow}"),
    "a delimiter at the end of the header only": rows("{time};{wide};{narrow}", header="t;S1;S2;"),
    "a delimiter at the end of the rows only": rows(header="t;S1;S2"),
    "several delimiters at the end": rows("{time};{wide};{narrow};;;", header="t;S1;S2"),
    "comment lines among the data": rows().replace(
        "3.0;53", "# window wiped; again\n% or so\n! x\n// y\n3.0;53"
    ),
    "a header behind a comment sign": "# " + rows(),
    "a comment that holds the names of the columns": "# t S1 S2\n" + rows(),
}


@pytest.mark.parametrize("habit", HABITS)
def test_a_table_of_any_habit_gives_the_same_signals(tmp_path, habit):
    test = read(tmp_path, HABITS[habit])
    np.testing.assert_allclose(test.time, np.arange(ROWS), rtol=RTOL)
    np.testing.assert_allclose(test.signal_wide, (50 + np.arange(ROWS)) * 1e-9, rtol=RTOL)
    np.testing.assert_allclose(test.signal_narrow, (30 + np.arange(ROWS) / 2) * 1e-9, rtol=RTOL)


MARKED = {  # words of a mark, and that it stands among the data of a table with such a delimiter
    "a line of words": ("--- injection ---", ";"),
    "behind its time": ("4.2;INJECTION;;", ";"),
    "with a number of its own": ("Event 3: shutter open", ";"),
    "between blanks": ("shutter is open now", " "),
    "beside tabulators": ("plasma on", "\t"),
}


@pytest.mark.parametrize("habit", MARKED)
def test_marks_of_events_among_the_data_are_left_out_and_said(tmp_path, caplog, habit):
    words, delimiter = MARKED[habit]
    lines = rows("{time};{wide};{narrow}", header="t;S1;S2").replace(";", delimiter).splitlines()
    test = read(tmp_path, "\n".join([*lines[:5], words, *lines[5:]]) + "\n")
    np.testing.assert_allclose(test.time, np.arange(ROWS), rtol=RTOL)
    np.testing.assert_allclose(test.signal_wide, (50 + np.arange(ROWS)) * 1e-9, rtol=RTOL)
    assert f"1 lines hold no sample and are taken as marks: line 6 '{words}'" in caplog.text


@pytest.mark.parametrize("words", ["4.2;52,8O", "t;Ka;Kb", "4.2;off;31.0", "x9f;;", "4.2"])
def test_what_may_be_a_damaged_row_or_another_table_is_no_mark(tmp_path, words):
    lines = rows("{time};{wide};{narrow}", header="t;S1;S2").splitlines()
    assert "line 6" in faults(tmp_path, "\n".join([*lines[:5], words, *lines[5:]]) + "\n")[0]


def test_an_empty_last_cell_is_a_missing_sample(tmp_path):
    test = read(tmp_path, rows("{time};{wide};{narrow}", header="t;S1;S2").replace(";31.50", ";"))
    assert np.flatnonzero(np.isnan(test.signal_narrow)).tolist() == [3]


def test_a_cell_too_many_or_too_few_is_still_refused(tmp_path):
    for wrong in ("3.0;53.00;31.50;a;b", "3.0;53.00"):
        (message,) = faults(tmp_path, rows().replace("3.0;53.00;31.50;", wrong))
        assert f"line 5: {wrong.count(';') + 1} cells, the header has 4" in message


def stamp(form="25.10.2026 {:02d}:{:02d}:{:02d},25", start=7200):
    return lambda i: form.format(*divmod((start + i) // 60, 60), (start + i) % 60)


STAMPS = {
    "date and clock with decimals": ("%d.%m.%Y %H:%M:%S", "25.10.2026 01:59:30", stamp(), 30.25),
    "decimals in the format": ("%d.%m.%Y %H:%M:%S,%f", "25.10.2026 01:59:30,5", stamp(), 29.75),
    "American date": (
        "%m/%d/%Y %H:%M:%S",
        "10/25/2026 02:00:00",
        stamp("10/25/2026 {:02d}:{:02d}:{:02d}"),
        0.0,
    ),
    "date as in ISO 8601": (
        "%Y-%m-%dT%H:%M:%S",
        "2026-10-24T02:00:00",
        stamp("2026-10-25T{:02d}:{:02d}:{:02d}"),
        86400.0,
    ),
    "time of day over midnight": (
        "%H:%M:%S",
        "23:59:50",
        lambda i: f"23:59:{50 + i}" if i < 10 else f"00:00:{i - 10:02d}",
        0.0,
    ),
    "zero behind midnight": (
        "%H:%M:%S",
        "00:00:05",
        lambda i: f"23:59:{50 + i}" if i < 10 else f"00:00:{i - 10:02d}",
        -15.0,
    ),
}


@pytest.mark.parametrize("case", STAMPS)
def test_dates_and_times_of_day_are_read_in_the_stated_format(tmp_path, case):
    form, zero, write, first = STAMPS[case]
    described = STAMPED.replace("%d.%m.%Y %H:%M:%S", form).replace("25.10.2026 01:59:30", zero)
    described = described.replace("columns:", "delimiter: ;\n  columns:")
    place = samples.folder(tmp_path / "t", described, pyrometer__csv=rows(stamp=write))
    text = (place / "test.yaml").read_text()
    begin = f"[{first}, {first + 5}]"
    text = text.replace("[0.0, 5.0]", begin).replace("_time: 100.0", f"_time: {first + 100}")
    (place / "test.yaml").write_text(text.replace("injection_time: 0.0", f"injection_time: {first - 1}"))
    np.testing.assert_allclose(read_test(place).time, first + np.arange(ROWS), rtol=1e-9)


def test_date_and_time_of_day_may_stand_in_two_columns(tmp_path):
    described = (
        STAMPED.replace("01:59:30", "02:00:00")
        .replace("{name: t,", "{name: [Datum, Uhrzeit],")
        .replace("columns:", "delimiter: ;\n  columns:")
    )
    text = rows(
        stamp=lambda i: stamp()(i).replace(" ", ";"), header="Datum;Uhrzeit [hh:mm:ss];S1;S2;Kommentar"
    )
    np.testing.assert_allclose(read(tmp_path, text, described).time, 0.25 + np.arange(ROWS), rtol=1e-9)
    (message,) = faults(tmp_path, text.replace("Uhrzeit", "Zeit"), described)
    assert "no column 'Uhrzeit' in the header" in message


def test_a_date_without_a_format_is_called_a_date(tmp_path):
    (message,) = faults(tmp_path, rows(stamp=stamp()))
    assert "line 2: '25.10.2026 02:00:00,25' is a date or a time of day; state its `format`" in message


def test_a_moment_that_shall_be_zero_and_is_missing_is_one_fault(tmp_path):
    (message,) = faults(tmp_path, rows(stamp=stamp()), STAMPED.replace("  zero: '25.10.2026 01:59:30'\n", ""))
    assert "pyrometer.zero is missing" in message


def test_a_date_of_another_format_is_refused_with_the_line(tmp_path):
    (message,) = faults(
        tmp_path, rows(stamp=stamp()).replace("25.10.2026 02:00:03", "25/10/2026 02:00:03"), STAMPED
    )
    assert "line 5: '25/10/2026 02:00:03,25' is not of the stated format" in message


def test_the_end_of_summer_time_is_said_and_undone_only_if_stated(tmp_path):
    text = rows(stamp=lambda i: stamp(start=10790 - 3600 * (i > 9))(i))
    (message,) = faults(tmp_path, text, STAMPED)
    assert "line 12: the clock goes back by an hour: the end of summer time?" in message
    told = STAMPED.replace("%S'}", "%S', set_back: yes}").replace("01:59:30", "02:59:50")
    np.testing.assert_allclose(read(tmp_path, text, told).time, 0.25 + np.arange(ROWS), rtol=1e-9)
    (message,) = faults(tmp_path, rows(stamp=stamp()), told)
    assert "goes back by an hour 0 times" in message


WRONG_STAMPS = {
    "no format": (("%d.%m.%Y %H:%M:%S", "seconds"), "'seconds' is no format of dates"),
    "a name of a time zone": (("%d.%m.%Y %H:%M:%S", "%H:%M:%S%Z"), "is no format of dates"),
    "zero as a number": (("25.10.2026 01:59:30", "3600"), "`zero` '3600' is not of the format"),
    "no zero": (("  zero: '25.10.2026 01:59:30'\n", ""), "pyrometer.zero is missing"),
    "a unit as well": (("%S'}", "%S', unit: s}"), "has no meaning beside `format`"),
}


@pytest.mark.parametrize("case", WRONG_STAMPS)
def test_a_wrong_statement_about_dates_is_refused(tmp_path, case):
    change, words = WRONG_STAMPS[case]
    found = faults(tmp_path, rows(stamp=stamp()), STAMPED.replace(*change))
    assert words in "\n".join(found)


def test_seconds_of_a_stamp_are_those_of_the_calendar():
    # 2026-10-25 is 9794 days after 2000-01-01 (26 years of 365 days, 7 leap days, 297 days of the year).
    assert clock.seconds("25.10.2026 00:00:01,5", "%d.%m.%Y %H:%M:%S") == 9794 * 86400 + 1.5
    assert clock.seconds("01:02:03.250", "%H:%M:%S") == 3723.25
    assert clock.seconds("01:62:03", "%H:%M:%S") is None
    assert clock.seconds("2026-10-25", "%Y-%m-%d") == 9794 * 86400


def test_files_of_one_record_are_joined_in_their_order(tmp_path):
    lines = samples.table().splitlines(keepends=True)
    described = samples.CSV.replace("pyrometer:\n", "pyrometer:\n  file: [a.csv, b.csv]\n")
    parts = {"a__csv": "".join(lines[:9]), "b__csv": lines[0] + "".join(lines[9:])}
    test = read_test(samples.folder(tmp_path / "t", described, **parts))
    np.testing.assert_allclose(test.time, np.arange(ROWS), rtol=RTOL)
    np.testing.assert_allclose(test.signal_wide, (50 + np.arange(ROWS)) * 1e-9, rtol=RTOL)
    (message,) = check_test(samples.folder(tmp_path / "t", described.replace("a.csv, b.csv", "b.csv, a.csv")))
    assert "a.csv: begins at 0 s, when b.csv ends at 19 s; name the files in their order" in message
    for files, words in (
        ("[a.csv, a.csv]", "a file stands twice"),
        ("[a.csv, ../b.csv]", "outside"),
        ("[]", "1 to"),
    ):
        (message,) = check_test(samples.folder(tmp_path / "t", described.replace("[a.csv, b.csv]", files)))
        assert words in message


def test_tables_of_spectra_and_burst_logs_are_joined_too(tmp_path):
    spectra = samples.CSV + (
        "spectrometer:\n  file: [a.csv, b.csv]\n  quantity: counts\n  unit: count\n  background: a.csv\n"
    )
    place = samples.folder(
        tmp_path / "s",
        spectra.replace("spectrometer_fwhm", "spectrometer_fwhm"),
        pyrometer__csv=samples.table(),
        a__csv="t,800,801,\n1,10,11,\n2,12,13,\n",
        b__csv="t,800,801\n3,14,15\n",
    )
    text = (place / "test.yaml").read_text()
    (place / "test.yaml").write_text(
        text.replace("  spectrometer_fwhm", "  spectrometer_integration_time: 0.5\n  spectrometer_fwhm")
    )
    np.testing.assert_array_equal(read_test(place).counts, [[10, 11], [12, 13], [14, 15]])
    (place / "b.csv").write_text("t,800,802\n3,14,15\n")
    assert "other wavelengths than a.csv" in "".join(check_test(place))
    lines = samples.log().splitlines(keepends=True)
    described = samples.MARATHON + "  file: [a.log, b.log]\n  zero: '14:02:10.50'\n"
    logs = {"a__log": "".join(lines[:9]), "b__log": "".join(lines[9:])}
    np.testing.assert_allclose(
        read_test(samples.folder(tmp_path / "t", described, **logs)).time, np.arange(ROWS), atol=1e-9
    )
    (message,) = check_test(samples.folder(tmp_path / "t", described.replace("  zero: '14:02:10.50'\n", "")))
    assert "zero is needed for a record of several files" in message


def test_waveforms_of_several_tdms_files_share_the_clock_of_their_start(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    place = samples.folder(
        tmp_path / "t",
        "pyrometer:\n  file: [a.tdms, b.tdms]\n  zero: 1.0\n  columns:\n"
        "    signal_wide: {name: pyro/S1, unit: nA}\n    signal_narrow: {name: pyro/S2, unit: nA}\n",
    )
    for name, start in (("a", "2026-10-25T02:00:00.500"), ("b", "2026-10-25T02:00:10.750")):
        timing = {"wf_increment": 0.5, "wf_start_time": np.datetime64(start)}
        with nptdms.TdmsWriter(place / f"{name}.tdms") as writer:
            writer.write_segment(
                [
                    nptdms.ChannelObject("pyro", channel, np.arange(1.0, 21), timing)
                    for channel in ("S1", "S2")
                ]
            )
    time = np.arange(20) / 2 - 1
    np.testing.assert_allclose(read_test(place).time, [*time, *(time + 10.25)], rtol=1e-9, atol=1e-6)
    with nptdms.TdmsWriter(place / "b.tdms") as writer:
        writer.write_segment(
            [nptdms.ChannelObject("pyro", c, np.arange(1.0, 21), {"wf_increment": 0.5}) for c in ("S1", "S2")]
        )
    assert "has no start time" in "".join(check_test(place))


def test_a_channel_of_a_tdms_file_is_divided_by_its_gain(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    described = "pyrometer:\n  file: a.tdms\n  columns:\n"
    for band in ("wide", "narrow"):
        described += f"    signal_{band}: {{name: pyro/U, unit: A, gain: pyro/G}}\n"
    place = samples.folder(tmp_path / "t", described)
    timing, gain = {"wf_increment": 0.5}, np.where(np.arange(20) < 7, 1e6, 1e5)
    values = {"U": np.arange(1.0, 21) * 1e-9 * gain, "G": gain}
    with nptdms.TdmsWriter(place / "a.tdms") as writer:
        writer.write_segment([nptdms.ChannelObject("pyro", *one, timing) for one in values.items()])
    for name in ("signal_wide", "signal_narrow"):
        np.testing.assert_allclose(read_test(place)[name], np.arange(1.0, 21) * 1e-9, rtol=RTOL)


def test_numbers_in_file_names_count_as_numbers(tmp_path):
    assert sorted(["s10.txt", "s9.txt", "s1.txt", "s2b.txt"], key=natural) == [
        "s1.txt",
        "s2b.txt",
        "s9.txt",
        "s10.txt",
    ]
    place = samples.spectra(samples.folder(tmp_path / "t", samples.SPECTRA), "jaz", number=11)
    for path in (place / "spectrometer").iterdir():
        path.rename(path.with_name(f"s{int(path.stem.split('_')[1])}.txt"))
    np.testing.assert_allclose(read_test(place).counts[:, 0], samples.COUNTS[0] + 10 * np.arange(11))


@pytest.mark.parametrize(
    "names",
    [
        [f"t={time:g}s.txt" for time in (0.5, 1.25, 2, 2.75, 3.5, 10.25)],
        [f"spec_{time:.1f}.txt" for time in (-3.5, -1.5, 0.5, 2.5)],
        ["s_1.9.txt", "s_1.10.txt", "s_1.11.txt", "s_2.1.txt"],  # counters
        ["run-1_2.txt", "run-1_10.txt", "run-2_1.txt"],  # no signs
        ["20261128_095959.txt", "20261128_100001.txt"],
    ],
)
def test_times_in_file_names_are_ordered_as_times_and_counters_as_counters(names):
    form = number_form(names)
    assert sorted(reversed(names), key=lambda name: natural(name, form)) == names


def test_every_fault_of_one_table_comes_in_one_round(tmp_path):
    text = (
        rows(header="t;S1 [nm];S2;x")
        .replace("3.0;53.00", "3.0;53,00")
        .replace("4.0;54.00;32.00;", "4.0;54.00")
    )
    described = samples.CSV.replace("{name: S1, unit: nA}", "{name: S1}")
    place = samples.folder(
        tmp_path / "t", described, pyrometer__csv=text.replace("6.0;56.00", "6.0;high")[:-1]
    )
    stated = (place / "test.yaml").read_text().replace("emittance: 0.85", "emittance: 85")
    (place / "test.yaml").write_text(stated)
    found = check_test(place)
    for words in (
        "line 6: 2 cells, the header has 4",
        "decimal comma and with decimal point are mixed",
        "'high' in column 'S1' is not a number",
        "is in 'nm', which is no unit of signal_wide",
        "may be cut off",
        "attribute emittance: 85",
    ):
        assert words in "\n".join(found), words
    assert len(found) == 6


@pytest.mark.parametrize(
    ("time", "words"),
    [
        (lambda i: 10776 + i, "the record runs from 10776 to 10795 s; is `zero` missing?"),
        (lambda i: 3600 + i, "or a clock an hour off (summer time)?"),
        (lambda i: 1000 * i, "one per 1000 s; is the `unit` of the time right?"),
    ],
)
def test_why_the_reference_window_is_empty_is_asked(tmp_path, time, words):
    text = samples.table().splitlines()
    shifted = "\n".join(
        [text[0], *(f"{time(i)}.0" + line[line.index(",") :] for i, line in enumerate(text[1:]))]
    )
    assert words in faults(tmp_path, shifted + "\n")[0]


def test_columns_that_are_absent_are_said_beside_those_that_are_there(tmp_path):
    """Arrays within a struct of Matlab or a record of HDF5 have the name of both, as no viewer shows it."""
    told = faults(tmp_path, rows(header="log.t;log.S1;log.S2;Kommentar"))[0]
    assert "no column 't', 'S1', 'S2' in the header of 'log.t', 'log.S1', 'log.S2', 'Kommentar'" in told


@pytest.mark.parametrize("name", ["Test.yaml", "test.yml", "TEST.YML", "test.yaml.txt"])
def test_a_description_of_nearly_the_right_name(tmp_path, name):
    folder = samples.folder(tmp_path / "t", samples.CSV, pyrometer__csv=rows())
    (folder / "test.yaml").rename(folder / "renamed")
    (folder / "renamed").rename(folder / name)
    assert check_test(folder) == [
        f"{folder}: holds neither test.nc nor test.yaml; rename {name} to test.yaml"
    ]


def test_a_table_of_nothing_but_a_mark_of_its_encoding_is_empty(tmp_path):
    folder = samples.folder(tmp_path / "t", samples.CSV, pyrometer__csv=rows())
    (folder / "pyrometer.csv").write_bytes(b"\xff\xfe")
    assert any("pyrometer.csv: is empty; export it again" in one for one in check_test(folder))
