"""Text tables with a header: columns found by name, units undone."""

import csv
import re

import numpy as np

from plasmapyro.readers import units
from plasmapyro.readers.text import MISSING, Refusal, fault, number, quote, read_lines, refuse, require_end

LARGEST = 96_000_000  # [byte] of one table
HEADER_LINES = 200  # a preamble is shorter than this
MOST_CELLS = 50_000_000
DELIMITERS = {"tab": "\t", ";": ";", ",": ",", "|": "|", "space": " "}
REPORTED = 10  # bad cells named before the rest is only counted
IN_BRACKETS = re.compile(r"^(.*?)\s*[\[(]([^\[\]()]*)[\])]\s*$")
THOUSANDS = re.compile(r"[+-]?\d{1,3},\d{3}", re.ASCII)


class Column:
    """What the description says about one column: its name in the file, its unit, a scale."""

    def __init__(self, name, section):
        self.name = name
        self.header = section.text("name", needed=True)
        self.unit = section.text("unit")
        self.scale = section.number("scale", 1.0)
        if self.scale == 0:
            section.blame("scale", "must not be 0", "remove it or correct it")
        if self.unit is not None and units.factor(self.unit, name) is None:
            section.blame(
                "unit", f"{quote(self.unit)} is not a unit of {name}", f"write one of {units.known(name)}"
            )
            self.unit = None
        section.close()


def wanted(section, names):
    """Columns (name -> `Column`) described by the sub-section 'columns'; faults are noted."""
    listing = section.section("columns")
    found = {name: Column(name, listing.section(name)) for name in names if listing.raw(name) is not None}
    for name in names:
        listing.used.add(name)
    listing.close()
    return found


def to_si(path, column, values, stated, line=None):
    """Values of a column in SI; `stated` is the unit the file itself gives, or None."""
    if stated and units.factor(stated, column.name) is None:
        if column.unit is None:
            refuse(
                path,
                f"column {quote(column.header)} is in {quote(stated)}, which is no unit of {column.name}",
                f"state its `unit` in test.yaml: {units.known(column.name)}",
                line,
            )
        stated = None
    unit = column.unit or stated
    if unit is None:
        refuse(
            path,
            f"the unit of column {quote(column.header)} is not known",
            f"state its `unit` in test.yaml: {units.known(column.name)}",
            line,
        )
    if stated and column.unit and _conversion(stated, column) != _conversion(column.unit, column):
        refuse(
            path,
            f"column {quote(column.header)} says {quote(stated)}, test.yaml says {quote(column.unit)}",
            "correct the one that is wrong",
            line,
        )
    return values * (units.factor(unit, column.name) * column.scale) + units.offset(unit)


def _conversion(unit, column):
    return units.factor(unit, column.name), units.offset(unit)


def read_table(path, columns, delimiter=None, decimal=None):
    """Columns of a text table in SI.

    Parameters
    ----------
    path : path
    columns : mapping of name -> `Column`
        Header cells may carry the unit in brackets: 'Time [ms]', 'S1 (nA)'.
    delimiter : key of `DELIMITERS`, or None to find it from the header
    decimal : '.' or ',', or None to find it from the cells

    Returns
    -------
    dict of name -> (N,) ndarray, NaN where a cell says so or is empty

    Raises
    ------
    Refusal
        One sentence per fault, with the line.
    """
    lines, ended = read_lines(path, LARGEST)
    require_end(path, lines, ended)
    start, mark, places, stated = _header(path, lines, columns, delimiter)
    width, cells, numbers = places.pop("width"), {name: [] for name in columns}, []
    faults = []
    for index in range(start + 1, len(lines)):
        if not lines[index].strip():
            continue
        row = split(lines[index], mark)
        if len(row) != width:
            faults.append(
                fault(
                    path, f"{len(row)} cells, the header has {width}", "restore or remove the line", index + 1
                )
            )
            continue
        numbers.append(index + 1)
        for name, place in places.items():
            cells[name].append(row[place])
    if not numbers and not faults:
        refuse(path, "holds a header and no data", "export the data again", start + 1)
    decimal = decimal or _decimal(path, mark, cells, numbers)
    result = {}
    for name, words in cells.items():
        values = [number(word, decimal) for word in words]
        faults += [
            fault(
                path,
                f"{quote(words[i])} in column {quote(columns[name].header)} is not a number",
                "correct it, or leave the cell empty if the sample is missing",
                numbers[i],
            )
            for i, value in enumerate(values)
            if value is None
        ]
        if not faults:
            result[name] = to_si(path, columns[name], np.array(values, dtype=float), stated[name], start + 1)
    if faults:
        more = [f"{path}: {len(faults) - REPORTED} more faults like these"] if len(faults) > REPORTED else []
        raise Refusal(faults[:REPORTED] + more)
    return result


def split(line, mark):
    """Cells of one line; quotes are removed, a final empty cell is dropped."""
    try:
        cells = line.split() if mark == " " else next(csv.reader([line], delimiter=mark))
    except csv.Error:
        cells = line.split(mark)
    cells = [cell.strip() for cell in cells]
    return cells[:-1] if len(cells) > 1 and cells[-1] == "" and line.rstrip().endswith(mark) else cells


def _header(path, lines, columns, delimiter):
    """Index of the header line, its delimiter, the place of each column, the unit each header gives."""
    marks = [DELIMITERS[delimiter]] if delimiter else list(DELIMITERS.values())
    best, best_line = set(), None
    for index, line in enumerate(lines[:HEADER_LINES]):
        for mark in marks:
            cells = split(line, mark)
            places, stated = {}, {}
            for name, column in columns.items():
                hits = [
                    (place, unit)
                    for place, cell in enumerate(cells)
                    for label, unit in [_label(cell)]
                    if column.header in (cell, label)
                ]
                if len(hits) > 1:
                    refuse(
                        path,
                        f"column {quote(column.header)} stands {len(hits)} times in the header",
                        "rename or remove one",
                        index + 1,
                    )
                if hits:
                    places[name], stated[name] = hits[0]
            if len(places) == len(columns):
                return index, mark, {**places, "width": len(cells)}, stated
            if len(places) > len(best):
                best, best_line = set(places), index + 1
    absent = [quote(column.header) for name, column in columns.items() if name not in best]
    refuse(
        path,
        f"no column {', '.join(absent)} in the header",
        "write the names in test.yaml as they stand in the file, or name the `delimiter`",
        best_line,
    )


def _label(cell):
    match = IN_BRACKETS.match(cell)
    return (match.group(1).strip(), match.group(2).strip()) if match else (cell, None)


def _decimal(path, mark, cells, numbers):
    """The decimal sign of the cells; refused where they leave it open."""
    commas = points = doubtful = 0
    for words in cells.values():
        for word in words:
            if word.lower() not in MISSING:
                commas += "," in word
                points += "." in word
                doubtful += THOUSANDS.fullmatch(word) is not None
    if commas and points and mark != ",":
        refuse(
            path,
            "numbers with decimal comma and with decimal point are mixed",
            "export with one decimal sign, or state `decimal` in test.yaml",
            numbers[0],
        )
    if commas and doubtful == commas:
        refuse(
            path,
            "every comma is followed by three digits: decimals or thousands?",
            "state `decimal` in test.yaml",
            numbers[0],
        )
    return "," if commas and not points else "."


def read_matrix(path, delimiter=None, decimal=None):
    """A table of spectra: first header cell anything, then wavelengths; each row a time and its values.

    Parameters
    ----------
    path, delimiter, decimal : as in `read_table`

    Returns
    -------
    (time, wavelength, values)
        (N,), (W,) and (N, W) arrays in the units of the file; NaN for missing values.

    Raises
    ------
    Refusal
        As `read_table`; also if a header cell is no number or a spectrum has no time.
    """
    lines, ended = read_lines(path, LARGEST)
    require_end(path, lines, ended)
    rows = [(i, line) for i, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(rows) < 2:
        refuse(path, "holds no spectrum", "it needs a header with wavelengths and a row per spectrum")
    mark = DELIMITERS[delimiter] if delimiter else max(DELIMITERS.values(), key=rows[0][1].count)
    header = split(rows[0][1], mark)
    cells = {line: split(words, mark) for line, words in rows[1:]}
    if len(header) < 3 or len(header) * len(cells) > MOST_CELLS:
        refuse(
            path,
            f"{len(cells)} spectra of {len(header) - 1} pixels",
            f"a spectrum has 2 pixels or more, a file at most {MOST_CELLS} values; or name the `delimiter`",
            rows[0][0],
        )
    ragged = [line for line, row in cells.items() if len(row) != len(header)]
    if ragged:
        refuse(
            path,
            f"{len(cells[ragged[0]])} cells, the header has {len(header)}",
            "restore or remove the line",
            ragged[0],
        )
    listing = {rows[0][0]: header[1:], **cells}
    decimal = decimal or _decimal(path, mark, listing, [rows[0][0]])
    numbers = {}
    for line, row in listing.items():
        values = [number(word, decimal) for word in row]
        if None in values:
            refuse(path, f"{quote(row[values.index(None)])} is not a number", "correct it", line)
        numbers[line] = np.array(values)
        row.clear()
    wavelength = numbers.pop(rows[0][0])
    if np.isnan(wavelength).any():
        refuse(path, "a wavelength is missing in the header", "every column needs one", rows[0][0])
    table = np.array(list(numbers.values()))
    return table[:, 0], wavelength, table[:, 1:]
