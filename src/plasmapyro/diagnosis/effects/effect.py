"""What an effect is, and how it is declared: by a decorator at its formula."""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from types import MappingProxyType

import numpy as np

ORDER = ("clock", "surface", "gas", "path", "optics", "detector")  # the way of the light
CHANGES = {"clock": "clock", "detector": "output"}  # what the formula of a stage changes, else the light
PHASES = ("pre", "cold", "heating", "steady", "cooling")
HOT, EXPOSED, BURNING = PHASES[2:], PHASES[1:4], PHASES[:4]
BOTH = ("pyrometer", "spectrometer")
PYROMETER, SPECTROMETER = BOTH[:1], BOTH[1:]
PAPER = "Fagnani et al."
KNOWN = "Z. M. Zhang, B. K. Tsai & G. Machin, Radiometric Temperature Measurements (2010)"


@dataclass(frozen=True)
class Amplitude:
    """Size of an effect: what it means, its unit, standard deviation of its prior, and where it may lie."""

    name: str
    unit: str
    sigma: float
    bounds: tuple


@dataclass(frozen=True)
class Effect:
    """One thing that may be wrong, as a change of the base model; amplitude 0 changes nothing, to the bit.

    `light(scene, amplitude, **shape)` returns a changed copy of the light, `output(output, amplitude)` other
    values of an instrument, `clock(amplitude)` a shift of its time [s]; only `instruments` are asked. `sigma`
    is the standard deviation of the prior of the amplitude, in `unit`; `shapes` the further numbers at which
    the effect is looked for; `shape_bounds` where they may move in the fit; `measurement` what would decide
    whether it is there. `quadratic`: the data change with the square of the amplitude, as with a width.
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
    reference: str = KNOWN
    shapes: tuple = (MappingProxyType({}),)
    shape_bounds: dict = field(default_factory=dict)
    degenerate_with: tuple = ()
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


def effect(identity, name, *, stage, amplitude, shape=MappingProxyType({}), **fields):
    """Decorator that makes a formula an `Effect`.

    Parameters
    ----------
    identity, name : str
    stage : one of `ORDER`
    amplitude : Amplitude
    shape : mapping name -> (numbers at which the effect is looked for, bounds)
        It is looked for at every combination of the numbers.
    **fields : the other fields of `Effect`

    Returns
    -------
    function formula -> Effect

    Raises
    ------
    TypeError
        A field that is missing or that no effect has.
    """
    tried = {number: values for number, (values, _) in shape.items() if values}

    def declared(formula):
        return Effect(
            id=identity,
            name=name,
            stage=stage,
            amplitude=amplitude.name,
            unit=amplitude.unit,
            sigma=amplitude.sigma,
            bounds=amplitude.bounds,
            shapes=tuple(dict(zip(tried, numbers, strict=True)) for numbers in product(*tried.values())),
            shape_bounds={number: bounds for number, (_, bounds) in shape.items()},
            **fields,
            **{CHANGES.get(stage, "light"): formula},
        )

    return declared
