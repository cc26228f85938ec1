"""The board takes records that it was not written with: other references, names and folders."""

import re
from pathlib import Path

import pytest


@pytest.fixture
def board(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).resolve().parents[2] / "benchmarks")
    import real

    return real


@pytest.fixture
def species(board):
    import species

    return species


@pytest.mark.parametrize(
    ("stem", "word", "elements"),
    [
        ("Al", "Al", ["Al"]),
        ("Fe_2", "Fe", ["Fe"]),
        ("Zn-shot 3", "Zn", ["Zn"]),
        ("quartz12_spectrum", "quartz", ["Si"]),
        ("corundumE21", "corundum", ["Al"]),
        ("granite", "granite", []),
        ("2021-03-04", "2021-03-04", []),
    ],
)
def test_a_name_of_a_file_tells_its_elements(species, stem, word, elements):
    assert (species.word_of(Path(f"{stem}.csv")), species.known(Path(f"{stem}.csv"))) == (word, elements)


def furnace(folder, *names):
    for name in names:
        (folder / name).write_text("")


def test_any_record_of_the_furnace_may_calibrate(board, tmp_path):
    furnace(tmp_path, "23.5C_a.asc", "625C_b.asc", "900C_c.asc", "lights_on.asc", board.EMISSIVITY)
    celsius, dark, light = board.records(tmp_path, 625.0)
    assert (dark.name, light.name) == ("23.5C_a.asc", "625C_b.asc")
    assert sorted(map(str, celsius.values())) == ["23.5", "625.0", "900.0", "None"]


@pytest.mark.parametrize(
    ("names", "reference", "words"),
    [
        ((), 900, "there are none"),
        (("23C_a.asc", "700C_b.asc"), 900, "there are 23, 700; say another by --reference"),
        (("700C_b.asc",), 700, "needs a dark, below 50 C"),
        (("23C_a.asc", "100C_b.asc"), 100, "450 or more"),
        (("23C_a.asc", "700C_b.asc"), 700, "needs Ta_emissivity.csv"),
    ],
)
def test_a_furnace_that_lacks_a_record_is_said(board, tmp_path, names, reference, words):
    furnace(tmp_path, *names)
    with pytest.raises(SystemExit, match=re.escape(words)):
        board.records(tmp_path, reference)
