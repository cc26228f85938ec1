"""Text tables with a header: columns found by name, units undone."""

import logging
import re
from types import SimpleNamespace

import numpy as np

from plasmapyro.readers import clock, units
from plasmapyro.readers.cells import (
    COMMENT,
    DELIMITERS,
    decimal_sign,
    is_mark,
    is_remark,
    is_value,
    label_of,
    split,
    units_in,
    without_empty_end,
)
from plasmapyro.readers.dialects import table_lines
from plasmapyro.readers.text import (
    FILLS,
    Refusal,
    fault,
    number,
    quote,
    refuse,
    refuse_all,
    require_end,
)

LOG = logging.getLogger(__name__)

LARGEST = 96_000_000  # [byte] of one table
HEADER_LINES = 200  # a preamble is shorter than this
MOST_CELLS = 50_000_000
MARKS, SHOWN = 5, 8  # marks, and columns, that are said by their words
STACKED = 8  # lines above the data that may hold names and units
NUMBERED = re.compile(r"column [1-9]\d?")  # of a table without names
GAIN_OF = "gain of "  # a signal: key of the column that it is divided by
CLOCK, MILLISECONDS = "time of day", "milliseconds"  # keys of columns that stand beside the one of the date
LONG = 20_000  # rows, beyond which a table is first tried all at once
SIGNS = set("0123456789+-.,")
PLAIN = set("0123456789+-.,eE\n\r\t ")
FRACTION = re.compile(r",\d{1,2}(\D|$)|,\d{4}", re.ASCII)  # behind a comma that parts no thousands


class Column:
    """What the description says about one column: its name in the file, its unit, a scale, its own file."""

    def __init__(self, name, section, files=False):
        self.name = name
        self.format, self.zero, self.set_back, self.clock, self.milliseconds = None, None, False, None, None
        self.file = section.file("file") if files and name != "time" else None
        both = section.raw("name")
        if name == "time" and "format" in section and isinstance(both, list) and len(both) == 2:
            self.header, self.clock = both[0], SimpleNamespace(header=both[1])  # date and time of day
        else:
            self.header = section.text("name", needed=True)
        if name == "time" and "format" in section:
            self._stamps(section)
        self.unit = section.text("unit")
        self.scale = section.number("scale", 1.0)
        if self.scale == 0:
            section.blame("scale", "must not be 0", "remove it or correct it")
        self.gain = section.text("gain") if units.is_current(name) else None
        if self.gain and number(self.gain):
            remedy = "a gain that stays is `scale` (1/gain) with `unit: A`"
            section.blame("gain", f"names a column, and {self.gain} is a number", remedy)
            self.gain = None
        if self.unit is not None and units.factor(self.unit, name) is None:
            section.blame(
                "unit", f"{quote(self.unit)} is not a unit of {name}", f"write one of {units.known(name)}"
            )
            self.unit = None
        section.close()

    def divisor(self):
        """The column of the amplifier's gain, as a column of its own."""
        return SimpleNamespace(name="gain_correction", header=self.gain, unit="1", scale=1.0)

    def beside(self):
        """The columns that a stamp is made of besides the first, by their keys."""
        pair = {CLOCK: self.clock, MILLISECONDS: self.milliseconds}
        return {key: column for key, column in pair.items() if column}

    def stamp(self, cells):
        """One stamp of the cells of its columns (key -> word)."""
        words = f"{cells['time']} {cells[CLOCK]}" if self.clock else cells["time"]
        if self.milliseconds and (part := cells[MILLISECONDS].partition(".")[0]).isdigit():
            words += f".{part:0>3}"
        return words

    def _stamps(self, section):
        self.format = section.text("format")
        if (name := section.text("milliseconds")) is not None:
            self.milliseconds = SimpleNamespace(header=name)
        self.set_back = section.text("set_back", "no", choices=("yes", "no")) == "yes"
        if self.format and not clock.reads_format(self.format):
            section.blame(
                "format", f"{quote(self.format)} is no format of dates", f"write it as {clock.EXAMPLE}"
            )
            self.format = clock.EXAMPLE
        if "unit" in section:
            section.blame("unit", "has no meaning beside `format`", "remove one of them")


def marks(section):
    """Delimiter and decimal sign that a section states, None for what is left to be found."""
    return (section.text("delimiter", choices=tuple(DELIMITERS)), section.text("decimal", choices=(".", ",")))


def wanted(section, names, kinds=(), needed=(), files=False):
    """Columns (name -> `Column`) described by the sub-section 'columns'; faults are noted.

    `kinds` maps names to the variables of the register that they are; others are their own. The absence of
    `needed` ones is a fault. With `files` a column may stand in a file of its own.
    """
    listing, kinds = section.section("columns"), dict(kinds)
    found = {
        name: Column(kinds.get(name, name), listing.section(name), files)
        for name in names
        if listing.raw(name) is not None
    }
    for name in names:
        listing.used.add(name)
    listing.close()
    for absent in [name for name in needed if name not in found]:
        section.blame(f"columns.{absent}", "is missing", "name the column that holds it")
    return found


def to_si(path, column, values, stated, line=None):
    """Values of a column in SI; `stated` is the unit the file itself gives, or None."""

    def conversion(unit):
        return units.factor(unit, column.name), units.offset(unit)

    name, remedy = quote(column.header), f"state its `unit` beside its name: {units.known(column.name)}"
    if stated and conversion(stated)[0] is None:
        if column.unit is None:
            what = f"column {name} is in {quote(stated)}, which is no unit of {column.name}"
            refuse(path, what, remedy, line)
        stated = None
    unit = column.unit or stated or ("1" if units.is_ratio(column.name) else None)
    if unit is None:
        refuse(path, f"the unit of column {name} is not known", remedy, line)
    if stated and conversion(stated) != conversion(unit):
        what = f"column {name} says {quote(stated)}, test.yaml says {quote(unit)}"
        refuse(path, what, "correct the one that is wrong", line)
    factor, added = conversion(unit)
    return values * (factor * column.scale) + added


def read_table(path, columns, delimiter=None, decimal=None):
    """Columns (N,) of a text table in SI by their names, over the `gain` of their rows where they have one.

    As `_read_table`, which takes no gain.
    """
    gains = divisors(columns)
    asked = columns | {GAIN_OF + name: column for name, column in gains.items()}
    found = _read_table(path, asked, delimiter, decimal)
    for name in gains:
        found[name] = over_gain(path, columns[name], found[name], found.pop(GAIN_OF + name))
    return found


def divisors(columns):
    """Columns of amplifier gains, by the names of those that are divided by them."""
    return {name: column.divisor() for name, column in columns.items() if getattr(column, "gain", None)}


def over_gain(path, column, values, gain):
    """Values over the gain of the amplifier."""
    if np.any(gain <= 0):
        refuse(path, f"a gain in column {quote(column.gain)} is not above 0", "correct it, or remove `gain`")
    return values / gain


def _read_table(path, columns, delimiter=None, decimal=None):
    """Columns (N,) of a text table in SI by their names, NaN where a cell says so or is empty.

    `columns`: name -> `Column`; header cells may carry the unit in brackets: 'Time [ms]', 'S1 (nA)'. The
    delimiter (of `DELIMITERS`) is found from the header, the decimal sign from the cells if None. Refusal
    with one sentence per fault, with the line.
    """
    stamped = columns["time"] if "time" in columns and columns["time"].format else None
    sought = {**columns, **stamped.beside()} if stamped else columns
    lines, ended = table_lines(path, LARGEST, [column.header for column in sought.values()])
    start, mark, places, stated = header_of(path, lines, sought, delimiter)
    for index in range(start + 1, min(start + 1 + STACKED, len(lines))):
        cells = split(lines[index], mark)
        if any(is_value(cell) and not cell[0].isalpha() for cell in cells):  # 'T0 = 12.03.2026' is none
            break
        if below := units_in(cells):  # units and remarks between the names and the data
            stated = {name: stated[name] or dict(enumerate(below)).get(at) for name, at in places.items()}
        lines[index] = ""
    if ended and not stamped and (plain := _plain(lines, start, mark, decimal)) is not None:
        result = {name: plain[:, place] for name, place in places.items()}
        for name, values in result.items():
            if name != "time":
                values[np.isin(values, FILLS)] = np.nan
            result[name] = to_si(path, columns[name], values, stated[name], start + 1)
        return result
    nameless = all(NUMBERED.fullmatch(column.header) for column in columns.values())
    numbers, rows, faults = _rows(path, lines, start, mark, set(places.values()), nameless)
    try:
        require_end(path, lines, ended)
    except Refusal as reason:
        faults += reason.messages
    if not numbers and not faults:
        refuse(path, "holds a header and no data", "export the data again", start + 1)
    needed = max(places.values())
    faults += [
        fault(path, f"{len(row)} cells, column {needed + 1} is needed", "restore or remove the line", line)
        for row, line in zip(rows, numbers, strict=True)
        if len(row) <= needed
    ]
    kept = [(row, line) for row, line in zip(rows, numbers, strict=True) if len(row) > needed]
    numbers = [line for _, line in kept]
    cells = {name: [row[place] for row, _ in kept] for name, place in places.items()}
    if stamped and stamped.beside():
        keys = ("time", *stamped.beside())
        rows = zip(*(cells[key] for key in keys), strict=True)
        cells["time"] = [stamped.stamp(dict(zip(keys, row, strict=True))) for row in rows]
        cells = {name: words for name, words in cells.items() if name in columns}
    plain = {name: words for name, words in cells.items() if not (stamped and name == "time")}
    if not stamped and "time" in cells:
        faults += _unstated_stamps(path, cells["time"], numbers)
    if not faults or decimal is None:
        decimal, more = (decimal, []) if decimal else decimal_sign(path, mark, plain, numbers)
        faults += more
    result = {}
    for name, words in plain.items():
        values = [number(word, decimal, thousands=True) for word in words]
        faults += [
            fault(
                path,
                f"{quote(words[i])} in column {quote(columns[name].header)} is not a number",
                "correct it, or leave the cell empty if the sample is missing",
                numbers[i],
            )
            for i, value in enumerate(values)
            if value is None and not (name == "time" and clock.looks_like_stamp(words[i]))
            if decimal or not set(words[i]) <= SIGNS  # those the sign that was left open decides
        ]
        try:
            known = np.array(values, dtype=float)  # NaN for None
            if name != "time":
                known[np.isin(known, FILLS)] = np.nan
            result[name] = to_si(path, columns[name], known, stated[name], start + 1)
        except Refusal as reason:
            faults += reason.messages
    if stamped:
        result["time"], more = clock.times(
            path, cells["time"], numbers, stamped.format, stamped.zero, stamped.set_back
        )
        faults += more
    refuse_all(path, faults)
    return result


def _plain(lines, start, mark, decimal):
    """Cells (N, columns) of a long table of nothing but finite numbers, all at once; None for any other."""
    body, width = [line for line in lines[start + 1 :] if line], len(split(lines[start], mark))
    if len(body) < LONG or mark in " .":
        return None
    whole = "\n".join(body)
    signs = set(whole) - {mark}
    if not signs <= PLAIN or {".", ","} <= signs:
        return None
    comma = "," in signs
    if decimal not in (None, "," if comma else ".") or (comma and not FRACTION.search(whole)):
        return None  # a sign that the description denies, or what may be thousands
    try:
        found = np.loadtxt(
            body if not comma else whole.replace(",", ".").split("\n"), delimiter=mark, ndmin=2
        )
    except ValueError:  # cells that are empty, rows of another length: for the strict reader to say
        return None
    return found if found.shape == (len(body), width) and np.isfinite(found).all() else None


def _rows(path, lines, start, mark, needed, nameless=False):
    """Line numbers and cells of the rows below the header; rows of another length are faults.

    A row has as many cells as the header, or, where a program leaves out empty cells at the end, as most rows
    have. Empty cells beyond the header are those of a final delimiter. Marks of events, without a sample in
    the `needed` columns, are left out, and it is said.
    """
    names = lines[start] if start >= 0 else ""
    remark = nameless and is_remark(names)
    if remark or not names.strip() or len(split(names, mark)) < 2:  # a table without names
        names = next((line for line in lines[start + 1 :] if line.strip()), "")
    header = without_empty_end(split(names, mark))
    numbers, rows = [], []
    for index in range(start + 1, len(lines)):
        again = start >= 0 and lines[index].strip() == lines[start].strip()  # of a further block
        if lines[index].strip() and not again and not is_remark(lines[index]):
            numbers.append(index + 1)
            rows.append(split(lines[index], mark))
    marks = [at for at, row in enumerate(rows) if is_mark(row, needed, len(header))]
    if marks:
        said = ", ".join(
            f"line {numbers[at]} {quote(lines[numbers[at] - 1].strip())}" for at in marks[:MARKS]
        )
        LOG.warning("%s: %d lines hold no sample and are taken as marks: %s", path, len(marks), said)
        numbers, rows = ([row for at, row in enumerate(one) if at not in marks] for one in (numbers, rows))
    widths = [len(row) if len(row) <= len(header) else len(without_empty_end(row)) for row in rows]
    # A named last column that no row or few rows fill is one for remarks.
    usual = max(set(widths), key=lambda width: (widths.count(width), width)) if widths else 0
    least, most = min(usual, len(header)), max(len(header), len(split(names, mark)))
    faults = [
        fault(path, f"{width} cells, the header has {len(header)}", "restore or remove the line", line)
        for width, line in zip(widths, numbers, strict=True)
        if width < least or width > most
    ]
    if mark == "," and widths and min(widths) >= 2 * most - 1 > 1:
        what = (
            f"{min(widths)} cells in all rows, the header has {len(header)}: commas in the numbers as well?"
        )
        faults = [fault(path, what, "export with decimal points, or with ';' between the cells", numbers[0])]
    good = [least <= width <= most for width in widths]
    return (
        [line for line, kept in zip(numbers, good, strict=True) if kept],
        [row for row, kept in zip(rows, good, strict=True) if kept],
        faults,
    )


def _unstated_stamps(path, words, numbers):
    """The fault of dates or clock times whose format test.yaml does not state."""
    stamps = [line for word, line in zip(words, numbers, strict=True) if clock.looks_like_stamp(word)]
    if not stamps:
        return []
    word = words[numbers.index(stamps[0])]
    return [
        fault(
            path,
            f"{quote(word)} is a date or a time of day",
            f"state its `format` beside its `name`, e.g. '{clock.EXAMPLE}', and `zero` in the same form",
            stamps[0],
        )
    ]


def header_of(path, lines, columns, delimiter):
    """Index of the header line, its delimiter, the place of each column, the unit each header gives."""
    marks = [DELIMITERS[delimiter]] if delimiter else list(DELIMITERS.values())
    best, best_line = set(), None
    listed = list(enumerate(lines[:HEADER_LINES]))
    # A header may stand behind a comment sign; a plain line that holds the names comes first.
    for index, line in sorted(listed, key=lambda one: one[1].lstrip().startswith(COMMENT)):
        for mark in marks:
            cells = split(line.lstrip("#%! "), mark)
            places, stated = {}, {}
            for name, column in columns.items():
                hits = [
                    (place, unit)
                    for place, cell in enumerate(cells)
                    for label, unit in [label_of(cell)]
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
                return index, mark, places, stated
            if len(places) > len(best):
                best, best_line = set(places), index + 1
    for find in (_numbered, _stacked):
        if found := find(lines, columns, marks):
            return found
    if not lines:
        refuse(path, "is empty", "export it again")
    absent = [quote(column.header) for name, column in columns.items() if name not in best]
    refuse(
        path,
        f"no column {', '.join(absent)} in the header{_held(lines[(best_line or 1) - 1])}",
        "write the names in test.yaml as they stand in the file, or name the `delimiter`",
        best_line,
    )


def _held(line):
    """Words that say which columns a header holds; none for a line of one cell."""
    cells = max((split(line, mark) for mark in DELIMITERS.values()), key=len)
    more = ", ..." if len(cells) > SHOWN else ""
    return f" of {', '.join(map(quote, cells[:SHOWN]))}{more}" if len(cells) > 1 else ""


def _numbered(lines, columns, marks):
    """What `header_of` returns for a table without names, whose columns are called by numbers; or None."""
    if not all(NUMBERED.fullmatch(column.header) for column in columns.values()):
        return None
    places = {name: int(column.header.split()[1]) - 1 for name, column in columns.items()}
    for index, line in enumerate(lines[:HEADER_LINES]):
        for mark in marks:
            cells = split(line, mark)
            if len(cells) > max(places.values()) and all(is_value(cells[place]) for place in places.values()):
                return index - 1, mark, places, dict.fromkeys(columns)
    return None


def _stacked(lines, columns, marks):
    """What `header_of` returns, for names that stand in several lines above the data, or None."""
    for mark in marks:
        rows = [split(line, mark) for line in lines[:HEADER_LINES]]
        for last in range(len(rows)):
            block = [
                row for row in rows[max(last - STACKED + 1, 0) : last + 1] if len(row) == len(rows[last])
            ]
            names = [
                {part for cell in cells for part in (cell, label_of(cell)[0])}
                for cells in zip(*block, strict=True)
            ]
            places = {
                name: [place for place, found in enumerate(names) if column.header in found]
                for name, column in columns.items()
            }
            if len(rows[last]) > 1 and all(len(found) == 1 for found in places.values()):
                below = [units_in(row) or [None] * len(row) for row in block]
                labels = [[label_of(cell)[1] for cell in row] for row in block]
                stated = [next(filter(None, words), None) for words in zip(*labels, *below, strict=True)]
                places = {name: found[0] for name, found in places.items()}
                return last, mark, places, {name: stated[place] for name, place in places.items()}
    return None
