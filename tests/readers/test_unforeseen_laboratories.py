"""Folders as laboratories write them whom nobody asked: `init` describes them so that they are read right."""

import gzip
import json
from datetime import datetime, timedelta

import h5py
import numpy as np
import pytest
from scipy.io import savemat
from test_first_description import NARROW, RTOL, WIDE, described
from test_laboratory_habits import ROWS

from plasmapyro.readers.guess import describe
from plasmapyro.readers.stage import check_test
from plasmapyro.readers.text import Refusal, missing, number

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


def archived(time):
    """A moment as WinCC counts it: millionths of days since 1900."""
    return f"{46149e6 + time / 0.0864:.6f}".replace(".", ",")


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
    "a Swedish minus": table(
        "Tid [s];S1 [A];S2 [A]", lambda t, w, n: (t, f"{w}e\u22129", f"{n}e\u22129"), ";", ","
    ),
    "UTF-16 without its mark": PLAIN.encode("utf-16-le"),
    "UTF-16 of another machine without its mark": PLAIN.encode("utf-16-be"),
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
    "thousands between semicolons": table(
        "Time [s];S1 [pA];S2 [pA]", lambda t, *p: (f"{t:.2f}", *(f"{v * 1e3:,.1f}" for v in p)), ";"
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
    "Graphtec": '"Model","GL840"\n"Interval","1s"\n"CH","Signal","Input","Range"\n"CH1","wide","DC","20V"\n'
    + table(
        '"Number","Date&Time","ms","wide","narrow","Alarm"\n"NO.","Time","ms","nA","nA","A123"',
        lambda t, w, n: (
            *(int(t) + 1, f"{NOON + timedelta(seconds=t):%Y/%m/%d %H:%M:%S}", "  0"),
            *(f"+ {w:8.3f}", f"+ {n:8.3f}", '"LLLL"'),
        ),
    ),
    "Yokogawa": '"Model","GX20"\n\n"CH","","","0001","0002"\n"Tag","","","Pyro wide","Pyro narrow"\n'
    + table(
        '"Unit","","","nA","nA"\n"Date","Time","ms","",""',
        lambda t, *pair: (*f"{NOON + timedelta(seconds=t):%Y/%m/%d %H:%M:%S}".split(), "000", *pair),
    ),
    "an oscilloscope that states more": table(
        "Length,Analog:20\nUnits,CH1:A,CH2:A\nModel,X2\nSource,CH1,CH2\nSecond,Ampere,Ampere",
        lambda t, w, n: (t, w * 1e-9, n * 1e-9),
    ),
    "spans of time": table(",t,wide_nA,narrow_nA", lambda t, *p: (int(t), f"0 days 00:00:{t:09.6f}", *p)),
    "seconds with their unit": table("Time,wide_nA,narrow_nA", lambda t, *p: (f"{t} sec", *p)),
    "names and numbers": "".join(f"t={t} s1_nA={w} s2_nA={n}\n" for t, w, n in SAMPLES),
    "wide numbers below names with blanks": "  Time s     Wide pA    Narrow pA\n"
    + "".join(f"{t:9.2f} {1e3 * w:9.3f} {1e3 * n:9.3f}\n" for t, w, n in SAMPLES),
    "lines of words within": PLAIN.replace("\n15.0,", "\n# lost\n15.0,").replace("\n5.0,", "\n! back\n5.0,"),
    "an oscilloscope": table("x-axis,1,2\nsecond,Ampere,Ampere", lambda t, w, n: (t, w * 1e-9, n * 1e-9)),
    "minutes and seconds": table(
        "Elapsed;Wide (nA);Narrow (nA)",
        lambda t, *p: (f"{int(t + 50) // 60:02d}:{(t + 50) % 60:05.2f}", *p),
        ";",
    ),
    "smallest and largest values above": table(
        "Variable;Zeitstempel;breit;schmal\nEinheit;s;nA;nA\nMinimum;0;50;30\nMaximum;19;69;39.5",
        lambda *row: ("", *row),
        ";",
    ),
    "Igor": "IGOR\rWAVES/D\tt_ms\twide_nA\tnarrow_nA\rBEGIN\r"
    + "".join(f"\t{1e3 * t}\t{w}\t{n}\r" for t, w, n in SAMPLES)
    + 'END\rX SetScale/P x 0,1,"", t_ms\r',
    "Igor by its scale": "IGOR\nWAVES\tWide\tNarrow\nBEGIN\n"
    + "".join(f"\t{w}\t{n}\n" for _, w, n in SAMPLES)
    + 'END\nX SetScale/P x 0,1,"s", Wide,Narrow; SetScale d 0,0,"nA", Wide\nX SetScale d 0,0,"nA", Narrow\n',
    "LabVIEW without times": "LabVIEW Measurement\nX_Columns\tNo\nX0\t0.0\t0.0\nDelta_X\t1.0\t1\n***End***\n"
    + table("X_Value\tWide (nA)\tNarrow (nA)\tComment", lambda t, *pair: ("", *pair), "\t"),
    "LabVIEW with units above": "LabVIEW Measurement\nX_Columns\tOne\nTime\t10:22:31,4\n***End***\n"
    + "Time\t1,5\t1,5\nY_Unit_Label\tnA\tnA\nX_Dimension\tTime\tTime\nX0\t0,0\t0,0\nDelta_X\t1,0\n***\n"
    + table("X_Value\tPyro_breit\tPyro_schmal\tComment", lambda *row: (*row, ""), "\t", ","),
    "names with blanks": "log, run 2\n\n  Time (s)   Signal 1 (nA)   Signal 2 (nA)\n"
    + "".join(f"{t:10.2f}{w:16.3f}{n:16.3f}\n" for t, w, n in SAMPLES),
    "remarks below the names": table(
        "Zeit [s]\tPyro breit [nA]\tPyro schmal [nA]\n1 Hz\t1 Hz\t1 Hz", lambda *row: row, "\t", ","
    ),
    "units behind the readings": table(
        "Reading1,Reading2,Time", lambda t, w, n: (f"{w:+.6E}nA", f"{n:+.6E}nA", f"{t:+.3E}s")
    ),
    "months by name": table(
        "Zeit,S1 [nA],S2 [nA]",
        lambda t, *pair: (f"{NOON + timedelta(seconds=t):%d-Mai-%Y %H:%M:%S}:000", *pair),
    ),
    "stamps without signs": table(
        "timestamp,S1 [nA],S2 [nA]",
        lambda t, *pair: (f"{NOON + timedelta(seconds=t):%Y%m%dT%H%M%S}.0", *pair),
    ),
    "nanoseconds since 1970": table(
        "name,time,S1 [nA],S2 [nA]", lambda t, *pair: ("p", f"{1778155190 + int(t)}000000000", *pair)
    ),
    "words of spreadsheets": "sep=;\n"
    + table("Zeit;Signal 1;Signal 2;Bemerkung\ns;nA;nA;", lambda *row: (*row, ""), ";", ",").replace(
        "5,0;55,0;32,5;", "5,0;55,0;32,5;\n5,5;#WERT!;#DIV/0!;"
    ),
    "a recorder without times": '"Header Size",7\n"TraceName","Pyro wide","Pyro narrow"\n"VUnit","nA","nA"\n'
    '"HResolution",1.0e+0,1.0e+0\n"HOffset",0.0,0.0\n"HUnit","s","s"\n"Date","2026/05/07","2026/05/07"\n'
    + "".join(f",{w},{n}\n" for _, w, n in SAMPLES),
    "an archive of values, its times in days": '"VarName";"TimeString";"VarValue";"Validity";"Time_ms"\n'
    + "".join(
        f'"{name}";"07.05.2026 12:{t:02.0f}";{str(value).replace(".", ",")};1;{archived(t)}\n'
        for t, *pair in SAMPLES
        for name, value in zip(("Pyro_S1_nA", "Pyro_S2_nA"), pair, strict=True)
    )
    + '"$RT_OFF$";"07.05.2026 13:00";0;2;46149500000,0\n',
    "an archive with units": table(
        "Index,Channel,Reading,Unit,Time,Relative Time",
        lambda t, w, n: (f"1,101,{w},nA,11:59:50,{t}\n2,102,{n}", "nA", "11:59:50", t),
    ),
    "units that change within a column": table(
        '"Time","Pyro S1","Pyro S2"',
        lambda t, w, n: (
            f"{NOON + timedelta(seconds=t):%Y-%m-%d %H:%M:%S}",
            f"{w} nA" if t % 2 else f"{w / 1e3} \u00b5A",
            f"{1e3 * n} pA",
        ),
    ),
    "catman": "HBM_CATMAN_DATAFILE_40\nCOMMENT LINES = 0\n\nZeit  1 - Standardabtastrate\tPyro_S1\tPyro_S2\n"
    "Computer-Zeit\tMX840A_0 CH 1\tMX840A_0 CH 2\n"
    + "\n".join(["\t".join([word] * 3) for word in ("T0 = 12.03.2026 14:22:01", "dt = 1000 ms")])
    + table("\ns\tnA\tnA\n\t\t\nSR=1 Hz\tSR=1 Hz\tSR=1 Hz", lambda *row: row, "\t", ","),
    "LabVIEW with times for each": "LabVIEW Measurement\nX_Columns\tMulti\n***End***\n"
    + table("X_Value\tWide (nA)\tX_Value\tNarrow (nA)\tComment", lambda t, w, n: (t, w, t, n, ""), "\t"),
    "typographic thousands": table(
        "Zeit [s];S1 [pA];S2 [pA]",
        lambda t, *p: (t, *(f"{v * 1e3:,.1f}".replace(",", "\u2019") for v in p)),
        ";",
    ),
    "names of rows of R": '"t_s" "S1_nA" "S2_nA"\n'
    + "".join(f'"{i}" {t} {w} {n}\n' for i, (t, w, n) in enumerate(SAMPLES, 1)),
    "a delimiter before the names": table("\tTime_s\tWide_nA\tNarrow_nA", lambda *row: row, "\t"),
    "parts of days of a spreadsheet": table(
        "Time;S1 [nA];S2 [nA]", lambda t, *p: (f"{0.25 + t / 86400:.12f}", *p), ";"
    ),
    "times without a name": table(
        ',"Pyro S1 Ave. (nA)","Pyro S2 Ave. (nA)"',
        lambda t, *p: (f"{(NOON + timedelta(seconds=t)).isoformat()}+01:00", *p),
    ),
    "minutes beside milliseconds": table(
        "Date,Elapsed (ms),S1 (nA),S2 (nA)",
        lambda t, *p: (f"{NOON + timedelta(seconds=t):%Y-%m-%d %H:%M}", 1e3 * t, *p),
    ),
    "a remark above numbers without names": "# run\n" + "".join(f"{t} {w} {n}\n" for t, w, n in SAMPLES),
    "letters that are none": PLAIN.replace("S1", "S\x8e1").replace("S2", "S2").encode("latin-1"),
}


@pytest.mark.parametrize("habit", TABLES)
def test_a_table_gives_its_signals(tmp_path, habit):
    test, _ = described(tmp_path / "Été 3", log__csv=TABLES[habit])
    atol = 2e-5 if "days" in habit else 1e-9  # s: ten digits of a day
    given = np.isfinite(test.signal_wide.values)  # '#WERT!' is no sample
    np.testing.assert_allclose(test.time[given], np.arange(ROWS), atol=atol)
    np.testing.assert_allclose(test.signal_wide[given], WIDE, rtol=RTOL)
    np.testing.assert_allclose(test.signal_narrow[given], NARROW, rtol=RTOL)


def arrays(place, kind):
    """SAMPLES as a file of arrays."""
    names = dict(zip(("t_s", "wide_nA", "narrow_nA"), np.array(SAMPLES).T, strict=True))
    if kind == "mat":
        savemat(place / "shot.mat", {"run": {**names, "title": "x"}})
    elif kind == "h5":
        with h5py.File(place / "shot.h5", "w") as file:
            for name, values in names.items():
                file["run/" + name.partition("_")[0]] = values[:, None]
                file["run/" + name.partition("_")[0]].attrs["units"] = name.partition("_")[2]
            file["spectra"] = np.ones((7, 60))
    elif kind == "rows.h5":
        rows = np.array(SAMPLES).ravel().view([(name, float) for name in names])
        with h5py.File(place / "shot.h5", "w") as file:
            file["log"] = rows
    elif kind == "npz":
        np.savez(place / "shot.npz", **names)
    else:
        rows = [json.dumps(dict(zip(names, row, strict=True))) for row in SAMPLES]
        channels = [
            {"name": n.split("_")[0], "unit": "nA", "data": [*v]}
            for n, v in names.items()
            if "t" not in n[:2]
        ]
        texts = {
            "jsonl": "\n".join(rows),
            "ndjson": "".join(
                json.dumps({"ts": 1778155190000 + 1000 * t, "pay": {"s1_nA": w, "s2_nA": n}}) + "\n"
                for t, w, n in SAMPLES
            ),
            "json": f"[{','.join(rows)}]",
            "channels.json": json.dumps({"by": "lab", "t_s": [*names["t_s"]], "channels": channels}),
        }
        (place / f"shot.{kind}").write_text(texts[kind])


@pytest.mark.parametrize("kind", ["mat", "h5", "rows.h5", "npz", "json", "channels.json", "jsonl", "ndjson"])
def test_arrays_of_a_file_are_columns(tmp_path, kind):
    (tmp_path / "t").mkdir()
    arrays(tmp_path / "t", kind)
    test, questions = described(tmp_path / "t")
    np.testing.assert_allclose(test.time, np.arange(ROWS))
    np.testing.assert_allclose(test.signal_wide, WIDE, rtol=RTOL)
    np.testing.assert_allclose(test.signal_narrow, NARROW, rtol=RTOL)
    assert not any("unit" in words for words in questions if "time" not in words)


@pytest.mark.parametrize(
    ("narrow", "wide"),
    [("Smalband", "Breedband"), ("Pasmo wąskie", "Pasmo szerokie"), ("Узкий", "Широкий"), ("窄带", "宽带")],
)
def test_a_name_tells_the_bands_where_the_narrow_one_is_brighter(tmp_path, narrow, wide):
    """By its size alone, which had been taken, the narrow band would be the wide one."""
    (tmp_path / "log.csv").write_text(table(f"t [s];{narrow} [nA];{wide} [nA]", lambda *row: row, ";"))
    words = describe(tmp_path)
    text = words if isinstance(words, str) else words[0]
    assert f'signal_wide: {{name: "{wide}"}}' in text and f'signal_narrow: {{name: "{narrow}"}}' in text


def test_spectra_in_a_file_of_arrays_are_told_what_to_do(tmp_path):
    savemat(tmp_path / "a.mat", {"wavelength": np.linspace(700, 900, 60), "counts": np.ones((9, 60))})
    with pytest.raises(Refusal, match="from such a file, spectra are not: save them as text"):
        describe(tmp_path)


def test_a_band_may_stand_in_a_file_of_its_own(tmp_path):
    def one(place):
        return table("Interval,1,,\nTime,Ampl [nA]", lambda *row: (row[0], row[place]))

    test, questions = described(tmp_path / "t", pyro_C1__txt=one(2), pyro_C2__txt=one(1))
    np.testing.assert_allclose(test.signal_wide, WIDE, rtol=RTOL)
    np.testing.assert_allclose(test.signal_narrow, NARROW, rtol=RTOL)
    assert any("which file is the wide band?" in words for words in questions)
    named = (
        table("timestamp,wide_nA", lambda t, w, n: (1.75e9 + t, w)),
        table("timestamp,narrow_nA", lambda t, w, n: (1.75e9 + t, n)),
    )
    test, questions = described(tmp_path / "n", b__csv=named[0], a__csv=named[1])
    np.testing.assert_allclose([test.signal_wide, test.signal_narrow], [WIDE, NARROW], rtol=RTOL)
    assert not any("wide band" in words for words in questions)
    (tmp_path / "t" / "pyro_C1.txt").write_text(one(2).replace("\n19.0,", "\n20.0,"))
    (message,) = check_test(tmp_path / "t")
    assert "has 20 times from 0 to 20 s" in message and "at the same moments" in message


def test_volts_are_asked_for_their_amperes(tmp_path):
    test, questions = described(
        tmp_path / "t", log__csv=table("Time [s],CH1 <wide> (VDC),CH2 <narrow> (VDC)", lambda *row: row)
    )
    np.testing.assert_allclose(test.signal_wide, WIDE * 1e3, rtol=RTOL)  # 1 uA per V
    assert sum("how many amperes is one?" in words for words in questions) == 2


REFUSED = {
    "temperatures alone": (
        "a.txt",
        table(
            "Date;Time;T [degC];Emissivity [%]",
            lambda t, *_: ("1.2.2026", f"10:00:{int(t):02d}", 900, 100),
            ";",
        ),
        "'T', 'Emissivity'; temperatures alone cannot be corrected",
    ),
    "pixels without wavelengths": (
        "a.txt",
        "Pixel\tCounts\n" + "".join(f"{i}\t{500 + i}\n" for i in range(40)),
        "holds pixels without wavelengths",
    ),
    "one band": ("a.csv", table("t_s,value_nA", lambda *row: row[:2]), "one signal ('value') against time"),
    "one band of a radiometer": (
        "a.csv",
        table("t_s,value_nA", lambda *row: row[:2]),
        "an instrument of one band is described as a `radiometer`",
    ),
    "a tail of zeros": (
        "a.csv",
        PLAIN + "\0" * 512,
        "a.csv: ends in 512 zero bytes, as after a loss of power; the samples there are lost",
    ),
    "a workbook": (
        "a.xlsx",
        b"PK\x03\x04rest",
        "is a packed file or a workbook, not text; save the sheet as CSV",
    ),
    "a mark and nothing else": ("a.csv", b"\xff\xfe", "no columns of numbers"),
    "values logged one after the other": (
        "a.csv",
        table(
            "Index,Channel,Reading,Unit,Time",
            lambda t, w, n: (f"1,101,{w},nA,{t}\n2,102,{n}", "nA", t + 0.02),
        ),
        "'101' and '102' are logged at moments of their own (0.0 and 0.02)",
    ),
    "a damaged Matlab file": ("a.mat", b"MATLAB 5.0 MAT-file" + b"\0" * 200, "cannot be read"),
    "arrays of other files": (
        "a.json",
        b'{"a": [1, 2]}',
        "holds no two columns of numbers of one length (a)",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_read_is_told_with_what_to_do(tmp_path, case):
    name, content, words = REFUSED[case]
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(Refusal) as refusal:
        describe(tmp_path)
    assert words in str(refusal.value), str(refusal.value)


@pytest.mark.parametrize(
    ("times", "words"),
    [
        (lambda i: i % 10, "goes back to the begin (was the logger restarted?)"),
        (
            lambda i: i - 5 if i < 10 else i - 10,
            "goes back by 4 s (was the logger restarted?)",
        ),
        (lambda i: i // 4, "is given in steps of 1 s only"),
        (lambda i: i // 2, "if lines stand there twice, remove their copies"),
        (lambda i: ROWS - i, "the time runs backwards"),
        (lambda i: i ^ 4 if i > 7 else i, "sort the lines by their time"),
        (lambda i: f"{i},0,1", "commas in the numbers as well?"),
    ],
)
def test_a_clock_that_cannot_be_right_is_named(tmp_path, times, words):
    rows = "".join(f"{times(i)},{50 + i},{30 + i / 2}\n" for i in range(ROWS))
    (tmp_path / "log.csv").write_text("t [s],S1 [nA],S2 [nA]\n" + rows)
    (tmp_path / "test.yaml").write_text(describe(tmp_path).text)
    assert any(words in one for one in check_test(tmp_path))


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
    [
        "OVER",
        "1.#INF",
        "-1.#IND",
        "1.#QNAN",
        "#N/A",
        "Inf",
        "---",
        "O.L",
        "9.9E37",
        "-9999",
        "-999.25",
        "(null)",
    ]
    + ["-nan(ind)", "?", "****", "-1.#J", "BAD"],
)
def test_what_meters_show_instead_of_a_number_is_no_sample(tmp_path, word):
    test, _ = described(tmp_path / "t", log__csv=PLAIN.replace("3.0,53.0,31.5", f"3.0,{word},31.5"))
    assert np.flatnonzero(np.isnan(test.signal_wide)).tolist() == [3]
    assert np.isfinite(test.signal_narrow).all() and np.isfinite(test.time).all()
    assert number(word) is not None or missing(word)


@pytest.mark.parametrize(
    ("word", "decimal", "value"),
    [
        ("1,06,038.4", ".", 106038.4),
        ("12,34,56,789", ".", 123456789.0),
        ("10\u2019603.8", ".", 10603.8),
        ("10\u2009603,8", ",", 10603.8),
        ("1,06,38.4", ".", None),
        ("1,2345", ".", None),
    ],
)
def test_thousands_are_read_where_they_can_be_nothing_else(word, decimal, value):
    assert number(word, decimal) == value


def test_a_cell_longer_than_any_is_no_fault_of_ours(tmp_path):
    test, _ = described(tmp_path, log__csv=f'"{"x" * 140_000}",TraceName\n' + PLAIN)
    np.testing.assert_allclose(test.signal_wide, WIDE, rtol=RTOL)


def test_signals_logged_at_moments_of_their_own_are_refused(tmp_path):
    rows = "".join(f"{t}\t{w}\t\n{t + 0.5}\t\t{n}\n" for t, w, n in SAMPLES)
    (tmp_path / "log.txt").write_text("Time [s]\tS1 [nA]\tS2 [nA]\n" + rows)
    (tmp_path / "test.yaml").write_text(describe(tmp_path).text)
    assert any("never stand in one row" in one for one in check_test(tmp_path))


AIR = np.linspace(700.0, 1000.0, 40)
COUNTS = 1000.0 + 10 * np.arange(3)[:, None] + np.arange(40)
DARK = 500.0 + np.arange(40.0)
MOMENTS = [0.5, 1.5, 2.5]


def matrix(first, rows, mark=","):
    return "\n".join(mark.join(map(str, row)) for row in [first, *rows]) + "\n"


def upright(header, *series):
    return matrix(header, zip(AIR, *series, strict=True), "\t")


def long(header, spectra, moments):
    """A table of a row per pixel."""
    rows = ([t, a, c] for t, row in zip(moments, spectra, strict=True) for a, c in zip(AIR, row, strict=True))
    return matrix(header, rows)


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
    "behind columns of other things": {
        "s.csv": matrix(
            ["time_s", "exposure_ms", "T_detector", *AIR],
            ([t, 500, -10.1, *c] for t, c in zip(MOMENTS, COUNTS, strict=True)),
        ),
        "dark.csv": upright(["nm", "D"], DARK),
    },
    "in columns below words": {
        "s.csv": matrix(
            ["Wavelength (nm)", *(f"Spectrum {t} s" for t in MOMENTS)], zip(AIR, *COUNTS, strict=True)
        ),
        "dark.csv": upright(["nm", "D"], DARK),
    },
    "as OceanView exports a series": {
        "s.txt": "Data from x\nIntegration Time (sec): 5.0E-1\n>>>>>Begin Spectral Data<<<<<\n"
        + matrix(["", "", *AIR], ([stamp(t), 0, *c] for t, c in zip(MOMENTS, COUNTS, strict=True)), "\t"),
        "dark.csv": upright(["nm", "D"], DARK),
    },
    "in columns below clock times": {
        "s.csv": matrix(["Timestamp", *map(stamp, MOMENTS)], zip(AIR, *COUNTS, strict=True)),
        "dark.txt": upright(["nm", "D"], DARK),
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
    "a row per pixel": {
        "s.csv": long(["Frame", "Wavelength", "Intensity"], COUNTS, range(1, 4)),
        "dark.csv": long(["Frame", "Wavelength", "Intensity"], [DARK], [1]),
    },
    "a row per pixel with its time": {
        "s.csv": long(["time_s", "wavelength_nm", "counts"], COUNTS, MOMENTS),
        "dark.csv": matrix(["wavelength_nm", "counts"], zip(AIR, DARK, strict=True)),
    },
    "times in a row above": {
        "s.txt": "No\t1\t2\t3\nTime [s]\t0.5\t1.5\t2.5\n" + upright(["Wavelength [nm]", "", "", ""], *COUNTS),
        "dark.txt": "#Acq. time (s)=\t0.25\n" + upright(["#Title=", "dark"], DARK),
    },
    "as Andor Solis exports them": {
        name: "Model: DU420\nExposure Time (secs): 0.5\nKinetic Cycle Time (secs): 1.0\n\n"
        + matrix([], zip(AIR, *rows, strict=True)).removeprefix("\n")
        for name, rows in (("s.asc", COUNTS), ("dark.asc", [DARK]))
    },
    "as B&W Tek and Thorlabs export them": {
        f"run/{name}.txt": "title;\nintigration times(ms);500\nIntegrationTime,500\n[Data]\n"
        + matrix(
            ["Pixel", "Wavelength", "Wavenumber", "Dark", "Reference", "Raw data #1", "Dark Subtracted #1"],
            (
                (i, a, 1e7 / a, d, 65535, s, s - d, "")
                for i, (a, d, s) in enumerate(zip(AIR, DARK, row, strict=True))
            ),
            ";",
        )
        + "[EndOfFile]\n"
        for name, row in zip(("spec_1", "spec_2", "spec_3"), COUNTS, strict=True)
    },
    "among others": {
        f"run/{name}.SSM": f'"File: {name}"\n"Int:500ms Aver:1"\n'
        + matrix([], zip(AIR, row, strict=True), "  ").strip("\n")
        + "\n"
        for name, row in zip(
            ("f1", "f2", "f3", "lamp HL", "dark"), [*COUNTS, COUNTS[0] * 2, DARK], strict=True
        )
    }
    | {"run/readme.txt": "taken in May\n"},
    "below words": {"s.csv": "Maya\nIntegration: 500 ms\n\n" + LYING, "dark.csv": LYING_DARK},
    "against clock times": {
        "s.csv": matrix(["time", *AIR], ([stamp(t), *row] for t, row in zip(MOMENTS, COUNTS, strict=True))),
        "dark.csv": LYING_DARK,
    },
    "as WinSpec exports them": {
        f"run/{name}.txt": matrix([], zip(AIR, [1] * 40, row, strict=True), "\t").removeprefix("\n")
        for name, row in zip(("s01", "s02", "s03", "bg"), [*COUNTS, DARK], strict=True)
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


def test_counts_per_second_and_wavelengths_without_a_unit_are_asked_for(tmp_path):
    for name, row in {"s1": COUNTS[0], "s2": COUNTS[1], "dark": DARK}.items():
        (tmp_path / "t" / "run").mkdir(parents=True, exist_ok=True)
        text = upright(["Wavelength (nm)", "Intensity (counts/s)"], row)
        (tmp_path / "t" / "run" / f"{name}.txt").write_text(text)
    (tmp_path / "t" / "other.csv").write_text(
        matrix(["lambda", 1, 2, 3], zip(10 * AIR, *COUNTS, strict=True))
    )
    test, questions = described(tmp_path / "t", log__csv=PLAIN)
    assert test.attrs["spectrometer_integration_time"] == 1.0
    assert any("counts per second" in words for words in questions)
    assert any("'lambda' runs from 7000 to 10000; write the unit" in words for words in questions)


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
    assert any("not used: other.txt: no columns of numbers with a time" in words for words in questions)
    _, questions = described(tmp_path / "u", log__csv=PLAIN, dark__csv=LYING_DARK)
    assert any("dark.csv looks like a dark, and no table like its spectra" in words for words in questions)
    series = "".join(
        f"{one:.3f}\t" + "\t".join(f"{c[i]:g}" for c in COUNTS) + "\n" for i, one in enumerate(AIR)
    )
    dark = "".join(f"{one:.3f}\t{c:g}\n" for one, c in zip(AIR, COUNTS[0], strict=True))
    series += "\nExposure Time (secs):\t0.5\nKinetic Cycle Time (secs):\t1\n"
    (tmp_path / "w").mkdir()
    for name, words in (("log.csv", PLAIN), ("run.asc", series), ("dark.asc", dark)):
        (tmp_path / "w" / name).write_text(words)
    questions = describe(tmp_path / "w").questions
    assert any("when, after the begin of the series, is 0?" in words for words in questions)
    assert any("not used: dark.asc: looks like a spectrum" in words for words in questions)
    shown = "t [s],T ratio [degC],Laser power [kW]\n" + "".join(f"{i}.0,90{i}.0,1.0\n" for i in range(9))
    spectra = matrix(["t", *AIR], ([t, *c] for t, c in zip(MOMENTS, COUNTS, strict=True)))
    (tmp_path / "v").mkdir()
    for name, words in (("shown.csv", shown), ("s.csv", spectra)):
        (tmp_path / "v" / name).write_text(words)
    questions = describe(tmp_path / "v").questions
    assert any("not used: shown.csv" in words and "temperatures alone" in words for words in questions)


def test_a_gain_that_is_a_number_is_told_its_key(tmp_path):
    signals = "".join(f"    signal_{band}: {{name: S, unit: A, gain: 1e5}}\n" for band in ("wide", "narrow"))
    (tmp_path / "test.yaml").write_text("pyrometer:\n  columns:\n    time: {name: t, unit: s}\n" + signals)
    words = "\n".join(check_test(tmp_path))
    assert "signal_wide.gain names a column, and 1e5 is a number; a gain that stays is `scale`" in words


def test_arrays_beside_slower_ones_are_found_and_unequal_ones_named(tmp_path):
    samples = np.array(SAMPLES)
    slow = {name: np.arange(ROWS / 4) for name in ("t_tunnel", "p", "flow", "power")}
    arrays = dict(zip(("t", "S1", "S2"), samples.T, strict=True))
    savemat(tmp_path / "log.mat", arrays | slow)
    (tmp_path / "test.yaml").write_text(
        "pyrometer:\n  file: log.mat\n  columns:\n    time: {name: t, unit: s}\n"
        "    signal_wide: {name: S1, unit: nA}\n    signal_narrow: {name: S2, unit: nA}\n"
    )
    assert not [one for one in check_test(tmp_path) if "log.mat" in one]
    assert '"S1"' in describe(tmp_path).text
    savemat(tmp_path / "log.mat", arrays | {"t": samples[:-3, 0]})
    (words,) = [one for one in check_test(tmp_path) if "log.mat" in one]
    assert "holds arrays of different lengths" in words and f"t {ROWS - 3}" in words and f"S1 {ROWS}" in words
