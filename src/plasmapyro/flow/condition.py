"""One operating condition of the torch, its distance from another, and the way between them."""

from dataclasses import MISSING, astuple, dataclass, fields

import numpy as np

from plasmapyro.checks import non_negative, positive, within

UNITS = {
    "numerical_power": "W",
    "chamber_pressure": "Pa",
    "mass_flow_rate": "kg s-1",
    "coil_frequency": "Hz",
    "probe_temperature": "K",
    "swirl_angle": "rad",
    "radiation_factor": "1",
    "mixing": "1",
    "back_wall_temperature": "K",
    "tube_wall_temperature": "K",
    "chamber_wall_temperature": "K",
}
WALLS = ("back_wall", "tube_wall", "chamber_wall", "probe")
BESIDE_COLD_GAS = ("tube_wall_temperature", "chamber_wall_temperature")
MAY_BE_ZERO = ("swirl_angle", "radiation_factor", "mixing")
COLD_WALL = 350.0  # [K]
# On the way to an adiabatic wall, and from one: it is held at WARM [K], reached after `WARMED` of the way,
# before its temperature is free. From 350 K Newton's method overshoots.
WARM, WARMED = 6000.0, 0.8
OWN_TEMPERATURE = {"back_wall_temperature": "back_wall", "probe_temperature": "probe"}
LARGEST_SWIRL_ANGLE = np.radians(80.0)
# Largest change per part of the way: of ln(value) for what is positive by nature, else of the value.
# The power has a second step, given by the caller in watts.
STEP = {
    "numerical_power": 0.25,
    "chamber_pressure": 0.8,
    "mass_flow_rate": 0.4,
    "coil_frequency": 0.4,
    "probe_temperature": 0.7,
    "swirl_angle": np.radians(5.0),
    "radiation_factor": 0.5,
    "mixing": 0.03,
    "back_wall_temperature": 1.0,
    "tube_wall_temperature": 1.0,
    "chamber_wall_temperature": 1.0,
}


@dataclass(frozen=True)
class Condition:
    """What may change from one solution to the next on one mesh; SI.

    `numerical_power`: Joule power; `probe_temperature`: of the probe wall; `swirl_angle`: between the gas
    that enters and the axis; `radiation_factor`: multiplies the net emission of the gas, 0 for no loss;
    `mixing`: mixing length over the torch radius, see `physics`; `back_wall_temperature`,
    `tube_wall_temperature`: of the torch; `chamber_wall_temperature`: around the torch exit;
    `adiabatic_walls`: those of `WALLS` that no heat enters, whatever temperature is given for them.
    """

    numerical_power: float
    chamber_pressure: float
    mass_flow_rate: float
    coil_frequency: float
    probe_temperature: float
    swirl_angle: float = 0.0
    radiation_factor: float = 0.0
    mixing: float = 0.0
    back_wall_temperature: float = COLD_WALL
    tube_wall_temperature: float = COLD_WALL
    chamber_wall_temperature: float = COLD_WALL
    adiabatic_walls: tuple = ()

    def __post_init__(self):
        for name, unit in UNITS.items():
            value = getattr(self, name)
            value = (non_negative if name in MAY_BE_ZERO else positive)(name, value, unit)
            object.__setattr__(self, name, float(value))
        within("swirl_angle", self.swirl_angle, 0.0, LARGEST_SWIRL_ANGLE, "rad")
        unknown = sorted(set(self.adiabatic_walls) - set(WALLS))
        if unknown:
            raise ValueError(f"adiabatic_walls must be of {', '.join(WALLS)}; got {', '.join(unknown)}")
        object.__setattr__(
            self, "adiabatic_walls", tuple(name for name in WALLS if name in self.adiabatic_walls)
        )

    @classmethod
    def of(cls, dataset):
        """The condition of a flow dataset; ValueError if it does not say."""
        known = {name: dataset.attrs.get("wall_temperature", COLD_WALL) for name in BESIDE_COLD_GAS}
        known |= {name: dataset[name] for name in UNITS if name in dataset}
        known |= {name: dataset.attrs[name] for name in UNITS if name in dataset.attrs}
        missing = [one.name for one in fields(cls) if one.default is MISSING and one.name not in known]
        if missing:
            raise ValueError(f"the flow solution lacks {', '.join(missing)}; compute it again")
        adiabatic = tuple(dataset.attrs.get("adiabatic_walls", "").split())
        return cls(**{name: float(value) for name, value in known.items()}, adiabatic_walls=adiabatic)

    @property
    def walls(self):
        """Temperature [K] of each of `WALLS`."""
        return {name: getattr(self, f"{name}_temperature") for name in WALLS}

    def parts_to(self, other, power_step):
        """Number of parts (a real number) of the way to `other`, the largest over the quantities."""
        parts = [abs(other.numerical_power - self.numerical_power) / power_step]
        for name, step in STEP.items():
            here, there = self._ends(other, name)
            change = there - here if name in MAY_BE_ZERO else np.log(there / here)
            parts.append(abs(change) / step)
        if self.adiabatic_walls != other.adiabatic_walls:
            parts = [max(parts) / WARMED]
        return float(max(parts))

    def _ends(self, other, name):
        """Values of a quantity at the ends of the way; temperature of an adiabatic wall: see `WARM`."""
        changed = set(self.adiabatic_walls) ^ set(other.adiabatic_walls)
        warmed = OWN_TEMPERATURE.get(name) in changed
        return (
            WARM if warmed and OWN_TEMPERATURE[name] in one.adiabatic_walls else getattr(one, name)
            for one in (self, other)
        )

    def towards(self, other, share):
        """The condition at `share` of the way: in equal ratios, or equal steps for what may be zero."""
        if share >= 1:
            return other
        values = {}
        if self.adiabatic_walls != other.adiabatic_walls:
            share = min(share / WARMED, 1.0)
        for name in UNITS:
            here, there = self._ends(other, name)
            linear = name in MAY_BE_ZERO
            values[name] = here + share * (there - here) if linear else here * (there / here) ** share
        both = tuple(set(self.adiabatic_walls) & set(other.adiabatic_walls))
        return Condition(**values, adiabatic_walls=both)

    def describe(self):
        """The condition in a few words, in the units of the configuration."""
        power, pressure, flow, frequency, probe, swirl, radiation, mixing, *_, adiabatic = astuple(self)
        text = f"{power / 1e3:.4g} kW, {pressure / 100:.4g} mbar, {flow * 1e3:.4g} g/s"
        extra = [f"{frequency / 1e3:.4g} kHz", f"probe {probe:.4g} K"]
        if swirl:
            extra.append(f"swirl {np.degrees(swirl):.3g} deg")
        if radiation:
            extra.append(f"radiation x {radiation:.3g}")
        if mixing:
            extra.append(f"mixing {mixing:.3g}")
        for name in ("back_wall", "tube_wall", "chamber_wall"):
            if self.walls[name] != COLD_WALL and name not in adiabatic:
                extra.append(f"{name.replace('_', ' ')} {self.walls[name]:.4g} K")
        if adiabatic:
            extra.append(f"adiabatic {', '.join(adiabatic)}".replace("_", " "))
        return f"{text} ({', '.join(extra)})"
