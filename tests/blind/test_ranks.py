import json

import numpy as np
import pytest
from blind.ranks import OTHER, amplitudes, figure, in_catalogue, ranks
from twin.hidden import CATALOGUE


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
    for number, named in enumerate((["winE", "Cu"], [])):
        place = tmp_path / "cases" / f"case{number}"
        (place / "out").mkdir(parents=True)
        effects = [{"effect": name, "amplitude": 0.05, "shape": {}} for name in ("winE", "Cu")]
        (place / "truth.json").write_text(json.dumps({"case": {"world": "first"}, "effects": effects}))
        entry = {"id": "winE", "amplitude": 0.045, "standard_error": 0.005}
        (place / "out/diagnosis.json").write_text(
            json.dumps({"candidates": [entry], "verdict": {"named": named}})
        )
    (tmp_path / "cases" / "waiting").mkdir()
    assert list(amplitudes(tmp_path)) == [("winE", 0.05, 0.045, 0.005)]
    told = ranks(amplitudes(tmp_path))
    assert told["coverage"] == 1.0 and told["histogram"][8] == 1
    assert ranks([])["number"] == 0
    assert list(amplitudes(tmp_path, "second")) == []
    figure({"first": told, "second": ranks([])}, tmp_path / "ranks.svg")
    assert "1 amplitudes, 100 % in their 95 % intervals" in (tmp_path / "ranks.svg").read_text()


def test_amplitudes_are_counted_as_the_catalogue_counts():
    """A loss that grows for 300 s in the second laboratory, grains whose light is that of 2300 K, and
    of what is reflected the scattered share."""
    case = {"case": {"world": "second"}, "base": {"off": 150.0}}
    assert in_catalogue({"effect": "winE", "amplitude": 0.1}, case) == pytest.approx(0.05)
    assert in_catalogue({"effect": "eps_T", "amplitude": 0.1}, case) == 0.1
    assert in_catalogue({"effect": "edge_p", "amplitude": 0.1}, case) is None
    grains = {"effect": "particles", "amplitude": 1e-3, "shape": {"grain_k": 2500.0}}
    wien = np.exp(1.438776877e-2 / 0.95e-6 * (1 / 2300 - 1 / 2500))
    assert in_catalogue(grains, {"case": {}}) == pytest.approx(1e-3 * wien, rel=2e-3)
    scattered = {"effect": "refl", "amplitude": 0.8, "shape": {"diffuse": 0.05}}
    assert in_catalogue(scattered, {"case": {}}) == pytest.approx(0.04)
    assert {name for known in OTHER.values() for name in known} <= set(CATALOGUE)
