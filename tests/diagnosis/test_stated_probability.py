"""Stated probabilities: the first is the share that was measured, the order stays."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro import tables
from plasmapyro.diagnosis.report import report
from plasmapyro.diagnosis.select import probability

LOG = {"winE": 0.0, "winE_sl": -2.0, "none": -9.0, "unknown": -4.0}


def test_first_answer_gets_the_measured_share_and_the_order_stays(monkeypatch):
    monkeypatch.setattr(probability, "measured_share", lambda status, stated: 0.6)
    found, before = probability.honest(LOG, "named")
    weight = np.exp(list(LOG.values()))
    assert before == pytest.approx(weight[0] / weight.sum(), rel=1e-12)
    assert found["winE"] == pytest.approx(0.6, abs=1e-6)
    assert sorted(found, key=found.get) == sorted(LOG, key=LOG.get)
    assert sum(found.values()) == pytest.approx(1, abs=4 * probability.LEAST)


@pytest.mark.parametrize("wanted", [1e-9, 0.3, 1.0])
def test_probabilities_stay_probabilities_whatever_is_wanted(monkeypatch, wanted):
    monkeypatch.setattr(probability, "measured_share", lambda status, stated: wanted)
    found, _ = probability.honest(LOG, "named")
    assert max(found, key=found.get) == "winE" and sum(found.values()) == pytest.approx(1, abs=1e-5)
    assert 1 / len(LOG) < found["winE"] <= probability.CERTAIN + 1e-9


def test_a_name_with_reserve_is_never_stated_as_sure(monkeypatch):
    monkeypatch.setattr(probability, "measured_share", lambda status, stated: 0.95)
    sure, doubted = (probability.honest(LOG, status)[0]["winE"] for status in ("named", "named+unknown"))
    assert sure == pytest.approx(0.95, abs=1e-6) and doubted < 0.8  # which the blind tests call confident


def test_answers_of_equal_weight_are_left_alone():
    found, before = probability.honest({"winE": 0.0, "clock": 0.0}, "named")
    assert found == {"winE": 0.5, "clock": 0.5} and before == 0.5


def test_a_status_that_was_never_simulated_keeps_what_is_stated():
    assert probability.measured_share("of no verdict", 0.37) == 0.37


def test_table_rises_within_each_status_and_holds_shares():
    table = tables.load(probability.TABLE)
    for status in set(table["status"]):
        own = table["status"] == status
        assert np.all(np.diff(table["stated"][own]) > 0) and np.all(np.diff(table["right"][own]) > 0)
    assert np.all((table["right"] > 0) & (table["right"] < 1))
    assert probability.measured_share("named", 1.0) == table["right"][table["status"] == "named"][-1]


@pytest.mark.parametrize(
    ("rounds", "joint"),
    [
        ([(), ("a",)], 0.8),
        ([(), ("a",), ("a", "b")], 0.8 * 0.8),  # told by its evidence, but no surer than the first
        ([(), ("a",), ("a", "c"), ("a", "b", "d")], 0.8**3),  # c gave way: nothing is known of b and d alone
    ],
)
def test_the_probability_of_all_names_takes_rounds_that_add_one(monkeypatch, rounds, joint):
    monkeypatch.setattr(report, "log_evidence", lambda solution, size: [0.0, 50.0, 90.0, 80.0][solution])
    steps = [
        SimpleNamespace(settings=tuple(SimpleNamespace(id=name) for name in names), solution=place)
        for place, names in enumerate(rounds)
    ]
    findings = SimpleNamespace(
        final=steps[-1],
        selection=SimpleNamespace(steps=steps),
        probability=({"a": 0.8, "b": 0.1}, 1.0),
        effects=dict.fromkeys(range(30)),
        size=1,
    )
    assert report._joint(findings) == pytest.approx(joint)
