"""The extended model: its effects, and what it is worth on data that the fit has not seen."""

import numpy as np

from plasmapyro.diagnosis.effects.condition import OF_CONDITION
from plasmapyro.diagnosis.effects.effect import REGISTER
from plasmapyro.diagnosis.fit.setting import Setting, free_numbers
from plasmapyro.diagnosis.fit.terms import AMPLITUDE, Term, text_of
from plasmapyro.diagnosis.report import show
from plasmapyro.diagnosis.report.foreign import terms_of_jet
from plasmapyro.diagnosis.simulation.compare import HOTTER

HOT = 1000.0  # [K] from which the uncertainty of a temperature is given


def extension(findings):
    """Entry of the extended model, None where nothing is named."""
    final = findings.final
    if not final.settings:
        return None
    free = free_numbers(final.settings)
    errors = np.sqrt(np.maximum(np.diag(final.covariance)[findings.size :], 0))
    terms = tuple(_terms(final.settings, errors))
    entries = [
        {
            "id": term.setting.id,
            "parameters": {name: float(term.numbers[name]) for name in term.uncertainty},
            "standard_errors": term.uncertainty,
        }
        for term in terms
    ]
    gained = findings.gained
    better = "improve" if gained.improves else "do not improve significantly"
    if gained.improves and not findings.applied:
        better = "improve, but nothing being wrong is likelier"
    return {
        "configuration": text_of(terms, data=findings.data),
        "terms": entries,
        "chi2": float(final.chi2),
        "dof": float(final.count - findings.fitted - len(free)),
        "applied": findings.applied,
        "why": f"held-out data {better}: by {gained.total / max(gained.standard_error, 1e-9):.1f} standard"
        " errors of their log score",
    }


def worth(findings, shift):
    """Entry of what the extension gains, None without one; `shift` [K] of the temperature at worst."""
    gained, base, final = findings.gained, findings.base.solution, findings.final
    if gained is None:
        return None
    return {
        "heldout_log_score": gained.total,
        "heldout_standard_error": gained.standard_error,
        "calibration": gained.calibration,
        "blocks": [{"start": a, "end": b, "difference": d} for a, b, d in gained.blocks],
        "cross_instrument": gained.cross_instrument,
        "cross_condition": findings.crossed,
        "kappa_before": _mean_step(findings, base),
        "kappa_after": _mean_step(findings, final),
        "temperature_shift": shift,
        "temperature_sigma_base": _sigma(findings, base),
        "temperature_sigma_extended": _sigma(findings, final),
    }


def _sigma(findings, solution):
    """Median standard deviation [K] of the temperature, where it is hot and has settled, if anywhere."""
    knots, (first, last) = findings.model.history.knots, findings.span
    hot = (solution.state.knots > HOT) & (knots >= first) & (knots <= last)
    sigma = np.sqrt(np.diag(solution.covariance)[: knots.size])
    return float(np.median(sigma[hot] if hot.any() else sigma))


def _mean_step(findings, solution):
    """Weighted mean over the channels of the step at the end of the plasma over the gas before it."""
    step = show.kappa(findings.model, findings.base.fitter, solution)
    pairs = [(k, e) for k, e in zip(step["kappa"], step["error"], strict=True) if k is not None and e]
    if not pairs:
        return None
    values, errors = np.array(pairs).T
    return float(np.sum(values / errors**2) / np.sum(1 / errors**2))


def proposed(findings):
    """Terms that a diagnosis proposes to take as given, of the test and of the simulation of its gas.

    What it was given itself comes first: as it was, or as the fit leaves it if it was fitted to these data.
    Terms of the test are proposed where held-out data speak for them; a power that `simulation.compare` calls
    wrong.
    """
    fit = findings.final if findings.applied else findings.base.solution
    model, errors = findings.model, np.sqrt(np.maximum(np.diag(fit.covariance), 0))
    of_test = []
    for term in (one for one in model.given if one.setting.id in REGISTER):
        if not term.own:
            of_test.append(term)
            continue
        places = {name: model.index[f"{term.setting.id}.{name}"] for name in term.uncertainty}
        setting = term.at({name: fit.state.values[place] for name, place in places.items()})
        sigma = {name: errors[model.size + place] for name, place in places.items()}
        of_test.append(Term(setting, sigma, own=True))
    of_test += _terms(fit.settings, errors[findings.size :])
    found = findings.comparison.final
    errors = np.sqrt(np.maximum(np.diag(found.covariance), 0))
    rest = list(_terms(found.settings, errors[2:]))
    of_test += [one for one in rest if one.setting.effect.stage != "gas"]  # of the spectrometer
    of_gas = [one for one in rest if one.setting.id in OF_CONDITION and one.setting.id != HOTTER]
    power, given = OF_CONDITION["power"], {term.setting.id: term for term in model.library.given}
    if findings.comparison.power_is_wrong:
        change, error = findings.comparison.power
        if power.id in given:
            change += np.log1p(given.pop(power.id).setting.amplitude)
        size = float(np.clip(np.expm1(change), *power.bounds))
        of_gas.append(Term(Setting(power, size), {AMPLITUDE: float(error * (1 + size))}, own=True))
    of_gas = [*given.values(), *of_gas, *terms_of_jet(findings.foreign)]
    return tuple(of_test), tuple(of_gas)


def _terms(settings, errors):
    """Terms of fitted settings with the standard errors of their free numbers."""
    free = free_numbers(settings)
    for place, setting in enumerate(settings):
        own = [j for j, number in enumerate(free) if number.place == place]
        yield Term(setting, {free[j].name or AMPLITUDE: float(errors[j]) for j in own}, own=True)


def terms_text(findings):
    """What `plasmapyro diagnose` writes as terms.yaml: effects of the test, and of the simulated gas."""
    of_test, of_gas = proposed(findings)
    return (
        "# Effects that this diagnosis proposes: for `--with`, or as the key `effects` of the files named.\n"
        f"test:  # config/tests\n{text_of(of_test, '  ', findings.data)}"
        f"condition:  # config/conditions, {findings.record.attributes['condition']}\n"
        f"{text_of(of_gas, '  ', findings.data)}"
    )
