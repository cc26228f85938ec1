"""Entries of the effects: those named and those like them, what would not be seen, and what would decide."""

import numpy as np

from plasmapyro.diagnosis.fit.setting import free_numbers
from plasmapyro.diagnosis.report import show
from plasmapyro.diagnosis.report.kelvin import fitted_shift
from plasmapyro.diagnosis.report.sentences import candidate_sentence
from plasmapyro.diagnosis.select.screen import LEAST_LEFT, angles, best_by_id, linear_evidence

SHOWN = 12  # candidates in the report besides those named
JUST_SEEN = 5.0  # standard deviations
UNSEEN_ERROR = 10.0  # prior standard deviations: error of an amplitude that the data do not show
LEAST_EVIDENCE = -1e6


def candidates(findings):
    """Entries of the effects named, as fitted, and of the others, as linearised, dearest first."""
    screen, gains, final = findings.first.screen, findings.first.gains, findings.final
    angle = angles(screen.information[: screen.count, : screen.count])
    order = best_by_id(screen.candidates, gains)
    fitted = {setting.id: place for place, setting in enumerate(final.settings)}
    shown = [i for i in order if screen.candidates[i].id in fitted]
    shown += [i for i in order if screen.candidates[i].id not in fitted][:SHOWN]
    evidence, entries = linear_evidence(screen), []
    for index in shown:
        candidate = screen.candidates[index]
        effect = candidate.effect
        if candidate.id in fitted:
            amplitude, error, shape = _as_fitted(findings, fitted[candidate.id])
        else:
            amplitude, error, shape = _as_linearised(screen, index)
        others = [j for j in order if screen.candidates[j].id != candidate.id and screen.left[j] > LEAST_LEFT]
        nearest = min(others, key=lambda j: angle[index, j]) if others else None
        paper, when = findings.paper_shift(effect, amplitude, shape)
        linear = effect.linear_of(amplitude)
        fit, when_fit = fitted_shift(
            findings.model, findings.base.solution, screen, index, linear, findings.span
        )
        entry = {
            "id": candidate.id,
            "name": effect.name,
            "class": effect.klass,
            "stage": effect.stage,
            "rank": 0,
            "amplitude": float(amplitude),
            "standard_error": error,
            "interval95": [float(amplitude - 1.96 * error), float(amplitude + 1.96 * error)],
            "unit": effect.unit,
            "amplitude_name": effect.amplitude,
            "shape": shape,
            "gain_chi2": float(gains[index]),
            "log_evidence": show.number(max(evidence[index], LEAST_EVIDENCE)),
            "probability": float(findings.probability[0].get(candidate.id, 0.0)),
            "significance": float(abs(amplitude) / error),
            "angle_to_next": None if nearest is None else float(angle[index, nearest]),
            "next": None if nearest is None else screen.candidates[nearest].id,
            "temperature_shift": {
                "paper": paper,
                "base": fit,
                "at_time": float(when if abs(paper) > abs(fit) else when_fit),
            },
            "phases": list(effect.phases),
            "instruments": list(effect.instruments),
            "sentence": "",
        }
        entry["sentence"] = candidate_sentence(entry)
        entries.append(entry)
    least = findings.selection.thresholds.effect

    def rank(entry):
        cost = max(abs(entry["temperature_shift"]["paper"]), abs(entry["temperature_shift"]["base"]))
        supported = entry["id"] in fitted or entry["gain_chi2"] > least
        return (entry["id"] not in fitted, not supported, -cost if supported else -entry["gain_chi2"])

    entries.sort(key=rank)
    return [entry | {"rank": place} for place, entry in enumerate(entries, 1)]


def _as_fitted(findings, place):
    """Amplitude, standard error and shape of a setting of the final fit."""
    final = findings.final
    (row,) = (
        j
        for j, number in enumerate(free_numbers(final.settings))
        if number.place == place and number.name is None
    )
    at, setting = findings.size + row, final.settings[place]
    error = float(np.sqrt(final.covariance[at, at]))
    return setting.amplitude, error, {name: float(value) for name, value in setting.shape.items()}


def _as_linearised(screen, index):
    """Amplitude, standard error and shape of a candidate alone, by its column."""
    candidate = screen.candidates[index]
    effect, shape = candidate.effect, {name: float(value) for name, value in candidate.shape.items()}
    if screen.left[index] <= LEAST_LEFT:
        return 0.0, float(UNSEEN_ERROR * effect.sigma), shape
    amplitude = float(screen.amplitudes()[index])
    error = float(1 / np.sqrt(screen.information[index, index]))
    if effect.quadratic:
        error = float(effect.amplitude_of(effect.linear_of(amplitude) + error)) - amplitude
    return amplitude, error, shape


def limits(findings):
    """Entries of what remains possible and would not be seen, worst first."""
    screen = findings.first.screen
    information = np.diag(screen.information)[: screen.count]
    best = {}
    for index, candidate in enumerate(screen.candidates):
        if candidate.id not in best or information[index] > information[best[candidate.id]]:
            best[candidate.id] = index
    rows = []
    for identity, index in best.items():
        effect = screen.candidates[index].effect
        seen = screen.left[index] > LEAST_LEFT
        just_seen = effect.amplitude_of(JUST_SEEN / np.sqrt(information[index])) if seen else np.inf
        per_unit, _ = findings.paper_shift(effect, effect.step, screen.candidates[index].shape)
        per_unit /= effect.linear_of(effect.step)
        limit = float(min(just_seen, max(abs(bound) for bound in effect.bounds)))
        rows.append(
            {
                "id": identity,
                "name": effect.name,
                "amplitude_5sigma": limit,
                "unit": effect.unit,
                "temperature_5sigma": float(abs(per_unit * effect.linear_of(limit))),
                "temperature_prior": float(abs(per_unit * effect.linear_of(effect.sigma))),
                "invisible": bool(just_seen > effect.sigma),
                "measurement": effect.measurement,
            }
        )
    rows.sort(key=lambda row: -(row["temperature_prior"] if row["invisible"] else row["temperature_5sigma"]))
    rows.sort(key=lambda row: not row["invisible"])
    return rows


def missing_evidence(findings):
    """Measurements that would decide between effects that the data do not tell apart."""
    decides = {}
    for ids in findings.selection.sets:
        for identity in ids if len(ids) > 1 else ():
            decides.setdefault(findings.effects[identity].measurement, set()).update(ids)
    return [
        {"measurement": measurement, "decides": sorted(ids), "expected_significance": None}
        for measurement, ids in decides.items()
    ]


def likeness(findings):
    """Angles between the best candidates."""
    screen = findings.first.screen
    order = best_by_id(screen.candidates, findings.first.gains)[:SHOWN]
    angle = angles(screen.information[: screen.count, : screen.count])
    return {
        "ids": [screen.candidates[i].id for i in order],
        "degrees": [[show.number(angle[i, j]) if i != j else 0.0 for j in order] for i in order],
    }
