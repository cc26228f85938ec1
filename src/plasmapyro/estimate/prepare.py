"""From the files of a test to what the estimate works with: samples, noise, bins, first guesses."""

import dataclasses

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.estimate.bins import pixel_bins
from plasmapyro.estimate.dynamics import GAS, RATE, SIZE, TEMPERATURE
from plasmapyro.estimate.instrument import BANDS, GreyTable, bin_pixels, pyrometer, spectrometer
from plasmapyro.estimate.observations import PyrometerData, SpectrometerData, constants
from plasmapyro.estimate.response import LINEARITY, SHIFT, of_course, of_linearity, of_place
from plasmapyro.instrument.scale import scale_modes
from plasmapyro.instrument.spectrometer import NORMAL_MAD, local_noise
from plasmapyro.instrument.wander import MEMORY, WANDER, wandering
from plasmapyro.record import noise
from plasmapyro.record.binning import finite_mean, groups
from plasmapyro.record.emittance import PIVOT, relative_emittance
from plasmapyro.record.rounding import rounding

MOST_SAMPLES = 12000  # of the chain; a longer record is averaged over groups of samples
NOISE_BLOCK = 50  # samples per noise estimate of the pyrometer
LEAST_SAMPLES = {"pyrometer": 4 * NOISE_BLOCK, "radiometer": 60}  # in which the noise is seen
LEAST_NOISE = 1e-6  # of the usual noise: no sample is exact
WIDE_PRIOR = 3.0  # [1] a gas level is known to this many times its first guess: left to the data
NOTHING = 1e-6  # [1] or [K] stands for a standard deviation of zero
RAMPS = 6  # of the scale of an instrument against the bands, through a test
SHORTEST = 1.0  # [s] of a record, for what wanders in it
DRIFT = 0.02  # [1] ASSUME standard deviation of them at its end: deposits on one of two windows, fibres
BESIDE, BESIDE_STEPS = 0.5, 1.5  # [s], usual steps between samples: farther from all of them lies a gap
# ASSUME: a beam that moves dims all light of an exposure; what the data do not tell, and the least.
JITTER, LEAST_JITTER = 1e-3, 1e-4  # [1]
LEAST_BENDS = 12  # third differences that tell it
FINE, STEADY = 0.01, 0.05  # [1] noise of all light of a spectrum, and by what the next one differs, at most
RESCALING = (0.2, 20.0)  # by how much residuals may correct the noise


@dataclasses.dataclass(frozen=True)
class Samples:
    """Signals of the C bands of the instrument that makes the time axis of the chain."""

    time: np.ndarray  # (n,) [s]
    signal: np.ndarray  # (C, n), NaN where not to be used
    noise: np.ndarray  # (C, n)
    injected: np.ndarray  # (n,) bool
    shining: np.ndarray  # (n,) bool, gas in view
    group: np.ndarray  # (t,) which of the n each sample of the test belongs to
    flicker: float  # [1] NaN if the bands do not tell
    flicker_time: float  # [s]


def leading(record):
    """The instrument of bands that makes the time axis of the chain: the pyrometer, else a radiometer."""
    return record.instrument("pyrometer") or record.instrument("radiometer")


def samples_of(record, spans, least=None, most=MOST_SAMPLES):
    """`Samples` of a test with their noise, without those while the probe moves in or the plasma dies.

    Parameters
    ----------
    record : Record, with the pyrometer or a radiometer
    spans : (2,) floats [s], left out before injection and after the end of the plasma
    least : int
        Of each band, in which the noise is seen; `LEAST_SAMPLES` of the instrument if None.
    most : int
        A longer record is averaged over groups of neighbours, which never straddle a switch.
    """
    bands = leading(record)
    time, off = bands.time, record.off
    moving = ((time >= -spans[0]) & (time < 0)) | ((time > off) & (time <= off + spans[1]))
    signal = np.where(moving, np.nan, bands.sound.T)
    least = least or LEAST_SAMPLES[bands.name]
    for band, row in zip(bands.band, signal, strict=True):
        if np.isfinite(row).sum() < least:
            raise ValueError(
                f"signal_{band} must hold {least} samples outside the switches for the joint"
                f" estimate; got {np.isfinite(row).sum()}"
            )
    floor, relative = noise.signal_noise(signal, min(NOISE_BLOCK, time.size // 4))
    level = np.stack([noise.smoothed(row, 3) for row in signal])  # of a steep rise, each its own
    spread = np.hypot(floor[:, None], relative[:, None] * level)
    spread = np.maximum(spread, np.median(spread, axis=1, keepdims=True) * LEAST_NOISE)
    low, high = record.window
    windows = [time < -spans[0], (time >= low) & (time <= high)]
    deviation, correlation = noise.flicker(time, signal, windows)
    group = groups(time, (0.0, off), most)
    count = np.bincount(group)
    middle = np.bincount(group, time) / count
    good = np.isfinite(signal)
    valid = np.stack([np.bincount(group, row) for row in good.astype(float)])
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.stack([np.bincount(group, row) for row in np.where(good, signal, 0.0)]) / valid
        square = np.stack([np.bincount(group, row) for row in np.where(good, spread**2, 0.0)]) / valid
        square /= valid
        square += [rounding(row).variance(*one) for row, *one in zip(signal, mean, valid, strict=True)]
        own = np.where(valid > 0, np.sqrt(square), 1.0)
    if count.max() > 1 and np.isfinite(deviation):
        deviation = mean_flicker(deviation, correlation, float(np.median(np.diff(middle))))
    injected, _ = record.phases(middle)
    return Samples(middle, mean, own, injected, middle <= off, group, deviation, correlation)


def pyrometer_data(samples, response, calibration, gas, slope=0.0, course=None):
    """What the pyrometer contributes to the estimate; `gas` (2,) [A]: a first guess of its light, `slope`
    [m-1] as from `record.emittance.tilt`.

    `course`: `radiometer.Course` of the emissivity, where other bands tell it.
    """
    moved = response.assign_coords(wavelength=response.wavelength + SHIFT)
    black = [pyrometer(own, calibration) for own in (response, moved)]
    seen = black
    if slope or course is not None:
        seen = [lit(own, slope, course and course.relative) for own in black]
    points = calibration.source_temperature.values
    value, by_temperature, _ = GreyTable(black[0])(points)
    points = np.stack([points] * len(black[0].weight), axis=1)
    return PyrometerData(
        samples.signal,
        samples.noise,
        samples.injected,
        samples.shining,
        GreyTable(seen[0]),
        (by_temperature / value).mean(axis=0),
        {
            "band_shift": of_place(seen, black, points),
            "band_course": of_course(seen[0], black[0], points),
            "band_linearity": of_linearity(seen[0], black[0], points),
        },
        gas,
        shape=None if course is None else course.of_bands(black[0]),
        parting=parting(samples.time),
    )


def parting(time):
    """Modes (n, K), each times a standard normal number, by which the ratio of two bands wanders."""
    knots, root = wandering(time[0], time[-1] + SHORTEST, MEMORY * (time[-1] - time[0] + SHORTEST))
    return WANDER["ratio"] * np.array([np.interp(time, knots, mode) for mode in root.T]).T


def lit(instrument, slope=0.0, relative=None):
    """An instrument in front of a surface that is not grey: its bins see so much less of a black body.

    `slope` [m-1] as from `record.emittance.tilt`, or `relative`: (wavelengths [m]) -> share of the emittance.
    """
    own = instrument.wavelength
    share = relative_emittance(own, slope) if relative is None else relative(own)
    return dataclasses.replace(instrument, weight=instrument.weight * share)


def mean_flicker(deviation, correlation, exposure):
    """Standard deviation of the mean over an exposure of an Ornstein-Uhlenbeck flicker."""
    x = exposure / correlation
    return deviation * np.sqrt(2 / x * (1 + np.expm1(-x) / x))


def gain_uncertainties(calibration, source_slope):
    """Error of the source [K] and own relative errors of the gains (2,), taken apart from their sum.

    The calibration states the sum u2 = u_S2 / N + g2 u_T2 of each gain, with u_S and N in the file.
    """
    total = (
        (calibration.absolute_sensitivity_uncertainty / calibration.absolute_sensitivity)
        .sel(band=list(BANDS))
        .values
    )
    own = calibration.attrs["signal_uncertainty"] / np.sqrt(calibration.sizes["calibration_point"])
    source = np.sqrt(np.maximum(total**2 - own**2, 0.0)) / source_slope
    return float(source.mean()), np.full(2, own)


def pyrometer_constants(record, data, calibration, gas, gas_change, band_shift_uncertainty):
    """Prior of what does not change, as far as the pyrometer sees it; `gas` (2,) [A] is a first guess."""
    source, own = gain_uncertainties(calibration, data.source_slope)
    own = np.hypot(own, record.emittance_slope_uncertainty / np.sqrt(2))  # between the bands, half in each
    fixed = band_constants(record, source, own, gas, gas_change, band_shift_uncertainty)
    fixed = fixed + constants("band_course", np.zeros(data.errors["band_course"].number), 1.0)
    fixed = fixed + constants("band_linearity", np.zeros(len(gas)), LINEARITY)
    return fixed + constants("ratio_wander", np.zeros(data.parting.shape[1]), 1.0)


def band_constants(record, source, own, gas, gas_change, band_shift_uncertainty):
    """Prior of what does not change of C bands: error of the `source` [K], `own` (C,) of their gains [1]."""
    emittance, none = record.emittance, np.zeros(len(gas))
    spread = max(record.emittance_uncertainty / emittance, NOTHING)
    return (
        constants("log_emittance", np.log(emittance), spread)
        + constants("source_error", 0.0, max(source, NOTHING))
        + constants("gain_error", none, np.maximum(own, NOTHING))
        + constants("gas_signal", gas, WIDE_PRIOR * gas)
        + constants("gas_signal_before", none, max(gas_change, NOTHING))
        + constants("band_shift", none, max(band_shift_uncertainty, NOTHING * SHIFT))
    )


def first_gas(record, samples):
    """Gas signal (C,) to start from: the median of the reference window.

    ValueError if it holds no sample of a band between injection and the end of the plasma.
    """
    low, high = record.window
    inside = (samples.time >= low) & (samples.time <= high) & samples.injected & samples.shining
    if not np.isfinite(samples.signal[:, inside]).any(axis=1).all():
        low, high = record.clock(low), record.clock(high)
        raise ValueError(
            f"the reference window {low:g} to {high:g} s holds no sample of"
            f" {'both' if len(samples.signal) == 2 else 'all'} bands after injection"
        )
    least = np.median(samples.noise[:, inside], axis=1)
    return np.maximum(np.nanmedian(samples.signal[:, inside], axis=1), least)


def first_path(samples, data, gas, emittance, initial_temperature):
    """Path (n, 4) to start from: the band of the longest waves less its gas, read as a grey surface."""
    one = data.longest
    time, signal = samples.time, noise.smoothed(samples.signal[one], 31)
    surface = signal - np.where(data.shining, gas[one], 0.0)
    clear = data.injected & (surface > np.where(data.shining, 0.3 * gas[one], 10 * data.noise[one]))
    inverse = np.linspace(1 / 3900.0, 1 / 250.0, 500)
    curve = np.log(emittance * data.table(1 / inverse)[0][:, one])
    guess = 1 / np.interp(np.log(surface[clear]), curve[::-1], inverse[::-1])
    axis, values = np.append(0.0, time[clear]), np.append(initial_temperature, guess)
    path = np.zeros((time.size, SIZE))
    path[:, TEMPERATURE] = np.where(data.injected, np.interp(time, axis, values), initial_temperature)
    path[:, RATE] = np.where(data.injected, np.gradient(path[:, TEMPERATURE], time), 0.0)
    before = samples.signal[0, ~data.injected]
    before = before[np.isfinite(before)]
    if before.size and np.median(before) > 0:
        path[~data.injected, GAS] = np.median(before) / gas[0] - 1
    return path


def spectrometer_data(
    record,
    frames,
    time,
    source_temperature,
    flicker,
    noise_block,
    spans,
    slope=(0.0, 0.0),
    shared=True,
    **course,
):
    """What the spectrometer contributes: means of the bins; None if no exposure is of use.

    Exposures during which the probe moves in or the plasma starts or ends are left out. `slope`: `tilt` of
    the emittance and its standard uncertainty [m-1], which joins the course of the scale. `shared`: its
    source is that of the pyrometer. `course`: `relative` and `basis` of a `radiometer.Course`.
    """
    pixels, radiance, instrument = frames.wavelength, frames.sound, spectrometer(frames.wavelength)
    usable = np.isfinite(radiance)
    own = local_noise(radiance, noise_block)
    mean, count = bin_pixels(pixels, radiance, usable, instrument.edges)
    square, _ = bin_pixels(pixels, own**2, usable & np.isfinite(own), instrument.edges)
    spread = np.sqrt(square / np.maximum(count, 1))
    mean[~apart(frames, time, record.off, spans)] = np.nan
    mean[~(spread > 0)] = np.nan
    good = np.isfinite(mean).any(axis=0)
    if not good.any():
        return None
    own = _of_pixels(instrument, pixels, usable.any(axis=0), good)
    scale = scale_modes(instrument.wavelength[good])
    if slope[1]:
        scale = np.column_stack([scale, slope[1] * (instrument.wavelength[good] - PIVOT)])
    return SpectrometerData(
        *placed(frames, time),
        mean[:, good],
        np.where(np.isfinite(mean), spread, 1.0)[:, good],
        frames.time >= 0,
        frames.time <= record.off,
        GreyTable(lit(own, slope[0], course.get("relative"))),
        (SECOND_RADIATION / instrument.wavelength / source_temperature**2)[good],
        flicker,
        source="source_error" if shared else "spectrometer_source_error",
        shape=course["basis"](instrument.wavelength[good]) if course else None,
        drift=ramps(frames.time),
        scale=scale,
        jitter=jitter(mean[:, good], spread[:, good]),
    )


def jitter(radiance, spread):
    """Relative standard deviation of all light of an exposure, by third differences of spectra (S, C) while
    they hardly change, less the `spread` of their bins."""
    good = np.isfinite(radiance) & (spread > 0)
    weight = np.where(good, np.abs(np.nan_to_num(radiance)) / np.where(good, spread, 1.0) ** 2, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        weight = np.median(weight, axis=0)
        light = np.where(good, radiance, 0.0) @ weight
        own = np.sqrt(np.where(good, spread, 0.0) ** 2 @ weight**2) / light
        change = np.diff(np.log(np.where(light > 0, light, np.nan)))
    bend = np.diff(change, 2)
    most = np.abs(np.stack([change[:-2], change[1:-1], change[2:]])).max(axis=0)
    told = (most < STEADY) & (own[:-3] < FINE)
    if told.sum() < LEAST_BENDS:
        return JITTER
    found = noise.variance(bend[told]) / noise.THIRD_DIFFERENCES - np.median(own[:-3][told] ** 2)
    return max(np.sqrt(max(found, 0.0)), LEAST_JITTER)


def ramps(time):
    """Ramps (S, K) from 0 to 1, one after the other from the injection to the last of the times (S,)."""
    ends = np.linspace(0.0, max(time[-1], 1.0), RAMPS + 1)
    return np.clip((time[:, None] - ends[:-1]) / np.diff(ends), 0.0, 1.0)


def apart(frames, time, off, spans):
    """Exposures (S,) beside a sample of the chain during which nothing moves, starts or ends.

    In a gap of the samples the path has no state that an exposure could see.
    """
    middle, half = frames.time, frames.integration_time / 2
    still = (
        ((middle - half >= 0) & (middle + half <= off))
        | (middle + half <= -spans[0])
        | (middle - half >= off + spans[1])
    )
    beside = np.abs(placed(frames, time)[1]) <= max(BESIDE, BESIDE_STEPS * float(np.median(np.diff(time))))
    return (middle >= time[0]) & (middle <= time[-1]) & still & beside


def placed(frames, time):
    """Sample nearest to the middle of each exposure (S,), the rest of the time (S,) [s], exposure [s]."""
    middle = frames.time
    place = np.clip(np.searchsorted(time, middle), 1, time.size - 1)
    place = place - (middle - time[place - 1] < time[place] - middle)
    return place, middle - time[place], frames.integration_time


def _of_pixels(instrument, pixels, usable, good):
    """The spectrometer with its pixels as bins: Planck's law is then averaged as the data are."""
    step = (pixels[1:] + pixels[:-1]) / 2
    edges = np.concatenate([[2 * pixels[0] - step[0]], step, [2 * pixels[-1] - step[-1]]])
    belongs = pixel_bins(pixels, instrument.edges) == np.arange(instrument.edges.size - 1)[:, None]
    weight = (belongs & usable).astype(float)
    return dataclasses.replace(
        instrument, edges=edges, weight=(weight / np.maximum(weight.sum(axis=1, keepdims=True), 1))[good]
    )


def spectrometer_constants(data, scale_uncertainty, bin_uncertainty, gas_change):
    """Constants of an instrument on its own clock, of scale and channels (`bin_uncertainty`: one or C).

    The light of the gas starts from the exposures with the coldest surface.
    """
    injected = np.flatnonzero(data.injected & data.shining & np.isfinite(data.radiance).any(axis=1))
    before = np.flatnonzero(~data.injected & np.isfinite(data.radiance).any(axis=1))
    early = injected[:2] if injected.size else before
    gas = finite_mean(data.radiance[early])
    floor = np.median(data.noise, axis=0)
    gas = np.where(np.isfinite(gas), gas, floor)
    gas = np.where(np.abs(gas) > floor, gas, floor)
    none, tag = np.zeros(gas.size), data.tag
    found = (
        constants(f"{tag}scale_error", 0.0, max(scale_uncertainty, NOTHING))
        + constants(f"{tag}scale_drift", np.zeros(data.drift.shape[1]), DRIFT / np.sqrt(RAMPS))
        + constants(f"{tag}bin_error", none, np.maximum(bin_uncertainty, NOTHING))
        + constants(f"{tag}gas_radiance", gas, WIDE_PRIOR * np.abs(gas))
        + constants(f"{tag}gas_radiance_before", none, max(gas_change, NOTHING))
    )
    return found if data.scale is None else found + constants("scale_course", 0 * data.scale[0], 1.0)


def rescaled(data, found, fixed):
    """Data whose noise, in each band or bin, is that of their residuals."""
    residual = data.residual(found.path, found.values, fixed.where)
    if isinstance(data, PyrometerData):
        scale = noise.standing_together(residual)[:, None]
    else:
        scale = NORMAL_MAD * np.nanmedian(np.abs(residual), axis=0, keepdims=True)
    return dataclasses.replace(data, noise=data.noise * np.clip(scale, *RESCALING))


def bent(data, chain, path):
    """Data whose exposures see the path between its samples; samples of bands are instants."""
    return data.bent(chain.time, path, chain.switches) if hasattr(data, "bent") else data
