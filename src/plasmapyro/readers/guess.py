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
from plasmapyro.readers import burst, clock, columns, ocean, parts, spectra_table, tdms, units
from plasmapyro.readers.description import Section
from plasmapyro.readers.dialects import ARRAYS, table_lines
from plasmapyro.readers.guess_table import (
    INDIRECT,
    MOST_ROWS,
    NAMES,
    TUNNEL_UNITS,
    VOLTS,
    Table,
    assign,
    by_name,
    gains_of,
    look_at_table,
    stamp_format,
    suits,
    values_of,
)
from plasmapyro.readers.text import Refusal, number, quote, read_lines, refuse
from plasmapyro.record import onset

MOST_FILES = 20_000  # of a folder
PLATEAU = 0.98  # of the highest signal: the plasma is taken to end when the signal last had it
OF_WINDOW = "kept for the record: calibrate through it, or state window_transmittance in calibration.yaml"
OF_ZERO = "what shall be 0, best the injection"
FIRST_WINDOW = 0.1  # of the exposure, where no growth shows the surface
GUIDE = "docs/your-own-data.md"
MULTIPLE = re.compile(r"(\d+\.?\d*)\s*(\D+)")  # a unit of so many units: ticks of 0.1 ms
OTHERS = set(
    ".yaml .yml .md .pdf .png .jpg .jpeg .tif .gif .mp4 .avi .html .py .m .docx .pptx .ini .db .lnk".split()
)
EPOCH = (1e9, 3e9)  # [s] since 1970: 2001 to 2065
DAYS = (30_000, 800_000)  # dates as spreadsheets (1982 on) and Matlab count them
DAY_PART = 1.0  # a record without a unit that ends before: times of day as spreadsheets count them
# ASSUME: currents without a unit are amperes if as small as photodiodes give them, else nanoamperes.
LEAST_GAIN = 1e3  # [V/A] of amplifiers of photodiodes
LARGEST_CURRENT = 0.1  # [A]


class Guess(NamedTuple):
    """Lines of test.yaml, and what a person must answer."""

    text: str
    questions: list


def _quoted(word):
    return json.dumps(word, ensure_ascii=not word.isprintable())


def describe(folder):
    """A first test.yaml for a folder of raw files; Refusal if nothing in it looks like signals or spectra."""
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
    tunnel = kinds.get("tunnel", [])
    for path, (table, _) in tunnel[1:] if pyrometer else tunnel:
        why = (
            "one log of the tunnel is read; bring its columns into that one"
            if pyrometer
            else "; ".join(_without_signals(table))
        )
        remarks.append(f"not used: {path.name}: {why}")
    if pyrometer:
        blocks += ["pyrometer:", *pyrometer]
    if spectrometer:
        blocks += ["spectrometer:", *spectrometer]
    if pyrometer and tunnel:
        path, (table, places) = tunnel[0]
        blocks += ["tunnel:", *_table_lines(folder, [path], table, places, questions)]
    if not blocks:
        seen = ", ".join(sorted({path.suffix or path.name for path in files})) or "no files"
        raise Refusal(
            [
                f"{folder}: nothing looks like signals of a pyrometer or spectra ({seen}); a table needs"
                " names above its columns and one row per sample, such as 'Time [s];wide [nA];narrow [nA]',"
                f" see {GUIDE}",
                *_grouped(remarks),
            ]
        )
    remarks += _left_out(folder, kinds, blocks, [*questions, *remarks])
    attributes = _attributes(folder, read, bool(pyrometer), spectrometer, kinds, questions)
    head = [
        "# Guessed from the files; every '?' is a question that no file answers: correct what is wrong, then",
        "#   plasmapyro check FOLDER",
    ]
    asked = [
        " ".join(printable(words).split()) for words in [*questions, *_grouped(remarks)]
    ]  # names may hold line ends
    head += [f"# ? {words}" for words in asked]
    return Guess("\n".join([*head, "attributes:", *attributes, *blocks]) + "\n", asked)


SEEN_AS = {"andor": "a series of Andor Solis", "matrix": "a table of spectra", "burst": "a burst log"}


def _left_out(folder, kinds, blocks, said):
    """Remarks on files that were recognised, but stand in no line of test.yaml, nor are spoken of."""
    lines, spoken = "\n".join(blocks), "\n".join(said)
    series = {folder / name for name in re.findall(r'^  folder: "(.*)"$', lines, re.MULTILINE)}
    return [
        f"not used: {name}: looks like {SEEN_AS.get(kind, f'a {kind}')} beside what is read; take it out, or"
        " name it in test.yaml"
        for kind, listed in kinds.items()
        for path, _ in listed
        for name in [path.relative_to(folder).as_posix()]
        if _quoted(name) not in lines
        and not (kind == "spectrum" and path.parent in series)
        and path.name not in spoken
    ]


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
    if fenced and spectra_table.series_lines(lines) is lines or not fenced and ocean.plain_spectrum(every):
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
    if len(table.labels) > spectra_table.MOST_OF_LONG and table.labels[0] == "column 1":
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
    refuse(path, *_without_signals(table))


def _without_signals(table):
    """What is missing in a table that is no pyrometer's, and what to do."""
    listed = ", ".join(quote(label) for label in table.labels[:10])
    if any(unit and units.factor(unit, "source_temperature") for unit in table.units):
        why = "temperatures alone cannot be corrected; name two columns of signals, or see `radiometer`"
    else:
        why = "name the signals, e.g. 'wide [nA]' and 'narrow [nA]', and the time; one row per sample"
    return f"no two signals against time are seen in its columns {listed}", f"{why}, in {GUIDE}"


def _matrix(path, lines):
    """Unit of the wavelengths and delimiter, if a line holds rising or falling wavelengths behind one cell.

    Or, below a cell that names wavelengths, the first column does; if they are none, Refusal.
    """
    lines = spectra_table.series_lines(lines)
    for name, mark in columns.DELIMITERS.items():
        rows = [columns.without_empty_end(columns.split(line, mark)) for line in lines]
        start = next((i for i, row in enumerate(rows[:-1]) if len(row) > 1 and len(row) == len(rows[-1])), 0)
        upright = spectra_table.upright_row(rows)
        if upright is not None and len(rows[upright]) > len(rows[-1]):
            continue
        start = start if upright is None else upright
        spare = spectra_table.spare_columns(rows[start])
        listed = rows[start][1 + spare :] if upright is None else [row[0] for row in rows[start + 1 :]]
        if long := spectra_table.long_places(rows[start]):
            listed = [row[long[0]] for row in rows[start + 1 :] if len(row) > long[0]]
            listed = listed[: listed.index(listed[0], 1)] if listed[0] in listed[1:] else listed
        values = [number(word, "," if "," in word else ".") for word in listed]
        if len(values) > 2 and None not in values and abs(np.sign(np.diff(values)).sum()) == len(values) - 1:
            values.sort()
            for unit, scale in (("nm", 1e-9), ("um", 1e-6), ("m", 1.0), ("Angstrom", 1e-10)):
                if unit == "Angstrom" and not spectra_table.ANGSTROM.search(rows[start][0]):
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
    sizes = [-np.nanmedian(values_of(table, places["band"])) for _, (table, places) in listed]
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
        time = values_of(table, places["time"])
        unit, stated, scale = table.units[places["time"]], True, 1.0
        several = MULTIPLE.fullmatch(unit or "")
        if several and suits(several[2], "time"):
            unit, stated, scale = several[2], False, float(several[1])
        elif unit is None or not suits(unit, "time"):
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
    gains = gains_of(table, [place for place in places.values() if type(place) is int])
    for variable in (*parts.SIGNALS, *parts.TUNNEL):
        if variable in places:
            gain = None
            if gains and variable in parts.SIGNALS:
                gain = gains.pop(0) if len(gains) > 1 else gains[0]
            found.append(_column(variable, table, places[variable], questions, gain))
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


def _column(variable, table, place, questions, gain=None):
    label, unit = table.labels[place], table.units[place]
    if gain is not None:
        values, name = values_of(table, gain), table.labels[gain]
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        volt = VOLTS.get(units.normalised(unit)) if unit else None
        if volt and low >= LEAST_GAIN:
            questions.append(f"columns.{variable}.gain: {label!r} is divided by {name!r}, volts per ampere?")
            described = f"name: {_quoted(label)}, unit: A, scale: {volt:g}, gain: {_quoted(name)}"
            return f"    {variable}: {{{described}}}  # ?"
        if low < high:
            questions.append(
                f"columns.{variable}.gain: {name!r} goes from {low:g} to {high:g}, and {label!r} is taken as"
                f" it stands; if it must be divided by it row by row, add `gain: {name}`"
            )
    if unit is not None and suits(unit, variable):
        return f"    {variable}: {{name: {_quoted(label)}}}"
    if unit is not None and (each := INDIRECT.get(units.normalised(unit))) and variable in parts.SIGNALS:
        questions.append(
            f"columns.{variable}.scale: {label!r} is in {unit}: how many amperes is one? {each:g} is taken"
        )
        return f"    {variable}: {{name: {_quoted(label)}, unit: A, scale: {each:g}}}  # ?"
    usual = TUNNEL_UNITS.get(VARIABLES[variable].units)
    if usual is None:
        usual = "A" if np.nanmax(np.abs(values_of(table, place))) < LARGEST_CURRENT else "nA"
    questions.append(f"columns.{variable}.unit: is {label!r} in {usual}? no file says it")
    return f"    {variable}: {{name: {_quoted(label)}, unit: {usual}}}  # ?"


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
    places = {variable: by_name(table, variable, range(len(names))) for variable in NAMES}
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
    single = [path for path, _ in kinds.get("spectrum", [])]
    dark = [path for path in single if ocean.DARK.search(path.stem)]
    light = [path for path in single if path not in dark]
    if light:
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
    # A table of spectra may have a dark in a file of its own.
    return _matrix_lines(folder, kinds["matrix"], dark, questions) if "matrix" in kinds else []


def _series(place, light, dark):
    """Pattern of the names of the largest series in a folder, its files, and the names of the others."""
    groups = {}
    for path in light:
        groups.setdefault(re.sub(r"\d+", "*", path.name), []).append(path)
    pattern, series = max(groups.items(), key=lambda item: len(item[1]))
    held = [path for path in place.glob("[!.]*") if path.suffix.lower() in parts.SPECTRUM_SUFFIXES]
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
    lines = spectra_table.series_lines(read_lines(tables[0], columns.LARGEST)[0])
    lines = [line for line in lines if line.strip()]
    rows = [columns.split(line, columns.DELIMITERS[mark]) for line in lines]
    upright = spectra_table.upright_row(rows)
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
    times, _, values = spectra_table.read_matrix(tables[0], mark, stamps=(form, zero) if stamps else None)
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
