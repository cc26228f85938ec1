"""One exposure of the spectrometer: how good it is, its temperatures, and their uncertainties."""

from typing import NamedTuple

import numpy as np

from plasmapyro.experiment.curves import fit_normalised_near, fit_scaled_near, local_curves
from plasmapyro.experiment.spectra import fit_normalised, fit_scaled, nearest_trial, normalised
from plasmapyro.instrument.calibration import spread
from plasmapyro.instrument.scale import scale_draws
from plasmapyro.radiation.planck import blackbody_radiance


class FrameFit(NamedTuple):
    """Results of one exposure; all NaN if one of the two fits failed, or an uncertainty has no end."""

    temperature: float = np.nan  # [K] normalised fit
    temperature_uncertainty: float = np.nan
    scaled_temperature: float = np.nan  # [K] fit with a free scale
    scaled_temperature_uncertainty: float = np.nan
    scale: float = np.nan  # [1]
    scale_uncertainty: float = np.nan


def pivot_signal_to_noise(corrected, noise, gas_error, chosen):
    r"""Mean corrected radiance of the `chosen` pivot pixels over its standard uncertainty, (S,) [1].

    .. math:: u^2 = \frac1{N^2}\sum_n \sigma_n^2 + \Big(\frac1N \sum_n v L^{ref}_n\Big)^2

    The noise of N pixels averages out, the level of the gas does not. Arguments (S, W); NaN without a usable
    pixel.
    """
    count = np.maximum(chosen.sum(axis=1), 1)

    def total(values):
        return np.where(chosen, values, 0.0).sum(axis=1)

    spread_of_mean = np.hypot(np.sqrt(total(noise**2)), total(gas_error)) / count
    mean = total(corrected) / count
    return np.where(chosen.any(axis=1), mean / np.where(spread_of_mean > 0, spread_of_mean, np.nan), np.nan)


def factor_errors(wavelength, source_temperature, source_uncertainty, factor_uncertainty, draws, generator):
    r"""Draws (draws, W) [1] of the relative error of the calibration factor, common to all exposures.

    .. math:: \delta f = \frac{L^{bb}(T_s + \delta T)}{L^{bb}(T_s)} - 1 + \delta_\lambda + s(\lambda)

    with the relative `factor_uncertainty` (W,) from counting noise, NaN in unusable pixels, and the smooth
    error s of `scale_draws`. Deviation: the paper names neither.
    """
    actual = source_temperature + source_uncertainty * generator.standard_normal((draws, 1))
    bias = blackbody_radiance(wavelength, actual) / blackbody_radiance(wavelength, source_temperature) - 1
    own = np.nan_to_num(factor_uncertainty) * generator.standard_normal((draws, wavelength.size))
    return bias + own + scale_draws(wavelength, draws, generator)


def fit_frame(
    wavelength,
    corrected,
    noise,
    gas,
    usable,
    pivot,
    trials,
    temperature_range,
    gas_variation,
    factor_error,
    gas_level,
    generator,
):
    """Both Planck fits of one corrected spectrum, with Monte Carlo uncertainties: a FrameFit.

    Every draw takes its own noise, its own calibration factor and its own level of the gas, and is fitted
    anew. The spectrum `corrected`, its `noise` and the `gas` that was taken away, 0 if none was, are (W,)
    [W m-2 sr-1 m-1] at `wavelength` [m]; `usable` and `pivot` (W,) say which pixels enter; `trials` are as of
    `spectra.trial_curves`. `gas_variation` [1] enters the weights of the scaled fit: pixels with strong gas
    lines count less. `factor_error` (D, W) or (D, 1) and `gas_level` (D, 1) are draws of the relative error
    of the calibration factor and of the relative change of the gas since the reference spectrum.

    Source: Fagnani et al., sec. 3.2 (Monte Carlo through every step) and 5.3.
    """
    mask, weight = usable[None], np.hypot(noise, gas_variation * gas)[None]
    start = nearest_trial(trials, corrected, weight[0], usable)
    (scaled,), (scale,) = fit_scaled(wavelength, corrected[None], weight, mask, temperature_range, start)
    if np.isnan(scaled):
        return FrameFit()
    begin = np.array([scaled])
    (best,) = fit_normalised(wavelength, corrected[None], mask, pivot, temperature_range, begin)
    if np.isnan(best):
        return FrameFit()
    drawn = np.where(usable, corrected, 0.0) * (1 + factor_error)
    drawn += np.where(usable, noise, 0.0) * generator.standard_normal(drawn.shape)
    drawn -= gas_level * np.where(usable, gas, 0.0)
    curves = local_curves(wavelength, best)
    temperatures = fit_normalised_near(curves, drawn, usable, pivot, best)
    far = _beyond(temperatures, temperature_range)
    # Draws that leave the table are fitted without it.
    if far.size:
        every, begin = np.broadcast_to(mask, (far.size, usable.size)), np.full(far.size, best)
        temperatures[far] = fit_normalised(wavelength, drawn[far], every, pivot, temperature_range, begin)
    scaled_ones, scales = fit_scaled_near(curves, drawn, weight[0], usable, best)
    far = _beyond(scaled_ones, temperature_range)
    if far.size:
        every, weights = (np.broadcast_to(row, (far.size, usable.size)) for row in (mask, weight))
        begin = np.full(far.size, scaled)
        scaled_ones[far], scales[far] = fit_scaled(
            wavelength, drawn[far], weights, every, temperature_range, begin
        )
    fit = FrameFit(best, spread(temperatures), scaled, spread(scaled_ones), scale, spread(scales))
    return fit if np.isfinite(fit).all() else FrameFit()


def _beyond(temperature, temperature_range):
    """Indices of the temperatures that are none, or outside the range."""
    low, high = temperature_range
    return np.flatnonzero(~((temperature >= low) & (temperature <= high)))


def fitted_curve(wavelength, temperature, usable, pivot):
    """Black body (S, W) at each temperature (S,) [K] over its mean at the pivot pixels; NaN for NaN."""
    curve = np.full(usable.shape, np.nan)
    found = np.isfinite(temperature)
    if found.any():
        body = blackbody_radiance(wavelength, temperature[found][:, None])
        curve[found] = normalised(body, usable[found], pivot)
    return curve
