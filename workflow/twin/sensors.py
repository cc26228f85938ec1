"""The pyrometer and the spectrometer: what they make of light, and their noise."""

from dataclasses import dataclass

import numpy as np
import scipy

# Absorption of silicon [m-1] at 300 K for the quantum efficiency of the spectrometer's detector:
# Green & Keevers, Progress in Photovoltaics 3, 189 (1995).
SILICON_WAVELENGTH = np.array([0.70, 0.75, 0.80, 0.85, 0.90, 0.95, 1.00, 1.05, 1.10]) * 1e-6
SILICON_ABSORPTION = np.array([1.90e5, 1.30e5, 8.50e4, 5.35e4, 3.06e4, 1.57e4, 6.40e3, 1.63e3, 3.5e2])


@dataclass(frozen=True)
class Pyrometer:
    narrow_gain: float = 1.0e-8  # [A m2 sr W-1] sensitivity times throughput of the narrow band
    sensitivity_ratio: float = 0.315  # k1/k2
    reading_noise: float = 0.003  # relative, per sample
    floor_noise: float = 5e-11  # [A] per sample

    @property
    def gains(self):
        return np.array([self.sensitivity_ratio, 1.0]) * self.narrow_gain


@dataclass(frozen=True)
class Spectrometer:
    """A back-thinned detector behind a grating: 16 bit, 2068 pixels over 750 to 1030 nm."""

    first: float = 750e-9  # [m]
    last: float = 1030e-9  # [m]
    pixels: int = 2068
    fwhm: float = 0.75e-9  # [m]
    peak_rate: float = 110e3  # [count s-1] in the best pixel before a black body at 1773 K
    depth: float = 18e-6  # [m] of silicon that collects
    offset: float = 2400.0  # [count]
    offset_pattern: float = 25.0  # [count] standard deviation between pixels
    dark_rate: float = 40.0  # [count s-1]
    read_noise: float = 25.0  # [count]
    electrons_per_count: float = 3.0
    full_scale: int = 65535

    @property
    def wavelength(self):
        return np.linspace(self.first, self.last, self.pixels)

    @property
    def efficiency(self):
        """Relative response per radiance: silicon, times a grating blazed at 0.8 um."""
        wavelength = self.wavelength
        smooth = scipy.interpolate.CubicSpline(SILICON_WAVELENGTH, np.log(SILICON_ABSORPTION))
        absorption = np.exp(smooth(wavelength))
        blaze = np.sinc(0.55 * (1 - 0.8e-6 / wavelength)) ** 2
        return wavelength * -np.expm1(-absorption * self.depth) * blaze

    def rate_per_radiance(self, planck):
        """Count rate per spectral radiance (W,) [count s-1 / (W m-2 sr-1 m-1)]."""
        before_source = self.efficiency * planck(self.wavelength, 1773.0)
        return self.efficiency * self.peak_rate / before_source.max()


def pyrometer_reading(pyrometer, clean, random, draw=None):
    """Noisy signals (..., t) [A] from clean ones; `draw` replaces the normal distribution."""
    shape = (2, *clean.shape)
    noise = random.standard_normal(shape) if draw is None else draw(random, shape, -1)
    return clean * (1 + pyrometer.reading_noise * noise[0]) + pyrometer.floor_noise * noise[1]


def offset_pattern(spectrometer, random):
    """Electronic offset of each pixel (W,) [count]."""
    return spectrometer.offset + spectrometer.offset_pattern * random.standard_normal(spectrometer.pixels)


def counts_variance(spectrometer, rate, integration_time):
    """Variance (..., W) [count2] of the counts of one exposure: shot noise, read noise, rounding."""
    collected = np.maximum((rate + spectrometer.dark_rate) * integration_time, 0.0)
    return collected / spectrometer.electrons_per_count + spectrometer.read_noise**2 + 1 / 12


def counts(spectrometer, rate, integration_time, pattern, random, draw=None):
    """Raw counts (..., W) of one exposure each: shot noise, read noise, 16 bit, clipped.

    With `draw` the sum of both noises has that distribution instead of Poisson's and Gauss's.
    """
    light = rate * integration_time
    dark = spectrometer.dark_rate * integration_time
    if draw is None:
        electrons = random.poisson((light + dark) * spectrometer.electrons_per_count)
        raw = pattern + electrons / spectrometer.electrons_per_count
        raw = raw + spectrometer.read_noise * random.standard_normal(raw.shape)
    else:
        size = np.sqrt(counts_variance(spectrometer, rate, integration_time))
        raw = pattern + light + dark + size * draw(random, np.shape(size), 0)
    return np.clip(np.rint(raw), 0, spectrometer.full_scale)
