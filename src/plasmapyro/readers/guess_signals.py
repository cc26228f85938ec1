"""What a first description says of the pyrometer and the tunnel: sections from files of signals."""

import re

import numpy as np

from plasmapyro.contracts import VARIABLES
from plasmapyro.readers import parts, tdms, units
from plasmapyro.readers.description import in_yaml
from plasmapyro.readers.guess_table import (
    INDIRECT,
    NAMES,
    TUNNEL_UNITS,
    VOLTS,
    Table,
    by_name,
    file_line,
    gains_of,
    stamp_format,
    suits,
    values_of,
)

OF_ZERO = "what shall be 0, best the injection"
MULTIPLE = re.compile(r"(\d+\.?\d*)\s*(\D+)")  # a unit of so many units: ticks of 0.1 ms
EPOCH = (1e9, 3e9)  # [s] since 1970: 2001 to 2065
DAYS = (30_000, 800_000)  # dates as spreadsheets (1982 on) and Matlab count them
DAY_PART = 1.0  # a record without a unit that ends before: times of day as spreadsheets count them
LEAST_GAIN = 1e3  # [V/A] of amplifiers of photodiodes
# ASSUME: currents without a unit are amperes if as small as photodiodes give them, else nanoamperes.
LARGEST_CURRENT = 0.1  # [A]


def pyrometer_section(folder, kinds, questions):
    """Lines of the section 'pyrometer'; empty if no file has its signals."""
    if "pyrometer" in kinds:
        (_, (table, places)), *others = kinds["pyrometer"]
        same = [path for path, (other, _) in kinds["pyrometer"] if other.labels == table.labels]
        questions += [
            f"{path.name} looks like signals too and is not used"
            for path, (o, _) in others
            if o.labels != table.labels
        ]
        return table_section(folder, same, table, places, questions)
    if bands := _bands(folder, kinds.get("band", []), questions):
        return bands
    if "burst" in kinds:
        paths = [path for path, _ in kinds["burst"]]
        stamp, items = kinds["burst"][0][1]
        found = [file_line(folder, paths), "  format: marathon"]
        if stamp is None:
            found.append("  period: 0.1  # ? s between lines, the log has no times")
            questions.append("pyrometer.period: how many seconds lie between two lines of the log?")
        else:
            found.append(f"  zero: {in_yaml(stamp)}  # ? {OF_ZERO}; here the first line")
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
    lines = table_section(folder, [listed[0][0]], table, places, questions)[1:]
    for variable, one in zip(parts.SIGNALS, order, strict=True):
        path, (table, places) = listed[one]
        line = _column(variable, table, places["band"], questions)
        name = in_yaml(path.relative_to(folder).as_posix())
        lines.append(line.replace("{name:", f"{{file: {name}, name:", 1))
    return lines


def table_section(folder, paths, table, places, questions):
    """Lines of a section for a text table."""
    found = [file_line(folder, paths), f"  delimiter: {in_yaml(table.delimiter)}"]
    if table.decimal == ",":
        found.append('  decimal: ","')
    if "stamps" in places:
        form, zero, more = stamp_format(table, places["stamps"])
        questions += more
        names = [in_yaml(table.labels[place]) for place in places["stamps"]]
        found.append(f"  zero: {in_yaml(zero)}  # ? {OF_ZERO}; here the first sample")
        name = names[0] if len(names) == 1 else f"[{', '.join(names)}]"
        more = (
            f", milliseconds: {in_yaml(table.labels[places['milliseconds']])}"
            if "milliseconds" in places
            else ""
        )
        timing = f"    time: {{name: {name}, format: {in_yaml(form)}{more}}}"
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
        timing = f"    time: {{name: {in_yaml(table.labels[places['time']])}" + (
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
            described = f"name: {in_yaml(label)}, unit: A, scale: {volt:g}, gain: {in_yaml(name)}"
            return f"    {variable}: {{{described}}}  # ?"
        if low < high:
            questions.append(
                f"columns.{variable}.gain: {name!r} goes from {low:g} to {high:g}, and {label!r} is taken as"
                f" it stands; if it must be divided by it row by row, add `gain: {name}`"
            )
    if unit is not None and suits(unit, variable):
        return f"    {variable}: {{name: {in_yaml(label)}}}"
    if unit is not None and (each := INDIRECT.get(units.normalised(unit))) and variable in parts.SIGNALS:
        questions.append(
            f"columns.{variable}.scale: {label!r} is in {unit}: how many amperes is one? {each:g} is taken"
        )
        return f"    {variable}: {{name: {in_yaml(label)}, unit: A, scale: {each:g}}}  # ?"
    usual = TUNNEL_UNITS.get(VARIABLES[variable].units)
    if usual is None:
        usual = "A" if np.nanmax(np.abs(values_of(table, place))) < LARGEST_CURRENT else "nA"
    questions.append(f"columns.{variable}.unit: is {label!r} in {usual}? no file says it")
    return f"    {variable}: {{name: {in_yaml(label)}, unit: {usual}}}  # ?"


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
    lines = [file_line(folder, paths), "  columns:"]
    for variable, place in found.items():
        name, unit = list(names)[place], table.units[place]
        usual = "s" if variable == "time" else "A"
        if unit is None:
            questions.append(f"columns.{variable}.unit: is {name!r} in {usual}? no file says it")
        lines.append(
            f"    {variable}: {{name: {in_yaml(name)}" + ("}" if unit else f", unit: {usual}}}  # ?")
        )
    return lines
