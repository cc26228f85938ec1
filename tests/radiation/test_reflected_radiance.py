"""Light of the gas that arrives at the surface: what a mirror and a matt surface see of it."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.path import gas_path, path_radiance
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.stage import line_of_sight_radiance, reflected_radiance
from plasmapyro.radiation.systems import line_lists

RANGE = (770e-9, 785e-9)
FLOAT_RTOL = 1e-12  # thousands of eps, for sums in another order
KEYS = {"wavelength_range": RANGE, "grid_points": 7000, "slit_fwhm": 0.75e-9}
ANGLES, WEIGHTS = np.array([0.61, 0.02, 0.5, 1.2]), np.array([0.0, 0.2, 0.5, 0.3])


@pytest.fixture(scope="module")
def response():
    wavelength = np.linspace(771e-9, 784e-9, 27)
    shape = np.sin(np.pi * (wavelength - 771e-9) / 13e-9)
    return xr.Dataset(
        {"responsivity_wide": ("wavelength", shape), "responsivity_narrow": ("wavelength", shape**4)},
        coords={"wavelength": wavelength},
    )


@pytest.fixture(scope="module")
def view_of(equilibrium_densities):
    """Function (temperature of distance, lengths of the rays) -> dataset of contract 'surface_view'."""

    def view(temperature, lengths, points=9, pressure=5000.0):
        distance = np.linspace(0, 1, points) * np.array(lengths)[:, None]
        gas = np.array([temperature(row) for row in distance])
        density = equilibrium_densities(gas, pressure)
        return xr.Dataset(
            {
                "ray_angle": ("ray", ANGLES),
                "ray_weight": ("ray", WEIGHTS),
                "ray_distance": (("ray", "node"), distance),
                "ray_temperature": (("ray", "node"), gas),
                "ray_pressure": (("ray", "node"), np.full(gas.shape, pressure)),
                "ray_number_density": (
                    ("ray", "species", "node"),
                    np.stack([density[name] for name in SPECIES], axis=1),
                ),
            },
            {"species": list(SPECIES)},
        )

    return view


def uniform(distance):
    return np.full(distance.shape, 8000.0)


def cooling(distance):
    return 4000 + 4000 * np.tanh(distance / 0.01)


def test_the_file_honours_its_contract(view_of, response):
    found = reflected_radiance(view_of(cooling, [0.1, 0.4, 0.2, 0.1]), response, **KEYS)
    contracts.check(contracts.label(found, "reflected_radiance"), "reflected_radiance")
    assert found.reflection.values.tolist() == ["specular", "diffuse"]
    np.testing.assert_allclose(found.incident_radiance_component.sum("component"), found.incident_radiance)


def test_gas_that_looks_the_same_everywhere_returns_its_own_radiance(view_of, response):
    view = view_of(uniform, [0.1] * 4)
    found = reflected_radiance(view, response, **KEYS)
    outside = xr.Dataset(
        {
            "temperature": ("path_distance", view.ray_temperature.values[0]),
            "number_density": (("species", "path_distance"), view.ray_number_density.values[0]),
        },
        {"path_distance": view.ray_distance.values[0], "species": view.species},
    )
    direct = line_of_sight_radiance(outside, response, **KEYS)
    for reflection in ("specular", "diffuse"):
        there = found.sel(reflection=reflection)
        np.testing.assert_allclose(there.incident_radiance, direct.gas_radiance, rtol=FLOAT_RTOL)
        np.testing.assert_allclose(there.incident_radiance_slit, direct.gas_radiance_slit, rtol=FLOAT_RTOL)
        np.testing.assert_allclose(there.incident_signal, direct.band_signal, rtol=FLOAT_RTOL)


def test_inside_a_cavity_of_opaque_gas_the_surface_sees_a_black_body(view_of, response):
    found = reflected_radiance(view_of(lambda s: uniform(s) + 4000, [3e4] * 4, points=3), response, **KEYS)
    expected = blackbody_radiance(found.wavelength.values, 12000.0)
    for reflection in ("specular", "diffuse"):
        radiance = found.incident_radiance.sel(reflection=reflection)
        np.testing.assert_allclose(radiance, expected, rtol=1e-9)


def test_thin_gas_counts_with_its_length(view_of, response):
    lengths = np.array([0.002, 0.001, 0.003, 0.004])
    found = reflected_radiance(view_of(uniform, lengths), response, **KEYS)
    specular, diffuse = found.incident_signal.values
    # Optical depth below 1e-3, so that absorption takes less than that.
    np.testing.assert_allclose(diffuse / specular, np.sum(WEIGHTS * lengths) / lengths[0], rtol=1e-3)
    np.testing.assert_allclose(found.ray_signal / specular, np.outer(lengths, [1, 1]) / lengths[0], rtol=1e-3)


def test_a_mirror_shows_a_symmetric_path_as_it_is_and_others_reversed(view_of, response):
    """Layer by layer from the far end: the cold layer on the surface comes last and absorbs."""

    def signal(view, reverse):
        ray = view.isel(ray=0)
        order = slice(None, None, -1) if reverse else slice(None)
        distance = ray.ray_distance.values[order]
        density = dict(zip(SPECIES, ray.ray_number_density.values[:, order], strict=True))
        grid = log_grid(RANGE, KEYS["grid_points"])
        path = gas_path(np.abs(distance - distance[0]), ray.ray_temperature.values[order], density)
        return path_radiance(path, line_lists(grid), grid).radiance.sum(axis=0)[::-1]

    dense = {"pressure": 1e5}  # so that absorption tells the two directions apart
    symmetric = view_of(lambda s: 9000 - 3000 * ((s - 0.05) / 0.05) ** 2, [0.1] * 4, **dense)
    mirrored = reflected_radiance(symmetric, response, **KEYS).incident_radiance.sel(reflection="specular")
    np.testing.assert_allclose(mirrored, signal(symmetric, reverse=False), rtol=1e-9)

    lopsided = view_of(lambda s: 6000 + 3000 * s / 0.1, [0.1] * 4, **dense)
    mirrored = reflected_radiance(lopsided, response, **KEYS).incident_radiance.sel(reflection="specular")
    np.testing.assert_allclose(mirrored, signal(lopsided, reverse=True), rtol=FLOAT_RTOL)
    outward = signal(lopsided, reverse=False)
    assert float(np.abs(mirrored - outward).max()) > 0.1 * outward.max()


def test_a_view_without_a_mirrored_ray_is_refused(view_of, response):
    view = view_of(uniform, [0.1] * 4)
    view["ray_weight"] = view.ray_weight + 0.1
    with pytest.raises(ValueError, match="exactly one ray must have weight 0; got 0"):
        reflected_radiance(view, response, **KEYS)
