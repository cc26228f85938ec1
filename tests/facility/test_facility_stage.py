"""Readings of probes in a flow, and what measured pairs say of a family of flows."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from half_disc import POINT, flow

from plasmapyro import configuration, contracts
from plasmapyro.facility.jet import Jet, edge_ahead, jet_ahead, own_heat_flux, own_pressure
from plasmapyro.facility.probes import Calorimeter, heat_flux, pitot_pressure
from plasmapyro.facility.stage import _together, _verdict, _with_causes, facility, probe_readings
from plasmapyro.facility.verdict import as_markdown
from plasmapyro.gas.species import AIR
from plasmapyro.gas.stage import gas_table
from plasmapyro.quantities import in_si

RADIUS, SLOPE, GRADIENT = 0.025, 4e4, 1200.0  # [m], [K m-1], [s-1]
SCHEMA = Path(__file__).resolve().parents[2] / "config/schema_condition.yaml"


@pytest.fixture(scope="module")
def gas():
    return gas_table(temperature=np.arange(300.0, 7001.0, 50.0), pressure=[5000.0])


@pytest.fixture(scope="module")
def invented():
    """Temperature straight from a wall at 350 K; speeds and pressure as simple functions of the distance."""
    distance = np.concatenate([np.linspace(1e-5, 4.1e-4, 5), np.geomspace(1e-3, 0.08, 40)])
    found = flow(lambda d: np.minimum(350 + SLOPE * d, 5400.0), distance, rays=61)
    ahead = POINT - found.node_z.values
    scalars = {"chamber_pressure": 5000.0, "numerical_power": 6e4, "coil_current": 550.0}
    return (
        found.assign(
            axial_velocity=("node", 4000.0 * ahead),
            radial_velocity=("node", GRADIENT * found.node_r.values),
            pressure=("node", 5003.0 - 20.0 * ahead),
            boundary_heat_flow=("boundary", [9e3, 1e3, 5e3]),
            **{name: ((), value) for name, value in scalars.items()},
        )
        .assign_coords(boundary=["back_wall", "tube_wall", "probe"])
        .assign_attrs(wall_temperature=350.0, torch='{"radius": 0.04}')
    )


def test_edge_and_jet_are_read_where_they_lie(invented):
    edge, jet = edge_ahead(invented, RADIUS), jet_ahead(invented, RADIUS)
    assert (edge.distance, edge.pressure) == (pytest.approx(0.015), 5000.0)
    assert edge.temperature == pytest.approx(950.0, rel=1e-3)
    assert edge.normal_speed == pytest.approx(60.0, rel=1e-6)
    assert edge.gradient == pytest.approx(GRADIENT, rel=1e-6)
    assert jet.speed == pytest.approx(200.0, rel=1e-6)
    assert jet.gauge_pressure == pytest.approx(2.0, abs=1e-6)
    assert own_pressure(invented) == pytest.approx(3.0, abs=1e-3)


def test_the_flows_own_heat_flux_is_conductivity_times_slope(invented, gas):
    cold = float(np.interp(350.0, gas.temperature, gas.thermal_conductivity[0]))
    assert own_heat_flux(invented, gas) == pytest.approx(cold * SLOPE, rel=0.02)


def test_readings_stand_beside_what_was_measured(invented, gas, caplog):
    caplog.set_level("INFO")
    written = {
        "heat_flux_kw_m2": {"value": 40, "uncertainty": 4, "shape": "blunt", "radius_mm": 25}
        | {"wall_temperature_k": 350, "recombination": [0.01, 0.1]},
        "pitot_pressure_pa": {"value": 90, "uncertainty": 5, "radius_mm": 25, "wall_temperature_k": 350},
        "coil_current_a": {"value": 500, "uncertainty": 20},
        "water_heat_kw": {"value": 12, "uncertainty": 1},
        "electric_power_kw": {"value": 50, "uncertainty": 2},
    }
    condition = {"numerical_power_kw": 60, "chamber_pressure_mbar": 50, "mass_flow_rate_g_s": 16}
    for known in ([0.1, 0.1], [0.1, 0.01], [0.01, 0.1]):  # a known coefficient, and ends in any order
        written["heat_flux_kw_m2"]["recombination"] = known
        configuration.check(condition | {"emittance": 0.8, "measured": written}, SCHEMA, "test")
    found = probe_readings(
        invented.assign(mass_flow_rate=0.010), gas, rates=["kossyi"], recombination=[1.0, 0.0],
        probe_radius=RADIUS, wall_temperature=350.0,
        pitot_radius=[RADIUS], measured=in_si(written),
    )  # fmt: skip
    contracts.check(contracts.label(found, "probe_readings"), "probe_readings")
    rows = {str(name): found.sel(measurement=name) for name in found.measurement.values}
    assert float(rows["coil_current"].simulated_low) == 550.0
    assert float(rows["water_heat"].simulated_high) == 1e4
    assert float(rows["water_heat"].measured_value) == 12e3
    assert float(rows["electric_power"].simulated_low) == 6e4
    assert "coil_current: measured 500 +- 20 A, simulated 550: 2.5 standard uncertainties too high" in (
        caplog.messages
    )
    assert any(
        line == "water_heat: measured 12 +- 1 kW, simulated 10: 2.0 standard uncertainties too low"
        for line in caplog.messages
    )
    wide = "a probe of 25 mm behind a torch of 40 mm; the jet is taken as uniform around it"
    assert sum(line.endswith(wide) for line in caplog.messages) == 2
    assert any("efficiency 1.20, which no torch has: less power" in line for line in caplog.messages)
    assert float(rows["pitot_pressure"].simulated_low) == pytest.approx(float(found.pitot_pressure[0]))
    # At 950 K there is nothing to recombine: catalysis cannot matter, and the flat probe takes less.
    low, high = (float(rows["heat_flux"][f"simulated_{end}"]) for end in ("low", "high"))
    assert low == pytest.approx(high, rel=1e-3)
    sphere, _ = heat_flux(Jet(950.0, 5000.0, 200.0, 2.0), Calorimeter(RADIUS), "equilibrium")
    assert 0.55 < low / sphere < 0.7


@pytest.mark.parametrize("nitrogen", [AIR["N2"], 1.0])
def test_a_pair_that_the_jet_itself_gives_asks_for_that_jet(nitrogen):
    jet = Jet(4800.0, 5000.0, 95.0, 0.7, nitrogen)
    wall = {"radius": 0.02, "shape": "blunt", "wall_temperature": 400.0, "recombination": [0.03, 0.03]}
    flux, _ = heat_flux(jet, Calorimeter(0.02, "blunt", 400.0, 0.03), "kossyi")
    read = pitot_pressure(jet, 0.008, wall_temperature=400.0)
    measured = {"pitot_pressure": {"value": read}, "heat_flux": wall | {"value": flux}}
    said, asked = _together(measured, [("Pa", 0, 0, read, read), None], jet, jet, "kossyi")
    assert asked.speed == pytest.approx(95.0, rel=1e-3)
    numbers = [float(word.strip("(),")) for word in said.split() if word.strip("(),")[0].isdigit()]
    assert len(numbers) == 6 and numbers[1::2] == pytest.approx(numbers[::2], rel=2e-3)
    assert (numbers[1], numbers[5]) == (4800.0, 95.0)


def test_a_pair_of_ones_own_gets_causes(caplog):
    """Num-2 as its file has it: 300 kW/m2 on a flat probe."""
    caplog.set_level("INFO")
    wall = {"radius": 0.025, "shape": "blunt", "wall_temperature": 350.0, "recombination": [0.1, 0.01]}
    pair = {
        "heat_flux": wall | {"value": 300e3, "uncertainty": 30e3},
        "pitot_pressure": {"value": 15.0, "uncertainty": 0.75, "radius": 0.025, "wall_temperature": 350.0},
    }
    jet, none = Jet(4700.0, 5000.0, 90.0, 0.7), xr.Dataset()
    found = _with_causes(none, pair, jet, 0.016, "kossyi")
    probability = found.cause_probability.to_series()
    assert probability.sum() == pytest.approx(1.0)
    assert probability[[name for name in probability.index if "mixing" in name]].sum() > 0.6
    assert any(line.startswith("causes: mixing") for line in caplog.messages)
    assert any("causes: what decides next" in line for line in caplog.messages)
    for other, mass_flow, reason in (
        (replace(jet, nitrogen=0.9), 0.016, "jets were computed in air"),
        (jet, 0.010, "with 16 g/s"),
        (replace(jet, pressure=1500.0), 0.016, "chamber pressure must lie in 25 to 200 mbar"),
    ):
        assert _with_causes(none, pair, other, mass_flow, "kossyi") is none
        assert "causes: not known" in caplog.messages[-1] and reason in caplog.messages[-1]


@pytest.mark.parametrize(
    "name, row, ends",
    [
        ("heat_flux", ("W m-2", 50e3, 5e3, 4e5, 5e5), "too high, 8 times; was it written in kW/m2?"),
        ("pitot_pressure", ("Pa", 5015, 1, 15, 15), "written in Pa and not with the chamber's pressure?"),
        ("heat_flux", ("W m-2", 5e5, 100, 4e5, 5e5), "uncertainty of 0.02 %; is it in kW/m2, not a share?"),
        ("coil_current", ("A", 400, 20, 566, 566), "8.3 standard uncertainties too high"),
    ],
)
def test_what_is_far_off_asks_for_its_unit(name, row, ends):
    assert _verdict(name, *row).endswith(ends)


def test_an_unknown_measurement_is_refused():
    condition = {"numerical_power_kw": 60, "chamber_pressure_mbar": 50, "mass_flow_rate_g_s": 16}
    with pytest.raises(configuration.ConfigurationError, match="heat_flux_kw"):
        configuration.check(condition | {"emittance": 0.8, "measured": {"heat_flux_kw": {}}}, SCHEMA, "test")


def family(scale=1.0, fraction=0.3):
    """Flows of five powers: flux proportional to pressure, half of what gamma brings at gamma = 0.01."""
    gamma = np.array([1.0, 0.1, 0.01, 0.0])
    share = fraction + (1 - fraction) * gamma / (gamma + 0.01) * 1.01

    def one(pressure):
        whole = scale * 50e3 * pressure
        values = {"numerical_power": 4e3 * pressure, "own_heat_flux": whole, "own_pressure": pressure}
        values |= {"equilibrium_heat_flux": whole, "edge_temperature": 5e3, "edge_enthalpy": 1e7}
        return xr.Dataset(
            {
                "stagnation_heat_flux": (("rates", "recombination"), whole * share[None]),
                "pitot_pressure": ("pitot_radius", [pressure, 1.5 * pressure]),
                **{name: ((), value) for name, value in (values | {"jet_speed": 80.0}).items()},
            },
            {"rates": ["kossyi"], "recombination": gamma, "pitot_radius": [0.025, 0.005]},
        )

    return {f"{p:g}": one(p) for p in (30.0, 5.0, 10.0, 14.0, 20.0)}


def judged(**options):
    settings = {
        "admissible_recombination": [0.01, 0.1],
        "flux_uncertainty": 0.1,
        "pressure_uncertainty": 0.05,
    }
    return facility(family(**options), **settings)


def test_a_pair_on_the_family_gives_back_its_recombination():
    # Num-2: 500 kW/m2 at 14.98 Pa; the family gives 749 fully catalytic there, and 0.6675 of it is needed.
    found = judged()
    contracts.check(contracts.label(found, "facility"), "facility")
    row = found.sel(pair="Num-2", rates="kossyi").isel(pitot_radius=0)
    share = (500e3 / (50e3 * 14.98) - 0.3) / 0.7 / 1.01
    assert float(row.needed_recombination) == pytest.approx(0.01 * share / (1 - share), rel=1e-3)
    assert int(row.pair_verdict) == 1
    assert float(row.matching_power) == pytest.approx(4e3 * 14.98, rel=1e-3)
    assert list(found.condition.values) == ["5", "10", "14", "20", "30"]


def test_what_is_left_over_is_said_in_heat_and_in_momentum():
    found = judged(scale=2.0)
    row = found.sel(pair="Num-2", rates="kossyi").isel(pitot_radius=0)
    assert int(row.pair_verdict) == 0
    at_low = 0.3 + 0.7 * 0.5 * 1.01  # share of the heat at gamma = 0.01
    assert float(row.heat_left[0]) == pytest.approx(2 * 50e3 * 14.98 * at_low / 500e3, rel=1e-3)
    # Flux is proportional to pressure here, so what is left of one is left of the other.
    assert row.momentum_left.values == pytest.approx(row.heat_left.values, rel=1e-3)
    assert int(judged(scale=0.3).sel(pair="Num-2").pair_verdict[0, 0]) == -1


def test_a_smaller_pitot_probe_asks_for_less():
    found = judged(scale=2.0).sel(pair="Num-2", rates="kossyi")
    assert found.heat_left.values[1] == pytest.approx(found.heat_left.values[0] / 1.5, rel=1e-3)


def test_the_names_of_a_pair_do_not_depend_on_the_flows():
    found = judged(scale=2.0)
    assert found.cause_probability.sum("cause").values == pytest.approx(1.0)
    assert judged().cause_probability.identical(found.cause_probability)
    mixed = found.sel(pair="Num-2", cause="mixing")
    assert np.isnan(mixed.cause_nose).all() and 0.0 < mixed.cause_mixing[0] < mixed.cause_mixing[1] < 0.12
    assert float(found.matching_temperature[0, 0]) == pytest.approx(5e3)


def test_the_page_has_a_row_for_each_pair_probe_and_cause():
    page = as_markdown(judged())
    probes, names = page.split("## Names")
    assert probes.count("| Num-2 |") == probes.count("| ZU1 |") == 2
    assert "explains: some admissible recombination" in probes
    assert (
        names.index("| Num-2 | mixing+") < names.index("| ZU1 | unknown |") and "| Num-2 | unknown |" in names
    )
    assert "| Num-2 | recombination |" not in names
