"""Lets the tests import the harness and the twin, which are no part of the package."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "workflow"), str(ROOT / "tests" / "twin")]


@pytest.fixture(scope="session")
def small_results(tmp_path_factory):
    """Folder with the results of a small main job, its diagnosis' inputs among them."""
    pytest.importorskip("plasmapyro.diagnosis.command", reason="needs the diagnosis")
    from small_job import make_results

    return make_results(tmp_path_factory.mktemp("results"))
