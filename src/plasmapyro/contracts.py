"""What every netCDF file between two stages must contain: names, dims, units, ranges.

`VARIABLES` says once what a name means; `DATASETS` says which names a file holds, on which dims.
A name in `DATASETS` that ends in '?' is optional.
"""

from dataclasses import dataclass
from math import inf

import numpy as np


class ContractError(ValueError):
    """A dataset does not honour its contract; the message lists every breach."""


@dataclass(frozen=True)
class Variable:
    units: str  # "" for text
    long_name: str
    low: float = -inf
    high: float = inf
    nan_allowed: bool = False
    standard_name: str = ""


RADIANCE = "W m-2 sr-1 m-1"

VARIABLES = {
    # coordinates
    "condition": Variable("", "power condition"),
    "species": Variable("", "chemical species"),
    "component": Variable("", "radiating system"),
    "band": Variable("", "pyrometer band"),
    "wavelength": Variable("m", "wavelength in vacuum", 1e-7, 2e-5, standard_name="radiation_wavelength"),
    "wavelength_slit": Variable("m", "wavelength in vacuum, slit-convolved view", 1e-7, 2e-5),
    "time": Variable("s", "time since injection", nan_allowed=False),
    "spectrum_time": Variable("s", "time since injection, middle of each exposure"),
    # gas
    "temperature": Variable("K", "temperature", 100, 3e4),
    "pressure": Variable("Pa", "absolute pressure", 1, 1e7),
    "mole_fraction": Variable("1", "mole fraction", 0, 1 + 1e-9),
    "density": Variable("kg m-3", "density", 0, 1e3),
    "enthalpy": Variable("J kg-1", "specific enthalpy, equilibrium", -1e7, 1e10),
    "heat_capacity": Variable("J kg-1 K-1", "equilibrium specific heat at constant pressure", 0, 1e7),
    "viscosity": Variable("Pa s", "dynamic viscosity", 0, 1),
    "thermal_conductivity": Variable(
        "W m-1 K-1", "total thermal conductivity, reactive part included", 0, 1e3
    ),
    "electrical_conductivity": Variable("S m-1", "electrical conductivity", 0, 1e6),
    # flow
    "mesh": Variable("1", "UGRID topology of the triangles (attributes only)"),
    "node_z": Variable("m", "axial position of the node, 0 at the torch back wall", -100, 100),
    "node_r": Variable("m", "distance of the node from the axis", 0, 100),
    "face_node": Variable("1", "vertices of the triangle, counter-clockwise in (z, r)", 0),
    "face_midnode": Variable("1", "middle node of the edge from corner k to corner k+1 (mod 3)", 0),
    "axial_velocity": Variable("m s-1", "axial velocity", -5e3, 5e3),
    "radial_velocity": Variable("m s-1", "radial velocity, outward", -5e3, 5e3),
    "joule_heating": Variable("W m-3", "Joule heating, mean over a field period", 0, 1e12),
    "numerical_power": Variable("W", "Joule power of the simulated plasma", 0, 1e8),
    "chamber_pressure": Variable("Pa", "static pressure of the chamber", 1, 1e7),
    "mass_flow_rate": Variable("kg s-1", "gas fed through the inlet slot", 0, 10),
    "coil_current": Variable("A", "amplitude of the coil current", 0, 1e6),
    "equivalent_resistance": Variable("ohm", "plasma resistance seen by the coil", 0, 1e3),
    "boundary": Variable("", "part of the boundary"),
    "boundary_mass_flow": Variable("kg s-1", "mass leaving through the boundary", -10, 10),
    "boundary_enthalpy_flow": Variable("W", "enthalpy leaving with the gas, zero at the wall temperature"),
    "boundary_heat_flow": Variable("W", "conducted heat leaving through the boundary"),
    "mass_imbalance": Variable("1", "net mass outflow over gross mass outflow", -1, 1),
    "energy_imbalance": Variable("1", "net energy outflow minus Joule power, over Joule power", -1, 1),
    "residual_norm": Variable("1", "norm of the discrete residual over that of the first step", 0),
    "velocity_change": Variable("m s-1", "largest velocity change of the step", 0),
    "temperature_change": Variable("1", "largest relative temperature change of the step", 0),
    "cfl_number": Variable("1", "Courant number of the pseudo-time step", 0),
    # analysis
    "gas_signal": Variable("W m-2 sr-1", "band signal of the gas along the line of sight", 0, 1e9),
    "sample_emittance": Variable("1", "grey emittance of the surface in the condition", 0, 1),
    "object_temperature": Variable("K", "true surface temperature", 100, 1e4),
    "visibility_level": Variable("1", "level of the visibility factor", 0, 1),
    "visibility_factor": Variable("1", "share of the surface in the band signal", 0, 1),
    "visibility_limit": Variable(
        "K", "surface temperature at which the visibility level is reached", 100, 1e4, nan_allowed=True
    ),
    "apparent_temperature": Variable("K", "temperature read through the gas", 100, 1e4, nan_allowed=True),
    "relative_error": Variable(
        "1", "apparent minus true temperature over the true one", -1, 1e3, nan_allowed=True
    ),
    "reading_status": Variable("1", "-1 below, 0 within, +1 above the modelled ratio curve", -1, 1),
    "emittance": Variable("1", "grey emittance of the surface", 0, 1),
    "error_limit": Variable(
        "K", "surface temperature above which the error stays within the level", 100, 1e4, nan_allowed=True
    ),
    "limit_status": Variable("1", "-1 limit below, 0 within, +1 above the temperatures studied", -1, 1),
    "object_temperature_history": Variable("K", "true surface temperature while heating", 100, 1e4),
    "surface_radiance": Variable(RADIANCE, "radiance of the grey surface", 0, 1e17),
    # sight line
    "path_distance": Variable("m", "distance from the surface along the line of sight", 0, 100),
    "axial_position": Variable("m", "axial position, 0 at the torch back wall", -100, 100),
    "radial_position": Variable("m", "distance from the jet axis", 0, 100),
    "number_density": Variable("m-3", "number density", 0, 1e28),
}

DATASETS = {
    "gas": {
        "pressure": ("pressure",),
        "temperature": ("temperature",),
        "species": ("species",),
        "mole_fraction": ("pressure", "temperature", "species"),
        **{
            name: ("pressure", "temperature")
            for name in (
                "density",
                "enthalpy",
                "heat_capacity",
                "viscosity",
                "thermal_conductivity",
                "electrical_conductivity",
            )
        },
    },
    "flow": {
        "mesh": (),
        "node_z": ("node",),
        "node_r": ("node",),
        "face_node": ("face", "corner"),
        "face_midnode": ("face", "corner"),
        **{
            name: ("node",)
            for name in ("temperature", "pressure", "axial_velocity", "radial_velocity", "joule_heating")
        },
        **{
            name: ()
            for name in (
                "numerical_power",
                "chamber_pressure",
                "mass_flow_rate",
                "coil_current",
                "equivalent_resistance",
                "mass_imbalance",
                "energy_imbalance",
            )
        },
        "boundary": ("boundary",),
        **{
            name: ("boundary",)
            for name in ("boundary_mass_flow", "boundary_enthalpy_flow", "boundary_heat_flow")
        },
        **{
            name: ("iteration",)
            for name in ("residual_norm", "velocity_change", "temperature_change", "cfl_number")
        },
    },
    "gas_signal": {
        "condition": ("condition",),
        "band": ("band",),
        "gas_signal": ("condition", "band"),
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
    },
    "visibility": {
        "condition": ("condition",),
        "band": ("band",),
        "object_temperature": ("object_temperature",),
        "visibility_level": ("visibility_level",),
        "visibility_factor": ("condition", "band", "object_temperature"),
        "visibility_limit": ("visibility_level", "condition", "band"),
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
    },
    "apparent_temperature": {
        "condition": ("condition",),
        "object_temperature": ("object_temperature",),
        "apparent_temperature": ("condition", "object_temperature"),
        "relative_error": ("condition", "object_temperature"),
        "reading_status": ("condition", "object_temperature"),
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
    },
    "error_map": {
        "condition": ("condition",),
        "emittance": ("emittance",),
        "object_temperature": ("object_temperature",),
        "relative_error": ("condition", "emittance", "object_temperature"),
        "error_limit": ("condition", "emittance"),
        "limit_status": ("condition", "emittance"),
        "numerical_power": ("condition",),
    },
    "transient": {
        "condition": ("condition",),
        "time": ("time",),
        "object_temperature_history": ("time",),
        "apparent_temperature": ("condition", "time"),
        "reading_status": ("condition", "time"),
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
    },
    "surface_radiance": {
        "object_temperature": ("object_temperature",),
        "wavelength": ("wavelength",),
        "surface_radiance": ("object_temperature", "wavelength"),
    },
    "sightline": {
        "path_distance": ("path_distance",),
        "species": ("species",),
        "temperature": ("path_distance",),
        "pressure": ("path_distance",),
        "number_density": ("species", "path_distance"),
        "axial_position?": ("path_distance",),
        "radial_position?": ("path_distance",),
    },
}


def _breaches_of(found, name, dims, rule):
    if found.dims != dims:
        yield f"{name}: dims {found.dims}, expected {dims}"
    if rule.units == "":
        if found.dtype.kind not in "OUST":
            yield f"{name}: must be text, is {found.dtype}"
        return
    if found.attrs.get("units") != rule.units:
        yield f"{name}: units {found.attrs.get('units')!r}, expected {rule.units!r}"
    values = np.asarray(found.values)
    if values.dtype.kind not in "fiu":
        yield f"{name}: must be numbers, is {values.dtype}"
        return
    if not rule.nan_allowed and np.isnan(values).any():
        yield f"{name}: NaN not allowed"
    outside = (values < rule.low) | (values > rule.high)
    if outside.any():
        yield f"{name}: {values[outside].flat[0]:g} {rule.units} outside [{rule.low:g}, {rule.high:g}]"


def check(dataset, contract):
    """Raise ContractError naming all breaches of `contract` in `dataset`; return the dataset."""
    breaches = []
    for key, dims in DATASETS[contract].items():
        name = key.rstrip("?")
        if name in dataset.variables:
            breaches += _breaches_of(dataset[name], name, dims, VARIABLES[name])
        elif key == name:
            breaches.append(f"{name}: missing")
    if breaches:
        raise ContractError(f"not a valid '{contract}' dataset:\n  " + "\n  ".join(breaches))
    return dataset


def label(dataset, contract):
    """Return a copy of `dataset` whose variables carry the registered units, long and standard names."""
    dataset = dataset.copy()
    for key in DATASETS[contract]:
        name = key.rstrip("?")
        if name in dataset.variables:
            rule = VARIABLES[name]
            attributes = {"long_name": rule.long_name}
            if rule.units:
                attributes["units"] = rule.units
            if rule.standard_name:
                attributes["standard_name"] = rule.standard_name
            dataset[name].attrs.update(attributes)
    return dataset
