"""What a black body gives in the channels of an instrument, by bins of wavelength, over its temperature."""

import dataclasses

import numpy as np

from plasmapyro.estimate.bins import FINE, band_edges, bin_mean, pixel_bins, spectrometer_edges
from plasmapyro.radiation.bandsignal import BANDS, responsivities, two_bands
from plasmapyro.radiation.planck import blackbody_derivatives

MIDDLE = 1500.0  # [K] where x of `InverseTable` is T
# A cold surface is heated in kelvin, not in 1/T. At half of `MIDDLE` it gives 1e-4 of the light, at 1 um;
# 100 K less or more move valid temperatures by 0.3 of their uncertainty at most, gas_dominated ones by 1.
COLD = 750.0  # [K]
TABLE_TEMPERATURES = (200.0, 4000.0)  # [K] of the tables of a grey surface
ROUNDING = 1e-9  # [1] by which paths may pass the ends of the tables
TABLE_POINTS = 400  # equal steps of 1/T; ln S is nearly straight in it: error below 1e-8


@dataclasses.dataclass(frozen=True)
class Instrument:
    """Bins of wavelength and what they give in the channels; `weight` None: each bin is a channel."""

    edges: np.ndarray  # (B + 1,) [m]
    weight: np.ndarray | None = None  # (C, B) signal per radiance of a bin

    @property
    def wavelength(self):
        """(B,) [m] middle of each bin."""
        return (self.edges[1:] + self.edges[:-1]) / 2

    def detect(self, radiance):
        """Signal (..., C) of a radiance (..., B)."""
        return radiance if self.weight is None else radiance @ self.weight.T


def pyrometer(response, calibration):
    """The pyrometer as `Instrument`, with the absolute sensitivities of its calibration as gains.

    `response`, `calibration`: Datasets of these contracts. Source: Fagnani et al., eq. 1, with the
    responsivity as mean over each bin.
    """
    wavelength = response.wavelength.values
    bands = np.stack(responsivities(two_bands(response, "the joint estimate")))
    edges = band_edges(wavelength, bands[0])
    gains = calibration.absolute_sensitivity.sel(band=list(BANDS)).values
    return Instrument(edges, gains[:, None] * bin_mean(wavelength, bands, edges) * np.diff(edges))


def radiometer(calibration, frames):
    """`Instrument` of any bands, with the sensitivities of its calibration and the window before the test.

    `calibration`: contract 'radiometer_calibration'; `frames`: `record.Instrument` with bands and window.
    """
    bands = calibration.sel(band=list(frames.band))
    wavelength, curves = bands.wavelength.values, bands.responsivity.values
    seen = np.flatnonzero((curves > 0).any(axis=0))
    low, high = wavelength[max(seen[0] - 1, 0)], wavelength[min(seen[-1] + 1, wavelength.size - 1)]
    edges = np.linspace(low, high, int(np.ceil((high - low) / FINE)) + 1)
    gain = bands.band_sensitivity.values[:, None] * frames.window_transmittance
    return Instrument(edges, gain * bin_mean(wavelength, curves, edges) * np.diff(edges))


def spectrometer(pixels):
    """The spectrometer of some pixels (W,) [m]: radiance in bins, one for each line of the gas."""
    return Instrument(spectrometer_edges(pixels))


class GreyTable:
    """Black body signals of an instrument as a function of 1/T, with two derivatives by T."""

    def __init__(self, instrument):
        from scipy.interpolate import CubicSpline

        low, high = TABLE_TEMPERATURES
        inverse = np.linspace(1 / high, 1 / low, TABLE_POINTS)
        body = blackbody_derivatives(instrument.wavelength, 1 / inverse[:, None])[0]
        # Evaluated here: three calls of scipy take ten times as long for the one temperature of a filter.
        self._pieces = CubicSpline(inverse, np.log(instrument.detect(body))).c
        self._inverse, self.temperatures = inverse, TABLE_TEMPERATURES

    def __call__(self, temperature):
        r"""Signal, :math:`S'`, :math:`S''` by the temperature, each (t, C); ValueError outside the table."""
        temperature = np.asarray(temperature, dtype=float)
        low, high = np.array(self.temperatures) * (1 - ROUNDING, 1 + ROUNDING)
        if not np.all((temperature >= low) & (temperature <= high)):
            raise ValueError(
                f"temperature must lie in [{self.temperatures[0]:g}, {self.temperatures[1]:g}] K;"
                f" got {np.min(temperature):g} to {np.max(temperature):g} K"
            )
        beta, nodes = 1 / temperature, self._inverse
        piece = ((beta - nodes[0]) / (nodes[1] - nodes[0])).astype(int).clip(0, nodes.size - 2)
        away, beta = (beta - nodes[piece])[:, None], beta[:, None]
        cubic, square, slope, start = self._pieces[:, piece]
        value = np.exp(((cubic * away + square) * away + slope) * away + start)
        logarithmic, bend = (3 * cubic * away + 2 * square) * away + slope, 6 * cubic * away + 2 * square
        first = -(beta**2) * logarithmic
        second = first**2 + beta**4 * bend + 2 * beta**3 * logarithmic
        return value, value * first, value * second


class InverseTable:
    r"""A `GreyTable` over :math:`x = T_0 (2 - T_0/T)` instead of T: in kelvin, and dx/dT = 1, at T_0.

    Temperatures of the same light at other emissivities, or by another source of the calibration, differ by
    a constant in x (Wien's law): all these paths bend as much, and none is the likelier for it. In T the most
    probable path is the coldest, 40 to 170 K too cold where a record is fine. Below `COLD` x is linear in T.
    """

    def __init__(self, table):
        self._table, self.temperatures = table, tuple(straight(np.array(table.temperatures)))

    def __call__(self, x):
        """Signal and two derivatives by x, each (t, C)."""
        kelvin, slope = from_straight(np.asarray(x, dtype=float))
        value, first, second = self._table(np.clip(kelvin, *self._table.temperatures))  # rounding at the ends
        slope, bend = slope[:, None], np.where(kelvin > COLD, 2 * slope**2 / kelvin, 0.0)[:, None]
        return value, first * slope, second * slope**2 + first * bend


def straight(kelvin):
    """x (...) [K] of temperatures (...), see `InverseTable`."""
    warm = np.maximum(kelvin, COLD)
    return MIDDLE * (2 - MIDDLE / warm) + (MIDDLE / COLD) ** 2 * (kelvin - warm)


def from_straight(x):
    """Temperatures (...) [K] of x (...), and their slope dT/dx (...)."""
    x, edge = np.asarray(x, dtype=float), straight(COLD)
    kelvin = MIDDLE**2 / (2 * MIDDLE - np.maximum(x, edge))
    slope = (kelvin / MIDDLE) ** 2
    return kelvin + slope * np.minimum(x - edge, 0.0), slope


def bin_pixels(pixels, spectra, usable, edges):
    """Means of the usable pixels of each bin.

    Parameters
    ----------
    pixels : (W,) array [m]
    spectra : (S, W) array
    usable : (S, W) bool array
    edges : (C + 1,) array [m]

    Returns
    -------
    mean : (S, C) ndarray, NaN where a bin has lost a pixel that other exposures have
    count : (C,) ndarray
        Pixels that enter.
    """
    place = pixel_bins(pixels, edges)
    ever = usable.any(axis=0)
    total, lost = np.zeros((2, len(spectra), len(edges) - 1))
    for column in np.flatnonzero(ever):
        good = usable[:, column]
        total[:, place[column]] += np.where(good, spectra[:, column], 0.0)
        lost[:, place[column]] += ~good
    count = np.bincount(place[ever], minlength=len(edges) - 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where((lost == 0) & (count > 0), total / count, np.nan), count
