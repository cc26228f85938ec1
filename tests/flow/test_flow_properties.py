"""Property tables of the flow: exact at nodes, consistent derivatives, refusals."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.flow.boundary import inlet_mach_number
from plasmapyro.flow.geometry import Torch
from plasmapyro.flow.properties import OutsideTable, gas_properties

HERMITE_RTOL = 2e-6  # fine grid of 2.5 K resampled from a 50 K spline
NAMES = (
    "density",
    "enthalpy",
    "heat_capacity",
    "viscosity",
    "thermal_conductivity",
    "electrical_conductivity",
)


@pytest.mark.parametrize("name", ["density", "viscosity", "thermal_conductivity"])
def test_table_values_are_met_at_table_temperatures(air, name):
    properties = gas_properties(air, 5e3, 350.0)
    temperature = air.temperature.values[3:-3]
    expected = air[name].sel(pressure=5e3).values[3:-3]
    np.testing.assert_allclose(getattr(properties, name)(temperature)[0], expected, rtol=HERMITE_RTOL)


@pytest.mark.parametrize("name", [*NAMES, "density_slope"])
def test_slope_is_the_derivative_of_the_value(air, name):
    table = getattr(gas_properties(air, 5e3, 350.0), name)
    temperature = np.linspace(400.0, 14000.0, 997)
    difference = (table(temperature + 1e-3)[0] - table(temperature - 1e-3)[0]) / 2e-3
    slope = table(temperature)[1]
    np.testing.assert_allclose(slope, difference, rtol=1e-5, atol=1e-6 * np.abs(slope).max())


def test_heat_capacity_is_the_slope_of_the_enthalpy_and_near_the_tabulated_one(air):
    properties = gas_properties(air, 5e3, 350.0)
    temperature = np.linspace(500.0, 14000.0, 301)
    capacity = properties.heat_capacity(temperature)[0]
    np.testing.assert_allclose(properties.enthalpy(temperature)[1], capacity, rtol=1e-5)
    tabulated = np.interp(temperature, air.temperature, air.heat_capacity.sel(pressure=5e3))
    np.testing.assert_allclose(capacity, tabulated, rtol=0.03)  # linear interpolation in steps of 50 K
    assert properties.enthalpy(350.0)[0] == pytest.approx(0.0, abs=1e-3)


def test_density_slope_is_the_slope_of_the_density(air):
    properties = gas_properties(air, 5e3, 350.0)
    temperature = np.linspace(300.0, 14000.0, 301)
    slope = properties.density(temperature)[1]
    np.testing.assert_allclose(properties.density_slope(temperature)[0], slope, rtol=1e-4)


def test_density_proportional_to_pressure_is_interpolated_exactly(constant_gas):
    # Linear in ln p of ln rho: rho ~ p comes out at any pressure between the nodes.
    assert gas_properties(constant_gas, 2345.0, 350.0).density(5000.0)[0] == pytest.approx(4.69, rel=1e-12)


def test_a_temperature_outside_the_table_is_refused(air):
    table = gas_properties(air, 5e3, 350.0).density
    with pytest.raises(OutsideTable, match="temperature 16000 K outside the property table 200..15000 K"):
        table(np.array([500.0, 16000.0]))
    with pytest.raises(OutsideTable, match="temperature nan K"):
        table(np.nan)


@pytest.mark.parametrize(
    ("pressure", "message"), [(1e5, r"lie in \[4500, 5500\] Pa"), (-1.0, "must be > 0 Pa")]
)
def test_a_pressure_outside_the_table_is_refused(air, pressure, message):
    with pytest.raises(ValueError, match=message):
        gas_properties(air, pressure, 350.0)


def test_net_emission_is_a_property_with_its_slope(air):
    pressure = air.pressure.values
    temperature = np.arange(200.0, 15001.0, 250.0)
    law = 1e3 * pressure[:, None] * np.exp(-6e4 / temperature)
    emission = xr.Dataset(
        {"net_emission": (("pressure", "temperature"), law)},
        {"pressure": pressure, "temperature": temperature},
    )
    assert gas_properties(air, 5e3, 350.0, emission, 0.0).net_emission is None
    table = gas_properties(air, 5e3, 350.0, emission, 2.0).net_emission
    at = np.array([4000.0, 7100.0, 10900.0])
    value, slope = table(at)
    assert value == pytest.approx(2 * 5e6 * np.exp(-6e4 / at), rel=5e-3)  # monotone cubics over 250 K
    assert slope == pytest.approx(value * 6e4 / at**2, rel=3e-2)
    with pytest.raises(ValueError, match="radiation_factor 1 needs a table of net emission"):
        gas_properties(air, 5e3, 350.0, None, 1.0)


def test_the_mach_number_of_the_feed(air, torch_lengths):
    # Dry air at 350 K: gamma 1.40, R 287 J/(kg K), a = 375 m/s. 16 g/s at 50 mbar through the slot: 133 m/s.
    velocity = 0.016 * 287.0 * 350.0 / (5e3 * np.pi * (0.080**2 - 0.075**2))
    found = inlet_mach_number(Torch(**torch_lengths), gas_properties(air, 5e3, 350.0), 0.016, 350.0)
    assert found == pytest.approx(velocity / np.sqrt(1.4 * 287.0 * 350.0), rel=0.01)


def test_the_heat_flux_potential_is_inverted_and_its_slope_is_the_conductivity(air):
    properties = gas_properties(air, 5e3, 350.0)
    temperature = np.linspace(210.0, 14900.0, 777)
    potential, slope = properties.heat_flux_potential(temperature)
    np.testing.assert_allclose(slope, properties.thermal_conductivity(temperature)[0], rtol=1e-4)
    np.testing.assert_allclose(properties.temperature_of(potential), temperature, rtol=1e-6)
    assert properties.temperature_of(np.array([-1.0, 1e9])) == pytest.approx([200.0, 15000.0])
