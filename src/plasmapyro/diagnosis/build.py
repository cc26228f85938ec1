"""From a test, its calibrations and the gas spectra to instruments on bins and the base model."""

import numpy as np

from plasmapyro.diagnosis import binning, observation
from plasmapyro.diagnosis.model import History, Model, Parameter, knots
from plasmapyro.diagnosis.observation import Instrument
from plasmapyro.diagnosis.scene import planck_and_slope
from plasmapyro.diagnosis.templates import BANDS_OF
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.instrument.spectrometer import USABLE, measured_radiance

SATURATION = 65000.0  # [count]
UNIFORM = np.sqrt(3)  # half width of a uniform law over its standard deviation
DARK_COUNTS = 8.0  # [count] ASSUME: error of the background of a pixel: 25 counts of noise, some ten scans
PATTERN_MARGIN = 1.3  # [1]: the noise of the calibration is itself estimated, from few pixels
POWER_SIGMA = 0.08  # [1] of ln P: the efficiency 0.375 +- 0.025 of the paper and the scatter of the field
GROUP_SIGMA = 0.08  # [1] of the strength of a group of lines, cf. `component_uncertainty`
SEQUENCE_SIGMA = 0.02  # [1] of one sequence of N2 1P against the others: they share one transition moment
GAS_SIGMA = 0.15  # [1] of the brightness of the gas as a whole
BEFORE = (np.log(1.6), 0.35)  # brightness before injection over after it, logarithm: the jet flows free
GAIN_SIGMA = 0.02  # [1] of each instrument between calibration and test


def base_model(test, library, calibration, response, spectrometer_calibration=None):
    """Instruments on bins and the base model of a test.

    Parameters
    ----------
    test : Dataset, contract 'test', without faults
    library : GasLibrary of its condition
    calibration : Dataset, contract 'calibration', or None without a pyrometer
    response : Dataset, contract 'response'
    spectrometer_calibration : Dataset, contract 'spectrometer_calibration', or None

    Returns
    -------
    Model
    """
    edges = observation.time_bins(test)
    injection, off = (float(test.attrs[name]) for name in ("injection_time", "plasma_off_time"))
    response_arrays = (
        response["wavelength"].values,
        [response[f"responsivity_{band}"].values for band in ("wide", "narrow")],
    )
    instruments, lamp = [], {}
    if "signal_wide" in test.variables and calibration is not None:
        instruments.append(_pyrometer(test, calibration, response_arrays, library, edges))
        lamp["pyrometer"] = _lamp_of_pyrometer(calibration, response_arrays)
    if "spectral_radiance" in test.variables or "counts" in test.variables:
        instruments.append(_spectrometer(test, spectrometer_calibration, library, edges))
        lamp["spectrometer"] = _lamp_of_spectrometer(instruments[-1], spectrometer_calibration)
    end = max(one.moment.max() for one in instruments)
    history = History(knots(edges, injection, off, end), off)
    emittance = float(test.attrs["emittance"])
    parameters = base_parameters(test, calibration, library, emittance)
    return Model(instruments, library, history, parameters, off, emittance, response_arrays, lamp)


def base_parameters(test, calibration, library, emittance):
    """The parameters of the base model with their priors."""
    ratio = 0.005
    if calibration is not None:
        ratio = float(calibration.sensitivity_ratio_uncertainty / calibration.sensitivity_ratio)
    source = 3.0 / UNIFORM
    return (
        Parameter("emittance", "emittance", float(test.attrs["emittance_uncertainty"]) / emittance),
        Parameter("gain_pyrometer", "throughput of the pyrometer", GAIN_SIGMA),
        Parameter("gain_spectrometer", "throughput of the spectrometer", GAIN_SIGMA),
        Parameter("ratio", "sensitivity ratio", ratio),
        Parameter("lamp", "temperature of the calibration source", source, "K"),
        Parameter("power", "simulated power (logarithm)", POWER_SIGMA),
        Parameter("gas", "brightness of the gas (logarithm)", GAS_SIGMA),
        Parameter(
            "before_injection", "gas before over after injection (logarithm)", BEFORE[1], "1", BEFORE[0]
        ),
        *(
            Parameter(f"group:{name}", f"strength of {name}", group_sigma(name))
            for name in library.group_name
        ),
        Parameter(f"system:{BANDS_OF}", f"strength of {BANDS_OF}", GROUP_SIGMA),
    )


def group_sigma(group):
    """Prior standard deviation of the logarithm of the strength of a group of lines [1]."""
    return SEQUENCE_SIGMA if group.startswith(BANDS_OF) else GROUP_SIGMA


def _pyrometer(test, calibration, response, library, edges):
    time = test["time"].values
    half = float(test.attrs["pyrometer_integration_time"]) / 2
    injection, off = float(test.attrs["injection_time"]), float(test.attrs["plasma_off_time"])
    index = binning.membership(time - half, time + half, edges, injection, off)
    raw = np.stack([test["signal_wide"].values, test["signal_narrow"].values], axis=1)
    index = observation.without_lost(index, raw)
    moment, count = observation.instants(time - half, time + half, index, edges.size - 1)
    value, number = binning.mean_in_bins(raw, index, edges.size - 1)
    kept = count > 0
    renumber = np.where(kept, np.cumsum(kept) - 1, -1)
    axis, curves = response
    nodes, centres = observation.band_nodes(axis, curves)
    weight = np.zeros((2, 2 * centres.size))
    maps = []
    for band, curve in enumerate(curves):
        weight[band, band * centres.size : (band + 1) * centres.size] = observation.band_weights(
            nodes, axis, curve
        )
        maps.append(observation.band_gas_map(nodes, library.wavelength, axis, curve))
    return Instrument(
        kind="pyrometer",
        moment=moment[kept],
        value=value[kept],
        number=number[kept],
        wavelength=np.tile(centres, 2),
        weight=weight,
        gain=calibration["absolute_sensitivity"].values.astype(float),
        gas_map=observation.side_by_side(maps),
        node_edges=nodes,
        factor=None,
        pixel_edges=None,
        raw=raw,
        raw_moment=np.stack([time - half / UNIFORM, time + half / UNIFORM], axis=1),
        raw_bin=np.where(index >= 0, renumber[index], -1),
        raw_clean=np.isfinite(raw),
        pattern=np.zeros(2),
        dark=np.zeros(2),
    )


def _spectrometer(test, calibration, library, edges):
    time = test["spectrum_time"].values
    half = float(test.attrs["spectrometer_integration_time"]) / 2
    injection, off = float(test.attrs["injection_time"]), float(test.attrs["plasma_off_time"])
    index = binning.membership(time - half, time + half, edges, injection, off)
    wavelength = test["wavelength"].values
    saturated = np.zeros((time.size, wavelength.size), dtype=bool)
    if "counts" in test.variables:
        counts = test["counts"].values.astype(float)
        saturated = counts >= SATURATION
        factor = calibration["calibration_factor"].values / (2 * half)
        radiance = measured_radiance(
            np.where(saturated, np.nan, counts),
            test["background_counts"].values,
            calibration["calibration_factor"].values,
            2 * half,
        )
    else:
        radiance = test["spectral_radiance"].values.astype(float)
        factor = np.ones(wavelength.size)
    relative = np.zeros(wavelength.size)
    if calibration is not None:
        good = calibration["pixel_status"].values == USABLE
        radiance = np.where(good, radiance, np.nan)
        relative = np.nan_to_num(calibration["calibration_factor_uncertainty"].values)
        factor = np.where(good, factor, np.nan)
    inside = (wavelength > library.wavelength[3]) & (wavelength < library.wavelength[-4])
    usable = np.isfinite(radiance).mean(axis=0) > 0.5
    chosen = np.flatnonzero(inside & usable)
    radiance, wavelength, factor, relative = (
        radiance[:, chosen],
        wavelength[chosen],
        factor[chosen],
        relative[chosen],
    )
    fwhm = float(test.attrs["spectrometer_fwhm"])
    seen = np.interp(wavelength, library.wavelength, library.base)
    pixels = binning.pixel_edges(wavelength, seen, fwhm)
    raw, number_of_pixels = observation.in_pixel_bins(radiance, pixels)
    in_bin = number_of_pixels.max(axis=0)
    # The mean of some pixels of a bin is that of another wavelength.
    raw = np.where(number_of_pixels == in_bin, raw, np.nan)
    index = observation.without_lost(index, np.where(saturated[:, chosen], 0.0, radiance))
    raw = np.where(observation.beside_saturation(saturated[:, chosen], index, pixels), np.nan, raw)
    moment, count = observation.instants(time - half, time + half, index, edges.size - 1)
    value, number = binning.mean_in_bins(raw, index, edges.size - 1)
    kept = count > 0
    renumber = np.where(kept, np.cumsum(kept) - 1, -1)
    centres, _ = observation.in_pixel_bins(wavelength, pixels)
    binned_factor, _ = observation.in_pixel_bins(factor, pixels)
    pattern, _ = observation.in_pixel_bins(relative, pixels)
    return Instrument(
        kind="spectrometer",
        moment=moment[kept],
        value=value[kept],
        number=number[kept],
        wavelength=centres,
        weight=None,
        gain=np.ones(centres.size),
        gas_map=observation.pixel_gas_map(library.wavelength, wavelength, pixels),
        node_edges=None,
        factor=binned_factor,
        pixel_edges=pixels,
        raw=raw,
        raw_moment=np.stack([time - half / UNIFORM, time + half / UNIFORM], axis=1),
        raw_bin=np.where(index >= 0, renumber[index], -1),
        raw_clean=np.isfinite(raw),
        pattern=PATTERN_MARGIN * np.maximum(pattern, 1e-4) / np.sqrt(in_bin),
        dark=np.full(centres.size, DARK_COUNTS) * binned_factor / np.sqrt(in_bin),
    )


def _lamp_of_pyrometer(calibration, response):
    """Relative change (2,) of the sensitivities per kelvin of the source [K-1]."""
    source = calibration["source_temperature"].values
    step = 0.5
    return np.array(
        [
            np.mean(
                np.log(
                    blackbody_signal(source + step, response[0], curve)
                    / blackbody_signal(source - step, response[0], curve)
                )
            )
            / (2 * step)
            for curve in response[1]
        ]
    )


def _lamp_of_spectrometer(instrument, calibration):
    """Relative change (P,) of the calibration factor per kelvin of the source [K-1]."""
    if calibration is None:
        return np.zeros(instrument.wavelength.size)
    source = np.array([float(calibration["source_temperature"])])
    body, slope = planck_and_slope(instrument.wavelength, source)
    return (slope / body)[0]
