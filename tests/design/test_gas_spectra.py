"""Binned spectra: nothing is lost, and the table gives what the engine gives layer by layer."""

import numpy as np
import pytest

from plasmapyro.design.spectra import COLDEST_NODE, AirSpectra, bin_edges, binned, heated
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.path import gas_path, path_radiance
from plasmapyro.radiation.systems import line_lists

RANGE = (774e-9, 781e-9)
TABLE_RTOL = 2e-3  # eight temperature nodes over 7000 K


def test_bins_keep_the_integral():
    wavelength = np.sort(np.random.default_rng(1).uniform(700e-9, 720e-9, 4000))
    wavelength[0], wavelength[-1] = 700e-9, 720e-9
    radiance = np.random.default_rng(2).random((2, 4000))
    edges = np.linspace(700e-9, 720e-9, 21)
    np.testing.assert_allclose(
        binned(wavelength, radiance, edges) @ np.diff(edges), np.trapezoid(radiance, wavelength), rtol=1e-12
    )


def test_bins_fill_the_range_and_do_not_leave_the_data():
    edges = bin_edges((650e-9, 1250e-9), 1e-9)
    assert len(edges) == 601 and edges[-1] == 1250e-9
    with pytest.raises(ValueError, match="wavelength_range"):
        bin_edges((650e-9, 2600e-9), 1e-9)


def test_heating_leaves_cold_gas_alone_and_keeps_the_pressure():
    temperature = np.array([400.0, 3000.0, 8000.0])
    changed, density = heated(temperature, np.full(3, 5000.0), 1.05, 0.79)
    np.testing.assert_allclose(changed, [400.0, 3150.0, 8400.0])
    assert temperature[0] < COLDEST_NODE and density.shape == (len(SPECIES), 3)
    np.testing.assert_allclose(density.sum(axis=0) * 1.380649e-23 * changed, 5000.0, rtol=1e-9)


def test_the_binned_table_agrees_with_the_engine():
    air = AirSpectra(5000.0, 9000.0, wavelength_range=RANGE, grid_points=4000, nodes=8, bin_width=0.5e-9)
    distance, temperature = np.array([0.0, 0.03, 0.06]), np.array([6000.0, 6000.0, 7500.0])
    density = number_density(temperature, 5000.0).T
    path = gas_path(distance, temperature, dict(zip(SPECIES, density, strict=True)))
    engine = path_radiance(path, line_lists(air.grid), air.grid)
    whole = np.trapezoid(engine.radiance.sum(axis=0)[::-1], air.wavelength)
    got = air.radiance(distance, temperature, density).sum(axis=0) @ np.diff(air.edges)
    assert got == pytest.approx(whole, rel=TABLE_RTOL)
