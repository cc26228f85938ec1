"""Units a laboratory writes, and what they are in SI."""

from plasmapyro.contracts import VARIABLES

RADIANCE = "W m-2 sr-1 m-1"
TO_SI = {  # SI unit -> {unit as written, normalised: factor}
    "s": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0},
    "A": {"A": 1.0, "mA": 1e-3, "uA": 1e-6, "nA": 1e-9, "pA": 1e-12},
    "W": {"W": 1.0, "kW": 1e3, "MW": 1e6},
    "Pa": {"Pa": 1.0, "hPa": 1e2, "mbar": 1e2, "kPa": 1e3, "bar": 1e5, "Torr": 101325 / 760},
    "kg s-1": {"kg s-1": 1.0, "kg/s": 1.0, "g s-1": 1e-3, "g/s": 1e-3, "mg/s": 1e-6, "g/min": 1e-3 / 60},
    "K": {"K": 1.0, "degC": 1.0, "C": 1.0, "\u00b0C": 1.0},
    "m": {"m": 1.0, "um": 1e-6, "nm": 1e-9, "Angstrom": 1e-10},
    "count": {"count": 1.0, "counts": 1.0},
    "1": dict.fromkeys(("1", "V", "mV", "uV", "A", "mA", "uA", "nA", "pA", "count", "counts", "W"), 1.0)
    | {"%": 0.01},  # signals of a radiometer stay in the unit of its calibration
    RADIANCE: {
        RADIANCE: 1.0,
        "W/m2/sr/m": 1.0,
        "W m-2 sr-1 nm-1": 1e9,
        "W/m2/sr/nm": 1e9,
        "W m-2 sr-1 um-1": 1e6,
        "W/m2/sr/um": 1e6,
        "mW/m2/sr/nm": 1e6,
        "W/cm2/sr/nm": 1e13,
        "W/cm2/sr/um": 1e10,
        "uW/cm2/sr/nm": 1e7,
    },
}
OFFSET = {"degC": 273.15, "C": 273.15, "\u00b0C": 273.15}  # added after the factor


def normalised(unit):
    """A unit with micro signs, powers and dots written in one way."""
    unit = unit.strip().replace("\u00b5", "u").replace("\u03bc", "u").replace("\u00b2", "2")
    return unit.replace("^", "").replace("\u00b7", " ").replace("*", " ")


def factor(unit, name):
    """Factor from `unit` to the SI unit of the variable `name`; None if that is not a unit of it."""
    return TO_SI[VARIABLES[name].units].get(normalised(unit))


def is_ratio(name):
    """Whether the variable `name` needs no unit."""
    return VARIABLES[name].units == "1"


def offset(unit):
    """What is added to a value in `unit`, after the factor, to be in SI."""
    return OFFSET.get(normalised(unit), 0.0)


def known(name):
    """The units accepted for a variable, as words."""
    return ", ".join(TO_SI[VARIABLES[name].units])
