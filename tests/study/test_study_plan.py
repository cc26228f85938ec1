"""What a study asks for follows from its file alone: conditions, flows, sight lines, and who starts where."""

from itertools import product
from math import prod
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from plasmapyro import configuration
from plasmapyro.flow.condition import Condition
from plasmapyro.study import plan

ROOT = Path(__file__).resolve().parents[2]
START = {"numerical_power_kw": 90, "chamber_pressure_mbar": 50, "mass_flow_rate_g_s": 16}
STEP_KW = 10
RANGES = {
    "numerical_power_kw": (30, 200),
    "chamber_pressure_mbar": (15, 300),
    "mass_flow_rate_g_s": (5, 30),
    "emittance": (0.01, 1),
    "angle_deg": (23, 89),
}
TWIN_RTOL = 1e-12  # the same differences of logarithms, added in another order


def study(**changes):
    axes = {
        "numerical_power_kw": [80, 90, 100],
        "chamber_pressure_mbar": [50, 100],
        "mass_flow_rate_g_s": [16],
        "emittance": [0.3, 0.6, 0.9],
        "angle_deg": [35, 50],
    }
    rest = {key: changes.pop(key) for key in ("extra", "limit", "longest_chain") if key in changes}
    return {"axes": {**axes, **changes}, "object_temperature_k": [800, 2400, 100], "longest_chain": 3, **rest}


def made(**changes):
    return plan.make(study(**changes), START, STEP_KW)


def one(**changes):
    return {
        "numerical_power_kw": 80,
        "chamber_pressure_mbar": 50,
        "mass_flow_rate_g_s": 16,
        "emittance": 0.3,
        "angle_deg": 35,
        **changes,
    }


def test_conditions_are_the_product_and_share_flows_and_sight_lines():
    found = made()
    assert len(found.conditions) == 3 * 2 * 1 * 3 * 2
    assert len(found.flows) == 3 * 2
    assert len(found.sight_lines) == 3 * 2 * 2
    assert found.flows["80kW_100mbar_16gs"]["chamber_pressure_mbar"] == 100
    assert found.sight_lines["80kW_100mbar_16gs_50deg"] == ("80kW_100mbar_16gs", 50)


def test_an_extra_emittance_asks_for_no_flow_and_no_sight_line():
    found = made(extra=[one(emittance=0.77)])
    assert len(found.conditions) == 37
    assert found.flows == made().flows and found.sight_lines == made().sight_lines


def test_an_extra_power_asks_for_one_of_each():
    found = made(extra=[one(numerical_power_kw=85.5)])
    assert set(found.flows) - set(made().flows) == {"85.5kW_50mbar_16gs"}
    assert set(found.sight_lines) - set(made().sight_lines) == {"85.5kW_50mbar_16gs_35deg"}


values = {
    axis: st.lists(st.floats(*ends).map(lambda number: round(number, 3)), min_size=1, max_size=4, unique=True)
    for axis, ends in RANGES.items()
}


@settings(max_examples=60, deadline=None, derandomize=True)
@given(axes=st.fixed_dictionaries(values), longest=st.integers(0, 5))
def test_any_study_names_each_job_once_and_has_no_long_chain(axes, longest):
    found = plan.make(study(**axes, longest_chain=longest), START, STEP_KW)
    sizes = {axis: len(entries) for axis, entries in axes.items()}
    assert len(found.conditions) == len(set(found.conditions)) == prod(sizes.values())
    assert len(found.flows) == prod(sizes[axis] for axis in plan.FLOW_AXES)
    assert len(found.sight_lines) == len(found.flows) * sizes["angle_deg"]
    assert all(configuration.NAME.fullmatch(name) for name in found.sight_lines)
    for name, chain in found.chains.items():
        assert len(chain) == found.level(name) <= longest
        assert name not in chain and len(set(chain)) == len(chain)
        if chain:  # a chain is the parent and the parent's own chain, so none can close
            assert found.chains[chain[0]] == chain[1:]


@settings(max_examples=25, deadline=None, derandomize=True)
@given(axes=st.fixed_dictionaries({axis: values[axis] for axis in plan.FLOW_AXES}))
def test_no_flow_has_a_longer_way_than_from_the_cold_start(axes):
    found = plan.make(study(**axes, emittance=[0.5], angle_deg=[35], longest_chain=3), START, STEP_KW)
    where = {name: condition(place) for name, place in found.flows.items()}
    for name, chain in found.chains.items():
        if chain:
            to_parent = where[chain[0]].parts_to(where[name], STEP_KW * 1e3)
            to_start = condition(START).parts_to(where[name], STEP_KW * 1e3)
            assert np.ceil(to_parent - 1e-9) < np.ceil(to_start - 1e-9)


def condition(place):
    return Condition(
        place["numerical_power_kw"] * 1e3,
        place["chamber_pressure_mbar"] * 100,
        place["mass_flow_rate_g_s"] * 1e-3,
        400e3,
        350.0,
    )


def test_the_distance_between_flows_is_that_of_the_solver():
    generator = np.random.default_rng(5)
    ends = [RANGES[axis] for axis in plan.FLOW_AXES]
    for _ in range(50):
        first, second = (
            dict(zip(plan.FLOW_AXES, (generator.uniform(*end) for end in ends), strict=True))
            for _ in range(2)
        )
        ours = plan._parts(*(np.array(plan._place(one, STEP_KW)) for one in (first, second)))
        theirs = condition(first).parts_to(condition(second), STEP_KW * 1e3)
        assert ours == pytest.approx(theirs, rel=TWIN_RTOL, abs=0)


def test_a_row_of_powers_becomes_a_shallow_tree_of_single_steps():
    powers = list(range(92, 131, 2))
    found = made(numerical_power_kw=powers, chamber_pressure_mbar=[50], longest_chain=3)
    levels = [found.level(f"{power}kW_50mbar_16gs") for power in powers]
    assert levels == [0] * 5 + [1] * 5 + [2] * 5 + [3] * 5
    for power in powers[5:]:
        parent = found.chains[f"{power}kW_50mbar_16gs"][0]
        assert power - found.flows[parent]["numerical_power_kw"] <= 10


def test_without_a_chain_every_flow_starts_cold():
    assert set(made(longest_chain=0, numerical_power_kw=[50, 60, 70, 80]).chains.values()) == {()}


def test_nine_hundred_flows_are_planned_in_four_levels():
    axes = dict(
        numerical_power_kw=list(range(50, 140, 10)),
        chamber_pressure_mbar=[15, 20, 30, 40, 50, 70, 100, 140, 200, 300],
        mass_flow_rate_g_s=[6, 8, 10, 12, 14, 16, 18, 20, 24, 28],
    )
    found = made(**axes, emittance=[0.5], angle_deg=[35])
    assert len(found.flows) == 900
    assert max(map(len, found.chains.values())) == 3


def test_the_order_of_the_values_does_not_matter():
    assert made(numerical_power_kw=[100, 80, 90]).chains == made().chains


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (dict(limit=35), "36 conditions (3 numerical_power_kw x 2 chamber_pressure_mbar x"),
        (
            dict(emittance=[k / 1000 for k in range(1, 1000)]),
            "set study.limit to 11988 or more if you mean it",
        ),
        (dict(angle_deg=[35, 35.0000000000001]), "study.axes.angle_deg: 35 is given twice"),
        (dict(extra=[one()]), "study.extra: 80, 50, 16, 0.3, 35 is given twice"),
        (dict(extra=[one(emittance=0.77)] * 2), "study.extra: 80, 50, 16, 0.77, 35 is given twice"),
        (dict(extra=[one(angle_deg=35.0000000000001, emittance=0.77)]), "angle_deg: 35 is given twice"),
    ],
)
def test_a_study_that_cannot_be_meant_is_refused(changes, message):
    with pytest.raises(configuration.ConfigurationError) as caught:
        made(**changes)
    assert message in str(caught.value)


def test_a_limit_beyond_all_memory_is_refused_before_it_is_tried():
    many = list(np.linspace(30, 200, 10_000))
    with pytest.raises(configuration.ConfigurationError, match="more than the limit of 1000"):
        made(**{axis: many for axis in plan.AXES})


def configured(**changes):
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text())
    return {**config, "study": study(**changes)}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (dict(numerical_power_kw=[]), "study.axes.numerical_power_kw: [] should be non-empty (Powers"),
        (dict(emittance=[0.5, 0.5]), "study.axes.emittance: [0.5, 0.5] has non-unique elements"),
        (dict(numerical_power_kw=[90_000]), "study.axes.numerical_power_kw.0: 90000 is greater than"),
        (dict(chamber_pressure_mbar=["50 mbar"]), "'50 mbar' is not of type 'number'"),
        (dict(emittance=[0]), "study.axes.emittance.0: 0 is less than or equal to the minimum of 0"),
        (dict(angle_deg=[95]), "study.axes.angle_deg.0: 95 is greater than or equal to the maximum of 90"),
        (dict(mass_flow_rate_kg_s=[0.016]), "did you mean 'mass_flow_rate_g_s'?"),
        (dict(extra=[{**one(), "angle": 3}]), "did you mean 'angle_deg'?"),
    ],
)
def test_the_schema_names_the_axis_and_the_rule(changes, message):
    with pytest.raises(configuration.ConfigurationError) as caught:
        configuration.check(configured(**changes), ROOT / "config/schema.yaml", "the configuration")
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 2


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            dict(angle_deg=[35, 20]),
            "angle_deg: 20 deg; a line of sight this close to the axis ends at the torch",
        ),
        (dict(extra=[one(angle_deg=22)]), "more than 22.6 deg"),
    ],
)
def test_a_study_that_does_not_fit_the_rest_is_refused(changes, message):
    with pytest.raises(configuration.ConfigurationError) as caught:
        plan.check(configured(**changes))
    assert message in str(caught.value)


def test_pressures_outside_the_table_and_a_window_inside_the_chamber_are_refused():
    config = configured(chamber_pressure_mbar=[15, 50, 300])
    plan.check(config)
    config["gas"]["pressure_mbar"] = [40, 100]
    config["sightline"]["window_distance_mm"] = 200
    with pytest.raises(configuration.ConfigurationError) as caught:
        plan.check(config)
    faults = str(caught.value).splitlines()[1:]
    assert ["15 mbar" in faults[0], "300 mbar" in faults[1]] == [True, True]
    assert faults[2:] == [
        "  angle_deg: 35 deg; its line of sight leaves the simulated chamber behind the window"
        " (sightline.window_distance_mm: 200 mm)",
        "  angle_deg: 50 deg; its line of sight leaves the simulated chamber behind the window"
        " (sightline.window_distance_mm: 200 mm)",
    ]


def test_ranges_of_the_axes_are_those_of_a_condition():
    whole = yaml.safe_load((ROOT / "config/schema.yaml").read_text())["properties"]
    rules = whole["study"]["properties"]
    single = yaml.safe_load((ROOT / "config/schema_condition.yaml").read_text())["properties"]
    single["angle_deg"] = whole["sightline"]["properties"]["angle_deg"]
    for axis in plan.AXES:
        expected = bounds(single[axis])
        assert bounds(rules["axes"]["properties"][axis]["items"]) == expected
        assert bounds(rules["extra"]["items"]["properties"][axis]) == expected


def bounds(rule):
    return {key: value for key, value in rule.items() if "imum" in key.lower()}


def test_the_shipped_study_fits():
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text())
    config |= configuration.read(ROOT / "config/study.yaml")
    configuration.check(config, ROOT / "config/schema.yaml", "the configuration")
    plan.check(config)
    found = plan.make(config["study"], config["flow"]["start"], config["flow"]["power_step_kw"])
    assert (len(found.conditions), len(found.flows), len(found.sight_lines)) == (270, 18, 54)


def test_conditions_in_si_are_those_of_the_plan():
    asked = study(extra=[one(emittance=0.77)])
    rows = plan.in_si(asked["axes"], asked["extra"])
    factors = np.array([1e3, 100.0, 1e-3, 1.0, np.pi / 180])
    expected = np.array(plan.make(asked, START, STEP_KW).conditions) * factors
    np.testing.assert_array_equal(rows, expected)
    assert list(rows[0]) == pytest.approx([80e3, 5000.0, 0.016, 0.3, np.radians(35)], rel=TWIN_RTOL, abs=0)


def test_names_do_not_depend_on_how_a_number_is_written():
    assert plan.flow_name((80.0, 50, 16)) == plan.flow_name((80, 50.0, 16.0)) == "80kW_50mbar_16gs"
    assert len({plan.flow_name(place) for place in product([80, 80.1], [50], [16, 16.01])}) == 4
