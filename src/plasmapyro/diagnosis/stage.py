"""Stage: the diagnosis of one test, from its data to a report, a map of the residuals and temperatures."""

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from plasmapyro.diagnosis import show
from plasmapyro.diagnosis.base import fit_base
from plasmapyro.diagnosis.build import base_model
from plasmapyro.diagnosis.catalogue import EFFECTS
from plasmapyro.diagnosis.extension import fragment
from plasmapyro.diagnosis.gain import cross_condition, gain
from plasmapyro.diagnosis.inference import free_numbers
from plasmapyro.diagnosis.interval import estimated_beside_bounded
from plasmapyro.diagnosis.kelvin import PaperShift, fitted_shift, paper_temperature
from plasmapyro.diagnosis.library import gas_library
from plasmapyro.diagnosis.probability import honest
from plasmapyro.diagnosis.reserve import SENTENCES as RESERVES
from plasmapyro.diagnosis.screen import angles, columns_of_candidates
from plasmapyro.diagnosis.select import PULL, Selector, best_by_id, linear_evidence
from plasmapyro.diagnosis.sentences import candidate_sentence, verdict_sentences

SCHEMA = "plasmapyro-diagnosis-1"
PRIOR_NONE, PRIOR_UNKNOWN = 0.5, 0.1  # before the data; the catalogue shares the rest
LARGEST_MISFIT = (
    1.25  # chi-squared per number, beyond which single causes are not judged, if nothing explains it
)
NEED_VARIATIONS = ("P_eff", "ripple", "T_exc", "T_vib", "selfabs", "refl", "bl", "CN")
SHOWN = 12  # candidates in the report besides those named
ASSUMPTIONS = (
    "local thermal equilibrium of the simulated gas, unless a term says otherwise",
    "a grey emittance in the base model, known as stated in the test",
    "the source temperature of the calibration lies within its uncertainty, uniformly",
    "before injection and after it the gas has the same spectrum, at another brightness",
    "the catalogue of effects is finite: what it lacks can only be called unknown",
)


@dataclass(frozen=True)
class Diagnosis:
    """What a diagnosis hands over: `report` (by the schema), `residual_map` and `temperature` datasets."""

    report: dict
    residual_map: xr.Dataset
    temperature: xr.Dataset


def diagnose(
    test,
    radiation,
    powers,
    variations,
    response,
    calibration=None,
    spectrometer_calibration=None,
    *,
    exclude=(),
    draws=2000,
    seed=1,
    provenance=None,
    thresholds=None,
    others=(),
):
    """Diagnose one test against the simulation of its condition.

    Parameters
    ----------
    test : Dataset, contract 'test', without faults (`experiment.inputs.faults`)
    radiation : mapping condition -> Dataset, contract 'radiation'
    powers : mapping condition -> float [W]
    variations : Dataset, contract 'gas_variations', of the condition of the test, or None
        Without it the terms that need it are not looked for.
    response : Dataset, contract 'response'
    calibration, spectrometer_calibration : Datasets or None
    exclude : ids of effects that are taken out of the catalogue
    draws, seed : int
        Simulated nulls behind the thresholds.
    provenance : dict, optional
        Goes into the report.
    thresholds : Thresholds, optional
        Of an alike data set, instead of new ones.
    others : sequence of (test, variations)
        Tests with the same instruments, at other conditions, on which the terms are tried.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ValueError
        Unknown condition or effect.
    """
    unknown = set(exclude) - set(EFFECTS)
    if unknown:
        raise ValueError(
            f"exclude must name effects among {', '.join(EFFECTS)}; got {', '.join(sorted(unknown))}"
        )

    def fitted(test, variations):
        fwhm = float(test.attrs.get("spectrometer_fwhm", 0.75e-9))
        library = gas_library(str(test.attrs["condition"]), radiation, powers, variations, fwhm=fwhm)
        return fit_base(base_model(test, library, calibration, response, spectrometer_calibration))

    base = fitted(test, variations)
    if variations is None:
        exclude = (*exclude, *NEED_VARIATIONS)
    selector = Selector(base.model, base.fitter, thresholds, exclude, draws, seed)
    selection = selector.run(base.solution)
    crossed = None
    if selection.final.settings and others:
        crossed = sum(_crossed(base, selection.final, fitted(*other)) for other in others)
    curve = None
    if calibration is not None:
        curve = (
            calibration["calibration_temperature"].values,
            calibration["calibration_ratio"].values,
        )
    return _Report(test, base, selection, selector, curve, provenance or {}, crossed).make()


def _crossed(base, final, other):
    """Log score of another test with the terms of this one."""
    start = replace(other.solution.state, amplitudes=final.state.amplitudes)
    with_terms = other.fitter.fit(start, final.settings)
    sizes = [one.model.size + len(one.model.parameters) for one in (base, other)]
    return cross_condition(final, other.solution, with_terms, *sizes)


class _Report:
    """Puts the pieces together."""

    def __init__(self, test, base, selection, selector, curve, provenance, crossed):
        self.test, self.base, self.selection, self.selector = test, base, selection, selector
        self.model, self.fitter = base.model, base.fitter
        self.curve, self.provenance, self.crossed = curve, provenance, crossed
        self.size = self.model.size + len(self.model.parameters)
        self.window = np.asarray(test.attrs.get("reference_window", (0.0, 6.0)), dtype=float)
        self.paper = PaperShift(self.model, base.solution, self.window, curve)

    def make(self):
        """Report and datasets."""
        final, first = self.selection.final, self.selection.steps[0]
        z_base = show.residuals(self.model, self.fitter, self.base.solution)
        z_final = show.residuals(self.model, self.fitter, final)
        gained = gain(self.model, self.base.solution, final) if final.settings else None
        applied = bool(gained is not None and gained.improves)
        status, why = self._status(final)
        self.probability, uncalibrated = honest(self._log_weights(first), status)
        candidates = self._candidates(first, final)
        limits = self._limits(first)
        terms = [setting.id for setting in final.settings]
        by_id = {entry["id"]: entry for entry in candidates}
        limits_of = self.selection.thresholds
        p_effect = limits_of.p_effect(first.gains.max())
        p_unknown = limits_of.p_unknown(float(first.unknown.max()))
        p_base = float(min(1.0, 2 * min(p_effect, p_unknown)))
        unknown_name = self._structure_name(self.selection.unknown_class)
        pulls = self._pulls(final)
        unsure = [why] if why else []
        unsure += [RESERVES[self.selection.reserve]] if self.selection.reserve else []
        unsure += [
            f"The fit moves the {row['name']} by {row['pull']:+.1f} prior standard deviations."
            for row in pulls
            if row["finding"]
        ]
        sets = [list(one) for one in self.selection.sets]
        correlation, quantile = show.series(self.model, z_base)
        _, columns = columns_of_candidates(self.model, self.base.solution, self.selector.exclude)
        temperature = self._temperature(final, applied)
        shift = self._shift(temperature)
        report = {
            "schema": SCHEMA,
            "dataset": self._dataset(),
            "noise": self._noise(),
            "base": {
                "chi2": float(self.base.solution.chi2),
                "dof": float(self.base.solution.count - self.size),
                "converged": bool(self.base.solution.converged),
                "adequate": status != "not-adequate",
                "why": why,
                "by_phase": show.phase_table(self.model, z_base),
                "pulls": pulls,
            },
            "tests": [
                {
                    "id": "any",
                    "name": "largest chi-squared gain of one effect",
                    "statistic": float(first.gains.max()),
                    "p": float(p_effect),
                    "threshold": float(limits_of.effect),
                },
                {
                    "id": "unknown",
                    "name": "largest log Bayes factor of an unknown structure",
                    "statistic": float(first.unknown.max()),
                    "p": float(p_unknown),
                    "threshold": show.number(limits_of.unknown),
                },
            ],
            "thresholds": {
                "effect": float(limits_of.effect),
                "unknown": show.number(limits_of.unknown),
                "third": float(limits_of.third),
                "nulls": int(limits_of.draws),
                "seed": int(limits_of.seed),
                "level": 0.05,
            },
            "candidates": candidates,
            "verdict": {
                "status": status,
                "named": terms,
                "set": sets,
                "class": [EFFECTS[identity].klass for identity in terms],
                "probability": self.probability,
                "uncalibrated": uncalibrated,
                "p_base": p_base,
                "temperature_shift": shift,
                "sentences": verdict_sentences(
                    status, by_id, terms, p_base, unknown_name, gained, limits, unsure
                ),
                "missing_evidence": self._evidence(sets),
            },
            "discrepancy": self._discrepancy(unknown_name, z_final),
            "extended": self._extended(final, gained, applied),
            "gain": self._gain(gained, temperature, final, shift),
            "limits": limits,
            "show": {
                "phases": [row[0] for row in show.phases(self.model)],
                "signals": self._signals(final),
                "kappa": show.kappa(self.model, self.fitter, self.base.solution),
                "emittance_loop": show.emittance_loop(self.model, self.fitter, self.base.solution),
                "line_hump": self._line_hump(),
                "gas_monitor": show.gas_monitor(self.model, self.fitter, self.base.solution, self.test),
                "components": show.components(self.model, z_base, first.found, columns),
                "autocorrelation": correlation,
                "quantiles": quantile,
                "profile": show.profile(final, self.size),
                "angles": self._angles(first),
            },
            "assumptions": list(ASSUMPTIONS),
            "provenance": {
                "version": self.provenance.get("version", "unknown"),
                "commit": self.provenance.get("commit"),
                "seed": int(limits_of.seed),
                "files": dict(self.provenance.get("files", {})),
                "blind_score": self.provenance.get("blind_score"),
            },
        }
        return Diagnosis(report, self._residual_map(final, z_base, z_final), temperature)

    def _status(self, final):
        """Status of the verdict and, if the base fit is not adequate, why."""
        status = self.selection.status
        last = self.selection.final
        misfit = last.objective / max(last.count - self.model.size, 1)
        if not last.converged:
            return "not-adequate", "The fit did not converge."
        if status == "null" and misfit > LARGEST_MISFIT:
            return (
                "not-adequate",
                f"Chi-squared per number stays at {misfit:.2f} although nothing explains it.",
            )
        return status, ""

    def _dataset(self):
        attributes = self.test.attrs
        rows = []
        for identity, name, first, last in show.phases(self.model):
            samples = sum(
                int(((one.moment.mean(axis=1) >= first) & (one.moment.mean(axis=1) < last)).sum())
                for one in self.model.instruments
            )
            rows.append(
                {"id": identity, "name": name, "start": float(first), "end": float(last), "samples": samples}
            )
        return {
            "title": str(attributes.get("title", "")),
            "condition": str(attributes["condition"]),
            "origin": self.provenance.get("origin", str(attributes.get("origin", "measured"))),
            "sha256": self.provenance.get("test", ""),
            "instruments": [one.kind for one in self.model.instruments],
            "phases": rows,
            "plasma_off_time": float(self.model.off),
            "time_bins": int(max(one.moment.shape[0] for one in self.model.instruments)),
            "wavelength_bins": int(
                max((one.channels for one in self.model.instruments if one.kind == "spectrometer"), default=0)
            ),
        }

    def _noise(self):
        rows = []
        for one, law in zip(self.model.instruments, self.base.noise_models, strict=True):
            kinds = ("wide", "narrow") if one.kind == "pyrometer" else ("spectrometer",)
            for place, name in enumerate(kinds):
                level = np.nanmedian(one.value[:, place] if one.kind == "pyrometer" else one.value)
                factor = 1.0 if one.factor is None else float(np.median(one.factor))
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
                        "unit": "A" if one.kind == "pyrometer" else "count",
                    }
                )
            rows.append(
                {
                    "channel": f"gas flicker ({one.kind})",
                    "relative": float(np.sqrt(law.flicker)),
                    "constant": 0.0,
                    "linear": 0.0,
                    "quadratic": float(law.flicker),
                    "lag1": float(law.flicker_memory),
                    "tail": 1.0,
                    "unit": "1",
                }
            )
        return rows

    def _pulls(self, final):
        rows = []
        for parameter, value in zip(self.model.parameters, final.state.values, strict=True):
            off = float(value - parameter.centre)
            pull = off / parameter.sigma
            rows.append(
                {
                    "id": parameter.id,
                    "name": parameter.name,
                    "value": off,
                    "sigma": float(parameter.sigma),
                    "pull": float(pull),
                    "unit": parameter.unit,
                    "finding": bool(abs(pull) > PULL),
                }
            )
        return rows

    def _candidates(self, first, final):
        """Entries of the terms named, as fitted, and of the others, as linearised."""
        found, gains = first.found, first.gains
        probability = self.probability
        evidence = linear_evidence(found)
        own = np.diag(found.information)[: found.count]
        angle = angles(found.information[: found.count, : found.count])
        order = best_by_id(found.candidates, gains)
        fitted = {setting.id: place for place, setting in enumerate(final.settings)}
        keep = [i for i in order if found.candidates[i].id in fitted]
        keep += [i for i in order if found.candidates[i].id not in fitted][:SHOWN]
        entries = []
        for index in keep:
            candidate = found.candidates[index]
            effect = EFFECTS[candidate.id]
            amplitude = float(found.amplitudes()[index])
            error = float(1 / np.sqrt(own[index])) if found.left[index] > 1e-5 else float(10 * effect.sigma)
            if found.left[index] <= 1e-5:
                amplitude = 0.0
            elif effect.quadratic:
                error = float(effect.amplitude_of(effect.linear_of(amplitude) + error)) - amplitude
            shape = {name: float(value) for name, value in candidate.shape.items()}
            if candidate.id in fitted:
                setting, at = final.settings[fitted[candidate.id]], self._place(final, fitted[candidate.id])
                amplitude, shape = setting.amplitude, {k: float(v) for k, v in setting.shape.items()}
                error = float(np.sqrt(final.covariance[at, at]))
            others = [j for j in order if found.candidates[j].id != candidate.id and found.left[j] > 1e-5]
            nearest = min(others, key=lambda j: angle[index, j]) if others else None
            paper, when = self.paper(candidate.id, amplitude, shape)
            fit, when_fit = fitted_shift(
                self.model, self.base.solution, found, index, effect.linear_of(amplitude)
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
                "log_evidence": show.number(max(evidence[index], -1e6)),
                "probability": float(probability.get(candidate.id, 0.0)),
                "significance": float(abs(amplitude) / error),
                "angle_to_next": None if nearest is None else float(angle[index, nearest]),
                "next": None if nearest is None else found.candidates[nearest].id,
                "temperature_shift": {
                    "paper": paper,
                    "base": fit,
                    "at_time": float(when if abs(paper) > abs(fit) else when_fit),
                },
                "phases": list(effect.phases),
                "instruments": [kind for kind in effect.instruments],
                "sentence": "",
            }
            entry["sentence"] = candidate_sentence(entry)
            entries.append(entry)

        def key(entry):
            cost = max(abs(entry["temperature_shift"]["paper"]), abs(entry["temperature_shift"]["base"]))
            supported = entry["id"] in fitted or entry["gain_chi2"] > self.selection.thresholds.effect
            return (entry["id"] not in fitted, not supported, -cost if supported else -entry["gain_chi2"])

        entries.sort(key=key)
        for rank, entry in enumerate(entries, 1):
            entry["rank"] = rank
        return entries

    def _place(self, final, term):
        """Row of the amplitude of a term in the covariance."""
        rows = [
            j
            for j, number in enumerate(free_numbers(final.settings))
            if number[0] == term and number[1] is None
        ]
        return self.size + rows[0]

    def _log_weights(self, first):
        """Logarithms of the weights of ids, none and unknown."""
        found = first.found
        evidence = linear_evidence(found)
        log = {"none": np.log(PRIOR_NONE)}
        share = np.log((1 - PRIOR_NONE - PRIOR_UNKNOWN) / len(EFFECTS))
        for index in best_by_id(found.candidates, evidence):
            identity = found.candidates[index].id
            if found.left[index] > 1e-5:
                log[identity] = share + float(evidence[index])
        trials = self.selection.trials
        if trials:
            reference = -0.5 * self.base.solution.objective
            for identity, value in trials.items():
                log[identity] = share + value - reference
        log["unknown"] = np.log(PRIOR_UNKNOWN) + float(first.unknown.max())
        if self.selection.final.settings and self.selection.status != "named+unknown":
            log["unknown"] = min(log["unknown"], max(log.values()) - 5.0)
        if self.selection.status == "null":
            log["none"] = max(log["none"], max(log.values()) + 1.0)
        return log

    def _limits(self, first):
        found = first.found
        own = np.diag(found.information)[: found.count]
        best = {}
        for index, candidate in enumerate(found.candidates):
            if candidate.id not in best or own[index] > own[best[candidate.id]]:
                best[candidate.id] = index
        rows = []
        for identity, index in best.items():
            effect = EFFECTS[identity]
            seen = found.left[index] > 1e-5
            five = effect.amplitude_of(5 / np.sqrt(own[index])) if seen else np.inf
            largest = max(abs(effect.bounds[0]), abs(effect.bounds[1]))
            paper_unit, _ = self.paper(identity, effect.step, found.candidates[index].shape)
            paper_unit /= effect.linear_of(effect.step)
            limit = float(min(five, largest))
            rows.append(
                {
                    "id": identity,
                    "name": effect.name,
                    "amplitude_5sigma": limit,
                    "unit": effect.unit,
                    "temperature_5sigma": float(abs(paper_unit * effect.linear_of(limit))),
                    "temperature_prior": float(abs(paper_unit * effect.linear_of(effect.sigma))),
                    "invisible": bool(five > effect.sigma),
                    "measurement": effect.measurement,
                }
            )
        rows.sort(
            key=lambda row: -(row["temperature_prior"] if row["invisible"] else row["temperature_5sigma"])
        )
        rows.sort(key=lambda row: not row["invisible"])
        return rows

    def _evidence(self, sets):
        rows = []
        for one in sets:
            if len(one) > 1:
                for identity in one:
                    rows.append((EFFECTS[identity].measurement, one))
        merged = {}
        for measurement, decides in rows:
            merged.setdefault(measurement, set()).update(decides)
        return [
            {"measurement": text, "decides": sorted(ids), "expected_significance": None}
            for text, ids in merged.items()
        ]

    def _structure_name(self, identity):
        for structure in self.selection.steps[0].found.structures:
            if structure.id == identity:
                return structure.name
        return None

    def _discrepancy(self, name, z):
        last = self.selection.steps[-1]
        rank1 = None
        if self.selection.unknown_class:
            which = int(np.argmax([np.nanmean(part**2) for part in z]))
            one, own = self.model.instruments[which], np.nan_to_num(z[which])
            u, s, v = np.linalg.svd(own, full_matrices=False)
            rank1 = {
                "time": show.numbers(one.moment.mean(axis=1)),
                "time_weight": show.numbers(u[:, 0]),
                "wavelength": show.numbers(one.wavelength) if one.weight is None else [0.0, 1.0],
                "wavelength_weight": show.numbers(v[0]),
                "channel": one.kind,
                "share": float(s[0] ** 2 / np.sum(s**2)),
            }
        return {
            "class": self.selection.unknown_class,
            "name": name,
            "log_bayes": float(last.unknown.max()),
            "per_class": [
                {"id": structure.id, "name": structure.name, "log_bayes": float(value)}
                for structure, value in zip(last.found.structures, last.unknown, strict=True)
            ],
            "rank1": rank1,
        }

    def _extended(self, final, gained, applied):
        if not final.settings:
            return None
        terms = []
        for place, setting in enumerate(final.settings):
            numbers, errors = {}, {}
            for j, (term, name, *_) in enumerate(free_numbers(final.settings)):
                if term == place:
                    key = name or "amplitude"
                    numbers[key] = float(setting.amplitude if name is None else setting.shape[name])
                    errors[key] = float(np.sqrt(max(final.covariance[self.size + j, self.size + j], 0)))
            terms.append({"id": setting.id, "parameters": numbers, "standard_errors": errors})
        better = "improve" if applied else "do not improve significantly"
        return {
            "configuration": fragment(final.settings),
            "terms": terms,
            "chi2": float(final.chi2),
            "dof": float(final.count - self.size - len(free_numbers(final.settings))),
            "applied": applied,
            "why": f"held-out data {better}: {gained.total:+.1f} ± {gained.standard_error:.1f}",
        }

    def _gain(self, gained, temperature, final, shift):
        if gained is None:
            return None

        def sigma(solution):
            hot = (solution.state.knots > 1000) & (self.model.history.knots > 18)
            values = np.sqrt(np.diag(solution.covariance)[: self.model.size])
            return float(np.median(values[hot])) if hot.any() else float(np.median(values))

        def lines(solution):
            found = show.kappa(self.model, self.fitter, solution)
            pairs = [
                (k, e) for k, e in zip(found["kappa"], found["error"], strict=True) if k is not None and e
            ]
            if not pairs:
                return None
            values, errors = np.array(pairs).T
            return float(np.sum(values / errors**2) / np.sum(1 / errors**2))

        return {
            "heldout_log_score": gained.total,
            "heldout_standard_error": gained.standard_error,
            "calibration": gained.calibration,
            "blocks": [{"start": a, "end": b, "difference": d} for a, b, d in gained.blocks],
            "cross_instrument": gained.cross_instrument,
            "cross_condition": self.crossed,
            "kappa_before": lines(self.base.solution),
            "kappa_after": lines(final),
            "temperature_shift": shift,
            "temperature_sigma_base": sigma(self.base.solution),
            "temperature_sigma_extended": sigma(final),
        }

    def _signals(self, final):
        for which, one in enumerate(self.model.instruments):
            if one.kind == "pyrometer":
                base, more = self.base.solution.prediction[which], final.prediction[which]
                return {
                    "time": show.numbers(one.moment.mean(axis=1)),
                    "wide": show.numbers(one.value[:, 0]),
                    "narrow": show.numbers(one.value[:, 1]),
                    "wide_model": show.numbers(base[:, 0]),
                    "narrow_model": show.numbers(base[:, 1]),
                    "wide_extended": show.numbers(more[:, 0]),
                    "narrow_extended": show.numbers(more[:, 1]),
                }
        return {
            name: []
            for name in (
                "time",
                "wide",
                "narrow",
                "wide_model",
                "narrow_model",
                "wide_extended",
                "narrow_extended",
            )
        }

    def _line_hump(self):
        library, solution = self.model.library, self.base.solution
        spectrum = self.model.spectrum(solution.state.values)
        index, size = self.model.index, self.model.size

        def error(name):
            row = size + index[name]
            return float(np.sqrt(solution.covariance[row, row]))

        line = [name for name in self.model.groups if "O I 77" in name]
        hump = [name for name in self.model.index if name.startswith("system:")]
        errors = (error(line[0]) if line else 0.05, error(hump[0]) if hump else 0.05)
        moved = any(
            row["finding"] for row in self._pulls(self.base.solution) if row["id"].startswith("gain_")
        )
        tracks = show.explanations(library, self.model.emittance)
        return show.line_hump(library, (spectrum, errors), tracks, calibration=moved)

    def _angles(self, first):
        found = first.found
        order = best_by_id(found.candidates, first.gains)[:SHOWN]
        angle = angles(found.information[: found.count, : found.count])
        return {
            "ids": [found.candidates[i].id for i in order],
            "degrees": [[show.number(angle[i, j]) if i != j else 0.0 for j in order] for i in order],
        }

    def _temperature(self, final, applied):
        times = np.unique(np.concatenate([one.moment.mean(axis=1) for one in self.model.instruments]))
        basis = self.model.history.basis(times)
        size = self.model.size

        lamp = size + self.model.index["lamp"]

        def estimate(solution, unsure=0.0):
            mean, covariance = basis @ solution.state.knots, solution.covariance
            variance = np.einsum("tk,kl,tl->t", basis, covariance[:size, :size], basis)
            # What the model leaves of the data beyond their noise is in the interval as well.
            misfit = max(solution.objective / max(solution.count - self.size, 1), 1.0)
            # The bias of the calibration source is bounded, not normal.
            spread = estimated_beside_bounded(
                misfit * variance + unsure**2,
                np.sqrt(misfit) * (basis @ covariance[:size, lamp]),
                self.model.parameters[self.model.index["lamp"]].sigma,
            )
            keep = times >= 0
            return [np.where(keep, values, np.nan) for values in (mean, mean - spread, mean + spread)]

        base = estimate(self.base.solution)
        # Terms that the data ask for but held-out data do not confirm: their shift is an uncertainty.
        shift = basis @ (final.state.knots - self.base.solution.state.knots)
        extended = estimate(final) if applied else estimate(self.base.solution, shift)
        paper = np.full(times.size, np.nan)
        for one in self.model.instruments:
            if one.kind == "pyrometer" and self.curve is not None:
                moment = one.moment.mean(axis=1)
                own = paper_temperature(one.value, moment, self.window, self.model.off, self.curve)
                paper[np.searchsorted(times, moment)] = own
        names = ("", "_low", "_high")
        return xr.Dataset(
            {"paper_temperature": ("time_bin", paper)}
            | {f"base_temperature{n}": ("time_bin", v) for n, v in zip(names, base, strict=True)}
            | {f"extended_temperature{n}": ("time_bin", v) for n, v in zip(names, extended, strict=True)},
            {"time_bin": times},
            {
                "title": "Surface temperature: of the paper, of the base model, of the extended model",
                "applied": int(applied),
                "terms": " ".join(setting.id for setting in final.settings),
                "origin": str(self.test.attrs.get("origin", "measured")),
            },
        )

    def _shift(self, temperature):
        time = temperature["time_bin"].values
        change = (temperature["extended_temperature"] - temperature["base_temperature"]).values
        hot = (time >= 18) & (temperature["base_temperature"].values > 900)
        return float(change[hot][np.argmax(np.abs(change[hot]))]) if hot.any() else 0.0

    def _residual_map(self, final, z_base, z_final):
        times = np.unique(np.concatenate([one.moment.mean(axis=1) for one in self.model.instruments]))
        edges = np.stack([times, times], axis=1)
        variables, coordinates = {}, {"time_bin": times, "model": ["base", "extended"]}
        for which, one in enumerate(self.model.instruments):
            moment = one.moment.mean(axis=1)
            place = np.searchsorted(times, moment)
            half = np.maximum(one.moment[:, 1] - one.moment[:, 0], 1e-3) * np.sqrt(3) / 2
            edges[place] = np.stack([moment - half, moment + half], axis=1)

            def laid(values, place=place):
                result = np.full((times.size, values.shape[1]), np.nan)
                result[place] = values
                return result

            predicted = [laid(self.base.solution.prediction[which]), laid(final.prediction[which])]
            left = [laid(z_base[which]), laid(z_final[which])]
            if one.kind == "spectrometer":
                dims = ("time_bin", "wavelength_bin")
                coordinates["wavelength_bin"] = one.wavelength
                variables["measured_radiance"] = (dims, laid(one.value))
                variables["modelled_radiance"] = (("model", *dims), np.array(predicted))
                variables["radiance_residual"] = (("model", *dims), np.array(left))
                middle = (one.wavelength[1:] + one.wavelength[:-1]) / 2
                ends = 2 * one.wavelength[[0, -1]] - middle[[0, -1]]
                bounds = np.concatenate([ends[:1], middle, ends[1:]])
                variables["wavelength_edge"] = (
                    ("wavelength_bin", "bound"),
                    np.stack([bounds[:-1], bounds[1:]], axis=1),
                )
            else:
                dims = ("band", "time_bin")
                coordinates["band"] = ["wide", "narrow"]
                variables["measured_signal"] = (dims, laid(one.value).T)
                variables["modelled_signal"] = (("model", *dims), np.array([p.T for p in predicted]))
                variables["signal_residual"] = (("model", *dims), np.array([r.T for r in left]))
        variables["time_edge"] = (("time_bin", "bound"), edges)
        return xr.Dataset(
            variables,
            coordinates,
            {
                "title": "Measured, modelled, and the difference over its standard deviation",
                "origin": str(self.test.attrs.get("origin", "measured")),
            },
        )
