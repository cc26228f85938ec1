"""Samples of a pyrometer as they come: from a text table that grows, or as JSON lines."""

import codecs
import json
import time
from pathlib import Path

import numpy as np

from plasmapyro.readers import clock, columns, parts
from plasmapyro.readers.cells import COMMENT, decimal_sign, split, units_in
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
                if not file.tell() - len(more) and more.startswith(
                    (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
                ):
                    refuse(path, "is text in UTF-16", "log it in UTF-8 or ASCII")
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


def _numbers(path, header, sought, cells, decimal):
    """Numbers of the columns `sought` (key -> column) in a line of cells; or a str: what is wrong with it."""
    _, mark, places, _ = header
    words = {name: cells[places[name]] for name in sought}
    if decimal is None:
        decimal, faults = decimal_sign(path, mark, {name: [word] for name, word in words.items()}, [None])
        if faults:
            return faults[0]
    found = {name: number(word, decimal, thousands=True) for name, word in words.items()}
    odd = [name for name, value in found.items() if value is None]
    return (
        f"{quote(words[odd[0]])} in column {quote(sought[odd[0]].header)} is not a number" if odd else found
    )


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
    of_gains = {columns.GAIN_OF + name: column for name, column in gains.items()}
    sought = {**wanted, **wanted["time"].beside(), **of_gains}
    start = clock.seconds(zero, form) if form else zero
    if start is None:
        refuse(path, f"`zero` {quote(zero)} is not of the format {quote(form)}", "correct it")
    above, header, sampled, before, nights = [], None, False, -np.inf, 0.0
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
            if not sampled and (below := units_in(cells)):
                stated |= {name: stated[name] or below[at] for name, at in places.items()}
                continue
            sampled, word = True, cells[places["time"]]
            plain = {
                name: column for name, column in {**wanted, **of_gains}.items() if not form or name != "time"
            }
            values = _numbers(path, header, plain, cells, decimal)
            if isinstance(values, str):
                if before == -np.inf and "`decimal`" in values:  # no later line tells more
                    raise Refusal([values])
                yield values
                continue
            found = {}
            for name in parts.SIGNALS:
                found[name] = float(columns.to_si(path, wanted[name], values[name], stated[name]))
                if name in gains:
                    gain = values[columns.GAIN_OF + name]
                    found[name] /= gain if gain > 0 else np.nan
            if form:
                word = wanted["time"].stamp({key: cells[place] for key, place in places.items()})
                moment = clock.seconds(word, form)
            else:
                moment = columns.to_si(path, wanted["time"], values["time"], stated["time"])
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
