"""What the names and units of a foreign file mean."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from plasmapyro.cfd import map_of
from plasmapyro.configuration import ConfigurationError, check
from plasmapyro.constants import AVOGADRO
from plasmapyro.gas.species import SPECIES, TRACES
from plasmapyro.readers.units import TO_SI, normalised, offset

SCHEMA = Path(__file__).with_name("map_schema.yaml")
LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254}
DENSITY = {"kg m-3": 1.0, "kg/m3": 1.0, "g m-3": 1e-3, "g/m3": 1e-3, "g cm-3": 1e3, "g/cm3": 1e3}
TEMPERATURES = ("temperature", "rotational_temperature", "vibrational_temperature", "electron_temperature")
UNITS = {  # kind of quantity -> {unit: factor}
    **dict.fromkeys(TEMPERATURES, {"K": 1.0, "kK": 1e3, "degC": 1.0, "C": 1.0}),
    "pressure": TO_SI["Pa"] | {"MPa": 1e6, "atm": 101325.0},
    "density": DENSITY,
    "number_density": {"m-3": 1.0, "1/m3": 1.0, "cm-3": 1e6, "1/cm3": 1e6},
    "molar_density": {
        "mol m-3": AVOGADRO,
        "mol/m3": AVOGADRO,
        "kmol/m3": 1e3 * AVOGADRO,
        "mol/cm3": 1e6 * AVOGADRO,
    },
    "partial_density": DENSITY,
    "mole_fraction": {"1": 1.0, "%": 1e-2},
    "mass_fraction": {"1": 1.0, "%": 1e-2},
}
GRID_COORDINATES = {
    "axisymmetric": ("axial", "radial"),
    "planar": ("x", "y"),
    "three_dimensional": ("x", "y", "z"),
    "profile": ("distance",),
    "state": (),
}
USUAL_NAMES = {"axial": "x", "radial": "y", "x": "x", "y": "y", "z": "z"}
LARGEST_MISSING_SHARE = 0.01


@dataclass(frozen=True)
class Source:
    """A quantity of the file: its name, or None for one `value` everywhere; SI = factor v + shift."""

    name: str | None
    value: float | None
    factor: float
    shift: float

    def si(self, values):
        return self.factor * values + self.shift


@dataclass(frozen=True)
class Mapping:
    """Checked form of a map; see map_schema.yaml for what its parts mean. Lengths in m."""

    format: str | None
    geometry: str
    length: float
    coordinates: tuple
    mirror: dict
    zones: tuple
    largest_cell: float | None
    variables: dict
    excitation: str | None
    species: dict
    quantity: str
    missing_share: float
    ray: dict
    state: dict


def check_conditions(conditions):
    """Names of the conditions that bring their own flow field, whose maps are checked.

    ConfigurationError: the first map that is wrong; the message names the condition and lists all of its
    faults.
    """
    own = [name for name, condition in conditions.items() if "cfd" in condition]
    for name in own:
        source = f"cfd of condition {name}"
        try:
            parse(check(map_of(conditions[name]), SCHEMA, source))
        except ConfigurationError:
            raise
        except ValueError as fault:
            raise ConfigurationError(f"{source}: {fault}") from None
    return own


def parse(values):
    """The `Mapping` of values that fit map_schema.yaml, checked for what that cannot say, in SI.

    ValueError, all faults at once: unknown units, keys that do not go together, a ray that is none.
    """
    faults = []
    variables = {
        name: _source(f"variables.{name}", name, part, faults) for name, part in values["variables"].items()
    }
    species, quantity, share = {}, "equilibrium", 0.0
    if values["species"] != "equilibrium":
        part = values["species"]
        quantity, share = part["quantity"], part.get("missing_share", LARGEST_MISSING_SHARE)
        for name in (*SPECIES, *TRACES):
            if name in part["names"]:
                entry = {"name": part["names"][name], "unit": part["unit"]}
                species[name] = _source("species", quantity, entry, faults)
        if quantity == "mass_fraction" and share > LARGEST_MISSING_SHARE and "density" not in variables:
            faults.append("species.missing_share needs variables.density when mass fractions are given")
    geometry, length = values["geometry"], LENGTH[values["length_unit"]]
    coordinates = _coordinates(geometry, values.get("coordinates", {}), faults)
    if "mirror" in values and geometry not in ("planar", "three_dimensional"):
        faults.append(f"mirror is for planar and three_dimensional fields; geometry is {geometry}")
    if "mirror" in values and geometry == "planar" and "z" in values["mirror"]:
        faults.append("mirror.z: a planar field has no z")
    if ("state" in values) != (geometry == "state"):
        faults.append("state and geometry: state belong together")
    if geometry == "state" and values.get("state", {}).get("path_length", np.inf) <= values.get(
        "state", {}
    ).get("boundary_layer", 0):
        faults.append("state.boundary_layer must be less than state.path_length")
    ray = values.get("ray", {})
    _check_ray(geometry, ray, faults)
    two = {"vibrational_temperature", "electron_temperature"}
    excitation = values.get("excitation")
    if excitation and excitation not in variables:
        faults.append(f"excitation: variables.{excitation} is missing")
    if two <= set(variables) and not excitation:
        faults.append(
            "excitation is missing: state whether vibrational_temperature or electron_temperature excites"
        )
    if faults:
        raise ValueError("\n  ".join(["the map does not fit together:", *faults]))
    return Mapping(
        format=values.get("format"),
        geometry=geometry,
        length=length,
        coordinates=coordinates,
        mirror={name: place * length for name, place in values.get("mirror", {}).items()},
        zones=tuple(values.get("zones", ())),
        largest_cell=values["largest_cell"] * length if "largest_cell" in values else None,
        variables=variables,
        excitation=excitation or next((name for name in sorted(two) if name in variables), None),
        species=species,
        quantity=quantity,
        missing_share=share,
        ray=ray,
        state=values.get("state", {}),
    )


def _source(where, kind, part, faults):
    if ("name" in part) == ("value" in part):
        faults.append(f"{where}: give name or value, one of them")
        return None
    known = {normalised(unit): scale for unit, scale in UNITS[kind].items()}
    unit = normalised(part["unit"])
    if unit not in known:
        faults.append(f"{where}: unknown unit '{part['unit']}' of a {kind}; known: {', '.join(UNITS[kind])}")
        return None
    factor = known[unit]
    shift = factor * part.get("add", 0.0) + offset(unit)
    return Source(part.get("name"), part.get("value"), factor, shift)


def _coordinates(geometry, given, faults):
    """Names of the coordinates in the file, in the order of the mesh."""
    wanted = GRID_COORDINATES[geometry]
    unused = sorted(set(given) - set(wanted))
    if unused:
        known = ", ".join(wanted) or "none"
        faults.append(f"coordinates.{unused[0]}: a {geometry} field has {known}")
    if geometry == "profile" and "distance" not in given:
        faults.append("coordinates.distance is missing: the column with the distance from the surface")
        return ()
    return tuple(given.get(name, USUAL_NAMES.get(name)) for name in wanted)


def _check_ray(geometry, ray, faults):
    if geometry in ("profile", "state"):
        if ray:
            faults.append(f"ray: a {geometry} is its own path; leave it out")
        return
    if "origin" not in ray:
        faults.append("ray.origin is missing: where the line of sight starts")
        return
    count = len(ray["origin"])
    allowed = {"axisymmetric": (2, 3), "planar": (2,), "three_dimensional": (3,)}[geometry]
    if count not in allowed:
        faults.append(f"ray.origin must hold {' or '.join(map(str, allowed))} coordinates; got {count}")
    if "direction" in ray and "angle_deg" in ray:
        faults.append("ray: give direction or angle_deg, not both")
    if "direction" in ray and (len(ray["direction"]) != count or not np.any(ray["direction"])):
        faults.append(f"ray.direction must hold {count} coordinates, not all 0; got {ray['direction']}")
    if geometry == "three_dimensional" and "direction" not in ray:
        faults.append("ray.direction is missing: a three_dimensional field needs it, an angle is not enough")
