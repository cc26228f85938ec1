"""Stages of a test: corrected temperatures of the pyrometer and of the spectrometer."""

import numpy as np
import xarray as xr

from plasmapyro.experiment import correction, inputs, signals, spectra, status
from plasmapyro.instrument.calibration import require_rising, spread
from plasmapyro.instrument.spectrometer import USABLE, local_noise, measured_radiance
from plasmapyro.radiation.planck import blackbody_radiance

BANDS = ("wide", "narrow")
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
    Source: Fagnani et al., eqs. 11 and 12, sec. 5.2.
    """
    test = inputs.require(test, "pyrometer")
    time = test.time.values
    raw = np.stack([test[f"signal_{band}"].values for band in BANDS]).astype(float)
    injected, shining = signals.phases(time, test.attrs["injection_time"], test.attrs["plasma_off_time"])
    means = [signals.reference_signal(time, row, test.attrs["reference_window"]) for row in raw]
    reference, reference_uncertainty = np.array(means).T
    corrected = signals.corrected_signal(raw, reference, injected, shining)
    uncertainty = signals.corrected_signal_uncertainty(
        raw, reference, reference_uncertainty, shining, signal_uncertainty, gas_variation
    )
    fit = [calibration[name].values for name in ("fit_coefficient", "fit_range", "instrument_range")]
    require_rising(*fit)
    measured_temperature, measured_status = correction.read_measured(raw, *fit)
    corrected_temperature, corrected_status = correction.read_corrected(
        raw, corrected, uncertainty, injected, *fit, detection_level, least_surface_share
    )

    def monte_carlo(gas, gas_uncertainty, temperature, stream):
        spread_of_draws = correction.temperature_uncertainty(
            raw,
            gas,
            gas_uncertainty,
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
        _carried(test),
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

    Returns
    -------
    Dataset, contract 'spectrometer_correction'

    Raises
    ------
    ValueError
        Naming every fault of the test, or a calibration that does not fit it.

    Notes
    -----
    Source: Fagnani et al., eqs. 8 and 13, sec. 5.3. The temperatures come from two fits: the paper's,
    normalised at a pivot (`spectrometer_temperature`), and one with a free scale in units of the noise
    (`scaled_temperature`), which needs no pivot and gives the apparent emittance as well.
    """
    test = inputs.require(test, "spectrometer")
    time, wavelength = test.spectrum_time.values, test.wavelength.values
    radiance, pixels = _radiance(test, spectrometer_calibration, saturation_counts)
    reference = radiance[_reference_index(test, reference_time)]
    injected, shining = signals.phases(time, test.attrs["injection_time"], test.attrs["plasma_off_time"])
    corrected = signals.corrected_signal(radiance.T, reference, injected, shining).T
    noise = np.where(np.isfinite(corrected), local_noise(corrected, noise_block), np.nan)
    gas = np.where(shining[:, None], reference, 0.0)
    uncertainty = np.hypot(noise, gas_variation * gas)
    usable = np.isfinite(corrected) & (uncertainty > 0)
    pivot = np.abs(wavelength - normalisation_wavelength) <= normalisation_half_width
    if not pivot.any():
        raise ValueError(
            f"no pixel within {normalisation_half_width * 1e9:g} nm of the normalisation wavelength"
            f" {normalisation_wavelength * 1e9:g} nm; the spectra end at {wavelength[-1] * 1e9:g} nm"
        )
    clear = spectra.normalised(corrected, usable, pivot)
    to_noise = _pivot_signal_to_noise(corrected, noise, gas_variation * gas, usable & pivot)
    state = _spectrum_status(test, time, injected, usable & pivot, to_noise, least_signal_to_noise)

    pivot_temperature, scaled_temperature, scale = (np.full(time.size, np.nan) for _ in range(3))
    pivot_spread, scaled_spread, scale_spread = (np.full(time.size, np.nan) for _ in range(3))
    curve = np.full(corrected.shape, np.nan)
    common = _common_errors(spectrometer_calibration, wavelength, gas_variation, draws, seed)
    for frame in np.flatnonzero(state == status.VALID):
        one = (corrected[frame : frame + 1], usable[frame : frame + 1])
        spreads = uncertainty[frame : frame + 1]
        found = spectra.fit_normalised(wavelength, *one, pivot, temperature_range)
        best, size = spectra.fit_scaled(wavelength, one[0], spreads, one[1], temperature_range)
        pivot_temperature[frame], scaled_temperature[frame], scale[frame] = found[0], best[0], size[0]
        if np.isnan(found[0]) or np.isnan(best[0]):
            continue
        shape = blackbody_radiance(wavelength, found[0])[None]
        curve[frame] = spectra.normalised(shape, one[1], pivot)[0]
        sample = _draws(corrected[frame], noise[frame], gas[frame], common, seed, frame)
        many = np.broadcast_to(one[1], sample.shape)
        drawn = spectra.fit_normalised(
            wavelength, sample, many, pivot, temperature_range, start=np.full(draws, found[0])
        )
        again, sizes = spectra.fit_scaled(
            wavelength,
            sample,
            np.broadcast_to(spreads, sample.shape),
            many,
            temperature_range,
            start=np.full(draws, best[0]),
        )
        pivot_spread[frame], scaled_spread[frame] = spread(drawn), spread(again)
        scale_spread[frame] = spread(sizes)
    lost = (state == status.VALID) & (np.isnan(pivot_temperature) | np.isnan(scaled_temperature))
    state[lost] = status.NO_SIGNAL
    held = state == status.VALID
    across = ("spectrum_time", "wavelength")
    return xr.Dataset(
        {
            "pixel_status": ("wavelength", pixels),
            "reference_radiance": ("wavelength", reference),
            "spectral_radiance": (across, radiance),
            "corrected_radiance": (across, corrected),
            "radiance_noise": (across, noise),
            "normalised_radiance": (across, clear),
            "normalised_fit": (across, curve),
            "spectrometer_temperature": ("spectrum_time", np.where(held, pivot_temperature, np.nan)),
            "spectrometer_temperature_uncertainty": ("spectrum_time", pivot_spread),
            "scaled_temperature": ("spectrum_time", np.where(held, scaled_temperature, np.nan)),
            "scaled_temperature_uncertainty": ("spectrum_time", scaled_spread),
            "apparent_emittance": ("spectrum_time", np.where(held, scale, np.nan)),
            "apparent_emittance_uncertainty": ("spectrum_time", scale_spread),
            "signal_to_noise": ("spectrum_time", to_noise),
            "spectrum_status": ("spectrum_time", state, status.flags()),
        },
        {"spectrum_time": time, "wavelength": wavelength},
        _carried(test)
        | {
            "reference_time": float(time[_reference_index(test, reference_time)]),
            "normalisation_wavelength": float(normalisation_wavelength),
        },
    )


def _carried(test):
    return {name: test.attrs[name] for name in CARRIED if name in test.attrs}


def _radiance(test, calibration, saturation_counts):
    """Radiance (S, W) of a test, NaN where unusable, and the status (W,) of the pixels."""
    if calibration is None:
        if "spectral_radiance" not in test.variables:
            raise ValueError("the test holds counts: a spectrometer calibration is needed")
        pixels = np.full(test.sizes["wavelength"], USABLE, dtype="int8")
    else:
        if not np.array_equal(calibration.wavelength.values, test.wavelength.values):
            raise ValueError("the spectrometer calibration and the test are not on the same wavelengths")
        pixels = calibration.pixel_status.values.astype("int8")
    if "spectral_radiance" in test.variables:
        return np.where(pixels == USABLE, test.spectral_radiance.values, np.nan), pixels
    raw = test.counts.values.astype(float)
    radiance = measured_radiance(
        np.where(raw < saturation_counts, raw, np.nan),
        test.background_counts.values,
        calibration.calibration_factor.values,
        test.attrs["spectrometer_integration_time"],
    )
    return radiance, pixels


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


def _pivot_signal_to_noise(corrected, noise, gas_error, chosen):
    """Mean corrected radiance of the pivot pixels (S,) over its uncertainty: noise averages, gas does not."""
    count = np.maximum(chosen.sum(axis=1), 1)

    def total(values):
        return np.where(chosen, values, 0.0).sum(axis=1)

    spread_of_mean = np.hypot(np.sqrt(total(noise**2)), total(gas_error)) / count
    mean = total(corrected) / count
    return np.where(chosen.any(axis=1), mean / np.where(spread_of_mean > 0, spread_of_mean, np.nan), np.nan)


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
    """Draws of what errs alike in all spectra: calibration factor (D, W), relative; gas level (D, 1)."""
    generator = np.random.default_rng([seed, 0])
    level = gas_variation * generator.standard_normal((draws, 1))
    if calibration is None:
        return np.zeros((draws, 1)), level
    source = float(calibration.source_temperature)
    actual = source + float(calibration.source_temperature_uncertainty) * generator.standard_normal(
        (draws, 1)
    )
    bias = blackbody_radiance(wavelength, actual) / blackbody_radiance(wavelength, source) - 1
    pixel = np.nan_to_num(calibration.calibration_factor_uncertainty.values)
    return bias + pixel * generator.standard_normal((draws, wavelength.size)), level


def _draws(corrected, noise, gas, common, seed, frame):
    """Draws (D, W) of one corrected spectrum."""
    factor, level = common
    generator = np.random.default_rng([seed, 1, frame])
    own = np.nan_to_num(noise) * generator.standard_normal((level.shape[0], corrected.size))
    return corrected * (1 + factor) + own - level * gas
