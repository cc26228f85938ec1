"""A hundred mistakes of a laboratory: how many change a temperature without a word."""

import re
from pathlib import Path

import pytest
from mistakes import MISTAKES
from try_mistakes import EXAMPLE, outcome, run

SILENT = {  # mistake -> why no rule can say it
    "black body of the spectrometer fifty kelvin too low": "two of the pyrometer's uncertainties of 20 K, and"
    " by Wien's law the shape of the spectra stays right"
}
HARMLESS = {
    "transmittance of a filter for that of the window",
    "last spectra of the series lost",
    "first points read before the source was warm",
    "missing samples of one band written as minus 9999",  # read as what they are, as the next ones
    "a cell says OVER",
    "a cell says VALUE",
    "a cell says inf",
    "a row of units below the header",
    "utf 16 without its mark",
    "response time of the pyrometer two seconds",  # `correct` says so of the joint estimate
}
PAGE = Path(__file__).resolve().parents[2] / "docs" / "your-own-data.md"


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    place = tmp_path_factory.mktemp("quality") / "lab"
    assert run("calibrate", EXAMPLE / "calibration", "--out", place)[0] == 0
    return place


def test_sound_files_are_passed_in_silence(lab):
    assert run("check", EXAMPLE / "calibration") == (0, "")
    assert run("check", EXAMPLE / "my_test", "--instrument", lab) == (0, "")


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_refused_or_said(tmp_path, lab, name):
    word, said = outcome(name, tmp_path, lab)
    wanted = {"silent"} if name in SILENT else {"harmless"} if name in HARMLESS else {"refused", "said"}
    assert word in wanted, said
    # What is said names a rule or the key, file or line; none of it is a warning of a library.
    assert "Warning:" not in said and "Traceback" not in said


def test_there_are_a_hundred_mistakes_and_the_page_says_how_many_pass():
    assert len(MISTAKES) >= 100 and len(SILENT) <= 3
    numbers = re.search(
        r"Of (\d+) mistakes (\d+) pass(?:es)? silently", PAGE.read_text(encoding="utf-8"), re.DOTALL
    )
    assert [int(number) for number in numbers.groups()] == [len(MISTAKES), len(SILENT)]
