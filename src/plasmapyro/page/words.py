"""Numbers and user text as HTML: escaped, rounded to what they are worth, without folders of a machine."""

import html
import math
import re
from pathlib import PurePosixPath, PureWindowsPath

DASH = "–"
MINUS = "−"
# A folder of a machine: a drive or a root, at least two levels deep.
FOLDER = re.compile(r"(?<![\w/.:])(?:[A-Za-z]:\\|\\\\|/|~/)(?:[^\s/\\<>\"'|,;]+[/\\])+[^\s/\\<>\"'|,;]*")


def text(value):
    """User text for HTML: escaped, and folders cut down to the name of the file."""
    return html.escape(without_folders(str(value)), quote=True)


def without_folders(words):
    """Words with each folder of a machine cut down to the name of its file."""
    return FOLDER.sub(lambda found: file_name(found.group()), words)


def for_figures(value):
    """A report whose texts may go into figures: no folders, no dollar that would start a formula."""
    if isinstance(value, dict):
        return {name: for_figures(one) for name, one in value.items()}
    if isinstance(value, list):
        return [for_figures(one) for one in value]
    return without_folders(value).replace("$", r"\$") if isinstance(value, str) else value


def file_name(path):
    """Last part of a path of either kind."""
    return PureWindowsPath(PurePosixPath(path).name).name or DASH


def number(value, digits=3):
    """A number with `digits` significant digits; a dash for None and NaN."""
    if value is None or not math.isfinite(value):
        return DASH
    rounded = f"{value:.{digits}g}"
    if "e" in rounded:
        mantissa, exponent = rounded.split("e")
        return f"{mantissa.replace('-', MINUS)}·10<sup>{str(int(exponent)).replace('-', MINUS)}</sup>"
    return rounded.replace("-", MINUS)


def with_error(value, error, unit=""):
    """Value and standard error to the error's two digits."""
    if value is None or not math.isfinite(value):
        return DASH
    if error is None or not math.isfinite(error) or error <= 0:
        return f"{number(value)}{_unit(unit)}"
    places = max(0, 1 - math.floor(math.log10(error)))
    if places > 4 or abs(value) >= 1e5:
        return f"{number(value)} ± {number(error, 2)}{_unit(unit)}"
    shown = f"{value:.{places}f} ± {error:.{places}f}".replace("-", MINUS)
    return f"{shown}{_unit(unit)}"


def kelvin(value, signed=True):
    """A temperature difference [K], with its sign unless only the size counts."""
    if value is None or not math.isfinite(value):
        return DASH
    digits = 0 if abs(value) >= 10 else 1
    shown = f"{value:+.{digits}f}" if signed else f"{abs(value):.{digits}f}"
    return "0 K" if float(shown) == 0 else f"{shown.replace('-', MINUS)} K"


def with_unit(value, unit, digits=2):
    """A number and its unit."""
    return f"{number(value, digits)}{_unit(unit)}"


def probability(value):
    """A probability as words would have it."""
    if value is None or not math.isfinite(value):
        return DASH
    if 0 < value < 1e-4:
        return "< 0.0001"
    return f"{value:.2g}" if value < 0.01 else f"{value:.2f}"


def _unit(unit):
    if unit in ("", "1"):
        return ""
    # A unit such as 0.01 is a factor.
    return f" × {unit}" if re.fullmatch(r"[\d.]+", unit) else f" {text(unit)}"
