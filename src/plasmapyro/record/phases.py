"""The parts of a test, as shares of its own length."""

import numpy as np
from scipy.ndimage import uniform_filter1d

from plasmapyro.record import flags

# [1] of the light of the window: less is no plasma, its inverse no gas alone, if that is as steady as this
LIT, STEADY = 1 / 3, 0.1
ALIKE = 51  # pixels whose mean light weighs each of them
COOLING = 1 / 3  # of the exposure: what of the time after the end of the plasma is divided up


def phases(time, injection_time, plasma_off_time):
    """Where samples (t,) [s] are in view, and where the plasma shines on them, both ends included."""
    time = np.asarray(time, dtype=float)
    injected = time >= injection_time
    return injected, injected & (time <= plasma_off_time)


def unlit(time, value, window, exposure=0.0):
    """Samples (t,) without plasma: up to the last with less than a third of its light, before the injection
    and before the reference window. A shutter or a probe that passes later takes no reference away.

    A record may begin before the plasma burns; the dark then is no gas that was weak. More than three times
    the light is that of a surface: an earlier test of the same log, which goes on to where that paused.

    Parameters
    ----------
    time : (t,) array [s]
        From the injection.
    value : (t, C) array
    window : pair [s]
        The reference window; a slow instrument that has no sample in it is judged by the last before it.
    exposure : float [s]
        Of a sample: one that goes on behind the window sees the surface heat.
    """
    held = np.isfinite(value).any(axis=1) & (time + exposure / 2 <= window[1])
    inside = (time >= window[0]) & held
    if not inside.any():
        inside = np.arange(time.size) == np.flatnonzero(held)[-1:].sum()
    if not held[inside].any():
        return np.zeros(time.size, dtype=bool)
    number = np.maximum(np.isfinite(value[inside]).sum(axis=0), 1)
    gas = np.nansum(value[inside], axis=0) / number
    # By its own noise as a weight a faint gas would seem brighter than others as faint.
    weight = np.maximum(uniform_filter1d(gas, ALIKE), 0.0) if gas.size > ALIKE else gas
    with np.errstate(invalid="ignore"):  # samples without a channel
        share = np.nansum(value * weight, axis=1) / np.sum(np.isfinite(value) * gas * weight, axis=1)
    ahead = time < min(0.0, time[inside][0])
    bright = np.flatnonzero(ahead & (share > 1 / LIT))
    last = np.flatnonzero(ahead & (share < LIT))
    if bright.size:
        rests = np.flatnonzero(flags.pauses(time) & ahead[:-1])
        last = np.concatenate([last, bright[-1:], rests[rests >= bright[-1]][:1]])
    if not last.size or not share[inside].std() < STEADY:
        return np.zeros(time.size, dtype=bool)
    return np.arange(time.size) <= last.max()


def during(shares, off):
    """Times [s] at shares (...) of the exposure."""
    return np.asarray(shares) * off


def afterwards(shares, off, end):
    """Times [s] at shares (...) of the cooling: to the end of the record, or a third of the exposure."""
    return off + np.asarray(shares) * min(max(end - off, 0.0), COOLING * off)
