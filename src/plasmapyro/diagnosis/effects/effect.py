"""What an effect is, and how it is declared: by a decorator at its formula, and a row of `effects.csv`.

Its source "Zhang, Tsai & Machin" is their book Radiometric Temperature Measurements (2010), "Launder &
Spalding" Mathematical Models of Turbulence (1972), with mixing lengths of 0.07 to 0.16 of the width of free
flows.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from types import MappingProxyType

import numpy as np

from plasmapyro.tables import rows

ORDER = ("clock", "surface", "gas", "path", "optics", "detector")  # the way of the light
CHANGES = {"clock": "clock", "detector": "output"}  # what the formula of a stage changes, else the light
PHASES = ("pre", "cold", "heating", "steady", "cooling")
BOTH = ("pyrometer", "spectrometer")
REGISTER = {row["id"]: row for row in rows("diagnosis/effects/effects.csv")}


@dataclass(frozen=True)
class Effect:
    """One thing that may be wrong, as a change of the base model; amplitude 0 changes nothing, to the bit.

    `light(scene, amplitude, **shape)` returns a changed copy of the light, `output(output, amplitude)` other
    values of an instrument, `clock(amplitude, kind, **shape)` a shift of the time [s] of a kind of
    instrument, asked of all; else only `instruments` are asked. `sigma` is the standard deviation of the
    prior of the amplitude, in `unit`; `shapes` the further numbers at which the effect is looked for;
    `shape_bounds` where they may move in the fit; `starts` others from which a fit begins as well, too much
    like those to be looked for apart; `measurement` what would decide whether it is there.
    `quadratic`: the data change with the square of the amplitude, as with a width.
    `steady_gas`: it changes the light of the gas alone, and alike at all times, so that nothing but a
    simulation tells it from the gas as it is.
    """

    id: str
    name: str
    klass: str
    stage: str
    amplitude: str
    unit: str
    sigma: float
    bounds: tuple
    phases: tuple
    measurement: str
    instruments: tuple = BOTH
    shapes: tuple = (MappingProxyType({}),)
    shape_bounds: dict = field(default_factory=dict)
    starts: tuple = ()
    quadratic: bool = False
    steady_gas: bool = False
    light: Callable | None = None
    output: Callable | None = None
    clock: Callable | None = None

    @property
    def order(self):
        """Place on the way of the light."""
        return ORDER.index(self.stage)

    @property
    def step(self):
        """Amplitude for derivatives: small against the prior, with the sign that the bounds allow.

        A secant over the whole prior for what is quadratic: its derivative at 0 is 0.
        """
        size = self.sigma if self.quadratic else 0.05 * self.sigma
        return size if self.bounds[1] > 0 else -size

    def amplitude_of(self, linear):
        r"""Amplitude behind a linear estimate (...) along the secant; :math:`\sqrt{x s}` if quadratic."""
        if not self.quadratic:
            return linear
        return np.sqrt(np.maximum(linear * self.step, 0.0))

    def linear_of(self, amplitude):
        """The number along the secant that stands for an amplitude: the other way round."""
        return amplitude * abs(amplitude) / abs(self.step) if self.quadratic else amplitude


def effect(identity, shape=MappingProxyType({})):
    """Decorator that makes a formula the `Effect` of a row of `effects.csv`.

    `shape`: name -> (numbers at which the effect is looked for, bounds); every combination of them is tried.
    """
    row = REGISTER[identity]
    tried = {number: values for number, (values, _) in shape.items() if values}

    def declared(formula):
        return Effect(
            id=identity,
            klass=row["class"],
            sigma=float(row["sigma"]),
            bounds=(float(row["low"]), float(row["high"])),
            phases=tuple(row["phases"].split()),
            instruments=tuple(row["instruments"].split()),
            quadratic=row["quadratic"] == "yes",
            steady_gas=row["steady gas"] == "yes",
            shapes=tuple(dict(zip(tried, numbers, strict=True)) for numbers in product(*tried.values())),
            shape_bounds={number: bounds for number, (_, bounds) in shape.items()},
            **{name: row[name] for name in ("name", "stage", "amplitude", "unit", "measurement")},
            **{CHANGES.get(row["stage"], "light"): formula},
        )

    return declared
