"""What a design gains over a reference, and whether the gain survives a gas that is not quite as computed.

A gain is by how much the temperature is lower above which the gas error stays below a level [K], NaN where
reference or design have none.
"""

import numpy as np


def change(perturbed, nominal):
    """Perturbed over nominal gain (..., C) [1]; NaN where one is missing or the nominal gain is not > 0."""
    nominal = np.broadcast_to(nominal, np.shape(perturbed))
    good = np.isfinite(perturbed) & np.isfinite(nominal) & (nominal > 0)
    return np.divide(perturbed, nominal, out=np.full(np.shape(perturbed), np.nan), where=good)


def excess(ratio, tolerance):
    """By how much the worst ratio leaves 1 +- `tolerance` (D,), of (D, ...) ratios; at most 1, as for NaN."""
    beyond = np.clip(np.abs(ratio - 1) - tolerance, 0.0, 1.0)
    return np.nan_to_num(beyond, nan=1.0).reshape(len(ratio), -1).max(axis=1)


def at_neighbours(numerical_power, gained, step):
    """Gains (..., C) at each condition's power less and plus a step: (..., 2, C); linear in the power.

    Where no neighbour was computed the gain itself stands, which says nothing and costs nothing.
    """
    power = np.asarray(numerical_power, dtype=float)
    rows = np.nan_to_num(gained, nan=0.0).reshape(-1, power.size)
    result = np.empty((len(rows), 2, power.size))
    for place, sign in enumerate((-1, 1)):
        wanted = power + sign * step
        outside = (wanted < power[0]) | (wanted > power[-1])
        for number, row in enumerate(rows):
            result[number, place] = np.where(outside, row, np.interp(wanted, power, row))
    return result.reshape(*np.shape(gained)[:-1], 2, power.size)


def neighbour_signals(numerical_power, signal, step):
    """Band signals (..., C) at each condition's power [W] plus a step [W], linear in their logarithm.

    NaN where that power lies outside those computed, which increase.
    """
    power = np.asarray(numerical_power, dtype=float)
    wanted = power + step
    rows = np.log(signal).reshape(-1, power.size)
    found = np.array([np.interp(wanted, power, row, left=np.nan, right=np.nan) for row in rows])
    return np.exp(found).reshape(np.shape(signal))
