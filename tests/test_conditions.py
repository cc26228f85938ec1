"""A ladder of powers holds conditions that share all but the power, whatever their names are."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import conditions, contracts


def gas(power, *, pressure=5000.0, rate=0.016, gas="air", angle=35.0):
    stated = conditions.stated(
        gas=gas,
        settings={"angle": angle},
        numerical_power=power,
        chamber_pressure=pressure,
        mass_flow_rate=rate,
    )
    return xr.Dataset(attrs=stated)


NINE = {f"{power}kW": gas(1e3 * power) for power in range(130, 40, -10)}


def test_a_ladder_rises_whatever_the_order_and_the_names():
    assert conditions.ladder("90kW", NINE) == [f"{power}kW" for power in range(50, 140, 10)]
    named = {"mine": gas(80e3), "a": gas(90e3), "zz": gas(60e3)}
    assert conditions.ladder("mine", named) == ["zz", "mine", "a"]


@pytest.mark.parametrize(
    "other",
    [{"pressure": 2000.0}, {"rate": 0.010}, {"gas": "CO2"}, {"angle": 45.0}, {"pressure": None}],
    ids=lambda changed: next(iter(changed)),
)
def test_a_condition_that_differs_in_more_than_its_power_stands_on_another(other):
    datasets = {**NINE, "95kW": gas(95e3, **other)}
    assert "95kW" not in conditions.ladder("90kW", datasets)
    assert conditions.ladder("95kW", datasets) == ["95kW"]


def test_of_equal_powers_the_condition_itself_stands_for_all_or_else_the_first_by_name():
    datasets = {"z": gas(90e3), "b": gas(90e3), "low": gas(60e3)}
    assert conditions.ladder("z", datasets) == ["low", "z"]
    assert conditions.ladder("low", datasets) == ["low", "b"]


def test_equal_is_meant_as_numbers_are():
    assert conditions.ladder("a", {"a": gas(9e4), "b": gas(8e4, pressure=0.05 * 1e5 * (1 + 1e-12))}) == [
        "b",
        "a",
    ]


def test_a_condition_without_a_power_stands_alone():
    datasets = {**NINE, "mine": gas(None), "bare": xr.Dataset()}
    assert conditions.ladder("mine", datasets) == ["mine"]
    assert conditions.ladder("bare", datasets) == ["bare"]
    assert conditions.ladder("90kW", datasets) == conditions.ladder("90kW", NINE)


def test_what_is_made_of_a_file_says_the_same():
    assert conditions.carried(NINE["90kW"]) == NINE["90kW"].attrs
    assert conditions.carried(xr.Dataset(attrs={"title": "x"})) == {}
    assert np.isnan(conditions.number(xr.Dataset(), "numerical_power"))


@pytest.mark.parametrize(
    ("name", "value"),
    [("numerical_power", np.nan), ("chamber_pressure", "50 mbar"), ("mass_flow_rate", -1.0), ("gas", 5)],
)
def test_a_file_cannot_state_nonsense(name, value):
    line = xr.Dataset(
        {
            "temperature": ("path_distance", [300.0, 300.0], {"units": "K"}),
            "pressure": ("path_distance", [5e3, 5e3], {"units": "Pa"}),
            "number_density": (("species", "path_distance"), [[1e20, 1e20]]),
        },
        {"path_distance": [0.0, 1.0], "species": ["N2"]},
        NINE["90kW"].attrs,
    )
    contracts.check(contracts.label(line, "sightline"), "sightline")
    with pytest.raises(contracts.ContractError, match=f"attribute {name}"):
        contracts.check(contracts.label(line.assign_attrs({name: value}), "sightline"), "sightline")
