"""Numbers behind the figures of a diagnosis: what departs from the model, where and when."""

import numpy as np
from scipy.special import chdtrc, ndtri

from plasmapyro.diagnosis.select.leftover import leading
from plasmapyro.diagnosis.select.screen import best_by_id
from plasmapyro.radiation.bandsignal import BANDS

LINES = ((777.6, "O I 777"), (844.9, "O I 845"), (868.3, "N I 868"), (822.0, "N I 822"), (926.9, "O I 927"))
LINE_REACH = 1.6e-9  # [m] around a line
RED = 960e-9  # [m], beyond which channels count as red
STEP_REACH = 4.0  # [s] on either side of the end of the plasma
LAGS = 20
UNSETTLED = 0.02  # of the way from the injection to the end of the plasma


def number(value):
    """A float that JSON knows; None for NaN or infinity."""
    value = float(value)
    return value if np.isfinite(value) else None


def numbers(values):
    """A list of `number`."""
    return [number(value) for value in np.ravel(values)]


def channel_kinds(one):
    """Index arrays of the channels of an instrument by kind."""
    if one.kind == "pyrometer":
        return {name: np.array([place]) for place, name in enumerate(one.band)}
    near = np.zeros(one.channels, dtype=bool)
    for place, _ in LINES:
        near |= np.abs(one.wavelength - place * 1e-9) < LINE_REACH
    red = ~near & (one.wavelength > RED)
    return {"lines": np.flatnonzero(near), "hump": np.flatnonzero(~near & ~red), "red": np.flatnonzero(red)}


def phases(model, solution):
    """(id, name, first, last) [s] of the parts of a test: the sample is cold for as long as the reference
    window states, and steady once its temperature has made most of its way."""
    end = max(instrument.moment.max() for instrument in model.instruments)
    start = min(instrument.moment.min() for instrument in model.instruments)
    off = model.off
    cold = float(np.clip(model.record.window[1], 0.0, off))
    settled = max(_settled(model, solution), cold)
    rows = [
        ("pre", "before injection", start, 0.0),
        ("cold", "first seconds", 0.0, cold),
        ("heating", "heating", cold, settled),
        ("steady", "steady state", settled, off),
        ("cooling", "plasma off", off, end),
    ]
    return [row for row in rows if row[3] > row[2]]


def _settled(model, solution):
    """Time [s] from which the temperature stays near that at the end of the plasma."""
    knots, temperature = model.history.knots, solution.state.knots
    last = int(np.argmin(np.abs(knots - min(model.off, knots[-1]))))
    left = np.abs(temperature[: last + 1] - temperature[last])
    away = left > UNSETTLED * left[0]
    return float(knots[np.flatnonzero(away)[-1] + 1]) if away.any() else 0.0


def phase_table(model, solution, z):
    """Chi-squared by phase and kind of channel, with the probability of more."""
    rows = []
    for identity, _, first, last in phases(model, solution):
        for instrument, own in zip(model.instruments, z, strict=True):
            time = instrument.time
            inside = (time >= first) & (time < last)
            for kind, channels in channel_kinds(instrument).items():
                part = own[np.ix_(inside, channels)]
                count = int(np.isfinite(part).sum())
                if count:
                    chi2 = float(np.nansum(part**2))
                    rows.append(
                        {
                            "phase": identity,
                            "channel": kind,
                            "chi2": chi2,
                            "count": count,
                            "p": float(chdtrc(count, chi2)),
                        }
                    )
    return rows


def kappa(model, fitter, solution):
    r"""Step at the end of the plasma over the gas before it, 1 if nothing but the gas goes out.

    .. math:: \kappa = \frac{[S(t_{off}^-) - S(t_{off}^+)] - [\text{the same without gas}]}{S_{gas}}

    The fall of the surface's light between the two sides is taken from the fitted temperature.
    """
    result = {"wide": None, "narrow": None, "wide_error": None, "narrow_error": None}
    spectrum = {"wavelength": [], "kappa": [], "error": []}
    for instrument, noise, gas, predicted in zip(
        model.instruments, fitter.noise, solution.gas, solution.prediction, strict=True
    ):
        time = instrument.time
        before = (time > model.off - 3 * STEP_REACH) & (time < model.off)
        after = (time > model.off) & (time < model.off + STEP_REACH)
        if not before.any() or not after.any():
            continue
        surface = predicted - gas
        left = instrument.value - surface
        weight = 1 / noise.variance

        def mean(rows, left=left, weight=weight):
            total = weight[rows].sum(axis=0)
            safe = np.where(total > 0, total, np.nan)
            return np.nansum(weight[rows] * left[rows], axis=0) / safe, 1 / safe

        (high, high_variance), (low, low_variance) = mean(before), mean(after)
        level = gas[before].mean(axis=0)
        # What is fitted of no light is noise, on either side of zero.
        level = np.where(level > 0, level, np.nan)
        value, error = (high - low) / level, np.sqrt(high_variance + low_variance) / level
        if instrument.band == BANDS:
            result |= {
                "wide": number(value[0]),
                "narrow": number(value[1]),
                "wide_error": number(error[0]),
                "narrow_error": number(error[1]),
            }
        else:
            spectrum = {
                "wavelength": numbers(instrument.middle),
                "kappa": numbers(value),
                "error": numbers(error),
            }
    labels = [{"wavelength": place * 1e-9, "text": text} for place, text in LINES]
    return result | spectrum | {"labels": labels}


def emittance_loop(model, fitter, solution):
    """Apparent emittance against temperature: light of the surface over that of a black body."""
    one = model.instruments[-1]
    noise, gas, predicted = fitter.noise[-1], solution.gas[-1], solution.prediction[-1]
    time = one.time
    surface = np.maximum(predicted - gas, 1e-300)
    weight = np.where(np.isfinite(one.value), surface**2 / noise.variance, 0.0)
    total = weight.sum(axis=1)
    ratio = np.nansum(np.where(weight > 0, (one.value - gas) / surface, 0.0) * weight, axis=1) / np.where(
        total > 0, total, np.nan
    )
    level = model.emittance * np.exp(solution.state.values[model.index["emittance"]])
    good = (time > 0) & (total > 100)
    return {
        "temperature": numbers((model.history.basis(time) @ solution.state.knots)[good]),
        "emittance": numbers(level * ratio[good]),
        "error": numbers(level / np.sqrt(total[good])),
        "heating": [bool(t < model.off) for t in time[good]],
        "stated": float(model.emittance),
    }


def gas_monitor(model, fitter, solution):
    """Brightness of the gas over the simulated one, bin by bin, from the channels where it stands out."""
    which = len(model.instruments) - 1
    one, noise = model.instruments[which], fitter.noise[which]
    if one.kind != "spectrometer" or not model.plasma:
        return None  # two bands do not tell gas from surface
    gas, time = solution.gas[which], one.time
    gain = np.where(time < 0, np.exp(solution.state.values[model.index["before_injection"]]), 1.0)
    lit = (time < model.off).astype(float)
    unit = np.median(gas[(time > 0) & (time < model.off)], axis=0)
    # What neighbours in wavelength share is surface; the lines against them are gas.
    residual = np.where(np.isfinite(one.value), one.value - solution.prediction[which], 0.0)
    weight = 1 / noise.variance
    shapes = np.stack([unit, np.ones_like(unit), one.wavelength / one.wavelength.mean() - 1], axis=1)
    normal = np.einsum("ck,nc,cl->nkl", shapes, weight, shapes)
    right = np.einsum("ck,nc->nk", shapes, weight * residual)
    scale = np.sqrt(np.maximum(np.einsum("nkk->nk", normal), 1e-300))
    normal = normal / (scale[:, :, None] * scale[:, None, :]) + 1e-12 * np.eye(3)
    inverse = np.linalg.inv(normal)
    level = np.einsum("nkl,nl->nk", inverse, right / scale)[:, 0] / scale[:, 0]
    error = np.sqrt(np.maximum(inverse[:, 0, 0], 0)) / scale[:, 0]
    channels = {}
    for name, (moment, measured) in model.record.accompanying.items():
        values = np.interp(time, moment, measured)
        mean = np.median(values[(time > 0) & (time < model.off)])
        channels[name] = numbers(values / mean if mean else values)
    return {
        "time": numbers(time),
        "gas": numbers(gain * lit + level),
        "error": numbers(np.where(lit > 0, error, np.nan)),
        "channels": channels,
    }


def signals(model, base, extended):
    """Signals of the bands, measured, of the base and of the extended fit; empty without bands."""
    rows = {"": [], "_model": [], "_extended": []}
    time, names = [], BANDS
    for which, instrument in enumerate(model.instruments):
        if instrument.band:
            time, names = numbers(instrument.time), instrument.band
            rows = {
                "": instrument.value.T,
                "_model": base.prediction[which].T,
                "_extended": extended.prediction[which].T,
            }
    bands = {
        f"{band}{suffix}": numbers(values[place]) if len(values) else []
        for suffix, values in rows.items()
        for place, band in enumerate(names)
    }
    return {"time": time} | bands


def _axis(instrument):
    """Wavelengths [m] of the channels; of the pyrometer's two bands their places."""
    return [0.0, 1.0] if instrument.band == BANDS else numbers(instrument.middle)


def leading_pattern(model, z):
    """Leading pattern of the residuals of the instrument whose are largest."""
    which = int(np.argmax([np.nanmean(part**2) for part in z]))
    instrument = model.instruments[which]
    time, channel, size, _ = leading(z[which])
    return {
        "time": numbers(instrument.time),
        "time_weight": numbers(time),
        "wavelength": _axis(instrument),
        "wavelength_weight": numbers(channel),
        "channel": instrument.kind,
        "share": size**2 / float(np.nansum(z[which] ** 2)),
    }


def components(model, z, screen, columns):
    """Leading pattern of the residuals of each instrument, against what noise alone would show."""
    rows = []
    for which, (instrument, own) in enumerate(zip(model.instruments, z, strict=True)):
        if min(own.shape) < 2:
            continue
        time, channel, size, expected = leading(own)
        cosine = {}
        for index in best_by_id(screen.candidates, screen.gains()):
            column = columns[which][..., index]
            length = np.linalg.norm(column)
            if length > 0:
                cosine[screen.candidates[index].id] = abs(float(time @ column @ channel) / length)
        best = sorted(cosine, key=lambda identity: -cosine[identity])[:3]
        rows.append(
            {
                "instrument": instrument.kind,
                "singular_value": size,
                "expected": expected,
                "time": numbers(instrument.time),
                "time_weight": numbers(time),
                "axis": _axis(instrument),
                "axis_weight": numbers(channel),
                "resembles": [{"id": identity, "cosine": cosine[identity]} for identity in best],
            }
        )
    return rows


def series(model, z):
    """Autocorrelation and quantiles of the mean residual of each instrument."""
    correlation, quantile = [], []
    for instrument, own in zip(model.instruments, z, strict=True):
        for kind, channels in channel_kinds(instrument).items():
            if not np.isfinite(own[:, channels]).any():
                continue
            mean = np.nansum(own[:, channels], axis=1) / np.sqrt(
                np.maximum(np.isfinite(own[:, channels]).sum(axis=1), 1)
            )
            centred = mean - mean.mean()
            power = np.sum(centred**2)
            lags = [
                float(np.sum(centred[k:] * centred[:-k]) / power) if power else 0.0
                for k in range(1, LAGS + 1)
            ]
            correlation.append(
                {
                    "channel": kind,
                    "lag": list(range(1, LAGS + 1)),
                    "value": lags,
                    "band": float(1.96 / np.sqrt(mean.size)),
                }
            )
            flat = own[:, channels]
            flat = flat[np.isfinite(flat)]
            share = (np.arange(41) + 0.5) / 41
            quantile.append(
                {
                    "channel": kind,
                    "normal": numbers(ndtri(share)),
                    "residual": numbers(np.quantile(flat, share)),
                }
            )
    return correlation, quantile


def profile(solution, size):
    """Chi-squared against the amplitude of each effect about its best value, by the curvature there."""
    rows = []
    for place, setting in enumerate(solution.settings):
        sigma = float(np.sqrt(solution.covariance[size + place, size + place]))
        steps = np.linspace(-3, 3, 13)
        rows.append(
            {
                "id": setting.id,
                "amplitude": [float(setting.amplitude + step * sigma) for step in steps],
                "chi2": [float(step**2) for step in steps],
            }
        )
    return rows
