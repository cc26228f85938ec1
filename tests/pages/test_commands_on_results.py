"""The commands of the pages that need results of the main job; `make compare` runs them."""

import os

import pytest
from pages import ROOT, all_commands
from test_pages import call, ids, needs_results

COMMANDS = [one for one in all_commands("plasmapyro") if len(one.words) > 2 and needs_results(one)]
PLACEHOLDERS = {"FOLDER": "results/twin/csic_160kW", "95kW": "90kW"}

READINGS = "time [s], temperature [K]\n0, 1264\n20, 1420\n60, 1511\n160, 1559\n"


@pytest.mark.parametrize("command", COMMANDS, ids=ids(COMMANDS))
def test_a_command_on_results_runs(command, tmp_path, monkeypatch, capsys):
    if "PLASMAPYRO_RESULTS" not in os.environ:
        pytest.skip("needs the results of the main job (make compare)")
    (tmp_path / "results").symlink_to(ROOT / os.environ["PLASMAPYRO_RESULTS"])
    (tmp_path / "config").symlink_to(ROOT / "config")
    (tmp_path / "stag_point_temp.dat").write_text(READINGS)  # in the place of the facility's own
    monkeypatch.chdir(tmp_path)
    words = [PLACEHOLDERS.get(word, word) for word in command.words[1:]]
    assert call(words) == 0, capsys.readouterr().err


def test_the_worked_example_of_the_paper_quotes_the_results():
    if "PLASMAPYRO_RESULTS" not in os.environ:
        pytest.skip("needs the results of the main job (make compare)")
    page = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    tables = ROOT / os.environ["PLASMAPYRO_RESULTS"] / "diagnosis" / "published_experiment.md"
    rows = [row for row in tables.read_text(encoding="utf-8").splitlines() if row.startswith("|")]
    missing = [row for row in rows if row not in page]
    assert len(rows) > 10 and not missing
