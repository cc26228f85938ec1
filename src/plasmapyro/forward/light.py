"""Records that the effects change: the scene, the light on its way, the signals."""

import dataclasses

import numpy as np

LIGHT_STAGES = ("source", "surface", "path", "optics")
SIGNAL_STAGES = ("detector", "clock")
STAGES = LIGHT_STAGES + SIGNAL_STAGES


@dataclasses.dataclass(frozen=True)
class Scene:
    """What is true about a test, as far as the base model knows.

    `emittance` is a number or broadcasts to (t, B); `temperature_variance` [K2] is that of the surface
    within footprint and exposure (`averaging`), a number or (t,).
    """

    time: np.ndarray  # (t,) [s]
    temperature: np.ndarray  # (t,) [K]
    gas_amplitude: np.ndarray  # (t,) [1] gas light over that of the simulation at `power`
    injected: np.ndarray  # (t,) bool, surface in view
    emittance: float | np.ndarray
    power: float  # [W]
    incident_share: float = (
        0.0  # [1] of the incident gas light that the surface sends back, over 1 - emittance
    )
    temperature_variance: float | np.ndarray = 0.0
    plasma_on: np.ndarray | None = None  # (t,) bool; None: wherever the gas amplitude is not 0

    def __post_init__(self):
        size = np.shape(self.time)
        for name in ("temperature", "gas_amplitude", "injected"):
            if np.shape(getattr(self, name)) != size:
                raise ValueError(
                    f"{name} must have the shape of time {size}; got {np.shape(getattr(self, name))}"
                )


@dataclasses.dataclass(frozen=True)
class Light:
    """Light on its way to one instrument; arrays broadcast to (t, B) [W m-2 sr-1 m-1 or 1]."""

    instrument: str
    scene: Scene
    wavelength: np.ndarray  # (B,) [m] middle of each bin
    bin_size: np.ndarray  # (B,) [m]
    blackbody: np.ndarray  # Planck's law at the surface temperature, averaged over footprint and exposure
    blackbody_slope: np.ndarray  # its derivative by the temperature
    emittance: np.ndarray
    incident: np.ndarray  # gas light that falls on the surface
    gas: np.ndarray  # gas light along the line of sight
    emittance_slope: np.ndarray | float = 0.0  # [K-1] its derivative by the temperature
    foreground: np.ndarray | float = 0.0  # anything else that shines
    transmittance: np.ndarray | float = 1.0  # of what has been set so far, relative to the calibration

    def replace(self, **changes):
        """The same light with other values of some fields."""
        return dataclasses.replace(self, **changes)

    @property
    def injected(self):
        """(t, 1) bool: the surface is in view."""
        return self.scene.injected[:, None]

    def radiance(self):
        """Radiance (t, B) that arrives."""
        surface = self.emittance * self.blackbody + (1 - self.emittance) * self.incident
        return self.transmittance * (np.where(self.injected, surface, 0.0) + self.gas + self.foreground)

    def slope(self):
        """Derivative of the radiance by the surface temperature (t, B) [per K]."""
        change = self.emittance * self.blackbody_slope + self.emittance_slope * (
            self.blackbody - self.incident
        )
        return self.transmittance * np.where(self.injected, change, 0.0)


@dataclasses.dataclass(frozen=True)
class Signals:
    """What an instrument gives: A for the pyrometer, W m-2 sr-1 m-1 for the spectrometer."""

    instrument: str
    scene: Scene
    channel: np.ndarray  # (C,) band names, or [m] middle of each bin
    value: np.ndarray  # (t, C)
    slope: np.ndarray  # (t, C) derivative by the surface temperature

    def replace(self, **changes):
        """The same signals with other values of some fields."""
        return dataclasses.replace(self, **changes)

    def mapped(self, value, derivative):
        """Signals after a detector that makes `value` of them; `derivative` of that by the old value."""
        return self.replace(value=value, slope=self.slope * derivative)


def in_order(effects):
    """Effects sorted by stage, keeping their order within a stage.

    Raises
    ------
    ValueError
        For an effect of an unknown stage.
    """
    for effect in effects:
        if effect.stage not in STAGES:
            raise ValueError(
                f"the stage of an effect must be one of {', '.join(STAGES)}; got {effect.stage!r}"
            )
    return sorted(effects, key=lambda effect: STAGES.index(effect.stage))
