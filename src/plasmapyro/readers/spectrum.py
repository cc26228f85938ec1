"""One spectrum in a text file: wavelengths in nanometres and one or more frames of signal beside them."""

import numpy as np

from plasmapyro.readers.columns import DELIMITERS
from plasmapyro.readers.ocean import FENCE, read_spectrum
from plasmapyro.readers.text import number, read_lines, refuse

LARGEST = 32_000_000  # [byte]
HEADER_LINES = 100
SHORTEST, LONGEST = 100.0, 30000.0  # [nm]
LEAST = 20  # channels


def read_frames(path):
    """Wavelengths (N,) [m] as the instrument gives them and frames (F, N) of a spectrum.

    A file of SpectraSuite, OceanView or Jaz, or lines of numbers below a header of words: the wavelength
    [nm], then the signal, or several frames of it (as Andor Solis exports them).

    Raises
    ------
    Refusal
        No such file; no wavelengths in nanometres that rise; a line that is no row of numbers.
    """
    lines, _ = read_lines(path, LARGEST)
    if any(line.startswith(FENCE) for line in lines[:HEADER_LINES]):
        spectrum = read_spectrum(path)
        return spectrum.wavelength, np.array([list(spectrum.columns.values())[-1]])
    first, split = _begin(path, lines)
    rows = []
    for at, line in enumerate(lines[first:], first + 1):
        row = split(line)
        if not line.strip():
            continue
        if row is None or (rows and len(row) != len(rows[0])) or np.isnan(row).any():
            refuse(path, "is no row of as many numbers as those above", "correct or remove the line", at)
        rows.append(row)
    table = np.array(rows)
    wavelength = table[:, 0]
    if len(rows) < LEAST or not (np.diff(wavelength) > 0).all() or not _in_range(wavelength):
        refuse(
            path,
            "the first column is no scale of wavelengths:"
            f" {len(rows)} rows from {wavelength[0]:g} to {wavelength[-1]:g}",
            f"it must hold {LEAST} or more, rising, in nm",
        )
    return wavelength * 1e-9, table[:, 1:].T


def _in_range(wavelength):
    return wavelength[0] >= SHORTEST and wavelength[-1] <= LONGEST


def _begin(path, lines):
    """Index of the first row of numbers, and what splits a line into numbers (None if it holds others)."""
    for at, line in enumerate(lines[:HEADER_LINES]):
        for mark in DELIMITERS.values():
            for decimal in ".,":
                if decimal != mark and len(_row(line, mark, decimal) or ()) >= 2:
                    return at, lambda line, mark=mark, decimal=decimal: _row(line, mark, decimal)
    refuse(path, "holds no row of two or more numbers", "it needs wavelength [nm] and signal in columns")


def _row(line, mark, decimal):
    cells = line.split() if mark.isspace() else line.rstrip().rstrip(mark).split(mark)
    values = [number(cell, decimal) for cell in cells]
    return None if None in values else values
