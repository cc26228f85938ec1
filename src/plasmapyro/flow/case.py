"""The gas tables of a run, what stays the same during it, and the discrete problem of a condition."""

from dataclasses import dataclass

import xarray as xr

from plasmapyro.flow.dataset import Setup
from plasmapyro.flow.meshes import Meshes
from plasmapyro.flow.problem import Problem
from plasmapyro.flow.properties import gas_properties


@dataclass(frozen=True)
class Air:
    """The gas tables of all conditions: contract 'gas', contract 'net_emission' or None, wall temperature."""

    gas: xr.Dataset
    emission: xr.Dataset | None
    wall_temperature: float

    def properties(self, condition):
        """GasProperties at a condition."""
        return gas_properties(
            self.gas,
            condition.chamber_pressure,
            self.wall_temperature,
            self.emission,
            condition.radiation_factor,
        )


@dataclass(frozen=True)
class Case:
    """What stays the same on the way to a condition.

    `power_step` [W]: see `Condition.parts_to`; `mesh_ratio` [1]: of the cell sizes of successive meshes of
    the error estimate, 0 for none; `label` names the run in log records and errors.
    """

    setup: Setup
    meshes: Meshes
    air: Air
    power_step: float
    mesh_ratio: float
    label: str

    def on_level(self, level):
        """Label of a run on a coarser mesh."""
        return f"{self.label}, mesh {self.mesh_ratio**level:.3g} times as coarse"


def problem_of(mesh, setup, air, condition, order, limiter=0.0):
    """The Problem of a Condition on a mesh from `geometry.build_mesh`, torch and walls as in `setup`."""
    properties, walls = air.properties(condition), {"wall_temperature": setup.wall_temperature}
    return Problem(
        mesh, setup.torch, properties, order=order, limiter=limiter, **walls, **_besides_gas(condition)
    )


def moved(problem, air, condition):
    """The same problem at another Condition."""
    return problem.at(air.properties(condition), **_besides_gas(condition))


def _besides_gas(condition):
    """What a Problem takes of a Condition besides the properties of the gas and the power."""
    names = ("mass_flow_rate", "swirl_angle", "mixing", "walls", "adiabatic_walls")
    return {
        "frequency": condition.coil_frequency,
        **{name: getattr(condition, name) for name in names},
    }
