"""The verdict in words: sizes, costs and when."""

import copy
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from blind.consistent import contradictions

from plasmapyro.diagnosis.report.report import found_apart
from plasmapyro.diagnosis.report.sentences import candidate_sentence, verdict_sentences
from plasmapyro.diagnosis.report.simulation import foreign_sentences, simulation
from plasmapyro.diagnosis.report.temperature import largest_shift
from plasmapyro.diagnosis.select.pixels import NAMES, PIXELS
from plasmapyro.diagnosis.simulation.compare import Comparison
from plasmapyro.diagnosis.simulation.fitter import Fit
from plasmapyro.page.stage import STATUS, write_page


def entry(paper, base, at_time=300.0):
    return {
        "name": "deposit on window E",
        "amplitude_name": "loss at the end",
        "amplitude": 0.04994,
        "standard_error": 0.00016,
        "unit": "1",
        "temperature_shift": {"paper": paper, "base": base, "at_time": at_time},
    }


@pytest.mark.parametrize(
    ("paper", "base", "cost"),
    [
        (0.04, -4.31, "by 0 K and the fitted one by -4.3 K at worst, 300 s after the injection."),
        (2.277, -0.04, "by +2.3 K and the fitted one by 0 K at worst, 300 s after the injection."),
        (-0.04, 0.0, "it changes no temperature by a tenth of a kelvin."),
    ],
)
def test_a_cost_has_a_time_and_nothing_has_no_sign(paper, base, cost):
    sentence = candidate_sentence(entry(paper, base))
    assert sentence.startswith("Deposit on window E: loss at the end 0.0499 ± 0.0002; left out, ")
    assert sentence.endswith(cost)


def test_what_costs_less_than_half_a_kelvin_is_not_warned_of():
    limits = [
        {"name": name, "invisible": seen, "temperature_prior": kelvin}
        for name, seen, kelvin in (("ratio", True, 22.7), ("wall", True, 0.4), ("window", False, 9.0))
    ]
    *_, last = verdict_sentences("null", {}, [], [], 0.5, None, None, limits, [])
    assert last == "What could still be wrong and would not be seen in these data: ratio (23 K)."
    assert len(verdict_sentences("null", {}, [], [], 0.5, None, None, limits[1:], [])) == 1


def test_the_chance_of_a_misfit_is_no_reason_for_what_another_test_found():
    rest = ([], [], 1.0, "what repeats in the bands", None, [], [])
    first, *_ = verdict_sentences("unknown", {}, *rest, apart=True)
    assert first == (
        "Something is wrong that no single cause of the catalogue explains: what repeats in the bands,"
        " by a test of its own."
    )
    assert verdict_sentences("unknown", {}, *rest)[0].startswith("Something is wrong (p = 1) that no ")


def test_what_the_gas_asks_for_stands_in_the_first_sentence():
    """A page headed "a cause is named" began with "no single cause of the catalogue explains"."""
    entry = {"name": "copper", "sentence": "Copper: 1."}
    rest = (["Cu"], 0.2, "a wandering gain", None, [], [])
    first, *_ = verdict_sentences("named+unknown", {"Cu": entry}, [], *rest)
    assert first == (
        "The gas differs from the simulated one as if by: copper; something is wrong (p = 0.2) that no single"
        " cause of the catalogue explains: a wandering gain."
    )
    both = {"Cu": entry, "winE": {"name": "deposit", "sentence": "Deposit: 1."}}
    first, *others = verdict_sentences("named", both, ["winE"], *rest)
    assert "deposit" in first and "copper" in first and "Copper: 1." in others


def test_a_shift_is_taken_where_both_temperatures_are():
    """An extension without a value where the base model has one ended in a report that holds no number."""
    both = {"base_temperature": [1200.0, 1300.0, 1350.0], "extended_temperature": [1210.0, 1280.0, np.nan]}
    rows = {name: ("time_bin", np.array(values)) for name, values in both.items()}
    temperature = xr.Dataset(rows, {"time_bin": [10.0, 20.0, 30.0]})
    findings = SimpleNamespace(span=(5.0, 40.0))
    assert largest_shift(findings, temperature) == -20.0
    nowhere = temperature.assign(extended_temperature=("time_bin", np.full(3, np.nan)))
    assert largest_shift(findings, nowhere) == 0.0


@pytest.mark.parametrize(
    ("found", "unknown", "gain", "apart"),
    [
        ("walk", 9.0, 1.0, False),
        ("walk", 1.0, 30.0, False),
        ("walk", 1.0, 1.0, True),  # a strange line is a structure that the gas asks for
        ("repeats", 9.0, 30.0, True),
    ],
)
def test_what_is_unknown_is_of_a_test_of_its_own(found, unknown, gain, apart):
    screen = SimpleNamespace(structures=[SimpleNamespace(id="walk")])
    findings = SimpleNamespace(
        first=SimpleNamespace(screen=screen, unknown=np.array([unknown]), gains=np.array([gain])),
        selection=SimpleNamespace(unknown_class=found, thresholds=SimpleNamespace(unknown=5.0, effect=20.0)),
    )
    assert found_apart(findings) == apart


def test_a_verdict_says_that_pixels_in_turn_are_of_a_test_of_its_own(diagnosed, monkeypatch):
    monkeypatch.setattr("plasmapyro.diagnosis.stage.in_turn", lambda record: PIXELS)
    first, *_ = diagnosed(without=("clock",)).report["verdict"]["sentences"]
    assert first.endswith(f" explains: {NAMES[PIXELS]}, by a test of its own.")


@pytest.mark.parametrize(
    "hidden",
    [
        {},
        {"window_loss": 0.08},
        {"window_loss": 0.01},
        {"window_loss": 0.08, "without": ("winE",)},
        {"fringe": 0.006},
        {"fringe": 0.001},
        {"ratio_error": 0.04},
        {"ratio_error": 0.02},
    ],
    ids=str,
)
def test_status_names_probabilities_and_sentences_never_contradict(diagnosed, hidden):
    assert contradictions(diagnosed(**hidden).report) == []


@pytest.mark.parametrize(
    ("part", "key", "value"),
    [
        ("verdict", "status", "null"),
        ("verdict", "named", ["clock"]),
        ("verdict", "probability", {"none": 0.72, "winE": 0.28}),
        ("verdict", "unknown", {"instrument": "pyrometer", "axis": "time"}),
        ("gain", "heldout_standard_error", 1e3),
        ("base", "adequate", False),
    ],
)
def test_a_report_that_contradicts_itself_is_seen(diagnosed, part, key, value):
    report = copy.deepcopy(diagnosed(window_loss=0.08).report)
    assert report["extended"]["applied"] and contradictions(report) == []
    report[part][key] = value
    assert contradictions(report)


@pytest.mark.parametrize("hidden", [{}, {"window_loss": 0.08}, {"fringe": 0.006}], ids=str)
def test_the_page_says_what_the_report_says(diagnosed, hidden):
    result = diagnosed(**hidden)
    page = write_page(result.report, result.residual_map, result.temperature)
    verdict = result.report["verdict"]
    words = STATUS[verdict["status"]][0].partition("named")[2]
    assert ("the model explains the data" in page) == (verdict["status"] == "null") and words in page
    assert page.count("★") == 1 + len(verdict["named"])  # one explains the mark


@pytest.mark.parametrize(
    ("lines", "bright", "p"), [(1, 1.6, 0.0), (0, 0.1, 0.0), (1, 0.1, 0.5), (0, 0.1, 0.5)]
)
def test_a_gas_that_differs_as_a_whole_is_said_beside_its_lines(lines, bright, p):
    fit = Fit(0.0, bright, (), 0.0, np.eye(2))
    found = [SimpleNamespace(wavelength=780.5e-9, strength=1.4, error=0.3)] * lines
    agreed = Comparison(fit, fit, (), tuple(found), {"contin": 0.0}, 10.0, p, np.ones(1))
    said = " ".join(simulation(SimpleNamespace(comparison=agreed, foreign=()))["sentences"])
    assert ("as a whole" in said) is (p == 0.0)
    assert ("5 times as bright" in said) is (bright > 1)
    assert ("780.5 nm" in said) is (lines == 1)
    assert ("agrees" in said) is (lines == 0 and p > 0)


@pytest.mark.parametrize(
    ("with_sample", "since"),
    [(True, ", since the injection"), (False, ", before the injection too"), (None, "")],
)
def test_a_species_that_the_simulation_lacks_is_said_with_its_lines(with_sample, since):
    one = {
        "species": "Rb I",
        "probability": 0.97,
        "lines": [780.03e-9, 794.76e-9],
        "with_sample": with_sample,
    }
    assert foreign_sentences([one]) == [
        "Rb I, with probability 0.97, is in the gas, not in the simulation: lines at 780.0, 794.8 nm in air"
        + f"{since}."
    ]
