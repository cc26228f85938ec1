"""A test at another pressure than the simulated one: the gas is simulated at its own."""

import shutil

import numpy as np
import pytest
import xarray as xr
from small_job import DISTANCE, sight_line, surface_view
from two_bands import RESPONSE

from plasmapyro import io
from plasmapyro.conditions import pressure_of
from plasmapyro.diagnosis import command
from plasmapyro.diagnosis.gas.other_pressure import at_pressure
from plasmapyro.diagnosis.gas.templates import WARMTH_OF_POWER
from plasmapyro.diagnosis.simulation.simulated import expected_power
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.radiation.stage import line_of_sight_radiance

FLOW, CHAMBER = 5000.0, 1e4  # [Pa]
OF_TABLES = 2e-3  # [1] of the light: the emission table behind the finer grid, against lines one by one
STATED = {"chamber_pressure": FLOW, "mass_flow_rate": 0.016}


def at(pressure):
    return xr.Dataset({"chamber_pressure": ("time", [pressure] * 3)}, attrs={"condition": "80kW"})


@pytest.fixture(scope="module")
def run(small_results, tmp_path_factory):
    """Stage files of two powers whose pressure is stated."""
    folder = tmp_path_factory.mktemp("run")
    for power in ("80kW", "130kW"):
        made = io.read(small_results / f"radiation/{power}.nc", "radiation").assign_attrs(STATED)
        io.write(made, folder / f"radiation/{power}.nc", "radiation")
        line = sight_line(1e3 * float(power[:-2])).assign_attrs(STATED)
        io.write(line, folder / f"sightline/{power}.nc", "sightline")
        io.write(surface_view(line), folder / f"surface_view/{power}.nc", "surface_view")
    return folder


def test_a_sight_line_of_another_pressure_keeps_its_temperatures_in_equilibrium():
    line = sight_line(80e3)
    same, more = (at_pressure(line, factor, 0.79, "") for factor in (1.0, 4.0))
    np.testing.assert_allclose(same.number_density, line.number_density, rtol=1e-9)
    assert more.number_density.dims == line.number_density.dims
    np.testing.assert_array_equal(more.temperature, line.temperature)
    np.testing.assert_allclose(
        more.number_density.sum("species") * 1.380649e-23 * line.temperature, 4 * line.pressure, rtol=1e-6
    )
    hot = int(line.temperature.values.argmax())
    share = [float(one.number_density.sel(species="e-")[hot] / one.pressure[hot]) for one in (line, more)]
    assert share[1] < 0.9 * share[0]  # Le Chatelier: fewer free electrons per pressure


def test_a_gas_is_simulated_at_the_pressure_of_its_test(run):
    """Against the lines one by one of a gas in equilibrium at that pressure, the temperatures kept."""
    inputs = command.gas_of(run / "radiation")
    found = command.of_its_pressure(at(CHAMBER), inputs)
    own, line = found.radiation["80kW"], sight_line(80e3)
    pressure = np.full(DISTANCE.size, CHAMBER)
    density = number_density(line.temperature.values, pressure)
    line = line.assign(number_density=(("species", "path_distance"), density.T))
    line = line.assign(pressure=("path_distance", pressure))
    grid = {"wavelength_range": (700e-9, 1200e-9), "grid_points": 240_000}
    wanted = line_of_sight_radiance(line, RESPONSE, **grid, slit_fwhm=0.75e-9).gas_radiance_slit.values
    np.testing.assert_allclose(own.gas_radiance_slit, wanted, atol=OF_TABLES * wanted.max(), rtol=0.02)
    assert own.gas_radiance_slit.mean() > 1.5 * inputs.radiation["80kW"].gas_radiance_slit.mean()
    assert found.radiation["130kW"] is inputs.radiation["130kW"]  # too far in power to be asked
    assert set(found.variations) == {"80kW"} and "sightline/80kW.nc" in found.digests
    (said,) = (one for one in command.remarks_on(at(CHAMBER), found) if "mbar" in one)
    assert "simulated at the 100 mbar of the test along the temperatures of the flow at 50 mbar" in said


def test_the_gas_of_further_tests_is_varied_at_that_pressure_too(run):
    inputs = command.gas_of(run / "radiation")
    others = [at(CHAMBER).assign_attrs(condition=name) for name in ("130kW", "another gas")]
    found = command.of_its_pressure(at(CHAMBER), inputs, others)
    assert found.radiation["130kW"].chamber_pressure == CHAMBER  # though far in power
    assert set(found.variations) == {"80kW", "130kW"}


def test_a_gas_of_the_pressure_of_its_test_is_taken_as_it_is(run):
    inputs = command.gas_of(run / "radiation")
    assert command.of_its_pressure(at(1.05 * FLOW), inputs) is inputs
    assert command.of_its_pressure(at(1.05 * FLOW).drop_vars("chamber_pressure"), inputs) is inputs


def test_a_gas_that_its_condition_changes_is_simulated_at_no_other_pressure(run, tmp_path):
    shutil.copytree(run, tmp_path / "run")
    path = tmp_path / "run/radiation/80kW.nc"
    changed = io.read(path, "radiation")
    path.unlink()
    io.write(changed, path, "radiation", config={"changes": {"T_exc": 0.05}})
    inputs = command.gas_of(tmp_path / "run/radiation")
    assert command.of_its_pressure(at(CHAMBER), inputs) is inputs


def test_a_gas_that_no_table_holds_is_taken_as_it_is_and_said(run, tmp_path, monkeypatch):
    shutil.copytree(run, tmp_path / "run")
    path = tmp_path / "run/sightline/80kW.nc"
    line = io.read(path, "sightline").assign_attrs(gas="CO2")
    path.unlink()
    io.write(line, path, "sightline")
    inputs, said = command.gas_of(tmp_path / "run/radiation"), []
    monkeypatch.setattr(command.progress, "warn", said.append)
    found = command.of_its_pressure(at(CHAMBER), inputs)
    assert command.of_its_pressure(at(CHAMBER), found) is found and found.radiation is inputs.radiation
    assert [one.partition(": gas must be")[0] for one in said] == [
        "the gas is not simulated at the pressure of the test"
    ]


def test_a_gas_that_nobody_varied_is_varied_for_its_test(run, tmp_path):
    inputs = command.gas_of(run / "radiation")
    found = command.with_variations(at(FLOW), inputs)
    assert set(found.variations) == {"80kW"} and "surface_view/80kW.nc" in found.digests
    assert found.radiation is inputs.radiation and command.with_variations(at(FLOW), found) is found
    warmer = found.variations["80kW"].core_radiance.mean("wavelength_slit")  # hotter gas is brighter
    assert (np.diff(warmer) > 0).all()
    plain = found.variations["80kW"].core_radiance.sel(core_change=0, method="nearest")
    np.testing.assert_allclose(plain, inputs.radiation["80kW"].gas_radiance_slit, rtol=1e-6)
    shutil.copytree(run, tmp_path / "run")
    (tmp_path / "run/surface_view/80kW.nc").unlink()  # of the flow of another program
    alone = command.gas_of(tmp_path / "run/radiation")
    assert command.with_variations(at(FLOW), alone) is alone


@pytest.mark.parametrize("pressure", [50.0, 5e5])
def test_a_pressure_in_other_units_is_said(run, monkeypatch, pressure):
    inputs, said = command.gas_of(run / "radiation"), []
    monkeypatch.setattr(command.progress, "warn", said.append)
    assert command.of_its_pressure(at(pressure), inputs).radiation is inputs.radiation
    (words,) = said
    assert "chamber pressure must lie in [1500, 30000] Pa" in words


def test_a_pressure_that_was_not_logged_is_none():
    assert np.isnan(pressure_of(at(np.nan)))


@pytest.mark.parametrize(("pressure", "power", "hottest"), [(2500.0, -0.085, 5763.1), (1e4, 0.103, 6119.6)])
def test_flows_of_other_pressures_shine_as_those_of_another_power(pressure, power, hottest):
    """Flows solved at 25 and 100 mbar and 80 kW, read by spectra along the temperatures of that at 50 mbar,
    5934.9 K at the hottest; what a power does to temperatures says the same."""
    spectrum = xr.Dataset(attrs={"chamber_pressure": pressure, "flow_pressure": FLOW})
    mean, sigma = expected_power(spectrum)
    assert abs(power - mean) < sigma < 0.6 * abs(power)
    assert abs(np.log(hottest / 5934.9) / WARMTH_OF_POWER - mean) < sigma
    assert expected_power(xr.Dataset(attrs={"chamber_pressure": pressure})) == (0.0, 0.0)
