"""Surface temperatures of a test: of the paper, of the base model, of the extended model."""

import numpy as np
import xarray as xr

from plasmapyro.diagnosis.report.interval import estimated_beside_bounded
from plasmapyro.diagnosis.report.kelvin import COLDEST, paper_temperature
from plasmapyro.diagnosis.select.search import PULL

OF_GAS = ("gas", "before_injection", "before_power")  # parameters of a light that is measured


def temperatures(findings):
    """Temperatures with 95 % intervals at the middles of all bins.

    Parameters
    ----------
    findings : Findings

    Returns
    -------
    Dataset, contract 'diagnosis_temperature'
    """
    times, base, final = findings.times, findings.base.solution, findings.final
    basis = findings.model.history.basis(times)
    # Effects that the data ask for but held-out data do not confirm: their shift is an uncertainty.
    shift = 0.0 if findings.applied else basis @ (final.state.knots - base.state.knots)
    rows = {
        "base": _interval(findings, base),
        "extended": _interval(findings, final if findings.applied else base, shift),
    }
    return xr.Dataset(
        {"paper_temperature": ("time_bin", _paper(findings))}
        | {
            f"{model}_temperature{end}": ("time_bin", values)
            for model, three in rows.items()
            for end, values in zip(("", "_low", "_high"), three, strict=True)
        },
        {"time_bin": times},
        {
            "title": "Surface temperature: of the paper, of the base model, of the extended model",
            "applied": int(findings.applied),
            "terms": " ".join(setting.id for setting in final.settings),
            "origin": str(findings.record.attributes.get("origin", "measured")),
        },
    )


def _interval(findings, solution, unsure=0.0):
    """Temperature (t,) of a fit and the ends of its interval, NaN before the injection."""
    model, times = findings.model, findings.times
    basis, size, lamp = model.history.basis(times), model.size, model.index["lamp"]
    mean, covariance = basis @ solution.state.knots, solution.covariance
    unsure = np.hypot(np.hypot(unsure, strained(model, solution, basis)), basis @ findings.unknown_shift)
    variance = np.einsum("tk,kl,tl->t", basis, covariance[:size, :size], basis)
    # What the model leaves of the data beyond their noise is in the interval as well.
    misfit = max(solution.objective / max(solution.count - findings.fitted, 1), 1.0)
    # The bias of the calibration source is bounded, not normal.
    spread = estimated_beside_bounded(
        misfit * variance + unsure**2,
        np.sqrt(misfit) * (basis @ covariance[:size, size + lamp]),
        model.parameters[lamp].sigma,
    )
    return [np.where(times >= 0, values, np.nan) for values in (mean, mean - spread, mean + spread)]


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


def _paper(findings):
    """Temperature (t,) of the paper's method, NaN without a pyrometer."""
    times = findings.times
    paper = np.full(times.size, np.nan)
    for instrument in findings.model.instruments:
        if instrument.kind == "pyrometer" and findings.reading is not None:
            kelvin, _ = paper_temperature(
                instrument.value, instrument.time, findings.record, findings.reading
            )
            paper[np.searchsorted(times, instrument.time)] = kelvin
    return paper


def largest_shift(findings, temperature):
    """Largest change [K] of the temperature by the extension, where it is hot and has settled."""
    time = temperature["time_bin"].values
    change = (temperature["extended_temperature"] - temperature["base_temperature"]).values
    hot = (time >= findings.span[0]) & (temperature["base_temperature"].values > COLDEST)
    return float(change[hot][np.argmax(np.abs(change[hot]))]) if hot.any() else 0.0
