"""Levels of atoms and vibrations of N2 that have a temperature of their own, relative to that of the gas."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.gas.partition import partition_function
from plasmapyro.radiation.atoms import ATOMS

VIBRATION = "N2 1P"  # the system whose vibrational temperature may differ
COLDEST = 1500.0  # [K]: colder gas does not shine, and keeps its populations


def departures(temperature, *, excitation=0.0, vibration=0.0):
    """Departures of a path whose atoms are excited, or whose N2 vibrates, at another temperature.

    By component, as `path.gas_path` takes them; empty for no change. `temperature` (S,) [K] of the layers,
    relative change [1] of the temperature of all levels of the atoms (`excitation`) and of the vibrational
    levels of the upper state of N2 1P. ASSUME: the levels of a species share its number density at their
    temperature; of N2 1P the upper state keeps its population, and its lower state that of the gas.
    """
    found = {}
    if excitation:
        found |= dict.fromkeys(ATOMS, Excited(temperature, 1 + excitation))
    if vibration:
        found[VIBRATION] = Vibrating(temperature, 1 + vibration)
    return found


@dataclass(frozen=True)
class Excited:
    r"""Populations at :math:`r T`, over those at T: :math:`\frac{Q(T)}{Q(rT)} e^{c_2 E (1 - 1/r)/T}`."""

    temperature: np.ndarray
    ratio: float

    def factors(self, lines, layer):
        """Factors of the upper and lower levels of a line list in a layer: two (L,) [1]."""
        kelvin = self.temperature[layer]
        if kelvin < COLDEST:
            return np.ones((2, lines.upper_energy.size))
        plain, other = partition_function(lines.species, kelvin * np.array([1.0, self.ratio]))
        change = SECOND_RADIATION / kelvin * (1 - 1 / self.ratio)
        return [
            plain / other * np.exp(change * energy) for energy in (lines.upper_energy, lines.lower_energy)
        ]


@dataclass(frozen=True)
class Vibrating:
    """Populations of the vibrational levels of the upper state at r T, over those at T; their sum stays."""

    temperature: np.ndarray
    ratio: float

    def factors(self, lines, layer):
        """Factors of the upper and lower levels of a line list in a layer: two (L,) [1]."""
        kelvin, lower = self.temperature[layer], np.ones(lines.upper_energy.size)
        return (vibrational(lines, kelvin, self.ratio) if kelvin >= COLDEST else lower), lower


def vibrational(lines, temperature, ratio):
    r"""Factors (L,) that give the vibrational levels of the upper state another temperature.

    .. math:: f(G) = e^{c_2 G (1 - 1/r)/T}\,\frac{\sum_v e^{-c_2 G_v/T}}{\sum_v e^{-c_2 G_v/(rT)}}
    """
    energy, levels = lines.upper_vibration
    change = SECOND_RADIATION / temperature * (1 - 1 / ratio)
    whole = np.exp(-SECOND_RADIATION * levels / temperature)
    return np.exp(change * energy) * whole.sum() / np.sum(whole * np.exp(change * levels))
