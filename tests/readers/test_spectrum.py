"""One spectrum in a text file, in the ways programs write it."""

import numpy as np
import pytest

from plasmapyro.readers.spectrum import read_frames
from plasmapyro.readers.text import Refusal

ROWS = [(400 + 0.5 * k, 10 + k, 12 + k) for k in range(25)]


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
        ("".join(f"{a},{b}\n" for a, b, _ in ROWS[::-1]), "no scale of wavelengths"),
        ("".join(f"{a / 1000},{b}\n" for a, b, _ in ROWS), "in nm"),
        ("".join(f"{a},{b}\n" for a, b, _ in ROWS) + "412.1,x\n", "line 26"),
    ],
    ids=["words", "falling", "micrometres", "a word in a row"],
)
def test_refusals_name_what_is_wrong(tmp_path, content, words):
    path = tmp_path / "s.txt"
    path.write_text(content)
    with pytest.raises(Refusal, match=words):
        read_frames(path)
