"""Spectra as text in the columns of NEQAIR's `intensity_scanned.out`."""

import numpy as np

from plasmapyro.checks import increasing

ANGSTROM = 1e-10  # [m]
PER_MICROMETRE = 1e10  # [W m-2 sr-1 m-1] in one W cm-2 sr-1 um-1


def compose_spectrum(wavelength, radiance):
    r"""Text of a spectrum, as `intensity_scanned.out` lays it out.

    Two header lines, then wavelength [Angstrom], spectral radiance [W cm-2 sr-1 um-1] and its running
    integral [W cm-2 sr-1] (trapezoidal rule).

    Source: columns as read by NEQAIR_INTEGRATION (D. Saunders, NASA Ames, CFD Utilities, 2018), for NEQAIR 14
    and 15; that program ignores the third column, whose meaning here is our choice.

    ValueError: wavelengths that do not increase.

    Parameters
    ----------
    wavelength : (G,) [m]
        In vacuum, increasing.
    radiance : (G,) [W m-2 sr-1 m-1]
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
