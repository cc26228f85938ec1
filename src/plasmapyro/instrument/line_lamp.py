"""Wavelength scale and slit width of a spectrometer from the lines of a Hg(Ar) lamp."""

from typing import NamedTuple

import numpy as np

from plasmapyro import tables
from plasmapyro.checks import increasing, positive
from plasmapyro.instrument.spectrometer import local_noise
from plasmapyro.radiation.slit import FWHM_PER_SIGMA
from plasmapyro.refraction import vacuum_wavelength

LAMP_TABLES = ("lamp/mercury_sansonetti_1996", "lamp/argon_nist")
ISOLATION = 2.5  # [FWHM] a line with another this near is left out
REACH = 1.6  # [FWHM] half of the range that is fitted
NOISE_BLOCK = 100  # pixels


class Line(NamedTuple):
    """A lamp line as found."""

    species: str
    certified: float  # [m] in vacuum
    wavelength: float  # [m] as found
    uncertainty: float  # [m]
    fwhm: float  # [m] of the fitted Gaussian, pixel width taken out
    signal_to_noise: float  # [1] of the peak


def lamp_lines():
    """Species (L,) and vacuum wavelengths (L,) [m] of the lines of a Hg(Ar) lamp, rising."""
    species, wavelength = [], []
    for name in LAMP_TABLES:
        table = tables.load(name)
        species += list(table["species"])
        wavelength += list(vacuum_wavelength(table["wavelength_air"]))
    order = np.argsort(wavelength)
    return np.array(species)[order], np.array(wavelength)[order]


def find_lines(wavelength, net, *, expected_fwhm, search, least_signal_to_noise):
    """Lamp lines in a spectrum, each a Line: position and width of a Gaussian integrated over each pixel.

    `net` (W,) [count] is dark subtracted, NaN where saturated, at `wavelength` (W,) [m] in vacuum. A line may
    be `search` [m] off; lines nearer to another than 2.5 of the rough slit width `expected_fwhm` [m] and
    those below `least_signal_to_noise` are left out. ValueError if no line is found.

    Deviation: the paper does not say how its spectrometer's wavelengths and FWHM were had.
    """
    wavelength = increasing("wavelength", wavelength, "m")
    net = np.asarray(net, dtype=float)
    width = float(positive("expected_fwhm", expected_fwhm, "m"))
    noise = local_noise(net, NOISE_BLOCK)
    species, certified = lamp_lines()
    # to the nearest neighbour
    apart = np.minimum(np.diff(certified, prepend=-np.inf), np.diff(certified, append=np.inf))
    found = []
    for name, line in zip(
        species[apart > ISOLATION * width], certified[apart > ISOLATION * width], strict=True
    ):
        if wavelength[0] + search < line < wavelength[-1] - search:
            found.append(_fit(wavelength, net, noise * least_signal_to_noise, name, line, width, search))
    found = [
        line._replace(signal_to_noise=line.signal_to_noise * least_signal_to_noise) for line in found if line
    ]
    if not found:
        raise ValueError("no line of mercury or argon found: is this the spectrum of a Hg(Ar) lamp?")
    return found


def _fit(wavelength, net, threshold, name, line, width, search):
    """The line near `line`, or None if it is below the threshold, samples are lost there, or no fit holds."""
    from scipy.optimize import least_squares
    from scipy.special import erf

    near = np.flatnonzero(np.abs(wavelength - line) <= search)
    if near.size < 3 or not np.isfinite(net[near]).all():
        return None
    top = near[np.argmax(net[near])]
    used = np.flatnonzero(np.abs(wavelength - wavelength[top]) <= REACH * width)
    if used.size < 6 or not np.isfinite(net[used]).all() or top in (0, wavelength.size - 1):
        return None
    grid, values = wavelength[used], net[used]
    pixel = float(np.median(np.diff(grid)))
    floor = float(np.min(values))
    height = float(net[top]) - floor
    if not height > threshold[top] > 0:
        return None

    def model(p):
        centre, sigma, area, level = p
        edges = np.stack([grid - pixel / 2, grid + pixel / 2])
        steps = erf((edges - (wavelength[top] + centre * width)) / (np.sqrt(2) * abs(sigma) * width))
        return (area * (steps[1] - steps[0]) * width / pixel + level) * height + floor

    start = [0.0, 1 / FWHM_PER_SIGMA, 0.5, 0.0]
    result = least_squares(lambda p: (model(p) - values) / height, start)
    centre, sigma = result.x[0] * width, abs(result.x[1]) * width
    if not result.success or abs(wavelength[top] + centre - line) > search or not sigma > pixel / 20:
        return None
    freedom = max(values.size - 4, 1)
    try:
        covariance = np.linalg.inv(result.jac.T @ result.jac) * (2 * result.cost / freedom)
    except np.linalg.LinAlgError:
        return None
    if not covariance[0, 0] >= 0:
        return None
    return Line(
        str(name),
        float(line),
        float(wavelength[top] + centre),
        float(np.sqrt(covariance[0, 0]) * width),
        float(FWHM_PER_SIGMA * sigma),
        float(height / threshold[top]),
    )
