"""Values of the configuration in SI: the unit stands in the key."""

import numpy as np

# Ending of a key -> factor; of two that fit the longer counts. What ends otherwise has no unit, or an SI one.
FACTORS = {
    "_kw_m2": 1e3,
    "_kw": 1e3,
    "_a": 1,
    "_mbar": 100.0,
    "_pa": 1,
    "_g_s": 1e-3,
    "_khz": 1e3,
    "_hz": 1,
    "_a_per_root_hz": 1,
    "_m_s": 1,
    "_per_s": 1,
    "_s": 1,
    "_k": 1,
    "_deg": np.pi / 180,
    "_pixels": 1,
    "_mm": 1e-3,
    "_mm2": 1e-6,
    "_m2_sr": 1,
    "_um": 1e-6,
    "_per_um": 1e6,
    "_nm": 1e-9,
}
SHARES = {"": "", "1": "", "0.1": " tenths", "0.01": " %"}  # units that are numbers, in words
ENDINGS = sorted(FACTORS, key=len, reverse=True)


def behind(unit):
    """What follows a number of some unit, with the space between: "", " %", " nm"."""
    return SHARES.get(unit, f" {unit}")


def in_si(keys):
    """Settings with their values in SI and their names without the unit.

    Parameters
    ----------
    keys : mapping
        Of the configuration; numbers, and lists of numbers, are converted, all else stays. A mapping is a
        measurement: its `value` and `uncertainty` have the unit of its key, all else that of its own.

    Examples
    --------
    >>> in_si({"numerical_power_kw": 90, "coil_positions_mm": [127, 177], "points": 250})
    {'numerical_power': 90000.0, 'coil_positions': [0.127, 0.177], 'points': 250}
    """
    return dict(_in_si(key, value) for key, value in keys.items())


def _in_si(key, value):
    for ending in ENDINGS:
        if key.endswith(ending):
            factor = FACTORS[ending]
            name = key.removesuffix(ending)
            if isinstance(value, dict):
                own = {one: value[one] * factor for one in ("value", "uncertainty")}
                return name, in_si(value) | own
            return name, [each * factor for each in value] if isinstance(value, list) else value * factor
    return key, value


def steps(first, last, step):
    """Evenly spaced values from `first` to `last`, both included: the keys [first, last, step].

    Examples
    --------
    >>> steps(500, 520, 10)
    array([500., 510., 520.])
    """
    return np.arange(first, last + step / 2, step)
