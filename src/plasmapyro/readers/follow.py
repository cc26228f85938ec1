"""Samples of a pyrometer as they come: from a text table that grows, or as JSON lines."""

import json
import time
from pathlib import Path

import numpy as np

from plasmapyro.readers import clock, columns, parts
from plasmapyro.readers.cells import COMMENT, split
from plasmapyro.readers.text import Refusal, number, quote, refuse

POLL = 0.005  # [s] between two looks at a file: a tenth of the delay that is promised
LONGEST = 65_536  # [byte] of one line
EVENTS = ("injection", "plasma_off")


def growing(path, patience=np.inf, poll=POLL):
    """Lines of a text file as they are completed; None at each look that finds no more.

    Ends when nothing has come for `patience` [s]; looks every `poll` [s]. Refusal if the file shrinks, or a
    line has no end.
    """
    with open(path, "rb") as file:
        rest, last = b"", time.monotonic()
        while time.monotonic() - last <= patience:
            more = file.read(1 << 20)
            if more:
                *lines, rest = (rest + more).split(b"\n")
                yield from (_decoded(line) for line in lines)
                last = time.monotonic()
                if len(rest) > LONGEST:
                    refuse(path, f"holds a line of more than {LONGEST} bytes", "log one sample per line")
            else:
                if Path(path).stat().st_size < file.tell():
                    refuse(path, "has become shorter", "start again: the log was replaced")
                yield None
                time.sleep(poll)


def _number(cell, decimal):
    value = number(cell, decimal)
    return np.nan if value is None else value


def _decoded(line):
    try:
        return line.decode("utf-8-sig").rstrip("\r")
    except UnicodeDecodeError:
        return line.decode("latin-1").rstrip("\r")


def samples_of_table(path, section, lines):
    """Samples of a table that a section `pyrometer` of test.yaml describes.

    A dict of 'time' [s] and both signals [A], NaN where a cell is missing; a str that says why a line is
    none; or None where no line has come.
    """
    section.file("file", "pyrometer.csv")
    delimiter, decimal = columns.marks(section)
    wanted = columns.wanted(section, ("time", *parts.SIGNALS, *parts.TUNNEL))
    form = wanted["time"].format if "time" in wanted else None
    zero = section.text("zero", "", needed=True) if form else section.number("zero", 0.0)
    absent = {"time", *parts.SIGNALS} - wanted.keys()
    if absent or section.faults:
        raise Refusal(section.faults or [f"{path}: test.yaml names no column {', '.join(sorted(absent))}"])
    wanted = {name: wanted[name] for name in ("time", *parts.SIGNALS)}
    gains = columns.divisors(wanted)
    sought = {**wanted, **wanted["time"].beside(), **{columns.GAIN_OF + name: gains[name] for name in gains}}
    start = clock.seconds(zero, form) if form else zero
    if start is None:
        refuse(path, f"`zero` {quote(zero)} is not of the format {quote(form)}", "correct it")
    above, header, before, nights = [], None, -np.inf, 0.0
    for line in lines:
        if line is None:
            yield None
        elif header is None:
            above.append(line)
            try:
                header = columns.header_of(path, above, sought, delimiter)
            except Refusal:
                if len(above) >= columns.HEADER_LINES:
                    raise
        elif line.strip() and not line.lstrip().startswith(COMMENT):
            _, mark, places, stated = header
            cells = split(line, mark)
            if len(cells) <= max(places.values()):
                yield f"{len(cells)} cells, column {max(places.values()) + 1} is needed"
                continue
            found = {}
            for name in parts.SIGNALS:
                value = _number(cells[places[name]], decimal)
                found[name] = float(columns.to_si(path, wanted[name], value, stated[name]))
                if name in gains:
                    gain = _number(cells[places[columns.GAIN_OF + name]], decimal)
                    found[name] /= gain if gain > 0 else np.nan
            word = cells[places["time"]]
            if form:
                word = wanted["time"].stamp({key: cells[place] for key, place in places.items()})
                moment = clock.seconds(word, form)
            else:
                moment = number(word, decimal)
                moment = (
                    moment if moment is None else columns.to_si(path, wanted["time"], moment, stated["time"])
                )
            if moment is None or moment != moment:
                yield f"{quote(word)} is no time"
                continue
            if form and not clock.has_day(form) and moment + nights < before - clock.DAY / 2:
                nights += clock.DAY
            before = moment + nights
            yield found | {"time": float(before - start)}


def samples_of_json(lines):
    """Samples and events of JSON lines: {"time": 0.01, "signal_wide": 1e-7, "signal_narrow": 5e-8}, in SI, or
    {"event": "plasma_off", "time": 50.0}; yields as `samples_of_table`, and the events as they are."""
    for line in lines:
        if line is None:
            yield None
            continue
        try:
            found = json.loads(line[:LONGEST])
            event = found.get("event")
            names = ("time",) if event else ("time", *parts.SIGNALS)
            values = {name: float("nan" if found[name] is None else found[name]) for name in names}
            if (event and event not in EVENTS) or not np.isfinite(values["time"]):
                raise ValueError
            yield values | ({"event": event} if event else {})
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            yield f"{quote(line)} is no sample"
