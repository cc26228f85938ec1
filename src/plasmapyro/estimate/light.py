"""Light of a surface in channels without that of the gas in the reference window: of spectra, or of bands."""

from typing import NamedTuple

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.estimate.emissivity import Channels
from plasmapyro.instrument.spectrometer import local_noise
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import flags
from plasmapyro.record.emittance import ANY_LEVEL
from plasmapyro.record.inputs import SHORTER

LINES = 0.01  # [1] ASSUME: of the gas in a channel, beyond its common change: its lines do not keep in step
BASELINE = 0.15  # ASSUME: of a pixel's noise: how far the baseline of a frame is off that of the dark
GAS_MEMORY = 20.0  # [s] over which the common change of the gas persists
UNIFORM = 3**-0.5  # over its mean: of gas that a display shows nothing of, from none to the least it shows
NO_LEVEL = 300.0  # of the logarithm of a level that each sample has anew: many samples must not add up to one
LEAST_BINS = 3
LEAST_SERIES = 5  # samples that tell their noise


class Light(NamedTuple):
    """What C channels saw in S samples, and what may be wrong with it.

    `basis` (B, K): relative errors of all channels together, as shapes over wavelength; `rough` (B, R): the
    same, but taken as noise where samples are looked at one by one, of size `independent` (C,). `linear`
    (S, C, M): light of unit coefficients that persist over `memory` (M,) [s]; `gains` (C, G): of those that
    last, over the light of the surface.
    """

    frames: object  # record.Instrument
    channels: Channels
    middle: np.ndarray  # (C,) [m]
    seen: np.ndarray  # (S, C)
    behind: np.ndarray  # (S, C) of the gas
    noise: np.ndarray  # (S, C)
    offset: np.ndarray  # (S, C) light that all channels may see without a surface, standard
    flag: np.ndarray  # (S, any)
    independent: np.ndarray
    basis: np.ndarray
    kept: float  # [s] how long the errors of `basis` last
    rough: np.ndarray
    linear: np.ndarray
    memory: tuple
    gains: np.ndarray


class Bins(NamedTuple):
    """Neighbouring pixels that are averaged."""

    pixel: np.ndarray  # (P,) indices of the usable pixels, rising
    first: np.ndarray  # (C,) where each bin begins among them
    weight: np.ndarray  # (C, P)

    def mean(self, values):
        """Means (..., C) of (..., P); NaN where a pixel of the bin is."""
        return np.add.reduceat(values, self.first, axis=-1) * self.weight.max(axis=1)


def of_spectra(record, calibration, settings):
    """`Light` of the spectra of a record, pixels averaged in bins.

    `settings`: `bin_width`, `bin_uncertainty`, `gas_variation`, `stray_light`, `noise_block` as in
    `estimate_emissivity`.
    """
    frames = record.instrument("spectrometer")
    bins = _bins(frames, settings["bin_width"])
    radiance, shining = frames.sound[:, bins.pixel], record.phases(frames.time)[1]
    behind = shining[:, None] * _gas(record, frames)[bins.pixel]
    noise = local_noise(radiance - behind, settings["noise_block"])
    if frames.factor_uncertainty is not None:
        noise = np.hypot(noise, radiance * frames.factor_uncertainty[bins.pixel])
    count = 1 / bins.weight.max(axis=1)
    seen, behind, noise = bins.mean(radiance - behind), bins.mean(behind), bins.mean(noise**2) / count
    wavelength = frames.wavelength[bins.pixel]
    even = _even_light(frames, bins, settings["stray_light"], settings["noise_block"])
    return Light(
        frames,
        Channels(wavelength, bins.weight),
        bins.mean(wavelength),
        seen,
        behind,
        np.sqrt(noise + (LINES * behind) ** 2),
        even,
        frames.flag[:, bins.pixel],
        np.full(seen.shape[1], settings["bin_uncertainty"]),
        np.zeros((wavelength.size, 0))
        if calibration is None
        else _of_calibration(frames, bins, calibration, settings["stray_light"]),
        np.inf,
        settings["bin_uncertainty"] * (bins.weight.T > 0),
        np.stack([settings["gas_variation"] * behind, even], axis=-1),
        (GAS_MEMORY, 0.0),
        np.zeros((seen.shape[1], 0)),
    )


def of_bands(record, calibration, settings):
    """`Light` of the bands of a radiometer; settings as in `of_spectra`, of which it needs two."""
    frames = record.instrument("radiometer")
    bands = calibration.sel(band=list(frames.band))
    wavelength, curves = bands.wavelength.values, bands.responsivity.values
    used = (curves > 0).any(axis=0)
    weight = (curves * _trapezoid(wavelength))[:, used] * bands.band_sensitivity.values[:, None]
    weight, wavelength = weight * frames.window_transmittance, wavelength[used]
    middle = weight @ wavelength / weight.sum(axis=1)
    ratio = calibration.attrs["calibration"] == "readings" and len(frames.band) == 2
    if ratio and record.window:
        raise ValueError(
            "a displayed ratio tells no level, so light of the gas cannot be taken out of it: `plasmapyro"
            " correct-reading` does that with the gas of a computed condition"
        )
    signal, shining = frames.sound, record.phases(frames.time)[1]
    gas, variation = _gas(record, frames), settings["gas_variation"]
    if calibration.attrs["calibration"] == "readings" and np.isnan(gas).all() and shining.any():
        gas, variation = np.nanmin(signal[shining], axis=0) / 2, UNIFORM
    behind = shining[:, None] * gas
    seen, own = signal - behind, float(calibration.attrs["signal_uncertainty"])
    noise = local_noise(signal.T, settings["noise_block"]).T if len(signal) >= LEAST_SERIES else 0.0
    noise = np.sqrt(np.nan_to_num(noise) ** 2 + (own * signal) ** 2 + (LINES * behind) ** 2)
    sensitivity = bands.band_sensitivity_uncertainty.values
    source = float(bands.source_temperature_uncertainty) * SECOND_RADIATION
    source = source / (middle * bands.band_source_temperature.values**2)
    gains = np.column_stack([np.diag(sensitivity), source])
    free = ratio or calibration.attrs["calibration"] == "relative"
    return Light(
        frames,
        Channels(wavelength, weight),
        middle,
        seen,
        behind,
        noise,
        np.zeros_like(noise),
        frames.flag,
        np.hypot(sensitivity, source),
        np.full((wavelength.size, int(free)), NO_LEVEL if ratio else ANY_LEVEL),
        0.0 if ratio else np.inf,  # a displayed ratio says nothing of a level at any time
        np.zeros((wavelength.size, 0)),
        variation * behind[:, :, None],
        (GAS_MEMORY,),
        gains,
    )


def _trapezoid(nodes):
    """Weights (B,) with which values at nodes (B,) are integrated."""
    steps = np.diff(nodes)
    return (np.append(steps, 0.0) + np.append(0.0, steps)) / 2


def _bins(frames, width):
    pixel = np.flatnonzero(np.isfinite(frames.value).any(axis=0) & (frames.flag == 0).any(axis=0))
    full = np.flatnonzero((frames.flag & flags.SATURATED > 0).all(axis=0)).size
    why = f"; {full} pixels are saturated in all spectra: {SHORTER}" if full else ""
    if not pixel.size:
        raise ValueError(f"the spectra hold no usable pixel{why}")
    place = ((frames.wavelength[pixel] - frames.wavelength[pixel[0]]) / width).astype(int)
    names, first, count = np.unique(place, return_index=True, return_counts=True)
    if names.size < LEAST_BINS:
        raise ValueError(
            f"the usable pixels fill {names.size} bins of {width * 1e9:g} nm; temperature and emissivity need"
            f" {LEAST_BINS}{why}"
        )
    weight = (place == names[:, None]) / count[:, None]
    return Bins(pixel, first, weight)


def _gas(record, frames):
    """Mean light (C,) of the gas in the reference window; 0 without a plasma."""
    if not record.window:
        return np.zeros(frames.value.shape[1])
    half = frames.integration_time / 2
    inside = (frames.time - half >= record.window[0]) & (frames.time + half <= record.window[1])
    if not inside.any():
        begin, end = record.clock(np.array(record.window))
        raise ValueError(f"no sample lies inside the reference window {begin:g} to {end:g} s")
    sound = frames.sound[inside]
    number = np.isfinite(sound).sum(axis=0)
    return np.where(number > 0, np.nansum(sound, axis=0) / np.maximum(number, 1), np.nan)


def _even_light(frames, bins, stray_light, noise_block):
    """Light (S, C) of the same count in every pixel: stray light, and a baseline off that of the dark."""
    factor = np.ones(bins.pixel.size) if frames.factor is None else frames.factor[bins.pixel]
    counts = frames.sound[:, bins.pixel] / factor
    level = np.nansum(counts, axis=1) / np.maximum(np.isfinite(counts).sum(axis=1), 1)
    if frames.factor is None:
        return stray_light * level[:, None] * bins.mean(factor)
    drift = BASELINE * np.nanmedian(local_noise(counts, noise_block), axis=1)
    return np.hypot(stray_light * level, drift)[:, None] * bins.mean(factor)


def _of_calibration(frames, bins, calibration, stray_light):
    r"""Relative errors (P, 1 or 2) of all spectra alike: source temperature, stray light of its counts.

    .. math:: dL/L = (c_2/\lambda T)\,dT/T, \qquad dL/L = z\,\bar r / r_\lambda
    """
    kelvin, error = (
        float(calibration[f"source_temperature{one}"].values.mean()) for one in ("", "_uncertainty")
    )
    wavelength = frames.wavelength[bins.pixel]
    found = [SECOND_RADIATION * error / (wavelength * kelvin**2)]
    if frames.factor is not None:
        rate = blackbody_radiance(wavelength, kelvin) / frames.factor[bins.pixel]
        found.append(stray_light * rate.mean() / (bins.mean(rate) @ (bins.weight > 0)))
    return np.column_stack(found)
