"""Plain tables: scattered points, states along a path, and the output of one-dimensional solvers."""

import csv
import re

import numpy as np

from plasmapyro.cfd.grid import Zone
from plasmapyro.readers.text import quote, read_lines, refuse

LARGEST = 1_000_000_000  # [byte]
MARKS = (",", ";", "\t")
RULE = re.compile(r"^\s*-{3,}")


def read(path):
    """One zone without cells from a table with a header, or from lines 'key: value unit'.

    Columns are separated by commas, semicolons, tabs or, if the header has none of these, by two spaces or
    more; rules of hyphens and repeated headers are skipped. Columns that hold words are left out; asking for
    one names the first word. Refusal: no table, or rows that have not as many cells as the header.
    """
    lines, _ = read_lines(path, LARGEST)
    rows = [
        (number, line.strip())
        for number, line in enumerate(lines, 1)
        if line.strip() and not line.lstrip().startswith("#") and not RULE.match(line)
    ]
    if not rows:
        refuse(path, "holds no table", "it needs a header with names and a row per point")
    keys = [_key(line) for _, line in rows]
    if all(keys):
        return [_keys(rows, keys)]
    head = rows[0][1]
    mark = max(MARKS, key=head.count) if any(mark in head for mark in MARKS) else None
    names = _cells(path, rows[0], mark)
    cells = [(row[0], _cells(path, row, mark)) for row in rows[1:] if row[1] != head]
    if not cells:
        refuse(path, "holds a header and no row", "it needs a row per point")
    for number, words in cells:
        if len(words) != len(names):
            refuse(
                path,
                f"{len(words)} cells, the header has {len(names)}",
                "the file may be cut off; restore or remove the line",
                number,
            )
    zone = Zone("table", {})
    for k, name in enumerate(names):
        column = [words[k] for _, words in cells]
        try:
            zone.point_data[name] = np.array(column, dtype=float)
        except ValueError:
            number, word = next((n, words[k]) for n, words in cells if not _is_number(words[k]))
            zone.words[name] = f"line {number}: {quote(word)} in column {quote(name)} is not a number"
    return [zone]


def _cells(path, row, mark):
    number, line = row
    if mark:
        try:
            return [word.strip() for word in next(csv.reader([line], delimiter=mark, skipinitialspace=True))]
        except csv.Error as reason:
            refuse(path, f"cannot be read as a table ({reason})", "export it again", number)
    # Titles with units may stand one space apart: 'Total Temp [K] Total pressure [kPa]'.
    return [word for part in re.split(r"\s{2,}", line) for word in re.split(r"(?<=\])\s+", part)]


def _key(line):
    """Name and word of a line 'name: word' or 'name: word unit', or None."""
    name, _, rest = line.partition(":")
    words = rest.split()
    return (
        (name.strip(), words[0])
        if name.strip() and not set(name) & set(",;") and 0 < len(words) < 3
        else None
    )


def _keys(rows, keys):
    zone = Zone("state", {})
    for (number, _), (name, word) in zip(rows, keys, strict=True):
        if _is_number(word):
            zone.point_data[name] = np.array([float(word)])
        else:
            zone.words[name] = f"line {number}: {quote(word)} of {quote(name)} is not a number"
    return zone


def _is_number(word):
    try:
        float(word)
    except ValueError:
        return False
    return True
