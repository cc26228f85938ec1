"""What meets a measured pair predicts it, and other pressures as the computed jets say."""

import numpy as np
import pytest

from plasmapyro import tables
from plasmapyro.facility.jet import Jet
from plasmapyro.facility.prediction import (
    CARRIED,
    FADED,
    GASES,
    NOSES,
    RATES,
    Explanations,
    carried_over,
    jets,
    needed_mixing,
    predict,
    weights,
)
from plasmapyro.facility.probes import Calorimeter, heat_flux, pitot_pressure

PAIR = {"pair": "Num-2", "draws": 200, "seed": 1}
ADMISSIBLE = {"recombination": (0.01, 0.1), "nose": (0.005, 0.025)}
EXACT = {"flux_uncertainty": 1e-9, "pressure_uncertainty": 1e-9, "mixing_spread": 0.0}
USUAL = {"flux_uncertainty": 0.1, "pressure_uncertainty": 0.05, "mixing_spread": 0.25}
UNDISTURBED = 0.12  # of the heat flux: a sphere in a uniform stream for one in a jet of finite width


def explanation(recombination, rates, nose):
    return Explanations(np.array([recombination]), np.array([RATES.index(rates)]), np.array([nose]))


def test_what_meets_the_pair_predicts_it():
    found = predict([14.98], 5000.0, **PAIR, **ADMISSIBLE, **EXACT)
    assert found["heat_flux"][:, 0] == pytest.approx(500e3, rel=1e-3)
    assert found["explained"] > 0.5
    wider = predict([14.98], 5000.0, **PAIR, **ADMISSIBLE, **USUAL)["heat_flux"][:, 0]
    assert wider[0] < 450e3 < 550e3 < wider[2]


def test_the_interval_grows_away_from_the_pair_and_with_what_is_not_known():
    found = predict([7.0, 14.98, 60.0], 5000.0, **PAIR, **ADMISSIBLE, **EXACT)["heat_flux"]
    width = np.log(found[2] / found[0])
    assert width[1] < width[0] and width[1] < width[2]
    settled = ADMISSIBLE | {"recombination": (0.03, 0.031), "nose": (0.0125, 0.0126)}
    known = predict([7.0, 14.98, 60.0], 5000.0, **PAIR, **settled, **EXACT)["heat_flux"]
    assert np.all(np.log(known[2] / known[0])[[0, 2]] < width[[0, 2]])


def test_a_node_of_the_table_is_given_back():
    table = tables.load("facility/jets")
    row = int(np.flatnonzero((table["pressure"] == 1e4) & (table["mixing"] == 0.06))[1])
    wall = explanation(0.1, "park", NOSES[0])
    values, inside = jets().at(table["pitot_5_mm"][[row]], 1e4, wall)
    place = list(jets().mixing).index(0.06)
    expected = [table[name][row] for name in ("flux_park_0.1", "temperature", "enthalpy", "speed", "power")]
    assert np.exp(values[0, place, 0]) == pytest.approx(expected, rel=1e-9)
    assert inside[0, place, 0]


@pytest.mark.parametrize("gas, pressure, mixing", [("air", 5e3, 0.0), ("air", 1e4, 0.12), ("N2", 5e3, 0.06)])
def test_the_table_is_what_probes_take_from_such_a_stream(gas, pressure, mixing):
    """Without the flow: a sphere in a uniform stream of the tabulated temperature and speed."""
    table = tables.load("facility/jets")
    rows = (table["gas"] == gas) & (table["pressure"] == pressure) & (table["mixing"] == mixing)
    row = int(np.flatnonzero(rows & (table["power"] == 95e3))[0])
    jet = Jet(table["temperature"][row], pressure, table["speed"][row], 0.0, GASES[gas])
    found, _ = heat_flux(jet, Calorimeter(0.025, recombination=0.1), "kossyi")
    assert found == pytest.approx(table["flux_kossyi_0.1"][row], rel=UNDISTURBED)
    assert pitot_pressure(jet, 0.0125) == pytest.approx(table["pitot_12.5_mm"][row], rel=0.2)


def test_nitrogen_follows_air_but_where_it_was_computed():
    table, gas = tables.load("facility/jets"), jets("N2")
    rows = np.flatnonzero(table["gas"] == "N2")
    place = [list(axis).index(value) for axis, value in ((gas.pressure, 5e3), (gas.mixing, 0.06))]
    powers = np.unique(table["power"])
    for row in rows[(table["pressure"][rows] == 5e3) & (table["mixing"][rows] == 0.06)]:
        w = list(powers).index(table["power"][row])
        assert gas.computed[*place, w]
        assert np.exp(gas.state[*place, w, 0]) == pytest.approx(table["temperature"][row])
    assert not gas.computed[0, -1].any() and np.isfinite(gas.pitot).all() and np.isfinite(gas.flux).all()
    found = {one: predict([15.0], 5000.0, gas=one, **PAIR, **ADMISSIBLE, **USUAL) for one in ("air", "N2")}
    ratio = found["N2"]["heat_flux"][1] / found["air"]["heat_flux"][1]
    assert 0.8 < ratio[0] < 1.3 and found["N2"]["inside"][0] <= found["air"]["inside"][0]
    with pytest.raises(ValueError, match="no jets in 'O2'; computed in: air, N2"):
        predict([15.0], 5000.0, gas="O2", **PAIR, **ADMISSIBLE, **USUAL)


def test_more_mixing_takes_heat_at_the_same_pitot_pressure():
    wall = explanation(0.03, "kossyi", 0.0125)
    mixing = [needed_mixing(wall, flux, 14.98)[0] for flux in (700e3, 600e3, 500e3)]
    assert np.all(np.diff(mixing) > 0) and mixing[0] > 0
    assert np.isnan(needed_mixing(wall, 5e6, 14.98)).all()


@pytest.mark.parametrize("pair, other", [("Num-2", "ZU1"), ("ZU1", "Num-2")])
def test_each_measured_pair_lies_in_the_interval_that_the_other_gives(pair, other):
    table = tables.load("facility/plasmatron_pairs")
    row = list(table["pair"]).index(other)
    found = predict([table["dynamic_pressure"][row]], 5000.0, **PAIR | {"pair": pair}, **ADMISSIBLE, **USUAL)
    assert found["heat_flux"][0, 0] < table["heat_flux"][row] < found["heat_flux"][2, 0]


def test_further_tests_of_the_facility_lie_in_the_intervals_but_for_one():
    """Nothing was fitted to them. Exp-2 (300 kW/m2 at 17 Pa) holds only as read on the flat probe."""
    table, held = tables.load("facility/plasmatron_trials"), []
    columns = ("test", "gas", "shape", "chamber_pressure", "dynamic_pressure", "heat_flux")
    for name, gas, shape, pressure, pitot, flux in zip(*(table[one] for one in columns), strict=True):
        jet = {"gas": gas, "shape": shape}
        low, _, high = predict([pitot], pressure, **jet, **PAIR, **ADMISSIBLE, **USUAL)["heat_flux"][:, 0]
        held += [name] if low < flux < high else []
        assert high / low < 4 and (name != "Exp-2" or flux < low < 500e3 < high)
    assert held == [name for name in table["test"] if name != "Exp-2"]


def test_jets_at_another_pressure_follow_from_one_computed_there():
    """Nine jets at 100 mbar were computed: one of them, and the ratios at 50 mbar, give the others."""
    known = jets()
    whole = np.concatenate([known.pitot, known.state, known.flux[0]], axis=-1)
    base, place = (list(known.pressure).index(one) for one in (5e3, 1e4))
    left = np.zeros_like(known.computed[place])
    left[list(known.mixing).index(0.06), 2] = True
    hidden = np.where(left[..., None], whole[place], np.nan)
    # Jets that were carried over in the table itself are no witnesses.
    off = (carried_over(hidden, left, whole[base]) - whole[place])[known.computed[place]]
    assert np.abs(off[:, :3]).max() < 0.16 and np.abs(off[:, 3]).max() < 0.04
    assert np.abs(off[:, 7:]).max() < 0.14
    assert np.abs(off).max() > 0.05  # it was another jet


def test_cold_gas_alone_reads_more_than_a_faint_jet():
    """At 50 mbar 16 g/s of mixed gas read 12 Pa on a nose of 25 mm, however little power: less gas then."""
    place = list(jets().mixing).index(0.06)
    found = {}
    for warmth in (0.0, 1.0, np.nan):
        wall = Explanations(np.array([0.1]), np.array([0]), np.array([NOSES[-1]]), warmth)
        values, inside = jets().at([2.5, 10.0], 5e3, wall)
        assert not inside[0, place].any()
        found[warmth] = np.exp(values[0, place])
    assert np.isnan(found[np.nan]).all() and (found[0.0][:, :2] < found[1.0][:, :2]).all()
    # Half the speed, the same gas: stagnation heat transfer goes with the root of the speed.
    ratio = found[1.0][0] / found[1.0][1]
    assert ratio == pytest.approx([0.5**0.5, 1.0, 1.0, 0.5, 0.5])
    whole = predict([5.0, 200.0], 5000.0, **PAIR, **ADMISSIBLE, **USUAL)
    assert whole["inside"][0] < 0.5 and np.isfinite(whole["heat_flux"]).all()


@pytest.mark.parametrize("pressure", [2.5e3, 7e3, 2e4])
def test_every_pressure_is_answered_with_more_heat_at_more_pitot_pressure(pressure):
    found = predict([5.0, 30.0, 80.0, 200.0], pressure, **PAIR, **ADMISSIBLE, **USUAL)["heat_flux"]
    assert (np.diff(found, axis=1) > 0).all() and (np.diff(found, axis=0) > 0).all()


def test_what_cannot_be_answered_is_refused():
    with pytest.raises(ValueError, match="chamber pressure must lie in"):
        predict([15.0], 2000.0, **PAIR, **ADMISSIBLE, **USUAL)
    with pytest.raises(ValueError, match="no pair 'Num-3'; known: Num-2, ZU1"):
        predict([15.0], 5000.0, **{**PAIR, "pair": "Num-3"}, **ADMISSIBLE, **USUAL)
    with pytest.raises(ValueError, match="recombination must lie in"):
        predict([15.0], 5000.0, **PAIR, **(ADMISSIBLE | {"recombination": (1e-3, 0.1)}), **USUAL)
    with pytest.raises(ValueError, match="below 500 Pa, 0.1 of that of the chamber, .* got 5000 Pa"):
        predict([15.0, 5000.0], 5000.0, **PAIR, **ADMISSIBLE, **USUAL)
    with pytest.raises(ValueError, match="must be 1 Pa or more: less asks .* got 0.1 Pa"):
        predict([15.0, 0.1], 5000.0, **PAIR, **ADMISSIBLE, **USUAL)
    with pytest.raises(ValueError, match="radius of the calorimeter must lie in .*; got 0.5 m"):
        predict([15.0], 5000.0, radius=0.5, **PAIR, **ADMISSIBLE, **USUAL)
    with pytest.raises(ValueError, match="recombination: the least comes first.*; got 0.1 and 0.01"):
        predict([15.0], 5000.0, **PAIR, **ADMISSIBLE | {"recombination": (0.1, 0.01)}, **USUAL)
    with pytest.raises(ValueError, match="of 200 draws meet the pair 'ZU1'"):
        catalytic = {"recombination": (0.1, 1.0), "nose": (0.0249, 0.025)}
        predict([15.0], 5000.0, **{**PAIR, "pair": "ZU1"}, **catalytic, **EXACT)


def test_intervals_hold_what_is_read_in_jets_like_those(monkeypatch):
    """A hundred facilities, a pair measured in each, and other readings with another mixing, of the table."""
    random, known, load = np.random.default_rng(77), jets(), tables.load
    asked, held = np.array([10.0, 15.0, 30.0, 100.0]), []

    def flux_of(wall, pitot, mixing):
        values, inside = known.at(pitot, 5e3, wall)
        share = weights(mixing, known.mixing)
        columns = (np.einsum("nm,mn->n", share, one[0]) for one in (values[..., 0], inside))
        flux, between = columns
        return np.exp(flux + CARRIED * (1 - between) * random.standard_normal(len(pitot)))

    for seed in range(100):
        gamma, nose = (np.exp(random.uniform(*np.log(ends))) for ends in ADMISSIBLE.values())
        one = [np.array([value]) for value in (gamma, random.integers(2), nose, random.uniform())]
        wall, mixing, fading = Explanations(*one), random.uniform(0.03, 0.09), random.uniform()
        first = np.array([random.uniform(13.0, 20.0)])
        read, flux = first * np.exp(0.05 * random.standard_normal()), flux_of(wall, first, np.array([mixing]))
        pair = {
            "pair": ["X"],
            "dynamic_pressure": read,
            "heat_flux": flux * np.exp(0.1 * random.standard_normal()),
        }
        monkeypatch.setattr(tables, "load", lambda name, pair=pair: pair if "pairs" in name else load(name))
        try:
            found = predict(asked, 5e3, **PAIR | {"pair": "X", "seed": seed}, **ADMISSIBLE, **USUAL)[
                "heat_flux"
            ]
        except ValueError:  # errors so large that hardly any mixing meets the pair
            continue
        true = asked * np.exp(-0.05 * random.standard_normal(4))
        there = mixing * (1 - fading * np.clip(np.log(true / first) / np.log(FADED), 0, 1))
        there = np.minimum(there * np.exp(0.25 * random.standard_normal(4)), known.mixing[-1])
        shown = flux_of(wall, true, there) * np.exp(0.1 * random.standard_normal(4))
        held.append((found[0] < shown) & (shown < found[2]))
    assert len(held) > 90
    assert 0.90 < np.mean(held) < 0.99
