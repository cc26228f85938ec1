"""A sight line through warm air made for the tests, and the tables of `tests/reference`."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.atoms import atomic_lines

JET_PRESSURE = 5000.0


@pytest.fixture(scope="session")
def atoms():
    return [atomic_lines("N I"), atomic_lines("O I")]


@pytest.fixture(scope="session")
def equilibrium_densities():
    """Function (temperature, pressure) -> mapping species -> density, both arrays or floats."""

    def densities(temperature, pressure=JET_PRESSURE):
        values = number_density(temperature, pressure)
        return {name: values[..., i] for i, name in enumerate(SPECIES)}

    return densities


@pytest.fixture(scope="session")
def jet_sightline(equilibrium_densities):
    """A boundary layer of 5 mm, a jet of 100 mm at 7000 K, a 60 mm tail and cold gas to 300 mm."""
    distance = np.concatenate([np.linspace(0, 0.01, 12), np.linspace(0.015, 0.18, 25), [0.2, 0.25, 0.3]])
    temperature = 350 + 6650 * np.tanh(distance / 0.003) / (1 + np.exp((distance - 0.11) / 0.008))
    density = equilibrium_densities(temperature)
    return xr.Dataset(
        {
            "temperature": ("path_distance", temperature),
            "pressure": ("path_distance", np.full(distance.shape, JET_PRESSURE)),
            "number_density": (("species", "path_distance"), np.array([density[name] for name in SPECIES])),
        },
        coords={"path_distance": distance, "species": np.array(SPECIES, dtype=object)},
    )
