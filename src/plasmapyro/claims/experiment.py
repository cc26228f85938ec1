"""What the paper says of calibration and test (secs. 3 and 5), on the synthetic twin of its experiment."""

import numpy as np

from plasmapyro.claims.claim import UNTESTABLE, Claim

STEP = 4.0  # [s], over which the noise of single readings is averaged
TWIN = "On the synthetic twin: "


def calibration_claims(calibration):
    """Claims on the calibration of the pyrometer. `calibration`: Dataset, contract 'calibration'."""
    basis = _basis(calibration)
    temperature = calibration.calibration_temperature
    low, high = calibration.fit_range.values
    calibrated = (temperature >= low) & (temperature <= high)
    spread = (calibration.temperature_uncertainty / temperature)[calibrated]
    return [
        Claim(
            "sensitivity_ratio",
            "3.2",
            "A sensitivity ratio of 0.315 fits the modelled ratio to the calibration points.",
            float(calibration.sensitivity_ratio),
            "1",
            0.31,
            0.32,
            TWIN + "its points were made with 0.315, so this tests the fit, not the pyrometer.",
            basis,
        ),
        Claim(
            "calibration_residual",
            "3.2",
            "The modelled ratio fits the calibration points within 1.5 %.",
            100 * float(abs(calibration.model_residual).max()),
            "%",
            0,
            1.5,
            TWIN + "the residual is the noise of its points (3 K, 1 % per signal).",
            basis,
        ),
        Claim(
            "quadratic_fit",
            "3.2",
            "A quadratic function fits the calibration points with negligible residuals.",
            100 * float(abs(calibration.fit_residual).max()),
            "%",
            0,
            1,
            TWIN + "largest residual of the ratio; 'negligible' read as below the 1 % of a signal.",
            basis,
        ),
        Claim(
            "temperature_uncertainty",
            "3.2",
            "The Monte Carlo uncertainty of the measured temperature is about 1.5 %.",
            100 * float(spread.median()),
            "%",
            1,
            2,
            "Median standard uncertainty over the calibrated range, 3 K on the source and 1 % per signal;"
            " without bias, as in the paper.",
            basis,
        ),
    ]


def correction_claims(pyrometer):
    """Claims on measured and corrected temperature. `pyrometer`: contract 'pyrometer_correction'."""
    basis = _basis(pyrometer)
    begin = pyrometer.attrs["injection_time"]
    heating = ((pyrometer.time >= begin) & (pyrometer.time <= pyrometer.attrs["plasma_off_time"])).values
    error = abs(pyrometer.relative_error.values[heating])
    corrected = pyrometer.corrected_temperature.values[heating]
    time = pyrometer.time.values[heating]
    steady = error[time > pyrometer.attrs["plasma_off_time"] - 50]
    return [
        Claim(
            "signals_drop",
            "5.2",
            "Both signals drop at the injection, because the sample hides half of the jet.",
            _drop(pyrometer),
            "%",
            0,
            100,
            TWIN + "smaller of the two drops, seconds before against seconds after; the twin was given one.",
            basis,
        ),
        Claim(
            "corrected_rises",
            "5.2",
            "The corrected temperature recovers the rising trend of the heating.",
            _rising_share(pyrometer),
            "% of the heating",
            95,
            100,
            TWIN + f"share of steps of {STEP:g} s up to 80 s in which the median of the valid values rises.",
            basis,
        ),
        Claim(
            "error_one_percent",
            "5.2",
            "The measured temperature is within 1 % of the corrected one only above 1350 K.",
            _highest_with_error_above(corrected, error, 0.01),
            "K",
            1340,
            1360,
            TWIN + "crossing of the medians over 20 K; depends on the gas state the twin was given.",
            basis,
        ),
        Claim(
            "error_ten_percent",
            "5.2",
            "The error exceeds 10 % below 1120 K.",
            _highest_with_error_above(corrected, error, 0.10),
            "K",
            1110,
            1130,
            TWIN + "as above.",
            basis,
        ),
        Claim(
            "error_steady",
            "5.2",
            "At steady state the difference is negligible, 0.2 %.",
            100 * float(np.nanmedian(steady)),
            "%",
            0.15,
            0.25,
            TWIN + "median of the last 50 s before the plasma goes off.",
            basis,
        ),
    ]


def spectrometer_claims(pyrometer, spectra):
    """Claims on the spectrometer. `spectra`: Dataset, contract 'spectrometer_correction'."""
    basis = _basis(spectra)
    begin = spectra.attrs.get("injection_time", 0.0)
    usable = (spectra.spectrum_status == 0).values & (spectra.spectrum_time > begin).values
    time = spectra.spectrum_time.values[usable]
    reading = spectra.spectrometer_temperature.values[usable]
    other = np.interp(time, pyrometer.time, pyrometer.corrected_temperature.interpolate_na("time"))
    return [
        Claim(
            "spectrometer_start",
            "5.3",
            "Before 16 s the spectra are too weak to give a temperature.",
            float(time[0]) if time.size else np.nan,
            "s",
            14,
            18,
            TWIN + "first spectrum whose fit is usable; depends on the twin's heating curve and noise.",
            basis,
        ),
        Claim(
            "instruments_agree",
            "5.3",
            "Pyrometer (corrected) and spectrometer agree closely.",
            100 * float(np.nanmedian(abs(reading / other - 1))) if time.size else np.nan,
            "%",
            0,
            1.5,
            TWIN + "median difference over all usable spectra; 'closely' read as within the stated 1.5 %.",
            basis,
        ),
    ]


def untestable_claims():
    """Claims that rest on data which are not public."""
    return [
        Claim(
            "power_efficiency",
            "4.1",
            "The simulated power is 35 to 40 % of the electric power (56 to 64 kW at 160 kW).",
            UNTESTABLE,
            "1",
            0.35,
            0.40,
            "Needs the measured gas temperatures of another work; no public data.",
            "untestable",
        ),
        Claim(
            "room_air",
            "2",
            "The air of the room hardly absorbs on a metre of path.",
            UNTESTABLE,
            "1",
            0.99,
            1,
            "Needs line strengths of O2 and H2O; the shapes of their bands at hand know no amount.",
            "untestable",
        ),
        Claim(
            "facility_figures",
            "3, 5.1",
            "Sketch, facility, spectrometer and photographs of the sample (figures 1, 2, 4a, 9a, 9c).",
            UNTESTABLE,
            "1",
            1,
            1,
            "Drawings and photographs: no computation makes them; figure 9b is the emittance as stated.",
            "untestable",
        ),
        Claim(
            "reference_spectrum",
            "5.3",
            "The measured reference spectrum compares with the simulations at 80 and 90 kW.",
            UNTESTABLE,
            "kW",
            80,
            90,
            "Needs the measured spectrum, which is not public; the twin's was made from a simulation.",
            "untestable",
        ),
    ]


def _basis(dataset):
    return "synthetic" if dataset.attrs.get("origin") == "synthetic" else "simulation"


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


def _highest_with_error_above(temperature, error, level, width=20.0):
    """Temperature [K] above which the error stays below `level`, from medians over bins of `width` [K].

    The crossing is read between the centres of the last bin above the level and the next one, linear in
    the logarithm of the error; NaN if no bin is above.
    """
    good = np.isfinite(temperature) & np.isfinite(error)
    bins = np.floor(temperature[good] / width)
    numbers = np.unique(bins)
    median = np.array([np.median(error[good][bins == number]) for number in numbers])
    centres = (numbers + 0.5) * width
    beyond = np.nonzero(median > level)[0]
    if not beyond.size:
        return np.nan
    pair = slice(beyond[-1], beyond[-1] + 2)
    return float(np.interp(-np.log(level), -np.log(median[pair]), centres[pair]))
