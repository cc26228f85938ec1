"""The file test.yaml: what the raw files of a test folder mean."""

import json
from difflib import get_close_matches
from pathlib import PurePath

import numpy as np
import yaml

from plasmapyro.foreign import Strict, told
from plasmapyro.readers.text import fault, number, quote, read_lines, refuse

GUIDE = "compare with docs/your-own-data.md"
LARGEST = 64_000  # [byte] a description is a page of text
LONGEST_NAME = 200
MOST_FILES = 1000  # of one record
LEAST_NM = 100  # of an emittance over wavelength: below it a table is in um


class _Loader(Strict, yaml.BaseLoader):
    """Words, lists and mappings only.

    BaseLoader builds nothing but str, list and dict, and so leaves '10:00:00' the words they are, which
    YAML 1.1 would turn into the number 36000.
    """


def load(path):
    """Mapping of words (every scalar is a str) of a test.yaml.

    Refusal: not text, not YAML, not a mapping; the message names the line.
    """
    lines, _ = read_lines(path, LARGEST)
    try:
        values = yaml.load("\n".join(lines), Loader=_Loader)  # noqa: S506  a BaseLoader: words only
    except yaml.MarkedYAMLError as reason:
        line = reason.problem_mark.line + 1 if reason.problem_mark else None
        refuse(path, f"not readable as YAML ({told(reason.problem)})", GUIDE, line)
    except (yaml.YAMLError, ValueError) as reason:
        refuse(path, f"not readable as YAML ({told(reason)})", GUIDE)
    if not isinstance(values, dict):
        refuse(path, "must hold keys and values", GUIDE)
    return values


def nearly(path):
    """Name of the file beside a path that is not there which was meant by it, or None: other letters, `.yml`,
    or the second ending that an editor adds."""
    known = {path.name.lower(), path.with_suffix(".yml").name.lower()}
    names = sorted(one.name for one in path.parent.iterdir() if one.is_file())
    return next((one for one in names if one.lower().removesuffix(".txt") in known), None)


def _inside(name):
    """Whether a name is short, printable, relative, and does not lead out of its folder."""
    path = PurePath(name)
    plain = 0 < len(name) <= LONGEST_NAME and name.isprintable()
    return plain and not path.is_absolute() and ".." not in path.parts


class Section:
    """One level of the description; every fault goes to a common list, and a good value comes out."""

    def __init__(self, values, path, where, faults):
        self.path, self.where, self.faults = path, where, faults
        self.values = values if isinstance(values, dict) else {}
        self.used = set()
        if not isinstance(values, dict):
            self.blame("", f"must hold keys and values; got {quote(values)}", "indent its keys below it")

    def __contains__(self, key):
        return key in self.values

    def blame(self, key, what, remedy):
        """Note a fault of a key."""
        name = ".".join(part for part in (self.where, key) if part)
        self.faults.append(fault(self.path, f"{name} {what}", remedy))

    def raw(self, key, needed=False):
        """The value as it stands, or None."""
        self.used.add(key)
        if needed and key not in self.values:
            self.blame(key, "is missing", "add it")
        return self.values.get(key)

    def text(self, key, default=None, choices=None, needed=False):
        """A word; one of `choices` if given."""
        value = self.raw(key, needed)
        if value is None:
            return default
        if not isinstance(value, str) or (choices and value not in choices):
            rule = (
                f"must be one of {', '.join(map(repr, choices))}" if choices else "must be one word or phrase"
            )
            self.blame(key, f"{rule}; got {quote(value)}", "correct it")
            return default
        return value

    def number(self, key, default=None, above=None, needed=False):
        """A finite number, larger than `above` if given."""
        value = self.raw(key, needed)
        if value is None:
            return default
        found = number(value) if isinstance(value, str) else None
        if found is None or found != found or (above is not None and not found > above):
            rule = "must be a number" if above is None else f"must be a number > {above:g}"
            self.blame(key, f"{rule}; got {quote(value)}", "correct it")
            return default
        return found

    def numbers(self, key, count=None, kind=float, needed=False):
        """A list of numbers, of a length and rising if `count` is given; None after a fault."""
        words = self.raw(key, needed)
        if words is None:
            return None
        words = words if isinstance(words, list) else [words]
        values = [number(word) if isinstance(word, str) else None for word in words]
        wrong = not values or any(one is None or one != one or kind(one) != one for one in values)
        if wrong or (count and (len(values) != count or not (np.diff(values) > 0).all())):
            what = f"{count} rising numbers" if count else "a list of numbers"
            what = "a list of whole numbers" if kind is int else what
            self.blame(key, f"must be {what}; got {quote(words)}", "correct it")
            return None
        return [kind(one) for one in values]

    def emittance(self):
        """Attributes of `emittance`: a number, or pairs [nm, value] over wavelength; {} if absent."""
        words = self.raw("emittance")
        if words is None or isinstance(words, str):
            value = self.number("emittance")
            return {} if value is None else {"emittance": value}
        lists = [pair for pair in words if isinstance(pair, list) and len(pair) == 2]
        pairs = [[number(word) for word in pair if isinstance(word, str)] for pair in lists]
        values = np.array([pair for pair in pairs if len(pair) == 2 and None not in pair], dtype=float).T
        if len(words) < 2 or values.shape != (2, len(words)) or not (np.diff(values[0]) > 0).all():
            what = "must be a number, or pairs [nm, emittance] of rising wavelengths"
            self.blame("emittance", f"{what}; got {quote(words)}", "correct it")
            return {}
        if not ((values[1] > 0).all() and (values[1] <= 1).all()):
            self.blame("emittance", "must lie above 0 and up to 1", "state it as a fraction")
            return {}
        if values[0, 0] < LEAST_NM:
            what = f"must begin at {LEAST_NM} nm or above, not at {values[0, 0]:g}"
            self.blame("emittance", what, "state its wavelengths in nm")
            return {}
        table = {"emittance_wavelength": (values[0] * 1e-9).tolist(), "emittance_table": values[1].tolist()}
        return {"emittance": float(np.exp(np.log(values[1]).mean())), **table}

    def file(self, key, default=None, needed=False):
        """Name of a file in the folder: relative, and not leading out of it."""
        value = self.text(key, default, needed=needed)
        if value is not None and not _inside(value):
            self.blame(
                key, f"must name a file inside the test folder; got {quote(value)}", "move the file there"
            )
            return None
        return value

    def files(self, key, default=None):
        """Names of one or more files in the folder, in the order in which they are joined."""
        words = self.raw(key)
        if not isinstance(words, list):
            name = self.file(key, default)
            return [] if name is None else [name]
        if not 0 < len(words) <= MOST_FILES or not all(isinstance(word, str) for word in words):
            self.blame(key, f"must name 1 to {MOST_FILES} files; got {quote(words)}", "correct it")
            return []
        outside = [word for word in words if not _inside(word)]
        if outside or len(set(words)) < len(words):
            what = f"{quote(outside[0])} is outside the test folder" if outside else "a file stands twice"
            self.blame(key, what, "name each file of the folder once")
            return []
        return words

    def section(self, key):
        """The section below `key`."""
        where = ".".join(part for part in (self.where, key) if part)
        return Section(self.raw(key), self.path, where, self.faults)

    def close(self):
        """Note every key that nothing has asked for."""
        for key in self.values:
            if key not in self.used:
                near = get_close_matches(str(key), self.used, n=1, cutoff=0.5)
                hint = f"did you mean '{near[0]}'?" if near else f"valid here: {', '.join(sorted(self.used))}"
                self.blame(str(key)[:60], "is not a known key", hint)


def in_yaml(word):
    """A word as YAML holds it, whatever is in it."""
    return json.dumps(word, ensure_ascii=not word.isprintable())
