"""Folders as laboratories write them whom nobody asked: `init` describes them so that they are read right."""

import gzip
from datetime import datetime, timedelta

import numpy as np
import pytest
from test_first_description import NARROW, RTOL, WIDE, described
from test_laboratory_habits import ROWS

from plasmapyro.readers.stage import check_test
from plasmapyro.readers.text import MISSING, number

SAMPLES = [(float(i), 50.0 + i, 30.0 + i / 2) for i in range(ROWS)]
NOON = datetime(2026, 5, 7, 11, 59, 50)


def table(header, form, mark=",", decimal="."):
    """A table of SAMPLES; `form` makes the cells of a row."""
    rows = [mark.join(str(cell).replace(".", decimal) for cell in form(*row)) for row in SAMPLES]
    return header + "\n" + "\n".join(rows) + "\n"


def zoned(time, wide, narrow):
    """Clock times of Central Europe on the night of the end of summer time."""
    moment, zone = datetime(2026, 10, 25, 2, 59, 50) + timedelta(seconds=time), "+02:00"
    if moment >= datetime(2026, 10, 25, 3):
        moment, zone = moment - timedelta(hours=1), "+01:00"
    return f"{moment.isoformat(timespec='milliseconds')}{zone}", wide, narrow


PLAIN = table("Time [s],S1 [nA],S2 [nA]", lambda *row: row)
LABVIEW = "LabVIEW\nSeparator\tTab\nTime\t14:02:10.1\n***End***\nSamples\t20\t20\nX0\t0\t0\nDelta\t1\t1\n"
TABLES = {
    "UTC with decimals": table(
        "timestamp,S1 [nA],S2 [nA]",
        lambda t, *pair: (f"{(NOON + timedelta(seconds=t)).isoformat(timespec='milliseconds')}Z", *pair),
    ),
    "zones across the end of summer time": table("Zeitstempel,S1 [nA],S2 [nA]", zoned),
    "days of a spreadsheet": table(
        "Date;S1 [nA];S2 [nA]", lambda t, *p: (f"{46149.5 + t / 86400:.10f}", *p), ";"
    ),
    "a row of units": table("Time,S1,S2\ns,nA,nA", lambda *row: row),
    "a row of units in brackets": table("Time,S1,S2\n[s],[nA],[nA]", lambda *row: row),
    "units behind a slash": table("t / s;S1 / nA;S2 / nA", lambda *row: row, ";", ","),
    "blocks of numbers above": LABVIEW + table("Time [s]\tS1 (nA)\tS2 (nA)", lambda *row: row, "\t"),
    "UTF-16 without its mark": PLAIN.encode("utf-16-le"),
    "a Japanese Windows": PLAIN.replace("Time", "時間")
    .replace("S1", "広帯域")
    .replace("S2", "狭帯域")
    .encode("cp932"),
    "French names": PLAIN.replace("S1", "Voie large").replace("S2", "Voie étroite").encode("latin-1"),
    "German channels": PLAIN.replace("S1", "Kanal 1").replace("S2", "Kanal 2"),
    "halves of a day": table(
        "Date/Time,S1 [nA],S2 [nA]",
        lambda t, *p: ((NOON + timedelta(seconds=t)).strftime("%m/%d/%Y %I:%M:%S.%f %p"), *p),
    ),
    "units in the names": table("time_us,Wide_nA,Narrow_nA", lambda t, *p: (int(t * 1e6), *p)),
    "ticks": table("ticks (0.1 ms),S1 [nA],S2 [nA]", lambda t, *p: (int(t * 1e4), *p)),
    "thousands in quotes": table(
        "Time [s],S1 [pA],S2 [pA]", lambda t, *p: (t, *(f'"{value * 1e3:,.1f}"' for value in p))
    ),
    "thousands by points": table(
        "Zeit [s];S1 [pA];S2 [pA]",
        lambda t, *p: (t, *(f"{value * 1e3:,.1f}".replace(",", "!") for value in p)),
        ";",
        ",",
    ).replace("!", "."),
    "exponents of Fortran": table(
        "Time [s],S1 [A],S2 [A]", lambda t, *p: (t, *(f"{v * 1e-9:.10E}".replace("E", "D") for v in p))
    ),
    "remarks below the units": table("Time,S1,S2\ns,nA,nA\n,pyro wide,pyro narrow", lambda *row: row),
    "a header above each block": PLAIN.replace("\n9.0,", "\nTime [s],S1 [nA],S2 [nA]\n9.0,"),
    "letters that are none": PLAIN.replace("S1", "S\x8e1").replace("S2", "S2").encode("latin-1"),
}


@pytest.mark.parametrize("habit", TABLES)
def test_a_table_gives_its_signals(tmp_path, habit):
    test, _ = described(tmp_path / "Été 3", log__csv=TABLES[habit])
    atol = 2e-5 if "days" in habit else 1e-9  # s: ten digits of a day
    np.testing.assert_allclose(test.time, np.arange(ROWS), atol=atol)
    np.testing.assert_allclose(test.signal_wide, WIDE, rtol=RTOL)
    np.testing.assert_allclose(test.signal_narrow, NARROW, rtol=RTOL)


def test_a_packed_table_is_read_and_a_bomb_is_not(tmp_path):
    test, _ = described(tmp_path / "t", **{"log__csv__gz": gzip.compress(PLAIN.encode())})
    np.testing.assert_allclose(test.signal_wide, WIDE, rtol=RTOL)
    place = tmp_path / "t" / "log.csv.gz"
    for content, words in (
        (gzip.compress(b" " * 200_000_000), "bytes when unpacked"),
        (gzip.compress(PLAIN.encode())[:-20], "cut off"),
        (b"\x1f\x8b" + b"x" * 90, "broken gzip"),
    ):
        place.write_bytes(content)
        assert any(words in one for one in check_test(tmp_path / "t"))


@pytest.mark.parametrize(
    "word",
    ["OVER", "1.#INF", "-1.#IND", "1.#QNAN", "#N/A", "Inf", "---", "O.L", "9.9E37", "-9999", "(null)"]
    + ["-nan(ind)", "?", "****", "-1.#J", "BAD"],
)
def test_what_meters_show_instead_of_a_number_is_no_sample(tmp_path, word):
    test, _ = described(tmp_path / "t", log__csv=PLAIN.replace("3.0,53.0,31.5", f"3.0,{word},31.5"))
    assert np.flatnonzero(np.isnan(test.signal_wide)).tolist() == [3]
    assert np.isfinite(test.signal_narrow).all() and np.isfinite(test.time).all()
    assert number(word) is not None or word.lower() in MISSING


AIR = np.linspace(700.0, 1000.0, 40)
COUNTS = 1000.0 + 10 * np.arange(3)[:, None] + np.arange(40)
DARK = 500.0 + np.arange(40.0)
MOMENTS = [0.5, 1.5, 2.5]


def matrix(first, rows, mark=","):
    return "\n".join(mark.join(map(str, row)) for row in [first, *rows]) + "\n"


def upright(header, *series):
    return matrix(header, zip(AIR, *series, strict=True), "\t")


def stamp(time):
    return (NOON + timedelta(seconds=time)).strftime("%H:%M:%S.%f")


LYING = matrix(["t", *AIR], ([t, *row] for t, row in zip(MOMENTS, COUNTS, strict=True)))
LYING_DARK = matrix(["t", *AIR], [[0, *DARK]])
SPECTRA = {
    "a spectrum in each row": {"s.csv": LYING, "dark.csv": LYING_DARK},
    "in each column": {
        "s.csv": upright(["lambda [nm]", *MOMENTS], *COUNTS),
        "dark.csv": upright(["nm", "D"], DARK),
    },
    "from long to short, in um": {
        "s.csv": matrix(
            ["t", *AIR[::-1] / 1e3], ([t, *c[::-1]] for t, c in zip(MOMENTS, COUNTS, strict=True))
        ),
        "dark.csv": matrix(["t", *AIR[::-1] / 1e3], [[0, *DARK[::-1]]]),
    },
    "in Angstrom": {
        name: matrix(["t [s] / lambda [A]", *AIR * 10], rows)
        for name, rows in (
            ("s.csv", ([t, *row] for t, row in zip(MOMENTS, COUNTS, strict=True))),
            ("dark.csv", [[0, *DARK]]),
        )
    },
    "in columns with units": {
        "s.csv": upright(["Wavelength [nm]", *(f"{t} s" for t in MOMENTS)], *COUNTS),
        "dark.csv": upright(["Wavelength [nm]", "D"], DARK),
    },
    "behind the number of the pixel": {
        f"run/{name}.csv": "Gain,Low\n"
        + matrix(["Pixel", "Wavelength", "Intensity"], zip(range(40), AIR, row, strict=True))
        for name, row in zip(("000", "001", "002", "dark"), [*COUNTS, DARK], strict=True)
    },
    "as Avantes exports them": {
        f"run/{i:03}.txt": "Avantes\nWave   ;Sample   ;Dark     ;Reference;Scope\n"
        "[nm]   ;[counts] ;[counts] ;[counts]\n\n"
        + "".join(f"{a:.9f};{s:.1f};{d:.1f};0.0\n" for a, s, d in zip(AIR, row, DARK, strict=True))
        for i, row in enumerate(COUNTS)
    },
    "below words": {"s.csv": "Maya\nIntegration: 500 ms\n\n" + LYING, "dark.csv": LYING_DARK},
    "against clock times": {
        "s.csv": matrix(["time", *AIR], ([stamp(t), *row] for t, row in zip(MOMENTS, COUNTS, strict=True))),
        "dark.csv": LYING_DARK,
    },
    "two columns each": {
        f"run/{i:03}.asc": matrix([], zip(AIR, row, strict=True), "\t") for i, row in enumerate(COUNTS)
    }
    | {"dark.asc": matrix([], zip(AIR, DARK, strict=True), "\t")},
    "a dark beside each": {
        f"run/{i:03}.csv": matrix(
            ["Wavelength [nm]", "Dunkel", "Probe"], zip(AIR, DARK, row, strict=True), ";"
        )
        for i, row in enumerate(COUNTS)
    },
}


@pytest.mark.parametrize("habit", SPECTRA)
def test_spectra_are_found_beside_the_signals(tmp_path, habit):
    place = tmp_path / "t"
    for name, content in SPECTRA[habit].items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_text(content.removeprefix("\n"), encoding="utf-8")
    test, _ = described(place, log__csv=PLAIN)
    np.testing.assert_allclose(test.counts, COUNTS, rtol=RTOL)
    np.testing.assert_allclose(test.background_counts, DARK, rtol=RTOL)
    assert (test.wavelength.values / (AIR * 1e-9) - 1 > 2e-4).all()  # the index of air
    np.testing.assert_allclose(np.diff(test.spectrum_time, 2), 0, atol=1e-6)


def test_wavenumbers_are_not_taken_for_wavelengths(tmp_path):
    spectra = matrix(
        ["t [s] / nu [cm-1]", *1e7 / AIR], ([t, *c] for t, c in zip(MOMENTS, COUNTS, strict=True))
    )
    test, questions = described(tmp_path / "t", log__csv=PLAIN, s__csv=spectra)
    assert "wavelength" not in test.coords and any("not used: s.csv" in words for words in questions)


def test_no_file_is_left_out_without_a_word(tmp_path):
    _, questions = described(
        tmp_path / "t", log__csv=PLAIN, notes__bin=b"ab\x00\x01", other__txt="a letter\n"
    )
    assert any("not used: " in words and "notes.bin" in words for words in questions)
    assert any(
        "not used: other.txt: neither signals against time nor spectra" in words for words in questions
    )
    _, questions = described(tmp_path / "u", log__csv=PLAIN, dark__csv=LYING_DARK)
    assert any("dark.csv looks like a dark, and no table like its spectra" in words for words in questions)
