"""The verdict in words: sizes, costs and when."""

import pytest

from plasmapyro.diagnosis.report.sentences import candidate_sentence, verdict_sentences


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


def contradictions(report):
    """What status, names, probabilities and sentences of a diagnosis say against each other."""
    verdict, extended, gain = report["verdict"], report["extended"], report["gain"]
    status, named, probability = verdict["status"], verdict["named"], verdict["probability"]
    first, found = max(probability, key=probability.get), []
    terms = [term["id"] for term in extended["terms"]] if extended else []
    sentence = verdict["sentences"][0]
    if status in ("null", "unknown") and named:
        found.append("names under a verdict without any")
    if status in ("named", "one-of", "named+unknown") and not named:
        found.append("a verdict of names without any")
    if terms and (first == "none" or not probability.get(terms[0], 0.0) > 0):
        found.append(f"names {terms}, and {first} is likeliest")
    if status == "unknown" and first != "unknown" or status == "null" and first != "none":
        found.append(f"{status}, and {first} is likeliest")
    if status != "not-adequate" and bool(terms) != sentence.startswith("The data reject the base model"):
        found.append(f"{status} {terms}: {sentence}")
    if (status == "unknown") != sentence.startswith("Something is wrong") and not named:
        found.append(f"{status}: {sentence}")
    if extended and extended["applied"]:
        if probability.get("none", 0.0) >= 0.5:
            found.append("applied, and nothing being wrong is likelier")
        if not gain["heldout_log_score"] > 3 * gain["heldout_standard_error"]:
            found.append("applied without three standard errors of gain")
    if (verdict["unknown"] is None) != (report["discrepancy"]["class"] is None):
        found.append("something unknown without an axis, or an axis of nothing")
    return found


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
