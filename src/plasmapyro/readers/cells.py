"""Cells of a line of a table: how they are parted, and what they hold."""

import csv
import re

from plasmapyro.readers import clock, units
from plasmapyro.readers.text import GROUPED, NUMBER, ONE_GROUP, fault, missing, number

DELIMITERS = {"tab": "\t", ";": ";", ",": ",", "|": "|", "space": " ", "blanks": "  "}
IN_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]$")  # searched for after the blanks at both ends are cut off
THOUSANDS = re.compile(r"[+-]?\d{1,3},\d{3}", re.ASCII)
PARTED = re.compile(r"[+-]?\d{1,3}(?: \d{3})+(?:[.,]\d{1,40})?", re.ASCII)  # thousands between plain blanks
COMMENT = ("#", "%", "!", "//")  # a line that begins so is no data, wherever it stands
LETTERS = re.compile(r"[^\W\d_]{3}")
SUMMARY = re.compile(
    r"\W*(min(imum)?|max(imum)?|mean|average|mittel(wert)?|moyenne|std|einheit)\b", re.IGNORECASE
)


def split(line, mark):
    """Cells of one line; quotes are removed."""
    try:
        if mark == "  ":
            cells = ((cell, cell.split(" ")) for cell in re.split(r"\s{2,}", line.strip()))
            return [  # wide numbers leave one blank between them
                part
                for cell, parts in cells
                for part in (parts if None not in map(number, parts) and parts else [cell])
            ]
        if mark == " ":
            line = line.replace(" [", "[")  # a unit stays with its name
            if '"' not in line:
                return line.split()
        cells = next(csv.reader([line], delimiter=mark, skipinitialspace=mark == " "))
    except csv.Error:
        cells = line.split(mark)
    cells = [cell.strip() for cell in cells]
    if mark in "\t;|":  # where no blank parts cells
        cells = [cell.replace(" ", "\u00a0") if PARTED.fullmatch(cell) else cell for cell in cells]
    return cells


def without_empty_end(cells):
    """Cells without the empty ones at the end."""
    count = len(cells)
    while count > 1 and cells[count - 1] == "":
        count -= 1
    return cells[:count]


def is_remark(line):
    """Whether a line is no data, wherever it stands: a comment, or a smallest, largest or mean value."""
    return line.lstrip().startswith(COMMENT) or SUMMARY.match(line) is not None


def is_mark(cells, needed, width):
    """Whether cells of a line name an event ('--- injection ---', also behind its time): words, no sample.

    Of the `needed` columns of a table of so many cells at least one is a word, or absent. As many words as a
    row has cells are none: they may be the names of another table; nor is a word in a row that lacks nothing:
    it may be the reading.
    """
    words = [cell for cell in cells if not missing(cell) and not is_value(cell)]
    lost = len(cells) <= max(needed) or any(cells[place] in words for place in needed)
    plain = all(LETTERS.search(word) or not any(map(str.isdigit, word)) for word in words)
    lacking = len(words) == 1 and any(map(missing, cells))
    few = sum(map(is_value, cells)) <= 1 and (lacking or len(cells) != width)
    return lost and plain and few and any(map(LETTERS.search, words))


def is_value(word):
    """Whether a cell holds a number, a date or a time of day."""
    return clock.looks_like_stamp(word) or any(
        number(word, sign) is not None and not missing(word) for sign in ".,"
    )


def label_of(cell):
    """Name and unit of a cell of the header: 'S1 [nA]', 'S1 (nA)', 'S1 / nA', 'S1_nA'; else unit None.

    A single letter behind an underscore may be anything.
    """
    match = IN_BRACKETS.search(cell.strip())
    if match:
        return cell.strip()[: match.start()].strip(), match.group(1).strip()
    words = cell.split()
    if words[-2:-1] == ["in"] and units.is_unit(words[-1]):  # 'C1 in V'
        return " ".join(words[:-2]) or cell.strip(), words[-1]
    name, _, unit = (part.strip() for part in cell.rpartition("/"))
    last = cell.split()[-1] if cell.strip() else ""
    first, _, suffix = cell.strip().rpartition("_")
    if first and len(suffix) > 1 and units.is_unit(suffix):
        return first, suffix
    if len(last) > 1 and last != cell.strip() and "/" not in cell and units.is_unit(last):  # 'Wide nA'
        return cell.strip()[: -len(last)].strip(), last
    if not name or not units.is_unit(unit) or ("/" in last and units.is_unit(last)):  # 'flow g/s'
        return cell, None
    return name, unit


def units_in(cells):
    """As `units_below`, for a row in which other words stand beside two units or more."""
    found = [cell.strip().strip("[]()").strip() for cell in cells]
    telling = [word if len(word) > 1 and units.is_unit(word) else None for word in found]
    return units_below(cells) or (telling if sum(map(bool, telling)) > 1 else None)


def units_below(cells):
    """The units (or None) that a row below the names holds: 's', '[nA]', nothing else; None if it is none."""
    found = [cell.strip().strip("[]()").strip() for cell in cells]
    if not any(found) or not all(word in ("", "-") or units.is_unit(word) for word in found):
        return None
    return [word if units.is_unit(word) else None for word in found]


def decimal_sign(path, mark, cells, numbers):
    """The decimal sign of the cells (name -> words), and what leaves it open.

    Where a cell shows that one sign parts thousands ('1,234.5', '1,234,567') it does so in all.
    """
    words = [word for row in cells.values() for word in row]
    plain = [word for word in words if NUMBER.fullmatch(word)]  # most; in groups where others are, at most
    known = [
        word
        for word in words
        if not NUMBER.fullmatch(word) and not missing(word) and not clock.looks_like_stamp(word)
    ]
    shown = [[sign for sign in ".," if GROUPED[sign].fullmatch(word)] for word in known]
    parted = {signs[0] for signs in shown if len(signs) == 1}
    commas = doubtful = 0
    points = 0 if parted else sum("." in word for word in plain)
    also = [(word, []) for word in plain] if parted else []
    for word, signs in (*zip(known, shown, strict=True), *also):
        one = next((sign for sign in parted if ONE_GROUP[sign].fullmatch(word)), None)
        sign = signs[0] if len(signs) == 1 else one if len(parted) == 1 else None
        commas += "," in word if sign is None else sign == ","
        points += "." in word if sign is None else sign == "."
        doubtful += sign is None and THOUSANDS.fullmatch(word) is not None
    if commas and points and mark != ",":
        return None, [
            fault(
                path,
                "numbers with decimal comma and with decimal point are mixed",
                "export with one decimal sign, or state `decimal` in test.yaml",
                numbers[0],
            )
        ]
    if doubtful and doubtful == commas:
        return None, [
            fault(
                path,
                "every comma is followed by three digits: decimals or thousands?",
                "state `decimal` in test.yaml",
                numbers[0],
            )
        ]
    return "," if commas and not points else ".", []
