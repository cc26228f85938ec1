"""Stages of a test: corrected temperatures of the pyrometer and of the spectrometer."""

import logging

import numpy as np
import xarray as xr

from plasmapyro.experiment import correction, inputs, onset, signals, spectra, status
from plasmapyro.experiment.frame import (
    FrameFit,
    factor_errors,
    fit_frame,
    fitted_curve,
    pivot_signal_to_noise,
)
from plasmapyro.instrument.calibration import require_rising
from plasmapyro.instrument.raw_counts import above_baseline
from plasmapyro.instrument.spectrometer import USABLE, local_noise, measured_radiance

LOG = logging.getLogger(__name__)
BANDS = ("wide", "narrow")
SAME_PIXEL = 1e-11  # [m] programs print 2 to 4 digits of a nanometre; pixels are ten times as far apart
CARRIED = (
    "title",
    "origin",
    "condition",
    "injection_time",
    "plasma_off_time",
    "reference_window",
    "emittance",
    "emittance_uncertainty",
)


def correct_pyrometer(
    test, calibration, *, signal_uncertainty, gas_variation, detection_level, least_surface_share, draws, seed
):
    """Corrected signals and temperatures of the pyrometer of a test.

    Parameters
    ----------
    test : Dataset, contract 'test'
    calibration : Dataset, contract 'calibration'
    signal_uncertainty : float [1]
        Relative standard uncertainty of one signal.
    gas_variation : float [1]
        Relative standard deviation of the gas radiance about that of the reference window.
    detection_level : float [1]
        Corrected signals of fewer standard uncertainties than this give no temperature.
    least_surface_share : float [1]
        Below this share of the surface in a signal, the status says that the gas dominates.
    draws, seed : int
        Of the Monte Carlo uncertainties.

    Returns
    -------
    Dataset, contract 'pyrometer_correction'

    Raises
    ------
    ValueError
        Naming every fault of the test, or if the calibration cannot be inverted.

    Notes
    -----
    Source: Fagnani et al., eqs. 12 and 13, sec. 5.2.
    """
    test = inputs.require(test, "pyrometer")
    time = test.time.values
    raw = np.stack([test[f"signal_{band}"].values for band in BANDS]).astype(float)
    injected, shining = signals.phases(time, test.attrs["injection_time"], test.attrs["plasma_off_time"])
    limits = [test.attrs.get(f"signal_saturation_{band}", np.inf) for band in BANDS]
    saturated = (raw >= np.array(limits)[:, None]).any(axis=0)
    slope = float(test.attrs.get("emittance_slope", 1.0))
    sound = np.where(saturated, np.nan, raw)
    means = [signals.reference_signal(time, row, test.attrs["reference_window"]) for row in sound]
    reference, reference_uncertainty = np.array(means).T
    corrected = signals.corrected_signal(raw, reference, injected, shining)
    uncertainty = signals.corrected_signal_uncertainty(
        raw, reference, reference_uncertainty, shining, signal_uncertainty, gas_variation
    )
    fit = [calibration[name].values for name in ("fit_coefficient", "fit_range", "instrument_range")]
    require_rising(*fit)
    measured_temperature, measured_status = correction.read_measured(raw, saturated, slope, *fit)
    corrected_temperature, corrected_status = correction.read_corrected(
        raw, corrected, uncertainty, injected, saturated, slope, *fit, detection_level, least_surface_share
    )

    def monte_carlo(gas, gas_uncertainty, temperature, stream):
        spread_of_draws = correction.temperature_uncertainty(
            raw,
            gas,
            gas_uncertainty,
            slope,
            float(test.attrs.get("emittance_slope_uncertainty", 0.0)),
            fit[0],
            calibration.fit_covariance.values,
            fit[1],
            signal_uncertainty,
            gas_variation,
            draws,
            np.random.default_rng([seed, stream]),
        )
        return np.where(np.isfinite(temperature), spread_of_draws, np.nan)

    nothing = np.zeros_like(raw)
    return xr.Dataset(
        {
            "signal_wide": ("time", raw[0]),
            "signal_narrow": ("time", raw[1]),
            "reference_signal": ("band", reference),
            "reference_signal_uncertainty": ("band", reference_uncertainty),
            "corrected_signal": (("band", "time"), corrected),
            "corrected_signal_uncertainty": (("band", "time"), np.where(injected, uncertainty, np.nan)),
            "surface_share": (("band", "time"), corrected / np.where(raw == 0, np.nan, raw)),
            "measured_temperature": ("time", measured_temperature),
            "measured_temperature_uncertainty": (
                "time",
                monte_carlo(nothing, nothing, measured_temperature, 0),
            ),
            "measured_status": ("time", measured_status, status.flags()),
            "corrected_temperature": ("time", corrected_temperature),
            "corrected_temperature_uncertainty": (
                "time",
                monte_carlo(
                    np.where(shining, reference[:, None], 0.0),
                    np.where(shining, reference_uncertainty[:, None], 0.0),
                    corrected_temperature,
                    1,
                ),
            ),
            "corrected_status": ("time", corrected_status, status.flags()),
            "relative_error": (
                "time",
                (measured_temperature - corrected_temperature) / corrected_temperature,
            ),
            "instrument_range": calibration.instrument_range,
            "fit_range": calibration.fit_range,
        },
        {"time": time, "band": list(BANDS)},
        _carried(test) | _window_attributes("pyrometer", test, time, sound),
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
    report=None,
):
    """Corrected spectra of a test and the temperatures fitted to them.

    Parameters
    ----------
    test : Dataset, contract 'test'
        With `spectral_radiance`, or with `counts` and `background_counts`.
    spectrometer_calibration : Dataset, contract 'spectrometer_calibration', or None
        Needed for counts; on the same wavelengths. With radiances it adds its uncertainty and mask.
    reference_time : float [s]
        The exposure whose middle is nearest gives the reference spectrum; it must lie in the
        reference window.
    normalisation_wavelength, normalisation_half_width : float [m]
        Pivot of the normalised fit: the mean of the pixels within the half width.
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
    report : function (done, total), optional
        Called as the fits go on.

    Returns
    -------
    Dataset, contract 'spectrometer_correction'

    Raises
    ------
    ValueError
        Naming every fault of the test, or a calibration that does not fit it.

    Notes
    -----
    Source: Fagnani et al., eqs. 8 and 14, sec. 5.3. The temperatures come from two fits: the paper's,
    normalised at a pivot (`spectrometer_temperature`), and one with a free scale in units of the noise
    (`scaled_temperature`), which needs no pivot and gives the apparent emittance as well.
    """
    test = inputs.require(test, "spectrometer")
    time, wavelength = test.spectrum_time.values, test.wavelength.values
    radiance, pixels, saturated = calibrated_radiance(test, spectrometer_calibration, saturation_counts)
    reference = radiance[_reference_index(test, reference_time)]
    injected, shining = signals.phases(time, test.attrs["injection_time"], test.attrs["plasma_off_time"])
    corrected = signals.corrected_signal(radiance.T, reference, injected, shining).T
    noise = np.where(np.isfinite(corrected), local_noise(corrected, noise_block), np.nan)
    gas = np.where(shining[:, None], reference, 0.0)
    usable = np.isfinite(corrected) & (np.hypot(noise, gas_variation * gas) > 0)
    pivot = np.abs(wavelength - normalisation_wavelength) <= normalisation_half_width
    if not pivot.any():
        raise ValueError(
            f"no pixel within {normalisation_half_width * 1e9:g} nm of the normalisation wavelength"
            f" {normalisation_wavelength * 1e9:g} nm; the spectra end at {wavelength[-1] * 1e9:g} nm"
        )
    to_noise = pivot_signal_to_noise(corrected, noise, gas_variation * gas, usable & pivot)
    state = _spectrum_status(test, time, injected, usable & pivot, to_noise, least_signal_to_noise)
    state[(state == status.MISSING) & saturated[:, pivot].any(axis=1)] = status.SATURATED
    factor_error, gas_level = _common_errors(spectrometer_calibration, wavelength, gas_variation, draws, seed)
    trials = spectra.trial_curves(wavelength, temperature_range)
    fits = np.full((time.size, len(FrameFit._fields)), np.nan)
    frames = np.flatnonzero(state == status.VALID)
    for done, frame in enumerate(frames, 1):
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
        if report is not None:
            report(done, frames.size)
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
        {"spectrum_time": time, "wavelength": wavelength},
        _carried(test)
        | _window_attributes("spectrometer", test, time, halves(radiance))
        | {
            "reference_time": float(time[_reference_index(test, reference_time)]),
            "normalisation_wavelength": float(normalisation_wavelength),
        },
    )


def on_same_wavelengths(first, second):
    """Whether two datasets hold the same pixels, up to the digits that programs print."""
    mine, its = first.wavelength.values, second.wavelength.values
    return mine.size == its.size and np.allclose(mine, its, rtol=0, atol=SAME_PIXEL)


def _span(dataset):
    values = dataset.wavelength.values * 1e9
    return f"{values.size} pixels from {values[0]:.3f} to {values[-1]:.3f} nm"


def _carried(test):
    return {name: test.attrs[name] for name in CARRIED if name in test.attrs}


def halves(radiance):
    """Mean radiance (2, S) of the pixels of shorter and of longer wavelength; NaN without a usable one."""
    good = np.isfinite(radiance)
    middle = np.searchsorted(np.cumsum(good.any(axis=0)), good.any(axis=0).sum() / 2)
    parts = [slice(None, middle), slice(middle, None)]
    count = np.array([good[:, part].sum(axis=1) for part in parts])
    total = np.array([np.where(good[:, part], radiance[:, part], 0.0).sum(axis=1) for part in parts])
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _window_attributes(instrument, test, time, pair):
    """What the program finds in the reference window (see `onset.attributes`); also logged if amiss."""
    window = test.attrs["reference_window"]
    found = onset.attributes(instrument, time, pair, window, test.attrs["plasma_off_time"])
    if found[f"{instrument}_reference_verdict"] in (onset.SHOWS, onset.DRIFTS):
        LOG.warning("%s: reference window %g to %g s: %s", instrument, *window, found)
    return found


def calibrated_radiance(test, calibration, saturation_counts):
    """Radiance (S, W), NaN where unusable; status (W,) of the pixels; where the converter clipped (S, W)."""
    if calibration is None:
        if "spectral_radiance" not in test.variables:
            raise ValueError(
                "the test holds counts: a spectrometer calibration is needed (in the workflow:"
                " calibrated_spectra: false in the file of the test, and instrument.spectrometer_counts)"
            )
        pixels = np.full(test.sizes["wavelength"], USABLE, dtype="int8")
    else:
        if not on_same_wavelengths(calibration, test):
            raise ValueError(
                "the spectrometer calibration and the test are not on the same wavelengths:"
                f" {_span(calibration)} against {_span(test)}"
            )
        pixels = calibration.pixel_status.values.astype("int8")
    shape = test.sizes["spectrum_time"], test.sizes["wavelength"]
    saturated = test.saturated.values > 0 if "saturated" in test.variables else np.zeros(shape, dtype=bool)
    if "spectral_radiance" in test.variables:
        good = (pixels == USABLE) & ~saturated
        return np.where(good, test.spectral_radiance.values, np.nan), pixels, saturated
    raw = test.counts.values.astype(float)
    saturated |= raw >= saturation_counts
    raw[saturated] = np.nan
    background = test.background_counts.values
    if "linearity_coefficient" in calibration:
        # As the counts of the source were treated, so are these.
        if test.attrs.get("counts_linearised") and calibration.sizes["linearity_power"] > 1:
            raise ValueError(
                "the counts of the test are linearised already, those of the calibration were not: switch the"
                " correction off in the spectrometer's program, or calibrate with linearised counts"
            )
        masked = calibration.masked_pixel.values if "masked_pixel" in calibration else []
        raw, background = (
            above_baseline(values, calibration.linearity_coefficient.values, masked)
            for values in (raw, background)
        )
    radiance = measured_radiance(
        raw,
        background,
        calibration.calibration_factor.values,
        test.attrs["spectrometer_integration_time"],
    )
    return radiance, pixels, saturated


def _reference_index(test, reference_time):
    """Index of the exposure that gives the reference spectrum; refused if it is not all in the window."""
    time, window = test.spectrum_time.values, test.attrs["reference_window"]
    index = int(np.argmin(np.abs(time - reference_time)))
    half = test.attrs["spectrometer_integration_time"] / 2
    if not window[0] <= time[index] - half < time[index] + half <= window[1]:
        raise ValueError(
            f"the exposure nearest to reference_time {reference_time:g} s, {time[index] - half:g} to"
            f" {time[index] + half:g} s, is not inside the reference window"
            f" {window[0]:g} to {window[1]:g} s"
        )
    return index


def _spectrum_status(test, time, injected, chosen, to_noise, least):
    half = test.attrs["spectrometer_integration_time"] / 2
    state = np.full(time.size, status.VALID, dtype="int8")
    state[~(to_noise >= least)] = status.NO_SIGNAL
    state[~chosen.any(axis=1)] = status.MISSING
    state[~injected] = status.NOT_INJECTED
    for moment in (test.attrs["injection_time"], test.attrs["plasma_off_time"]):
        state[np.abs(time - moment) < half] = status.STRADDLING
    return state


def _common_errors(calibration, wavelength, gas_variation, draws, seed):
    """Draws of what errs alike in all spectra: calibration factor (D, W) and gas level (D, 1), relative."""
    generator = np.random.default_rng([seed, 0])
    level = gas_variation * generator.standard_normal((draws, 1))
    if calibration is None:
        return np.zeros((draws, 1)), level
    errors = factor_errors(
        wavelength,
        float(calibration.source_temperature),
        float(calibration.source_temperature_uncertainty),
        calibration.calibration_factor_uncertainty.values,
        draws,
        generator,
    )
    return errors, level
