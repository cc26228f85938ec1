"""Tables of spectra: a row, a column or rows of pixels per spectrum."""

import re

import numpy as np

from plasmapyro.readers import clock
from plasmapyro.readers.cells import (
    COMMENT,
    DELIMITERS,
    decimal_sign,
    split,
    without_empty_end,
)
from plasmapyro.readers.columns import HEADER_LINES, LARGEST, MOST_CELLS, STACKED
from plasmapyro.readers.text import (
    FILLS,
    Refusal,
    number,
    quote,
    read_lines,
    refuse,
    refuse_all,
    require_end,
)

WAVES = re.compile(
    r"lambda|\u03bb|wave(l|$)|wellenl|onda|onde|\u6ce2\u9577|^\W*(nm|um|\u00b5m)\W*$", re.IGNORECASE
)
TIMES = re.compile(r"\W*(t|time|zeit|temps|tiempo|tempo)(\b|_)", re.IGNORECASE)
FRAME = re.compile(r"\W*(frame|spectrum|scan|spektrum|spectre)", re.IGNORECASE)
VALUE = re.compile(r"intens|count|signal|radiance|value|wert", re.IGNORECASE)
MOST_OF_LONG = 12  # columns of a table of a row per pixel
ANGSTROM = re.compile(r"\u00c5|\u212b|[Aa]ngstr|ANGSTR|[\[(/]\s*A\s*($|[\])])", re.ASCII)


def read_matrix(path, delimiter=None, decimal=None, stamps=None):
    """A table of spectra: first header cell anything, then wavelengths; each row a time and its values.

    Where the first cell names wavelengths ('lambda', 'nm'), they stand in the first column instead, and each
    other column is a spectrum below its time (a single one, such as a dark, below any word; the times may
    stand in a row above). Where a later cell does, the table is long: a row per pixel, with its time or the
    number of its frame. Lines of words above the table are passed over.

    Time (N,), wavelength (W,) and values (N, W) in the units of the file; NaN for missing values. `stamps`:
    (format, zero) of times that are dates or times of day, see `clock`. Refusal as `read_table`; also if a
    header cell is no number or a spectrum has no time.
    """
    lines, ended = read_lines(path, LARGEST)
    require_end(path, lines, ended)
    lines = series_lines(lines)
    rows = [
        (i, line) for i, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith(COMMENT)
    ]
    if len(rows) < 2:
        refuse(path, "holds no spectrum", "it needs a header with wavelengths and a row per spectrum")
    mark = DELIMITERS[delimiter] if delimiter else max(DELIMITERS.values(), key=rows[-1][1].count)
    width = rows[-1][1].count(mark)
    while len(rows) > 2 and width and rows[0][1].count(mark) < width / 2 and rows[0][0] <= HEADER_LINES:
        del rows[0]
    if (place := upright_row([split(line, mark) for _, line in rows])) is not None:
        header = split(rows[place][1], mark)
        if not any(header[1:]):  # the times stand above
            timed = [i for i in range(place) if TIMES.match(split(rows[i][1], mark)[0])]
            above = timed[-1] if timed else max(place - 1, 0)
            header = [header[0], *split(rows[above][1], mark)[1:]]
        rows = [(rows[place][0], None), *rows[place + 1 :]]
    else:
        header = split(rows[0][1], mark)
    header = without_empty_end(header)
    if place is None and (more := spare_columns(header)):
        rows = [(line, mark.join(_without(split(words, mark), more))) for line, words in rows]
        header = _without(header, more)
    if long := long_places(header):
        return _long(path, header, [(line, split(words, mark)) for line, words in rows[1:]], long, decimal)
    cells = {line: _cut(split(words, mark), len(header)) for line, words in rows[1:]}
    upright = place is not None
    if not upright and len(header) < 3 or len(header) * len(cells) > MOST_CELLS:
        refuse(
            path,
            f"{len(cells)} spectra of {len(header) - 1} pixels",
            f"a spectrum has 2 pixels or more, a file at most {MOST_CELLS} values; or name the `delimiter`",
            rows[0][0],
        )
    ragged = [line for line, row in cells.items() if len(row) != len(header)]
    if ragged:
        refuse(
            path,
            f"{len(cells[ragged[0]])} cells, the header has {len(header)}",
            "restore or remove the line",
            ragged[0],
        )
    if upright:
        header, *spectra = map(list, zip(header, *cells.values(), strict=True))
        for row in spectra:
            row[0] = moment(row[0])
        cells = dict(zip(range(rows[0][0] + 1, rows[0][0] + 1 + len(spectra)), spectra, strict=True))
        if len(spectra) == 1 and number(spectra[0][0]) is None:
            spectra[0][0] = "0"
            stamps = None
    elif stamps and len(cells) == 1 and not clock.looks_like_stamp(next(iter(cells.values()))[0]):
        stamps = None  # of a dark the time does not matter
    times = None
    if stamps:
        times, faults = clock.times(path, [row[0] for row in cells.values()], list(cells), *stamps, False)
        refuse_all(path, faults)
        for row in cells.values():
            row[0] = "0"
    elif stamped := [line for line, row in cells.items() if clock.looks_like_stamp(row[0])]:
        refuse(
            path,
            f"{quote(cells[stamped[0]][0])} is a date or a time of day",
            f"state `time_format`, e.g. '{clock.EXAMPLE}', and `zero` in the same form",
            stamped[0],
        )
    listing = {rows[0][0]: header[1:], **cells}
    if decimal is None:
        decimal, faults = decimal_sign(path, mark, listing, [rows[0][0]])
        if faults:
            raise Refusal(faults)
    numbers = {}
    for line, row in listing.items():
        values = [number(word, decimal, thousands=True) for word in row]
        if None in values:
            refuse(path, f"{quote(row[values.index(None)])} is not a number", "correct it", line)
        numbers[line] = np.array(values)
        row.clear()
    wavelength = numbers.pop(rows[0][0])
    if np.isnan(wavelength).any():
        refuse(path, "a wavelength is missing in the header", "every column needs one", rows[0][0])
    table = np.array(list(numbers.values()))
    values = np.where(np.isin(table[:, 1:], FILLS), np.nan, table[:, 1:])
    return table[:, 0] if times is None else times, wavelength, values


def upright_row(rows):
    """The row that names the wavelengths below it in the first column, or stands above them; or None."""
    named = next((i for i, row in enumerate(rows[: STACKED + 1]) if row and names_wavelengths(row[0])), None)
    if named is not None or len(rows) < 4 or len(rows[0]) < 3:
        return named
    below = [number(row[0], None) for row in rows[1:]]
    rising = None not in below and below[0] > 150 and (np.diff(below) > 0).all()
    return 0 if rising and all(map(clock.looks_like_stamp, rows[0][1:])) else None


def long_places(header):
    """Places of wavelength, value and time or frame (or None) in a table of a row per pixel; or None."""
    waves = [i for i, cell in enumerate(header) if WAVES.search(cell) and number(cell) is None]
    times = [i for i, cell in enumerate(header) if TIMES.match(cell) or FRAME.match(cell)]
    values = [i for i, cell in enumerate(header) if VALUE.search(cell)]
    if len(waves) != 1 or not values or not (times or waves[0] > 0) or len(header) > MOST_OF_LONG:
        return None
    stamps = [i for i in times if TIMES.match(header[i])]
    return waves[0], values[-1], (stamps or times or [None])[0]


def _long(path, header, cells, places, decimal):
    """(time, wavelength, values) of a table of a row per pixel; times may be numbers of frames."""
    needed, stated = max(place for place in places if place is not None), decimal is not None
    decimal = decimal or (
        "," if any("," in row[places[0]] for _, row in cells[:9] if len(row) > needed) else "."
    )
    columns = []
    for place in places:
        words = (
            [(line, row[place] if place < len(row) else "") for line, row in cells]
            if place is not None
            else []
        )
        values = [number(word, decimal, thousands=stated) for _, word in words]
        if None in values:
            line, word = words[values.index(None)]
            refuse(
                path, f"{quote(word)} in column {quote(header[place])} is not a number", "correct it", line
            )
        columns.append(np.array(values, dtype=float))
    pixels, values, time = columns
    again = np.flatnonzero(pixels[1:] == pixels[0])
    count = again[0] + 1 if again.size else pixels.size
    if pixels.size % count or not (pixels.reshape(-1, count) == pixels[:count]).all():
        refuse(path, f"its {pixels.size} rows are no whole spectra of {count} pixels", "export it again")
    time = time[::count] if time.size else np.arange(pixels.size // count, dtype=float)
    values = np.where(np.isin(values, FILLS), np.nan, values)
    return time, pixels[:count], values.reshape(-1, count)


def series_lines(lines):
    """Lines of a table of spectra; of a series in one file of OceanView those below its header.

    There a row of wavelengths stands behind two empty cells, below it each row begins with a stamp and
    milliseconds since 1970, of which the stamp is kept.
    """
    first = next((i for i, line in enumerate(lines[:HEADER_LINES]) if line.startswith(">>>>>")), None)
    if first is None or first + 1 >= len(lines) or not lines[first + 1].startswith("\t\t"):
        return lines
    body = (line.split("\t") for line in lines[first + 1 :] if not line.startswith(">>>>>"))
    table = ["\t".join([cells[0], *cells[2:]]) for cells in body]
    return [*[""] * (first + 1), "time" + table[0], *table[1:]]


def spare_columns(header):
    """How many named columns stand between the times and the wavelengths of a table of spectra."""
    first = next((i for i in range(1, len(header)) if number(header[i]) is not None and header[i]), 0)
    rest = [number(cell, None) for cell in header[first:]]
    return first - 1 if 1 < first < MOST_OF_LONG and len(rest) > 2 * first and None not in rest else 0


def _without(cells, more):
    return [cells[0], *cells[1 + more :]]


def names_wavelengths(cell):
    """Whether the first cell of a table names the wavelengths below it, not times beside a row of them."""
    return WAVES.search(cell) is not None and not TIMES.match(cell)


def moment(word):
    """A cell of a time without its unit, if that is seconds, and a word before it: 'Spectrum 0.5 s'."""
    return re.sub(r"^[^\W\d]+[ _]+(?=[\d.]+\D*$)|(?<=\d)\s*s(ec)?$", "", word.strip())


def _cut(cells, width):
    """Cells without empty ones beyond `width`."""
    return cells[: max(width, len(without_empty_end(cells)))]
