"""Logs of the burst strings of a Raytek (Fluke) Marathon MR pyrometer."""

import re
from datetime import datetime, timedelta

import numpy as np

from plasmapyro.readers.text import fault, number, quote, read_lines, refuse, refuse_all, require_end

LARGEST = 96_000_000  # [byte]
ITEMS = {  # letter -> (meaning, lowest, highest)
    "T": ("two-colour temperature", 0.0, 9999.0),
    "W": ("one-colour temperature, wide band", 0.0, 9999.0),
    "N": ("one-colour temperature, narrow band", 0.0, 9999.0),
    "Q": ("power of the wide band", 0.0, 9999.999),
    "R": ("power of the narrow band", 0.0, 9999.999),
    "B": ("measured attenuation [%]", 0.0, 99.0),
    "S": ("slope", 0.85, 1.15),
    "I": ("internal temperature", -99.0, 999.0),
    "E": ("emissivity", 0.1, 1.0),
}
ITEM = re.compile(r"([A-Z])([+-]?[\d.,]+|E[A-Z]{3,4}|[<>-]+)", re.ASCII)
UNIT = re.compile(r"U([CF])")
CLOCK = re.compile(r"(?:(\d{4})-(\d{2})-(\d{2})[ T])?(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d{1,9})?)", re.ASCII)
POWERS = ("Q", "R")
UNDO = ("slope", "attenuation")
DAY = 86400.0


def read_log(path, period=None, zero=None):
    """A log of burst strings, one per line, e.g. '12.30 UC T1250 Q0812.345 R0311.020 S1.000 I029'.

    Time (N,) [s] and letter -> (N,) array; temperatures in C or F as logged, NaN where the unit sends an
    error code in place of a number (above or below range). `period` [s] between lines, if the log has no
    times of its own; `zero`: the log's own time (clock, date and clock, or seconds) at which the time shall
    be 0, by default that of the first line. Refusal: lines that are no burst strings, that lack an item
    others have, or values the unit cannot send.

    Source: maker's manual, Marathon MR, rev. E2 (04/2011), sec. 9.3.2 and table 5: the items of a burst
    string, their letters and ranges; the unit fixes their order, so the letters are read, not the places.
    """
    lines, ended = read_lines(path, LARGEST)
    require_end(path, lines, ended)
    stamps, rows, numbers, faults = [], [], [], []
    for index, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            stamp, row = _line(line)
        except ValueError as reason:
            faults.append(
                fault(path, str(reason), "remove the line, or log the burst strings as they come", index)
            )
            continue
        stamps.append(stamp)
        rows.append(row)
        numbers.append(index)
    if not rows:
        refuse_all(path, faults or [fault(path, "holds no burst string", "check that this is the log")])
    letters = rows[0].keys()
    faults += [
        fault(path, f"holds {_names(row)}, the first line {_names(letters)}", "remove incomplete lines", line)
        for row, line in zip(rows, numbers, strict=True)
        if row.keys() != letters
    ]
    refuse_all(path, faults)
    items = {letter: np.array([row[letter] for row in rows]) for letter in letters if letter != "U"}
    if len({row.get("U") for row in rows}) > 1:
        refuse(path, "the unit of temperature changes between C and F", "split the log where it changes")
    return _times(path, stamps, numbers, period, zero), items


def detector_signals(path, items, undo):
    r"""Signals (2, N) of the wide and the narrow band from the power items Q and R of `read_log`, in their
    unit.

    .. math:: S_1 = Q\,s\,(1 - B), \qquad S_2 = R\,(1 - B)

    with the slope `s` if 'slope' is in `undo` and the attenuation `B` if 'attenuation' is. Refusal: no powers
    in the log; an item to undo that is not logged; or a slope other than 1 or an attenuation other than 0
    while nothing says whether the powers contain them (`undo` None).

    Source: the manual's table 5 names Q 'wide power' and R 'narrow power' and gives no unit; that they are
    our S1 and S2 is an inference. ASSUME: the slope is the ratio of the emittances, wide over narrow, by
    which the unit divides the ratio of the powers; if the powers are sent after that, it sits in the wide
    one. ASSUME: the measured attenuation says by how much the powers lie below those of a full black body at
    the two-colour temperature; if the powers are sent scaled up to that, 1 - B takes it back. Whether they
    are is not in the manual and must be tested on the unit (change the slope before a steady source and see
    whether Q changes), so it is asked for instead of guessed.
    """
    absent = [letter for letter in POWERS if letter not in items]
    if absent:
        refuse(
            path,
            f"holds no item {' and '.join(absent)} ({_names(absent)})",
            "set the burst string to include Q and R ($=UTQRBSIE); temperatures alone cannot be corrected",
        )
    where = {"slope": ("S", 1.0), "attenuation": ("B", 0.0)}
    for name, (letter, neutral) in where.items():
        if undo is None and letter in items and not np.all(items[letter] == neutral):
            refuse(
                path,
                f"the {name} (item {letter}) is not {neutral:g} throughout, and the powers may contain it",
                "state `undo` in test.yaml: a list of slope, attenuation, or [] if Q and R are bare powers",
            )
        if undo and name in undo and letter not in items:
            refuse(
                path,
                f"`undo: {name}` needs item {letter}, which is not logged",
                "log it, or remove it from `undo`",
            )
    signals = np.stack([items[letter] for letter in POWERS])
    if undo and "slope" in undo:
        signals = signals * np.stack([items["S"], np.ones_like(items["S"])])
    if undo and "attenuation" in undo:
        signals = signals * (1 - items["B"] / 100)
    return signals


def _names(letters):
    return ", ".join(f"{letter} {ITEMS[letter][0]}" if letter in ITEMS else letter for letter in letters)


def _line(line):
    """Time stamp (its kind, seconds or None) and items of one line; ValueError says what is wrong."""
    words = _unquoted(line)
    clock, stamp = CLOCK.match(words), ("none", None)
    if clock:
        stamp, words = _clock(clock), words[clock.end() :]
    else:
        first, _, rest = words.replace(";", " ").replace("\t", " ").partition(" ")
        first = first.rstrip(",")
        value = number(first, None)
        if value is not None and value == value:
            stamp, words = ("seconds", value), rest
    row = {}
    for word in words.replace(";", " ").replace("\t", " ").split():
        unit, item = UNIT.fullmatch(word), ITEM.fullmatch(word)
        letter = "U" if unit else item.group(1) if item else None
        if letter is None or (letter not in ITEMS and letter != "U"):
            raise ValueError(f"{quote(word)} is no item of a burst string")
        if letter in row:
            raise ValueError(f"item {letter} stands twice")
        row[letter] = unit.group(1) if unit else _value(letter, item.group(2))
    if not row:
        raise ValueError(f"{quote(line)} holds no item of a burst string")
    return stamp, row


def _unquoted(line):
    """A line without the quotes that a program put around it, or around its time."""
    return line.translate({ord(one): " " for one in "\"'"}).strip()


def first_line(line):
    """Time stamp as it is written, or None, and items of one line; ValueError says what is wrong."""
    (_, value), row = _line(line)
    clock = CLOCK.match(_unquoted(line))
    return clock[0] if clock else value if value is None else f"{value:.13g}", row


def _value(letter, word):
    if not word[-1].isdigit() and not word[-1] == ".":
        return np.nan  # EHHH, EUUU, >, <: above or below range
    value = number(word, None)
    meaning, low, high = ITEMS[letter]
    if value is None or not low <= value <= high:
        raise ValueError(f"item {letter} ({meaning}) is {quote(word)}, the unit sends {low:g} to {high:g}")
    return value


def _clock(match):
    year, month, day, hour, minute, second = match.groups()
    of_day = int(hour) * 3600 + int(minute) * 60 + float(second.replace(",", "."))
    if not (int(hour) < 24 and int(minute) < 60 and float(second.replace(",", ".")) < 61):
        raise ValueError(f"{quote(match.group(0))} is no time of day")
    if year is None:
        return ("clock", of_day)
    try:
        date = datetime(int(year), int(month), int(day))
    except ValueError:
        raise ValueError(f"{quote(match.group(0))} is no date") from None
    return ("date", (date - datetime(2000, 1, 1)) / timedelta(days=1) * DAY + of_day)


def _times(path, stamps, numbers, period, zero):
    kinds, moments = zip(*stamps, strict=True)
    kind = kinds[0]
    if len(set(kinds)) > 1:
        line = next(n for n, other in zip(numbers, kinds, strict=True) if other != kind)
        refuse(path, "some lines have a time and others not, or of another kind", "make them alike", line)
    if kind == "none":
        if period is None:
            refuse(path, "the lines carry no time", "state `period` [s] in test.yaml")
        time = np.arange(len(stamps)) * period
    else:
        if period is not None:
            refuse(path, "the lines carry times, and test.yaml states a `period`", "remove `period`")
        time = np.array(moments, dtype=float)
        if kind == "clock":
            time = time + DAY * np.cumsum(np.diff(time, prepend=time[0]) < -DAY / 2)  # midnight
    back = np.flatnonzero(np.diff(time) <= 0)
    if back.size:
        refuse(
            path,
            "the time does not increase",
            "remove repeated lines, or log with more digits",
            numbers[back[0] + 1],
        )
    return time - (time[0] if zero is None else _zero(path, zero, kind))


def _zero(path, zero, kind):
    match = CLOCK.fullmatch(zero.strip())
    value = number(zero)
    if match:
        try:
            stamp = _clock(match)
        except ValueError:
            stamp = None
        if stamp and stamp[0] == kind:
            return stamp[1]
    elif kind in ("seconds", "none") and value is not None and value == value:
        return value
    form = {"clock": "a time of day hh:mm:ss", "date": "a date yyyy-mm-dd hh:mm:ss"}.get(
        kind, "a number of seconds"
    )
    refuse(path, f"`zero` {quote(zero)} does not fit its times", f"write it as {form}")
