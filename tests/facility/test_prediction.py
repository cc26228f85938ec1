"""What meets a measured pair predicts it, and other pressures as the computed jets say."""

import numpy as np
import pytest

from plasmapyro import tables
from plasmapyro.facility.jet import Jet
from plasmapyro.facility.prediction import NOSES, RATES, Explanations, jets, needed_mixing, predict
from plasmapyro.facility.probes import Calorimeter, heat_flux, pitot_pressure

PAIR = {"pair": "Num-2", "draws": 200, "seed": 1}
ADMISSIBLE = {"recombination": (0.01, 0.1), "nose": (0.005, 0.025)}
EXACT = {"flux_uncertainty": 1e-9, "pressure_uncertainty": 1e-9}
USUAL = {"flux_uncertainty": 0.1, "pressure_uncertainty": 0.05}
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


@pytest.mark.parametrize("pressure, mixing", [(5e3, 0.0), (1e4, 0.12)])
def test_the_table_is_what_probes_take_from_such_a_stream(pressure, mixing):
    """Without the flow: a sphere in a uniform stream of the tabulated temperature and speed."""
    table = tables.load("facility/jets")
    row = int(np.flatnonzero((table["pressure"] == pressure) & (table["mixing"] == mixing))[2])
    jet = Jet(table["temperature"][row], pressure, table["speed"][row], 0.0)
    found, _ = heat_flux(jet, Calorimeter(0.025, recombination=0.1), "kossyi")
    assert found == pytest.approx(table["flux_kossyi_0.1"][row], rel=UNDISTURBED)
    assert pitot_pressure(jet, 0.0125) == pytest.approx(table["pitot_12.5_mm"][row], rel=0.2)


def test_more_mixing_takes_heat_at_the_same_pitot_pressure():
    wall = explanation(0.03, "kossyi", 0.0125)
    found = [needed_mixing(wall, flux, 14.98) for flux in (700e3, 600e3, 500e3)]
    mixing, kelvin = np.concatenate(found, axis=1)
    assert np.all(np.diff(mixing) > 0) and np.all(np.diff(kelvin) < 0) and mixing[0] > 0
    assert np.isnan(needed_mixing(wall, 5e6, 14.98)).all()


def test_what_cannot_be_answered_is_refused():
    with pytest.raises(ValueError, match="chamber pressure must lie in"):
        predict([15.0], 2000.0, **PAIR, **ADMISSIBLE, **USUAL)
    with pytest.raises(ValueError, match="no pair 'Num-3'; known: Num-2, ZU1"):
        predict([15.0], 5000.0, **{**PAIR, "pair": "Num-3"}, **ADMISSIBLE, **USUAL)
    with pytest.raises(ValueError, match="recombination must lie in"):
        predict([15.0], 5000.0, **PAIR, **(ADMISSIBLE | {"recombination": (1e-3, 0.1)}), **USUAL)
    with pytest.raises(ValueError, match="of 200 draws meet the pair 'ZU1'"):
        catalytic = {"recombination": (0.1, 1.0), "nose": (0.0249, 0.025)}
        predict([15.0], 5000.0, **{**PAIR, "pair": "ZU1"}, **catalytic, **EXACT)
