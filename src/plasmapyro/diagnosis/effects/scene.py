"""What an instrument sees at every instant, before and after the effects that extend the base model."""

from dataclasses import dataclass, field, replace

import numpy as np


@dataclass(frozen=True)
class Scene:
    """Light on its way to one instrument at the instants (n, 2) on the nodes (M,).

    Effects return a changed copy. `spectrum` (K,) is the gas after injection on the axis `spectral_axis`,
    `gas_gain` (n, 2) its brightness; `more_gas` holds further (time weight (n, 2), spectrum (K,)) pairs,
    `scattered` those of light that is brighter in a channel where the gas is; `emittance` and `path`
    broadcast against (n, 2, M); `glow` (n, 2, M) is the black body the spot amounts to; `added` (n, 2, M)
    reaches the instrument without having been emitted by surface or gas.
    """

    kind: str
    time: np.ndarray
    temperature: np.ndarray
    wavelength: np.ndarray
    off_time: float
    glow: np.ndarray
    emittance: np.ndarray | float
    gas_gain: np.ndarray
    spectral_axis: np.ndarray
    spectrum: np.ndarray
    library: object
    power: float = 0.0  # of the gas: logarithm, over that of the library
    more_gas: tuple = ()
    scattered: tuple = ()
    path: np.ndarray | float = 1.0
    added: np.ndarray | float = 0.0
    response_shift: tuple = (0.0, 0.0)
    detector_shift: tuple = (0.0, 0.0)
    response_tail: float = 0.0
    wavelength_shift: float = 0.0
    slit_sigma2: float = 0.0
    history: object = None  # temperature at other times: callable (n, 2) -> (n, 2)

    @property
    def injected(self):
        """1 where the sample is in view (n, 2)."""
        return (self.time >= 0).astype(float)

    @property
    def plasma(self):
        """1 while the plasma burns (n, 2)."""
        return (self.time < self.off_time).astype(float)

    @property
    def exposure(self):
        """Share of the exposure that has passed (n, 2), 0 before and 1 after."""
        return np.clip(self.time / self.off_time, 0.0, 1.0)

    def but(self, **changes):
        """A copy with other fields."""
        return replace(self, **changes)


@dataclass(frozen=True)
class Output:
    """What an instrument shows: `value` (n, C) [A or W m-2 sr-1 m-1], and what its faults may depend on.

    `factor` (C,): radiance per count rate of the spectrometer, None for the pyrometer; `gas_level` (C,):
    signal of the gas alone after injection, as it is fitted, not as it is simulated; `full_scale`: largest
    value (C,) of the test, or the largest count rate of a pixel; `pixels` (C,): how many each channel holds.
    """

    kind: str
    time: np.ndarray  # (n,)
    off_time: float
    value: np.ndarray
    factor: np.ndarray | None
    gas_level: np.ndarray
    full_scale: np.ndarray | float
    pixels: np.ndarray
    wavelength: np.ndarray = field(default=None)

    def but(self, value):
        """A copy with another value."""
        return replace(self, value=value)
