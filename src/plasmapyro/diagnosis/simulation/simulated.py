"""The simulated gas in the channels of a test: its light at another power or with effects, and its error."""

from copy import copy
from dataclasses import replace

import numpy as np

from plasmapyro import conditions
from plasmapyro.diagnosis.fit.model import Model
from plasmapyro.diagnosis.fit.parameter import Parameter
from plasmapyro.diagnosis.fit.slit import SLIT

JUST_AFTER = 1e-3  # [s] after injection: the gas as it then is, in front of a cold surface
FAINTER, BRIGHTER = 0.1, 10.0  # [1], over the simulated light: beyond, its relative error says nothing
OF_A_VALUES = ("multiplet", "line")  # causes
SCALE = "wshift"  # the effect that is a wrong scale of the wavelengths
MOVING = SCALE, SLIT
COLD = 250.0  # [K]: a surface that does not shine
MOST_KEPT = 1000  # lights that fits have asked for

# At the same power the gas of a higher pressure is hotter, as that of a higher power at the same pressure:
# ln P of it over ln p, by flows at 25, 50 and 100 mbar and 80 kW (0.12 and 0.15, read from their spectra).
POWER_OF_PRESSURE, ITS_ERROR = 0.135, 0.07  # ASSUME half of it: other powers, gases and torches


def expected_power(radiation):
    """Mean and standard deviation of ln P of a gas over that of its simulated spectrum.

    (0, 0) but where this was simulated along the temperatures of a flow at another pressure.
    """
    flow = conditions.number(radiation, conditions.FLOW_PRESSURE)
    if np.isnan(flow):
        return 0.0, 0.0
    change = np.log(conditions.number(radiation, "chamber_pressure") / flow)
    return float(POWER_OF_PRESSURE * change), float(ITS_ERROR * abs(change))


class Simulated:
    """Light of the simulated gas in the channels of a test, over its level, and the errors of it.

    `strength`, `shape` (M, C): the modes of `radiation.uncertainty` in the channels, `systems` (M,) whose
    strength they are; `group` (G, C): the light in groups of lines; `effects` {id: Effect} that may act;
    `away`: mean and standard deviation of ln P that the gas is expected at;
    the data may raise `roughness` [1], the error of the light of bands in each channel by itself, from 0, and
    `scatter` [1], the error of the A values of lines over the stated one, from 1.
    """

    roughness, scatter = 0.0, 1.0

    def __init__(self, model, measured, effects, away=(0.0, 0.0)):
        instruments = [
            replace(
                one,
                moment=np.full_like(one.moment[:1], JUST_AFTER),
                value=one.value[:1],
                number=one.number[:1],
            )
            for one in model.instruments
        ]
        self.power = model.power[0] + away[0], float(np.hypot(model.power[1], away[1]))
        power = Parameter("power", "simulated power (logarithm)", self.power[1])
        self.model = Model(
            instruments,
            model.library,
            model.history,
            (*model.own, power),
            model.record,
            model.slope,
            model.response,
            model.lamp,
            model.persistent,
        )
        self.measured, self.effects = measured, effects
        self.centre = np.array([parameter.centre for parameter in self.model.parameters])
        self.centre[self.model.index["gas"]] = 0.0
        self.cold = np.full(model.size, COLD)
        self._scenes = [
            self.model.scene(which, self.cold, self.centre, ())[0] for which in range(len(instruments))
        ]
        self._kept = {}
        self.unit = measured.simulated / self._signals(0.0, ())[0]
        self.systems, self.shape_systems = model.library.systems, model.library.shape_systems
        self._see(())

    def _see(self, settings):
        """Take errors and groups as some settings show them."""
        library = self.model.library
        bands = np.broadcast_to(library.bands, library.base.shape)
        rows = library.strength_modes, library.shape_modes, library.group, np.array([bands, library.base])
        self._strength, self._shape, self.group, (rough, self.seen) = (
            self._channels(one, settings) for one in rows
        )
        wide = [np.full(one.channels, one.weight is not None) for one in self.model.instruments]
        self.bands = np.where(np.concatenate(wide), 0.0, rough)  # a wide band sees the mean of many lines

    def through(self, settings):
        """The same with errors and groups where a spectrometer of the scale and the slit of settings shows
        them: at the places of before, a line that is weaker would pass for one that moved less."""
        moving = tuple(one for one in settings if one.id in MOVING)
        if not moving:
            return self
        other = copy(self)
        other._see(moving)
        return other

    def _signals(self, power, settings):
        """Signals (2, C) of all instruments, in their units, before a surface that does not shine: of a gas
        as bright as simulated, and of what is not as bright as it is."""
        values = self.centre.copy()
        values[self.model.index["power"]] = power
        spectrum, changed, found = self.model.spectrum(values), {}, []
        for which, (one, plain) in enumerate(zip(self.model.instruments, self._scenes, strict=True)):
            acting = tuple(setting.id for setting in settings if setting.acts_on(one.kind))
            if acting not in changed:  # the spectrum is that of the gas, whoever looks at it
                changed[acting] = _changed(plain.but(spectrum=spectrum, power=power), acting, settings)
            scene = changed[acting]
            rows = np.array([scene.spectrum, *(row for _, row in scene.more_gas)])
            share = np.array([plain.gas_gain.mean(), *(part.mean() for part, _ in scene.more_gas)])
            light = share[:, None] * self.model.signal_of(which, rows, self.centre, scene)
            found.append(np.array([light[0], light[1:].sum(axis=0)]))
        return np.concatenate(found, axis=1)

    def _channels(self, spectra, settings):
        """Spectra (M, K) in the channels (M, C), over the level, by scale and slit as settings say."""
        found = []
        for which in range(len(self.model.instruments)):
            scene = self.model.changed_scene(which, self.cold, self.centre, settings)[0]
            found.append(self.model.signal_of(which, spectra, self.centre, scene))
        return self.unit * np.concatenate(found, axis=1)

    def light(self, power, brightness, settings=()):
        """Light (C,) over the level, for logarithms of power and brightness and with effects."""
        # Fits ask for many brightnesses at one power, and for one beside the other.
        key = power, tuple((one.id, one.amplitude, *sorted(one.shape.items())) for one in settings)
        if key not in self._kept:
            if len(self._kept) >= MOST_KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = self._signals(power, settings) * self.unit
        gas, more = self._kept[key]
        return np.exp(brightness) * gas + more

    def covariance(self, modes, light):
        """Covariance (C, C) of the error that modes (M, C) state, relative to some light (C,)."""
        factor = np.clip(light / np.where(self.seen > 0, self.seen, 1.0), FAINTER, BRIGHTER)
        scaled = modes * factor
        return scaled.T @ scaled + np.diag((self.roughness * self.bands * factor) ** 2)

    def groups_of(self, system):
        """Whether each group of lines (G,) is of a radiating system."""
        return np.array([f"{system} " in f"{name} " for name in self.model.library.group_name])

    @property
    def strength(self):
        """Modes (M, C) of the strengths of systems and of groups of their lines."""
        return self._scattered(self._strength, self.model.library.causes)

    @property
    def shape(self):
        """Modes (M, C) of what changes within systems and groups."""
        return self._scattered(self._shape, self.model.library.shape_causes)

    def _scattered(self, modes, causes):
        return modes * np.where(np.isin(causes, OF_A_VALUES), self.scatter, 1.0)[:, None]

    def stronger(self, factors):
        """The modes of shape (M, C) where systems are {name: factor} as bright as expected."""
        return self.shape * np.array([factors.get(name, 1.0) for name in self.shape_systems])[:, None]


def _changed(scene, acting, settings):
    """A scene with what those of some settings that are `acting` (ids) change of its light."""
    for setting in sorted(settings, key=lambda setting: setting.effect.order):
        if setting.id in acting and setting.effect.light is not None:
            scene = setting.effect.light(scene, setting.amplitude, **setting.shape)
    return scene
