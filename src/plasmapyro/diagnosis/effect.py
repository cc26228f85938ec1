"""What a term of the catalogue is."""

from collections.abc import Callable
from dataclasses import dataclass, field
from types import MappingProxyType

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
    they may move in the fit; `measurement` what would decide whether it is there.
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
    light: Callable | None = None
    output: Callable | None = None
    clock: Callable | None = None

    @property
    def order(self):
        """Place on the way of the light."""
        return ORDER.index(self.stage)

    @property
    def step(self):
        """Amplitude for derivatives: small against the prior, with the sign that the bounds allow."""
        size = 0.05 * self.sigma
        return size if self.bounds[1] > 0 else -size
