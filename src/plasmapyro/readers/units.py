"""Units a laboratory writes, and what they are in SI."""

import re

from plasmapyro.contracts import VARIABLES
from plasmapyro.tables import rows

REGISTER = rows("readers/units.csv")
TO_SI = {  # SI unit -> {unit as written, normalised: factor}
    si: {row["unit"]: float(row["factor"]) for row in REGISTER if row["in SI"] == si}
    for si in dict.fromkeys(row["in SI"] for row in REGISTER)
}
DIRECT = re.compile(r"(?<=[AV])[ _]?DC$")  # volts and amperes of direct current, as multimeters write them
WORDS = {  # units written out
    word: symbol
    for symbol, words in {
        "s": "second seconds secs sekunde sekunden secondes",
        "ms": "millisecond milliseconds",
        "A": "amp amps ampere amperes",
        "V": "volt volts",
    }.items()
    for word in words.split()
}
RADIANCE = re.compile(r"[mu]?W(?: (?:[mc]?m2|sr|[nu]?m)){3}")  # once its powers and signs are plain
OFFSET = {row["unit"]: float(row["added"]) for row in REGISTER if row["added"]}  # added after the factor


def normalised(unit):
    """A unit with micro signs, powers and dots written in one way."""
    unit = unit.strip().translate(str.maketrans("\u00b5\u03bc\u00b9\u00b2\u207b", "uu12-"))
    unit = WORDS.get(unit.lower(), DIRECT.sub("", unit))
    unit = unit.replace("^", "").replace("\u00b7", " ").replace("*", " ")
    plain = " ".join(re.findall(r"[A-Za-z]+2?", unit.replace("-1", "").replace("-2", "2")))
    if RADIANCE.fullmatch(plain):  # per area, angle and wavelength, in whatever order
        power, *per = plain.split()
        unit = "/".join([power, *sorted(per, key=lambda word: (word[-1] != "2", word != "sr"))])
    return unit


def factor(unit, name):
    """Factor from `unit` to the SI unit of the variable `name`; None if that is not a unit of it."""
    return TO_SI[VARIABLES[name].units].get(normalised(unit))


def is_unit(word):
    """Whether a word is a unit of anything."""
    return any(normalised(word) in known for known in TO_SI.values()) and word != "1"


def is_ratio(name):
    """Whether the variable `name` needs no unit."""
    return VARIABLES[name].units == "1"


def is_current(name):
    """Whether `name` is a variable of the register that is measured in amperes."""
    return name in VARIABLES and VARIABLES[name].units == "A"


def offset(unit):
    """What is added to a value in `unit`, after the factor, to be in SI."""
    return OFFSET.get(normalised(unit), 0.0)


def known(name):
    """The units accepted for a variable, as words."""
    words = ", ".join(TO_SI[VARIABLES[name].units])
    lamp = " (without sr it is an irradiance: divide by pi and multiply by the reflectance of the diffuser)"
    return words + (lamp if name == "spectral_radiance" else "")
