"""A radiometer of any bands in the joint estimate, and the emissivity over wavelength that it tells."""

from typing import NamedTuple

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.estimate import prepare
from plasmapyro.estimate.emissivity import smooth_prior
from plasmapyro.estimate.instrument import GreyTable, radiometer
from plasmapyro.estimate.observations import PyrometerData, SpectrometerData, constants
from plasmapyro.estimate.response import SHIFT, of_place
from plasmapyro.instrument.spectrometer import local_noise
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record.emittance import ANY_LEVEL, HOT, mean_emittance

GRID = 10e-9  # [m] on which shapes of the emissivity are held
EXACT = 1e-6  # [1] of the course of an emissivity that is stated where the only band lies
TAG = "radiometer_"


class Course(NamedTuple):
    """Emissivity over wavelength: what is stated, over its level, and K shapes (N, K) it may differ by."""

    attributes: dict
    emittance: float
    grid: np.ndarray
    shapes: np.ndarray

    def relative(self, wavelength):
        """Stated emissivity (N,) at wavelengths (N,) [m] over its level."""
        return mean_emittance(self.attributes, wavelength) / self.emittance

    def basis(self, wavelength):
        """Shapes (N, K) at wavelengths (N,) [m]."""
        return np.stack([np.interp(wavelength, self.grid, one) for one in self.shapes.T], axis=1)

    def of_bands(self, instrument):
        """Shapes (C, K) in the bands of an instrument: means over the light of a hot surface."""
        weight = instrument.weight * blackbody_radiance(instrument.wavelength, HOT)
        return weight @ self.basis(instrument.wavelength) / weight.sum(axis=1, keepdims=True)


def course_of(record, instruments, shape, length):
    """The `Course` of a record over the wavelengths (N,) [m] of its instruments; see `smooth_prior`."""
    every = np.concatenate(instruments)
    grid = np.arange(every.min(), every.max() + GRID, GRID)
    prior = smooth_prior(grid, 1.0, level=0.0, shape=shape, length=length)
    return Course(record.attributes, record.emittance, grid, prior.basis)


def facts(frames, calibration):
    """Of the bands: errors of the gains (C,) [1], source (C,) and its error [K], whether the level is free.

    ValueError: a displayed ratio, which has no level at any time.
    """
    bands = calibration.sel(band=list(frames.band))
    kind = calibration.attrs["calibration"]
    if kind == "readings" and len(frames.band) == 2:
        raise ValueError(
            "a displayed ratio tells no level: use --estimator emissivity without a plasma, `plasmapyro"
            " correct-reading` behind one"
        )
    return (
        bands.band_sensitivity_uncertainty.values,
        bands.band_source_temperature.values,
        float(bands.source_temperature_uncertainty),
        kind == "relative",
    )


def leading_data(samples, frames, calibration, gas, course):
    """What the bands of a radiometer contribute that makes the time axis."""
    _, kelvin, _, _ = facts(frames, calibration)
    moved = calibration.assign_coords(wavelength=calibration.wavelength + SHIFT)
    black = [radiometer(one, frames) for one in (calibration, moved)]
    seen = [prepare.lit(one, relative=course.relative) for one in black]
    table = GreyTable(black[0])
    points = np.clip(kelvin, *table.temperatures)
    value, by_temperature, _ = (np.diagonal(one) for one in table(points))
    middle = black[0].weight @ black[0].wavelength / black[0].weight.sum(axis=1)
    return PyrometerData(
        samples.signal,
        samples.noise,
        samples.injected,
        samples.shining,
        GreyTable(seen[0]),
        by_temperature / value,
        {"band_shift": of_place(seen, black, points[None])},
        gas,
        name="radiometer",
        shape=course.of_bands(black[0]),
        longest=int(np.argmax(middle)),
    )


def leading_constants(record, calibration, gas, gas_change, band_shift_uncertainty):
    """Prior of what does not change, as far as the bands of the radiometer see it."""
    own, _, source, free = facts(record.instrument("radiometer"), calibration)
    fixed = prepare.band_constants(record, source, own, gas, gas_change, band_shift_uncertainty)
    return fixed + constants("band_level", np.zeros(int(free)), ANY_LEVEL)


def beside_data(record, calibration, time, flicker, noise_block, spans, course):
    """What a radiometer contributes on its own clock, beside the instrument that makes the time axis."""
    frames = record.instrument("radiometer")
    _, kelvin, _, _ = facts(frames, calibration)
    own = radiometer(calibration, frames)
    signal = frames.sound
    noise = np.nan_to_num(local_noise(signal.T, noise_block).T)
    signal[~prepare.apart(frames, time, record.off, spans) | ~(noise > 0).all(axis=1)] = np.nan
    middle = own.weight @ own.wavelength / own.weight.sum(axis=1)
    return SpectrometerData(
        *prepare.placed(frames, time),
        signal,
        np.where(np.isfinite(signal), noise, 1.0),
        frames.time >= 0,
        frames.time <= record.off,
        GreyTable(prepare.lit(own, relative=course.relative)),
        SECOND_RADIATION / middle / kelvin**2,
        flicker,
        name="radiometer",
        tag=TAG,
        source=f"{TAG}source_error",
        shape=course.of_bands(own),
        drift=prepare.ramps(frames.time),
        jitter=prepare.jitter(signal, noise),
    )


def beside_constants(data, frames, calibration, scale_uncertainty, gas_change):
    """Prior of what does not change of a radiometer beside another instrument."""
    own, _, source, free = facts(frames, calibration)
    scale = ANY_LEVEL if free else scale_uncertainty
    fixed = prepare.spectrometer_constants(data, scale, own, gas_change)
    return fixed + constants(f"{TAG}source_error", 0.0, max(source, prepare.NOTHING))
