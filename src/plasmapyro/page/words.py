"""Numbers and user text for the page: rounded to what they are worth, without folders of a machine."""

import math
import re
from pathlib import PurePosixPath, PureWindowsPath

from plasmapyro.quantities import behind

DASH = "–"
MINUS = "−"
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
LEAST = 1e-4  # probabilities below are not written out
# A folder of a machine: a drive or a root, at least two levels deep.
FOLDER = re.compile(r"(?<![\w/.:])(?:[A-Za-z]:\\|\\\\|/|~/)(?:[^\s/\\<>\"'|,;]+[/\\])+[^\s/\\<>\"'|,;]*")


def without_folders(value):
    """A report whose texts, keys too, hold no folder: each is cut down to the name of its file."""
    return _each(value, lambda text: FOLDER.sub(lambda found: file_name(found.group()), text))


def for_figures(value):
    """A report whose texts, keys too, may go into figures: no dollar that would start a formula."""
    return _each(value, lambda text: text.replace("$", r"\$"))


def _each(value, change):
    """A report with a change of each of its texts."""
    if isinstance(value, dict):
        return {_each(name, change): _each(entry, change) for name, entry in value.items()}
    if isinstance(value, list):
        return [_each(entry, change) for entry in value]
    return change(value) if isinstance(value, str) else value


def file_name(path):
    """Last part of a path of either kind."""
    return PureWindowsPath(PurePosixPath(path).name).name or DASH


def number(value, digits=3):
    """A number with `digits` significant digits; a dash for None and NaN."""
    if value is None or not math.isfinite(value):
        return DASH
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    power = f"·10{str(int(exponent)).translate(RAISED)}" if exponent else ""
    return mantissa.replace("-", MINUS) + power


def with_error(value, error, unit=""):
    """Value and standard error to the error's two digits."""
    if value is None or not math.isfinite(value):
        return DASH
    if error is None or not math.isfinite(error) or error <= 0:
        return with_unit(value, unit, 3)
    places = max(0, 1 - math.floor(math.log10(error)))
    if places > 4 or abs(value) >= 1e5:
        return f"{number(value)} ± {number(error, 2)}{behind(unit)}"
    shown = f"{value:.{places}f} ± {error:.{places}f}".replace("-", MINUS)
    return f"{shown}{behind(unit)}"


def kelvin(value, signed=True):
    """A temperature difference [K], with its sign unless only the size counts."""
    if value is None or not math.isfinite(value):
        return DASH
    digits = 0 if abs(value) >= 10 else 1
    shown = f"{value:+.{digits}f}" if signed else f"{abs(value):.{digits}f}"
    return "0 K" if float(shown) == 0 else f"{shown.replace('-', MINUS)} K"


def with_unit(value, unit, digits=2):
    """A number and its unit."""
    return f"{number(value, digits)}{behind(unit)}"


def probability(value):
    """A probability as words would have it."""
    if value is None or not math.isfinite(value):
        return DASH
    if 0 < value < LEAST:
        return f"< {LEAST:g}"
    return f"{value:.2g}" if value < 0.01 else f"{value:.2f}"
