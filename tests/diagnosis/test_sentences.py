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
    *_, last = verdict_sentences("null", {}, [], 0.5, None, None, limits, [])
    assert last == "What could still be wrong and would not be seen in these data: ratio (23 K)."
    assert len(verdict_sentences("null", {}, [], 0.5, None, None, limits[1:], [])) == 1
