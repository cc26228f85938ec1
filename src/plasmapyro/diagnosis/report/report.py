"""The report of a diagnosis, by its schema."""

from itertools import pairwise

import numpy as np
from scipy.special import expit

from plasmapyro.diagnosis.fit.inference import log_evidence
from plasmapyro.diagnosis.fit.no_plasma import LAMP
from plasmapyro.diagnosis.fit.noise import period_of
from plasmapyro.diagnosis.report import show
from plasmapyro.diagnosis.report.candidates import candidates, likeness, limits, missing_evidence
from plasmapyro.diagnosis.report.extended import extension, worth
from plasmapyro.diagnosis.report.following import following
from plasmapyro.diagnosis.report.line_hump import line_against_hump
from plasmapyro.diagnosis.report.lines import species_of
from plasmapyro.diagnosis.report.posterior import posterior
from plasmapyro.diagnosis.report.sentences import verdict_sentences
from plasmapyro.diagnosis.report.simulation import entries_of, power_sentences, simulation
from plasmapyro.diagnosis.report.temperature import largest_shift
from plasmapyro.diagnosis.select import excursion, left_in_bands, leftover, pixels
from plasmapyro.diagnosis.select.probability import PRIOR_NONE, prior_share
from plasmapyro.diagnosis.select.reserve import SENTENCES as RESERVES
from plasmapyro.diagnosis.select.screen import columns_of_candidates

SCHEMA = "plasmapyro-diagnosis-1"
LEVEL = 0.05  # false alarms of both tests together
ASSUMPTIONS = (
    "the gas shines as it did before injection, but for its brightness and a change as of another power",
    "the simulated gas errs by what its data state, in local thermal equilibrium unless an effect says else",
    "a grey emittance in the base model, known as stated in the test",
    "the source temperature of the calibration lies within its uncertainty, uniformly",
    "the catalogue of effects is finite: what it lacks can only be called unknown",
)


def report_of(findings, temperature):
    """Everything that is said of a test, by the schema of `diagnosis.json`."""
    shift = largest_shift(findings, temperature)
    entries, hidden = [*candidates(findings), *entries_of(findings)], limits(findings)
    verdict = _verdict(findings, entries, hidden, shift)
    return {
        "schema": SCHEMA,
        "findings": [],
        "dataset": _dataset(findings),
        "noise": _noise(findings.base),
        "base": _base(findings),
        "tests": _tests(findings),
        "thresholds": _thresholds(findings.selection.thresholds),
        "candidates": entries,
        "verdict": verdict,
        "checks": _checks(findings),
        "discrepancy": _discrepancy(findings),
        "simulation": simulation(findings),
        "extended": extension(findings),
        "gain": worth(findings, shift),
        "limits": hidden,
        "posterior": posterior(findings),
        "next": _next(findings, entries, verdict["set"]),
        "show": _show(findings),
        "assumptions": list(ASSUMPTIONS),
        "provenance": _provenance(findings),
    }


def _dataset(findings):
    model, attributes, provenance = findings.model, findings.record.attributes, findings.provenance
    rows = []
    for identity, name, first, last in findings.phases:
        inside = [(instrument.time >= first) & (instrument.time < last) for instrument in model.instruments]
        rows.append(
            {
                "id": identity,
                "name": name,
                "start": float(first),
                "end": float(last),
                "samples": int(sum(part.sum() for part in inside)),
            }
        )
    spectral = [instrument.channels for instrument in model.instruments if instrument.kind == "spectrometer"]
    return {
        "title": str(attributes.get("title", "")),
        "condition": str(attributes["condition"]),
        "origin": provenance.get("origin", str(attributes.get("origin", "measured"))),
        "sha256": provenance.get("test", ""),
        "instruments": [instrument.kind for instrument in model.instruments],
        "phases": rows,
        "plasma_off_time": float(model.off),
        "time_bins": max(instrument.time.size for instrument in model.instruments),
        "wavelength_bins": max(spectral, default=0),
    }


def _next(findings, entries, groups):
    shifts = {entry["id"]: entry["temperature_shift"]["base"] for entry in entries}
    fit = findings.final if findings.applied else findings.base.solution
    return following(findings.model, fit, groups, shifts)


def _noise(base):
    rows = []
    for instrument, law in zip(base.model.instruments, base.noise_models, strict=True):
        kinds = instrument.band or ("spectrometer",)
        for place, name in enumerate(kinds):
            level = np.nanmedian(
                instrument.value[:, place] if instrument.kind == "pyrometer" else instrument.value
            )
            factor = 1.0 if instrument.factor is None else float(np.median(instrument.factor))
            constant = float(np.ravel(law.constant)[min(place, np.size(law.constant) - 1)])
            variance = constant * factor**2 + law.linear * factor * level + law.quadratic * level**2
            rows.append(
                {
                    "channel": name,
                    "relative": float(np.sqrt(max(variance, 0)) / level) if level > 0 else 0.0,
                    "constant": constant,
                    "linear": float(law.linear),
                    "quadratic": float(law.quadratic),
                    "lag1": float(law.memory),
                    "tail": float(law.tail),
                    "unit": "A" if instrument.kind == "pyrometer" else "count",
                }
            )
        rows.append(
            {
                "channel": f"gas flicker ({instrument.kind})",
                "relative": float(np.sqrt(law.flicker.total)),
                "constant": 0.0,
                "linear": 0.0,
                "quadratic": law.flicker.total,
                "lag1": 1 - float(law.flicker.between(period_of(instrument))) / law.flicker.total
                if law.flicker.total
                else 0.0,
                "tail": 1.0,
                "unit": "1",
            }
        )
    return rows


def _base(findings):
    solution = findings.base.solution
    return {
        "chi2": float(solution.chi2),
        "dof": float(solution.count - findings.fitted),
        "converged": bool(solution.converged),
        "adequate": not findings.misfit,
        "why": findings.misfit,
        "by_phase": show.phase_table(findings.model, findings.base.solution, findings.residuals[0]),
        "pulls": findings.pulls,
    }


def _tests(findings):
    first, thresholds = findings.first, findings.selection.thresholds
    gain, unknown = first.gains.max(), float(first.unknown.max())
    return [
        {
            "id": "any",
            "name": "largest chi-squared gain of one effect",
            "statistic": float(gain),
            "p": float(thresholds.p_effect(gain)),
            "threshold": float(thresholds.effect),
        },
        {
            "id": "unknown",
            "name": "largest log Bayes factor of an unknown structure",
            "statistic": unknown,
            "p": float(thresholds.p_unknown(unknown)),
            "threshold": show.number(thresholds.unknown),
        },
    ]


def _thresholds(thresholds):
    return {
        "effect": float(thresholds.effect),
        "unknown": show.number(thresholds.unknown),
        "third": float(thresholds.third),
        "nulls": int(thresholds.draws),
        "seed": int(thresholds.seed),
        "level": LEVEL,
    }


def _verdict(findings, entries, hidden, shift):
    selection, settings = findings.selection, findings.named
    named = [setting.id for setting in settings]
    sets = [*map(list, selection.sets), *([i, *ids] for i, ids in findings.comparison.rivals.items())]
    p_base = float(min(1.0, 2 * min(test["p"] for test in _tests(findings))))
    unsure = [findings.misfit] if findings.misfit else []
    unsure += power_sentences(findings.comparison)
    unsure += [RESERVES[selection.reserve]] if selection.reserve else []
    unsure += [
        f"The fit moves the {row['name']} by {row['pull']:+.1f} prior standard deviations."
        for row in findings.pulls
        if row["finding"]
    ]
    probability, uncalibrated = findings.probability
    return {
        "status": findings.status,
        "named": named,
        "set": sets if named else [],
        "class": [setting.effect.klass for setting in settings],
        "probability": probability,
        "joint_probability": _joint(findings),
        "uncalibrated": uncalibrated,
        "p_base": p_base,
        "unknown": findings.unknown,
        "temperature_shift": shift,
        "sentences": verdict_sentences(
            findings.status,
            {entry["id"]: entry for entry in entries},
            [setting.id for setting in findings.final.settings],
            [setting.id for setting in findings.comparison.final.settings],
            p_base,
            _name_of_unknown(findings),
            findings.gained,
            hidden,
            unsure,
            [term.setting.effect.name for term in findings.model.given if term.setting.id == LAMP],
            found_apart(findings),
        ),
        "missing_evidence": missing_evidence(findings),
    }


def _joint(findings):
    r"""Probability that all effects named in the test are right, None without any.

    .. math:: p = p_1 \prod_{k>1} \min(p_k, p_1), \qquad
              \ln\frac{p_k}{1-p_k} = \ln\frac{Z_k}{Z_{k-1}} + \ln\frac{\pi_k}{\pi_{none}}

    with that of the first answer, p_1, as measured on simulated cases, and the evidence Z of each round; no
    further name is called surer than the first. A round that put names in the place of others says nothing of
    one of them: each then counts as the first.
    """
    settings, steps = findings.final.settings, findings.selection.steps
    if not settings:
        return None
    first = max(findings.probability[0].get(setting.id, 0.0) for setting in settings)
    share = prior_share(len(findings.effects)) - np.log(PRIOR_NONE)
    further = {setting.id: first for setting in settings}
    for before, after in pairwise(steps):
        old, new = ({setting.id for setting in step.settings} for step in (before, after))
        if old and old < new and len(new - old) == 1:
            gained = np.subtract(*(log_evidence(step.solution, findings.size) for step in (after, before)))
            further |= {name: min(float(expit(gained + share)), first) for name in new - old}
    return float(np.prod([further[setting.id] for setting in settings]))


def _name_of_unknown(findings):
    names = {structure.id: structure.name for structure in findings.first.screen.structures}
    names |= leftover.names(findings.model.instruments) | left_in_bands.names(findings.model.instruments)
    names |= pixels.NAMES
    if findings.selection.unknown_class == excursion.EXCURSION:
        return excursion.name(findings.model, findings.unknown_shift)
    return names.get(findings.selection.unknown_class)


def found_apart(findings):
    """Whether what is unknown is not of the two tests of `p_base`: no structure of theirs, or neither is
    beyond chance."""
    first, limits = findings.first, findings.selection.thresholds
    structures = {structure.id for structure in first.screen.structures}
    beyond = first.unknown.max() > limits.unknown or first.gains.max() > limits.effect
    return findings.selection.unknown_class not in structures or not beyond


def _checks(findings):
    """Of the final model: its p-value, and chi-squared by phase and kind of channel."""
    return {
        "p": findings.p_value,
        "by_phase": show.phase_table(findings.model, findings.final, findings.residuals[1]),
    }


def _discrepancy(findings):
    last, unknown = findings.selection.steps[-1], findings.selection.unknown_class
    classes = zip(last.screen.structures, last.unknown, strict=True)
    return {
        "class": unknown,
        "name": _name_of_unknown(findings),
        "log_bayes": float(last.unknown.max()),
        "per_class": [
            {"id": structure.id, "name": structure.name, "log_bayes": float(value)}
            for structure, value in classes
        ],
        "rank1": show.leading_pattern(findings.model, findings.residuals[1]) if unknown else None,
        "lines": species_of(findings),
    }


def _show(findings):
    model, fitter, base = findings.model, findings.base.fitter, findings.base.solution
    residuals, screen = findings.residuals[0], findings.first.screen
    _, columns = columns_of_candidates(model, base, findings.selection.effects)
    correlation, quantile = show.series(model, residuals)
    return {
        "phases": [row[0] for row in findings.phases],
        "signals": show.signals(model, base, findings.final),
        "kappa": show.kappa(model, fitter, base),
        "emittance_loop": show.emittance_loop(model, fitter, base),
        "line_hump": line_against_hump(findings),
        "gas_monitor": show.gas_monitor(model, fitter, base),
        "components": show.components(model, residuals, screen, columns),
        "autocorrelation": correlation,
        "quantiles": quantile,
        "profile": show.profile(findings.final, findings.size),
        "angles": likeness(findings),
    }


def _provenance(findings):
    provenance = findings.provenance
    return {
        "version": provenance.get("version", "unknown"),
        "commit": provenance.get("commit"),
        "seed": int(findings.selection.thresholds.seed),
        "files": dict(provenance.get("files", {})),
        "blind_score": provenance.get("blind_score"),
    }
