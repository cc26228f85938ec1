"""What a term of the catalogue is."""

from collections.abc import Callable
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

ORDER = ("clock", "surface", "gas", "path", "optics", "detector")  # the way of the light
PHASES = ("pre", "cold", "heating", "steady", "cooling")
BOTH = ("pyrometer", "spectrometer")


@dataclass(frozen=True)
class Effect:
    """One thing that may be wrong, as a change of the base model; amplitude 0 changes nothing, to the last
    bit.

    `light(scene, amplitude, **shape)` and `output(output, amplitude, **shape)` return a changed copy;
    `clock(kind, amplitude, shape)` a shift of time [s]. `sigma` is the standard deviation of the prior of the
    amplitude, in `unit`; `shapes` the further numbers at which the effect is looked for; `shape_bounds` where
    they may move in the fit; `measurement` what would decide whether it is there. `quadratic`: the data
    change with the square of the amplitude, as with a spread or a width.
    """

    id: str
    name: str
    klass: str
    stage: str
    amplitude: str
    unit: str
    sigma: float
    bounds: tuple
    instruments: tuple
    phases: tuple
    measurement: str
    reference: str
    shapes: tuple = (MappingProxyType({}),)
    shape_bounds: dict = field(default_factory=dict)
    degenerate_with: tuple = ()
    quadratic: bool = False
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
