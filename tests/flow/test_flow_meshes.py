"""Meshes that a file hands on: the same as new ones, and used in place of them."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.flow import meshes as module
from plasmapyro.flow.geometry import BOUNDARIES, Torch, build_mesh, flow_mesh
from plasmapyro.flow.levels import level_factors
from plasmapyro.flow.meshes import Meshes, mesh_variables, meshes_of

FACTORS = level_factors(3.0, 1.41)
NAMES = {f"solver_vertex_{name}" for name in "zr"} | {"solver_mesh_factor", "solver_triangle"}


@pytest.fixture
def torch(torch_lengths):
    return Torch(**torch_lengths)


@pytest.fixture
def unmade(monkeypatch):
    """Nothing can be meshed; the list of the factors that were asked for."""
    asked = []

    def refuse(torch, factor):
        asked.append(factor)
        raise AssertionError(f"mesh {factor} is made again")

    return lambda: monkeypatch.setattr(module, "build_mesh", refuse) or asked


def test_the_levels_of_an_error_estimate():
    assert FACTORS == [3.0, 3.0 * 1.41, 3.0 * 1.41**2]
    assert level_factors(1.5, 0.0) == [1.5]


def test_stored_meshes_are_the_ones_that_netgen_makes(torch, unmade, tmp_path):
    file = tmp_path / "meshes.nc"
    xr.Dataset(mesh_variables(Meshes(torch), FACTORS)).to_netcdf(file)
    with xr.open_dataset(file) as opened:
        stored = opened.load()
    assert stored.keys() >= NAMES
    fresh = [build_mesh(torch, factor) for factor in FACTORS]
    unmade()
    known = meshes_of(stored, torch)
    for factor, new in zip(FACTORS, fresh, strict=True):
        old = known(factor)
        for here, there in ((old, new), (flow_mesh(old, torch), flow_mesh(new, torch))):
            assert here.p.tobytes() == there.p.tobytes() and here.t.tobytes() == there.t.tobytes()
            assert here.p.dtype == there.p.dtype and here.t.dtype == there.t.dtype
            for name in set(there.boundaries):
                np.testing.assert_array_equal(here.boundaries[name], there.boundaries[name], err_msg=name)
        for name in ("flow", "box"):
            np.testing.assert_array_equal(old.subdomains[name], new.subdomains[name])
        assert {"axis", *BOUNDARIES} == set(flow_mesh(old, torch).boundaries)


def test_a_mesh_is_made_once(torch, unmade):
    meshes = Meshes(torch)
    first = meshes(4.0)
    asked = unmade()
    assert meshes(4.0) is first and meshes(4.0 * (1 + 1e-12)) is first
    with pytest.raises(AssertionError, match=r"mesh 4\.1 is made again"):
        meshes(4.1)
    assert asked == [4.1]
