"""The state of the gas along the line of sight of the instruments."""

import numpy as np
import xarray as xr

from plasmapyro import conditions
from plasmapyro.checks import increasing, positive
from plasmapyro.gas.argon import densities, species_of
from plasmapyro.gas.species import AIR, argon_of, gas_name, nitrogen_of
from plasmapyro.sightline import ray, trace
from plasmapyro.sightline.hemisphere import directions

SURFACE_LENGTH = 2e-4  # [m], about the smallest cell on the probe
NEAR = 1e-4  # [m] of a path that finds the cell of a single point
OUTER_POINTS = 4  # nodes of each uniform stretch outside the flow field
WINDOW_THICKNESS = 1e-6  # [m]
"""ASSUME: the state jumps at the window; path_distance must increase, so the jump takes 1 um."""


def line_of_sight(
    flow, *, angle, points, window_distance, instrument_distance, laboratory_temperature, laboratory_pressure
):
    """State of the gas from the probe surface to the instrument.

    Inside the flow field: the field. From where the path leaves it to the window: uniform, as at the
    exit. From the window to the instrument: laboratory air. Composition in LTE everywhere: of the
    gas that the flow names up to the window, of air beyond it.

    Source: Fagnani et al., sec. 4.1 and fig. 5.

    ValueError: distances out of order, a path that ends at a wall before the outer radius, a state outside
    200 to 20000 K, or `face_node` or `face_midnode` that do not hold indices of nodes.

    Parameters
    ----------
    flow : Dataset
        Contract 'flow'; its attribute `stagnation_point_z` [m] is where the path starts.
    angle : float [rad]
        Between the path and the axis.
    points : int
        Nodes inside the flow field.
    window_distance, instrument_distance : float [m]
        Ends of the chamber and of the path, along the path.
    laboratory_temperature, laboratory_pressure : float [K], [Pa]
        Beyond the window.

    Returns
    -------
    Dataset
        Contract 'sightline'; attributes `angle` [deg], `exit_distance` and `window_distance` [m], and those
        of the condition (`conditions.stated`). The `temperature_error` of the field, if it holds one, is
        carried along.
    """
    laboratory_temperature = float(positive("laboratory_temperature", laboratory_temperature, "K"))
    laboratory_pressure = float(positive("laboratory_pressure", laboratory_pressure, "Pa"))
    inside = _inside(flow, angle, points)
    leaves = float(inside["path_distance"][-1])
    outer_radius = float(flow["node_r"].max())
    if inside["radial_position"][-1] < outer_radius * (1 - 1e-6):
        raise ValueError(
            f"angle must let the path leave the field at its outer radius; at {np.degrees(angle):g} deg"
            f" it ends at z = {inside['axial_position'][-1]:.4g} m, r = {inside['radial_position'][-1]:.4g} m"
        )
    chamber, laboratory = beyond_the_field(leaves, window_distance, instrument_distance)
    beyond = np.concatenate([chamber, laboratory])
    z, r = ray.towards(float(flow.attrs["stagnation_point_z"]), angle).at(beyond).T
    outside = {
        "path_distance": beyond,
        "axial_position": z,
        "radial_position": r,
        "temperature": _two(inside["temperature"][-1], chamber, laboratory_temperature, laboratory),
        "pressure": _two(inside["pressure"][-1], chamber, laboratory_pressure, laboratory),
        "temperature_error": np.zeros(beyond.size),
    }
    whole = {name: np.concatenate([inside[name], outside[name]]) for name in inside}
    return _dataset(
        whole,
        nitrogen_of(flow),
        laboratory.size,
        argon=argon_of(flow),
        angle=float(np.degrees(angle)),
        exit_distance=leaves,
        window_distance=float(window_distance),
        **_condition(flow, angle),
    )


def _condition(flow, angle):
    """Attributes of the condition that a flow was computed for; none of a field that does not say."""
    if "numerical_power" not in flow:
        return {}
    settings = {name: flow.attrs[name] for name in conditions.OF_FLOW if name in flow.attrs}
    return conditions.stated(
        gas=gas_name(nitrogen_of(flow), argon_of(flow)),
        settings={**settings, "angle": float(np.degrees(angle))},
        **{name: float(flow[name]) for name in (conditions.POWER, *conditions.STATE)},
    )


def beyond_the_field(exit_distance, window_distance, instrument_distance):
    """Path distances [m] of the nodes between field and window, and between window and instrument."""
    if not exit_distance < window_distance < instrument_distance - WINDOW_THICKNESS:
        raise ValueError(
            f"distances must satisfy exit < window < instrument; got {exit_distance:.4g},"
            f" {window_distance:g}, {instrument_distance:g} m"
        )
    chamber = np.linspace(exit_distance, window_distance, OUTER_POINTS)[1:]
    return chamber, np.linspace(window_distance + WINDOW_THICKNESS, instrument_distance, OUTER_POINTS)


def chord(flow, *, angle, points):
    """State of the gas (contract 'sightline') from the stagnation point to the boundary of the flow field.

    At any `angle` to the axis, 0 to pi/2 [rad], on `points` nodes; attributes `angle` [deg] and
    `exit_distance` [m]. ValueError as `line_of_sight`.
    """
    inside = _inside(flow, angle, points)
    exit_distance = float(inside["path_distance"][-1])
    return _dataset(
        inside,
        nitrogen_of(flow),
        argon=argon_of(flow),
        angle=float(np.degrees(angle)),
        exit_distance=exit_distance,
    )


def equilibrium_sightline(path_distance, temperature, pressure):
    """Sight line through given temperatures [K] and pressures [Pa], in equilibrium at every point.

    Of points (S,) [m] that rise towards the observer, or one value for all of them. ValueError: path that
    does not increase, or a state outside 200 to 20000 K.
    """
    distance = increasing("path_distance", path_distance, "m")
    temperature = np.broadcast_to(positive("temperature", temperature, "K"), distance.shape)
    pressure = np.broadcast_to(positive("pressure", pressure, "Pa"), distance.shape)
    return _dataset(
        {"path_distance": distance, "temperature": temperature.copy(), "pressure": pressure.copy()}
    )


def surface_view(flow, *, mirror_angle, directions_count, core_angle, points):
    """State of the gas (contract 'surface_view') along the rays that light the stagnation point.

    The first ray is the one a mirror would send into the instrument: specular reflection turns the line of
    sight, at `mirror_angle` [rad] to the axis, by 180 degrees about the normal, which in an axisymmetric
    field is the same path; its `ray_weight` is 0. The others are the directions of the hemispherical mean
    (`hemisphere.directions`), whose weights sum to 1. Each has `points` nodes and ends at the boundary of the
    flow field. ValueError as `chord` and `hemisphere.directions`.
    """
    angles, weights = directions(directions_count, core_angle)
    angles, weights = np.append(float(mirror_angle), angles), np.append(0.0, weights)
    paths = [chord(flow, angle=angle, points=points) for angle in angles]
    return bundle(angles, weights, paths, "Gas that lights the stagnation point")


def bundle(angles, weights, paths, title):
    """Rays (R,) to the stagnation point as one Dataset, contract 'surface_view'.

    `angles` [rad]; `weights` [1]; `paths`: of contract 'sightline' and the same species.
    """

    def stacked(name):
        return np.array([path[name].values for path in paths])

    return xr.Dataset(
        {
            "ray_angle": ("ray", angles),
            "ray_weight": ("ray", weights),
            "ray_distance": (("ray", "node"), stacked("path_distance")),
            "ray_temperature": (("ray", "node"), stacked("temperature")),
            "ray_pressure": (("ray", "node"), stacked("pressure")),
            "ray_number_density": (("ray", "species", "node"), stacked("number_density")),
        },
        {"species": paths[0].species.values},
        attrs={"origin": "modelled", "title": title},
    )


def _inside(flow, angle, points):
    """Named arrays along the part of the path that lies in the flow field."""
    try:
        nose = float(flow.attrs["stagnation_point_z"])
    except KeyError:
        raise ValueError("flow lacks the attribute stagnation_point_z [m], where the path starts") from None
    names = ["temperature", "pressure", *(["temperature_error"] if "temperature_error" in flow else [])]
    field, path = _field_of(flow, names), ray.towards(nose, angle)
    found = trace.crossings(field, path, 2 * float(np.linalg.norm(np.ptp(field.points, axis=0))))
    if not found.simplex.size:
        raise ValueError(
            f"the path at {np.degrees(angle):g} deg from z = {nose:g} m meets no boundary of the mesh"
        )
    end = float(trace.stretches(found)[0, 1])

    def along(distance, wanted):
        return trace.values_along(field, path, found, distance, wanted)

    fine = ray.fine_samples(0.0, end, SURFACE_LENGTH)
    kelvin = along(fine, ["temperature"])["temperature"]
    nodes = ray.spread(fine, kelvin, points=points, surface_length=SURFACE_LENGTH)
    z, r = path.at(nodes).T
    known = along(nodes, names)
    if "temperature_error" in known:
        # Between the nodes the quadratic can dip below zero where the error falls steeply.
        known["temperature_error"] = np.maximum(known["temperature_error"], 0.0)
    return {"path_distance": nodes, "axial_position": z, "radial_position": r, **known}


def on_line(flow, z, r, names):
    """Quantities (P,) of a computed flow, by their names, at points on one straight line through its plane.

    `z`, `r` (P,) [m]: the outermost points are the first and the last. ValueError: a line outside the flow
    field.
    """
    z, r = np.atleast_1d(z), np.atleast_1d(r)
    field, distance = _field_of(flow, names), np.hypot(z - z[0], r - r[0])
    step = np.array([z[-1] - z[0], r[-1] - r[0]]) / distance[-1] if distance[-1] else (-1.0, 0.0)
    path = trace.Ray(np.array([z[0], r[0], 0.0]), np.array([*step, 0.0]), True)
    found = trace.crossings(field, path, max(distance[-1], NEAR))
    if not found.simplex.size:
        raise ValueError(f"the line from z = {z[0]:.6g} m, r = {r[0]:.6g} m misses the flow field")
    return trace.values_along(field, path, found, distance, list(names))


def _field_of(flow, names):
    """Some quantities of a computed flow as a `trace.Field` over (axial, radial)."""
    points = np.stack([flow["node_z"].values, flow["node_r"].values], axis=1)
    values = {name: flow[name].values for name in names}
    return trace.Field(points, _indices(flow, "face_node"), _indices(flow, "face_midnode"), values)


def _indices(flow, name):
    """Indices of nodes (face, 3), refused unless each is that of a node."""
    values, last = flow[name].values, flow.sizes["node"] - 1
    if values.dtype.kind not in "iu":
        raise ValueError(f"{name} must hold integers; got {values.dtype}, {values.flat[0]:g} first")
    wrong = np.argwhere((values < 0) | (values > last))
    if wrong.size:
        face, corner = wrong[0]
        raise ValueError(
            f"{name} must lie in [0, {last}] (indices of nodes); got {values[face, corner]}"
            f" at face {face}, corner {corner}"
        )
    return values


def _two(first, first_nodes, second, second_nodes):
    """Two uniform stretches, one after the other."""
    return np.concatenate([np.full(first_nodes.size, first), np.full(second_nodes.size, second)])


def _dataset(arrays, nitrogen=AIR["N2"], laboratory=0, argon=0.0, **attributes):
    """Dataset of contract 'sightline' with the LTE composition; its last `laboratory` nodes are in air."""
    density = densities(arrays["temperature"], arrays["pressure"], nitrogen, argon)
    if laboratory:
        room = slice(-laboratory, None)
        density[room] = densities(arrays["temperature"][room], arrays["pressure"][room], argon=argon)
    variables = {
        name: ("path_distance", values) for name, values in arrays.items() if name != "path_distance"
    }
    variables["number_density"] = (("species", "path_distance"), density.T)
    return xr.Dataset(
        variables,
        {"path_distance": arrays["path_distance"], "species": list(species_of(argon))},
        attrs={"origin": "modelled", **attributes},
    )
