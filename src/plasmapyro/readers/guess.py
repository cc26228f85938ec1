"""A first description of a folder of raw files: what they seem to hold, and what only a person knows."""

import json
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
from plasmapyro.readers.text import MISSING, Refusal, number, read_lines
from plasmapyro.record import onset

MOST_FILES, MOST_ROWS = 20_000, 400  # looked at: of a folder, of a table
USUAL = 0.9  # of the rows: cells of a column that must be numbers or dates
PLATEAU = 0.98  # of the highest signal: the plasma is taken to end when the signal last had it
FIRST_WINDOW = 0.1  # of the exposure, where no growth shows the surface
NAMES = {  # label in lower case, without blanks, '_', '-' and '.', for those without a telling unit
    "time": r"t|time.*|\u6642.*|zeit.*|uhr.*|clock.*|datum.*|date.*|tiempo.*|temps.*|tempo|stamp.*|sec.*"
    r"|elapsed.*",
    "signal_wide": r".*s1|.*wide.*|.*breit.*|.*ancha?|.*larg[ea].*|.*\u5e83.*"
    r"|.*(ch(annel)?|kanal|voie|canale?)1|.*i1|.*det(ector)?1|.*band1|.*signal1|q",
    "signal_narrow": r".*s2|.*narrow.*|.*schmal.*|.*estrecha?|.*[\u00e9e]troit.*|.*strett.*|.*\u72ed.*"
    r"|.*(ch(annel)?|kanal|voie|canale?)2|.*i2|.*det(ector)?2|.*band2|.*signal2|r",
    "electric_power": r"p?el|pel.*|.*power.*|.*leistung.*|.*potencia.*|.*puissance.*",
    "chamber_pressure": r"pc.*|pch.*|.*press.*|.*druck.*|.*presi.n.*",
    "mass_flow_rate": r"mdot|.*massflow.*|.*flow.*|.*durchfluss.*|.*caudal.*|.*debit.*",
}
OF_UNIT = {
    "s": "time",
    "A": "signals",
    "W": "electric_power",
    "Pa": "chamber_pressure",
    "kg s-1": "mass_flow_rate",
}
WAVE = re.compile(r"\W*(lambda|\u03bb|wave|wellenl)", re.IGNORECASE)
WORDS = re.compile(r"[^\W\d]{3}")
MULTIPLE = re.compile(r"(\d+\.?\d*)\s*(\D+)")  # a unit of so many units: ticks of 0.1 ms
DATES = (
    "%d.%m.%Y",
    "%Y-%m-%d",
    "%d/%m/%Y",
    "%m/%d/%Y",
    "%d-%m-%Y",
    "%Y/%m/%d",
    "%Y.%m.%d",
    "%d.%m.%y",
    "%m/%d/%y",
)
TIMES = ("%H:%M:%S", "%H:%M", "%I:%M:%S %p", "%H:%M:%S%z")
FORMATS = [f"{day}{gap}{hour}" for day in DATES for gap in " T" for hour in TIMES] + list(TIMES)
OTHERS = set(".yaml .yml .nc .md .pdf .png .jpg .html .py .xlsx .zip".split())
DAYS = (30_000, 800_000)  # dates as spreadsheets (1982 on) and Matlab count them
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
    """The `Table` in a text file, or None if it does not look like one with a header.

    The delimiter is the one that makes most columns of numbers or dates.
    """
    lines = [line for line in read_lines(path, columns.LARGEST)[0] if line.strip()][
        : columns.HEADER_LINES + MOST_ROWS
    ]
    seen, best = set(), None  # a header may stand above each block of a record
    lines = [line for line in lines if not (line in seen or seen.add(line)) or not WORDS.search(line)]
    for name, mark in columns.DELIMITERS.items():
        rows = [columns.split(line.lstrip("#%! "), mark) for line in lines]
        good = [sum(map(_is_value, row)) >= 2 for row in rows]
        begins = [i for i in range(1, len(rows)) if good[i] and not good[i - 1]]
        if not begins:
            continue
        # Above the table there may be blocks of a few numbers: the longest run is it, with comments inside.
        remarks = [line.lstrip().startswith(columns.COMMENT) for line in lines]
        passed = [*map(any, zip(good, remarks, strict=True)), False]
        first = max(begins, key=lambda i, passed=passed: passed.index(False, i) - i)
        body = [
            row
            for row, line in zip(rows[first:], lines[first:], strict=True)
            if not line.lstrip().startswith(columns.COMMENT)
        ]
        header, below = rows[first - 1], columns.units_below(rows[first - 1])
        if not below and first > 2 and columns.units_below(rows[first - 2]):  # remarks below the units
            first -= 1
            header, below = rows[first - 1], columns.units_below(rows[first - 1])
        if below and first > 1 and len(rows[first - 2]) == len(header):
            header = [
                f"{name} [{unit}]" if unit else name
                for name, unit in zip(rows[first - 2], below, strict=True)
            ]
        cells = [[row[place] for row in body if place < len(row)] for place in range(len(header))]
        held = [place for place, words in enumerate(cells) if _is_column(words) and header[place]]
        if len(held) >= 2 and (best is None or len(held) > best[0]):
            best = (
                len(held),
                name,
                [columns._label(header[place]) for place in held],
                [cells[place] for place in held],
            )
    if best is None:
        return None
    _, name, labels, cells = best
    commas = any("," in word and not clock.looks_like_stamp(word) for words in cells for word in words)
    decimal = "," if commas and name != "," else "."
    return Table(name, decimal, [label for label, _ in labels], [unit for _, unit in labels], cells)


def _is_value(word):
    return clock.looks_like_stamp(word) or any(
        number(word, sign) is not None and word.lower() not in MISSING for sign in ".,"
    )


def _is_column(words):
    known = [word for word in words if word.lower() not in MISSING]
    return len(known) > 0 and np.mean([_is_value(word) for word in known]) >= USUAL


def assign(table):
    """Which column holds which variable (variable -> place); dates and times of day under 'stamps'."""
    found, stamps = {}, [i for i, words in enumerate(table.cells) if any(map(clock.looks_like_stamp, words))]
    free = [place for place in range(len(table.labels)) if place not in stamps]
    if any(WAVE.match(label) for label in table.labels):
        return {}  # a spectrum, whatever its columns rise like
    currents = []
    for place in list(free):
        variable = next(
            (
                OF_UNIT[si]
                for si, known in units.TO_SI.items()
                if si in OF_UNIT and table.units[place] and units.normalised(table.units[place]) in known
            ),
            None,
        )
        if variable == "signals":
            currents.append(place)
        elif variable and variable not in found and not (variable == "time" and stamps):
            found[variable] = place
            free.remove(place)
    for variable, pattern in NAMES.items():
        if variable in found or (variable == "time" and stamps):
            continue
        among = [p for p in free if p in currents] if variable.startswith("signal") and currents else free
        place = next(
            (
                p
                for p in among
                if table.units[p] is None or _suits(table.units[p], variable)
                if re.fullmatch(pattern, re.sub(r"[\s_.\-]", "", table.labels[p].lower()))
            ),
            None,
        )
        if place is not None:
            found[variable] = place
            free.remove(place)
    if stamps:
        found["stamps"] = stamps[:2]
    elif "time" not in found and free and (np.diff(_values(table, free[0])) > 0).all():
        found["time"] = free.pop(0)
    open_ones = [name for name in parts.SIGNALS if name not in found]
    rest = [place for place in free if place in currents] or free
    if len(open_ones) == len(rest) and "time" in (*found, *(["time"] if stamps else [])):
        # The wide band sees more: without names the larger signal is taken as the wide one.
        order = sorted(rest, key=lambda place: -np.nanmedian(_values(table, place)))
        found |= dict(zip(open_ones, order if len(order) == 2 else rest, strict=True)) | {
            "by size": len(order) == 2
        }
    return found


def _suits(unit, variable):
    return units.factor(unit, variable) is not None


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
        for path in sorted(folder.rglob("*"), key=lambda path: parts.natural(str(path)))
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
            remarks += [f"not used: {words}" for words in reason.messages]
            continue
        if kind:
            kinds.setdefault(kind, []).append((path, what))
        elif path.suffix.lower() not in OTHERS:
            unknown.append(path.relative_to(folder).as_posix())
    if unknown:
        more = f" and {len(unknown) - 1} more" if len(unknown) > 1 else ""
        remarks.append(
            f"not used: {unknown[0]}{more}: neither signals against time nor spectra are seen in it"
        )
    questions, blocks = [], []
    pyrometer = _pyrometer(folder, kinds, questions)
    read = _read(folder, "pyrometer", pyrometer, questions)
    spectrometer = _spectrometer(folder, kinds, read, questions)
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
                f"{folder}: nothing looks like signals of a pyrometer or spectra ({seen}); a table needs a"
                " header with names above its columns, see docs/your-own-data.md",
                *remarks,
            ]
        )
    attributes = _attributes(folder, read, bool(pyrometer), kinds if spectrometer else None, questions)
    head = [
        "# Guessed from the files; every '?' is a question that no file answers: correct what is wrong, then",
        "#   plasmapyro check FOLDER",
    ]
    asked = [
        " ".join(printable(words).split()) for words in [*questions, *remarks]
    ]  # names may hold line ends
    head += [f"# ? {words}" for words in asked]
    return Guess("\n".join([*head, "attributes:", *attributes, *blocks]) + "\n", asked)


def _kind(path):
    """Which of tdms, spectrum, burst, matrix, pyrometer, tunnel a file seems to be, and what it holds."""
    if path.suffix.lower() in OTHERS:
        return None, None
    if path.suffix.lower() == ".tdms":
        return "tdms", None
    lines = [line for line in read_lines(path, columns.LARGEST)[0][: ocean.HEADER_LINES] if line.strip()]
    if any(line.startswith(ocean.FENCE) for line in lines) or ocean.plain_spectrum(lines):
        return "spectrum", None
    data = [line for line in lines if not line.lstrip().startswith(columns.COMMENT)]
    try:
        if data and {"Q", "R"} <= burst._line(data[0])[1].keys():
            return "burst", burst._line(data[0])
    except ValueError:
        pass
    if data and (matrix := _matrix(data)):
        return "matrix", matrix
    table = look_at_table(path)
    if table is None:
        return None, None
    places = assign(table)
    if set(parts.SIGNALS) <= places.keys() and {"time", "stamps"} & places.keys():
        return "pyrometer", (table, places)
    if set(parts.TUNNEL) & places.keys() and {"time", "stamps"} & places.keys():
        return "tunnel", (table, places)
    return None, None


def _matrix(lines):
    """Unit of the wavelengths and delimiter, if a line holds rising or falling wavelengths behind one cell.

    Or, below a cell that names wavelengths, the first column does.
    """
    for name, mark in columns.DELIMITERS.items():
        rows = [columns.without_empty_end(columns.split(line, mark)) for line in lines]
        start = next((i for i, row in enumerate(rows[:-1]) if len(row) > 1 and len(row) == len(rows[-1])), 0)
        upright = columns.names_wavelengths(rows[start][0])
        listed = [row[0] for row in rows[start + 1 :]] if upright else rows[start][1:]
        values = [number(word, "," if "," in word else ".") for word in listed]
        if len(values) > 2 and None not in values and abs(np.sign(np.diff(values)).sum()) == len(values) - 1:
            values.sort()
            for unit, scale in (("nm", 1e-9), ("um", 1e-6), ("m", 1.0), ("Angstrom", 1e-10)):
                if unit == "Angstrom" and not columns.ANGSTROM.search(rows[start][0]):
                    continue
                if 1.5e-7 < values[0] * scale and values[-1] * scale < 5e-6:
                    return unit, name
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
    if "burst" in kinds:
        paths = [path for path, _ in kinds["burst"]]
        stamp, items = kinds["burst"][0][1]
        found = [_named(folder, paths), "  format: marathon"]
        if stamp is None:
            found.append("  period: 0.1  # ? s between lines, the log has no times")
            questions.append("pyrometer.period: how many seconds lie between two lines of the log?")
        elif len(paths) > 1:
            questions.append(
                "pyrometer.zero: several logs need the clock time that shall be 0, e.g. '14:02:10.5'"
            )
        if items.get("S", 1.0) != 1.0 or items.get("B", 0.0) != 0.0:
            found.append("  undo: []  # ? whether Q and R contain slope or attenuation")
            questions.append(
                "pyrometer.undo: do Q and R contain the slope or the attenuation? docs/your-own-data.md"
            )
        return found
    if "tdms" in kinds:
        return _tdms(folder, [path for path, _ in kinds["tdms"]], questions)
    return []


def _table_lines(folder, paths, table, places, questions):
    """Lines of a section for a text table."""
    found = [_named(folder, paths), f"  delimiter: {_quoted(table.delimiter)}"]
    if table.decimal == ",":
        found.append('  decimal: ","')
    if "stamps" in places:
        form, zero, more = _format(table, places["stamps"])
        questions += more
        names = [_quoted(table.labels[place]) for place in places["stamps"]]
        found.append(
            f"  zero: {_quoted(zero)}  # ? what shall be 0, best the injection; here the first sample"
        )
        name = names[0] if len(names) == 1 else f"[{', '.join(names)}]"
        timing = f"    time: {{name: {name}, format: {_quoted(form)}}}"
    else:
        time = _values(table, places["time"])
        unit, stated, scale = table.units[places["time"]], True, 1.0
        several = MULTIPLE.fullmatch(unit or "")
        if several and _suits(several[2], "time"):
            unit, stated, scale = several[2], False, float(several[1])
        elif unit is None or not _suits(unit, "time"):
            stated, unit = False, "ms" if np.nanmedian(np.diff(time)) >= 5 else "s"
            if DAYS[0] < time[0] < DAYS[1] and time[-1] - time[0] < 1:
                unit = "d"  # of a spreadsheet: days since 1900
            questions.append(f"pyrometer.columns.time.unit: is the time in {unit}? no file says it")
        first = float(time[0]) * units.factor(unit, "time") * scale
        if first > 0:
            found.append(f"  zero: {first:.10g}  # ? s, what shall be 0, best the injection; here the first")
        timing = f"    time: {{name: {_quoted(table.labels[places['time']])}" + (
            "}" if stated else f", unit: {unit}" + (f", scale: {scale:g}" if scale != 1 else "") + "}  # ?"
        )
    found += ["  columns:", timing]
    for variable in (*parts.SIGNALS, *parts.TUNNEL):
        if variable in places:
            found.append(_column(variable, table, places[variable], questions))
    if places.get("by size"):
        questions.append(
            "pyrometer.columns: which signal is the wide band? the larger one is taken, no name says it"
        )
    return found


def _column(variable, table, place, questions):
    label, unit = table.labels[place], table.units[place]
    if unit is not None and _suits(unit, variable):
        return f"    {variable}: {{name: {_quoted(label)}}}"
    usual = {"W": "kW", "Pa": "mbar", "kg s-1": "g/s"}.get(VARIABLES[variable].units)
    if usual is None:
        usual = "A" if np.nanmax(np.abs(_values(table, place))) < LARGEST_CURRENT else "nA"
    questions.append(f"columns.{variable}.unit: is {label!r} in {usual}? no file says it")
    return f"    {variable}: {{name: {_quoted(label)}, unit: {usual}}}  # ?"


def _format(table, places):
    """Format of dates that reads all cells with the shortest record, its first stamp, and questions."""
    stamps = [" ".join(words) for words in zip(*(table.cells[place] for place in places), strict=True)]
    known = [word for word in stamps if word.strip() and word.lower() not in MISSING]
    spans = {}
    for form in FORMATS:
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
    found = {}
    for variable, pattern in NAMES.items():
        for place, (label, unit) in enumerate(zip(table.labels, table.units, strict=True)):
            plain = re.sub(r"[\s_.\-]", "", label.lower())
            if (
                variable not in found
                and (unit is None or _suits(unit, variable))
                and re.fullmatch(pattern, plain)
            ):
                found[variable] = place
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
    questions += faults
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
        spectrum = ocean.read_spectrum(light[0])
        found += _quantity(
            next(iter(spectrum.columns.values())) if len(spectrum.columns) == 1 else None, questions
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
    return _matrix_lines(folder, kinds["matrix"], [], questions) if "matrix" in kinds else []


def _matrix_lines(folder, listed, dark, questions):
    """Lines of the section 'spectrometer' for tables of spectra; `dark`: files of single spectra."""
    dark = [path for path, _ in listed if ocean.DARK.search(path.stem)] + dark
    tables = [path for path, _ in listed if path not in dark]
    if not tables:
        questions.append(f"{dark[0].name} looks like a dark, and no table like its spectra")
        return []
    unit, mark = dict(listed)[tables[0]]
    lines = [line for line in read_lines(tables[0], columns.LARGEST)[0] if line.strip()]
    begins = [columns.split(line, columns.DELIMITERS[mark])[0] for line in lines[-MOST_ROWS:]]
    stamps = [word for word in begins if clock.looks_like_stamp(word)]
    timing = []
    if stamps:
        form, zero, more = _format(Table(mark, ".", ["time"], [None], [stamps]), [0])
        questions += [
            words.replace("pyrometer.columns.time.format", "spectrometer.time_format") for words in more
        ]
        timing = [
            f"  time_format: {_quoted(form)}",
            f"  zero: {_quoted(zero)}  # ? the moment that shall be 0",
        ]
    values = columns.read_matrix(tables[0], mark, stamps=(form, zero) if stamps else None)[2]
    found = [
        _named(folder, tables),
        f"  delimiter: {_quoted(mark)}",
        *_quantity(values, questions, table=True),
        *timing,
    ]
    if unit != "nm":
        found.append(f"  wavelength_unit: {unit}")
    if dark:
        found.append(f"  background: {_quoted(dark[0].relative_to(folder).as_posix())}")
    return found


def _quantity(values, questions, table=False):
    """Whether spectra are counts, by their size: a converter gives up to some 2^16."""
    if values is None or 20 < np.nanmax(values) < 70_000:
        return ["  quantity: counts", *(["  unit: count"] if table else [])]
    questions.append("spectrometer.unit: the spectra look like radiances; in which unit?")
    return ["  quantity: spectral_radiance", "  unit: W/m2/sr/nm  # ?"]


def _attributes(folder, read, pyrometer, kinds, questions):
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
            ("window_transmittance_pyrometer", "0.9", "?"),
            ("pyrometer_integration_time", "0.01", "? s"),
        ]
    if kinds:
        width, exposure = 1.5e-9, None
        if "spectrum" in kinds:
            spectrum = ocean.read_spectrum(kinds["spectrum"][0][0])
            # A slit is as wide as two pixels or more, or the maker has wasted some.
            width, exposure = 2 * np.median(np.diff(spectrum.wavelength)), spectrum.integration_time
        rows += [
            ("window_transmittance_spectrometer", "0.9", "?"),
            ("spectrometer_fwhm", f"{width:.2g}", "? m"),
        ]
        rows += [("spectrometer_integration_time", "0.1", "? s")] * (exposure is None)
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
    wide = np.nan_to_num(pair[0], nan=-np.inf)
    last = int(np.flatnonzero(wide >= PLATEAU * wide.max())[-1]) if wide.max() > 0 else time.size - 1
    inside = np.flatnonzero(time >= begin)
    end = float(time[max(last, min(inside[0] + 4, time.size - 1))])
    least = float(time[min(inside[0] + 3, time.size - 1)])
    window = (begin, max(begin + FIRST_WINDOW * (end - begin), least))
    found = onset.attributes("seen", time, pair, window, end)
    proposed = found.get("seen_proposed_window")
    return begin, end, (begin, max(float(proposed[1]), least)) if proposed is not None else window
