"""Temperature from the shape of a spectrum: least-squares fits of Planck's law."""

import numpy as np

from plasmapyro.radiation.planck import blackbody_radiance, radiance_and_inverse_slope

STEPS = 40  # Gauss-Newton steps allowed; a handful suffices from the starting grid
STEP_LIMIT = 0.1  # largest relative change of 1/T in one step
CONVERGED = 1e-7  # relative change of 1/T that ends the iteration: the next one changes 1e-4 K at most
STARTS = 24  # trial temperatures from which the best starts the iteration


def normalised(values, usable, pivot):
    """Values (R, W) over their mean in the pivot pixels (W,); NaN in rows where that is not > 0."""
    return values / _pivot_mean(values, usable, pivot)[:, None]


def _pivot_mean(values, usable, pivot):
    weight = usable & pivot
    count = weight.sum(axis=1)
    total = np.where(weight, values, 0.0).sum(axis=1)
    mean = total / np.maximum(count, 1)
    return np.where((count > 0) & (mean > 0), mean, np.nan)


def trial_curves(wavelength, temperature_range):
    """Temperatures (N,) [K], equidistant in 1/T, and their black bodies (N, W), for `nearest_trial`."""
    low, high = temperature_range
    temperature = 1 / np.linspace(1 / high, 1 / low, STARTS)
    return temperature, blackbody_radiance(wavelength, temperature[:, None])


def nearest_trial(trials, radiance, noise, usable):
    """Temperature (1,) [K] of `trial_curves` whose curve, of any scale, lies closest to a spectrum (W,)."""
    temperature, curves = trials
    weight = np.where(usable, 1 / np.where(usable, noise, 1.0) ** 2, 0.0)
    product = np.einsum("nw,w->n", curves, weight * np.where(usable, radiance, 0.0))
    power = np.einsum("nw,nw,w->n", curves, curves, weight)
    gain = np.sign(product) * _ratio(product**2, power)  # of the misfit, by the best scale
    return temperature[[np.argmax(gain)]]


def fit_normalised(wavelength, radiance, usable, pivot, temperature_range, start):
    r"""Temperatures (R,) [K] whose normalised Planck curves lie closest to the normalised spectra.

    .. math:: \min_T \sum_\lambda \left[\frac{L_\lambda}{L_{norm}}
              - \frac{L^{bb}_\lambda(T)}{L^{bb}_{norm}(T)}\right]^2

    Gauss-Newton in 1/T from `start` (R,) [K]. The `usable` pixels of `radiance`, both (R, W), enter; the rest
    may be NaN. The mean of the `pivot` pixels (W,) normalises. A fit that ends outside of `temperature_range`
    [K] is NaN.

    Source: Fagnani et al., sec. 5.3 (after Savino et al. 2020), normalised at 1.03 um. Deviation: the pivot
    may be the mean of the pixels of one resolution element instead of one pixel. The pivot is the weakest
    point of the method: its noise moves every point of the curve (`fit_scaled` has none).
    """
    data = normalised(radiance, usable, pivot)
    weight = (usable & np.isfinite(data)).astype(float)
    data = np.where(weight > 0, data, 0.0)

    def step(beta):
        shape, slope = radiance_and_inverse_slope(wavelength, beta)
        mean = _pivot_mean(shape, usable, pivot)[:, None]
        mean_slope = _pivot_mean(-shape * slope, usable, pivot)[:, None] / -mean
        curve = np.nan_to_num(shape / mean)
        derivative = curve * np.nan_to_num(slope - mean_slope)
        rest = data - curve
        return _ratio(np.sum(weight * derivative * rest, axis=1), np.sum(weight * derivative**2, axis=1))

    return _iterate(step, weight.sum(axis=1) >= 2, temperature_range, start)


def fit_scaled(wavelength, radiance, noise, usable, temperature_range, start):
    r"""Temperatures (R,) [K] and scales (R,) [1] of the Planck curves closest to spectra, weighed by noise.

    .. math:: \min_{T, s} \sum_\lambda \left[\frac{L_\lambda - s\,L^{bb}_\lambda(T)}{\sigma_\lambda}\right]^2

    The scale, the emittance as far as the absolute calibration holds, is eliminated at each temperature;
    Gauss-Newton in 1/T for the rest. `noise` (R, W) is > 0 where usable; the other arguments are as of
    `fit_normalised`.

    Deviation: not in the paper, which normalises at one wavelength.
    """
    good = usable & np.isfinite(radiance) & (noise > 0)
    weight = np.where(good, 1 / np.where(good, noise, 1.0) ** 2, 0.0)
    data = np.where(good, radiance, 0.0)

    def scale_of(shape):
        return _ratio(np.sum(weight * shape * data, axis=1), np.sum(weight * shape**2, axis=1))

    def step(beta):
        shape, slope = radiance_and_inverse_slope(wavelength, beta)
        scale = scale_of(shape)[:, None]
        derivative = scale * shape * slope
        # Take out of the derivative what a change of scale can do.
        share = _ratio(np.sum(weight * shape * derivative, axis=1), np.sum(weight * shape**2, axis=1))
        derivative = derivative - share[:, None] * shape
        rest = data - scale * shape
        return _ratio(np.sum(weight * derivative * rest, axis=1), np.sum(weight * derivative**2, axis=1))

    temperature = _iterate(step, good.sum(axis=1) >= 3, temperature_range, start)
    found = np.isfinite(temperature)
    scale = np.full(temperature.shape, np.nan)
    if found.any():
        shape, _ = radiance_and_inverse_slope(
            wavelength, 1 / np.where(found, temperature, temperature_range[0])
        )
        scale = np.where(found, scale_of(shape), np.nan)
    return temperature, scale


def _ratio(numerator, denominator):
    """Quotient, 0 where the denominator is 0 (a row without usable pixels stays where it is)."""
    return np.divide(numerator, denominator, out=np.zeros_like(numerator), where=denominator != 0)


def _iterate(step, good, temperature_range, start):
    """Temperatures (R,) at which the Gauss-Newton step vanishes; NaN where it does not settle."""
    low, high = (1 / float(value) for value in reversed(temperature_range))
    beta = np.clip(1 / np.asarray(start, dtype=float), low, high)
    for _ in range(STEPS):
        change = np.clip(step(beta) / beta, -STEP_LIMIT, STEP_LIMIT)
        # Room beyond the range, so that a fit on its edge is told from one that settles there.
        beta = np.clip(beta * (1 + change), low / 2, high * 2)
        settled = np.abs(change) < CONVERGED
        if settled.all():
            break
    inside = (beta >= low) & (beta <= high)
    return np.where(good & settled & inside, 1 / beta, np.nan)
