"""The simulated gas in the channels of a test: its light at another power or with effects, and its error."""

from dataclasses import replace

import numpy as np

from plasmapyro import conditions
from plasmapyro.diagnosis.fit.model import Model
from plasmapyro.diagnosis.fit.parameter import Parameter

JUST_AFTER = 1e-3  # [s] after injection: the gas as it then is, in front of a cold surface
FAINTER, BRIGHTER = 0.1, 10.0  # [1], over the simulated light: beyond, its relative error says nothing
OF_A_VALUES = ("multiplet", "line")  # causes
COLD = 250.0  # [K]: a surface that does not shine

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
        self._plain = {}
        self.unit = measured.simulated / self._signals(self.centre, ())
        library = model.library
        self.systems, self.shape_systems = library.systems, library.shape_systems
        self._strength, self._shape, self.group = (
            self._channels(rows) for rows in (library.strength_modes, library.shape_modes, library.group)
        )
        self.bands = self._channels(np.broadcast_to(library.bands, (1, library.wavelength.size)))[0]
        fine = [np.full(one.channels, one.weight is None) for one in instruments]
        self.bands[~np.concatenate(fine)] = 0.0  # a wide band sees the mean of many lines

    def _signals(self, values, settings):
        """Signals (C,) of all instruments, in their units."""
        count = len(self.model.instruments)
        found = [self.model.evaluate(which, self.cold, values, settings)[0] for which in range(count)]
        return np.concatenate(found)

    def _channels(self, spectra):
        """Spectra (M, K) in the channels (M, C), over the level."""
        count = len(self.model.instruments)
        found = [self.model.signal_of(which, spectra, self.centre) for which in range(count)]
        return self.unit * np.concatenate(found, axis=1)

    def light(self, power, brightness, settings=()):
        """Light (C,) over the level, for logarithms of power and brightness and with effects."""
        values = self.centre.copy()
        values[self.model.index["power"]] = power
        if settings:
            values[self.model.index["gas"]] = brightness
            return self._signals(values, settings) * self.unit
        # Without effects it is proportional to the brightness: fits ask for many at one power.
        if power not in self._plain:
            self._plain[power] = self._signals(values, ()) * self.unit
        return np.exp(brightness) * self._plain[power]

    def covariance(self, modes, light):
        """Covariance (C, C) of the error that modes (M, C) state, relative to some light (C,)."""
        simulated = np.where(self.measured.simulated > 0, self.measured.simulated, 1.0)
        factor = np.clip(light / simulated, FAINTER, BRIGHTER)
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
