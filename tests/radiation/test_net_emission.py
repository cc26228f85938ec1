"""Net emission against published values, the red part of it, and what is known of thick lines."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.atoms import TABLE_RANGE
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.net_emission import STEP, escape, net_emission
from plasmapyro.radiation.path import gas_path, path_radiance
from plasmapyro.radiation.systems import line_lists

PRESSURE = 5e3
HOT = 9000.0


@pytest.fixture(scope="module")
def table():
    temperature = np.linspace(3000.0, HOT, STEP + 1)
    gas = xr.Dataset(coords={"pressure": [PRESSURE, 2 * PRESSURE], "temperature": temperature})
    return net_emission(gas)


def test_table_honours_the_contract(table):
    contracts.check(contracts.label(table, "net_emission"), "net_emission")
    assert table.temperature.values.tolist() == [3000.0, HOT]
    assert table.attrs["gas"] == "air" and table.attrs["absorption_radius"] == 0


@pytest.fixture(scope="module")
def molecular_bound():
    """Net emission of the lists of 650-1250 nm alone, through the spectral grid [W m-3]."""
    thickness, temperature = 1e-6, np.full(2, HOT)
    density = dict(zip(SPECIES, number_density(temperature, PRESSURE).T, strict=True))
    grid = log_grid(TABLE_RANGE, 160_000)
    path = gas_path(np.array([0.0, thickness]), temperature, density)
    radiance = path_radiance(path, line_lists(grid), grid).thin_radiance[::-1]
    return 4 * np.pi * np.trapezoid(radiance, grid.wavelength[::-1]) / thickness


def test_all_wavelengths_radiate_much_more_than_the_red_alone(table, molecular_bound):
    whole = float(table.net_emission.sel(pressure=PRESSURE, temperature=HOT))
    assert whole > 20 * molecular_bound  # mostly vacuum ultraviolet


def test_thin_air_radiates_as_published(published):
    """Naghizadeh-Kashani et al. (2002), 1 atm, R = 0, read off their figure to 12 %.

    Below 7000 K molecules radiate beyond 650-1250 nm, which we leave out.
    """
    rows = published("net_emission_air_1atm")
    temperature, expected = np.array([[float(value) for value in row.values()] for row in rows]).T
    gas = xr.Dataset(coords={"pressure": [101325.0], "temperature": np.repeat(temperature, STEP)})
    found = net_emission(gas).net_emission.values[0] / (4 * np.pi)
    ratio = found / 10**expected
    assert (ratio > 0.6).all() and (ratio < 1.2).all()
    assert ratio[temperature > 8000] == pytest.approx(0.88, abs=0.13)


def test_thin_oxygen_radiates_as_another_code_says(published):
    """Lines of minplascalc 1.1.1 (no continuum), 1 atm; of both codes from NIST, but chosen apart.

    To 9000 K lines are nearly all; what recombination and free electrons add grows from there on.
    """
    rows = published("net_emission_oxygen_1atm")
    temperature, expected = np.array([[float(value) for value in row.values()] for row in rows]).T
    gas = xr.Dataset(
        coords={"pressure": [101325.0], "temperature": np.repeat(temperature, STEP)}, attrs={"gas": "O2"}
    )
    ratio = net_emission(gas).net_emission.values[0] / (4 * np.pi) / 10**expected
    assert ratio[temperature <= 9000] == pytest.approx(1.03, abs=0.04)
    assert (np.diff(ratio) > 0).all() and ratio.max() < 1.25


def test_what_a_sphere_takes_up_is_as_published():
    """0.1 mm of air at 1 atm, a fit to fig. 13 of the same paper: 10^7.67 W m-3 sr-1 at 10 kK."""
    gas = xr.Dataset(coords={"pressure": [101325.0], "temperature": np.repeat([1e4, 1.1e4], STEP)})
    thin, seen = (float(net_emission(gas, radius).net_emission[0, 0]) for radius in (0.0, 1e-4))
    assert seen / (4 * np.pi) == pytest.approx(10**7.67, rel=1.0)
    assert (
        0.06 < seen / thin < 0.14
    )  # published 10^(7.67 - 8.83) = 0.07 by the fits, 0.05 by what was read off


def test_light_escapes_by_the_core_and_then_by_the_wings():
    assert escape(np.zeros(1), np.array([0.01]))[0] == 1
    # To first order in the depth a Gaussian loses depth/sqrt(2 pi).
    few = escape(np.array([0.01]), np.array([1e-6]))[0]
    assert 1 - few == pytest.approx(0.01 / np.sqrt(2 * np.pi), rel=0.1)
    # Far in the wings phi = a/(pi x^2): the integral is sqrt(a/depth) for a thick Lorentz line.
    thick = escape(np.array([1e5]), np.array([1.0]))[0]
    assert thick == pytest.approx(np.sqrt(1.0 / 1e5), rel=0.05)


def test_hot_and_dense_gas_radiates_more(table):
    assert float(table.net_emission[0, 1]) > 1e3 * float(table.net_emission[0, 0])
    assert (table.net_emission.values[1] > table.net_emission.values[0]).all()
