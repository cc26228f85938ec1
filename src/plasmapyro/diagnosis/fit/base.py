"""The base fit: first with round numbers for the noise, then with the noise that the data show."""

from dataclasses import dataclass, replace

import numpy as np

from plasmapyro import progress
from plasmapyro.diagnosis.fit import first_gas, outliers
from plasmapyro.diagnosis.fit import noise as noises
from plasmapyro.diagnosis.fit.inference import Fitter, Solution
from plasmapyro.diagnosis.fit.model import INITIAL_TEMPERATURE, Model
from plasmapyro.diagnosis.fit.persistent import unresolved
from plasmapyro.diagnosis.fit.restless import darker, rougher, steadier, wandering
from plasmapyro.record import binning

RESTLESS = 3  # fits at most with a gas that wanders, or series that are rough, more and more
DARKER = 0.9  # [1] of the uncertainty of darks, below which they are fitted as so well known
SLOW = 4.0  # [s]: flicker that lasts longer tells of the minutes
START_TIME = 14.0  # [s] of the first guess of the temperature
LEAST_GUESS, MOST_GUESS = 400.0, 3500.0  # [K]
SEEN, LEAST_SEEN = 0.2, 4  # [1], of the gas: light of the surface that tells a temperature, so many times


@dataclass(frozen=True)
class Base:
    """Model with cleaned data, noise, fitter and the fit."""

    model: Model
    noise_models: tuple
    fitter: Fitter
    solution: Solution


def guess_temperature(model):
    """First temperatures of the knots (K,) [K], from the light of an instrument less that of the gas: of the
    one that sees the surface most often.

    Before the surface outshines a part of the gas, a parabola that starts at the first temperature of the
    model; where it never does, a rise to the temperature at which it would.
    """
    knots = model.history.knots
    (time, found), limit = seen_by_most(model)
    if time.size < LEAST_SEEN and model.history.cold:
        return INITIAL_TEMPERATURE + (limit - INITIAL_TEMPERATURE) * -np.expm1(
            -np.maximum(knots, 0) / START_TIME
        )
    result = np.interp(knots, time, found)
    early = (knots < time[0]) & model.history.cold
    result[early] = INITIAL_TEMPERATURE + (found[0] - INITIAL_TEMPERATURE) * (
        1 - (1 - knots[early] / time[0]) ** 1.5
    )
    return np.clip(result, 300.0, MOST_GUESS)


def seen_by_most(model, samples=False):
    """Times and temperatures at which the instrument that sees the surface most often does so, in bins or in
    single `samples`, and the temperature at which it begins to [K]."""
    seen = [_seen(model, which, samples) for which in range(len(model.instruments))]
    return max(seen, key=lambda one: one[0][0].size)


def _seen(model, which, samples):
    one, knots = model.instruments[which], model.history.knots
    share = 1.0 if one.factor is None else 1 / one.factor
    values = np.array([parameter.centre for parameter in model.parameters])
    middle = one.time
    burning = (middle > 0) & (middle < model.off)
    ladder = np.linspace(LEAST_GUESS, MOST_GUESS, 60)
    dark = int(np.argmax(middle >= model.off)) if (middle >= model.off).any() else middle.size - 1
    flat = [
        np.sum((model.evaluate(which, np.full(knots.size, kelvin), values) * share)[dark])
        for kelvin in (INITIAL_TEMPERATURE, *ladder)
    ]
    table = np.log(np.maximum(np.array(flat[1:]) - (flat[0] if burning[dark] else 0.0), 1e-300))
    seen = one.raw if samples else one.value
    total = np.nansum(seen * share, axis=1)
    total[~np.isfinite(seen).all(axis=1)] = np.nan
    if samples:
        middle = one.raw_moment.mean(axis=1)
        total[one.raw_bin < 0] = np.nan
        burning = (middle > 0) & (middle < model.off)
    reference = model.record.in_window(middle)
    gas = _median(total[reference]) if reference.any() else np.nanmin(total[burning], initial=np.inf)
    gas = np.where(burning & model.plasma, gas if np.isfinite(gas) else 0.0, 0.0)
    light = total - gas
    seen = np.flatnonzero((middle > 0) & (light > SEEN * gas.max(initial=0.0)) & (light > 0))
    limit = np.log(max(SEEN * gas.max(initial=0.0), 1e-300))
    found = 1 / np.interp(np.log(light[seen]), table, 1 / ladder)
    return (middle[seen], found), float(1 / np.interp(limit, table, 1 / ladder))


def _median(values):
    """Median of what is finite; 0 without any."""
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size else 0.0


def raw_model(model):
    """The same model with every sample as its own bin."""
    instruments = [
        replace(
            instrument,
            moment=instrument.raw_moment,
            value=instrument.raw,
            number=np.ones_like(instrument.raw),
        )
        for instrument in model.instruments
    ]
    return model_with(model, instruments)


def phase_of(time, off):
    """0 before injection, 1 with plasma, 2 after it, for the times (t,)."""
    return (time >= 0).astype(int) + (time >= off).astype(int)


def raw_residuals(model, solution):
    """Residuals, predictions and light of the gas (t, C) of the samples of each instrument; residuals are
    NaN where no bin holds them."""
    raw, state = raw_model(model), solution.state
    for which, instrument in enumerate(model.instruments):
        error = state.error_of_gas(which)
        plain = raw.evaluate(which, state.knots, state.values, solution.settings, gas_error=error)
        more = state.values.copy()
        more[model.index["gas"]] += 1e-3
        gas = raw.evaluate(which, state.knots, more, solution.settings, gas_error=error) - plain
        value = plain * (1 + state.pattern[which]) + state.dark[which]
        residual = np.where((instrument.raw_bin >= 0)[:, None], instrument.raw - value, np.nan)
        yield residual, value, np.maximum(gas / 1e-3, 0.0)


def renoised(model, solution):
    """Noise from the residuals of a fit, and the model with outliers left out of its bins."""
    found, instruments = [], []
    flicker = None
    samples = raw_residuals(model, solution)
    for instrument, (residual, value, gas) in zip(model.instruments, samples, strict=True):
        time = instrument.raw_moment.mean(axis=1)
        series = binning.series(time)
        phase, own = phase_of(time, model.off) + 3 * series, None if model.plasma else series
        law, left = noises.estimate(instrument, residual, value, gas, phase, flicker, own)
        flicker = law.flicker
        factor = np.ones(instrument.channels) if instrument.factor is None else instrument.factor
        sigma = np.sqrt(
            law.variance(series, value, factor, instrument.pixels)
            + law.flicker.total * gas**2
            + instrument.rounded(value, 1)
        )
        # A slow misfit is no outlier: samples are held against their neighbours and the others of their bin.
        hit = outliers.outliers(left / sigma, instrument.raw_bin >= 0, phase)
        own = outliers.line_in_bins(
            np.where(hit, np.nan, left), time, instrument.raw_bin, instrument.value.shape[0]
        )
        expected = value + np.nan_to_num(residual - left) + own
        hit |= np.abs(np.nan_to_num(left - own)) > outliers.CLIP * sigma
        hit &= ~outliers.crowded(hit, instrument.raw_bin, instrument.value.shape[0])
        cleaned = outliers.without_outliers(instrument, expected, hit)
        found.append(law)
        instruments.append(cleaned)
    slowest = max((law.flicker for law in found), key=lambda one: one.slower(0.0))
    found = [replace(law, flicker=law.flicker.with_memory_of(slowest)) for law in found]
    bins = [
        noises.on_bins(
            law,
            one,
            prediction,
            phase_of(one.time, model.off),
            unresolved(errors, np.ptp(one.moment, axis=1)),
        )
        for law, one, prediction, errors in zip(
            found, instruments, solution.prediction, model.persistent, strict=True
        )
    ]
    # 1/f noise is as strong in each decade of time: a gas wanders as much as it flickers slowly.
    model = _restless(model, float(np.sqrt(slowest.slower(SLOW))))
    return model_with(model, instruments), tuple(found), bins


def _restless(model, sigma):
    """The model of a gas that wanders by a standard deviation [1], if that is more than assumed."""
    return _with_law(
        model, {place: {"sigma": max(sigma, model.own[place].sigma)} for place in model.wandering}
    )


def _with_law(model, changes):
    """The model with other centres or standard deviations of parameters, {place: fields}, independent of
    the others."""
    own, precision = list(model.own), model.precision.copy()
    for place, fields in changes.items():
        own[place] = replace(own[place], **fields)
        precision[place, place] = own[place].sigma ** -2.0
    return model_with(model, model.instruments, tuple(own), precision)


def model_with(model, instruments, own=None, precision=None, persistent=None):
    """The model on other data, with other parameters of its own if given."""
    return Model(
        instruments,
        model.library,
        model.history,
        model.own if own is None else own,
        model.record,
        model.slope,
        model.response,
        model.lamp,
        model.persistent if persistent is None else persistent,
        model.given,
        model.precision if precision is None else precision,
        model.power,
    )


def fit_base(model, rounds=2):
    """Base fit with the noise that its own residuals show.

    Returns
    -------
    Base
    """
    values, errors = first_gas.guess(model) if model.plasma else first_gas.none(model)
    # Its light is free in each channel: how bright it is as a whole, the simulation is not asked.
    bright = model.index["gas"]
    model = _with_law(model, {bright: {"centre": float(values[bright])}})
    cold = np.full(model.size, 300.0)
    gas = [
        model.evaluate(which, cold, values, gas_error=errors[which]) * (instrument.moment[:, :1] < model.off)
        for which, instrument in enumerate(model.instruments)
    ]
    fitter = Fitter(model, noises.first_guess(model, gas))
    start = replace(fitter.start(guess_temperature(model)), values=values, lines=errors)
    solution = fitter.fit(start, tolerance=20.0)
    laws = ()
    for last in range(rounds):
        progress.step("diagnosis: base model, round", last + 1, rounds)
        model, laws, bins = renoised(model, solution)
        fitter = Fitter(model, bins)
        solution = fitter.fit(solution.state, tolerance=0.02 if last == rounds - 1 else 5.0)
    for _ in range(RESTLESS):
        sigma = wandering(model, solution)
        if sigma is None:
            break
        model = _restless(model, sigma)
        fitter, solution = _refitted(model, fitter, solution)
    factors = steadier(model, solution)
    if factors:
        model = _scaled(model, factors)
        fitter = Fitter(model, _with_course(model, laws, fitter.noise))
        fitter, solution = _refitted(model, fitter, solution)
    factors = darker(model, solution)
    if min(factors) < DARKER:
        darks = [replace(i, dark=f * i.dark) for i, f in zip(model.instruments, factors, strict=True)]
        fitter, solution = _refitted(model_with(model, darks), fitter, solution)
        model = fitter.model
    for _ in range(RESTLESS):
        factors = rougher(model, solution)
        if not factors:
            break
        model = _scaled(model, factors)
        fitter, solution = _refitted(model, fitter, solution)
    return Base(model, laws, fitter, solution)


def _with_course(model, laws, bins):
    """Noise of bins with that of a course over wavelength which wanders as the model says."""
    return [
        replace(
            one,
            course=noises.course_on_bins(
                law, instrument, unresolved(errors, np.ptp(instrument.moment, axis=1))[2]
            ),
        )
        for law, one, instrument, errors in zip(laws, bins, model.instruments, model.persistent, strict=True)
    ]


def _refitted(model, fitter, solution):
    """Fitter and fit of a model with other priors, the noise kept."""
    fitter = Fitter(model, fitter.noise)
    return fitter, fitter.fit(solution.state, tolerance=0.02)


def _scaled(model, factors):
    """The model with the standard deviations of persistent errors times factors {id: f}."""
    scale = np.array([factors.get(one.id, 1.0) for one in model.parameters])
    persistent = [
        replace(
            errors,
            parameters=tuple(
                replace(one, sigma=one.sigma * factors.get(one.id, 1.0)) for one in errors.parameters
            ),
        )
        for errors in model.persistent
    ]
    precision = model.precision / np.outer(scale, scale)
    return model_with(model, model.instruments, None, precision, persistent)
