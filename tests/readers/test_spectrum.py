"""One spectrum in a text file, in the ways programs write it."""

import numpy as np
import pytest

from plasmapyro.readers.spectrum import read_frames
from plasmapyro.readers.text import Refusal

ROWS = [(400 + 0.5 * k, 10 + k % 7, 12 + k % 7) for k in range(25)]


@pytest.mark.parametrize(
    ("head", "line"),
    [
        ("wavelength,spectrum,second\n", "{},{},{}\n"),
        ("Model: DU970P\r\nExposure Time (secs): 0.1\r\n\r\n", "{},{},{},\r\n"),
        ("", "{}\t{}\t{}\n"),
        ("nm counts counts\n", "  {}   {}  {}\n"),
    ],
    ids=["commas", "Andor", "tabs", "spaces"],
)
def test_layouts(tmp_path, head, line):
    path = tmp_path / "s.txt"
    path.write_text(head + "".join(line.format(*row) for row in ROWS), newline="")
    wavelength, frames = read_frames(path)
    np.testing.assert_allclose(wavelength, [row[0] * 1e-9 for row in ROWS], rtol=1e-15)
    np.testing.assert_array_equal(frames, np.array(ROWS).T[1:])


def test_decimal_commas(tmp_path):
    path = tmp_path / "s.txt"
    path.write_text("".join(f"{a};{b}\n".replace(".", ",") for a, b, _ in ROWS))
    assert read_frames(path)[0][1] == pytest.approx(400.5e-9, rel=1e-12)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("only words\nand more\n", "no row of two"),
        (
            "".join(f"{a},{b}\n" for a, b, _ in ROWS[5:20] + ROWS[:5] + ROWS[20:]),
            "and 400 does not lie beyond 409.5",
        ),
        ("".join(f"{10 * a},{b}\n" for a, b, _ in ROWS[::9]), "if its name says so"),
        ("Raman shift (cm-1),I\n" + "".join(f"{a},{b}\n" for a, b, _ in ROWS), "over wavelength"),
        ("".join(f"{a},{b}\n" for a, b, _ in ROWS) + "412.1,x\n", "line 26"),
    ],
    ids=["words", "out of order", "few and unnamed", "Raman shift", "a word in a row"],
)
def test_refusals_name_what_is_wrong(tmp_path, content, words):
    path = tmp_path / "s.txt"
    path.write_text(content)
    with pytest.raises(Refusal, match=words):
        read_frames(path)


@pytest.mark.parametrize(
    ("head", "line", "rows"),
    [
        ("", "{0},{1},{2}\n", ROWS[::-1]),
        ("", "{0:.7g},{1},{2}\n", [(a / 1000, b, c) for a, b, c in ROWS]),
        ("Wavelength [Angstrom],I,J\n", "{0},{1},{2}\n", [(10 * a, b, c) for a, b, c in ROWS]),
        ("", "{3},{0},{1},{2}\n", ROWS),
        ("wavelength,light,dark,more light\n", "{0},{4},3,{5}\n", ROWS),
    ],
    ids=["falling", "micrometres", "Angstrom", "numbered pixels", "dark beside it"],
)
def test_scales_of_programs(tmp_path, head, line, rows):
    path = tmp_path / "s.txt"
    lines = (line.format(a, b, c, k, b + 3, c + 3) for k, (a, b, c) in enumerate(rows))
    path.write_text(head + "".join(lines))
    wavelength, frames = read_frames(path)
    np.testing.assert_allclose(wavelength, [row[0] * 1e-9 for row in ROWS], rtol=1e-12)
    np.testing.assert_array_equal(frames, np.array(ROWS).T[1:])


@pytest.mark.parametrize(
    ("names", "light"),
    [
        ("mean,std", lambda one, two: one),
        ("Intensit\u00e4t;Standardabweichung", lambda one, two: one),
        ("uncertainty (k=2),counts", lambda one, two: two),
        ("counts_err,counts", lambda one, two: two),
        ("shot 1,shot 2", lambda one, two: [one, two]),
        ("std,error", lambda one, two: [one, two]),
        ("sample,reference", lambda one, two: one),
        ("dark,dark corrected", lambda one, two: two),
        ("dark,counts minus dark", lambda one, two: two),
        ("dark,scope", lambda one, two: two - one),
        ("raw,dark corrected", lambda one, two: one),
        ("errorless,studied", lambda one, two: [one, two]),
    ],
)
def test_columns_that_are_no_light_are_no_frames(tmp_path, names, light):
    path, mark = tmp_path / "s.csv", ";" if ";" in names else ","
    rows = "".join(f"{a}{mark}{b}{mark}{c}\n" for a, b, c in ROWS)
    path.write_text(f"wavelength{mark}{names}\n{rows}", encoding="utf-8")
    _, one, two = np.array(ROWS).T
    np.testing.assert_array_equal(read_frames(path)[1], np.atleast_2d(light(one, two)))


@pytest.mark.parametrize("word", ["", "NaN"])
def test_a_cell_without_a_number_is_no_light(tmp_path, word):
    path = tmp_path / "s.txt"
    path.write_text("".join(f"{a},{word if k == 3 else b}\n" for k, (a, b, _) in enumerate(ROWS)))
    assert np.flatnonzero(np.isnan(read_frames(path)[1][0])).tolist() == [3]


@pytest.mark.parametrize(
    ("head", "again"),
    [
        ("wavelength,wavelength [um],I\n", lambda place, nm: nm / 1000),
        ("", lambda place, nm: round(nm, 1)),
        ("nm,pixel,I\n", lambda place, nm: place + 1),
    ],
    ids=["in um", "again, without names", "pixels"],
)
def test_a_scale_that_is_there_twice_is_no_signal(tmp_path, head, again):
    path = tmp_path / "s.csv"
    path.write_text(head + "".join(f"{a},{again(k, a)},{b}\n" for k, (a, b, _) in enumerate(ROWS)))
    np.testing.assert_array_equal(read_frames(path)[1], [[row[1] for row in ROWS]])


@pytest.mark.parametrize(
    ("head", "second", "words"),
    [
        ("nm,I,nm,I\n", lambda nm: 2 * nm - 190.3, "column 3 is a second scale of wavelengths, from 609.7"),
        ("", lambda nm: 1.3 * nm, "column 3 is a second scale"),
        ("nm,I,,I\n", lambda nm: nm * 1.00028, "column 3 is a second scale"),
    ],
    ids=["two detectors", "without names", "air and vacuum"],
)
def test_two_scales_are_refused(tmp_path, head, second, words):
    path = tmp_path / "s.csv"
    path.write_text(head + "".join(f"{a},{b},{second(a)},{c}\n" for a, b, c in ROWS))
    with pytest.raises(Refusal, match=words):
        read_frames(path)


def test_wavelengths_alone_are_refused(tmp_path):
    path = tmp_path / "s.csv"
    path.write_text("".join(f"{a},{k},{a / 1000}\n" for k, (a, *_) in enumerate(ROWS)))
    with pytest.raises(Refusal, match="without a signal"):
        read_frames(path)
