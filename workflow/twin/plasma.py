"""How bright the plasma along the line of sight is, in the course of a test."""

from dataclasses import dataclass

import numpy as np
import scipy


@dataclass(frozen=True)
class Plasma:
    """Relative brightness 1 just after injection; the jet without the sample in it is brighter."""

    before_injection: float = 1.7
    drift: float = 0.03  # over the exposure
    swing: float = 0.01  # amplitude of a slow wave
    swing_period: float = 130.0  # [s]
    flicker: float = 0.012  # standard deviation
    flicker_time: float = 0.3  # [s] correlation time
    decay_time: float = 0.02  # [s] after switching off


def remembered(kicks, memory):
    """First-order autoregressive noise (t, ...) of the same variance as its independent kicks."""
    noise = kicks.copy()
    for index in range(1, len(kicks)):
        noise[index] = memory * noise[index - 1] + np.sqrt(1 - memory**2) * kicks[index]
    return noise


def brightness(plasma, time, plasma_off_time, random):
    """Brightness (t,) over that of the simulated gas, on equally spaced times (t,) [s]."""
    step = time[1] - time[0]
    memory = np.exp(-step / plasma.flicker_time)
    wander = remembered(random.standard_normal(time.size) * plasma.flicker, memory)
    exposure = np.clip(time / plasma_off_time, 0, 1)
    wave = np.sin(2 * np.pi * np.maximum(time, 0) / plasma.swing_period)
    slow = plasma.drift * exposure + plasma.swing * wave
    # The probe swings in within the last half second before 0 s.
    outside = scipy.special.expit(-(time + 0.25) / 0.04)
    level = (1 + (plasma.before_injection - 1) * outside) * (1 + slow + wander)
    return np.maximum(level, 0) * np.exp(-np.maximum(time - plasma_off_time, 0) / plasma.decay_time)
