"""What the paper says of the plasma along the line of sight (sec. 4.1)."""

import numpy as np

from plasmapyro.claims.analysis import last_above
from plasmapyro.claims.claim import claim
from plasmapyro.conditions import POWER, number


def flow_claims(lines):
    """Claims on the sight lines, of rising power."""
    hottest = np.array([float(line.temperature.max()) for line in lines])
    rise = np.array([_first_distance(line, 0.9) for line in lines])
    edge = [last_above(line.path_distance.values, line.temperature.values, 400.0) for line in lines]
    beyond = max(float(np.interp(0.15, line.path_distance, line.temperature)) for line in lines)
    inside = max(_pressure_spread(line) for line in lines)
    return [
        claim("domain_exit", 1e3 * lines[0].attrs["exit_distance"]),
        claim("core_temperature_lowest_power", hottest[0], power=number(lines[0], POWER) / 1e3),
        claim("core_temperature_highest_power", hottest[-1], power=number(lines[-1], POWER) / 1e3),
        claim("boundary_layer", 1e3 * np.median(rise)),
        claim("core_extent", 1e3 * np.median(edge)),
        claim("cold_outside", beyond),
        claim("pressure_uniform", 100 * inside),
    ]


def _first_distance(line, share):
    temperature = line.temperature.values
    index = int(np.argmax(temperature >= share * temperature.max()))
    pair = slice(index - 1, index + 1)
    return np.interp(share * temperature.max(), temperature[pair], line.path_distance.values[pair])


def _pressure_spread(line):
    pressure = line.pressure.values[line.path_distance.values <= line.attrs["exit_distance"]]
    return float(np.ptp(pressure) / pressure[-1])
