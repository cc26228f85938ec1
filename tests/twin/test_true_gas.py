"""A true gas of another power than the simulated one, hidden in a synthetic test."""

import numpy as np
import pytest
import xarray as xr
from twin import story

WAVELENGTH = np.linspace(700e-9, 1200e-9, 6)
SLOPE = np.array([6.0, 3.0])  # of ln L over ln P, of two radiating systems
HIDDEN = [{"effect": "power", "amplitude": -0.07}]


def simulated(power):
    light = (power / 80e3) ** SLOPE[:, None] * np.array([1.0, 2.0])[:, None] * (1 + WAVELENGTH / 1e-6)
    return xr.Dataset(
        {
            "gas_radiance_component": (("component", "wavelength"), light),
            "gas_radiance": ("wavelength", light.sum(axis=0)),
        },
        {"wavelength": WAVELENGTH, "component": ["lines", "bands"]},
        {"numerical_power": power},
    )


@pytest.mark.parametrize("change", [-0.07, 0.1])
def test_light_between_powers_follows_the_power_law_of_each_system(change):
    beside = [simulated(70e3), simulated(90e3)]
    effects = [{"effect": "power", "amplitude": change}]
    ((weight, gas),) = story.true_gas(effects, [(1.0, simulated(80e3))], beside)
    wanted = simulated(80e3 * (1 + change))
    assert weight == 1.0
    np.testing.assert_allclose(gas.gas_radiance_component, wanted.gas_radiance_component, rtol=1e-12)
    np.testing.assert_allclose(gas.gas_radiance, wanted.gas_radiance, rtol=1e-12)


def test_a_power_beyond_the_simulated_ones_is_refused():
    with pytest.raises(ValueError, match=r"beyond 74.4 kW"):
        story.true_gas(HIDDEN, [(1.0, simulated(80e3))], [simulated(90e3)])


def test_nothing_hidden_leaves_the_gas_as_it_is():
    weighted = [(1.0, simulated(80e3))]
    assert story.true_gas([], weighted) is weighted


def test_a_test_records_the_pressure_of_its_gas_and_hides_no_early_exposures():
    gas = simulated(80e3).assign_attrs(chamber_pressure=1e4, mass_flow_rate=8e-3)
    told = story.scene("mine", [], [(1.0, gas)], ())
    assert told.centred_exposures and told.hidden == ()
    assert (told.chamber_pressure, told.mass_flow_rate) == (1e4, 8e-3)
