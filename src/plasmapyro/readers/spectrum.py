"""One spectrum in a text file: wavelengths in nanometres and one or more frames of signal beside them."""

import numpy as np

from plasmapyro.readers.ocean import FENCE, block_of, read_spectrum
from plasmapyro.readers.text import read_lines, refuse

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
    while lines and (":" in lines[-1] or not lines[-1].strip()):
        del lines[-1]  # the settings of the instrument below the table
    block = block_of(lines, least=1)
    if block is None:
        refuse(path, "holds no row of two or more numbers", "it needs wavelength [nm] and signal in columns")
    table = block.table
    if block.stop is not None or np.isnan(table).any():
        at = block.lines[int(np.isnan(table).any(axis=1).argmax())] if np.isnan(table).any() else block.stop
        refuse(path, "is no row of as many numbers as those above", "correct or remove the line", at + 1)
    wavelength = table[:, 0]
    if len(table) < LEAST or not (np.diff(wavelength) > 0).all() or not _in_range(wavelength):
        refuse(
            path,
            "the first column is no scale of wavelengths:"
            f" {len(table)} rows from {wavelength[0]:g} to {wavelength[-1]:g}",
            f"it must hold {LEAST} or more, rising, in nm",
        )
    return wavelength * 1e-9, table[:, 1:].T


def _in_range(wavelength):
    return wavelength[0] >= SHORTEST and wavelength[-1] <= LONGEST
