"""Signals from tables, burst logs and TDMS files come out in SI, or one clear message does."""

import subprocess
import sys

import numpy as np
import pytest
import samples
import xarray as xr

from plasmapyro import contracts
from plasmapyro.readers import burst, columns, parts
from plasmapyro.readers.description import Section
from plasmapyro.readers.stage import check_test, read_test, sources
from plasmapyro.readers.text import Refusal

RTOL = 1e-12


def read(tmp_path, described=samples.CSV, **files):
    return read_test(samples.folder(tmp_path / "t", described, **files))


def message(tmp_path, described=samples.CSV, **files):
    (found,) = check_test(samples.folder(tmp_path / "t", described, **files))
    return found


TABLES = {
    "semicolon and comma": lambda t: t.replace(",", ";").replace(".", ","),
    "tab": lambda t: t.replace(",", "\t"),
    "spaces": lambda t: t.replace(",", "  "),
    "quoted decimal comma": lambda t: (
        "\n".join(
            ",".join(f'"{cell.replace(".", ",")}"' for cell in line.split(",")) for line in t.splitlines()
        )
        + "\n"
    ),
    "preamble and comments": lambda t: "Operator;x\n\n# free words\n" + t,
    "units in the header": lambda t: t.replace("t,S1,S2", "t [s],S1 (nA),S2 [nA]"),
    "another order": lambda t: (
        "\n".join(",".join(reversed(line.split(","))) for line in t.splitlines()) + "\n"
    ),
    "final delimiter": lambda t: t.replace("\n", ",\n"),
    "old Macintosh": lambda t: t.replace("\n", "\r"),
    "byte order mark": lambda t: "\ufeff" + t,
    "end of a text of DOS": lambda t: t.replace("\n", "\r\n") + "\x1a" * 7,
    "no end but that of DOS": lambda t: t.removesuffix("\n") + "\x1a",
}


@pytest.mark.parametrize("case", TABLES)
def test_tables_of_all_habits_give_the_same_signals(tmp_path, case):
    test = contracts.check(read(tmp_path, pyrometer__csv=TABLES[case](samples.table())), "test")
    np.testing.assert_allclose(test.time, np.arange(20.0), rtol=RTOL)
    np.testing.assert_allclose(test.signal_wide, (50 + np.arange(20.0)) * 1e-9, rtol=RTOL)
    np.testing.assert_allclose(test.signal_narrow, (30 + np.arange(20.0) / 2) * 1e-9, rtol=RTOL)


@pytest.mark.parametrize("case", [*TABLES, "a gap", "a word", "thousands or decimals"])
def test_a_long_table_is_read_as_a_short_one(tmp_path, monkeypatch, case):
    change = TABLES.get(case, lambda t: t)
    changed = {
        "a gap": ("53.00", ""),
        "a word": ("53.00", "OVER"),
        "thousands or decimals": ("53.00", "1,530"),
    }
    words = change(samples.table()).replace(*changed.get(case, ("", "")))
    place, found = samples.folder(tmp_path / "t", samples.CSV, pyrometer__csv=words), []
    for long in (columns.LONG, 1):
        monkeypatch.setattr(columns, "LONG", long)
        faults = check_test(place)
        found.append(faults if faults else read_test(place))
    if isinstance(found[0], list):
        assert found[0] == found[1]
    else:
        xr.testing.assert_equal(*found)


@pytest.mark.parametrize(("lost", "refused"), [("", False), ("0", True), ("50", True), (",39.50", True)])
def test_a_last_line_without_an_end_is_read_where_a_lost_digit_would_show(tmp_path, lost, refused):
    words = samples.table().rstrip("\n")
    assert words.endswith("19.0,69.00,39.50")
    described = samples.folder(tmp_path / "t", samples.CSV, pyrometer__csv=words.removesuffix(lost))
    assert bool(check_test(described)) is refused
    uneven = words.replace("31.00", "31.0")  # numbers of any length may have been longer
    assert check_test(samples.folder(tmp_path / "u", samples.CSV, pyrometer__csv=uneven))


def test_missing_cells_are_nan(tmp_path):
    test = read(tmp_path, pyrometer__csv=samples.table().replace("3.0,53.00", "3.0,").replace("55.00", "NaN"))
    assert np.flatnonzero(np.isnan(test.signal_wide)).tolist() == [3, 5]


@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e-3), ("us", 1e-6), ("min", 60.0), ("h", 3600.0)])
def test_units_and_zero_of_the_time(tmp_path, unit, factor):
    path = tmp_path / "a.csv"
    path.write_text(f"t [{unit}]\n" + "".join(f"{i}.5\n" for i in range(9)))
    faults = []
    section = Section({"file": "a.csv", "zero": "0.25", "columns": {"time": {"name": "t"}}}, "y", "", faults)
    found = parts.table(tmp_path, section, (), "a.csv")
    assert faults == []
    np.testing.assert_allclose(found["time"], (np.arange(9) + 0.5) * factor - 0.25, rtol=RTOL)


def test_tunnel_channels_join_onto_the_times_of_the_pyrometer(tmp_path):
    parts = samples.CSV + (
        "tunnel:\n  columns:\n    time: {name: t, unit: min}\n    chamber_pressure: {name: p, unit: mbar}\n"
        "    electric_power: {name: P, unit: kW}\n"
    )
    test = read(
        tmp_path, parts, pyrometer__csv=samples.table(), tunnel__csv="t,p,P\n0.0,50,100\n0.1,62,160\n"
    )
    np.testing.assert_allclose(test.chamber_pressure[:7], 5000 + 200 * np.arange(7), rtol=1e-9)
    np.testing.assert_allclose(test.electric_power[3], 130e3)
    assert np.isnan(test.chamber_pressure[7:]).all()


REFUSED = {
    "a repeated time": (lambda t: t.replace("4.0,54", "3.0,54"), "the time stands twice"),
    "time going back": (lambda t: t.replace("4.0,54", "2.5,54"), "the time goes back"),
    "no time": (lambda t: t.replace("4.0,54", ",54"), "samples have no time"),
    "a word": (lambda t: t.replace("54.00", "high"), "line 6: 'high' in column 'S1' is not a number"),
    "overflow": (lambda t: t.replace("54.00", "9e999"), "is not a number"),
    "a short row": (lambda t: t.replace("4.0,54.00,", "4.0,"), "line 6: 2 cells, the header has 3"),
    "cut off": (lambda t: t[:-3], "may be cut off"),
    "no such column": (lambda t: t.replace("S2", "S3"), "no column 'S2'"),
    "a column twice": (
        lambda t: "\n".join(line + "," + line.split(",")[1] for line in t.splitlines()) + "\n",
        "column 'S1' stands 2 times in the header",
    ),
    "another unit": (lambda t: t.replace("S1", "S1 [uA]"), "says 'uA', test.yaml says 'nA'"),
    "mixed decimals": (lambda t: t.replace(",", ";").replace("54.00", "54,00"), "mixed"),
    "no data": (lambda t: t.splitlines()[0] + "\n", "a header and no data"),
    "binary": (lambda t: t + "\0\1", "binary data"),
}


@pytest.mark.parametrize("word", ["inf", "1.#INF", "OVER"])
def test_what_a_logger_prints_beyond_its_range_is_no_sample(tmp_path, word):
    test = read(tmp_path, pyrometer__csv=samples.table().replace("54.00", word))
    assert np.isnan(test.signal_wide).sum() == 1


@pytest.mark.parametrize("case", REFUSED)
def test_a_damaged_table_is_refused_with_the_line(tmp_path, case):
    change, words = REFUSED[case]
    found = check_test(samples.folder(tmp_path / "t", samples.CSV, pyrometer__csv=change(samples.table())))
    assert len(found) == 1
    assert words in found[0]
    assert "pyrometer.csv" in found[0]


def test_thousands_are_not_taken_for_decimals(tmp_path):
    text = "t\tS1\tS2\n" + "".join(f"{i}\t1,{200 + i}\t1,{100 + i}\n" for i in range(9))
    assert "decimals or thousands" in message(tmp_path, pyrometer__csv=text)
    stated = samples.CSV.replace("pyrometer:", "pyrometer:\n  decimal: ','")
    np.testing.assert_allclose(read(tmp_path, stated, pyrometer__csv=text).signal_wide[0], 1.2e-9)


@pytest.mark.parametrize("quoted", ["{0} {1}", '"{0} {1}"', '"{0}" {1}'])
def test_burst_log_with_clock_times(tmp_path, quoted):
    log = "".join(quoted.format(*line.split(" ", 1)) + "\n" for line in samples.log().splitlines())
    test = contracts.check(read(tmp_path, samples.MARATHON, pyrometer__log=log), "test")
    np.testing.assert_allclose(test.time, np.arange(20.0), atol=1e-9)
    np.testing.assert_allclose(test.signal_wide, 800 + np.arange(20.0))
    np.testing.assert_allclose(test.signal_narrow, 300 + np.arange(20.0) / 2)


def test_burst_log_zero_period_scale_and_midnight(tmp_path):
    parts = samples.MARATHON + "  zero: '14:02:12.50'\n  ampere_per_unit: 1e-9\n"
    test = read(tmp_path, parts, pyrometer__log=samples.log(30))
    assert test.time.values[2] == pytest.approx(0)
    np.testing.assert_allclose(test.signal_wide, (800 + np.arange(30.0)) * 1e-9)
    bare = "".join(line.split(" ", 1)[1] + "\n" for line in samples.log().splitlines())
    np.testing.assert_allclose(
        read(tmp_path, samples.MARATHON + "  period: 0.5\n", pyrometer__log=bare).time, np.arange(20) / 2
    )
    night = "23:59:59.0 Q0800.0 R0300.0\n0:00:00.5 Q0800.0 R0300.0\n0:00:01.0 Q0800.0 R0300.0\n"
    place = tmp_path / "night.log"
    place.write_text(night)
    np.testing.assert_allclose(burst.read_log(place)[0], [0, 1.5, 2.0])


def test_slope_and_attenuation_are_undone_when_told_and_never_guessed(tmp_path):
    log = samples.log(tail="B20 S1.100 I029")
    found = check_test(samples.folder(tmp_path / "t", samples.MARATHON, pyrometer__log=log))
    assert len(found) == 1
    assert "slope (item S) is not 1 throughout" in found[0]
    for undo, wide, narrow in (
        ("[]", 800, 300),
        ("[slope]", 880, 300),
        ("[attenuation]", 640, 240),
        ("[slope, attenuation]", 704, 240),
    ):
        test = read(tmp_path, samples.MARATHON + f"  undo: {undo}\n", pyrometer__log=log)
        assert test.signal_wide.values[0] == pytest.approx(wide)
        assert test.signal_narrow.values[0] == pytest.approx(narrow)


def test_codes_for_out_of_range_are_missing_samples(tmp_path):
    log = samples.log().replace("T1203", "TEHHH").replace("Q0804.000", "QEUUU")
    test = read(tmp_path, samples.MARATHON, pyrometer__log=log)
    assert np.flatnonzero(np.isnan(test.signal_wide)).tolist() == [4]


BURSTS = {
    "no powers": (lambda t: t.replace(" Q0", " W0").replace(" R0", " N0"), "holds no item Q and R"),
    "an unknown item": (lambda t: t.replace("S1.000", "Z1.000", 1), "'Z1.000' is no item"),
    "an item twice": (lambda t: t.replace("S1.000", "S1.000 S1.000", 1), "item S stands twice"),
    "an impossible slope": (lambda t: t.replace("S1.000", "S9.000", 1), "the unit sends 0.85 to 1.15"),
    "an incomplete line": (lambda t: t.replace(" R0300.000", "", 1), "remove incomplete lines"),
    "a mixed unit": (lambda t: t.replace("UC", "UF", 1), "changes between C and F"),
    "no clock": (lambda t: t.replace("14:02:12.50", "", 1), "some lines have a time and others not"),
    "a wrong clock": (lambda t: t.replace("14:02:12.50", "14:62:12.50"), "no time of day"),
    "a repeated clock": (lambda t: t.replace("14:02:12.50", "14:02:11.50"), "does not increase"),
    "cut off": (lambda t: t[:-4], "may be cut off"),
    "nothing to read": (lambda t: "\n\n", "holds no burst string"),
}


@pytest.mark.parametrize("case", BURSTS)
def test_a_damaged_log_is_refused_with_the_line(tmp_path, case):
    change, words = BURSTS[case]
    found = check_test(samples.folder(tmp_path / "t", samples.MARATHON, pyrometer__log=change(samples.log())))
    assert words in "\n".join(found)


def test_tdms_waveforms_and_units(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    place = samples.folder(
        tmp_path / "t",
        "pyrometer:\n  file: a.tdms\n  columns:\n    signal_wide: {name: pyro/S1}\n"
        "    signal_narrow: {name: pyro/S2, unit: uA}\n",
    )
    timing = {"wf_increment": 0.5, "wf_start_offset": -1.0, "unit_string": "nA"}
    with nptdms.TdmsWriter(place / "a.tdms") as writer:
        channels = [
            nptdms.ChannelObject("pyro", "S1", np.arange(20.0), timing),
            nptdms.ChannelObject("pyro", "S2", np.arange(20.0), timing | {"unit_string": ""}),
        ]
        writer.write_segment(channels)
    test = contracts.check(read_test(place), "test")
    np.testing.assert_allclose(test.time, np.arange(20) / 2 - 1)
    np.testing.assert_allclose(test.signal_wide, np.arange(20.0) * 1e-9)
    np.testing.assert_allclose(test.signal_narrow, np.arange(20.0) * 1e-6)
    whole = (place / "a.tdms").read_bytes()
    for length in (10, 40, 120):
        (place / "a.tdms").write_bytes(whole[:length])
        assert len(check_test(place)) == 1


def test_a_tdms_file_takes_no_more_memory_than_its_size_allows(tmp_path):
    """In a process of its own: one that has freed memory before could take it again."""
    nptdms = pytest.importorskip("nptdms")
    place = samples.folder(
        tmp_path / "t",
        "pyrometer:\n  file: a.tdms\n  columns:\n    signal_wide: {name: pyro/S1}\n"
        "    signal_narrow: {name: pyro/S2}\n",
    )
    timing = {"wf_increment": 1e-3, "unit_string": "nA"}
    with nptdms.TdmsWriter(place / "a.tdms") as writer:
        values = np.ones(4_000_000)
        writer.write_segment([nptdms.ChannelObject("pyro", name, values, timing) for name in ("S1", "S2")])
    words = (
        "from plasmapyro import foreign\nfrom plasmapyro.readers.stage import check_test\n"
        "foreign.ANY_FILE, foreign.PER_BYTE = 20_000_000, 0  # bytes; a channel has 32 MB\n"
        f"print(check_test({str(place)!r}))"
    )
    said = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True).stdout
    assert "a.tdms: asks for more memory than its size allows" in said


YAML = {
    "an unknown key": ("pyrometr:\n  file: x\n", "did you mean 'pyrometer'"),
    "an alias bomb": ("a: &a [x, x]\nb: *a\n", "aliases (*name) are not taken"),
    "a repeated key": ("pyrometer:\n  file: a\n  file: b\n", "key 'file' is given twice"),
    "an outside file": ("pyrometer:\n  file: ../secret.csv\n", "must name a file inside the test folder"),
    "a deep nest": ("a: " + "[" * 40 + "]" * 40 + "\n", "nested too deeply"),
    "a tag": ("a: !!python/object/apply:os.system [ls]\n", "a is not a known key"),
    "no instrument": ("", "describes no pyrometer, spectrometer or radiometer"),
    "a wrong unit": (samples.CSV.replace("nA", "nm"), "'nm' is not a unit of signal_wide"),
    "a list for a section": ("pyrometer: [a]\n", "pyrometer must hold keys and values"),
    "broken": ("pyrometer: {a\n", "not readable as YAML"),
}


@pytest.mark.parametrize("case", YAML)
def test_a_wrong_description_is_refused(tmp_path, case):
    parts, words = YAML[case]
    found = check_test(samples.folder(tmp_path / "t", parts, pyrometer__csv=samples.table()))
    assert found
    assert words in "\n".join(found)


def test_everything_wrong_is_said_at_once(tmp_path):
    parts = samples.CSV + "spectrometer:\n  quantity: colour\n"
    place = samples.folder(tmp_path / "t", parts, pyrometer__csv=samples.table().replace("54.00", "x"))
    text = (place / "test.yaml").read_text()
    (place / "test.yaml").write_text(
        text.replace("[0.0, 5.0]", "5").replace("  emittance: 0.85", "  emittance: a")
    )
    found = "\n".join(check_test(place))
    for words in ("reference_window", "emittance", "quantity", "'x' in column 'S1'"):
        assert words in found
    with pytest.raises(Refusal, match="reference_window"):
        read_test(place)


def test_netcdf_folders_and_files_are_read_as_they_are(tmp_path):
    from plasmapyro import io

    test = read(tmp_path, pyrometer__csv=samples.table())
    stored = tmp_path / "stored"
    io.write(test, stored / "test.nc", "test")
    for place in (stored, stored / "test.nc"):
        np.testing.assert_array_equal(read_test(place).signal_wide, test.signal_wide)
    assert sources(stored) == [stored / "test.nc"]
    (stored / "test.yaml").write_text("a: b\n")
    assert "keep the one that is meant" in check_test(stored)[0]
    assert "no such folder" in check_test(tmp_path / "nowhere")[0]
    (stored / "test.yaml").unlink()
    (stored / "test.nc").write_bytes(b"not netcdf")
    assert "not a readable netCDF" in check_test(stored)[0]


def test_a_netcdf_with_senseless_attributes_or_too_large_is_refused(tmp_path):
    import netCDF4

    path = tmp_path / "test.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 5)
        for name in ("time", "signal_wide", "signal_narrow"):
            file.createVariable(name, "f8", ("time",))[:] = np.arange(5.0)
            file[name].units = "s" if name == "time" else "A"
        file["signal_wide"].scale_factor = "many"
    assert len(check_test(path)) >= 1
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 400_000_000)
        file.createVariable("signal_wide", "f8", ("time",), zlib=True)
    assert path.stat().st_size < 1e6
    assert "says that it holds 4800 MB, and has 0.00614 MB itself" in check_test(path)[0]


def test_absurd_numbers_and_names_end_in_words(tmp_path):
    scaled = samples.CSV.replace("S1, unit: nA", "S1, unit: nA, scale: 1e308").replace("nA", "A")
    found = check_test(samples.folder(tmp_path / "t", scaled, pyrometer__csv=samples.table()))
    assert "infinite" in found[0]
    for name in ('"a\\0b"', "x" * 5000, "/etc/passwd", "a/../../b"):
        found = check_test(samples.folder(tmp_path / "u", f"pyrometer:\n  file: {name}\n"))
        assert "inside the test folder" in found[0]
    assert check_test("x" * 5000)
    place = samples.folder(tmp_path / "v", samples.CSV, pyrometer__csv="a" * 6_000_000)
    assert "6000000 characters" in check_test(place)[0]
