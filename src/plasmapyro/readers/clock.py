"""Dates and times of day in the cells of a table, read in a format that test.yaml states."""

import re
from datetime import UTC, datetime

import numpy as np
from scipy.optimize import linprog

from plasmapyro.readers.text import fault, missing, quote, refuse

STAMP = re.compile(
    r"\d{1,4}[-./]\d{1,2}[-./]\d{1,4}|\d{1,2}:\d{2}|\b\d{8}[T_ ]\d{4}|\b\d{1,2}h\d{2}"
    r"|\b\d{1,2}[-. ]{1,2}[^\W\d]{3,9}\.?[- ,]{1,2}\d{2}|\b[A-Za-z]{3,9}\.? \d{1,2}, ?\d{4}",
    re.ASCII,
)
FRACTION = re.compile(r"[.,](\d{1,9})(?=$|Z$|[+-]\d{2}:?\d{2}$|\s*[AaPp][Mm]$)", re.ASCII)
# decimals of seconds behind a colon
COLON = re.compile(r"(?<![:\d])(\d{1,2}:\d{2}:\d{2}):(\d{1,9})(?!\d)", re.ASCII)
DAYS = re.compile(r"(\d{1,4}) days? ", re.ASCII)
ENGLISH = {  # abbreviated months of other languages, by their beginning
    name: english
    for english, names in {
        "jan": "jän ene gen",
        "feb": "fév",
        "mar": "mär mrz",
        "apr": "avr abr",
        "may": "mai mag",
        "jun": "juin giu",
        "jul": "juil lug",
        "aug": "aoû ago",
        "sep": "set",
        "oct": "okt ott",
        "dec": "dez déc dic",
    }.items()
    for name in names.split()
}
MONTH = re.compile(r"[^\W\d_]{3,9}\.?")
UNSURE = ("%Z", "%c", "%x", "%X")  # depend on the computer's settings, or on names of time zones
EPOCH = datetime(2000, 1, 1)
DAY, HOUR = 86400.0, 3600.0  # [s]
CHANGE = 60.0  # [s] a step back of an hour within this is that of the end of summer time
FRAMES, LEAST_SPAN = 8, 10.0  # and [s]: fewer dates, or a shorter series, tell no period
JITTER = 0.05  # [s] by which a frame may miss the second of its date
EXAMPLE = "%d.%m.%Y %H:%M:%S"


def looks_like_stamp(word):
    """Whether a cell holds a date or a time of day."""
    return STAMP.search(word) is not None


def reads_format(words):
    """Whether `words` is a format of `datetime.strptime` that this module reads."""
    if "%" not in words or any(sign in words for sign in UNSURE):
        return False
    try:
        datetime.strptime(EPOCH.replace(tzinfo=UTC).strftime(words), words)
    except ValueError:
        return False
    return True


def seconds(word, form):
    """Seconds since 2000, or since midnight if the format has no day; None if the cell is not of it.

    Seconds may have decimals after a point or a comma, whether the format says so or not. With a zone (%z:
    `Z`, `+02:00`) they are those of UTC, which knows no summer time.
    """
    word, form, rest = COLON.sub(r"\1.\2", word.strip()), form.strip(), 0.0
    if (days := DAYS.match(word)) and not has_day(form):  # a span, as pandas writes it
        word, rest = word[days.end() :], DAY * int(days[1])
    if "%b" in form:
        word = MONTH.sub(_english, word, count=1)
    for decimals in (".%f", ",%f"):
        form = form.removesuffix(decimals).replace(decimals + "%z", "%z").replace(decimals + " %p", " %p")
    if form.endswith(("%S", "%S%z", "%S %p", "%S%p")) and (part := FRACTION.search(word)):
        word, rest = word[: part.start()] + word[part.end() :], rest + float(f"0.{part.group(1)}")
    try:
        stamp = datetime.strptime(word, form)
    except ValueError:
        return None
    start = EPOCH if has_day(form) else datetime(1900, 1, 1)
    return (stamp - start.replace(tzinfo=stamp.tzinfo and UTC)).total_seconds() + rest


def _english(month):
    """An abbreviated month in English: 'Dez.' is 'dec'."""
    word = month[0].lower().rstrip(".")
    return next((english for begin, english in ENGLISH.items() if word.startswith(begin)), word[:3])


def has_day(form):
    """Whether a format names the day, or the time of day only."""
    return any(sign in form for sign in ("%d", "%j"))


def times(path, words, lines, form, zero, set_back):
    """Times (N,) [s] of the cells of a table, counted from `zero`, and sentences on what is wrong with them.

    NaN where a cell is missing or not of the format `form`, as `datetime.strptime` takes it; `zero` is
    written in it, too; `lines`: where the cells stand. `set_back`: the clock was set back by an hour during
    the record (end of summer time): undo it. It is never guessed: a second record of the same hour looks the
    same.
    """
    values = np.array([seconds(word, form) for word in words], dtype=float)  # NaN for None
    bad = [i for i, word in enumerate(words) if np.isnan(values[i]) and not missing(word)]
    faults = [
        fault(
            path,
            f"{quote(words[i])} is not of the stated format {quote(form)}",
            "correct it, or `format`",
            lines[i],
        )
        for i in bad
    ]
    start = seconds(zero, form)
    if start is None and zero:  # that it is missing was said
        faults.append(fault(path, f"`zero` {quote(zero)} is not of the format {quote(form)}", "correct it"))
    if faults or start is None:
        return values, faults
    known = np.flatnonzero(np.isfinite(values))
    if known.size and not has_day(form):
        nights = np.diff(values[known], prepend=values[known[0]]) < -DAY / 2
        values[known] += DAY * np.cumsum(nights)
        first, last = values[known][[0, -1]]
        # The moment may stand on the other side of midnight than the first line.
        start = next((one for one in (start, start + DAY, start - DAY) if first <= one <= last), start)
    back = known[1:][np.abs(np.diff(values[known]) + HOUR) < CHANGE]
    if back.size and not set_back:
        refuse(
            path,
            "the clock goes back by an hour: the end of summer time?",
            "if so, state `set_back: yes` beside `format`; else remove the repeated lines",
            lines[back[0]],
        )
    if set_back and back.size != 1:
        refuse(
            path,
            f"`set_back` is stated, and the clock goes back by an hour {back.size} times",
            "remove `set_back`, or read the record in parts",
        )
    if set_back:
        values[back[0] :] += HOUR
    return values - start, []


def cycle(stamps):
    r"""Period, moment of the first and margin m [s] of frames that come in a constant cycle, or None.

    .. math:: t_k + m \le a + p k \le t_k + 1 - m, \qquad m \to \max

    `stamps` (n,) [s]: their dates, whose decimals are cut off. None where no line runs through the seconds
    of all of them: a lost frame, or a cycle that is not constant.
    """
    if len(stamps) < FRAMES or stamps[-1] - stamps[0] < LEAST_SPAN:
        return None
    one, order = np.ones(len(stamps)), np.arange(len(stamps))
    late, early = (np.stack([sign * one, sign * order, one], axis=1) for sign in (-1, 1))
    since = stamps - stamps[0]
    found = linprog(
        [0, 0, -1], np.concatenate([late, early]), np.append(-since, since + 1), bounds=[(None, None)] * 3
    )
    if not found.success or found.x[2] < -JITTER or found.x[1] <= 0:
        return None
    first, period, margin = found.x
    return period, first + stamps[0], max(margin, 0.0)
