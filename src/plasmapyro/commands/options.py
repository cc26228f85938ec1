"""Options of the commands, from the table options.csv, and the kinds of numbers that they take.

A row per option, of one command or of several between bars: `kind` is the name of a function of this module
or of Python, `flag`, `append`, `once` of what must not stand twice, or the words that may be chosen, between
bars; `default` may be `required`; a `metavar` of several words takes as many values, one that ends in ... any
number, in [] also none. Two words are a range that rises, but LEAST MOST, which may be a point. Texts of help
stand in words/.
"""

import argparse
import csv
from inspect import signature
from math import inf
from pathlib import Path

HERE = Path(__file__).parent
POINT = ["LEAST", "MOST"]


class Once(argparse.Action):
    """What keeps the value of an option, and refuses a second one: it would silently take its place."""

    def __call__(self, parser, namespace, values, option_string=None):
        if getattr(namespace, self.dest) is not self.default:
            parser.error(f"{option_string} is given twice: one value only")
        setattr(namespace, self.dest, values)


class Rising(argparse.Action):
    """What keeps a range, and refuses one whose end is not above its begin."""

    def __call__(self, parser, namespace, values, option_string=None):
        try:
            setattr(namespace, self.dest, _rising(values))
        except argparse.ArgumentTypeError as fault:
            parser.error(f"{option_string} {fault}")


def _rising(values):
    if len(values) != 2 or not values[0] < values[1]:
        got = " ".join(f"{value:g}" for value in values)
        raise argparse.ArgumentTypeError(f"must be two numbers that rise; got {got}")
    return values


def words(name):
    """Description of a command and what its help ends with."""
    text = (HERE / f"words/{name}.txt").read_text(encoding="utf-8")
    return (part.strip("\n") for part in text.split("\n----\n"))


def add(command, name):
    """Add the options of a command to its parser."""
    groups = {"": command}
    for row in _rows(name):
        group = row["group"]
        if group not in groups:
            groups[group] = command.add_argument_group(group)
        groups[group].add_argument(row["option"], **_settings(row))


def check(name, given):
    """Refuse, of values by keyword, what a command refuses as words: ValueError with the option's name."""
    for row in _rows(name):
        value = given.get(row["destination"] or row["option"].lstrip("-").replace("-", "_"))
        settings = _settings(row)
        if value is None or "action" in settings and settings["action"] is not Rising:
            continue
        several = isinstance(value, list | tuple)
        try:
            made = [settings.get("type", str)(str(one)) for one in (value if several else [value])]
            unknown = set(made) - set(settings.get("choices", made))
            if unknown:
                choices = ", ".join(settings["choices"])
                raise argparse.ArgumentTypeError(f"knows {choices}; got {', '.join(sorted(unknown))}")
            if "action" in settings:
                _rising(made)
        except (argparse.ArgumentTypeError, ValueError) as fault:
            raise ValueError(f"{row['option']} {fault}") from None


def _rows(name):
    with (HERE / "options.csv").open(encoding="utf-8", newline="") as table:
        return [row for row in csv.DictReader(table) if name in row["command"].split("|")]


def _settings(row):
    """Arguments of `add_argument` for a row of the table."""
    kind, default, metavar, text = (row[name] for name in ("kind", "default", "metavar", "help"))
    if kind == "flag":
        return {"action": "store_true", "help": text}
    found = {"help": text, "metavar": metavar or None}
    if row["destination"]:
        found["dest"] = row["destination"]
    if kind == "append":
        return found | {"action": "append", "default": []}
    if kind == "once":
        return found | {"action": Once}
    if "|" in kind:
        found["choices"] = kind.split("|")
    elif kind:
        found["type"] = KINDS[kind]
    names = metavar.strip("[].").split()
    if metavar.endswith((".", "]")):
        found |= {"nargs": "*" if metavar.startswith("[") else "+", "metavar": names[0]}
        if row["option"].startswith("-"):
            found["default"] = []
    elif len(names) > 1:
        found |= {"nargs": len(names), "metavar": tuple(names)}
        found |= {"action": Rising} if len(names) == 2 and names != POINT else {}
    if default == "required":
        return found | {"required": True}
    if default == "inf":
        return found | {"default": inf}
    if default:
        values = [found.get("type", str)(value) for value in default.split(" ")]
        found["default"] = values if len(names) > 1 else values[0]
        found["help"] += f" (default: {default})"
    return found


def told(given, *skipped):
    """The options of a command that its results tell of: not where these go, nor those `skipped`."""
    return {name: value for name, value in vars(given).items() if name not in ("run", "out", *skipped)}


def settings(given, stage):
    """Of the options of a command those that arguments by keyword of a stage are named after, in SI.

    An option that is None is left out: the stage has a default of its own, or the command names a value.
    """
    from plasmapyro.quantities import in_si  # numpy, which no help needs

    known = in_si({name: value for name, value in vars(given).items() if value is not None})
    words = [one.name for one in signature(stage).parameters.values() if one.kind is one.KEYWORD_ONLY]
    return {name: known[name] for name in words if name in known}


def _number(word, rule, holds, kind=float):
    try:
        value = kind(word)
    except ValueError:
        value = None
    if value is None or not holds(value):
        raise argparse.ArgumentTypeError(f"{rule}; got {word!r}")
    return value


def positive(word):
    """A number > 0."""
    return _number(word, "must be a number > 0", lambda value: 0 < value < inf)


def not_negative(word):
    """A number >= 0."""
    return _number(word, "must be a number >= 0", lambda value: 0 <= value < inf)


def share(word):
    """A number from 0 to 1."""
    return _number(word, "must be a number from 0 to 1", lambda value: 0 <= value <= 1)


def seed(word):
    """A seed of random numbers."""
    return _number(word, "must be a whole number >= 0", lambda value: value >= 0, int)


def _whole(low, high):
    rule = f"must be a whole number from {low} to {high}"
    return lambda word: _number(word, rule, lambda value: low <= value <= high, int)


def picture(word):
    """Name of a file for a picture."""
    if not word.endswith((".png", ".svg")):
        raise argparse.ArgumentTypeError(f"must end in .png or .svg; got {word!r}")
    return word


ENDINGS = set(".nc .csv .txt .dat .tsv .xls .xlsx .ods .json .yaml .yml .html .png .svg .pdf .md".split())


def _file(what, *own):
    """Kind of the name of a file to write, whose ending says of no other kind of file."""

    def kind(word):
        if Path(word).suffix.lower() in ENDINGS - {*own}:
            raise argparse.ArgumentTypeError(f"is {what}: name it {Path(word).stem}{own[0]}; got {word!r}")
        return word

    return kind


KINDS = {
    **{kind.__name__: kind for kind in (float, int, positive, not_negative, share, seed, picture)},
    "netcdf": _file("a netCDF file", ".nc"),
    "table": _file("a table with commas", ".csv", ".txt", ".dat"),
    "page": _file("a page of HTML", ".html"),
    "markdown": _file("a page of Markdown", ".md", ".txt"),
    "text": _file("a text file", ".txt", ".dat"),
    "count": _whole(3, 100_000),
    "points": _whole(20, 5000),
    "grid_points": _whole(1, 5_000_000),  # 2 GB of memory
}
