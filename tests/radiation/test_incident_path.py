"""Light that falls on the surface comes from afar."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.path import incident_path


def test_the_last_layer_lies_at_the_surface():
    density = np.outer(np.arange(1.0, len(SPECIES) + 1), [1e22, 2e22, 4e22])
    ray = xr.Dataset(
        {
            "ray_distance": ("point", [0.0, 0.01, 0.05]),
            "ray_temperature": ("point", [1000.0, 4000.0, 9000.0]),
            "ray_number_density": (("species", "point"), density),
        },
        {"species": list(SPECIES)},
    )
    path = incident_path(ray)
    np.testing.assert_array_equal(path.temperature, [9000.0, 4000.0, 1000.0])
    assert path.thickness.sum() == pytest.approx(0.05)
    assert path.thickness[0] == pytest.approx(0.02) and path.thickness[-1] == pytest.approx(0.005)
