"""Series of spectra as Andor Solis exports them: one row per pixel, above or below it 'key: value' lines."""

import re
from contextlib import suppress
from datetime import datetime
from typing import NamedTuple

import numpy as np

from plasmapyro.readers.ocean import Spectrum
from plasmapyro.readers.spectrum import read_frames
from plasmapyro.readers.text import number, quote, read_lines, refuse, require_end

LARGEST = 96_000_000  # [byte]
HEADER_LINES = 200
ROW = re.compile(r"\s*[+-]?[\d.]")
MOST_SAMPLES = 50_000_000
DATES = "%a %b %d %H:%M:%S.%f %Y", "%a %b %d %H:%M:%S %Y"


class Series(NamedTuple):
    """Frames of one file: wavelengths as the instrument gives them, counts, and their times."""

    time: np.ndarray  # (n,) [s] middle of each exposure, from the begin of the first
    wavelength: np.ndarray  # (W,) [m]
    counts: np.ndarray  # (n, W)
    exposure: float | None  # [s], if the header states one
    date: datetime | None  # of the begin, if the header states one


def read_series(path):
    """The `Series` of an ASCII export of a kinetic series, or of a single spectrum.

    Refusal: not such a file, or incomplete: no times of the frames, no rows, a row of another length, a cell
    that is no number, wavelengths that do not rise.
    """
    lines, ended = read_lines(path, LARGEST)
    require_end(path, lines, ended)
    about = [line for line in lines[:HEADER_LINES] + lines[-HEADER_LINES:] if not ROW.match(line)]
    header = {name: value.strip() for name, _, value in (line.partition(":") for line in about)}
    exposure, cycle = (_seconds(path, header, key) for key in ("Exposure Time", "Kinetic Cycle Time"))
    step = cycle or exposure
    if step is None:
        refuse(path, "states no exposure time", "export it from Andor Solis as ASCII with its header")
    wavelength, counts = read_frames(path)
    if counts.size > MOST_SAMPLES:
        refuse(path, f"{len(counts)} frames of {wavelength.size} pixels", "export as many as fit")
    time = (exposure or step) / 2 + step * np.arange(len(counts))
    return Series(time, wavelength, counts, exposure, _date(header.get("Date and Time", "")))


def mean_spectrum(path):
    """The mean of the frames of a file (see `read_series`), as an `ocean.Spectrum` of 'counts'.

    Of a pixel that some frames lack it is that of the others.
    """
    series = read_series(path)
    held = np.isfinite(series.counts)
    with np.errstate(invalid="ignore"):
        columns = {"counts": np.where(held, series.counts, 0.0).sum(axis=0) / held.sum(axis=0)}
    return Spectrum(series.wavelength, columns, integration_time=series.exposure)


def _date(text):
    for form in DATES:
        with suppress(ValueError):
            return datetime.strptime(text, form)
    return None


def _seconds(path, header, key):
    """A duration [s] of the header, or None."""
    for name, value in header.items():
        if name.startswith(key):
            found = number(value, None)
            if found is None or not found > 0:
                refuse(path, f"{name} is {quote(value)}, no number > 0", "correct the header")
            return found
    return None
