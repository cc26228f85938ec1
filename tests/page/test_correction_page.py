"""The page that `correct` leaves: contradictions first, then temperature, each refusal with its reason."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from reader import Reader

from plasmapyro import cli, io
from plasmapyro.page.correction import write_page
from plasmapyro.plots import one_test
from plasmapyro.plots.colours import STATUS
from plasmapyro.plots.one_test import statuses
from plasmapyro.readers.stage import read_test
from plasmapyro.record.status import EXTRAPOLATED, MEANINGS, REASONS, VALID

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "example"


@pytest.fixture(scope="module")
def shelf(tmp_path_factory):
    """The example corrected both ways, with pages and a picture."""
    place = tmp_path_factory.mktemp("shelf")
    shutil.copytree(EXAMPLE / "my_test", place / "my_test")
    assert (
        cli.main(
            [
                "calibrate",
                str(EXAMPLE / "calibration"),
                "--out",
                str(place / "lab"),
                "--plot",
                str(place / "curve.svg"),
            ]
        )
        == 0
    )
    words = ["correct", str(place / "my_test"), "--instrument", str(place / "lab"), "--draws", "20"]
    assert cli.main([*words, "--out", str(place / "t.nc"), "--plot", str(place / "t.png")]) == 0
    joint = [
        *words,
        "--out",
        str(place / "j.nc"),
        "--estimator",
        "joint",
        "--html",
        str(place / "joint.html"),
    ]
    assert cli.main(joint) == 0
    return place


def test_every_status_has_a_colour_and_a_reason():
    assert set(MEANINGS.values()) == set(STATUS) and set(MEANINGS) == set(REASONS)


@pytest.mark.parametrize(("page", "contract"), [("t.html", "correction"), ("joint.html", "joint_estimate")])
def test_the_page_counts_what_the_file_holds(shelf, page, contract):
    said = Reader((shelf / page).read_text(encoding="utf-8")).words
    result = io.read(shelf / ("t.nc" if contract == "correction" else "j.nc"), contract)
    name, state = "recommended_temperature", "recommended_status"
    good = np.isin(result[state].values, (VALID, EXTRAPOLATED))  # as the command counts
    assert f"{int(good.sum())} of {result.sizes['time']} samples with a temperature to take away" in said
    first = int(np.flatnonzero(good)[0])
    assert f"{float(result[name][first]):.0f} ± " in said
    assert f"first, at {float(result.time[first]):.4g} s" in said
    assert result.attrs["recommended_because"] in said and result.attrs["recommended"] == "joint"
    for code, word in statuses(result[state]).items():
        count = int((result[state] == code).sum())
        assert (f"{word.replace('_', ' ')} {count} " in said) == (count > 0), word
        assert count == 0 or REASONS[code] in said
    assert "SYNTHETIC DATA" in said and "an invented test" in said


def test_the_page_loads_nothing_and_each_figure_speaks(shelf):
    for name, count in (("t.html", 4), ("joint.html", 3)):
        page = (shelf / name).read_text(encoding="utf-8")
        reader = Reader(page)
        assert not {"script", "link", "iframe", "object"} & set(reader.tags)
        assert page.count("<figcaption>") == page.count('<svg role="img" aria-label="') == count
        assert str(shelf) not in page


def test_contradictions_come_first_and_foreign_words_are_no_markup(shelf):
    result, evil = io.read(shelf / "t.nc", "correction"), '<script>alert("1")</script> /home/anna/run7 $x'
    result.attrs["title"] = evil
    found = {"rule": "stuck", "severity": "doubt", "where": "/home/anna/run7", "saw": evil, "remedy": "look"}
    page = write_page(read_test(shelf / "my_test"), result, [found])
    assert "<script" not in page and "anna" not in page
    places = [page.index(words) for words in ("[stuck]", "temperature to take away", "samples with a")]
    assert places == sorted(places)
    assert "one temperature to take away, but the data are in doubt" in page
    assert 'class="verdict fine"' not in page
    alone = write_page(read_test(shelf / "my_test"), result, [])
    assert "Findings in the data" not in alone and 'class="verdict fine"' in alone


def test_same_input_same_page(shelf):
    test, result = read_test(shelf / "my_test"), io.read(shelf / "t.nc", "correction")
    assert write_page(test, result, []) == write_page(test, result, [])


def test_a_long_record_is_thinned_for_drawing_and_counted_whole(shelf, monkeypatch):
    test, result = read_test(shelf / "my_test"), io.read(shelf / "t.nc", "correction")
    whole = write_page(test, result, [])
    monkeypatch.setattr(one_test, "MANY", 40)
    few = write_page(test, result, [])
    assert len(few) < 0.75 * len(whole)
    assert f"of {result.sizes['time']} samples with a temperature to take away" in Reader(few).words


def test_where_page_and_picture_go_is_up_to_the_user(shelf, tmp_path, capsys):
    words = ["correct", str(shelf / "my_test"), "--instrument", str(shelf / "lab"), "--draws", "20"]
    assert cli.main([*words, "--out", str(tmp_path / "t.nc"), "--no-html"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["t.nc"]
    assert "quadratic fit" in (shelf / "curve.svg").read_text(encoding="utf-8")
    assert (shelf / "t.png").read_bytes().startswith(b"\x89PNG") and not (shelf / "j.html").exists()
    inside = shelf / "my_test" / "t.html"
    assert cli.main([*words, "--out", str(tmp_path / "u.nc"), "--html", str(inside)]) == 2
    assert "lies in a folder that is read" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        cli.main([*words, "--out", str(tmp_path / "u.nc"), "--plot", "t.tiff"])
    assert "must end in .png or .svg; got 't.tiff'" in re.sub(r"\s+", " ", capsys.readouterr().err)
    assert not (tmp_path / "u.nc").exists()
