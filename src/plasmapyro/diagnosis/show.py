"""Numbers behind the figures of a diagnosis: what departs from the model, where and when."""

import numpy as np
from scipy import stats

from plasmapyro.diagnosis.build import GROUP_SIGMA, POWER_SIGMA, group_sigma
from plasmapyro.diagnosis.inference import whitened
from plasmapyro.diagnosis.select import best_by_id
from plasmapyro.diagnosis.templates import BANDS_OF

LINES = ((777.6, "O I 777"), (844.9, "O I 845"), (868.3, "N I 868"), (822.0, "N I 822"), (926.9, "O I 927"))
LINE_REACH = 1.6e-9  # [m] around a line
HUMP = (985e-9, 1030e-9)  # [m] of N2 first positive
RED = 960e-9  # [m], beyond which channels count as red
STEP_REACH = 4.0  # [s] on either side of the end of the plasma
# Shares of what a matt surface returns: the track bends within the first hundredths.
MATT = np.array([0.0, 0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0])
BINS = np.arange(745e-9, 1031e-9, 5e-9)  # [m] edges in which explanations are compared with a spectrum
SHAPE_SIGMA = 0.01  # [1] of the light of a bin, besides strengths and power
FINER = 8  # steps between two amplitudes of a track
FREE_NUMBER = 2.0  # of chi-squared: what an explanation's amplitude must gain (H. Akaike, IEEE TAC 19, 1974)
LAGS = 20


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
        return {"wide": np.array([0]), "narrow": np.array([1])}
    near = np.zeros(one.channels, dtype=bool)
    for place, _ in LINES:
        near |= np.abs(one.wavelength - place * 1e-9) < LINE_REACH
    red = ~near & (one.wavelength > RED)
    return {"lines": np.flatnonzero(near), "hump": np.flatnonzero(~near & ~red), "red": np.flatnonzero(red)}


def phases(model):
    """(id, name, first, last) [s] of the parts of a test."""
    end = max(one.moment.max() for one in model.instruments)
    start = min(one.moment.min() for one in model.instruments)
    off = model.off
    rows = [
        ("pre", "before injection", start, 0.0),
        ("cold", "first seconds", 0.0, 6.0),
        ("heating", "heating", 6.0, min(80.0, off)),
        ("steady", "steady state", 80.0, off),
        ("cooling", "plasma off", off, end),
    ]
    return [row for row in rows if row[3] > row[2]]


def residuals(model, fitter, solution):
    """Whitened residuals (n, C) per instrument, NaN where nothing was measured."""
    result = []
    for one, residual, noise, gas in zip(
        model.instruments, solution.residual, fitter.noise, solution.gas, strict=True
    ):
        z = whitened(residual, noise, gas)
        result.append(np.where(np.isfinite(one.value), z, np.nan))
    return result


def phase_table(model, z):
    """Chi-squared by phase and kind of channel, with the probability of more."""
    rows = []
    for identity, _, first, last in phases(model):
        for one, own in zip(model.instruments, z, strict=True):
            time = one.moment.mean(axis=1)
            inside = (time >= first) & (time < last)
            for kind, channels in channel_kinds(one).items():
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
                            "p": float(stats.chi2.sf(chi2, count)),
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
    for one, noise, gas, predicted in zip(
        model.instruments, fitter.noise, solution.gas, solution.prediction, strict=True
    ):
        time = one.moment.mean(axis=1)
        before = (time > model.off - 3 * STEP_REACH) & (time < model.off)
        after = (time > model.off) & (time < model.off + STEP_REACH)
        if not before.any() or not after.any():
            continue
        surface = predicted - gas
        left = one.value - surface
        weight = 1 / noise.variance

        def mean(rows, left=left, weight=weight):
            total = weight[rows].sum(axis=0)
            safe = np.where(total > 0, total, np.nan)
            return np.nansum(weight[rows] * left[rows], axis=0) / safe, 1 / safe

        (high, high_variance), (low, low_variance) = mean(before), mean(after)
        level = gas[before].mean(axis=0)
        value, error = (high - low) / level, np.sqrt(high_variance + low_variance) / level
        if one.kind == "pyrometer":
            result |= {
                "wide": number(value[0]),
                "narrow": number(value[1]),
                "wide_error": number(error[0]),
                "narrow_error": number(error[1]),
            }
        else:
            spectrum = {
                "wavelength": numbers(one.wavelength),
                "kappa": numbers(value),
                "error": numbers(error),
            }
    labels = [{"wavelength": place * 1e-9, "text": text} for place, text in LINES]
    return result | spectrum | {"labels": labels}


def emittance_loop(model, fitter, solution):
    """Apparent emittance against temperature: light of the surface over the black body, from the clearest
    channels."""
    one = model.instruments[-1]
    noise, gas, predicted = fitter.noise[-1], solution.gas[-1], solution.prediction[-1]
    time = one.moment.mean(axis=1)
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


def gas_monitor(model, fitter, solution, test):
    """Brightness of the gas over the simulated one, bin by bin, from the channels where it stands out."""
    which = len(model.instruments) - 1
    one, noise = model.instruments[which], fitter.noise[which]
    if one.kind != "spectrometer":
        return None  # two bands do not tell gas from surface
    gas, time = solution.gas[which], one.moment.mean(axis=1)
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
    for name in ("electric_power", "chamber_pressure", "mass_flow_rate"):
        if name in test.variables and "time" in test.variables:
            values = np.interp(time, test["time"].values, test[name].values)
            mean = np.median(values[(time > 0) & (time < model.off)])
            channels[name] = numbers(values / mean if mean else values)
    return {
        "time": numbers(time),
        "gas": numbers(gain * lit + level),
        "error": numbers(np.where(lit > 0, error, np.nan)),
        "channels": channels,
    }


# Tracks that are one cause: more power is a hotter core; a mirror shows the sight line itself and adds more
# of the same light, as a longer path would.
ONE_CAUSE = {"core": "P_eff", "refl": "path", "refl_diffuse": "refl"}


def line_hump(library, strengths, explanations, calibration=False):
    """Line and hump of the gas against the simulation: the measured point and where explanations lead.

    Parameters
    ----------
    library : GasLibrary
    strengths : (spectrum (K,), relative errors of line and hump), what the fit makes of the gas
    explanations : mapping id -> (name, amplitudes, function amplitude -> spectrum (K,))
    calibration : bool
        Whether the throughput of an instrument left its prior: surface and gas err alike.
    """
    axis = library.wavelength
    line = np.abs(axis - 777.6e-9) < LINE_REACH
    hump = (axis > HUMP[0]) & (axis < HUMP[1])

    def factors(spectrum):
        return (
            float(spectrum[line].sum() / library.base[line].sum()),
            float(spectrum[hump].sum() / library.base[hump].sum()),
        )

    spectrum, errors = strengths
    at = factors(spectrum)
    tracks = []
    for identity, (name, amplitudes, change) in explanations.items():
        points = [factors(change(amplitude)) for amplitude in amplitudes]
        tracks.append(
            {
                "id": identity,
                "name": name,
                "amplitude": [float(a) for a in amplitudes],
                "line": [p[0] for p in points],
                "hump": [p[1] for p in points],
            }
        )
    closest = "calibration" if calibration else _closest(library, spectrum, explanations)
    return {
        "measured": {
            "line": at[0],
            "hump": at[1],
            "line_error": at[0] * errors[0],
            "hump_error": at[1] * errors[1],
        },
        "tracks": tracks,
        "closest": closest,
    }


def _closest(library, spectrum, explanations):
    r"""Explanation that leaves least of a spectrum (K,) to the strengths and the power, or 'none'.

    .. math:: \chi^2 = \min_a (y - y_a)^T C^{-1} (y - y_a), \quad
              C = \sum_g \sigma_g^2 f_g f_g^T + \sigma_P^2 p p^T + \sigma^2

    with the logarithms :math:`y` of the light in `BINS` over the simulated one, the share :math:`f_g` of a
    group of lines in them and their change :math:`p` with the power. Line and hump alone leave power and
    path, ripple and excitation close to one another; the other bins tell them apart.
    """
    axis = library.wavelength
    place = np.digitize(axis, BINS) - 1
    inside = (place >= 0) & (place < BINS.size - 1)
    used = np.unique(place[inside])

    def binned(values):
        return np.bincount(place[inside], values[inside], BINS.size - 1)[used]

    base = binned(library.base)

    def logarithm(values):
        return np.log(binned(values) / base)

    share = np.array([binned(group) for group in library.group]) / base
    sigma = np.array([group_sigma(str(name)) for name in library.group_name])
    bands = share[[str(name).startswith(BANDS_OF) for name in library.group_name]].sum(axis=0)
    step = POWER_SIGMA / 2
    power = logarithm(library.power_factor(step) * library.base) - logarithm(
        library.power_factor(-step) * library.base
    )
    rows = np.concatenate([sigma[:, None] * share, [GROUP_SIGMA * bands, power]])
    covariance = rows.T @ rows + SHAPE_SIGMA**2 * np.eye(used.size)
    white = np.linalg.inv(np.linalg.cholesky(covariance))
    measured = logarithm(spectrum)
    left = {"none": float(np.sum((white @ measured) ** 2)) - FREE_NUMBER}
    for identity, (_, amplitudes, change) in explanations.items():
        nodes = np.arange(len(amplitudes))
        finer = np.interp(np.linspace(0, nodes[-1], FINER * nodes[-1] + 1), nodes, amplitudes)
        away = np.array([measured - logarithm(change(amplitude)) for amplitude in finer])
        left[identity] = float(np.min(np.sum((away @ white.T) ** 2, axis=1)))
    closest = min(left, key=left.get)
    return ONE_CAUSE.get(closest, closest)


def explanations(library, emittance):
    """The six explanations of a line and a hump that differ from the simulation, as changes of the
    spectrum."""
    one = library.addition["reflected_specular"]
    many = library.addition["reflected_diffuse"]
    power = np.log(np.array([0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.6]))
    return {
        "P_eff": ("simulated power", power, lambda a: library.base * library.power_factor(a)),
        "refl": (
            "reflected gas light, mirror",
            np.linspace(0, 1.5, 6),
            lambda a: library.base + a * (1 - emittance) * one,
        ),
        "refl_diffuse": (
            "reflected gas light, matt",
            MATT,
            lambda a: library.base + a * (1 - emittance) * many,
        ),
        "T_exc": (
            "excitation of the atoms",
            np.linspace(-0.1, 0.1, 9),
            lambda a: library.base * library.factor("excitation", a),
        ),
        "ripple": (
            "ripple of the torch",
            np.linspace(0, 0.2, 6),
            lambda a: library.base * library.factor("ripple", a),
        ),
        "core": (
            "temperature of the core",
            np.linspace(-0.12, 0.12, 9),
            lambda a: library.base * library.factor("core_temperature", a),
        ),
        "path": (
            "path length or grey calibration",
            np.linspace(-0.5, 1.0, 7),
            lambda a: library.base * (1 + a),
        ),
    }


def components(model, z, found, columns):
    """Leading pattern of the residuals of each instrument, against what noise alone would show."""
    rows = []
    generator = np.random.default_rng(7)
    for which, (one, own) in enumerate(zip(model.instruments, z, strict=True)):
        filled = np.nan_to_num(own)
        if min(filled.shape) < 2:
            continue
        u, s, v = np.linalg.svd(filled, full_matrices=False)
        null = [np.linalg.svd(generator.standard_normal(filled.shape), compute_uv=False)[0] for _ in range(5)]
        cosine = {}
        for index in best_by_id(found.candidates, found.gains()):
            column = columns[which][..., index]
            length = np.linalg.norm(column)
            if length > 0:
                cosine[found.candidates[index].id] = abs(float(u[:, 0] @ column @ v[0]) / length)
        best = sorted(cosine, key=lambda identity: -cosine[identity])[:3]
        rows.append(
            {
                "instrument": one.kind,
                "singular_value": float(s[0]),
                "expected": float(np.max(null)),
                "time": numbers(one.moment.mean(axis=1)),
                "time_weight": numbers(u[:, 0]),
                "axis": numbers(one.wavelength) if one.weight is None else [0.0, 1.0],
                "axis_weight": numbers(v[0]),
                "resembles": [{"id": identity, "cosine": cosine[identity]} for identity in best],
            }
        )
    return rows


def series(model, z):
    """Autocorrelation and quantiles of the mean residual of each instrument."""
    correlation, quantile = [], []
    for one, own in zip(model.instruments, z, strict=True):
        for kind, channels in channel_kinds(one).items():
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
                    "normal": numbers(stats.norm.ppf(share)),
                    "residual": numbers(np.quantile(flat, share)),
                }
            )
    return correlation, quantile


def profile(solution, size):
    """Chi-squared against the amplitude of each term about its best value, by the curvature there."""
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
