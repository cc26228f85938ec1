"""One spectrum in a text file: wavelengths and one or more frames of signal beside them."""

import re

import numpy as np

from plasmapyro.readers import spectra_table
from plasmapyro.readers.ocean import (
    DARK,
    DERIVED,
    FENCE,
    LEAST_PIXELS,
    NO_LIGHT,
    block_of,
    names_above,
    read_spectrum,
    rising,
)
from plasmapyro.readers.text import quote, read_lines, refuse

LARGEST = 32_000_000  # [byte]
HEADER_LINES = 100
# [1] by which two scales of one detector differ, and one scale in two units (powers of ten)
ALIKE, SAME, UNITS = 1e-3, 1e-5, (-3, 0, 1)
NO_WAVELENGTH = re.compile(r"raman|wave ?num|wellenzahl|energ|cm\^?-1|1/cm|\bevs?\b", re.IGNORECASE)
SPREAD = re.compile(  # of what stands beside it, no light
    r"(^|[\W_])(std(dev|ev)?|s\.?d|sem|rmsd?|sigma|\u03c3|err(or)?s?|uncert\w*|unc|deviation|fehler|incert\w*"
    r"|\w*unsicherheit|standardabw\w*|[e\u00e9]cart\w*|desv\w*)([\W_\d]|$)",
    re.IGNORECASE,
)
TAKEN_OFF = re.compile(r"subtract|correct|korrig|minus|net\b", re.IGNORECASE)


def read_frames(path, least=LEAST_PIXELS):
    """Wavelengths (N,) [m] as the instrument gives them and frames (F, N) of a spectrum.

    A file of SpectraSuite, OceanView or Jaz, or lines of numbers below a header of words: the wavelength [nm]
    ([um] if all are below 10, Angstrom if its name says so), then the signal, or several frames of it (as
    Andor Solis exports them); a column named as dark is subtracted unless it is already; one of the same
    wavelengths or of pixel numbers, or named as an error or a reference, is left out. NaN where no number
    stands. Refusal: no such file; fewer rows than `least`; no wavelengths that rise or fall, or two scales of
    them; a line that is no row of numbers.
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
    table, names = block.table, names_above(lines, block)[1]
    above = lines[block.lines[0] - 1] if block.lines[0] else ""
    if block.stop is not None or np.isnan(table[:, 0]).any():
        bad = np.isnan(table[:, 0])
        at = block.lines[int(bad.argmax())] if bad.any() else block.stop
        refuse(path, "is no row of as many numbers as those above", "correct or remove the line", at + 1)
    if not names and NO_WAVELENGTH.search(above):
        refuse(path, f"{quote(above.strip())} is no column of wavelengths", "export it over wavelength")
    place = next((i for i, name in enumerate(names) if spectra_table.WAVES.search(name)), 0)
    if table.shape[1] > 2 and not names and table[0, 0] in (0, 1) and (np.diff(table[:, 0]) == 1).all():
        place = 1  # behind the number of the pixel
    names, own = names[place:] or [""], table[:, place:]
    own, wavelength = rising(own, names[0])
    if len(own) < least or wavelength is None or own.shape[1] < 2:
        refuse(
            path,
            f"the first column is no scale of wavelengths: {_why(table[:, place])}",
            f"it must hold {least} or more, rising or falling, in nm (or um; or Angstrom, if its name"
            " says so)",
        )
    if own.shape[1] > 2:
        names, own = _without_scales(path, names, own)
    return wavelength, _light(names[1:], own[:, 1:].T)


def _light(names, columns):
    """Frames (F, N) of light among columns (C, N), their dark subtracted; all that have no name are frames.

    Not light: errors; beside raw signals a reference, what was made of them, and the dark.
    """
    names = [*names, *[""] * (len(columns) - len(names))]
    dark = np.array([bool(DARK.search(name) and not DERIVED.search(name)) for name in names])
    spread = np.array([SPREAD.search(name) is not None for name in names])
    raw = ~dark & ~spread & [NO_LIGHT.search(name) is None for name in names]
    light = raw if raw.any() else ~dark & ~spread
    if not light.any():
        return columns
    off = [TAKEN_OFF.search(name) is not None or DARK.search(name) is not None for name in names]
    if not dark.any() or np.all(np.array(off)[light]):
        return columns[light]
    return columns[light] - columns[dark].mean(axis=0)


def _without_scales(path, names, table):
    """Names and columns (N, C) without numbers of pixels and without the first, in any unit, once more."""
    names, kept = names + [""] * (table.shape[1] - len(names)), [0]
    for place in range(1, table.shape[1]):
        column = table[:, place]
        step, ratio = np.diff(column), column / table[:, 0]
        alike = np.all(np.abs(ratio - ratio.mean()) < ALIKE * abs(ratio.mean()))
        pixels = column.min() in (0, 1) and (np.abs(step) == 1).all()
        if not (spectra_table.WAVES.search(names[place]) or pixels or alike):
            kept.append(place)
            continue
        same = alike and np.isclose(np.log10(abs(ratio.mean())), UNITS, atol=SAME).any()
        if not pixels and not same:
            refuse(
                path,
                f"column {place + 1} is a second scale of wavelengths, from {column[0]:g} to {column[-1]:g}",
                "leave one scale in the file, and what was measured on it",
            )
    if len(kept) == 1:
        refuse(path, "holds wavelengths without a signal", "it needs wavelength [nm] and signal in columns")
    return [names[place] for place in kept], table[:, kept]


def _why(values):
    """What is wrong with a column of wavelengths, in words."""
    words = f"{values.size} rows from {values[0]:g} to {values[-1]:g}"
    steps = np.diff(values) * np.sign(values[-1] - values[0])
    if values.size > 1 and (steps <= 0).any() and (steps > 0).mean() > 0.5:
        place = int(np.argmax(steps <= 0)) + 1
        return f"{words}, and {values[place]:g} does not lie beyond {values[place - 1]:g}"
    return words
