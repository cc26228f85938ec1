"""What the paper says of the plasma along the line of sight (sec. 4.1)."""

import numpy as np

from plasmapyro.claims.claim import Claim
from plasmapyro.conditions import POWER, number


def flow_claims(sightlines):
    """Claims on the sight lines.

    Parameters
    ----------
    sightlines : list of Dataset, contract 'sightline', rising power

    Returns
    -------
    list of Claim
    """
    lines = sightlines
    hottest = np.array([float(line.temperature.max()) for line in lines])
    rise = np.array([_first_distance(line, 0.9) for line in lines])
    edge = np.array([_last_distance_above(line, 400.0) for line in lines])
    beyond = max(float(np.interp(0.15, line.path_distance, line.temperature)) for line in lines)
    inside = max(_pressure_spread(line) for line in lines)
    return [
        Claim(
            "domain_exit",
            "4.1",
            "The line of sight leaves the simulated domain at 278 mm.",
            1e3 * lines[0].attrs["exit_distance"],
            "mm",
            278,
            279,
            "160 mm over the sine of 35 degrees is 278.95 mm; the paper cuts the digits off.",
        ),
        Claim(
            "core_temperature_lowest_power",
            "1, 4.1",
            "The jet reaches 5000 to 10000 K: highest temperature on the line of sight, lowest power.",
            hottest[0],
            "K",
            5000,
            10000,
            f"At {number(lines[0], POWER) / 1e3:g} kW; LTE flow, probe wall at 350 K.",
        ),
        Claim(
            "core_temperature_highest_power",
            "1, 4.1",
            "The same at the highest power.",
            hottest[-1],
            "K",
            5000,
            10000,
            f"At {number(lines[-1], POWER) / 1e3:g} kW.",
        ),
        Claim(
            "boundary_layer",
            "4.1",
            "The thermal boundary layer on the probe is about 5 mm thick.",
            1e3 * float(np.median(rise)),
            "mm",
            2.5,
            7.5,
            "Distance to 90 % of the highest temperature, median of the powers; 'about' read as within half.",
        ),
        Claim(
            "core_extent",
            "4.1",
            "The jet core extends about 150 mm along the line of sight.",
            1e3 * float(np.median(edge)),
            "mm",
            135,
            165,
            "Last distance above 400 K, median of the powers; 'about' read as within 10 %.",
        ),
        Claim(
            "cold_outside",
            "4.1",
            "The temperature has dropped to 350 K beyond 150 mm.",
            beyond,
            "K",
            345,
            400,
            "Highest temperature of all powers at 150 mm; the hot edge widens with power.",
        ),
        Claim(
            "pressure_uniform",
            "4.1",
            "The pressure is fairly uniform in the test chamber.",
            100 * inside,
            "%",
            0,
            2,
            "Largest deviation from the chamber pressure along the line of sight, inside the domain.",
        ),
    ]


def _first_distance(line, share):
    temperature = line.temperature.values
    index = int(np.argmax(temperature >= share * temperature.max()))
    pair = slice(index - 1, index + 1)
    return np.interp(share * temperature.max(), temperature[pair], line.path_distance.values[pair])


def _last_distance_above(line, level):
    temperature, distance = line.temperature.values, line.path_distance.values
    last = int(np.nonzero(temperature > level)[0][-1])
    return np.interp(-level, -temperature[last : last + 2], distance[last : last + 2])


def _pressure_spread(line):
    pressure = line.pressure.values[line.path_distance.values <= line.attrs["exit_distance"]]
    return float(np.ptp(pressure) / pressure[-1])
