"""Limits that hold whatever the lines are, and requests the engine must refuse."""

import re

import numpy as np
import pytest
import xarray as xr

from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import gas_path, path_radiance
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.radiation.systems import line_lists

FIRST, SECOND = 2 * 6.62607015e-34 * 299792458.0**2, 6.62607015e-34 * 299792458.0 / 1.380649e-23
OPAQUE = 1e14  # [m]


@pytest.fixture(scope="module")
def grid():
    return log_grid((770e-9, 785e-9), 8000)


@pytest.fixture(scope="module")
def systems(grid):
    return line_lists(grid)


def uniform(densities, temperature, length):
    values = densities(temperature)
    return gas_path(
        [0.0, length], np.full(2, temperature), {name: np.full(2, float(n)) for name, n in values.items()}
    )


def test_opaque_gas_follows_wien_where_photons_are_dear(systems, grid, equilibrium_densities):
    # h nu/kT = 4.6 at 4000 K: Planck exceeds Wien by exp(-4.6) = 1.0 %, as 1/(1 - exp(-x)) says.
    result = path_radiance(uniform(equilibrium_densities, 4000.0, OPAQUE), systems, grid)
    assert result.optical_depth.min() > 20
    x = SECOND / (grid.wavelength * 4000.0)
    wien = FIRST / grid.wavelength**5 * np.exp(-x)
    excess = result.radiance.sum(axis=0) / wien - 1
    assert excess == pytest.approx(np.exp(-x), rel=0.02, abs=0)


@pytest.mark.parametrize("temperature", [5000.0, 9000.0])
def test_an_enclosure_at_one_temperature_shows_planck_whatever_is_in_it(
    systems, grid, equilibrium_densities, temperature
):
    # Gas of any thickness and composition before a black wall of its own temperature.
    exact = blackbody_radiance(grid.wavelength, temperature)
    for length in (1e-3, 10.0, 1e6):
        path = uniform(equilibrium_densities, temperature, length)
        path.number_density["NO"][:] *= 7.0
        gas = path_radiance(path, systems, grid)
        found = gas.radiance.sum(axis=0) + exact * np.exp(-gas.optical_depth)
        assert found == pytest.approx(exact, rel=1e-6, abs=0)


def test_the_number_of_points_asked_for_does(systems, equilibrium_densities):
    span = (770e-9, 785e-9)
    path = uniform(equilibrium_densities, 6000.0, 0.1)
    with pytest.raises(ValueError, match="grid points must be >= ") as fault:
        path_radiance(path, systems, log_grid(span, 2000))
    needed = int(re.search(r">= (\d+)", str(fault.value))[1])
    path_radiance(path, systems, log_grid(span, needed))
    with pytest.raises(ValueError, match=f"grid points must be >= {needed}"):
        path_radiance(path, systems, log_grid(span, needed - 1))


def _spoil(name, index, value):
    def spoil(sightline):
        sightline[name].values[index] = value
        return sightline

    return spoil


def _unsorted(sightline):
    distance = sightline.path_distance.values.copy()
    distance[3] = distance[2]
    return sightline.assign_coords(path_distance=distance)


def _xenon(sightline):
    return sightline.assign_coords(species=np.array(["Xe", *SPECIES[1:]], dtype=object))


@pytest.mark.parametrize(
    "spoil, message",
    [
        (_xenon, "species of the path must be N2, .*; unknown: Xe, missing: N2"),
        (_spoil("number_density", (3, 5), -1.0), "number_density of N must be >= 0 m-3; got -1 m-3 at"),
        (_spoil("number_density", (4, 2), np.nan), r"number_density of O must be >= 0 m-3; got nan m-3"),
        (_spoil("temperature", 7, 2e4), r"temperature must lie in \[200, 15000\] K; got 20000 K at"),
        (_spoil("temperature", 1, np.nan), r"temperature must lie in \[200, 15000\] K; got nan K"),
        (_unsorted, "path_distance must increase strictly; got .* at index 3"),
    ],
)
def test_spoilt_sight_lines_are_refused_with_one_clear_message(jet_sightline, spoil, message):
    wavelength = np.linspace(771e-9, 784e-9, 30)
    response = xr.Dataset(
        {f"responsivity_{band}": ("wavelength", np.ones(30)) for band in ("wide", "narrow")},
        coords={"wavelength": wavelength},
    )
    with pytest.raises(ValueError, match=message):
        line_of_sight_radiance(
            spoil(jet_sightline.copy(deep=True)),
            response,
            wavelength_range=(770e-9, 785e-9),
            grid_points=8000,
            slit_fwhm=0.75e-9,
        )
