"""What the paper says of calibration and test (secs. 3 and 5), on the synthetic twin of its experiment."""

import numpy as np

from plasmapyro.claims.analysis import last_above
from plasmapyro.claims.claim import claim

WIDTH = 20.0  # [K] of bins whose medians tell an error
STEP = 4.0  # [s], over which the noise of single readings is averaged


def calibration_claims(calibration):
    """Claims on the calibration of the pyrometer. `calibration`: Dataset, contract 'calibration'."""
    temperature = calibration.calibration_temperature
    low, high = calibration.fit_range.values
    calibrated = (temperature >= low) & (temperature <= high)
    spread = (calibration.temperature_uncertainty / temperature)[calibrated]
    return [
        claim("sensitivity_ratio", calibration.sensitivity_ratio, calibration),
        claim("calibration_residual", 100 * abs(calibration.model_residual).max(), calibration),
        claim("quadratic_fit", 100 * abs(calibration.fit_residual).max(), calibration),
        claim("temperature_uncertainty", 100 * spread.median(), calibration),
    ]


def correction_claims(pyrometer):
    """Claims on measured and corrected temperature. `pyrometer`: contract 'pyrometer_correction'."""
    begin = pyrometer.attrs["injection_time"]
    heating = ((pyrometer.time >= begin) & (pyrometer.time <= pyrometer.attrs["plasma_off_time"])).values
    error = abs(pyrometer.relative_error.values[heating])
    corrected = pyrometer.corrected_temperature.values[heating]
    time = pyrometer.time.values[heating]
    steady = error[time > pyrometer.attrs["plasma_off_time"] - 50]
    return [
        claim("signals_drop", _drop(pyrometer), pyrometer),
        claim("corrected_rises", _rising_share(pyrometer), pyrometer, step=STEP),
        claim("error_one_percent", _highest_with_error_above(corrected, error, 0.01), pyrometer),
        claim("error_ten_percent", _highest_with_error_above(corrected, error, 0.10), pyrometer),
        claim("error_steady", 100 * np.nanmedian(steady), pyrometer),
    ]


def spectrometer_claims(pyrometer, spectra):
    """Claims on the spectrometer. `spectra`: Dataset, contract 'spectrometer_correction'."""
    begin = spectra.attrs.get("injection_time", 0.0)
    usable = (spectra.spectrum_status == 0).values & (spectra.spectrum_time > begin).values
    time = spectra.spectrum_time.values[usable]
    reading = spectra.spectrometer_temperature.values[usable]
    other = np.interp(time, pyrometer.time, pyrometer.corrected_temperature.interpolate_na("time"))
    agree = 100 * np.nanmedian(abs(reading / other - 1)) if time.size else np.nan
    return [
        claim("spectrometer_start", time[0] if time.size else np.nan, spectra),
        claim("instruments_agree", agree, spectra),
    ]


def _drop(pyrometer):
    """Smaller loss [%] of the two signals from the last seconds before the injection to the first after."""
    time = pyrometer.time.values - pyrometer.attrs["injection_time"]
    before, after = (time > -5) & (time < -0.5), (time > 0.5) & (time < 4)
    if not (before.any() and after.any()):
        return np.nan
    signals = [pyrometer[f"signal_{band}"].values for band in ("wide", "narrow")]
    return float(min(100 * (1 - np.nanmean(one[after]) / np.nanmean(one[before])) for one in signals))


def _rising_share(pyrometer):
    """Share [%] of the steps in which the valid corrected temperature rises, up to 80 s."""
    time = pyrometer.time.values - pyrometer.attrs["injection_time"]
    good = (pyrometer.corrected_status.values == 0) & (time > 0) & (time <= 80)
    step = np.floor(time[good] / STEP)
    means = [np.median(pyrometer.corrected_temperature.values[good][step == one]) for one in np.unique(step)]
    return 100 * float(np.mean(np.diff(means) > 0)) if len(means) > 1 else np.nan


def _highest_with_error_above(temperature, error, level):
    """Temperature [K] above which the error stays below `level`, from medians over bins of `WIDTH` [K].

    The crossing is read between the centres of the last bin above the level and the next one, linear in
    the logarithm of the error; NaN if no bin is above.
    """
    good = np.isfinite(temperature) & np.isfinite(error)
    bins = np.floor(temperature[good] / WIDTH)
    numbers = np.unique(bins)
    median = np.array([np.median(error[good][bins == number]) for number in numbers])
    return last_above((numbers + 0.5) * WIDTH, np.log(median), np.log(level))
