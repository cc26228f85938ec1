"""Cases of the second laboratory from their drawing to the scoreboard, with an analyser that says nothing."""

import copy
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from blind import board, draw, page, run, score, second
from small_job import sight_line
from two_bands import RESPONSE

REPORT = {
    "verdict": {
        "status": "unknown",
        "named": [],
        "set": [],
        "probability": {"unknown": 0.9},
        "uncalibrated": 0.9,
        "unknown": {"instrument": "pyrometer", "axis": "time"},
        "sentences": ["Something is wrong."],
    },
    "discrepancy": {"class": "walk_pyrometer"},
    "base": {"adequate": True, "chi2": 1.0, "dof": 1},
    "candidates": [],
    "simulation": {"gains": [], "power": 1.0, "power_error": 0.03},
    "extended": None,
    "gain": None,
    "show": {"line_hump": None},
}


class Silent:
    """An analyser that finds something unknown in everything, at 1000 K."""

    def __init__(self):
        self.orders = []

    def ask(self, order):
        self.orders.append(order)
        if order["do"] == "simulate":
            (Path(order["folder"]) / "radiation").mkdir(parents=True)
        if order["do"] == "diagnose":
            out, data = Path(order["out"]), Path(order["data"])
            assert sorted(path.name for path in data.iterdir()) == ["test.nc"]
            out.mkdir(parents=True)
            (out / "diagnosis.json").write_text(json.dumps(REPORT), encoding="utf-8")
            time = np.arange(0.0, 120.0, 2.0)
            kinds = [
                f"{which}_temperature{end}"
                for which in ("paper", "base", "extended")
                for end in ("", "_low", "_high")
            ]
            rows = {name: ("time_bin", np.full(time.size, 1000.0)) for name in kinds}
            xr.Dataset(rows, {"time_bin": time}).to_netcdf(out / "temperature.nc")
        return {"ok": True, "wall": 1.0, "processor": 1.0}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    out, results = tmp_path_factory.mktemp("second"), tmp_path_factory.mktemp("results")
    (results / "sightline").mkdir()
    (results / "instrument").mkdir()
    for power in (50e3, 80e3, 130e3):
        sight_line(power).to_netcdf(results / f"sightline/{power / 1e3:.0f}kW.nc")
    RESPONSE.to_netcdf(results / "instrument/response.nc")
    workbench = second.bench(results, "a word")
    workbench.worlds = workbench.worlds[:1] * len(
        workbench.worlds
    )  # one gas is enough, and its table costs seconds
    workbench.pressures = workbench.pressures[:1] * len(workbench.worlds)
    folders = run.laboratories(out, results, workbench, "a word", Silent(), "second")
    cases = draw.draw("a word", {"null": 1, "outside": 3}, (20.0,), "second")
    return [run.run_case(case, workbench, folders, out, results, Silent()) for case in cases], out


def test_cases_are_scored_with_their_world(finished):
    records, _ = finished
    assert {one["outcome"] for one in records} <= {"scored", "beyond range"}
    assert {one["world"] for one in records} == {"second"}
    faults = [one for one in records if one["kind"] == "outside" and one["outcome"] == "scored"]
    assert faults and all(one["effects"][0]["snr"] == 20.0 for one in faults)


def test_the_truth_is_kept_apart_from_the_data(finished):
    records, out = finished
    name = next(one["case"] for one in records if one["kind"] == "outside" and one["outcome"] == "scored")
    truth = json.loads((out / "cases" / name / "truth.json").read_text(encoding="utf-8"))
    assert len(truth["effects"][0]["truth"]) == 2 and truth["strengths"]["N2 1P"]
    assert not list((out / "cases" / name / "data").iterdir())


def test_the_board_gives_rates_by_world_and_against_the_bars(finished):
    records, _ = finished
    other = [one | {"world": "first", "case": f"first-{index}"} for index, one in enumerate(records)]
    faint = copy.deepcopy(
        next(one for one in records if one["kind"] == "outside" and one["outcome"] == "scored")
    )
    faint["effects"][0]["snr"], faint["score"]["unknown"] = 12.0, False  # is not asked for
    both = board.summary([*records, *other, faint | {"case": "faint"}])
    assert set(both["worlds"]) == {"first", "second"}
    rows = {row["bar"].split(":")[-1].strip(): row for row in both["worlds"]["second"]["bars"]}
    names = rows["a name of surface, path, instrument or clock"]
    assert names["value"] == 0 and names["cases"] == 1
    scored = [one for one in records if one["kind"] == "outside" and one["outcome"] == "scored"]
    right = [one["effects"][0]["truth"] in (["p", "time"], ["ps", "time"]) for one in scored]
    assert rows["unknown, with instrument and axis"]["value"] == sum(right) / len(right)
    assert rows["diagnoses that contradict themselves"]["value"] == 0
    assert "## By world" in page.text(both, "Both.") and "worlds" not in board.summary(other)


@pytest.mark.parametrize("pressures", [(5e3, 2e3, 5e3, 2e4, 5e3, 1.5e3), (5e3, 2e4, 5e3, 8e3, 5e3, 5.2e3)])
def test_gases_of_other_pressures_have_a_simulation_but_for_the_last(pressures):
    said = second.simulations(SimpleNamespace(pressures=pressures))
    away = [index for index, one in enumerate(pressures) if abs(one / 5e3 - 1) > 0.1]
    assert [said[one] for one in away] == ["own"] * (len(away) - 1) + ["another pressure"]
    assert {one for index, one in enumerate(said) if index not in away} == {"main job"}


def test_a_simulation_is_made_once_and_only_where_it_is_one_of_the_pressure(tmp_path):
    analyser, workbench = Silent(), SimpleNamespace(pressures=(5e3, 2e3, 1e4))

    def spectra(world):
        made = SimpleNamespace(base=SimpleNamespace(world=world, pressure=workbench.pressures[world]))
        return run.spectra(made, workbench, tmp_path, "job", analyser)

    own = tmp_path / "simulations/2000Pa/radiation"
    assert spectra(1) == spectra(1) == (own, "own") and own.is_dir()
    assert [(one["do"], one["pressure"]) for one in analyser.orders] == [("simulate", 2e3)]
    assert spectra(0) == (Path("job/radiation"), "main job")
    assert spectra(2) == (Path("job/radiation"), "another pressure") and len(analyser.orders) == 1


def test_the_board_tells_what_a_gas_was_compared_with_apart(finished):
    records, _ = finished
    kinds = second.simulations(SimpleNamespace(pressures=(5e3, 2e3, 1e4)))
    told = [one | {"case": f"{kind}-{one['case']}", "simulation": kind} for kind in kinds for one in records]
    shown = board.summary(told)
    assert set(shown["simulations"]) == {"main job", "own", "another pressure"}
    assert sum(sum(one["cases"].values()) for one in shown["simulations"].values()) == sum(
        shown["cases"].values()
    )
    assert "## By simulation" in page.text(shown, "Three.")


@pytest.mark.parametrize(
    ("watt", "effects", "held"),
    [
        (79e3, [], True),
        (70e3, [], False),
        (70e3, [{"effect": "P_eff", "amplitude": 0.15}], True),
        (79e3, [{"effect": "ripple", "amplitude": 0.1}], None),
    ],
)
def test_the_power_of_the_gas_is_judged_by_the_one_that_it_has(watt, effects, held):
    base = SimpleNamespace(condition="80kW", power=watt)
    made = second.Made(None, base, tuple(effects), None)
    assert score._power_held(made, REPORT["simulation"]) is held
