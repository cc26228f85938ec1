"""Net emission against the radiance of a thin slab, which goes through the spectral grid."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.atoms import TABLE_RANGE
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.net_emission import STEP, net_emission
from plasmapyro.radiation.path import gas_path, path_radiance
from plasmapyro.radiation.systems import line_lists

PRESSURE = 5e3
HOT = 9000.0
# Line wings that the grid cuts at the ends of the range, and the continuum on a coarser axis.
SPECTRUM_RTOL = 5e-3


@pytest.fixture(scope="module")
def table():
    temperature = np.linspace(3000.0, HOT, STEP + 1)
    gas = xr.Dataset(coords={"pressure": [PRESSURE, 2 * PRESSURE], "temperature": temperature})
    return net_emission(gas)


def test_table_honours_the_contract(table):
    contracts.check(contracts.label(table, "net_emission"), "net_emission")
    assert table.temperature.values.tolist() == [3000.0, HOT]


def test_a_thin_slab_radiates_the_net_emission(table):
    thickness, temperature = 1e-6, np.full(2, HOT)
    density = dict(zip(SPECIES, number_density(temperature, PRESSURE).T, strict=True))
    grid = log_grid(TABLE_RANGE, 160_000)
    path = gas_path(np.array([0.0, thickness]), temperature, density)
    radiance = path_radiance(path, line_lists(grid), grid).thin_radiance[::-1]
    expected = 4 * np.pi * np.trapezoid(radiance, grid.wavelength[::-1]) / thickness
    found = float(table.net_emission.sel(pressure=PRESSURE, temperature=HOT))
    assert found == pytest.approx(expected, rel=SPECTRUM_RTOL)


def test_hot_and_dense_gas_radiates_more(table):
    assert float(table.net_emission[0, 1]) > 1e3 * float(table.net_emission[0, 0])
    assert (table.net_emission.values[1] > table.net_emission.values[0]).all()
