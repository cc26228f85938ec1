"""Shape of the first positive system of N2: bands with their rotation, from molecular constants."""

from functools import lru_cache

import numpy as np
import scipy

from twin import lines

SECOND = 1.438776877  # [cm K] h c / k
# Rotation [cm-1]: B, its decrease per vibrational quantum, of the upper and the lower state, and the
# spin-orbit splitting of the upper one. K. P. Huber & G. Herzberg, Constants of Diatomic Molecules (1979).
UPPER, LOWER, SPLITTING = (1.6374, 0.0179), (1.4546, 0.0180), 42.2
LOWER_QUANTUM, LOWER_ANHARMONIC = 1460.6, 13.87  # [cm-1] of the lower state, the same source
HIGHEST = 140  # rotational quantum number; 30 000 cm-1 of rotation
SMOOTH = 0.3e-9  # [m] standard deviation: below what a spectrometer of the laboratory resolves
FLOOR = 1e-6  # of the mean light, where no band reaches


@lru_cache(maxsize=1)
def _transitions():
    """Vacuum wavelength [m], vibrational level, rotational energy [cm-1], strength of all lines.

    ASSUME: P, Q and R branches of equal strength in each of three spin components, (2 J + 1) / 9 each.
    """
    level = np.array(lines.NITROGEN_VIBRATION, dtype=float)
    bottom = level[0] - 1e7 / (lines.NITROGEN_BANDS[0][1] * 1.00027)
    lower = np.arange(20)
    ladder = bottom + LOWER_QUANTUM * lower - LOWER_ANHARMONIC * lower * (lower + 1)
    j = np.arange(HIGHEST + 1.0)
    rows = []
    for upper, origin, probability in lines.NITROGEN_BANDS:
        place = 1e7 / (origin * 1.00027)
        down = lower[np.argmin(np.abs(level[upper] - place - ladder))]
        b_up = UPPER[0] - UPPER[1] * (upper + 0.5)
        b_down = LOWER[0] - LOWER[1] * (down + 0.5)
        energy = b_up * j * (j + 1)
        for change in (-1, 0, 1):
            below = np.maximum(j + change, 0.0)
            for spin in (-SPLITTING, 0.0, SPLITTING):
                line = place + spin + energy - b_down * below * (below + 1)
                rows.append((1e-2 / line, np.full(j.size, upper), energy, probability * (2 * j + 1) / 9))
    wavelength, upper, energy, strength = (np.concatenate(column) for column in zip(*rows, strict=True))
    return wavelength, upper, energy, strength


def bands(centres, population):
    """Light (B,) of the system on equal bins about `centres` [m], in units of its own.

    `population`: (vibrational, rotational energy (L,)) [cm-1] -> population (L,).
    """
    wavelength, upper, energy, strength = _transitions()
    step = (centres[-1] - centres[0]) / (centres.size - 1)
    place = np.round((wavelength - centres[0]) / step).astype(int)
    near = (place >= 0) & (place < centres.size)
    vibration = np.array(lines.NITROGEN_VIBRATION, dtype=float)[upper[near]]
    light = np.bincount(place[near], strength[near] * population(vibration, energy[near]), centres.size)
    return scipy.ndimage.gaussian_filter1d(light, SMOOTH / step, mode="nearest")


def change(centres, temperature, factor):
    """How the light of the system changes (B,) if each level gains `factor` (vibration, rotation)."""

    def before(vibration, rotation):
        first = lines.NITROGEN_VIBRATION[0]
        return np.exp(-SECOND * (vibration - first + rotation) / temperature)

    old = bands(centres, before)
    new = bands(centres, lambda v, r: before(v, r) * factor(v, r))
    floor = FLOOR * old.mean()
    return (new + floor) / (old + floor)


def vibrational(temperature, ratio):
    """Factor of the levels (vibration, rotation) if vibration has `ratio` times the temperature."""
    level = np.array(lines.NITROGEN_VIBRATION, dtype=float)
    now, then = (
        np.exp(-SECOND * (level - level[0]) / kelvin) for kelvin in (temperature, temperature * ratio)
    )

    def factor(vibration, rotation):
        shift = np.exp(-SECOND * (vibration - level[0]) / temperature * (1 / ratio - 1))
        return shift * now.sum() / then.sum()

    return factor
