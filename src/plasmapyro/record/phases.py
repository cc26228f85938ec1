"""The parts of a test, as shares of its own length."""

import numpy as np

COOLING = 1 / 3  # of the exposure: what of the time after the end of the plasma is divided up


def phases(time, injection_time, plasma_off_time):
    """Where samples (t,) [s] are in view, and where the plasma shines on them, both ends included."""
    time = np.asarray(time, dtype=float)
    injected = time >= injection_time
    return injected, injected & (time <= plasma_off_time)


def during(shares, off):
    """Times [s] at shares (...) of the exposure."""
    return np.asarray(shares) * off


def afterwards(shares, off, end):
    """Times [s] at shares (...) of the cooling: to the end of the record, or a third of the exposure."""
    return off + np.asarray(shares) * min(max(end - off, 0.0), COOLING * off)
