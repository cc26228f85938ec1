"""Stages of a test: corrected temperatures of the pyrometer and of the spectrometer."""

import logging

import numpy as np
import xarray as xr
from scipy.ndimage import uniform_filter1d

from plasmapyro.experiment import correction, signals, spectra
from plasmapyro.experiment.frame import (
    FrameFit,
    factor_errors,
    fit_frame,
    fitted_curve,
    pivot_signal_to_noise,
)
from plasmapyro.instrument.scale import scale_draws
from plasmapyro.instrument.spectrometer import USABLE, local_noise
from plasmapyro.progress import step
from plasmapyro.radiation.bandsignal import BANDS
from plasmapyro.record import budget, flags, onset, status
from plasmapyro.record.attributes import carried
from plasmapyro.record.calibrated import halves
from plasmapyro.record.inputs import instruments
from plasmapyro.record.level import unlike_level
from plasmapyro.record.noise import floor_of
from plasmapyro.record.record import record_of

LOG = logging.getLogger(__name__)
UNIFORM = 12.0  # a range that is all that is known, squared, over its variance: JCGM 100:2008, 4.3.7
SMOOTH = 4  # blocks of noise over which light is averaged to choose a pivot
PIVOT = 1030e-9  # [m] of the normalised fit by default: no line and little gas, Fagnani et al., sec. 5.3


def correct_pyrometer(
    test,
    calibration,
    response=None,
    *,
    signal_uncertainty,
    gas_variation,
    detection_level,
    least_surface_share,
    draws,
    seed,
):
    """Corrected signals and temperatures of the pyrometer of a test.

    Source: Fagnani et al., eqs. 12 and 13, sec. 5.2.

    ValueError, naming every fault of the test, or if the calibration cannot be inverted.

    Parameters
    ----------
    test : Dataset, contract 'test'
    calibration : Dataset, contract 'calibration'
    response : Dataset, contract 'response', optional
        With it a sample whose level is no light of the temperature of its ratio is contradicted, where no
        second instrument tells whether the temperature is right (`quality.instruments_disagree`).
    signal_uncertainty : float [1]
        Relative standard uncertainty of one signal, beside the noise that the record shows without light.
    gas_variation : float [1]
        Relative standard deviation of the gas radiance about that of the reference window; at least what
        both bands show in it.
    detection_level : float [1]
        Corrected signals of fewer standard uncertainties than this give no temperature.
    least_surface_share : float [1]
        Below this share of the surface in a signal, the status says that the gas dominates.
    draws, seed : int
        Of the Monte Carlo uncertainties.

    Returns
    -------
    Dataset, contract 'pyrometer_correction'
    """
    record = record_of(test, {"pyrometer": calibration}, needed=["pyrometer"])
    bands = record.instrument("pyrometer")
    injected, shining = record.phases(bands.time)
    saturated = bands.flagged(flags.SATURATED, flags.CLIPPED).any(axis=1)
    raw = np.where(bands.flagged(flags.STUCK, flags.SPIKED, flags.RELIT), np.nan, bands.value).T
    sound = np.where(saturated, np.nan, raw)
    means = [
        signals.reference_signal(bands.time, row, record.window) if record.window else (0.0, 0.0)
        for row in sound
    ]
    reference, reference_uncertainty = np.array(means).T
    if record.window:
        gas_variation = max(gas_variation, signals.shared_scatter(bands.time, sound, record.window))
    reading = correction.Reading.of(
        calibration,
        record.emittance_slope,
        signal_uncertainty=signal_uncertainty,
        gas_variation=gas_variation,
        detection_level=detection_level,
        least_surface_share=least_surface_share,
        slope_uncertainty=record.emittance_slope_uncertainty,
        floor=floor_of(sound),
    )
    corrected, uncertainty, corrected_temperature, corrected_status = reading.corrected(
        raw, reference, reference_uncertainty, injected, shining, saturated
    )
    measured_temperature, measured_status = correction.read_measured(reading, raw, saturated)

    def monte_carlo(gas, gas_uncertainty, temperature, state, stream):
        """Temperature and its uncertainty (t,) [K]; none where that tells no more than the range does."""
        generator = np.random.default_rng([seed, stream])
        error = correction.temperature_uncertainty(reading, raw, gas, gas_uncertainty, draws, generator)
        known = np.isfinite(temperature) & (error <= np.ptp(reading.instrument_range) / np.sqrt(UNIFORM))
        state[np.isfinite(temperature) & ~known] = status.NO_SIGNAL
        return (np.where(known, one, np.nan) for one in (temperature, error))

    nothing = np.zeros_like(raw)
    taken = [np.where(shining, row[:, None], 0.0) for row in (reference, reference_uncertainty)]
    corrected_temperature, corrected_uncertainty = monte_carlo(
        *taken, corrected_temperature, corrected_status, 1
    )
    measured_temperature, measured_uncertainty = monte_carlo(
        nothing, nothing, measured_temperature, measured_status, 0
    )
    if response is not None and len(instruments(test)) == 1:
        known = corrected_temperature, corrected_uncertainty
        unlike = unlike_level(corrected, *known, test.attrs, calibration, response)
        corrected_status[unlike] = status.CONTRADICTED
        corrected_temperature, corrected_uncertainty = (np.where(unlike, np.nan, one) for one in known)
    return xr.Dataset(
        {
            "signal_wide": ("time", bands.value[:, 0]),
            "signal_narrow": ("time", bands.value[:, 1]),
            "reference_signal": ("band", reference),
            "reference_signal_uncertainty": ("band", reference_uncertainty),
            "corrected_signal": (("band", "time"), corrected),
            "corrected_signal_uncertainty": (("band", "time"), np.where(injected, uncertainty, np.nan)),
            "surface_share": (("band", "time"), corrected / np.where(raw == 0, np.nan, raw)),
            "measured_temperature": ("time", measured_temperature),
            "measured_temperature_uncertainty": ("time", measured_uncertainty),
            "measured_status": ("time", measured_status, status.flags()),
            "corrected_temperature": ("time", corrected_temperature),
            "corrected_temperature_uncertainty": ("time", corrected_uncertainty),
            "corrected_status": ("time", corrected_status, status.flags()),
            "relative_error": (
                "time",
                (measured_temperature - corrected_temperature) / corrected_temperature,
            ),
            "instrument_range": calibration.instrument_range,
            "fit_range": calibration.fit_range,
            **budget.variables(correction.budget_of(reading, raw, *taken, corrected_uncertainty)),
        },
        {"time": test.time.values, "band": list(BANDS)},
        carried(test) | _window_attributes("pyrometer", record, bands.time, sound),
    )


def correct_spectra(
    test,
    spectrometer_calibration,
    *,
    reference_time,
    normalisation_wavelength,
    normalisation_half_width,
    temperature_range,
    saturation_counts,
    gas_variation,
    least_signal_to_noise,
    noise_block,
    draws,
    seed,
):
    """Corrected spectra of a test and the temperatures fitted to them.

    Source: Fagnani et al., eqs. 8 and 14, sec. 5.3. The temperatures come from two fits: the paper's,
    normalised at a pivot (`spectrometer_temperature`), and one with a free scale in units of the noise
    (`scaled_temperature`), which needs no pivot and gives the apparent emittance as well.

    ValueError, naming every fault of the test, or a calibration that does not fit it.

    Parameters
    ----------
    test : Dataset, contract 'test'
        With `spectral_radiance`, or with `counts` and `background_counts`.
    spectrometer_calibration : Dataset, contract 'spectrometer_calibration', or None
        Needed for counts; on the same wavelengths. With radiances it adds its uncertainty and mask.
    reference_time : float [s]
        The exposure whose middle is nearest gives the reference spectrum; it must lie in the
        reference window.
    normalisation_wavelength : float [m], or None
        Pivot of the normalised fit; None: `PIVOT`, or where the surface stands out most if no pixel is there.
    normalisation_half_width : float [m]
        The mean of the pixels within it is taken.
    temperature_range : (2,) floats [K]
        Where the fits look.
    saturation_counts : float [count]
        Raw counts from here on are saturated; such samples become NaN.
    gas_variation : float [1]
        Relative standard deviation of the gas radiance about that of the reference spectrum.
    least_signal_to_noise : float [1]
        Below this, at the pivot, a spectrum is not usable.
    noise_block : int
        Pixels per noise estimate.
    draws, seed : int
        Of the Monte Carlo uncertainties.

    Returns
    -------
    Dataset, contract 'spectrometer_correction'
    """
    record = record_of(
        test,
        {"spectrometer": spectrometer_calibration},
        saturation_counts=saturation_counts,
        needed=["spectrometer"],
    )
    frames = record.instrument("spectrometer")
    time, wavelength, pixels = frames.time, frames.wavelength, frames.channel_status
    radiance, saturated = frames.sound, frames.flagged(flags.SATURATED)
    index = _reference_index(record, frames, reference_time) if record.window else 0
    reference = radiance[index] if record.window else np.zeros(wavelength.size)
    injected, shining = record.phases(time)
    corrected = signals.corrected_signal(radiance.T, reference, injected, shining).T
    noise = np.where(np.isfinite(corrected), local_noise(corrected, noise_block), np.nan)
    gas = np.where(shining[:, None], reference, 0.0)
    usable = np.isfinite(corrected) & (np.hypot(noise, gas_variation * gas) > 0)
    if normalisation_wavelength is None:
        standing_out = _mean_about(corrected, SMOOTH * noise_block) / np.where(
            usable, np.hypot(noise, gas_variation * gas), np.nan
        )
        normalisation_wavelength = _pivot(
            wavelength, pixels == USABLE, normalisation_half_width, standing_out[injected]
        )
    pivot = np.abs(wavelength - normalisation_wavelength) <= normalisation_half_width
    good = wavelength[pixels == USABLE]
    if not (pivot & (pixels == USABLE)).any():
        span = f"{good[0] * 1e9:.5g} to {good[-1] * 1e9:.5g} nm" if good.size else "none"
        raise ValueError(
            f"no usable pixel within {normalisation_half_width * 1e9:g} nm of the wavelength at which the"
            f" spectra are normalised, {normalisation_wavelength * 1e9:g} nm; usable are {span}: choose"
            " another with `correct --normalisation-nm` (in the workflow: normalisation_wavelength_nm)"
        )
    to_noise = pivot_signal_to_noise(corrected, noise, gas_variation * gas, usable & pivot)
    state = _spectrum_status(record, frames, injected, usable & pivot, to_noise, least_signal_to_noise)
    state[(state == status.MISSING) & saturated[:, pivot].any(axis=1)] = status.SATURATED
    factor_error, gas_level = _common_errors(spectrometer_calibration, wavelength, gas_variation, draws, seed)
    trials = spectra.trial_curves(wavelength, temperature_range)
    fits = np.full((time.size, len(FrameFit._fields)), np.nan)
    usable_frames = np.flatnonzero(state == status.VALID)
    for done, frame in enumerate(usable_frames, 1):
        fits[frame] = fit_frame(
            wavelength,
            corrected[frame],
            noise[frame],
            gas[frame],
            usable[frame],
            pivot,
            trials,
            temperature_range,
            gas_variation,
            factor_error,
            gas_level,
            np.random.default_rng([seed, 1, frame]),
        )
        step("fitting spectra", done, usable_frames.size)
    found = FrameFit(*fits.T)
    # A spectrum that no black body in the range resembles holds no signal of one.
    state[(state == status.VALID) & np.isnan(found.temperature)] = status.NO_SIGNAL
    across = ("spectrum_time", "wavelength")
    return xr.Dataset(
        {
            "pixel_status": ("wavelength", pixels),
            "reference_radiance": ("wavelength", reference),
            "spectral_radiance": (across, radiance),
            "corrected_radiance": (across, corrected),
            "radiance_noise": (across, noise),
            "normalised_radiance": (across, spectra.normalised(corrected, usable, pivot)),
            "normalised_fit": (across, fitted_curve(wavelength, found.temperature, usable, pivot)),
            "spectrometer_temperature": ("spectrum_time", found.temperature),
            "spectrometer_temperature_uncertainty": ("spectrum_time", found.temperature_uncertainty),
            "scaled_temperature": ("spectrum_time", found.scaled_temperature),
            "scaled_temperature_uncertainty": ("spectrum_time", found.scaled_temperature_uncertainty),
            "apparent_emittance": ("spectrum_time", found.scale),
            "apparent_emittance_uncertainty": ("spectrum_time", found.scale_uncertainty),
            "signal_to_noise": ("spectrum_time", to_noise),
            "spectrum_status": ("spectrum_time", state, status.flags()),
        },
        {"spectrum_time": test.spectrum_time.values, "wavelength": wavelength},
        carried(test)
        | _window_attributes("spectrometer", record, time, halves(radiance))
        | {
            "reference_time": float(test.spectrum_time.values[index]) if record.window else np.nan,
            "normalisation_wavelength": float(normalisation_wavelength),
        },
    )


def _mean_about(values, block):
    """Running means (S, W) over `block` pixels of what is finite: a pivot chosen by single pixels is where
    the noise of the reference, which all exposures have, made them bright, and so too bright."""
    known = np.isfinite(values)
    total = uniform_filter1d(np.where(known, values, 0.0), block, axis=-1)
    return total / np.maximum(uniform_filter1d(known.astype(float), block, axis=-1), 1 / block)


def _pivot(wavelength, usable, half_width, standing_out):
    """`PIVOT` if a pixel (W,) is usable there or none anywhere, else the wavelength [m] of that out of which
    the surface stands most, by standard deviations (S, W) of which the median over the exposures counts."""
    number = np.isfinite(standing_out).sum(axis=0)
    seen = usable & (number > 0) & (2 * number >= number.max(initial=0))
    if (usable & (np.abs(wavelength - PIVOT) <= half_width)).any() or not seen.any():
        return PIVOT
    chosen = wavelength[seen][np.argmax(np.nanmedian(standing_out[:, seen], axis=0))]
    LOG.warning(
        "no usable pixel at %g nm: spectra are normalised at %.5g nm, where the surface stands out most;"
        " --normalisation-nm of `correct` chooses another",
        PIVOT * 1e9,
        chosen * 1e9,
    )
    return chosen


def _window_attributes(name, record, time, pair):
    """What the program finds in the reference window (see `onset.attributes`); also logged if amiss."""
    if not record.window:
        return {}
    found = onset.attributes(name, time, pair, record.window, record.off)
    # The record counts from the injection, a reader on the clock of the test.
    for moment in (f"{name}_surface_onset", f"{name}_proposed_window"):
        if moment in found:
            found[moment] = record.clock(np.array(found[moment])).tolist()
    if found[f"{name}_reference_verdict"] in (onset.SHOWS, onset.DRIFTS):
        LOG.info("%s: reference window %g to %g s: %s", name, *record.clock(np.array(record.window)), found)
    return found


def middle_exposure(test):
    """Middle [s] of the exposure within the reference window that is nearest to the middle of that; None if
    there is none, 0 without a window."""
    if "reference_window" not in test.attrs:
        return 0.0
    (low, high), half = test.attrs["reference_window"], test.attrs["spectrometer_integration_time"] / 2
    time = test.spectrum_time.values
    time = time[(time - half >= low) & (time + half <= high)]
    return float(time[np.argmin(np.abs(time - (low + high) / 2))]) if time.size else None


def _reference_index(record, frames, reference_time):
    """Index of the exposure that gives the reference spectrum; refused if it is not all in the window."""
    index = int(np.argmin(np.abs(frames.time - (reference_time - record.injection))))
    middle, half = frames.time[index], frames.integration_time / 2
    if not record.window[0] <= middle - half < middle + half <= record.window[1]:
        begin, end, low, high = record.clock(np.array([middle - half, middle + half, *record.window]))
        raise ValueError(
            f"the exposure nearest to reference_time {reference_time:g} s, {begin:g} to {end:g} s, is not"
            f" inside the reference window {low:g} to {high:g} s"
        )
    return index


def _spectrum_status(record, frames, injected, chosen, to_noise, least):
    state = np.full(frames.time.size, status.VALID, dtype="int8")
    state[~(to_noise >= least)] = status.NO_SIGNAL
    state[~chosen.any(axis=1)] = status.MISSING
    state[~injected] = status.NOT_INJECTED
    state[record.straddling(frames)] = status.STRADDLING
    return state


def _common_errors(calibration, wavelength, gas_variation, draws, seed):
    """Draws of what errs alike in all spectra: calibration factor (D, W) and gas level (D, 1), relative."""
    generator = np.random.default_rng([seed, 0])
    level = gas_variation * generator.standard_normal((draws, 1))
    if calibration is None:
        return scale_draws(wavelength, draws, generator), level
    errors = factor_errors(
        wavelength,
        float(calibration.source_temperature),
        float(calibration.source_temperature_uncertainty),
        calibration.calibration_factor_uncertainty.values,
        draws,
        generator,
    )
    return errors, level
