"""Between the state of a problem and the dataset of contract 'flow'."""

import json
from dataclasses import asdict, dataclass

import numpy as np
import xarray as xr

from plasmapyro.flow.boundary import inlet_mach_number
from plasmapyro.flow.condition import BESIDE_COLD_GAS, UNITS
from plasmapyro.flow.geometry import BOUNDARIES, Torch
from plasmapyro.flow.meshes import meshes_of
from plasmapyro.flow.physics import AXIAL

SAME_POINT = 1e-9  # [m]: largest distance between stored and rebuilt nodes


@dataclass(frozen=True)
class Setup:
    """What fixes mesh and equations, stored in the file so that another condition can start from it."""

    torch: Torch
    wall_temperature: float
    mesh_factor: float


def to_dataset(problem, setup, condition, result, balance, error=None):
    """Dataset of contract 'flow' for a converged Taylor-Hood solution.

    Nodes are the vertices of the mesh, then the midpoints of its edges. Pressure is linear on each triangle;
    its values at the midpoints are the means of the ends. The last entry of the history belongs to the
    stored state. `error`: nodal error of the temperature [K] and observed order, or None.
    """
    mesh = problem.mesh
    axial, radial, temperature, gauge = problem.physical(result.state)
    gauge = np.concatenate([gauge, gauge[mesh.facets].mean(axis=0)])
    corner, middle = _counter_clockwise(mesh)
    z, r = problem.space.points(AXIAL)
    heating = problem.joule_heating_at_nodes(result.state, result.coupling, result.current)
    topology = {
        "cf_role": "mesh_topology",
        "topology_dimension": 2,
        "node_coordinates": "node_z node_r",
        "face_node_connectivity": "face_node",
    }
    power = result.coupling.power
    scalars = {
        "numerical_power": power,
        "chamber_pressure": problem.properties.pressure,
        "mass_flow_rate": problem.mass_flow_rate,
        "coil_current": result.current,
        "equivalent_resistance": 2 * power / result.current**2,
        "mass_imbalance": balance.mass_imbalance,
        "energy_imbalance": balance.energy_imbalance,
        "radiated_power": balance.radiated_power,
    }
    history = {
        "residual_norm": [step.residual for step in result.steps],
        "velocity_change": [step.velocity_change for step in result.steps],
        "temperature_change": [step.temperature_change for step in result.steps],
        "cfl_number": [step.courant for step in result.steps],
    }
    flows = {
        "boundary_mass_flow": balance.mass_flow,
        "boundary_enthalpy_flow": balance.enthalpy_flow,
        "boundary_heat_flow": balance.heat_flow,
    }
    options = {}
    if condition.swirl_angle:
        options["azimuthal_velocity"] = ("node", problem.azimuthal_velocity(result.state)[0])
    if error is not None:
        options["temperature_error"] = ("node", error[0])
    # Walls as cold as the feed go without saying: ladders compare what the files say.
    stated = {name: getattr(condition, name) for name in UNITS if name not in scalars}
    cold = {name for name in BESIDE_COLD_GAS if stated[name] == setup.wall_temperature}
    stated = {name: value for name, value in stated.items() if name not in cold}
    # An attribute of NaN would not compare equal to itself.
    found = {} if error is None or np.isnan(error[1]) else {"mesh_order": error[1]}
    return xr.Dataset(
        {
            "mesh": ((), np.int32(0), topology),
            "node_z": ("node", z),
            "node_r": ("node", r),
            "face_node": (("face", "corner"), corner.astype(np.int32)),
            "face_midnode": (("face", "corner"), middle.astype(np.int32)),
            "temperature": ("node", temperature),
            "pressure": ("node", problem.properties.pressure + gauge),
            "axial_velocity": ("node", axial),
            "radial_velocity": ("node", radial),
            "joule_heating": ("node", heating),
            **options,
            **{name: ((), float(value)) for name, value in scalars.items()},
            "boundary": ("boundary", np.array(BOUNDARIES, dtype=object)),
            **{
                name: ("boundary", np.array([flow[part] for part in BOUNDARIES]))
                for name, flow in flows.items()
            },
            **{name: ("iteration", np.array(values)) for name, values in history.items()},
        },
        attrs={
            "title": "Axisymmetric LTE plasma torch and jet",
            "torch": json.dumps(asdict(setup.torch), sort_keys=True),
            **stated,
            **({"adiabatic_walls": " ".join(condition.adiabatic_walls)} if condition.adiabatic_walls else {}),
            "wall_temperature": setup.wall_temperature,
            "mesh_factor": setup.mesh_factor,
            "viscosity_limiter": problem.limiter,
            "stagnation_point_z": setup.torch.nose,
            "inlet_mach_number": inlet_mach_number(
                setup.torch, problem.properties, problem.mass_flow_rate, setup.wall_temperature
            ),
            **found,
        },
    )


def setup_of(dataset):
    """The Setup stored in a flow dataset; raise ValueError if it holds none."""
    try:
        lengths = json.loads(dataset.attrs["torch"])
        lengths["coil_positions"] = tuple(lengths["coil_positions"])
        return Setup(
            torch=Torch(**lengths),
            wall_temperature=float(dataset.attrs["wall_temperature"]),
            mesh_factor=float(dataset.attrs["mesh_factor"]),
        )
    except KeyError as missing:
        raise ValueError(f"the start solution lacks the attribute {missing}") from None


def mesh_of(dataset, setup, meshes=None):
    """Mesh of flow domain and box of a dataset; ValueError if its nodes are others than those of the fields.

    `meshes`: those of the torch, where known; else the mesh that the file holds, or a new one.
    """
    mesh = (meshes or meshes_of(dataset, setup.torch))(setup.mesh_factor)
    vertices = mesh.restrict("flow").p
    stored = np.stack([dataset.node_z.values, dataset.node_r.values])[:, : vertices.shape[1]]
    if stored.shape != vertices.shape or np.abs(stored - vertices).max() > SAME_POINT:
        raise ValueError(
            "the start solution stands on another mesh than its attributes give "
            f"({dataset.sizes['node']} nodes); compute it again"
        )
    return mesh


def state_from(dataset, problem):
    """State of `problem` (Taylor-Hood) that `dataset` holds; boundary values are those of `problem`."""
    vertices = problem.mesh.nvertices
    gauge = dataset.pressure.values[:vertices] - float(dataset.chamber_pressure)
    return problem.state_of(
        dataset.axial_velocity.values, dataset.radial_velocity.values, dataset.temperature.values, gauge
    )


def _counter_clockwise(mesh):
    """Corners (F, 3) and middle nodes (F, 3) of the triangles, counter-clockwise in (z, r)."""
    corner, middle = mesh.t.T.copy(), (mesh.nvertices + mesh.t2f).T.copy()
    a, b, c = (mesh.p[:, corner[:, k]] for k in range(3))
    clockwise = (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0])
    # scikit-fem's edges of a triangle are (0, 1), (1, 2), (0, 2); turning it round swaps the first and the
    # last.
    corner[clockwise] = corner[clockwise][:, [0, 2, 1]]
    middle[clockwise] = middle[clockwise][:, [2, 1, 0]]
    return corner, middle
