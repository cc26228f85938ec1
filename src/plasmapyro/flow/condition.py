"""One operating condition of the torch, its distance from another, and the way between them."""

from dataclasses import astuple, dataclass, fields

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
}
MAY_BE_ZERO = ("swirl_angle", "radiation_factor")
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
}


@dataclass(frozen=True)
class Condition:
    """What may change from one solution to the next on one mesh; SI.

    `numerical_power`: Joule power; `probe_temperature`: of the probe wall; `swirl_angle`: between the gas
    that enters and the axis; `radiation_factor`: multiplies the net emission of the gas, 0 for no loss.
    """

    numerical_power: float
    chamber_pressure: float
    mass_flow_rate: float
    coil_frequency: float
    probe_temperature: float
    swirl_angle: float = 0.0
    radiation_factor: float = 0.0

    def __post_init__(self):
        for name, unit in UNITS.items():
            value = getattr(self, name)
            value = (non_negative if name in MAY_BE_ZERO else positive)(name, value, unit)
            object.__setattr__(self, name, float(value))
        within("swirl_angle", self.swirl_angle, 0.0, LARGEST_SWIRL_ANGLE, "rad")

    @classmethod
    def of(cls, dataset):
        """The condition of a flow dataset; ValueError if it does not say."""
        missing = [name for name in UNITS if name not in dataset and name not in dataset.attrs]
        if missing:
            raise ValueError(f"the flow solution lacks {', '.join(missing)}; compute it again")
        return cls(
            **{name: float(dataset[name] if name in dataset else dataset.attrs[name]) for name in UNITS}
        )

    def parts_to(self, other, power_step):
        """Number of parts (a real number) of the way to `other`, the largest over the quantities."""
        parts = [abs(other.numerical_power - self.numerical_power) / power_step]
        for name, step in STEP.items():
            here, there = getattr(self, name), getattr(other, name)
            change = there - here if name in MAY_BE_ZERO else np.log(there / here)
            parts.append(abs(change) / step)
        return float(max(parts))

    def towards(self, other, share):
        """The condition at `share` of the way: in equal ratios, or equal steps for what may be zero."""
        if share >= 1:
            return other
        values = {}
        for field in fields(self):
            here, there = getattr(self, field.name), getattr(other, field.name)
            linear = field.name in MAY_BE_ZERO
            values[field.name] = here + share * (there - here) if linear else here * (there / here) ** share
        return Condition(**values)

    def describe(self):
        """The condition in a few words, in the units of the configuration."""
        power, pressure, flow, frequency, probe, swirl, radiation = astuple(self)
        text = f"{power / 1e3:.4g} kW, {pressure / 100:.4g} mbar, {flow * 1e3:.4g} g/s"
        extra = [f"{frequency / 1e3:.4g} kHz", f"probe {probe:.4g} K"]
        if swirl:
            extra.append(f"swirl {np.degrees(swirl):.3g} deg")
        if radiation:
            extra.append(f"radiation x {radiation:.3g}")
        return f"{text} ({', '.join(extra)})"
