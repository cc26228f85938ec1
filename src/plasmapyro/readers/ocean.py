"""Spectra as Ocean Optics / Ocean Insight programs write them: SpectraSuite, OceanView, Jaz."""

import re
import unicodedata
from datetime import datetime
from typing import NamedTuple

import numpy as np

from plasmapyro.readers import columns, spectra_table
from plasmapyro.readers.cells import DELIMITERS, is_value, split, units_below, without_empty_end
from plasmapyro.readers.text import number, quote, read_lines, refuse, require_end

LARGEST = 8_000_000  # [byte] of one spectrum
MOST_PIXELS = 65536
LEAST_PIXELS = 20  # of a spectrum without a header
SHORTEST, LONGEST = 1.5e-7, 5e-6  # [m]
DARK = re.compile(
    r"dark|background|dunkel|hintergrund|noir|oscur|fondo|buio|\u6697|(^|[\W_])(bg|bkgd?)([\W_\d]|$)",
    re.IGNORECASE,
)
DERIVED = re.compile(r"subtract|correct|korrig|minus|transm|absorb|raman|wavenumber|scope", re.IGNORECASE)
NO_LIGHT = re.compile(f"{DERIVED.pattern}|^\\W*ref", re.IGNORECASE)  # a reference is light of a lamp
RATE = re.compile(r"\bcps\b|count(s|\(s\))?\s*(/|per|\*?\s*s\^?-1)\s*(s\b|sec|\W|$)", re.IGNORECASE)
RAW = re.compile(r"raw|sample|probe|signal|counts|intens|muestra", re.IGNORECASE)
NO_NAMES = re.compile(r"^\s*[#%!/\"\[]|[:=]")  # a line that is no row of names
FENCE = ">>>>>"
HEADER_LINES = 100
LEAST_CLIPPED = 5  # neighbours at exactly the highest value: no light does that, a converter does
LEAST_CLIPPED_COUNTS = 4096.0  # below this a plateau can be rounding of a dark spectrum
PER_SECOND = {"usec": 1e6, "\u03bcsec": 1e6, "us": 1e6, "msec": 1e3, "ms": 1e3}
PER_SECOND |= dict.fromkeys(("s", "sec", "secs"), 1.0)
MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
DATE = re.compile(
    r"\b([A-Za-z]{3}) (\d{1,2}) (\d{1,2}):(\d{2}):(\d{2})(?: ([A-Za-z0-9+:-]{1,9}))? (\d{4})\b", re.ASCII
)
EXPOSURE = re.compile(  # 'Integration Time (usec): 600000', 'Acq. time (s)=\t0.5'
    r"(?:int[ei]gra|exposure|belicht|acq)[^:;=,\t]*[(\[](?P<unit>[^()\d]{1,6})[)\]]\s*[:;=,\t]+\s*(?P<value>[^\s;]*)",
    re.IGNORECASE,
)
EXPOSED = re.compile(  # 'Int:500ms', 'Exposure time = 0.5 s'
    r"\b(?:int|exposure|belicht|acq)[^:;=,\t\d]*[:;=,\t]\s*(?P<value>[\d.,]+)\s*(?P<unit>[um\u03bc]?s(ec)?)\b",
    re.IGNORECASE,
)
LONGEST_KEY = 500
BODY = set("0123456789+-.,eE\t ")


class Spectrum(NamedTuple):
    """One file: wavelengths as the instrument gives them [m], columns of counts, and its settings.

    Settings that the header does not state are None.
    """

    wavelength: np.ndarray
    columns: dict
    date: datetime | None = None
    time_zone: str | None = None
    integration_time: float | None = None
    averages: int | None = None
    dark_corrected: bool | None = None
    linearised: bool | None = None


def read_spectrum(path):
    """Read one spectrum file.

    The header is free text in the language of the program; only words common to the known languages are
    looked for. The data stand between two lines that begin with '>>>>>' (OceanView: from the first to the end
    of the file), in columns that a line of letters may name (Jaz: W D R S P). Refusal: not such a file, or
    incomplete: fewer rows than the header promises, no end, a cell that is no number, wavelengths that
    neither rise nor fall throughout.
    """
    lines, ended = read_lines(path, LARGEST)
    begin = next((i for i, line in enumerate(lines[:HEADER_LINES]) if line.startswith(FENCE)), None)
    if begin is None and (plain := plain_spectrum(lines)):
        require_end(path, lines, ended)
        return plain
    if begin is None:
        refuse(
            path,
            "no line '>>>>>Begin ... Data<<<<<', as SpectraSuite, OceanView and Jaz write it, nor columns of"
            " wavelength and signal",
            "export it in nm (or um; or Angstrom, if its name says so), without marks between thousands, or"
            " move it out of the folder",
        )
    end = next((i for i in range(begin + 1, len(lines)) if lines[i].startswith(FENCE)), len(lines))
    if end == len(lines):
        require_end(path, lines, ended)
    header = [_plain(line) for line in lines[:begin]]
    wavelength, columns = _body(path, lines, begin + 1, end)
    promised = _integer(header, "pixel")
    if promised is not None and promised > wavelength.size:  # a spliced spectrum holds more
        refuse(
            path,
            f"holds {wavelength.size} pixels, its header promises {promised}",
            "copy the file again from the instrument",
            end,
        )
    date, zone = _date(header)
    return Spectrum(
        wavelength,
        columns,
        date,
        zone,
        _integration_time(path, header),
        _integer(header, "averag", "scans to", "promedi", "mittel", "moyenn"),
        _yes(header, "lectri", but="linear"),
        _yes(header, "linear"),
    )


class Block(NamedTuple):
    """Rows of numbers in a text: values, their lines (from 0), delimiter, and where they break off."""

    table: np.ndarray
    lines: list
    mark: str
    stop: int | None  # line that holds numbers and is no further row


def block_of(lines, least=LEAST_PIXELS):
    """The first `Block` of so many rows of two or more numbers, each of as many as the first; or None."""
    for first in range(min(len(lines), HEADER_LINES)):
        for mark in DELIMITERS.values():
            for decimal in ".,":
                row = None if decimal == mark else _numbers(lines[first], mark, decimal)
                if row is None or len(row) < 2:
                    continue
                rows, at, stop = [row], [first], None
                for place, line in enumerate(lines[first + 1 :], first + 1):
                    if not line.strip():
                        continue
                    row = _numbers(line, mark, decimal, len(rows[0]))
                    if row is None or len(row) != len(rows[0]):
                        stop = place
                        break
                    rows.append(row)
                    at.append(place)
                if len(rows) < least:
                    continue
                after = [] if stop is None else enumerate(lines[stop:], stop)
                cells = ((place, cell) for place, line in after for cell in split(line, mark))
                stop = next((place for place, cell in cells if is_value(cell)), None)
                return Block(np.array(rows), at, mark, stop)
    return None


def _numbers(line, mark, decimal, width=0):
    """Numbers in a line, or None; of a `width` cells an empty one at the end is a missing number."""
    cells = line.split() if mark == " " else split(line, mark)
    cells = cells if len(cells) == width else without_empty_end(cells)
    values = [number(cell, decimal) for cell in cells]
    return None if None in values else values


def names_above(lines, block):
    """Cells of the lines above a `Block`, and the names of its columns ([] if none is one of wavelengths)."""
    above = [line for line in lines[: block.lines[0]] if line.strip()][-3:]
    above = [split(line.lstrip("#%! "), block.mark) for line in above]
    width = block.table.shape[1]
    named = [row for row in above if len(row) >= width and any(map(spectra_table.WAVES.search, row))]
    if not named:
        return above, []
    return above, next((row for row in reversed(named) if not units_below(row)), named[-1])[:width]


def rising(table, name=""):
    """A table with its rows in the order of rising wavelengths, those of its first column, and these [m].

    In nm, or in um if all are below 10; in Angstrom if their name says so. None in their place where they
    do not rise or fall throughout, or reach beyond 150 nm to 5 um.
    """
    table = table[::-1] if table[0, 0] > table[-1, 0] else table
    unit = 1e-10 if spectra_table.ANGSTROM.search(name) else 1e-6 if table[-1, 0] < 10 else 1e-9
    wavelength = table[:, 0] * unit
    sound = (np.diff(wavelength) > 0).all() and SHORTEST < wavelength[0] < wavelength[-1] < LONGEST
    return table, wavelength if sound else None


def plain_spectrum(lines):
    """The `Spectrum` in lines of wavelengths and values beside them, below words or nothing; or None.

    A row of names may stand above: a column named as dark becomes 'D', the one that is left, or the one of
    raw counts, 'S'. Wavelengths [nm], [um] if all are below 10, or in Angstrom if their name says so, that
    rise or fall.
    """
    block = block_of(lines)
    if block is None or block.stop is not None:
        return None
    table, first = block.table, block.lines[0]
    above, names = names_above(lines, block)
    if names:
        place = next((i for i, name in enumerate(names) if spectra_table.WAVES.search(name)), table.shape[1])
        if any(spectra_table.TIMES.match(name) for name in names[: place + 1]):
            return None
        names, table = names[place:], table[:, place:]
    else:
        if above and len(above[-1]) == table.shape[1] and not NO_NAMES.search(lines[first - 1]):
            return None  # columns of something else
        if table.shape[1] == 3 and (np.diff(table[:, 0]) == 1).all():
            table = table[:, 1:]  # behind the number of the pixel
        elif table.shape[1] == 3 and (table[:, 1] == 1).all():
            table = table[:, ::2]  # around the number of the strip, as WinSpec writes it
        names = ["W", "S"]
    if len(set(names)) < len(names) or len(names) != table.shape[1] or len(names) < 2:
        return None
    if table.shape[1] > 2 and all(is_value(spectra_table.moment(name)) for name in names[1:]):
        return None  # spectra below their times
    table, wavelength = rising(table, names[0])
    if wavelength is None:
        return None
    kinds = ["D" if DARK.search(name) and not DERIVED.search(name) else name for name in names[1:]]
    light = [i for i, name in enumerate(kinds) if name != "D" and not NO_LIGHT.search(name)]
    raw = [i for i in light if RAW.search(kinds[i])]
    for listed in (light, raw):
        if len(listed) == 1:
            kinds[listed[0]] = "S"
            break
    header = [_plain(line) for line in lines[:first]]
    found = dict(zip(kinds, table[:, 1:].T, strict=True))
    return Spectrum(wavelength, found, *_date(header), _integration_time(None, header))


def stated_exposure(paths):
    """The exposure [s] that words above the first of some tables state, or None."""
    for path in paths:
        header = [_plain(line) for line in read_lines(path, columns.LARGEST)[0][:HEADER_LINES]]
        if (found := _integration_time(path, [line[:200] for line in header])) is not None:
            return found
    return None


def states_rates(path):
    """Whether words above the numbers of a file say that they are counts per second."""
    lines = read_lines(path, columns.LARGEST)[0][:HEADER_LINES]
    return any(RATE.search(line[:2000]) for line in lines)


def clipped(counts):
    """Which samples of raw spectra (..., W) [count] are cut off by the converter.

    Those at the highest value of their spectrum, if at least `LEAST_CLIPPED` neighbours share it exactly and
    it exceeds `LEAST_CLIPPED_COUNTS`.
    """
    counts = np.asarray(counts, dtype=float)
    top = np.max(counts, axis=-1, keepdims=True, initial=-np.inf, where=np.isfinite(counts))
    at_top = (counts == top) & (top > LEAST_CLIPPED_COUNTS)
    if counts.shape[-1] < LEAST_CLIPPED:
        return np.zeros(counts.shape, dtype=bool)
    runs = np.lib.stride_tricks.sliding_window_view(at_top, LEAST_CLIPPED, axis=-1).all(axis=-1)
    return at_top & runs.any(axis=-1, keepdims=True)


def column_of(path, spectrum, settings):
    """The column of a file that holds what `settings` (quantity, column or None) asks for."""
    name = settings["column"]
    if name is None:
        name = next(iter(spectrum.columns)) if len(spectrum.columns) == 1 else None
    if name is None:
        name = {"counts": "S", "spectral_radiance": "P"}[settings["quantity"]]  # as a Jaz names them
    if name not in spectrum.columns:
        refuse(
            path, f"no column {quote(name)}", f"state `column` in test.yaml: {', '.join(spectrum.columns)}"
        )
    return spectrum.columns[name]


def _plain(line):
    """A header line without accents (a letter lost to a wrong encoding is dropped)."""
    return "".join(c for c in unicodedata.normalize("NFKD", line) if c.isascii() or c == "\u03bc").strip()


def _body(path, lines, begin, end):
    names = None
    if begin < end and re.fullmatch(r"[A-Za-z]+(\s+[A-Za-z]+)+\s*", lines[begin]):
        names, begin = lines[begin].split(), begin + 1
        if len(set(names)) != len(names):
            refuse(path, f"repeated column names {quote(' '.join(names))}", "export it again", begin)
    rows = [(i, row) for i, row in enumerate(map(str.split, lines[begin:end]), begin + 1) if row]
    if len(rows) < 2 or len(rows) > MOST_PIXELS:
        refuse(path, f"holds {len(rows)} pixels", f"a spectrum has 2 to {MOST_PIXELS}", end)
    width = len(names) if names else len(rows[0][1])
    if width < 2:
        refuse(path, "a row needs a wavelength and a value", "export it again", rows[0][0])
    for line, row in rows:
        if len(row) != width:
            refuse(path, f"{len(row)} values where {width} are expected", "copy the file again", line)
    signs = set("".join(lines[begin:end]))
    if "," in signs and "." in signs:
        refuse(path, "decimal commas and decimal points are mixed", "export with one of them", rows[0][0])
    decimal = "," if "," in signs else "."
    table = _fast(rows, decimal) if signs <= BODY else None
    if table is None:
        table = np.array([_slow(path, line, row, decimal) for line, row in rows])
    falls = table[0, 0] > table[-1, 0]
    table = table[::-1] if falls else table  # as some programs sort them
    rising = np.diff(table[:, 0]) > 0
    if not rising.all():
        where = int(np.argmin(rising)) + 1
        line = rows[len(rows) - 1 - where if falls else where][0]
        refuse(path, "the wavelengths do not rise, or fall, throughout", "copy the file again", line)
    names = names or ["W", *(f"column {i}" for i in range(2, width + 1))]
    return table[:, 0] * 1e-9, dict(zip(names[1:], table[:, 1:].T, strict=True))


def _fast(rows, decimal):
    """All cells at once; None if one of them needs the strict reader."""
    try:
        flat = [float(cell.replace(decimal, ".")) for _, row in rows for cell in row]
    except ValueError:
        return None
    table = np.array(flat).reshape(len(rows), -1)
    return table if np.isfinite(table).all() else None


def _slow(path, line, row, decimal):
    values = [number(cell, decimal) for cell in row]
    if None in values or values[0] != values[0]:
        bad = row[values.index(None)] if None in values else row[0]
        refuse(path, f"{quote(bad)} is not a number", "copy the file again, or correct the line", line)
    return values


def _integer(header, *words):
    for line in header:
        key, colon, rest = line.partition(":")
        match = re.match(r"\s*(\d{1,9})(?![\d.,])", rest, re.ASCII)
        if colon and match and any(word in key.lower() for word in words):
            return int(match.group(1))
    return None


def _yes(header, word, but=None):
    for line in header:
        key, colon, rest = line.partition(":")
        if colon and word in key.lower() and not (but and but in key.lower()):
            first = rest.strip()[:1].lower()
            if first in {"y", "t", "s", "j", "o"}:
                return True
            if first in {"n", "f"}:
                return False
    return None


def _integration_time(path, header):
    for index, line in enumerate(header, 1):
        line = line[:LONGEST_KEY]  # of a header; the patterns take long where there is no such key
        match = EXPOSURE.search(line) or EXPOSED.search(line)
        if match is None or match["unit"].lower() not in PER_SECOND:
            continue
        word = match["value"]
        value = number(word, None)
        if value is None or not value > 0:
            refuse(path, f"integration time {quote(word)} is not a number > 0", "correct the header", index)
        return value / PER_SECOND[match["unit"].lower()]
    return None


def _date(header):
    for line in header:
        match = DATE.search(line)
        if match and match.group(1).lower() in MONTHS:
            _, day, hour, minute, second, zone, year = match.groups()
            try:
                month = MONTHS.index(match.group(1).lower()) + 1
                return datetime(int(year), month, int(day), int(hour), int(minute), int(second)), zone
            except ValueError:
                return None, None
    return None, None
