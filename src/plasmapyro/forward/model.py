"""Signals of an instrument for a scene, with or without effects."""

import dataclasses

import numpy as np
from scipy.interpolate import CubicSpline

from plasmapyro.forward.averaging import planck_derivatives
from plasmapyro.forward.light import LIGHT_STAGES, SIGNAL_STAGES, Light, Signals, in_order

TABLE_TEMPERATURES = (200.0, 4000.0)  # [K] of the tables of a grey surface
TABLE_POINTS = 400  # equal steps of 1/T; ln S is nearly straight in it: error below 1e-8


@dataclasses.dataclass(frozen=True)
class Instrument:
    """One instrument: its bins, what they give in its channels, and the gas in them."""

    name: str
    edges: np.ndarray  # (B + 1,) [m]
    channel: np.ndarray  # (C,) band names or [m]
    weight: np.ndarray | None  # (C, B) signal per radiance of a bin; None: each bin is a channel
    power: np.ndarray  # (P,) [W] increasing, of the simulated conditions
    gas: np.ndarray  # (P, B) [W m-2 sr-1 m-1] their mean radiance in the bins
    incident: np.ndarray | None = None  # (P, B) gas light falling on the surface, if computed

    @property
    def wavelength(self):
        """(B,) [m] middle of each bin."""
        return (self.edges[1:] + self.edges[:-1]) / 2

    def gas_at(self, power):
        """Gas radiance (B,) [W m-2 sr-1 m-1] at a numerical power [W] between the simulated ones."""
        return interpolate_logarithm(power, self.power, self.gas)

    def incident_at(self, power):
        """Incident gas radiance (B,); 0 where none was computed."""
        if self.incident is None:
            return np.zeros(self.edges.size - 1)
        return interpolate_logarithm(power, self.power, self.incident)

    def detect(self, radiance):
        """Signal (..., C) of a radiance (..., B)."""
        return radiance if self.weight is None else radiance @ self.weight.T


def interpolate_logarithm(power, nodes, values):
    r"""Values between conditions, :math:`\ln L` linear in the power.

    Parameters
    ----------
    power : float [W]
    nodes : (P,) array [W], increasing
    values : (P, ...) array, > 0

    Returns
    -------
    (...) ndarray

    Raises
    ------
    ValueError
        If there are no nodes, or the power lies outside them.

    Notes
    -----
    ASSUME: ln L is straight between two powers. Leaving out one condition of the main job shows what steps
    of 20 kW cost in the wide band: 7 % at most from 80 to 110 kW, 12 % at 70, 20 % at 120, 33 % at 60 kW.
    """
    if len(nodes) == 0:
        raise ValueError("the model holds no gas: give it the radiance of at least one condition")
    if not nodes[0] <= power <= nodes[-1]:
        raise ValueError(
            f"power must lie within the simulated conditions, {nodes[0] / 1e3:g} to {nodes[-1] / 1e3:g} kW;"
            f" got {power / 1e3:g} kW"
        )
    if len(nodes) == 1:
        return np.array(values[0])
    upper = int(np.clip(np.searchsorted(nodes, power), 1, len(nodes) - 1))
    share = (power - nodes[upper - 1]) / (nodes[upper] - nodes[upper - 1])
    tiny = np.finfo(float).tiny
    low, high = (np.log(np.maximum(values[place], tiny)) for place in (upper - 1, upper))
    return np.exp((1 - share) * low + share * high)


def signals(instrument, scene, effects=()):
    """Signals of an instrument, with the effects applied stage by stage.

    Parameters
    ----------
    instrument : Instrument
    scene : Scene
    effects : sequence of callables with a `stage`, see the package

    Returns
    -------
    Signals

    Notes
    -----
    The slope leaves out the change of the averaging correction with temperature (a relative
    1/2 (c2/lambda T2)2 var T, 1 % for 10 K at 1000 K).
    """
    effects = in_order(effects)
    light = base_light(instrument, scene)
    for effect in effects:
        if effect.stage in LIGHT_STAGES:
            light = effect(light)
    seen = Signals(
        instrument.name,
        scene,
        instrument.channel,
        instrument.detect(light.radiance()),
        instrument.detect(light.slope()),
    )
    for effect in effects:
        if effect.stage in SIGNAL_STAGES:
            seen = effect(seen)
    return seen


def base_light(instrument, scene):
    """Light (t, B) without any effect."""
    wavelength = instrument.wavelength
    body, slope, curvature = planck_derivatives(
        wavelength, np.asarray(scene.temperature, dtype=float)[:, None]
    )
    if np.any(scene.temperature_variance):
        body = body + 0.5 * np.reshape(scene.temperature_variance, (-1, 1)) * curvature
    amplitude = np.asarray(scene.gas_amplitude, dtype=float)[:, None]
    incident = np.zeros((1, 1))
    if scene.incident_share:
        incident = scene.incident_share * amplitude * instrument.incident_at(scene.power)
    return Light(
        instrument.name,
        scene,
        wavelength,
        np.diff(instrument.edges),
        body,
        slope,
        np.atleast_2d(scene.emittance),
        incident,
        amplitude * instrument.gas_at(scene.power),
    )


class GreyTable:
    """Black body signals of an instrument as a function of 1/T, with two derivatives by T."""

    def __init__(self, instrument, temperatures=TABLE_TEMPERATURES, points=TABLE_POINTS):
        inverse = np.linspace(1 / temperatures[1], 1 / temperatures[0], points)
        body = planck_derivatives(instrument.wavelength, 1 / inverse[:, None])[0]
        self._spline = CubicSpline(inverse, np.log(instrument.detect(body)))
        self.temperatures = temperatures

    def __call__(self, temperature):
        r"""Signal, :math:`S'`, :math:`S''` by the temperature, each (t, C).

        Raises
        ------
        ValueError
            If a temperature lies outside the table.
        """
        temperature = np.asarray(temperature, dtype=float)
        if not np.all((temperature >= self.temperatures[0]) & (temperature <= self.temperatures[1])):
            raise ValueError(
                f"temperature must lie in [{self.temperatures[0]:g}, {self.temperatures[1]:g}] K;"
                f" got {np.min(temperature):g} to {np.max(temperature):g} K"
            )
        beta = 1 / temperature
        value = np.exp(self._spline(beta))
        logarithmic, bend = self._spline(beta, 1), self._spline(beta, 2)
        beta = beta[:, None]
        first = -(beta**2) * logarithmic
        second = first**2 + beta**4 * bend + 2 * beta**3 * logarithmic
        return value, value * first, value * second


def grey_signals(instrument, scene, table):
    """The same as `signals` for a grey surface, no incident light and no effects, from a `GreyTable`."""
    body, slope, curvature = table(scene.temperature)
    body = body + 0.5 * np.reshape(scene.temperature_variance, (-1, 1)) * curvature
    seen = np.asarray(scene.injected)[:, None] * scene.emittance
    gas = instrument.detect(instrument.gas_at(scene.power))
    return Signals(
        instrument.name,
        scene,
        instrument.channel,
        seen * body + np.asarray(scene.gas_amplitude)[:, None] * gas,
        seen * slope,
    )
