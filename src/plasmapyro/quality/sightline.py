"""Rules for a sight line: lengths and densities that no wind tunnel has."""

import numpy as np

from plasmapyro.constants import BOLTZMANN
from plasmapyro.quality.rule import rule


@rule(
    "path_length",
    looks_at="length of the sight line",
    needs=("sightline",),
    limit=1e-2,
    unit="m",
    reason="plasma jets that heat a sample are 2 cm to some metres across: 10 mm to 10 m",
    says="the path through the gas is {length:.3g} m long",
    remedy="check `length_unit` (mm taken for m, or m for mm)",
)
def path_length(case, limit):
    length = float(np.ptp(case.sightline.path_distance.values))
    return None if limit <= length <= 1e3 * limit else {"length": length}


@rule(
    "ideal_gas",
    looks_at="n k T over the pressure, where the path is",
    needs=("sightline",),
    limit=1.5,
    unit="1",
    reason="the gas is ideal; two temperatures and species left out cost less than a half",
    says="the number densities give n k T = {found:.3g} Pa at {where_m:.3g} m, the pressure there is"
    " {stated:.3g} Pa",
    remedy="check the unit of the densities (cm-3 taken for m-3 is a factor of a million) or of the pressure",
)
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
