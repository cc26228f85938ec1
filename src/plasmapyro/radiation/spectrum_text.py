"""Spectra as text in the columns of NEQAIR's `intensity_scanned.out` and `intensity.out`."""

import numpy as np

from plasmapyro.checks import increasing

ANGSTROM = 1e-10  # [m]
PER_MICROMETRE = 1e10  # [W m-2 sr-1 m-1] in one W cm-2 sr-1 um-1
HEADER_LINES = 2
RADIANCE_COLUMN = {2: 1, 3: 1, 4: 2}  # columns of the file -> column of the radiance; 4: intensity.out


def compose_spectrum(wavelength, radiance):
    r"""Text of a spectrum, as `intensity_scanned.out` lays it out.

    Two header lines, then wavelength [Angstrom], spectral radiance [W cm-2 sr-1 um-1] and its running
    integral [W cm-2 sr-1] (trapezoidal rule).

    Parameters
    ----------
    wavelength : (G,) [m]
        In vacuum, increasing.
    radiance : (G,) [W m-2 sr-1 m-1]

    Returns
    -------
    str

    Raises
    ------
    ValueError
        Wavelengths that do not increase.

    Notes
    -----
    Source: columns as read by NEQAIR_INTEGRATION (D. Saunders, NASA Ames, CFD Utilities, 2018), for NEQAIR 14
    and 15; that program ignores the third column, whose meaning here is our choice.
    """
    wavelength = increasing("wavelength", wavelength, "m")
    angstrom, watts = wavelength / ANGSTROM, np.asarray(radiance) / PER_MICROMETRE
    pieces = np.diff(angstrom) * 1e-4 * (watts[1:] + watts[:-1]) / 2
    running = np.concatenate([[0.0], np.cumsum(pieces)])
    lines = [
        "Spectral radiance of the gas, wavelength in vacuum",
        "Wavelength[A]   Radiance[W/cm2-sr-um]   Integral[W/cm2-sr]",
    ]
    rows = zip(angstrom, watts, running, strict=True)
    lines += [f"{position:14.6f} {value:15.8E} {integral:15.8E}" for position, value, integral in rows]
    return "\n".join(lines) + "\n"


def parse_spectrum(text):
    r"""Spectrum from text in the columns of `intensity_scanned.out` (2 or 3) or `intensity.out` (4).

    Parameters
    ----------
    text : str
        Two header lines, then wavelength [Angstrom] in the first column and the radiance [W cm-2 sr-1 um-1]
        in the second, or in the third of four. A wavelength given twice, as version 14 does where two of its
        spectral regions meet, counts once.

    Returns
    -------
    tuple of ndarray : wavelength (G,) [m], increasing, and spectral radiance (G,) [W m-2 sr-1 m-1]

    Raises
    ------
    ValueError
        One message with the number of the line: no data, another number of columns, no number where one is
        due, wavelengths that fall.

    Notes
    -----
    Source: as `compose_spectrum`.
    """
    rows = [
        (line, words)
        for line, words in enumerate((line.split() for line in text.splitlines()), start=1)
        if line > HEADER_LINES and words
    ]
    if not rows:
        raise ValueError(f"line {HEADER_LINES + 1}: no spectrum after the two header lines")
    columns = len(rows[0][1])
    if columns not in RADIANCE_COLUMN:
        raise ValueError(f"line {rows[0][0]}: 2, 3 or 4 columns expected, {columns} found")
    values = []
    for line, words in rows:
        if len(words) != columns:
            raise ValueError(f"line {line}: {columns} columns expected, {len(words)} found")
        try:
            pair = float(words[0]), float(words[RADIANCE_COLUMN[columns]])
        except ValueError:
            raise ValueError(f"line {line}: not a number among {' '.join(words)!r}") from None
        if not np.isfinite(pair).all():
            raise ValueError(f"line {line}: wavelength and radiance must be finite")
        if values and pair[0] < values[-1][0]:
            raise ValueError(f"line {line}: wavelengths must increase; got {values[-1][0]} then {pair[0]} A")
        if not values or pair[0] > values[-1][0]:
            values.append(pair)
    angstrom, watts = np.array(values).T
    return angstrom * ANGSTROM, watts * PER_MICROMETRE
