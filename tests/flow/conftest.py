"""One coarse cold start shared by the flow tests, and small meshes and gases with known answers."""

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from skfem import MeshTri

from plasmapyro.flow.stage import cold_start
from plasmapyro.gas.stage import gas_table

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
TORCH = {
    "length": 0.486,
    "radius": 0.080,
    "slot_inner_radius": 0.075,
    "chamber_length": 0.500,
    "chamber_radius": 0.160,
    "probe_distance": 0.385,
    "probe_radius": 0.025,
    "coil_radius": 0.109,
    "coil_positions": (0.127, 0.177, 0.227, 0.277, 0.327, 0.377),
    "probe_shape": "hemisphere",
    "shoulder_radius": 0.0,
}


@pytest.fixture(scope="session")
def torch_lengths():
    """Torch, chamber, probe and coil as `cold_start` takes them."""
    return dict(TORCH)


@pytest.fixture(scope="session")
def air():
    """Equilibrium air on a coarse table around 50 mbar."""
    return gas_table(temperature=np.arange(200.0, 15001.0, 50.0), pressure=np.array([4500.0, 5000.0, 5500.0]))


@pytest.fixture(scope="session")
def start(air):
    """The cheapest honest cold start, 90 kW."""
    return cold_start(
        air,
        numerical_power=90e3,
        chamber_pressure=5e3,
        mass_flow_rate=0.016,
        coil_frequency=4e5,
        wall_temperature=350.0,
        probe_temperature=350.0,
        mesh_factor=2.0,
        start_mesh_factor=2.0,
        error_mesh_ratio=1.15,
        viscosity_limiter=0.02,
        velocity_tolerance=0.5,
        temperature_tolerance=5e-3,
        largest_step_count=60,
        torch=TORCH,
    )


@pytest.fixture(scope="session")
def constant_gas():
    """A gas table whose rows are density 2 kg/m3 at 1 kPa, linear in p, and constants."""
    temperature = np.linspace(200.0, 15000.0, 75)
    pressure = np.array([1e3, 4e3])
    shape = (2, len(temperature))
    rows = {
        "density": np.outer(pressure / 500.0, np.ones(shape[1])),
        "enthalpy": np.broadcast_to(1000.0 * temperature, shape),
        "heat_capacity": np.full(shape, 1000.0),
        "viscosity": np.full(shape, 0.5),
        "thermal_conductivity": np.full(shape, 3.0),
        "electrical_conductivity": np.full(shape, 700.0),
    }
    return xr.Dataset(
        {name: (("pressure", "temperature"), values) for name, values in rows.items()},
        coords={"pressure": pressure, "temperature": temperature},
    )


@pytest.fixture
def pipe(pipe_mesh):
    return pipe_mesh


@pytest.fixture(scope="session")
def pipe_mesh():
    """Function n -> triangles of a pipe, z in [0, 0.3] m, r in [0, 0.1] m, with named boundaries."""

    def mesh(n):
        sides = {
            "axis": lambda x: x[1] < 1e-9,
            "tube_wall": lambda x: x[1] > 0.1 - 1e-9,
            "inlet": lambda x: x[0] < 1e-9,
            "outlet": lambda x: x[0] > 0.3 - 1e-9,
        }
        return MeshTri.init_tensor(np.linspace(0, 0.3, n + 1), np.linspace(0, 0.1, n + 1)).with_boundaries(
            sides
        )

    return mesh
