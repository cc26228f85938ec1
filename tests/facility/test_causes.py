"""Names for a measured pair: what was put into a jet of the table comes back, with its size."""

import numpy as np
import pytest

from plasmapyro import tables
from plasmapyro.facility.causes import NAMES, causes, sentences

ERRORS = {"admissible": (0.01, 0.1), "flux_uncertainty": 0.1, "pressure_uncertainty": 0.05}


def pair_of(mixing, power, flux, nose):
    table = tables.load("facility/jets")
    rows = (table["gas"] == "air") & (table["pressure"] == 5e3) & (table["mixing"] == mixing)
    (row,) = np.flatnonzero(rows & (table["power"] == power))
    return table[flux][row], table[f"pitot_{nose}_mm"][row]


def test_a_laminar_jet_on_a_good_catalyst_has_no_cause():
    found = causes(*pair_of(0.0, 95e3, "flux_kossyi_0.1", 25), **ERRORS)
    assert next(iter(found)) == "none" and found["none"][0] > 0.5
    assert set(found) == {"none", "unknown", *NAMES}
    assert sum(probability for probability, _ in found.values()) == pytest.approx(1.0)


def test_mixing_is_named_with_its_size_and_temperature():
    flux, read = pair_of(0.12, 95e3, "flux_kossyi_0.1", 25)
    found = causes(flux, read, **ERRORS)
    assert sum(p for name, (p, _) in found.items() if "mixing" in name) > 0.7
    low, high = found["mixing"][1]["mixing"]
    assert low < 0.12 == pytest.approx(high, rel=0.02)
    low, high = found["mixing"][1]["temperature"]
    assert low < 4841 < high


def test_what_no_cause_reaches_is_something_unknown():
    flux, read = pair_of(0.0, 130e3, "flux_equilibrium", 25)
    found = causes(5 * flux, read, **ERRORS)
    assert next(iter(found)) == "unknown" and found["unknown"][0] > 0.99


def test_a_known_nose_is_no_cause_and_what_is_in_doubt_decides():
    flux, read = pair_of(0.12, 95e3, "flux_kossyi_0.1", 12.5)
    found = causes(flux, read, nose=(0.0125, 0.0125), **ERRORS)
    assert not any("nose" in name for name in found)
    low, high = found["mixing"][1]["power"]
    assert low < 95e3 < 1.02 * high
    *lines, whole, decides = sentences(found)
    assert lines[0].startswith("mixing") and " kW in the gas, mixing 0.0" in lines[0]
    assert "nose" not in whole and decides.startswith("what decides next: a second calorimeter")


def test_less_momentum_is_named_where_it_alone_was_taken():
    flux, read = pair_of(0.0, 95e3, "flux_equilibrium", 25)
    found = causes(flux, 0.78 * read, nose=(0.025, 0.025), **ERRORS)
    assert sum(p for name, (p, _) in found.items() if "momentum" in name) > 0.4
    assert found["momentum"][1]["momentum"][0] < 0.8


def test_a_pair_in_the_wrong_unit_is_nothing_known():
    flux, read = pair_of(0.12, 95e3, "flux_kossyi_0.1", 25)
    assert sentences(causes(flux / 10, read, **ERRORS))[-1].startswith("nothing known reaches the pair")
