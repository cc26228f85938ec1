"""Surface temperatures of a test: of the paper, of the base model, of the extended model."""

from dataclasses import replace

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.diagnosis.fit.build import OF_GAS
from plasmapyro.diagnosis.report.interval import estimated_beside_bounded
from plasmapyro.diagnosis.report.kelvin import COLDEST, SURFACE, paper_temperature, reference_of
from plasmapyro.diagnosis.select.search import PULL
from plasmapyro.experiment.correction import budget_of
from plasmapyro.record import budget, recommended, status
from plasmapyro.record.emittance import THROUGHPUT_CHANCE, THROUGHPUT_WIDTH, with_temperature
from plasmapyro.record.level import EFFECTIVE

NOTHING = 1e-12  # [K-1] by which light of the surface changes beside that of the gas
FOLLOWS = "eps_T"  # effect of an emittance that follows the temperature
LARGEST = 0.03  # [1] standard uncertainty beyond which there is no temperature, as of the joint estimate
COLOUR = 0.03  # [1] by which the colour of the gas changes, as `gas_change` of the joint estimate


def temperatures(findings, against=(), contradicted=((), "")):
    """Temperatures with 95 % intervals at the middles of all bins, and the one to take away.

    Contract 'diagnosis_temperature'. `against`: what says that instruments contradict each other, see
    `record.recommended`; `contradicted`: see `stage.diagnose`.
    """
    unlike, words = _unlike(findings, *contradicted)
    if unlike.all():
        against = (*against, words)
    times, base, final = findings.times, findings.base.solution, findings.final
    basis = findings.model.history.basis(times)
    shift = doubtful(findings, basis @ (final.state.knots - base.state.knots))
    fit, moved = (final if findings.applied else base), other_clock(final, basis, times)
    rows = {
        "base": _interval(findings, base),
        "extended": _interval(findings, fit, np.hypot(shift, moved)),
    }
    paper, middle, inputs = _paper(findings), rows["extended"], _inputs(findings, fit, shift)
    if moved.any():
        inputs.append(budget.Input("which of two clocks is right", "named effects", moved))
    state = _status(findings, fit, middle[0], budget.combined(inputs))
    known = np.isin(state, status.WITH_VALUE).any()
    choice = recommended.recommended(
        recommended.Facts(
            (
                *(["extended"] if findings.applied and known else []),
                *(["base"] if known else []),
                *(["subtraction"] if np.isfinite(paper[0]).any() else []),
            ),
            tuple(against),
            verdict=findings.status,
            applied=findings.applied,
            strained=tuple(
                row["name"] for row in findings.pulls if row["finding"] and row["id"] not in OF_GAS
            ),
            instruments=tuple(one.name for one in findings.record.instruments),
        )
    )
    if choice.estimate == "subtraction":
        series = recommended.series(times, *paper, axis="time_bin")
    else:
        if choice.estimate is None:
            unlike[:] = True
        state = np.where(unlike & np.isin(state, status.WITH_VALUE), status.CONTRADICTED, state)
        series = recommended.series(times, middle[0], state, inputs, middle[2] - middle[0], "time_bin")
    return series.assign(
        {"paper_temperature": ("time_bin", paper[0])}
        | {
            f"{model}_temperature{end}": ("time_bin", values)
            for model, three in rows.items()
            for end, values in zip(("", "_low", "_high"), three, strict=True)
        }
    ).assign_attrs(
        {
            "title": "Surface temperature: of the paper, of the base model, of the extended model",
            "applied": int(findings.applied),
            "terms": " ".join(setting.id for setting in final.settings),
            "origin": str(findings.record.attributes.get("origin", "measured")),
            **recommended.attributes(choice),
            **unlike_throughput(findings.model, fit, basis)[1],
        }
    )


def _unlike(findings, moments, words):
    """Which times (t,) are next to a contradicted moment and no confirmed cause says why; the sentence."""
    times = findings.times
    unlike = np.zeros(times.size, dtype=bool)
    if len(moments) and not findings.applied:
        own = np.asarray(moments) - findings.record.clock(0.0)
        unlike[np.abs(times[:, None] - own).argmin(axis=0)] = True
    return unlike, words


def doubtful(findings, shift):
    r"""Part (t,) [K] of the shift (t,) of the temperature by the named effects that is an uncertainty.

    All of it where held-out data do not confirm them. Where names that are applied stand with reserve, the
    root of the mean square about the extended temperature, :math:`\sqrt{1 - p}\,\Delta T`: with the
    probability 1 - p it is another cause, and the temperature as likely that without them. Else none.
    """
    if not findings.applied:
        return shift
    if findings.status != "named+unknown":
        return np.zeros_like(shift)
    answers = findings.probability[0]
    right = sum(answers.get(setting.id, 0.0) for setting in findings.final.settings)
    return np.sqrt(max(1.0 - right, 0.0)) * shift


def _interval(findings, solution, unsure=0.0):
    """Temperature (t,) of a fit and the ends of its interval; NaN before the injection, and where only its
    prior tells one: a slow sample at 434 K was 658 +- 70 K."""
    model, times = findings.model, findings.times
    basis, size, lamp = model.history.basis(times), model.size, model.index["lamp"]
    mean, covariance = basis @ solution.state.knots, solution.covariance
    unsure = np.hypot(np.hypot(unsure, strained(model, solution, basis)), basis @ findings.unknown_shift)
    unsure = np.hypot(unsure, unlike_throughput(model, solution, basis)[0])
    unsure = np.hypot(unsure, following(model, solution, basis))
    unsure = np.hypot(unsure, other_colour(model, solution, times))
    variance = np.einsum("tk,kl,tl->t", basis, covariance[:size, :size], basis)
    # What the model leaves of the data beyond their noise is in the interval as well.
    misfit = max(solution.objective / max(solution.count - findings.fitted, 1), 1.0)
    # The bias of the calibration source is bounded, not normal.
    spread = estimated_beside_bounded(
        misfit * variance + unsure**2,
        np.sqrt(misfit) * (basis @ covariance[:size, size + lamp]),
        model.parameters[lamp].sigma,
    )
    told = (times >= 0) & (spread < budget.NORMAL_95 * LARGEST * mean)
    return [np.where(told, values, np.nan) for values in (mean, mean - spread, mean + spread)]


def strained(model, solution, basis):
    r"""Shift (t,) [K] of the temperature by parameters that the fit moved out of their priors.

    .. math:: \Delta T^2 = \sum_{|\theta| > 3\sigma} \left[\frac{\mathrm{cov}(T, \theta)}
              {\mathrm{var}(\theta)}\,\theta\right]^2

    What the temperature would be with each of them where it was known to be: the model errs in one of them,
    or in what moved it. The light of the gas is free anyway.
    """
    total = np.zeros(len(basis))
    for place, (parameter, value) in enumerate(zip(model.parameters, solution.state.values, strict=True)):
        change, at = value - parameter.centre, model.size + place
        if abs(change) > PULL * parameter.sigma and parameter.id not in OF_GAS:
            slope = basis @ solution.covariance[: model.size, at] / solution.covariance[at, at]
            total += (slope * change) ** 2
    return np.sqrt(total)


def following(model, solution, basis):
    r"""What it costs (t,) [K] that the emittance may follow the temperature, by too little to be named.

    .. math:: u = \frac{\lambda T^2}{c_2} u_{\ln\varepsilon}

    Wien's law at `level.EFFECTIVE`; 0 where that is named or given, and by how much it does known.
    """
    if FOLLOWS in {one.id for one in solution.settings} | {term.setting.id for term in model.given}:
        return np.zeros(len(basis))
    kelvin = np.maximum(basis @ solution.state.knots, COLDEST)
    return EFFECTIVE / SECOND_RADIATION * kelvin**2 * with_temperature(kelvin, model.emittance)


def other_colour(model, solution, times):
    r"""What it costs (t,) [K] bands alone that the gas changes its colour, which no spectrum follows.

    .. math:: u^{-2} = \frac{2}{s^2} \sum_c (x_c - \bar x)^2, \qquad
              x_c = \frac{1}{G_c} \frac{\partial S_c}{\partial T}

    with the light G of the gas in each band, each off by :math:`s/\sqrt 2`, and S of the surface: least
    squares for temperature and brightness of the gas at one moment. The base model holds the colour from
    injection to end, so that the hot surface tells the gas of the first seconds, and a colour that is off by
    5 % was a surface of 828 +- 10 K for one of 400 to 800. 0 without a gas.
    """
    only, missed = model.instruments[0], np.zeros(len(times))
    if len(model.instruments) > 1 or only.weight is None or only.channels < 2:
        return missed
    gas = solution.gas[0]
    shining = (gas > 0).all(axis=1)
    by_kelvin = solution.jacobian[0][shining, :, : model.size].sum(axis=2) / gas[shining]
    apart = np.sqrt(2 * by_kelvin.shape[1] * by_kelvin.var(axis=1))
    missed[np.searchsorted(times, only.time[shining])] = COLOUR / np.maximum(apart, NOTHING)
    return missed


def unlike_throughput(model, solution, basis):
    r"""What it costs not to know whether a pyrometer alone sees the light that its calibration tells.

    .. math:: p(g) = (1 - c)\,N(0, s_0^2) + c\,N(0, s_0^2 + w^2), \qquad
              \frac{w_1}{w_0} = \frac{c}{1 - c}\,\frac{s_0}{s_1\sqrt{1 + h v}}\,
              \exp\Bigl(-\frac{h m^2}{2 (1 + h v)}\Bigr), \quad h = s_1^{-2} - s_0^{-2}

    with the mean m and the variance v that the fit gives the logarithm g of the throughput with its narrow
    prior; the wide one makes them :math:`m' = m / (1 + h v), v' = v / (1 + h v)`.

    The linear case of `estimate.throughput`, which takes the path along with the level.

    Returns
    -------
    shift : (t,) ndarray [K], root of the mean square about the temperature of the fit; 0 where a second
        instrument or other tests contradict such a throughput
    facts : dict, as those of `estimate.throughput.in_doubt`; empty where the shift is 0
    """
    if [one.source for one in model.instruments] != ["pyrometer"] or not model.plasma:
        return np.zeros(len(basis)), {}
    place = model.index["gain_pyrometer"]
    own, at, size = model.parameters[place], model.size + place, model.size
    if model.precision[place, place] != own.sigma**-2.0:  # other tests tell
        return np.zeros(len(basis)), {}
    wide = own.sigma**2 + THROUGHPUT_WIDTH**2
    mean, variance = solution.state.values[place] - own.centre, solution.covariance[at, at]
    change = 1 / wide - own.sigma**-2.0
    freed = 1 + change * variance
    odds = THROUGHPUT_CHANCE / (1 - THROUGHPUT_CHANCE) * own.sigma / np.sqrt(wide * freed)
    odds *= np.exp(-change * mean**2 / (2 * freed))
    chance = odds / (1 + odds)
    slope = basis @ solution.covariance[:size, at] / variance
    square = chance * (variance / freed - variance + (mean / freed - mean) ** 2)
    return slope * np.sqrt(square), {
        "throughput_chance": float(chance),
        "throughput": float(np.exp(own.centre + mean / freed)),
        "throughput_uncertainty": float(np.sqrt(variance / freed)),
    }


def other_clock(solution, basis, times):
    r"""Change (t,) [K] of the temperature if the other one of two clocks that disagree is right.

    .. math:: \Delta T = \Delta t\,\partial T/\partial t

    Data tell how far the clocks are apart, not which is that of the test: the fit takes one.

    Source: first order of the displaced series; as large as that shift, like what is named and not confirmed.

    Parameters
    ----------
    solution : fit, with the clocks named in its `settings`; 0 K where there are none
    basis : (t, K) array, from its knots to the temperatures [K] at `times`
    times : (t,) array [s]
    """
    late = sum(one.late("pyrometer") - one.late("spectrometer") for one in solution.settings)
    return late * np.gradient(basis @ solution.state.knots, times) if late else np.zeros(len(times))


def _inputs(findings, solution, shift):
    r"""The uncertainty budget of a fit.

    .. math:: \sigma_T^2 = c^T V^{-1} c + \sum_i \mathrm{cov}(T, \theta_i \mid a)^2/\sigma_i^2 + \text{noise}

    with the covariance V of the numbers a of effects and theirs, c, with T: first what it costs not to know
    a, then, a known, as much of each prior as reaches T, and the rest. Effects given come as parameters.
    """
    model = findings.model
    basis, size = model.history.basis(findings.times), model.size
    given = [size + place for place, one in enumerate(model.parameters) if "." in one.id]
    own = [*given, *range(size + len(model.parameters), len(solution.covariance))]
    known, variance, named = _without(solution.covariance, own, basis)
    families = {}
    for place, one in enumerate(model.parameters):
        group = "emittance" if one.id == "emittance" else "gas" if one.id in OF_GAS else "calibration"
        if size + place not in own:
            families.setdefault((one.name, group, one.unit), []).append((place, one.sigma))
    across = _apart(model, [one - size for one in own]) @ known[size : size + len(model.parameters), :size]
    across = (across @ basis.T).T
    rows = []
    for (words, group, unit), members in families.items():
        places, sigmas = (np.array(row) for row in zip(*members, strict=True))
        law = "rectangular" if places[0] == model.index["lamp"] else "normal"
        rows.append(budget.of_family(words, group, across[:, places], sigmas, unit, law))
    rest = budget.remainder(variance - named, rows)
    rows.append(budget.Input("noise of the samples, and errors of single channels", "noise", rest))
    effects = dict.fromkeys(
        one.effect.name for one in (*solution.settings, *(t.setting for t in model.given))
    )
    if effects:
        words = f"size of what is named: {', '.join(effects)}"
        rows.append(budget.Input(words, "named effects", np.sqrt(named)))
    freedom = max(solution.count - findings.fitted, 1)
    excess = np.sqrt(max(solution.objective / freedom - 1, 0.0) * variance)
    misfit = "unnamed misfit"
    if np.any(shift):
        rows.append(
            budget.Input(
                "what was named and is not confirmed, or stands with reserve", "named effects", shift
            )
        )
    throughput = unlike_throughput(model, solution, basis)[0]
    if throughput.any():
        words = "throughput of the pyrometer, were it not as stated"
        rows.append(budget.Input(words, "calibration", throughput, THROUGHPUT_WIDTH, "1"))
    colour = other_colour(model, solution, findings.times)
    if colour.any():
        rows.append(budget.Input("colour of the gas that changes", "gas", colour, COLOUR, "1"))
    return [
        *rows,
        budget.Input(
            "emittance that follows the temperature", "emittance", following(model, solution, basis)
        ),
        budget.Input("misfit beyond the noise", misfit, excess, freedom=float(freedom)),
        budget.Input("numbers moved out of what is known", misfit, strained(model, solution, basis)),
        budget.Input("what no known cause explains", misfit, basis @ findings.unknown_shift),
    ]


def _apart(model, left_out):
    r"""Matrix (V, V) that takes errors of the parameters apart where their prior has them correlated.

    With the prior precision P and :math:`S = \mathrm{diag}(\sigma)`: :math:`S (S P S)^{1/2} S^{-1}`, the
    symmetric root, so that the squares of the contributions add up and each stays nearest to its parameter;
    1 where the errors are independent.
    """
    count, sigma = len(model.parameters), np.array([one.sigma for one in model.parameters])
    kept = np.setdiff1d(np.arange(count), left_out)
    inner = np.ix_(kept, kept)
    value, vector = np.linalg.eigh(model.precision[inner] * np.outer(sigma[kept], sigma[kept]))
    result = np.eye(count)
    result[inner] = sigma[kept, None] * ((vector * np.sqrt(np.maximum(value, 0.0))) @ vector.T) / sigma[kept]
    return result


def _without(covariance, own, basis):
    """The covariance if the numbers at `own` were known, the variance of T (t,), and what they add to it."""
    size = basis.shape[1]
    variance = np.einsum("tk,kl,tl->t", basis, covariance[:size, :size], basis)
    if not own:
        return covariance, variance, np.zeros_like(variance)
    gain = np.linalg.solve(covariance[np.ix_(own, own)], covariance[own])
    known = covariance - covariance[:, own] @ gain
    left = np.einsum("tk,kl,tl->t", basis, known[:size, :size], basis)
    return known, variance, np.maximum(variance - left, 0.0)


def _status(findings, solution, kelvin, deviation):
    """Status (t,) of the temperatures of a fit, see `status.MEANINGS`."""
    times, share = findings.times, np.zeros(findings.times.size)
    for instrument, gas, predicted in zip(
        findings.model.instruments, solution.gas, solution.prediction, strict=True
    ):
        own = np.median(1 - gas / np.where(predicted > 0, predicted, np.inf), axis=1)
        places = np.searchsorted(times, instrument.time)
        share[places] = np.maximum(share[places], own)
    state = np.full(times.size, status.VALID, dtype="int8")
    if findings.reading is not None:
        low, high = findings.reading.fit_range
        state[(kelvin < low) | (kelvin > high)] = status.EXTRAPOLATED
    state[share < SURFACE] = status.GAS_DOMINATED
    state[~(deviation < LARGEST * kelvin)] = status.NO_SIGNAL
    state[times < 0] = status.NOT_INJECTED
    return state


def _paper(findings):
    """Temperature (t,) of the paper's method, its status and its budget; NaN without a pyrometer."""
    times, reading, record = findings.times, findings.reading, findings.record
    kelvin, state = np.full(times.size, np.nan), np.full(times.size, status.MISSING, dtype="int8")
    state[times < 0] = status.NOT_INJECTED
    for instrument in findings.model.instruments:
        if instrument.kind == "pyrometer" and reading is not None:
            places, reference = np.searchsorted(times, instrument.time), reference_of(record)
            kelvin[places], state[places] = paper_temperature(
                instrument.value, instrument.time, record, reading, reference
            )
            taken = [np.where(record.phases(instrument.time)[1], row[:, None], 0.0) for row in reference]
            own = record.emittance_slope, record.emittance_slope_uncertainty
            sloped = replace(reading, slope=own[0], slope_uncertainty=own[1])
            inputs = budget_of(sloped, instrument.value.T, *taken)
            blank = np.full(times.size, np.nan)
            return kelvin, state, [_placed(one, blank, places) for one in inputs]
    return kelvin, state, []


def _placed(one, blank, places):
    whole = blank.copy()
    whole[places] = one.contribution
    return one._replace(contribution=whole)


def largest_shift(findings, temperature):
    """Largest change [K] of the temperature by the extension, where both are hot and have settled; 0 where
    they nowhere are."""
    time = temperature["time_bin"].values
    change = (temperature["extended_temperature"] - temperature["base_temperature"]).values
    hot = (
        (time >= findings.span[0]) & (temperature["base_temperature"].values > COLDEST) & np.isfinite(change)
    )
    return float(change[hot][np.argmax(np.abs(change[hot]))]) if hot.any() else 0.0
