"""Stage of the joint estimate: a test and the calibrations in, surface temperature and gas out."""

import dataclasses

import numpy as np
import xarray as xr

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.estimate import noise
from plasmapyro.estimate.dynamics import GAS, RATE, SIZE, TEMPERATURE, Dynamics
from plasmapyro.estimate.observations import PyrometerData, SpectrometerData, constants
from plasmapyro.estimate.smoother import Chain, fit, spread_of
from plasmapyro.experiment import inputs, status
from plasmapyro.experiment.signals import phases
from plasmapyro.experiment.stage import CARRIED, calibrated_radiance
from plasmapyro.forward.model import GreyTable
from plasmapyro.forward.stage import BANDS, bin_pixels, forward_model
from plasmapyro.instrument.calibration import EXTRAPOLATED, VALID
from plasmapyro.instrument.spectrometer import local_noise

NORMAL_95 = 1.959964  # standard deviations of half a 95 % interval
FIRST_RATE = 0.1  # [K/s] standard deviation before injection: nothing heats the sample
KICK = 100.0  # [K/s] of the rate at injection and at the end of the plasma
START_DYNAMICS = {"quiet": 1e-2, "bending": 30.0, "memory": 15.0}  # where the search begins
GAS_START = 1e-3  # [1] the gas amplitude right after injection is 1 by definition
WIDE_PRIOR = 3.0  # [1] a gas level is known to this many times its first guess: left to the data
BEFORE_DEVIATION = 1.0  # [1] of the logarithm of the gas amplitude before injection, the same
NOISE_BLOCK = 50  # samples per noise estimate of the pyrometer
SHIFT = 0.5e-9  # [m] step of the derivative by the place of a response
FIRST_ROUNDS = 2  # of path and dynamics, before the noise is looked at again
TELLING = 1.0  # [s] span whose samples must tell the temperature by themselves
RESCALING = (0.2, 20.0)  # by how much residuals may correct the noise of a bin


def estimate(
    test,
    calibration,
    response,
    spectrometer_calibration=None,
    *,
    gas_drift,
    gas_flicker,
    gas_flicker_time,
    gas_change,
    band_shift_uncertainty,
    initial_temperature,
    initial_temperature_uncertainty,
    scale_uncertainty,
    bin_uncertainty,
    injection_time_span,
    plasma_off_time_span,
    least_surface_share,
    largest_uncertainty,
    saturation_counts,
    noise_block,
    instruments=("pyrometer", "spectrometer"),
):
    """Surface temperature of a test from both bands in absolute units and, if present, the spectra.

    Parameters
    ----------
    test : Dataset, contract 'test'
        With the pyrometer; spectra are used if there are any.
    calibration : Dataset, contract 'calibration'
    response : Dataset, contract 'response'
    spectrometer_calibration : Dataset, contract 'spectrometer_calibration', optional
        Needed for counts.
    gas_drift : float [1]
        Standard deviation of the slow change of the gas light from injection to the end of the plasma.
    gas_flicker, gas_flicker_time : float [1], [s]
        Used only if the bands do not tell.
    gas_change : float [1]
        Relative change of colour of the gas when the probe comes in.
    band_shift_uncertainty : float [m]
        Of the place of each response on the wavelength axis.
    initial_temperature, initial_temperature_uncertainty : float [K]
        Of the surface at injection.
    scale_uncertainty, bin_uncertainty : float [1]
        Of the spectrometer: common to all wavelengths (what lies in its view), and of each bin.
    injection_time_span, plasma_off_time_span : float [s]
        Left out before injection and after the end of the plasma.
    least_surface_share : float [1]
        If the surface gives less in both bands, the status says that the gas dominates.
    largest_uncertainty : float [1]
        Beyond this relative standard uncertainty there is no temperature.
    saturation_counts : float [count]
    noise_block : int
        Pixels per noise estimate of the spectrometer.
    instruments : names of those to use; without 'spectrometer' its data are left aside.

    Returns
    -------
    Dataset, contract 'joint_estimate'

    Raises
    ------
    ValueError
        Naming every fault of the test, or if the iteration does not converge.

    Notes
    -----
    Not in the paper; method and reasons in docs/estimator.md.
    """
    test = inputs.require(test, "pyrometer")
    time, off = test.time.values, test.attrs["plasma_off_time"]
    injection = test.attrs["injection_time"]
    injected, shining = phases(time, injection, off)
    shining = time <= off
    has_spectra = "spectrometer" in inputs.instruments(test) and "spectrometer" in instruments
    pixels = test.wavelength.values if has_spectra else None
    model = forward_model(response, calibration, {}, pixels)
    switched = _switching(time, injection, off, injection_time_span, plasma_off_time_span)
    raw = np.stack([test[f"signal_{band}"].values for band in BANDS]).astype(float)
    signal = np.where(switched, np.nan, raw)
    moved = forward_model(response.assign_coords(wavelength=response.wavelength + SHIFT), calibration, {})
    tables = GreyTable(model["pyrometer"]), GreyTable(moved["pyrometer"])
    pyrometer = _pyrometer_data(signal, calibration, *tables, injected, shining)
    deviation, correlation = _flicker(test, time, signal, injection - injection_time_span)
    if np.isnan(deviation):
        deviation, correlation = gas_flicker, gas_flicker_time
    fixed, path = _first_guess(
        test, time, pyrometer, calibration, gas_change, (initial_temperature, injection, off)
    )
    fixed = fixed + constants("band_shift", np.zeros(2), max(band_shift_uncertainty, 1e-15))
    observations = [pyrometer]
    if pixels is not None:
        radiance, _ = calibrated_radiance(test, spectrometer_calibration, saturation_counts)
        exposure = test.attrs["spectrometer_integration_time"]
        spectra = _spectrometer_data(
            test,
            radiance,
            model["spectrometer"],
            spectrometer_calibration,
            _mean_flicker(deviation, correlation, exposure),
            noise_block,
            (injection_time_span, plasma_off_time_span),
        )
        if spectra is not None:
            observations.append(spectra)
            fixed = fixed + _spectrometer_constants(spectra, scale_uncertainty, bin_uncertainty, gas_change)
    chain = Chain(
        time,
        (injection, off),
        injection,
        np.array([initial_temperature, 0.0, path[0, GAS], 0.0]),
        np.diag(
            [
                initial_temperature_uncertainty**2,
                FIRST_RATE**2 if time[0] < injection else KICK**2,
                BEFORE_DEVIATION**2 if time[0] < injection else GAS_START**2,
                deviation**2,
            ]
        ),
    )
    dynamics = Dynamics(
        **START_DYNAMICS,
        kick=KICK,
        gas=gas_drift**2 / (off - injection),
        gas_start=GAS_START,
        flicker=deviation,
        flicker_time=correlation,
    )
    found = fit(chain, observations, fixed, dynamics, path, fixed.mean.copy(), FIRST_ROUNDS)
    # Second pass with the noise that the residuals show: lines inflate the first guess of their bins.
    observations = [rescaled(one, found, fixed) for one in observations]
    found = fit(chain, observations, fixed, found.dynamics, found.path, found.values, 1)
    if not found.converged:
        raise ValueError(f"the joint estimate did not converge in {found.steps} steps")
    spread = spread_of(chain, observations, fixed, found)
    limits = least_surface_share, largest_uncertainty
    return _dataset(test, calibration, observations, fixed, found, spread, raw, injected, limits)


def _switching(time, injection, off, before, after):
    """Samples in which the probe moves in, or the plasma dies."""
    return ((time >= injection - before) & (time < injection)) | ((time > off) & (time <= off + after))


def _pyrometer_data(signal, calibration, table, shifted, injected, shining):
    floor, relative = noise.signal_noise(signal, NOISE_BLOCK)
    level = np.stack([noise.smoothed(row, 11) for row in signal])
    spread = np.hypot(floor[:, None], relative[:, None] * level)
    least = np.nanmedian(spread, axis=1, keepdims=True) * 1e-6
    value, slope, _ = table(calibration.source_temperature.values)
    moved = shifted(calibration.source_temperature.values)[0]
    return PyrometerData(
        signal,
        np.maximum(spread, least),
        injected,
        shining,
        table,
        (slope / value).mean(axis=0),
        shifted,
        SHIFT,
        np.log(moved / value).mean(axis=0) / SHIFT,
    )


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


def _flicker(test, time, signal, before):
    low, high = test.attrs["reference_window"]
    return noise.flicker(time, signal, [time < before, (time >= low) & (time <= high)])


def _mean_flicker(deviation, correlation, exposure):
    """Standard deviation of the mean over an exposure of an Ornstein-Uhlenbeck flicker."""
    x = exposure / correlation
    return deviation * np.sqrt(2 / x * (1 + np.expm1(-x) / x))


def _first_guess(test, time, data, calibration, gas_change, known):
    """Constants of the pyrometer, and a path from the narrow band less its reference signal."""
    initial, injection, off = known
    low, high = test.attrs["reference_window"]
    window = (time >= low) & (time <= high) & data.injected & data.shining
    gas = np.nanmedian(data.signal[:, window], axis=1)
    gas = np.maximum(gas, np.nanmedian(data.noise[:, window], axis=1))
    emittance = test.attrs["emittance"]
    spread = max(test.attrs["emittance_uncertainty"] / emittance, 1e-6)
    source, own = gain_uncertainties(calibration, data.source_slope)
    fixed = (
        constants("log_emittance", np.log(emittance), spread)
        + constants("source_error", 0.0, max(source, 1e-6))
        + constants("gain_error", np.zeros(2), np.maximum(own, 1e-6))
        + constants("gas_signal", gas, WIDE_PRIOR * gas)
        + constants("gas_signal_before", np.zeros(2), max(gas_change, 1e-6))
    )
    narrow = noise.smoothed(data.signal[1], 31)
    surface = narrow - np.where(data.shining, gas[1], 0.0)
    clear = data.injected & (surface > np.where(data.shining, 0.3 * gas[1], 10 * data.noise[1]))
    grid = 1 / np.linspace(1 / 3900.0, 1 / 250.0, 500)
    curve = np.log(emittance * data.table(grid)[0][:, 1])
    guess = 1 / np.interp(np.log(np.where(clear, surface, np.nan)), curve[::-1], 1 / grid[::-1])
    knots = np.append(clear & np.isfinite(guess), False)[:-1]
    axis, values = np.append(injection, time[knots]), np.append(initial, guess[knots])
    path = np.zeros((time.size, SIZE))
    path[:, TEMPERATURE] = np.where(data.injected, np.interp(time, axis, values), initial)
    path[:, RATE] = np.where(data.injected, np.gradient(path[:, TEMPERATURE], time), 0.0)
    before = np.nanmedian(data.signal[0, ~data.injected]) if (~data.injected).any() else np.nan
    if np.isfinite(before) and before > 0:
        path[~data.injected, GAS] = np.log(before / gas[0])
    return fixed, path


def _spectrometer_data(test, radiance, instrument, calibration, flicker, noise_block, spans):
    """Means of the bins; None if no exposure is of use."""
    time, middle = test.time.values, test.spectrum_time.values
    injection, off = test.attrs["injection_time"], test.attrs["plasma_off_time"]
    half = test.attrs["spectrometer_integration_time"] / 2
    usable = np.isfinite(radiance)
    own = local_noise(radiance, noise_block)
    mean, count = bin_pixels(test.wavelength.values, radiance, usable, instrument.edges)
    square, _ = bin_pixels(test.wavelength.values, own**2, usable & np.isfinite(own), instrument.edges)
    spread = np.sqrt(square / np.maximum(count, 1))
    apart = (
        ((middle - half >= injection) & (middle + half <= off))
        | (middle + half <= injection - spans[0])
        | (middle - half >= off + spans[1])
    )
    inside = (middle >= time[0]) & (middle <= time[-1]) & apart
    mean[~inside] = np.nan
    mean[~(spread > 0)] = np.nan
    good = np.isfinite(mean).any(axis=0)
    if not good.any():
        return None
    place = np.clip(np.searchsorted(time, middle), 1, time.size - 1)
    place = place - (middle - time[place - 1] < time[place] - middle)
    source = SECOND_RADIATION / instrument.wavelength
    if calibration is not None:
        source = source / float(calibration.source_temperature) ** 2
    return SpectrometerData(
        place,
        middle - time[place],
        2 * half,
        mean[:, good],
        np.where(np.isfinite(mean), spread, 1.0)[:, good],
        middle >= injection,
        middle <= off,
        GreyTable(_of_pixels(instrument, test.wavelength.values, usable.any(axis=0), good)),
        source[good] if calibration is not None else np.zeros(good.sum()),
        flicker,
    )


def _of_pixels(instrument, pixels, usable, good):
    """The spectrometer with its pixels as bins: Planck's law is then averaged as the data are."""
    from plasmapyro.forward.bins import pixel_bins

    step = (pixels[1:] + pixels[:-1]) / 2
    edges = np.concatenate([[2 * pixels[0] - step[0]], step, [2 * pixels[-1] - step[-1]]])
    belongs = pixel_bins(pixels, instrument.edges) == np.arange(instrument.edges.size - 1)[:, None]
    weight = (belongs & usable).astype(float)
    return dataclasses.replace(
        instrument,
        edges=edges,
        channel=instrument.channel[good],
        weight=(weight / np.maximum(weight.sum(axis=1, keepdims=True), 1))[good],
    )


def _spectrometer_constants(data, scale_uncertainty, bin_uncertainty, gas_change):
    """Constants of the spectrometer; the gas spectrum starts from the exposures with the coldest surface."""
    injected = np.flatnonzero(data.injected & data.shining & np.isfinite(data.radiance).any(axis=1))
    before = np.flatnonzero(~data.injected & np.isfinite(data.radiance).any(axis=1))
    early = injected[:2] if injected.size else before
    gas = np.nanmean(data.radiance[early], axis=0) if early.size else np.nanmin(data.radiance, axis=0)
    floor = np.nanmedian(data.noise, axis=0)
    gas = np.where(np.isfinite(gas), gas, floor)
    gas = np.where(np.abs(gas) > floor, gas, floor)
    count = gas.size
    return (
        constants("scale_error", 0.0, max(scale_uncertainty, 1e-6))
        + constants("bin_error", np.zeros(count), max(bin_uncertainty, 1e-6))
        + constants("gas_radiance", gas, WIDE_PRIOR * np.abs(gas))
        + constants("gas_radiance_before", np.zeros(count), max(gas_change, 1e-6))
    )


def rescaled(data, found, fixed):
    """Data whose noise, in each band or bin, is that of their residuals."""
    residual = data.residual(found.path, found.values, fixed.where)
    axis = 1 if isinstance(data, PyrometerData) else 0
    scale = noise.NORMAL_MAD * np.nanmedian(np.abs(residual), axis=axis, keepdims=True)
    scale = np.clip(np.where(np.isfinite(scale), scale, 1.0), *RESCALING)
    return dataclasses.replace(data, noise=data.noise * scale)


def _told(time, told, temperature, largest):
    """Where the samples within `TELLING` fix the temperature by themselves: continuity is no measurement."""
    total = np.concatenate([[0.0], np.cumsum(told)])
    first, last = (np.searchsorted(time, time + shift) for shift in (-TELLING / 2, TELLING / 2))
    return (total[last] - total[first]) * (largest * temperature) ** 2 > 1


def _dataset(test, calibration, observations, fixed, found, spread, raw, injected, limits):
    time, of = test.time.values, fixed.where
    temperature = found.path[:, TEMPERATURE]
    deviation = np.sqrt(spread.path[:, TEMPERATURE, TEMPERATURE])
    least_share, largest = limits
    surface, gas, _ = observations[0].predict(found.path, found.values, of)
    share = surface / (surface + gas)
    known = injected & (deviation < largest * temperature) & _told(time, spread.told, temperature, largest)
    low, high = calibration.fit_range.values
    state = np.where((temperature < low) | (temperature > high), EXTRAPOLATED, VALID).astype("int8")
    state[(share < least_share).all(axis=0)] = status.GAS_DOMINATED
    state[np.isnan(raw).all(axis=0)] = status.MISSING
    state[~known] = status.NO_SIGNAL
    state[~injected] = status.NOT_INJECTED
    factor = np.exp(NORMAL_95 * deviation / temperature)
    amplitude = np.where(observations[0].shining, np.exp(found.path[:, GAS]), 0.0)
    of_constants = np.sqrt(np.diag(spread.constants))
    emittance = float(np.exp(found.values[of("log_emittance")[0]]))
    gains = found.values[of("gain_error")] - observations[0].source_slope * found.values[of("source_error")]
    direction = np.zeros((2, fixed.mean.size))
    direction[np.arange(2), of("gain_error")] = 1.0
    direction[:, of("source_error")[0]] = -observations[0].source_slope
    gain_variance = np.einsum("bi,ij,bj->b", direction, spread.constants, direction)
    return xr.Dataset(
        {
            "surface_temperature": ("time", np.where(known, temperature, np.nan)),
            "surface_temperature_uncertainty": ("time", np.where(known, deviation, np.nan)),
            "surface_temperature_interval": (
                ("bound", "time"),
                np.where(known, np.stack([temperature / factor, temperature * factor]), np.nan),
            ),
            "estimate_status": ("time", state, status.flags()),
            "estimated_surface_share": (("band", "time"), np.where(injected, share, np.nan)),
            "gas_amplitude": ("time", amplitude),
            "gas_amplitude_uncertainty": (
                "time",
                amplitude * np.sqrt(spread.path[:, GAS, GAS]),
            ),
            "gas_current": ("band", found.values[of("gas_signal")]),
            "gas_current_uncertainty": ("band", of_constants[of("gas_signal")]),
            "estimated_emittance": emittance,
            "estimated_emittance_uncertainty": emittance * float(of_constants[of("log_emittance")[0]]),
            "gain_correction": ("band", np.expm1(gains)),
            "gain_correction_uncertainty": ("band", np.sqrt(gain_variance)),
            "whitened_residual": (("band", "time"), observations[0].residual(found.path, found.values, of)),
        },
        {"time": time, "band": list(BANDS)},
        {name: test.attrs[name] for name in CARRIED if name in test.attrs}
        | {
            "instruments": " ".join(["pyrometer", "spectrometer"][: len(observations)]),
            "steps": found.steps,
            "gas_flicker": float(found.dynamics.flicker),
            "gas_flicker_time": float(found.dynamics.flicker_time),
        }
        | {
            f"dynamics_{name}": float(getattr(found.dynamics, name))
            for name in ("quiet", "bending", "memory")
        },
    )
