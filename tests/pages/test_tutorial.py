"""The tutorial is what its boxes print and draw, and reads as a notebook."""

import sys

import nbformat
import pytest
from matplotlib import image
from pages import ROOT

from plasmapyro import progress

sys.path.insert(0, str(ROOT / "workflow"))
import notebook  # noqa: E402

PAGE = ROOT / "docs/tutorial.md"
ALIKE = 0.02  # mean difference of a picture of 0 to 1: another line, not another font


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    return tmp_path_factory.mktemp("pictures")


def test_the_tutorial_prints_and_draws_what_stands_on_it(pictures, monkeypatch):
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(progress.LOG, "handlers", [])  # of commands that other tests called
    for number, (stated, printed) in enumerate(notebook.run(PAGE, pictures)):
        assert stated == printed, f"box {number}; python workflow/notebook.py docs/tutorial.md"
    drawn = list(pictures.iterdir())
    assert len(drawn) == PAGE.read_text(encoding="utf-8").count("](figures/")
    for path in drawn:
        fresh, kept = image.imread(path), image.imread(PAGE.parent / "figures" / path.name)
        assert fresh.shape == kept.shape and abs(fresh - kept).mean() < ALIKE, path.name


def test_it_is_a_notebook_with_answers():
    found = nbformat.reads(notebook.notebook(PAGE), as_version=4)
    nbformat.validate(found)
    kinds = [output.output_type for cell in found.cells for output in cell.get("outputs", [])]
    assert kinds.count("display_data") == 3 and kinds.count("stream") == 7
