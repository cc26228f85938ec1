"""The sight line of the instruments through a flow field of another program."""

from dataclasses import replace

import numpy as np
import xarray as xr

from plasmapyro import conditions, progress
from plasmapyro.cfd import assemble, composition
from plasmapyro.cfd.mapping import parse
from plasmapyro.checks import increasing, positive, within
from plasmapyro.gas.species import SPECIES
from plasmapyro.quantities import in_si
from plasmapyro.sightline import trace
from plasmapyro.sightline.hemisphere import directions
from plasmapyro.sightline.ray import fine_samples, spread
from plasmapyro.sightline.stage import SURFACE_LENGTH, beyond_the_field, bundle

TEMPERATURE_RANGE = (100.0, 3e4)  # [K]
PRESSURE_RANGE = (1.0, 1e7)  # [Pa]
START_GAP = 1e-3  # [m]
"""ASSUME: a field that begins within 1 mm of the origin begins at it (facets of a curved surface, an axis
that the cells do not reach); the first state holds up to the origin."""
PLAUSIBLE_LENGTH = (0.01, 10.0)  # [m] of a path through a field; beyond, mm was taken for m or the reverse
OTHER_TEMPERATURES = ("rotational_temperature", "vibrational_temperature", "electron_temperature")


def sightline(path, settings, *, points, mesh=None, angle=None):
    """Sight line (contract 'sightline') through the flow field in a file, as far as the field reaches.

    `settings` fit cfd/map_schema.yaml; about `points` nodes along the path, >= 20; `mesh`: of an SU2 restart
    file; `angle` [rad]: from the negative axial direction outward, where the map states no direction.
    Attributes: `entry_distance`, `exit_distance` [m] from the origin, `path_end` ('boundary', 'body' or
    'profile') and `path_status`, a sentence. The path stops at the first hole of the field unless the map
    says that holes are gas. Refusal or ValueError: a file, map or ray that makes no sight line.
    """
    mapping = parse(settings)
    zones = assemble.read_zones(path, mapping, mesh)
    if mapping.geometry in ("profile", "state"):
        arrays, attributes = _from_table(assemble.table(zones, mapping, path), mapping)
    else:
        field = assemble.build(zones, mapping, path)
        arrays, attributes = _along_ray(field, mapping, points, angle)
    result = _dataset(arrays, mapping, attributes)
    length = float(result["path_distance"][-1] - result["path_distance"][0])
    if not PLAUSIBLE_LENGTH[0] <= length <= PLAUSIBLE_LENGTH[1]:
        low, high = PLAUSIBLE_LENGTH
        progress.warn(
            f"{path}: the line of sight is {1e3 * length:.3g} mm long, laboratory plasmas have"
            f" {1e3 * low:g} mm to {high:g} m: is `length_unit` of the map right?"
        )
    return result


def to_instrument(
    inside, *, window_distance, instrument_distance, laboratory_temperature, laboratory_pressure
):
    """A `sightline` continued from the field to the window and on to the instrument.

    From where the path leaves the field to the window: uniform, as there. Beyond: laboratory air. Distances
    [m] from the origin. ValueError: distances out of order, or a body between surface and instrument.

    Source: Fagnani et al., sec. 4.1; as `sightline.stage.line_of_sight`.
    """
    if inside.attrs["path_end"] == "body":
        raise ValueError(
            f"the instrument does not see the surface: the line of sight {inside.attrs['path_status']};"
            " change ray.direction, or state ray.gaps: gas if the hole is gas that the file does not hold"
        )
    leaves = float(inside["path_distance"][-1])
    chamber, beyond = beyond_the_field(leaves, window_distance, instrument_distance)
    last = inside.isel(path_distance=np.full(chamber.size, -1)).assign_coords(path_distance=chamber)
    outside = inside.isel(path_distance=np.full(beyond.size, -1)).assign_coords(path_distance=beyond)
    names, density = composition.equilibrium(
        np.full(beyond.size, float(positive("laboratory_temperature", laboratory_temperature, "K"))),
        np.full(beyond.size, float(positive("laboratory_pressure", laboratory_pressure, "Pa"))),
    )
    for name in ("temperature", "excitation_temperature", *OTHER_TEMPERATURES):
        if name in outside:
            outside[name] = ("path_distance", np.full(beyond.size, float(laboratory_temperature)))
    outside["pressure"] = ("path_distance", np.full(beyond.size, float(laboratory_pressure)))
    air = xr.DataArray(density, {"species": names}, ("species", "path_distance"))
    outside["number_density"] = air.reindex(species=inside["species"], fill_value=0.0)
    for part in (last, outside):
        for name in ("axial_position", "radial_position"):
            if name in part:
                slope = (inside[name].values[-1] - inside[name].values[0]) / (
                    leaves - float(inside["path_distance"][0])
                )
                reached = inside[name].values[-1] + slope * (part["path_distance"].values - leaves)
                part[name] = ("path_distance", reached)
    whole = xr.concat([inside, last, outside], "path_distance", data_vars="minimal", join="exact")
    whole.attrs = {**inside.attrs, "window_distance": float(window_distance)}
    return whole


def condition_of(line, settings, *, angle_deg=None, **state):
    """Attributes that say which condition the gas of a sight line belongs to (`conditions.stated`).

    `settings`: the map of the file; `angle_deg` where that does not state the ray; `state`: power, pressure
    and mass flow rate by their keys of the configuration, None if not known.
    """
    names = {str(name) for name in line["species"].values}
    return conditions.stated(
        gas="air" if names <= set(SPECIES) else " ".join(sorted(names)),
        settings={"cfd": settings, "angle": angle_deg},
        **in_si({name: value for name, value in state.items() if value is not None}),
    )


def surface_view(path, settings, *, mesh=None, mirror_angle, directions_count, core_angle, points):
    """Rays that light the stagnation point ('surface_view'), through an axisymmetric field in a file.

    Arguments as of `sightline`, whose origin is the stagnation point on the axis, and of
    `sightline.stage.surface_view`. Refusal or ValueError as `sightline`; also another geometry, an origin off
    the axis, or a ray that meets a body.
    """
    mapping = parse(settings)
    origin = mapping.ray.get("origin", [])
    if mapping.geometry != "axisymmetric" or any(origin[1:]):
        raise ValueError(
            "the light on the surface needs a stagnation point on the axis of an axisymmetric field"
            f"; geometry is {mapping.geometry}, ray.origin {origin}"
        )
    field = assemble.build(assemble.read_zones(path, mapping, mesh), mapping, path)
    free = replace(mapping, ray={"origin": origin})
    angles, weights = directions(directions_count, core_angle)
    angles, weights = np.append(float(mirror_angle), angles), np.append(0.0, weights)
    lines = []
    for angle in angles:
        arrays, attributes = _along_ray(field, free, points, angle)
        lines.append(_dataset(arrays, free, attributes))
        if attributes["path_end"] == "body":
            raise ValueError(f"the ray at {np.degrees(angle):.4g} deg {attributes['path_status']}")
    names = list(lines[0]["species"].values)
    if names != list(SPECIES):
        raise ValueError(
            f"the light on the surface is computed for the species of air; got {', '.join(names)}"
        )

    return bundle(angles, weights, lines, "Gas that lights the stagnation point of a given flow field")


def _along_ray(field, mapping, points, angle):
    """Named arrays along the ray of the map, and attributes."""
    if points < 20:
        raise ValueError(f"points must be >= 20; got {points}")
    ray = _ray(mapping, angle)
    reach = 2 * float(np.linalg.norm(np.ptp(field.points, axis=0)) * 2 + _off(field, ray))
    found = trace.crossings(field, ray, reach)
    if not len(found.simplex):
        low, high = field.points.min(axis=0), field.points.max(axis=0)
        extent = " to ".join(str(tuple(round(float(x), 6) for x in corner)) for corner in (low, high))
        raise ValueError(
            f"the line of sight from {tuple(float(x) for x in ray.origin)} m in direction"
            f" {tuple(round(float(x), 6) for x in ray.direction)} misses the flow field, which reaches from"
            f" {extent} m; check ray and length_unit"
        )
    parts = trace.stretches(found)
    first = parts[0, 0]
    attributes = {"entry_distance": float(first) + 0.0, "path_end": "boundary"}
    bridged = mapping.ray.get("gaps", "body") == "gas"
    if len(parts) > 1 and not bridged:
        gap = parts[1, 0] - parts[0, 1]
        attributes["path_end"] = "body"
        attributes["path_status"] = (
            f"stops at a body {1e3 * parts[0, 1]:.4g} mm from its origin; the field goes on"
            f" {1e3 * gap:.4g} mm behind"
        )
        parts = parts[:1]
    leaves = float(parts[-1, 1])
    attributes["exit_distance"] = leaves
    attributes.setdefault("path_status", f"leaves the field {1e3 * leaves:.4g} mm from its origin")
    start = 0.0 if first <= START_GAP else first
    if start > 0:
        attributes["path_status"] = (
            f"begins {1e3 * start:.4g} mm from its origin, where the field does, and "
            + attributes["path_status"]
        )
    fine = fine_samples(start, leaves, SURFACE_LENGTH)
    fine_temperature = trace.values_along(field, ray, found, fine, ["temperature"])["temperature"]
    _require_finite("temperature", fine_temperature, fine, ray)
    positive("temperature along the line of sight", fine_temperature, "K")
    nodes = spread(fine, fine_temperature, points=points, surface_length=SURFACE_LENGTH)
    if len(parts) > 1:
        inside = [(nodes >= low) & (nodes <= high) for low, high in parts]
        nodes = np.unique(np.concatenate([nodes[np.any(inside, axis=0)], parts.ravel()[1:-1], [start]]))
    arrays = trace.values_along(field, ray, found, nodes, list(field.values))
    for name, values in arrays.items():
        _require_finite(name, values, nodes, ray)
    arrays["path_distance"] = nodes
    if ray.axisymmetric:
        arrays["axial_position"], arrays["radial_position"] = ray.at(nodes).T
    return arrays, attributes


def _ray(mapping, angle):
    origin = np.zeros(3)
    given = np.array(mapping.ray["origin"], dtype=float) * mapping.length
    origin[: given.size] = given
    direction = np.zeros(3)
    if "direction" in mapping.ray:
        direction[: given.size] = mapping.ray["direction"]
    else:
        stated = mapping.ray.get("angle_deg")
        turned = angle if stated is None else np.radians(stated)
        if turned is None:
            raise ValueError("ray.direction or ray.angle_deg is missing: where the line of sight points to")
        direction[:2] = -np.cos(turned), np.sin(turned)
    return trace.Ray(origin, direction / np.linalg.norm(direction), mapping.geometry == "axisymmetric")


def _off(field, ray):
    """Distance of the origin from the middle of the field [m]."""
    middle = (field.points.max(axis=0) + field.points.min(axis=0)) / 2
    return np.linalg.norm(ray.at(np.array([0.0]))[0, : len(middle)] - middle)


def _require_finite(name, values, distance, ray):
    if not np.isfinite(values).all():
        k = int(np.argmax(~np.isfinite(values)))
        place = ", ".join(f"{x:.4g}" for x in ray.at(distance[k : k + 1])[0])
        raise ValueError(
            f"{name} is not a number (NaN or infinite) in the file near ({place}) m,"
            f" {1e3 * distance[k]:.4g} mm along the line of sight; export a converged solution"
        )


def _from_table(columns, mapping):
    """Named arrays of a profile or of one state, and attributes."""
    if mapping.geometry == "profile":
        order = np.argsort(columns["distance"], kind="stable")
        arrays = {name: values[order] for name, values in columns.items()}
        arrays["path_distance"] = increasing("distance", arrays.pop("distance"), "m")
        if len(order) < 2:
            raise ValueError(f"a profile needs 2 rows or more; got {len(order)}")
        if arrays["path_distance"][0] < 0:
            raise ValueError(f"distance must be >= 0 m; got {arrays['path_distance'][0]:g} m")
    else:
        arrays = _uniform(columns, mapping)
    for name, values in arrays.items():
        if not np.isfinite(values).all():
            raise ValueError(f"{name} is not a number in row {int(np.argmax(~np.isfinite(values))) + 1}")
    leaves = float(arrays["path_distance"][-1])
    status = f"ends with the {mapping.geometry} at {1e3 * leaves:.4g} mm"
    return arrays, {
        "entry_distance": float(arrays["path_distance"][0]),
        "exit_distance": leaves,
        "path_end": "profile",
        "path_status": status,
    }


def _uniform(columns, mapping):
    """One state over the path, behind a boundary layer.

    ASSUME: through the boundary layer the temperatures rise linearly from the wall's; the composition there
    must be in equilibrium, because one state says nothing of it.
    """
    if mapping.quantity != "equilibrium":
        raise ValueError("species must be equilibrium for geometry state: its boundary layer has another gas")
    row = mapping.state.get("row", 1) - 1
    count = len(columns["temperature"])
    if row >= count:
        raise ValueError(f"state.row is {row + 1}; the file holds {count} rows")
    layer = mapping.state["boundary_layer"] * mapping.length
    distance = np.concatenate([np.linspace(0, layer, 41), [mapping.state["path_length"] * mapping.length]])
    share = np.minimum(distance / layer, 1.0)
    wall = float(mapping.state["wall_temperature_k"])
    arrays = {"path_distance": distance}
    for name, values in columns.items():
        edge = values[row]
        arrays[name] = wall + share * (edge - wall) if "temperature" in name else np.full(share.size, edge)
    return arrays


def _dataset(arrays, mapping, attributes):
    """Dataset of contract 'sightline'."""
    temperature = within("temperature", arrays["temperature"], *TEMPERATURE_RANGE, "K")
    pressure = within("pressure", arrays["pressure"], *PRESSURE_RANGE, "Pa")
    excited = arrays.get(mapping.excitation) if mapping.excitation else None
    if mapping.quantity == "equilibrium":
        if excited is not None:
            raise ValueError(
                "species: equilibrium needs one temperature; the map names"
                f" {mapping.excitation} besides: give the species of the file"
            )
        names, density = composition.equilibrium(temperature, pressure)
    else:
        names, density = composition.from_shares(
            mapping.quantity,
            {name: arrays[f"species {name}"] for name in mapping.species},
            temperature=temperature,
            electron_temperature=arrays.get("electron_temperature", excited),
            pressure=pressure,
            density=arrays.get("density"),
            missing_share=mapping.missing_share,
        )
    variables = {"temperature": temperature, "pressure": pressure}
    if excited is not None:
        variables["excitation_temperature"] = within(mapping.excitation, excited, *TEMPERATURE_RANGE, "K")
    for name in OTHER_TEMPERATURES:
        if name in arrays:
            variables[name] = within(name, arrays[name], *TEMPERATURE_RANGE, "K")
    for name in ("axial_position", "radial_position"):
        if name in arrays:
            variables[name] = arrays[name]
    return xr.Dataset(
        {
            **{name: ("path_distance", values) for name, values in variables.items()},
            "number_density": (("species", "path_distance"), density),
        },
        {"path_distance": arrays["path_distance"], "species": names},
        attrs={"origin": "modelled", "title": "Line of sight through a given flow field", **attributes},
    )
