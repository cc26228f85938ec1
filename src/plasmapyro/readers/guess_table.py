"""What one text table looks like, and which of its columns seem to hold what."""

import re
from typing import NamedTuple

import numpy as np

from plasmapyro.readers import clock, columns, parts, units
from plasmapyro.readers.cells import (
    DELIMITERS,
    decimal_sign,
    is_remark,
    is_value,
    label_of,
    split,
    units_below,
    units_in,
    without_empty_end,
)
from plasmapyro.readers.description import in_yaml
from plasmapyro.readers.dialects import table_lines
from plasmapyro.readers.text import missing, number

MOST_ROWS = 400  # of a table that are looked at
USUAL = 0.9  # of the rows: cells of a column that must be numbers or dates
LEAST_RUN = 10  # rows: of a table, not of the blocks of numbers above it
NAMES = {  # label in lower case, without blanks, '_', '-' and '.', for those without a telling unit
    "time": r"t|ts|tms|time.*|\u6642.*|zeit.*|uhr.*|clock.*|datum.*|date.*|tiempo.*|temps.*|tempo|stamp.*"
    r"|sec.*|elapsed.*|xvalue",
    "signal_wide": r".*s1|.*wide.*|.*breit.*|.*ancha?|.*larg[ea].*|.*\u5e83.*|.*\u5bbd.*|.*breed.*"
    r"|.*szerok.*|.*\u0448\u0438\u0440\u043e\u043a.*|.*(ch(annel)?|kanal|voie|canale?)1"
    r"|.*i1|.*det(ector)?1|.*band1|.*signal1|q",
    "signal_narrow": r".*s2|.*narrow.*|.*schmal.*|.*estrecha?|.*[\u00e9e]troit.*|.*strett.*|.*\u72ed.*"
    r"|.*\u7a84.*|.*smal.*|.*w[a\u0105]sk.*|.*\u0443\u0437\u043a.*|.*(ch(annel)?|kanal|voie|canale?)2"
    r"|.*i2|.*det(ector)?2|.*band2|.*signal2|r",
    "electric_power": r"p?el|pel.*|.*power.*|.*leistung.*|.*potencia.*|.*puissance.*",
    "chamber_pressure": r"pc.*|pch.*|.*press.*|.*druck.*|.*presi.n.*",
    "mass_flow_rate": r"mdot|.*massflow.*|.*flow.*|.*durchfluss.*|.*caudal.*|.*debit.*",
}
TUNNEL_UNITS = {"W": "kW", "Pa": "mbar", "kg s-1": "g/s"}  # SI, and what tunnels are logged in
OF_UNIT = {"s": "time", "A": "signals"} | dict(zip(TUNNEL_UNITS, parts.TUNNEL, strict=True))
WAVE = re.compile(r"\W*(lambda|\u03bb|wave|wellenl)", re.IGNORECASE)
WORDS = re.compile(r"[^\W\d]{3}")
DATES = (
    "%d.%m.%Y|%Y-%m-%d|%d/%m/%Y|%m/%d/%Y|%d-%m-%Y|%Y/%m/%d|%Y.%m.%d|%d.%m.%y|%m/%d/%y|%y/%m/%d|%d-%b-%Y"
    "|%d %b %Y|%d. %b %Y|%d-%b-%y|%b %d, %Y|%Y%m%d"
).split("|")
TIMES = (
    "%H:%M:%S|%H:%M|%M:%S|%I:%M:%S %p|%H:%M:%S%z|%H:%M:%S %z|%H%M%S|%H%M%S%z|%H-%M-%S|%H.%M.%S|%Hh%Mm%Ss"
).split("|")
FORMATS = [
    f"{day}{gap}{hour}" for day in DATES for gap in (" ", "T", "_") for hour in TIMES if hour != "%M:%S"
] + TIMES
NO_SIGNAL = re.compile(  # columns that are none, whatever their size
    r"([-+]?[\d,]+|no|nr|num(ber)?|index|sample|scan|channel|status|flag|alarm.*|.*temp.*|.*emiss.*|.*slope.*"
    r"|.*humid.*|.*gain.*|.*range.*|.*bereich|verst.*|ganancia.*)\d*"
)
GAIN = re.compile(r".*gain.*|.*range|.*bereich|verst.*|ganancia.*", re.IGNORECASE)  # of an amplifier
VOLTS = {"V": 1.0, "mV": 1e-3, "uV": 1e-6}
INDIRECT = {"V": 1e-6, "mV": 1e-9, "uV": 1e-12, "count": 1e-9, "counts": 1e-9}  # to ask the amperes of one


class Table(NamedTuple):
    """What a text table looks like: its marks, and of each column label, unit and words."""

    delimiter: str
    decimal: str | None  # None: left open, for `check` to ask
    labels: list
    units: list
    cells: list


def look_at_table(path):
    """The `Table` in a file, or None if it does not look like one.

    The delimiter is the one that makes most columns of numbers or dates. Names and units may stand in several
    lines above them; without names the columns are 'column 1' and so on.
    """
    lines = [line for line in table_lines(path, columns.LARGEST)[0] if line.strip()][
        : columns.HEADER_LINES + MOST_ROWS
    ]
    seen, best = set(), None  # a header may stand above each block of a record
    lines = [line for line in lines if not (line in seen or seen.add(line)) or not WORDS.search(line)]
    tabbed = sum("\t" in line for line in lines) > USUAL * len(lines)
    for name, mark in DELIMITERS.items():
        if tabbed and mark.isspace() and mark != "\t":
            continue  # an empty cell would be lost
        rows = [split(line.lstrip("#%! "), mark) for line in lines]
        good = [_is_row(row) for row in rows]
        begins = [i for i in range(len(rows)) if good[i] and not (i and good[i - 1])]
        if not begins:
            continue
        # Above the table there may be blocks of a few numbers: the longest run is it, with comments inside.
        remarks = [is_remark(line) for line in lines]
        passed = [*map(any, zip(good, remarks, strict=True)), False]
        runs = {begin: passed.index(False, begin) - begin for begin in begins}
        first = max(begins, key=runs.get)
        long = [b for b in begins if runs[b] >= LEAST_RUN and len(rows[b]) == len(rows[first])]
        first = min([first, *long])  # lines of words may stand within the table
        body = [row for row, remark in zip(rows[first:], remarks[first:], strict=True) if not remark]
        width = max(map(len, body[:MOST_ROWS]))
        header = _names(rows[max(first - columns.STACKED, 0) : first], width, len(body))
        cells = [[row[place] for row in body if place < len(row)] for place in range(len(header))]
        held = [
            place
            for place, words in enumerate(cells)
            if 2 * len(words) > len(body) and _is_column(words) and header[place][0]
        ]
        named = [place for place in held if not columns.NUMBERED.fullmatch(header[place][0])]
        rank = (len(named) > 1, len(held), -abs(len(header) - width))
        if len(held) >= 2 and (best is None or rank > best[0]):
            best = (rank, name, [header[place] for place in held], [cells[place] for place in held])
    if best is None:
        return None
    _, name, labels, cells = best
    decimal, _ = decimal_sign(path, DELIMITERS[name], dict(enumerate(cells)), [1])
    return Table(name, decimal, [label for label, _ in labels], [unit for _, unit in labels], cells)


def _is_row(cells):
    """Whether cells are values of a table: two or more, or one beside cells that say there is none."""
    values = sum(map(is_value, cells))
    return values >= 2 or (values == 1 and sum(map(missing, filter(None, cells))) > 0)


def _names(above, width, count):
    """(label, unit or None) of each column, from the lines above the data.

    The line whose names tell most has the word, other lines fill what it leaves empty.
    """
    above = [row for row in above if len(row) > 1 and len(without_empty_end(row)) >= min(2, width)]
    while {len(row) for row in above} != {len(row) for row in above[-1:]}:
        del above[0]
    below = [units_in(row) for row in above]
    labels = [[label_of(cell) for cell in row] for row in above]
    telling = [
        -1
        if units_only
        else sum(bool(unit) or any(_matches(label, one) for one in NAMES) for label, unit in row)
        for row, units_only in zip(labels, map(units_below, above), strict=True)
    ]
    if (
        not above
        or max(telling) < 0
        or not any(map(WORDS.search, above[telling.index(max(telling))]))
        and not max(telling)
    ):
        return [(f"column {place}", None) for place in range(1, width + 1)] if count > 3 else []
    chosen = labels[telling.index(max(telling))]
    named = [row for row, units_only in zip(labels, telling, strict=True) if units_only >= 0]
    found = []
    for place, (label, unit) in enumerate(chosen):
        label = label or next((row[place][0] for row in reversed(named) if row[place][0]), "")
        stated = [row[place] for row in below if row] + [row[place][1] for row in labels]
        found.append((label, unit or next(filter(None, stated), None)))
    return found


def _matches(label, variable):
    return re.fullmatch(NAMES[variable], re.sub(r"[\s_.\-]", "", label.lower())) is not None


def _is_column(words):
    known = [word for word in words if not missing(word)]
    return len(known) > 0 and np.mean([is_value(word) for word in known]) >= USUAL


def assign(table):
    """Which column holds which variable (variable -> place); dates and times of day under 'stamps'."""
    found, stamps = {}, [i for i, words in enumerate(table.cells) if any(map(clock.looks_like_stamp, words))]
    free = [place for place in range(len(table.labels)) if place not in stamps]
    if any(WAVE.match(label) for label in table.labels):
        return {}  # a spectrum, whatever its columns rise like
    if stamps and len(set(zip(*(table.cells[place] for place in stamps), strict=False))) < len(
        table.cells[0]
    ):
        finer = [
            p for p in free if _is_one_of(table.units[p], "s") and (np.diff(values_of(table, p)) > 0).all()
        ]
        stamps = [] if finer else stamps  # clock times of minutes beside a count of milliseconds
    if stamps:
        fractions = [
            p for p in free if table.labels[p].lower() in ("ms", "msec", "millisecond", "milliseconds")
        ]
        if fractions and all(
            word.strip().isdigit() and int(word) < 1000 for word in table.cells[fractions[0]]
        ):
            found["milliseconds"] = fractions[0]
            free.remove(fractions[0])
    currents = []
    for place in list(free):
        variable = next((name for si, name in OF_UNIT.items() if _is_one_of(table.units[place], si)), None)
        if variable == "signals":
            currents.append(place)
        elif variable and variable not in found and not (variable == "time" and stamps):
            found[variable] = place
            free.remove(place)
    for variable in NAMES:
        if variable in found or (variable == "time" and stamps):
            continue
        among = [p for p in free if p in currents] if variable.startswith("signal") and currents else free
        if (place := by_name(table, variable, among)) is not None:
            found[variable] = place
            free.remove(place)
    if stamps:
        found["stamps"] = stamps[:2]
    elif "time" not in found and free and (np.diff(values_of(table, free[0])) > 0).all():
        found["time"] = free.pop(0)
    open_ones = [name for name in parts.SIGNALS if name not in found]
    rest = [p for p in free if p in currents] or [
        p
        for p in free
        if not _is_known(table.units[p], "signal_wide")
        and not NO_SIGNAL.fullmatch(re.sub(r"[\s_.\-]", "", table.labels[p].lower()))
        and len(set(table.cells[p])) > 1
    ]
    timed = "time" in found or stamps
    if open_ones and timed and len(rest) >= len(open_ones):
        # The wide band sees more: without names the larger signal is taken as the wide one.
        if len(rest) > len(open_ones):
            found["unsure"] = [table.labels[p] for p in rest]
        order = sorted(rest[:2], key=lambda place: -np.nanmedian(values_of(table, place)))
        chosen = order if len(open_ones) == 2 else rest
        found |= dict(zip(open_ones, chosen, strict=False)) | {"by size": len(open_ones) == 2}
    elif open_ones and timed and len(rest) == len(open_ones) - 1:
        found["band"] = (rest or [found.pop(name) for name in parts.SIGNALS if name in found])[0]
    return found


def gains_of(table, taken):
    """Places of the columns that look like amplifier gains, but for those `taken`: positive numbers."""
    places = [p for p, label in enumerate(table.labels) if GAIN.fullmatch(label.strip()) and p not in taken]
    return [p for p in places if np.nanmin(values_of(table, p), initial=np.inf) > 0]


def by_name(table, variable, places):
    """The first of some columns that is called as a variable is, and whose unit does not deny it; or None."""
    fits = [p for p in places if not _is_known(table.units[p], variable)]
    return next((p for p in fits if _matches(table.labels[p], variable)), None)


def _is_known(unit, variable):
    """Whether a unit is one of something else than the variable, and no reading of it (a voltage, counts)."""
    return (
        unit is not None
        and units.is_unit(unit)
        and units.normalised(unit) not in INDIRECT
        and not suits(unit, variable)
    )


def suits(unit, variable):
    """Whether a variable may be in a unit."""
    return unit is not None and units.factor(unit, variable) is not None


def _is_one_of(unit, si):
    return bool(unit) and units.normalised(unit) in units.TO_SI[si]


def values_of(table, place):
    """Numbers (rows,) of a column, NaN where a cell holds none."""
    values = [number(word, table.decimal, thousands=True) for word in table.cells[place]]
    return np.array(values, dtype=float)  # NaN for None


def stamp_format(table, places):
    """Format of dates that reads all cells with the shortest record, its first stamp, and questions."""
    stamps = [" ".join(words) for words in zip(*(table.cells[place] for place in places), strict=True)]
    known = [word for word in stamps if word.strip() and not missing(word)]
    spans = {}
    for form in FORMATS:
        if not known or clock.seconds(known[0], form) is None:
            continue
        values = [clock.seconds(word, form) for word in known]
        if None not in values:
            spans[form] = (sum(np.diff(values) < 0), max(values) - min(values))
    if not spans:
        return clock.EXAMPLE, known[0], [f"pyrometer.columns.time.format: no known format reads {known[0]!r}"]
    form = min(spans, key=spans.get)
    values = np.array([clock.seconds(word, form) for word in known])
    questions = []
    if sum(clock.has_day(other) for other in spans) > 1:
        questions.append(
            f"pyrometer.columns.time.format: {known[0]!r} is read as {form}; day and month may be exchanged"
        )
    if (np.abs(np.diff(values) + clock.HOUR) < clock.CHANGE).any():
        questions.append(
            "the clock goes back by an hour; if summer time ended, add `set_back: yes` beside `format`"
        )
    return form, known[0], questions


def file_line(folder, paths):
    """Line of a section that names its files, within the folder of the test."""
    names = [in_yaml(path.relative_to(folder).as_posix()) for path in paths]
    return f"  file: {names[0] if len(names) == 1 else '[' + ', '.join(names) + ']'}"
