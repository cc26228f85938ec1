"""Rules for a sight line: lengths, pressures and densities that no wind tunnel has."""

import numpy as np

from plasmapyro.constants import BOLTZMANN
from plasmapyro.quality.rule import rule


@rule()
def path_length(case, limit):
    length = float(np.ptp(case.sightline.path_distance.values))
    return None if limit <= length <= 1e3 * limit else {"length": length}


@rule()
def gas_pressure(case, limit):
    pressure = float(np.median(case.sightline.pressure.values))
    return None if limit <= pressure <= 2e3 * limit else {"pressure": pressure}


@rule()
def ideal_gas(case, limit):
    gas = case.sightline
    pressure = gas.pressure.values
    product = gas.number_density.sum("species").values * BOLTZMANN * gas.temperature.values
    ratio = np.abs(np.log(product / pressure))
    ratio = np.where(np.isnan(ratio), np.inf, ratio)
    if not np.median(ratio) > np.log(limit):
        return None
    place = int(np.argsort(ratio)[ratio.size // 2])
    return {
        "found": float(product[place]),
        "where_m": float(gas.path_distance.values[place]),
        "stated": float(pressure[place]),
    }
