"""A first description of a folder of raw files: what they seem to hold, and what only a person knows."""

import os
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml

from plasmapyro.foreign import printable
from plasmapyro.readers import burst, columns, ocean, parts, spectra_table, units
from plasmapyro.readers.cells import COMMENT, DELIMITERS, split, without_empty_end
from plasmapyro.readers.description import Section, in_yaml
from plasmapyro.readers.dialects import ARRAYS, table_lines
from plasmapyro.readers.guess_signals import pyrometer_section, table_section
from plasmapyro.readers.guess_spectra import spectrometer_section
from plasmapyro.readers.guess_table import assign, look_at_table
from plasmapyro.readers.spectrometer import natural
from plasmapyro.readers.text import Refusal, number, quote, refuse
from plasmapyro.record import onset

MOST_FILES = 20_000  # of a folder
PLATEAU = 0.98  # of the highest signal: the plasma is taken to end when the signal last had it
OF_WINDOW = "kept for the record: calibrate through it, or state window_transmittance in calibration.yaml"
FIRST_WINDOW = 0.1  # of the exposure, where no growth shows the surface
GUIDE = "docs/your-own-data.md"
OTHERS = set(
    ".yaml .yml .md .pdf .png .jpg .jpeg .tif .gif .mp4 .avi .html .py .m .docx .pptx .ini .db .lnk".split()
)


class Guess(NamedTuple):
    """Lines of test.yaml, and what a person must answer."""

    text: str
    questions: list


def describe(folder):
    """A first test.yaml for a folder of raw files; Refusal if nothing in it looks like signals or spectra."""
    folder = Path(folder)
    files = [
        path
        for path in sorted(
            folder.rglob("*"), key=lambda path: (path.suffix.lower() in ARRAYS, natural(str(path)))
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
    pyrometer = pyrometer_section(folder, kinds, questions)
    read = _read(folder, pyrometer, questions)
    spectrometer = spectrometer_section(folder, kinds, read, questions)
    for path, (table, places) in (
        kinds.get("band", []) if not any("{file:" in line for line in pyrometer) else ()
    ):
        remarks.append(
            f"not used: {path.name}: one signal ({table.labels[places['band']]!r}) against time is seen; the"
            " other band must stand in a column beside it, or alone in a second file of the same form; an"
            " instrument of one band is described as a `radiometer`"
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
        blocks += ["tunnel:", *table_section(folder, [path], table, places, questions)]
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
    # names may hold line ends
    asked = [" ".join(printable(words).split()) for words in [*questions, *_grouped(remarks)]]
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
        if in_yaml(name) not in lines
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
    data = [line for line in lines if not line.lstrip().startswith(COMMENT)]
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
    for name, mark in DELIMITERS.items():
        rows = [without_empty_end(split(line, mark)) for line in lines]
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
        values = [number(word, None) for word in listed]
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


def _read(folder, lines, questions):
    """Variables of the section 'pyrometer' as its reader reads it; what it refuses is among the questions."""
    if not lines:
        return {}
    faults = []
    values = yaml.load("\n".join(lines), Loader=yaml.BaseLoader)
    section = Section(values, folder / "test.yaml", "pyrometer", faults)
    try:
        found = parts.pyrometer(folder, section) or {}
    except Refusal as reason:
        found, faults = {}, [*faults, *reason.messages]
    questions += faults[:1]
    return found


def _attributes(folder, read, pyrometer, spectrometer, kinds, questions):
    """Lines of the attributes: events from the signals where there are any, the rest asked for."""
    begin, end, window = _events(read)
    rows = [
        ("title", in_yaml(folder.resolve().name), ""),
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
