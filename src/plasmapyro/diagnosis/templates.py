"""What the gas looks like to each instrument: templates on the nodes of an instrument, and how they vary."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from plasmapyro.radiation.slit import FWHM_PER_SIGMA

ATOMIC_GAP = 1.0e-9  # [m] of darkness: lines of an atom with less between them share a strength (a multiplet)
MOLECULAR_EDGES = (
    np.array([700, 800, 945, 1200]) * 1e-9
)  # [m] between sequences of N2 1P (2, 1, 0 more vibration)
ATOMS = ("N I", "O I")
BANDS_OF = "N2 1P"
SMALL = 1.5e-3  # [1], of the light: smaller groups of lines join the rest


@dataclass(frozen=True)
class GasLibrary:
    """Spectra of the gas behind a slit, for all simulated powers and for single things varied.

    `wavelength` (K,) [m]; `log_power` (C,) [1] increasing; `radiance` (C, K) [W m-2 sr-1 m-1];
    `group` (G, K): the light of the condition in groups of lines, adding up to it; `variation`: name ->
    (amplitude (L,), radiance (L, K)); `addition`: name -> (K,); `weakest` (K,): of the least power.
    """

    condition: str
    power: float
    wavelength: np.ndarray
    slit_fwhm: float
    log_power: np.ndarray
    radiance: np.ndarray
    group_name: tuple
    group: np.ndarray
    variation: dict
    addition: dict
    weakest: np.ndarray

    @cached_property
    def base(self):
        """Spectrum of the condition (K,)."""
        return self.group.sum(axis=0)

    @cached_property
    def _by_power(self):
        return CubicSpline(self.log_power, np.log(self.radiance))

    def power_factor(self, change):
        r"""Spectrum at another power over that of the condition (K,), :math:`\ln P = \ln P_0 +` change."""
        start = np.log(self.power)
        if self.log_power.size < 2:
            return np.exp(change) * np.ones(self.wavelength.size)
        low, high = self.log_power[0] - 0.2, self.log_power[-1] + 0.2
        return np.exp(self._by_power(np.clip(start + change, low, high)) - self._by_power(start))

    def factor(self, name, amplitude):
        """Spectrum with one property varied over the simulated one (K,), smooth in the amplitude."""
        return np.exp(self._splines[name](amplitude))

    @cached_property
    def _splines(self):
        return {
            name: CubicSpline(at, np.log(light / self._at_zero(at, light)))
            for name, (at, light) in self.variation.items()
        }

    @staticmethod
    def _at_zero(amplitude, light):
        return light[np.argmin(np.abs(amplitude))]


def line_groups(wavelength, component, radiance):
    """Split a spectrum into groups of lines whose strengths err independently.

    Parameters
    ----------
    wavelength : (K,) [m]
    component : sequence of names (C,)
    radiance : (C, K) [W m-2 sr-1 m-1]

    Returns
    -------
    names (G,), radiance (G, K), adding up to the whole.

    Notes
    -----
    ASSUME: lines of one atom with less than 1 nm of darkness between them (a multiplet) share an error of
    strength, as do the faint lines of one atom, and the bands of N2 1P of one sequence.
    """
    names, rows = [], []
    whole = radiance.sum()
    rest = np.zeros(wavelength.size)
    for name, light in zip(component, radiance, strict=True):
        if name in ATOMS:
            faint = np.zeros(wavelength.size)
            for first, last in _clusters(wavelength, light):
                inside = (wavelength >= first) & (wavelength < last)
                if light[inside].sum() > SMALL * whole:
                    names.append(
                        f"{name} {1e9 * np.average(wavelength[inside], weights=light[inside]):.0f} nm"
                    )
                    rows.append(np.where(inside, light, 0.0))
                else:
                    faint = faint + np.where(inside, light, 0.0)
            if faint.any():
                names.append(f"faint lines of {name}")
                rows.append(faint)
        elif name == BANDS_OF:
            for first, last in zip(MOLECULAR_EDGES[:-1], MOLECULAR_EDGES[1:], strict=True):
                inside = (wavelength >= first) & (wavelength < last)
                names.append(f"{name} {first * 1e9:.0f}-{last * 1e9:.0f} nm")
                rows.append(np.where(inside, light, 0.0))
        elif light.sum() > SMALL * whole:
            names.append(name)
            rows.append(light)
        else:
            rest = rest + light
    return (*names, "other"), np.array([*rows, rest])


def _clusters(wavelength, light):
    """Edges (first, last) of stretches of a spectrum, cut in the widest dark gaps between its lines."""
    bright = np.flatnonzero(light > 2e-3 * light.max())
    gaps = np.flatnonzero(np.diff(wavelength[bright]) > ATOMIC_GAP)
    cuts = [(wavelength[bright[g]] + wavelength[bright[g + 1]]) / 2 for g in gaps]
    edges = [wavelength[0], *cuts, wavelength[-1] * (1 + 1e-9)]
    return list(zip(edges[:-1], edges[1:], strict=True))


def widened(wavelength, radiance, extra_sigma):
    """Convolve spectra (..., K) on equal steps with a Gaussian of some standard deviation [m]."""
    if extra_sigma <= 0:
        return radiance
    frequency = np.fft.rfftfreq(wavelength.size, (wavelength[-1] - wavelength[0]) / (wavelength.size - 1))
    damping = np.exp(-2 * (np.pi * frequency * extra_sigma) ** 2)
    return np.fft.irfft(np.fft.rfft(radiance, axis=-1) * damping, wavelength.size, axis=-1)


def extra_sigma(fwhm, library_fwhm):
    """Standard deviation [m] that widens the slit of the library to another; 0 for a narrower one."""
    return np.sqrt(max(fwhm**2 - library_fwhm**2, 0.0)) / FWHM_PER_SIGMA
