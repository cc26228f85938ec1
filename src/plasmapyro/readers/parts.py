"""Signals and numbers of a test folder, each part from its section of test.yaml."""

from itertools import pairwise
from pathlib import Path

import numpy as np

from plasmapyro.readers import burst, clock, columns, tdms
from plasmapyro.readers.text import number, quote, refuse
from plasmapyro.record.inputs import NUMBERS

SIGNALS = ("signal_wide", "signal_narrow")
TUNNEL = ("electric_power", "chamber_pressure", "mass_flow_rate")
SHUFFLED = 3  # usual steps by which lines that are not sorted go back
WORDS = ("title", "condition", "origin")


def attributes(section):
    """Attributes of the contract 'test': numbers in SI, the reference window, words."""
    found = section.emittance()
    given = {name: section.number(name) for name in NUMBERS if name != "emittance"}
    given |= {name: section.text(name) for name in WORDS}
    found |= {name: value for name, value in given.items() if value is not None}
    window = section.raw("reference_window")
    if window is not None:
        values = [number(word) for word in window] if _words(window) else []
        if len(values) != 2 or any(value is None or value != value for value in values):
            section.blame("reference_window", f"must be [begin, end] in s; got {quote(window)}", "correct it")
        else:
            found["reference_window"] = values
    section.close()
    return found


def table(folder, section, names, default, kinds=()):
    """Columns of CSV or TDMS files, SI, with 'time'; None if the description does not say enough to read.

    Several files are parts of one record, joined in the order in which they are named.
    """
    files = section.files("file", default)
    kind = section.text("format", choices=("csv", "tdms"))
    marks = columns.marks(section)
    wanted = columns.wanted(section, ("time", *names), kinds, files=True)
    stamped = "time" in wanted and wanted["time"].format
    if stamped:
        wanted["time"].zero = section.text("zero", "", needed=True)
        shift = 0.0
    else:
        shift = section.number("zero", 0.0)
    section.close()
    if any(column.header is None for column in wanted.values()) or not wanted:
        return None
    apart = {name: column for name, column in wanted.items() if column.file}
    if apart and "time" in wanted:
        return _of_files(folder, wanted, apart, files if len(apart) < len(wanted) - 1 else [], marks, shift)
    parts = []
    for name in files:
        path = Path(folder) / name
        if kind == "tdms" or (kind is None and path.suffix.lower() == ".tdms"):
            parts.append(tdms.read_tdms(path, wanted, joined=len(files) > 1))
        elif "time" in wanted:
            parts.append(columns.read_table(path, wanted, *marks))
        else:
            section.blame("columns.time", "is missing", "name the column that holds the time")
            return None
    first = parts[0].get("start", 0.0) if parts else 0.0
    for part in parts:
        part["time"] = part["time"] + part.pop("start", first) - first
    return joined([Path(folder) / name for name in files], parts, shift) if parts else None


def _of_files(folder, wanted, apart, files, marks, shift):
    """Columns that stand in files of their own, each beside its times; those must be the same in all."""
    groups = [(name, {key: one for key, one in wanted.items() if key not in apart}) for name in files]
    for file in dict.fromkeys(column.file for column in apart.values()):
        groups.append(
            (file, {"time": wanted["time"]} | {k: one for k, one in apart.items() if one.file == file})
        )
    result, first = {}, None
    for name, columns_of_file in groups:
        path = Path(folder) / name
        found = columns.read_table(path, columns_of_file, *marks)
        time = rising(path, found["time"])
        if first is not None and (
            time.size != result["time"].size
            or np.abs(time - result["time"]).max() > 0.1 * np.median(np.diff(result["time"]))
        ):
            refuse(
                path,
                f"has {time.size} times from {time[0]:g} to {time[-1]:g} s, {first} has {result['time'].size}"
                f" from {result['time'][0]:g} to {result['time'][-1]:g} s",
                "export both at the same moments, or join them on one clock before",
            )
        first = first or name
        result = {**found, **result}
    return result | {"time": result["time"] - shift}


def joined(paths, parts, shift):
    """Parts of one record after one another, their time counted from `shift`."""
    for path, part in zip(paths, parts, strict=True):
        rising(path, part["time"])
    for (path, part), (after, later) in pairwise(zip(paths, parts, strict=True)):
        if not later["time"][0] > part["time"][-1]:
            refuse(
                after,
                f"begins at {later['time'][0]:g} s, when {path.name} ends at {part['time'][-1]:g} s",
                "name the files in their order in time; the times of all must be of one clock",
            )
    whole = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return whole | {"time": whole["time"] - shift}


def pyrometer(folder, section):
    """Variables on `time`: both signals and, if the same file holds them, tunnel channels."""
    if section.text("format", choices=("csv", "tdms", "marathon")) == "marathon":
        return _marathon(folder, section)
    found = table(folder, section, (*SIGNALS, *TUNNEL), "pyrometer.csv")
    if found and set(SIGNALS) <= found.keys() and found["time"].size > 1:
        seen = np.isfinite([found[name] for name in SIGNALS])
        if seen.any(axis=1).all() and not seen.all(axis=0).any():
            refuse(
                section.path,
                "the two signals never stand in one row: they are logged at moments of their own",
                "export both at the same moments, one row per moment",
            )
    return found


def radiometer(folder, section):
    """Variables on `radiometer_time` and `band`: signals, or displayed temperatures with their setting.

    The section `columns` names the signal of each band; or `reading`, and `bands` says which band, or which
    two in a ratio, made it. `setting` is the emissivity set (the slope of a ratio): a number, or a column.
    """
    if "bands" not in section:
        section.used.add("setting")
        listed = section.values.get("columns")
        names = [one for one in listed if one != "time"] if isinstance(listed, dict) else []
        found = table(folder, section, names, "radiometer.csv", dict.fromkeys(names, "radiometer_signal"))
        if found is None:
            return None
        signal = np.stack([found[name] for name in names], axis=1)
        return {"radiometer_time": found["time"], "band": names, "radiometer_signal": signal}
    names = section.raw("bands")
    if not _words(names) or not 0 < len(set(names)) == len(names) <= 2:
        section.blame("bands", f"must name one band, or two of a ratio; got {quote(names)}", "correct it")
        return None
    setting = section.number("setting", 1.0, above=0)
    kinds = {"reading": "radiometer_reading", "setting": "radiometer_setting"}
    found = table(folder, section, tuple(kinds), "radiometer.csv", kinds)
    if found is None or "reading" not in found:
        section.blame("columns.reading", "is missing", "name the column of the displayed temperature")
        return None
    setting = found.get("setting", np.full(found["time"].size, setting))
    pair = len(names) == 2  # a ratio of bands is the slope times that of a black body
    return {
        "radiometer_time": found["time"],
        "band": names,
        "radiometer_reading": np.stack([found["reading"]] * len(names), axis=1),
        "radiometer_setting": np.stack([setting, np.ones_like(setting)][: 1 + pair], axis=1),
    }


def tunnel(folder, section, time):
    """Tunnel channels of a file of their own, joined linearly onto `time`; NaN outside their record."""
    found = table(folder, section, TUNNEL, "tunnel.csv")
    if found is None:
        return {}
    own = found.pop("time")
    return {name: np.interp(time, own, values, left=np.nan, right=np.nan) for name, values in found.items()}


def _words(values):
    return isinstance(values, list) and all(isinstance(value, str) for value in values)


def rising(path, time):
    """`time` if it rises strictly; else Refusal, with the place."""
    if np.isnan(time).any():
        refuse(path, f"{int(np.isnan(time).sum())} samples have no time", "remove those lines")
    steps = np.diff(time)
    if (steps <= 0).any():
        first = int(np.argmax(steps <= 0))
        what = "stands twice" if steps[first] == 0 else "goes back"
        remedy = "remove repeated lines, or log the time with more digits"
        if abs(steps[first] + clock.HOUR) < clock.CHANGE:
            what += " by an hour (the end of summer time?)"
        elif abs(steps[first] + 12 * clock.HOUR) < clock.CHANGE:
            what += " by twelve hours (a clock without AM and PM?)"
            remedy = "log with a clock of 24 hours, or add 12 to the hours after noon"
        elif (steps < 0).all():
            what, remedy = "runs backwards", "sort the lines by their time, the oldest first"
        elif steps[first] < 0 and time[first + 1] <= time[0] + np.median(steps):
            what += " to the begin (was the logger restarted?)"
            remedy = "keep the part that holds the test, or log with one clock"
        elif _begun_anew(time, -steps[first]):
            what += f" by {-steps[first]:g} s (was the logger restarted?)"
            remedy = "keep the part that holds the test, or log with one clock"
        elif steps[first] < 0:
            remedy = "sort the lines by their time, and remove those that stand twice"
        elif (steps == 0).mean() > 0.3:
            what = f"is given in steps of {steps[steps > 0].min() if (steps > 0).any() else 0:g} s only"
            remedy = (
                "log it with decimals, or name the column that has them as `milliseconds` beside `format`;"
                " if lines stand there twice, remove their copies"
            )
        refuse(
            path,
            f"the time {what}: sample {first + 2} is at {time[first + 1]:g} s after {time[first]:g} s",
            remedy,
        )
    return time


def _begun_anew(time, back):
    """Whether a step back [s] is that of a logger that began anew: sorted, two records would be mixed."""
    usual = np.median(np.diff(time))
    return back > SHUFFLED * usual and np.diff(np.sort(time)).min() < usual / 2


def _marathon(folder, section):
    before = len(section.faults)
    files = [Path(folder) / name for name in section.files("file", "pyrometer.log")]
    period = section.number("period", above=0)
    zero = section.text("zero")
    scale = section.number("ampere_per_unit", 1.0, above=0)
    undo = section.raw("undo")
    if undo is not None and (not _words(undo) or set(undo) - set(burst.UNDO)):
        section.blame("undo", f"must be a list of {', '.join(burst.UNDO)}; got {quote(undo)}", "correct it")
    section.close()
    if len(files) > 1 and (zero is None or period is not None):
        section.blame("zero", "is needed for a record of several files", "log the clock, and state it")
    if len(section.faults) > before:
        return None
    parts = []
    for path in files:
        time, items = burst.read_log(path, period, zero)
        wide, narrow = burst.detector_signals(path, items, undo) * scale
        parts.append({"time": time, "signal_wide": wide, "signal_narrow": narrow})
    return joined(files, parts, 0.0)
