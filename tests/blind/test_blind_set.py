"""A small blind test: gas of the radiation engine, hidden effects of the twin, diagnosis of the package.

The seed comes from the environment where there is one (a commit), so that no code can be fitted to it; the
gates are so wide that a sound diagnosis fails them less than once in a thousand seeds, at the rates of
docs/scoreboard.md. The full set is `make blind`.
"""

import json
import os

import pytest
from blind import run

SEED = os.environ.get("BLIND_SEED", "a word that nothing was fitted to")
CASES = {"null": 1, "liar": 1, "single": 4, "double": 1, "outside": 2, "without": 1, "sabotage": 1}


@pytest.fixture(scope="module")
def board(small_results, tmp_path_factory):
    """The scores of the small set."""
    out = tmp_path_factory.mktemp("blind")
    counts = [word for kind, number in CASES.items() for word in (f"--{kind}", str(number))]
    run.main(
        ["--seed", SEED, "--results", str(small_results), "--out", str(out), "--ladder", "20", "50", *counts]
    )
    return json.loads((out / "scoreboard.json").read_text(encoding="utf-8"))


def test_no_case_fails(board):
    assert board["failed"] == {}
    assert sum(board["cases"].values()) + sum(board["skipped"].values()) == sum(CASES.values())


def test_nothing_is_called_nothing(board):
    assert board["false_alarms"]["trials"] == 1 and board["false_alarms"]["hits"] == 0


def test_a_strong_effect_is_named(board):
    named = board["at_least_20"]
    assert named["detected"]["hits"] >= named["detected"]["trials"] - 2
    assert named["class"]["rate"] >= 0.5


def test_what_no_name_fits_is_called_unknown(board):
    assert board["outside"]["unknown"]["hits"] >= 1
    assert board["outside"]["confident_wrong"]["hits"] <= 1


def test_temperature_does_not_suffer(board):
    rms = board["temperature"]["rms"]
    assert rms["extended"] <= 1.2 * rms["base"] and rms["extended"] < rms["paper"]
