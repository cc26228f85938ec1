"""Stage: temperature and smooth emissivity of a surface from spectra alone, with or without a plasma."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.estimate.emissivity import Channels, follow, infer, log_emissivity, smooth_prior
from plasmapyro.instrument.spectrometer import local_noise
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import budget, flags, status
from plasmapyro.record.attributes import carried
from plasmapyro.record.emittance import mean_emittance
from plasmapyro.record.record import record_of

NORMAL_95 = 1.959964  # standard deviations of half a 95 % interval
UNTOLD = 0.1  # [1] of the level of the emissivity, where a test states no uncertainty
LINES = 0.01  # [1] ASSUME: of the gas in a bin, beyond its common change: its lines do not keep in step
GAS_MEMORY = 20.0  # [s] over which the common change of the gas persists
MISFIT = 3.0  # rms of the residuals in standard deviations, beyond which this is not light of a hot surface
LARGEST = 0.1  # [1] relative standard uncertainty of the temperature, beyond which there is none
LEAST_BINS = 3


class Bins(NamedTuple):
    """Neighbouring pixels that are averaged."""

    pixel: np.ndarray  # (P,) indices of the usable pixels, rising
    first: np.ndarray  # (C,) where each bin begins among them
    weight: np.ndarray  # (C, P)

    def mean(self, values):
        """Means (..., C) of (..., P); NaN where a pixel of the bin is."""
        return np.add.reduceat(values, self.first, axis=-1) * self.weight.max(axis=1)


def estimate_emissivity(
    test,
    calibration,
    *,
    level,
    shape,
    length,
    memory,
    stray_light,
    bin_width,
    bin_uncertainty,
    gas_variation,
    least_signal_to_noise,
    least_surface_share,
    saturation_counts,
    noise_block,
):
    """Temperature and emissivity over wavelength and time from the spectra of a test, the gas removed.

    Parameters
    ----------
    test : Dataset, contract 'test', with spectra
    calibration : Dataset, contract 'spectrometer_calibration', or None if the test holds radiances
    level : float [1], or None
        Relative standard uncertainty of the emissivity as a whole; None: what the test states.
    shape : float [1]
        Of its course over wavelength.
    length, memory : float [m], [s]
        Over which its course and its change in time are smooth.
    stray_light : float [1]
        Share of the mean count rate that may reach every pixel, in the test and in the calibration.
    bin_width : float [m]
        Pixels are averaged over it.
    bin_uncertainty : float [1]
        Of a bin, independent: what is rough in calibration and emissivity.
    gas_variation : float [1]
        Relative standard deviation of the gas radiance about that of the reference window.
    least_signal_to_noise, least_surface_share : float [1]
        Of the clearest bin: below the first a spectrum is dark, below the other the gas dominates.
    saturation_counts : float [count]
    noise_block : int
        Pixels per noise estimate.

    Returns
    -------
    Dataset, contract 'emissivity_estimate'
        Attributes: `contradictions`, what speaks against light of a hot surface; `degenerate`, what the light
        cannot tell.

    Raises
    ------
    ValueError
        Naming every fault of the test, or fewer than three usable bins.
    """
    record = record_of(
        test, {"spectrometer": calibration}, saturation_counts=saturation_counts, needed=["spectrometer"]
    )
    frames = record.instrument("spectrometer")
    injected, shining = record.phases(frames.time)
    bins = _bins(frames, bin_width)
    radiance = frames.sound[:, bins.pixel]
    behind = shining[:, None] * _gas(record, frames)[bins.pixel]
    noise = local_noise(radiance - behind, noise_block)
    if frames.factor_uncertainty is not None:
        noise = np.hypot(noise, radiance * frames.factor_uncertainty[bins.pixel])
    count = 1 / bins.weight.max(axis=1)
    seen, behind, noise = bins.mean(radiance - behind), bins.mean(behind), bins.mean(noise**2) / count
    noise = np.sqrt(noise + (LINES * behind) ** 2)
    wavelength = frames.wavelength[bins.pixel]
    if level is None:
        level = record.emittance_uncertainty / record.emittance or UNTOLD
    mean = mean_emittance(test.attrs, wavelength)
    prior = smooth_prior(wavelength, mean, level=level, shape=shape, length=length)
    smooth = prior.basis.shape[1]
    if calibration is not None:
        common = _of_calibration(frames, bins, calibration, stray_light)
        prior = prior._replace(basis=np.column_stack([prior.basis, common]))
    linear = np.stack([gas_variation * behind, stray_light * _mean_light(frames, bins)], axis=-1)
    state = _status(record, frames, bins, injected)
    with np.errstate(invalid="ignore"):
        clearest = np.nanmax(np.where(np.isfinite(seen), seen / noise, -np.inf), axis=1)
        share = np.nansum(seen, axis=1) / np.nansum(seen + behind, axis=1)
    state[(state == status.VALID) & ~(share >= least_surface_share)] = status.GAS_DOMINATED
    given = np.isin(state, (status.VALID, status.GAS_DOMINATED))
    state[given & ~(clearest >= least_signal_to_noise)] = status.NO_SIGNAL
    channels, used = Channels(wavelength, bins.weight), np.isin(state, (status.VALID, status.GAS_DOMINATED))
    data = np.where(used[:, None], seen, np.nan)
    alone = infer(channels, prior, data, np.hypot(noise, bin_uncertainty * seen), linear)
    misfit = np.sqrt(np.nansum(alone.residual**2, axis=1) / np.maximum(np.isfinite(data).sum(axis=1), 1))
    state[used & ~alone.converged] = status.NO_SIGNAL
    state[used & (misfit > MISFIT)] = status.CONTRADICTED
    # What is not light of a hot surface says nothing about its neighbours; the errors of bins last.
    data[~np.isin(state, (status.VALID, status.GAS_DOMINATED))] = np.nan
    rough = bin_uncertainty * (bins.weight.T > 0)
    whole = prior._replace(basis=np.column_stack([prior.basis, rough]))
    memories = np.full(whole.basis.shape[1] + linear.shape[-1], np.inf)
    memories[:smooth], memories[-2:] = memory, (GAS_MEMORY, 0.0)
    found = follow(channels, whole, frames.time, data, noise, linear, memories)
    lost = np.isfinite(data).any(axis=1) & ~(found.converged & (found.relative_uncertainty < LARGEST))
    state[lost] = status.NO_SIGNAL
    return _dataset(test, record, frames, bins, prior, smooth, found, alone.residual, state)


def _bins(frames, width):
    pixel = np.flatnonzero(np.isfinite(frames.value).any(axis=0) & (frames.flag == 0).any(axis=0))
    if not pixel.size:
        raise ValueError("the spectra hold no usable pixel")
    place = ((frames.wavelength[pixel] - frames.wavelength[pixel[0]]) / width).astype(int)
    names, first, count = np.unique(place, return_index=True, return_counts=True)
    if names.size < LEAST_BINS:
        raise ValueError(
            f"the usable pixels fill {names.size} bins of {width * 1e9:g} nm; temperature and emissivity need"
            f" {LEAST_BINS}"
        )
    weight = (place == names[:, None]) / count[:, None]
    return Bins(pixel, first, weight)


def _gas(record, frames):
    """Mean radiance (W,) of the gas in the reference window; 0 without a plasma."""
    if not record.window:
        return np.zeros(frames.wavelength.size)
    half = frames.integration_time / 2
    inside = (frames.time - half >= record.window[0]) & (frames.time + half <= record.window[1])
    if not inside.any():
        begin, end = record.clock(np.array(record.window))
        raise ValueError(f"no exposure lies inside the reference window {begin:g} to {end:g} s")
    sound = frames.sound[inside]
    number = np.isfinite(sound).sum(axis=0)
    return np.where(number > 0, np.nansum(sound, axis=0) / np.maximum(number, 1), np.nan)


def _mean_light(frames, bins):
    """Light (S, C) that gives every pixel the count of the mean pixel."""
    factor = np.ones(bins.pixel.size) if frames.factor is None else frames.factor[bins.pixel]
    counts = frames.sound[:, bins.pixel] / factor
    level = np.nansum(counts, axis=1) / np.maximum(np.isfinite(counts).sum(axis=1), 1)
    return level[:, None] * bins.mean(factor)


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


def _status(record, frames, bins, injected):
    state = np.full(frames.time.size, status.VALID, dtype="int8")
    chosen = frames.flag[:, bins.pixel]
    state[(chosen & flags.SATURATED > 0).mean(axis=1) > 0.5] = status.SATURATED
    state[(chosen & (flags.LOST | flags.STUCK) > 0).mean(axis=1) > 0.5] = status.MISSING
    state[~injected] = status.NOT_INJECTED
    for moment in (0.0, record.off) if record.window else ():
        state[np.abs(frames.time - moment) < frames.integration_time / 2] = status.STRADDLING
    return state


def _dataset(test, record, frames, bins, prior, smooth, found, residual, state):
    middle = bins.mean(frames.wavelength[bins.pixel])
    known = np.isin(state, (status.VALID, status.GAS_DOMINATED))
    blank = np.where(known, 1.0, np.nan)
    temperature, error = found.temperature * blank, found.relative_uncertainty
    factor = np.exp(NORMAL_95 * error)
    nearest = np.array([np.argmin(np.abs(frames.wavelength[bins.pixel] - one)) for one in middle])
    value, deviation = log_emissivity(found, prior.logarithm[nearest], prior.basis[nearest, :smooth])
    value, spread = np.exp(value) * blank[:, None], np.exp(NORMAL_95 * deviation)
    across = ("spectrum_time", "emissivity_wavelength")
    return xr.Dataset(
        {
            "spectral_temperature": ("spectrum_time", temperature),
            "spectral_temperature_uncertainty": ("spectrum_time", temperature * error),
            "spectral_temperature_interval": (
                ("bound", "spectrum_time"),
                np.stack([temperature / factor, temperature * factor]),
            ),
            "spectral_status": ("spectrum_time", state, status.flags()),
            "emissivity": (across, value),
            "emissivity_interval": (("bound", *across), np.stack([value / spread, value * spread])),
            "spectral_residual": (across, residual),
            **budget.variables(_inputs(temperature, error, found.noise_only)),
        },
        {
            "spectrum_time": record.clock(frames.time),
            "time": record.clock(frames.time),
            "emissivity_wavelength": middle,
        },
        carried(test)
        | {
            "degenerate": _degenerate(temperature, found, middle),
            "contradictions": _contradictions(record.clock(frames.time), middle, residual, state),
        },
    )


def _inputs(temperature, error, noise):
    """The uncertainty budget: noise, and what calibration and emissivity leave open besides."""
    rest = np.sqrt(np.maximum(error**2 - noise**2, 0.0))
    return [
        budget.Input("noise of the spectra", "noise", temperature * noise),
        budget.Input("emissivity over wavelength, and the calibration", "emittance", temperature * rest),
    ]


def _degenerate(temperature, found, wavelength):
    """What the light cannot tell, in words, for the hottest spectrum."""
    if not np.isfinite(temperature).any():
        return ""
    hottest = np.nanargmax(temperature)
    kelvin, error = temperature[hottest], found.relative_uncertainty[hottest]
    change = 100 * np.expm1(-SECOND_RADIATION / (wavelength[[0, -1]] * kelvin) * error)
    return (
        f"of the +- {kelvin * error:.2g} K at {kelvin:.0f} K the noise makes"
        f" {kelvin * found.noise_only[hottest]:.1g} K; a surface hotter by all of it, with an emissivity of"
        f" {change[0]:+.2g} % at {wavelength[0] * 1e9:.0f} nm and {change[1]:+.2g} % at"
        f" {wavelength[-1] * 1e9:.0f} nm, gives the same light: what is stated of the emissivity decides"
    )


def _contradictions(time, wavelength, residual, state):
    """A sentence if spectra are no light of a hot surface of smooth emissivity."""
    bad = np.flatnonzero(state == status.CONTRADICTED)
    if not bad.size:
        return ""
    worst = np.nan_to_num(residual[bad])
    row, column = np.unravel_index(np.argmax(np.abs(worst)), worst.shape)
    side = "more" if worst[row, column] > 0 else "less"
    return (
        f"{bad.size} of {state.size} spectra (first at {time[bad[0]]:g} s) are not the light of a hot surface"
        f" of smooth emissivity: most at {wavelength[column] * 1e9:.0f} nm, {abs(worst[row, column]):.0f}"
        f" uncertainties {side} light: other light in the view, or a calibration of another instrument"
    )
