"""A first description of a folder of raw files: what they seem to hold, and what only a person knows."""

import json
import os
import re
from datetime import timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml

from plasmapyro.contracts import VARIABLES
from plasmapyro.foreign import printable
from plasmapyro.readers import burst, clock, columns, ocean, parts, tdms, units
from plasmapyro.readers.description import Section
from plasmapyro.readers.dialects import ARRAYS, table_lines
from plasmapyro.readers.text import Refusal, missing, number, quote, read_lines, refuse
from plasmapyro.record import onset

MOST_FILES, MOST_ROWS = 20_000, 400  # looked at: of a folder, of a table
USUAL = 0.9  # of the rows: cells of a column that must be numbers or dates
LEAST_RUN = 10  # rows: of a table, not of the blocks of numbers above it
PLATEAU = 0.98  # of the highest signal: the plasma is taken to end when the signal last had it
OF_WINDOW = "kept for the record: calibrate through it, or state window_transmittance in calibration.yaml"
OF_ZERO = "what shall be 0, best the injection"
FIRST_WINDOW = 0.1  # of the exposure, where no growth shows the surface
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
GUIDE = "docs/your-own-data.md"
WAVE = re.compile(r"\W*(lambda|\u03bb|wave|wellenl)", re.IGNORECASE)
WORDS = re.compile(r"[^\W\d]{3}")
MULTIPLE = re.compile(r"(\d+\.?\d*)\s*(\D+)")  # a unit of so many units: ticks of 0.1 ms
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
OTHERS = set(
    ".yaml .yml .md .pdf .png .jpg .jpeg .tif .gif .mp4 .avi .html .py .m .docx .pptx .ini .db .lnk".split()
)
NO_SIGNAL = re.compile(  # columns that are none, whatever their size
    r"([-+]?[\d,]+|no|nr|num(ber)?|index|sample|scan|channel|status|flag|alarm.*|.*temp.*|.*emiss.*|.*slope.*"
    r"|.*humid.*)\d*"
)
INDIRECT = {"V": 1e-6, "mV": 1e-9, "uV": 1e-12, "count": 1e-9, "counts": 1e-9}  # to ask the amperes of one
EPOCH = (1e9, 3e9)  # [s] since 1970: 2001 to 2065
DAYS = (30_000, 800_000)  # dates as spreadsheets (1982 on) and Matlab count them
DAY_PART = 1.0  # a record without a unit that ends before: times of day as spreadsheets count them
# ASSUME: currents without a unit are amperes if as small as photodiodes give them, else nanoamperes.
LARGEST_CURRENT = 0.1  # [A]


class Table(NamedTuple):
    """What a text table looks like: its marks, and of each column label, unit and words."""

    delimiter: str
    decimal: str
    labels: list
    units: list
    cells: list


class Guess(NamedTuple):
    """Lines of test.yaml, and what a person must answer."""

    text: str
    questions: list


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
    for name, mark in columns.DELIMITERS.items():
        if tabbed and mark.isspace() and mark != "\t":
            continue  # an empty cell would be lost
        rows = [columns.split(line.lstrip("#%! "), mark) for line in lines]
        good = [_is_row(row) for row in rows]
        begins = [i for i in range(len(rows)) if good[i] and not (i and good[i - 1])]
        if not begins:
            continue
        # Above the table there may be blocks of a few numbers: the longest run is it, with comments inside.
        remarks = [columns.is_remark(line) for line in lines]
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
        rank = (len(held), -abs(len(header) - width))
        if len(held) >= 2 and (best is None or rank > best[0]):
            best = (rank, name, [header[place] for place in held], [cells[place] for place in held])
    if best is None:
        return None
    _, name, labels, cells = best
    commas = any(
        "," in word and number(word) is None and not clock.looks_like_stamp(word)
        for words in cells
        for word in words
    )
    decimal = "," if commas and name != "," else "."
    return Table(name, decimal, [label for label, _ in labels], [unit for _, unit in labels], cells)


def _is_row(cells):
    """Whether cells are values of a table: two or more, or one beside cells that say there is none."""
    values = sum(map(columns.is_value, cells))
    return values >= 2 or (values == 1 and sum(map(missing, filter(None, cells))) > 0)


def _names(above, width, count):
    """(label, unit or None) of each column, from the lines above the data.

    The line whose names tell most has the word, other lines fill what it leaves empty.
    """
    above = [row for row in above if len(row) > 1 and len(columns.without_empty_end(row)) >= min(2, width)]
    while {len(row) for row in above} != {len(row) for row in above[-1:]}:
        del above[0]
    below = [columns.units_in(row) for row in above]
    labels = [[columns._label(cell) for cell in row] for row in above]
    telling = [
        -1
        if units_only
        else sum(bool(unit) or any(_matches(label, one) for one in NAMES) for label, unit in row)
        for row, units_only in zip(labels, map(columns.units_below, above), strict=True)
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
    return len(known) > 0 and np.mean([columns.is_value(word) for word in known]) >= USUAL


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
            p for p in free if _is_one_of(table.units[p], "s") and (np.diff(_values(table, p)) > 0).all()
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
        if (place := _by_name(table, variable, among)) is not None:
            found[variable] = place
            free.remove(place)
    if stamps:
        found["stamps"] = stamps[:2]
    elif "time" not in found and free and (np.diff(_values(table, free[0])) > 0).all():
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
        order = sorted(rest[:2], key=lambda place: -np.nanmedian(_values(table, place)))
        chosen = order if len(open_ones) == 2 else rest
        found |= dict(zip(open_ones, chosen, strict=False)) | {"by size": len(open_ones) == 2}
    elif open_ones and timed and len(rest) == len(open_ones) - 1:
        found["band"] = (rest or [found.pop(name) for name in parts.SIGNALS if name in found])[0]
    return found


def _by_name(table, variable, places):
    """The first of some columns that is called as a variable is, and whose unit does not deny it; or None."""
    fits = [p for p in places if not _is_known(table.units[p], variable)]
    return next((p for p in fits if _matches(table.labels[p], variable)), None)


def _is_known(unit, variable):
    """Whether a unit is one of something else than the variable, and no reading of it (a voltage, counts)."""
    return (
        unit is not None
        and units.is_unit(unit)
        and units.normalised(unit) not in INDIRECT
        and not _suits(unit, variable)
    )


def _suits(unit, variable):
    return unit is not None and units.factor(unit, variable) is not None


def _is_one_of(unit, si):
    return bool(unit) and units.normalised(unit) in units.TO_SI[si]


def _values(table, place):
    values = [number(word, table.decimal) for word in table.cells[place]]
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def _quoted(word):
    return json.dumps(word, ensure_ascii=not word.isprintable())


def describe(folder):
    """A first test.yaml for a folder of raw files.

    Parameters
    ----------
    folder : path

    Returns
    -------
    Guess

    Raises
    ------
    Refusal
        If nothing in the folder looks like signals of a pyrometer or spectra.
    """
    folder = Path(folder)
    files = [
        path
        for path in sorted(
            folder.rglob("*"), key=lambda path: (path.suffix.lower() in ARRAYS, parts.natural(str(path)))
        )
        if path.is_file()
        and not path.is_symlink()
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    ]
    if len(files) > MOST_FILES:
        raise Refusal([f"{folder}: holds more than {MOST_FILES} files; name the folder of one test"])
    kinds, remarks, unknown = {}, [], []
    for path in files:
        try:
            kind, what = _kind(path)
        except Refusal as reason:
            remarks += ["not used: " + words.replace(f"{folder}{os.sep}", "", 1) for words in reason.messages]
            continue
        if kind:
            kinds.setdefault(kind, []).append((path, what))
        elif path.suffix.lower() not in OTHERS:
            unknown.append(path.relative_to(folder).as_posix())
    remarks += [
        f"not used: {name}: no columns of numbers with a time or wavelengths are seen" for name in unknown
    ]
    questions, blocks = [], []
    pyrometer = _pyrometer(folder, kinds, questions)
    read = _read(folder, "pyrometer", pyrometer, questions)
    spectrometer = _spectrometer(folder, kinds, read, questions)
    for path, (table, places) in (
        kinds.get("band", []) if not any("{file:" in line for line in pyrometer) else ()
    ):
        remarks.append(
            f"not used: {path.name}: one signal ({table.labels[places['band']]!r}) against time is seen; the"
            " other band must stand in a column beside it, or alone in a second file of the same form"
        )
    remarks = _grouped(remarks)
    if pyrometer:
        blocks += ["pyrometer:", *pyrometer]
    if spectrometer:
        blocks += ["spectrometer:", *spectrometer]
    if pyrometer and (tunnel := [(path, table, places) for path, (table, places) in kinds.get("tunnel", [])]):
        path, table, places = tunnel[0]
        blocks += ["tunnel:", *_table_lines(folder, [path], table, places, questions)]
    if not blocks:
        seen = ", ".join(sorted({path.suffix or path.name for path in files})) or "no files"
        raise Refusal(
            [
                f"{folder}: nothing looks like signals of a pyrometer or spectra ({seen}); a table needs"
                " names above its columns and one row per sample, such as 'Time [s];wide [nA];narrow [nA]',"
                f" see {GUIDE}",
                *remarks,
            ]
        )
    attributes = _attributes(folder, read, bool(pyrometer), spectrometer, kinds, questions)
    head = [
        "# Guessed from the files; every '?' is a question that no file answers: correct what is wrong, then",
        "#   plasmapyro check FOLDER",
    ]
    asked = [
        " ".join(printable(words).split()) for words in [*questions, *remarks]
    ]  # names may hold line ends
    head += [f"# ? {words}" for words in asked]
    return Guess("\n".join([*head, "attributes:", *attributes, *blocks]) + "\n", asked)


def _grouped(remarks):
    """Remarks on files, those with the same reason as one."""
    groups = {}
    for words in remarks:
        name, _, reason = words.removeprefix("not used: ").partition(": ")
        groups.setdefault(reason, []).append(name)
    return [
        f"not used: {names[0]}" + (f" and {len(names) - 1} more" if names[1:] else "") + f": {reason}"
        for reason, names in groups.items()
    ]


def _kind(path):
    """Which of tdms, spectrum, burst, matrix, pyrometer, tunnel a file seems to be, and what it holds."""
    if path.suffix.lower() in OTHERS:
        return None, None
    if path.suffix.lower() == ".tdms":
        return "tdms", None
    every = table_lines(path, columns.LARGEST)[0]
    lines = [line for line in every[: ocean.HEADER_LINES] if line.strip()]
    if any(line.startswith("Exposure Time (secs)") for line in lines + every[-ocean.HEADER_LINES :]):
        return "andor", None
    fenced = any(line.startswith(ocean.FENCE) for line in lines)
    if fenced and columns.series_lines(lines) is lines or not fenced and ocean.plain_spectrum(every):
        return "spectrum", None
    data = [line for line in lines if not line.lstrip().startswith(columns.COMMENT)]
    try:
        if data and {"Q", "R"} <= burst.first_line(data[0])[1].keys():
            return "burst", burst.first_line(data[0])
    except ValueError:
        pass
    if data and (matrix := _matrix(path, data)):
        return "matrix", matrix
    table = look_at_table(path)
    if table is None:
        return None, None
    places = assign(table)
    if len(table.labels) > columns.MOST_OF_LONG and table.labels[0] == "column 1":
        what = f"holds {len(table.labels)} columns of numbers without names"
        refuse(
            path, what, "of spectra write the wavelengths above them, as 'time,750.1,750.5', of signals names"
        )
    if set(parts.SIGNALS) <= places.keys() and {"time", "stamps"} & places.keys():
        return "pyrometer", (table, places)
    if set(parts.TUNNEL) & places.keys() and {"time", "stamps"} & places.keys():
        return "tunnel", (table, places)
    if any(re.match(r"pixel", label, re.IGNORECASE) for label in table.labels):
        refuse(path, "holds pixels without wavelengths", "export it with the wavelength of each pixel")
    if "band" in places:
        return "band", (table, places)
    listed = ", ".join(quote(label) for label in table.labels[:10])
    if any(unit and units.factor(unit, "source_temperature") for unit in table.units):
        why = "temperatures alone cannot be corrected; name two columns of signals, or see `radiometer`"
    else:
        why = "name the signals, e.g. 'wide [nA]' and 'narrow [nA]', and the time; one row per sample"
    refuse(path, f"no two signals against time are seen in its columns {listed}", f"{why}, in {GUIDE}")


def _matrix(path, lines):
    """Unit of the wavelengths and delimiter, if a line holds rising or falling wavelengths behind one cell.

    Or, below a cell that names wavelengths, the first column does; if they are none, Refusal.
    """
    lines = columns.series_lines(lines)
    for name, mark in columns.DELIMITERS.items():
        rows = [columns.without_empty_end(columns.split(line, mark)) for line in lines]
        start = next((i for i, row in enumerate(rows[:-1]) if len(row) > 1 and len(row) == len(rows[-1])), 0)
        upright = columns.upright_row(rows)
        if upright is not None and len(rows[upright]) > len(rows[-1]):
            continue
        start = start if upright is None else upright
        spare = columns.spare_columns(rows[start])
        listed = rows[start][1 + spare :] if upright is None else [row[0] for row in rows[start + 1 :]]
        if long := columns.long_places(rows[start]):
            listed = [row[long[0]] for row in rows[start + 1 :] if len(row) > long[0]]
            listed = listed[: listed.index(listed[0], 1)] if listed[0] in listed[1:] else listed
        values = [number(word, "," if "," in word else ".") for word in listed]
        if len(values) > 2 and None not in values and abs(np.sign(np.diff(values)).sum()) == len(values) - 1:
            values.sort()
            for unit, scale in (("nm", 1e-9), ("um", 1e-6), ("m", 1.0), ("Angstrom", 1e-10)):
                if unit == "Angstrom" and not columns.ANGSTROM.search(rows[start][0]):
                    continue
                if 1.5e-7 < values[0] * scale and values[-1] * scale < 5e-6:
                    return unit, name
            if upright is not None:
                what = f"{quote(rows[start][0])} runs from {values[0]:g} to {values[-1]:g}"
                refuse(
                    path,
                    what,
                    "write the unit of the wavelengths there, as 'lambda [nm]', [um] or [Angstrom]",
                )
    return None


def _named(folder, paths):
    names = [_quoted(path.relative_to(folder).as_posix()) for path in paths]
    return f"  file: {names[0] if len(names) == 1 else '[' + ', '.join(names) + ']'}"


def _pyrometer(folder, kinds, questions):
    """Lines of the section 'pyrometer'; empty if no file has its signals."""
    if "pyrometer" in kinds:
        (_, (table, places)), *others = kinds["pyrometer"]
        same = [path for path, (other, _) in kinds["pyrometer"] if other.labels == table.labels]
        questions += [
            f"{path.name} looks like signals too and is not used"
            for path, (o, _) in others
            if o.labels != table.labels
        ]
        return _table_lines(folder, same, table, places, questions)
    if bands := _bands(folder, kinds.get("band", []), questions):
        return bands
    if "burst" in kinds:
        paths = [path for path, _ in kinds["burst"]]
        stamp, items = kinds["burst"][0][1]
        found = [_named(folder, paths), "  format: marathon"]
        if stamp is None:
            found.append("  period: 0.1  # ? s between lines, the log has no times")
            questions.append("pyrometer.period: how many seconds lie between two lines of the log?")
        else:
            found.append(f"  zero: {_quoted(stamp)}  # ? {OF_ZERO}; here the first line")
        if items.get("S", 1.0) != 1.0 or items.get("B", 0.0) != 0.0:
            found.append("  undo: []  # ? whether Q and R contain slope or attenuation")
            questions.append(
                "pyrometer.undo: do Q and R contain the slope or the attenuation? docs/your-own-data.md"
            )
        return found
    if "tdms" in kinds:
        return _tdms(folder, [path for path, _ in kinds["tdms"]], questions)
    return []


def _bands(folder, listed, questions):
    """Lines of the section 'pyrometer' for two files with a band each, or none."""
    if len(listed) != 2 or listed[0][1][0].labels[0] != listed[1][1][0].labels[0]:
        return []
    sizes = [-np.nanmedian(_values(table, places["band"])) for _, (table, places) in listed]
    stems = [f"{p.stem} {table.labels[at['band']]}".lower().replace("_", " ") for p, (table, at) in listed]
    order = sorted((0, 1), key=sizes.__getitem__)
    for wide, narrow in ((0, 1), (1, 0)):
        if re.search(r"wide|breit|large|ch1|s1", stems[wide]) and re.search(
            r"narrow|schmal|troit|ch2|s2", stems[narrow]
        ):
            order = [wide, narrow]
            break
    else:
        questions.append(
            f"pyrometer.columns: which file is the wide band? {listed[order[0]][0].name} is taken, the larger"
        )
    table, places = listed[0][1]
    lines = _table_lines(folder, [listed[0][0]], table, places, questions)[1:]
    for variable, one in zip(parts.SIGNALS, order, strict=True):
        path, (table, places) = listed[one]
        line = _column(variable, table, places["band"], questions)
        name = _quoted(path.relative_to(folder).as_posix())
        lines.append(line.replace("{name:", f"{{file: {name}, name:", 1))
    return lines


def _table_lines(folder, paths, table, places, questions):
    """Lines of a section for a text table."""
    found = [_named(folder, paths), f"  delimiter: {_quoted(table.delimiter)}"]
    if table.decimal == ",":
        found.append('  decimal: ","')
    if "stamps" in places:
        form, zero, more = stamp_format(table, places["stamps"])
        questions += more
        names = [_quoted(table.labels[place]) for place in places["stamps"]]
        found.append(f"  zero: {_quoted(zero)}  # ? {OF_ZERO}; here the first sample")
        name = names[0] if len(names) == 1 else f"[{', '.join(names)}]"
        more = (
            f", milliseconds: {_quoted(table.labels[places['milliseconds']])}"
            if "milliseconds" in places
            else ""
        )
        timing = f"    time: {{name: {name}, format: {_quoted(form)}{more}}}"
    else:
        time = _values(table, places["time"])
        unit, stated, scale = table.units[places["time"]], True, 1.0
        several = MULTIPLE.fullmatch(unit or "")
        if several and _suits(several[2], "time"):
            unit, stated, scale = several[2], False, float(several[1])
        elif unit is None or not _suits(unit, "time"):
            stated, unit = False, "ms" if np.nanmedian(np.diff(time)) >= 5 else "s"
            since_1970 = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
            unit = next((u for u, one in since_1970.items() if EPOCH[0] < time[0] / one < EPOCH[1]), unit)
            if (DAYS[0] < time[0] < DAYS[1] and time[-1] - time[0] < 1) or 0 <= time[0] < time[-1] < DAY_PART:
                unit = "d"  # of a spreadsheet: days since 1900
            questions.append(f"pyrometer.columns.time.unit: is the time in {unit}? no file says it")
        first = float(time[0]) * units.factor(unit, "time") * scale
        if first > 0:
            found.append(f"  zero: {first:.13g}  # ? s, {OF_ZERO}; here the first")
        timing = f"    time: {{name: {_quoted(table.labels[places['time']])}" + (
            "}" if stated else f", unit: {unit}" + (f", scale: {scale:g}" if scale != 1 else "") + "}  # ?"
        )
    found += ["  columns:", timing]
    for variable in (*parts.SIGNALS, *parts.TUNNEL):
        if variable in places:
            found.append(_column(variable, table, places[variable], questions))
    if "unsure" in places:
        listed = ", ".join(places["unsure"])
        questions.append(
            f"pyrometer.columns: which of the columns {listed} are the two signals? the first two are taken"
        )
    elif places.get("by size"):
        questions.append(
            "pyrometer.columns: which signal is the wide band? the larger one is taken, no name says it"
        )
    return found


def _column(variable, table, place, questions):
    label, unit = table.labels[place], table.units[place]
    if unit is not None and _suits(unit, variable):
        return f"    {variable}: {{name: {_quoted(label)}}}"
    if unit is not None and (each := INDIRECT.get(units.normalised(unit))) and variable in parts.SIGNALS:
        questions.append(
            f"columns.{variable}.scale: {label!r} is in {unit}: how many amperes is one? {each:g} is taken"
        )
        return f"    {variable}: {{name: {_quoted(label)}, unit: A, scale: {each:g}}}  # ?"
    usual = TUNNEL_UNITS.get(VARIABLES[variable].units)
    if usual is None:
        usual = "A" if np.nanmax(np.abs(_values(table, place))) < LARGEST_CURRENT else "nA"
    questions.append(f"columns.{variable}.unit: is {label!r} in {usual}? no file says it")
    return f"    {variable}: {{name: {_quoted(label)}, unit: {usual}}}  # ?"


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


def _tdms(folder, paths, questions):
    """Lines of the section 'pyrometer' for TDMS files, from the names of their channels."""
    names = tdms.channels(paths[0])
    table = Table(
        "",
        ".",
        [name.rpartition("/")[2] for name in names],
        [unit for unit, _ in names.values()],
        [[] for _ in names],
    )
    places = {variable: _by_name(table, variable, range(len(names))) for variable in NAMES}
    found = {variable: place for variable, place in places.items() if place is not None}
    if not set(parts.SIGNALS) <= found.keys():
        questions.append(
            f"pyrometer.columns: which channels are the two signals? there are {', '.join(names)}"
        )
        found |= dict(zip(parts.SIGNALS, range(len(names)), strict=False))
    if "time" not in found and not all(track for _, track in names.values()):
        questions.append("pyrometer.columns.time: no channel of time, and the channels carry none")
    lines = [_named(folder, paths), "  columns:"]
    for variable, place in found.items():
        name, unit = list(names)[place], table.units[place]
        usual = "s" if variable == "time" else "A"
        if unit is None:
            questions.append(f"columns.{variable}.unit: is {name!r} in {usual}? no file says it")
        lines.append(
            f"    {variable}: {{name: {_quoted(name)}" + ("}" if unit else f", unit: {usual}}}  # ?")
        )
    return lines


def _read(folder, name, lines, questions):
    """Variables of a section as its reader reads it; what it refuses is among the questions."""
    if not lines:
        return {}
    faults = []
    section = Section(yaml.load("\n".join(lines), Loader=yaml.BaseLoader), folder / "test.yaml", name, faults)
    try:
        found = getattr(parts, name)(folder, section) or {}
    except Refusal as reason:
        found, faults = {}, [*faults, *reason.messages]
    questions += faults[:1]
    return found


def _spectrometer(folder, kinds, read, questions):
    """Lines of the section 'spectrometer'; empty if there are no spectra."""
    if "spectrum" in kinds:
        dark = [path for path, _ in kinds["spectrum"] if ocean.DARK.search(path.stem)]
        light = [path for path, _ in kinds["spectrum"] if path not in dark]
        if not light and "matrix" in kinds:  # a table of spectra with a dark of its own
            return _matrix_lines(folder, kinds["matrix"], dark, questions)
        if not light:
            return []
        places = {path.parent for path in light}
        place = max(places, key=lambda one: sum(path.parent == one for path in light))
        light = [path for path in light if path.parent == place]
        if len(places) > 1:
            questions.append(
                f"spectrometer.folder: spectra lie in {len(places)} folders; {place.name} is taken"
            )
        found = [f"  folder: {_quoted(place.relative_to(folder).as_posix())}"]
        series, light, others = _series(place, light, dark)
        if others:
            found.append(f"  files: {_quoted(series)}")
            questions.append(f"spectrometer.files: only {series} are taken, not {', '.join(others[:5])}")
        spectrum = ocean.read_spectrum(light[0])
        found += _quantity(
            light[0], next(iter(spectrum.columns.values())) if len(spectrum.columns) == 1 else None, questions
        )
        if dark:
            found.append(f"  background: {_quoted(dark[0].relative_to(folder).as_posix())}")
        elif "D" not in spectrum.columns and "quantity: counts" in found[1]:
            questions.append(
                "spectrometer.background: which file is the dark spectrum? add `background: NAME`"
            )
        dates = [ocean.read_spectrum(path).date for path in (light[0], light[-1])]
        if None not in dates and dates[1] > dates[0]:
            zero = dates[0] - timedelta(seconds=spectrum.integration_time or 0.0)
            found.append(
                f'  time: {{from: date, zero: "{zero:%Y-%m-%d %H:%M:%S}"}}  # ? the moment that shall be 0'
            )
            questions.append(
                "spectrometer.time.zero: which clock time is the injection? the first spectrum is taken"
            )
        else:
            time = read.get("time", np.array([0.0, float(len(light))]))
            period = float(time[-1] - max(time[0], 0.0)) / len(light)
            found.append(f"  time: {{from: order, first: {period / 2:.4g}, period: {period:.4g}}}  # ? s")
            questions.append("spectrometer.time: when was the first spectrum, and how far apart are they?")
        return found
    if "andor" in kinds:
        dark = [path for path, _ in kinds["andor"] if ocean.DARK.search(path.stem)]
        light = [path for path, _ in kinds["andor"] if path not in dark] or dark
        found = [_named(folder, light), "  format: andor", "  quantity: counts"]
        questions.append("spectrometer.zero: when, after the begin of the series, is 0? 0 s is taken")
        return found + [f"  background: {_quoted(path.relative_to(folder).as_posix())}" for path in dark[:1]]
    return _matrix_lines(folder, kinds["matrix"], [], questions) if "matrix" in kinds else []


def _series(place, light, dark):
    """Pattern of the names of the largest series in a folder, its files, and the names of the others."""
    groups = {}
    for path in light:
        groups.setdefault(re.sub(r"\d+", "*", path.name), []).append(path)
    pattern, series = max(groups.items(), key=lambda item: len(item[1]))
    held = [path for path in place.iterdir() if path.suffix.lower() in parts.SPECTRUM_SUFFIXES]
    others = [path.name for path in held if path not in series and path not in dark[:1]]
    odd = series[0].suffix.lower() not in parts.SPECTRUM_SUFFIXES
    if not (others or odd):
        return pattern, light, []
    return pattern, series, sorted(others) or ["files of other kinds"]


def _matrix_lines(folder, listed, dark, questions):
    """Lines of the section 'spectrometer' for tables of spectra; `dark`: files of single spectra."""
    dark = [path for path, _ in listed if ocean.DARK.search(path.stem)] + dark
    tables = [path for path, _ in listed if path not in dark]
    if not tables:
        questions.append(f"{dark[0].name} looks like a dark, and no table like its spectra")
        return []
    unit, mark = dict(listed)[tables[0]]
    lines = columns.series_lines(read_lines(tables[0], columns.LARGEST)[0])
    lines = [line for line in lines if line.strip()]
    rows = [columns.split(line, columns.DELIMITERS[mark]) for line in lines]
    upright = columns.upright_row(rows)
    begins = [row[0] for row in rows[-MOST_ROWS:]] if upright is None else rows[upright][1:]
    stamps = [word for word in begins if clock.looks_like_stamp(word)]
    timing = []
    if stamps:
        form, zero, more = stamp_format(Table(mark, ".", ["time"], [None], [stamps]), [0])
        questions += [
            words.replace("pyrometer.columns.time.format", "spectrometer.time_format") for words in more
        ]
        timing = [
            f"  time_format: {_quoted(form)}",
            f"  zero: {_quoted(zero)}  # ? the moment that shall be 0",
        ]
    times, _, values = columns.read_matrix(tables[0], mark, stamps=(form, zero) if stamps else None)
    if not stamps and times.size > 1 and (np.diff(times) == 1).all() and times[0] in (0, 1):
        questions.append(
            "spectrometer.time: the spectra are numbered: when was the first, how far apart are they?"
        )
        timing = ["  time: {from: order, first: 0.5, period: 1.0}  # ? s"]
    found = [
        _named(folder, tables),
        f"  delimiter: {_quoted(mark)}",
        *_quantity(tables[0], values, questions, table=True),
        *timing,
    ]
    if unit != "nm":
        found.append(f"  wavelength_unit: {unit}")
    if dark:
        found.append(f"  background: {_quoted(dark[0].relative_to(folder).as_posix())}")
    return found


def _quantity(path, values, questions, table=False):
    """Whether spectra are counts, by their size: a converter gives up to some 2^16."""
    if values is None or 20 < np.nanmax(values) < 70_000:
        return ["  quantity: counts", *(["  unit: count"] if table else [])]
    lines = read_lines(path, columns.LARGEST)[0][: ocean.HEADER_LINES]
    words = [word for line in lines for word in re.findall(r"[\[(]([^\[\]]{5,40})[\])]", line[:2000])]
    if stated := [word for word in words if units.factor(word, "spectral_radiance")]:
        return ["  quantity: spectral_radiance", f"  unit: {_quoted(stated[0])}"]
    questions.append("spectrometer.unit: the spectra look like radiances; in which unit?")
    return ["  quantity: spectral_radiance", "  unit: W/m2/sr/nm  # ?"]


def _attributes(folder, read, pyrometer, spectrometer, kinds, questions):
    """Lines of the attributes: events from the signals where there are any, the rest asked for."""
    begin, end, window = _events(read)
    rows = [
        ("title", _quoted(folder.resolve().name), ""),
        ("origin", "measured", ""),
        ("condition", "none", "? the simulation to compare with, such as 90kW"),
        ("injection_time", f"{begin:.6g}", "? s, sample in the plasma"),
        ("plasma_off_time", f"{end:.6g}", "? s; guessed from the signal where it begins to fall for good"),
        ("reference_window", f"[{window[0]:.6g}, {window[1]:.6g}]", "? s: plasma shines, surface still dark"),
        ("emittance", "0.85", "? of the surface in the bands"),
        ("emittance_uncertainty", "0.1", "?"),
    ]
    if pyrometer:
        rows += [
            ("window_transmittance_pyrometer", "0.9", f"? {OF_WINDOW}"),
            ("pyrometer_integration_time", "0.01", "? s"),
        ]
    if spectrometer:
        width, exposure, stated = 1.5e-9, None, None
        if "folder:" in spectrometer[0]:
            spectrum = ocean.read_spectrum(kinds["spectrum"][0][0])
            # A slit is as wide as two pixels or more, or the maker has wasted some.
            width, exposure = 2 * np.median(np.diff(spectrum.wavelength)), spectrum.integration_time
        elif "  format: andor" in spectrometer:
            exposure = np.nan  # its header brings it
        else:
            stated = ocean.stated_exposure([path for path, _ in kinds["matrix"]])
        rates = [path for kind in ("spectrum", "matrix") for path, _ in kinds.get(kind, [])[:1]]
        if exposure is None and any(map(ocean.states_rates, rates)):
            stated = 1.0
            questions.append(
                "spectrometer: the spectra are counts per second; they are read as counts of 1 s"
            )
        rows += [
            ("window_transmittance_spectrometer", "0.9", f"? {OF_WINDOW}"),
            ("spectrometer_fwhm", f"{width:.2g}", "? m"),
        ]
        rows += [("spectrometer_integration_time", f"{stated or 0.1:g}", "? s")] * (exposure is None)
    questions += [
        f"attributes.{name}: {words.lstrip('? ') or 'not in the files'}" for name, _, words in rows if words
    ]
    return [f"  {name}: {value}" + (f"  # {words}" if words else "") for name, value, words in rows]


def _events(read):
    """Injection, end of the plasma and reference window [s] as the signals show them."""
    if "signal_wide" not in read or len(read["time"]) < 4:
        return 0.0, 100.0, (0.0, 5.0)
    time, pair = read["time"], np.stack([read[name] for name in parts.SIGNALS])
    begin = 0.0 if time[0] <= 0 < time[-1] else float(time[0])
    wide = np.nan_to_num(pair[np.isnan(pair).sum(axis=1).argmin()], nan=-np.inf)  # one may be saturated
    last = int(np.flatnonzero(wide >= PLATEAU * wide.max())[-1]) if wide.max() > 0 else time.size - 1
    inside = np.flatnonzero(time >= begin)
    end = float(time[max(last, min(inside[0] + 4, time.size - 1))])
    least = float(time[min(inside[0] + 3, time.size - 1)])
    window = (begin, max(begin + FIRST_WINDOW * (end - begin), least))
    with np.errstate(all="ignore"):  # a wrong unit or a damaged number: `check` says it
        found = onset.attributes("seen", time, pair, window, end)
    proposed = found.get("seen_proposed_window")
    return begin, end, (begin, max(float(proposed[1]), least)) if proposed is not None else window
