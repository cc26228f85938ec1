import json

import numpy as np
import pytest
from blind.ranks import amplitudes, ranks


def rows(seed, count=200, off=0.0, wide=1.0):
    random = np.random.default_rng(seed)
    return [("winE", 0.05, 0.05 + 0.005 * (off + wide * random.normal()), 0.005) for _ in range(count)]


def test_right_laws_stay_within_the_band():
    outside = [ranks(rows(seed))["outside"] > 0 for seed in range(40)]
    assert np.mean(outside) < 0.2  # 5 % are outside somewhere; 40 draws


@pytest.mark.parametrize(("off", "wide"), [(0.7, 1.0), (0.0, 2.0), (0.0, 0.4)])
def test_biased_narrow_and_wide_laws_leave_it(off, wide):
    told = ranks(rows(1, off=off, wide=wide))
    assert told["outside"] > 0.1
    assert sum(told["histogram"]) == told["number"] == 200


def test_named_effects_of_a_folder_of_cases_are_ranked(tmp_path):
    for number, named in enumerate((["winE"], [])):
        place = tmp_path / "cases" / f"case{number}"
        (place / "out").mkdir(parents=True)
        (place / "truth.json").write_text(json.dumps({"effects": [{"effect": "winE", "amplitude": 0.05}]}))
        entry = {"id": "winE", "amplitude": 0.045, "standard_error": 0.005}
        (place / "out/diagnosis.json").write_text(
            json.dumps({"candidates": [entry], "verdict": {"named": named}})
        )
    (tmp_path / "cases" / "waiting").mkdir()
    assert list(amplitudes(tmp_path)) == [("winE", 0.05, 0.045, 0.005)]
    told = ranks(amplitudes(tmp_path))
    assert told["coverage"] == 1.0 and told["histogram"][8] == 1
    assert ranks([])["number"] == 0
