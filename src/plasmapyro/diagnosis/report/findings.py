"""What was found in a test: all that a report is made of."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, cho_solve
from scipy.special import chdtrc

from plasmapyro.diagnosis.fit.base import Base
from plasmapyro.diagnosis.report import show
from plasmapyro.diagnosis.report.kelvin import PaperShift, judged_span
from plasmapyro.diagnosis.select.excursion import EXCURSION, excursion
from plasmapyro.diagnosis.select.held_out import Gain
from plasmapyro.diagnosis.select.leftover import STEP, whitened
from plasmapyro.diagnosis.select.probability import PRIOR_NONE, PRIOR_UNKNOWN, honest, prior_share
from plasmapyro.diagnosis.select.screen import LEAST_LEFT, best_by_id, linear_evidence
from plasmapyro.diagnosis.select.search import PULL
from plasmapyro.diagnosis.select.selection import Selection
from plasmapyro.diagnosis.select.structures import seen_by
from plasmapyro.diagnosis.select.unknowns import Unknowns
from plasmapyro.diagnosis.simulation.compare import SYSTEM, Comparison
from plasmapyro.experiment.correction import Reading

LARGEST_MISFIT = 1.25  # chi-squared per number beyond which no effect is judged, if nothing explains it,
BY_CHANCE = 5.0  # and standard deviations of it by which it must exceed 1
BESIDE_NAMES = -5.0  # log weight of something unknown below that of what is named
EVEN = 0.5  # probability of nothing beyond which no extension is applied
OF_GAS = "gas"  # row of the table of stated probabilities where the gas alone has a name
ONE_STEP = "one_walk_spectrometer"  # structure that moves the temperature as a step of frames does
AHEAD = 1.0  # log weight of what the verdict says above all others


@dataclass(frozen=True)
class Findings:
    """Fits and selection of a test, and its gas against the simulated one.

    `effects` {id: Effect} of the whole catalogue share the prior; `gained` by the extension on held-out data,
    None without one; `crossed` its log score on tests at other conditions; `reading` of the paper's method,
    None without a pyrometer; `provenance` goes into the report; `data` digest of the signals of the test;
    `foreign` species whose lines the gas has and its simulation lacks, see `foreign.lines_lacking`.
    """

    base: Base
    selection: Selection
    comparison: Comparison
    effects: dict
    gained: Gain | None
    crossed: float | None
    reading: Reading | None
    provenance: dict
    data: str = ""
    foreign: tuple = ()

    @property
    def model(self):
        """Of the test."""
        return self.base.model

    @property
    def record(self):
        """Of the test."""
        return self.base.model.record

    @property
    def final(self):
        """The fit with the effects that the data ask for."""
        return self.selection.final

    @property
    def first(self):
        """The round beside the base fit."""
        return self.selection.steps[0]

    @property
    def size(self):
        """Knots and parameters, which come before the numbers of effects in a covariance."""
        return self.model.size + len(self.model.parameters)

    @cached_property
    def fitted(self):
        r"""Numbers that a fit without effects takes from the data and not from priors, about.

        .. math:: K - \mathrm{tr}(P M^{-1})

        of K numbers with the inverse covariance P before and M after the data.

        Source: D. J. Spiegelhalter et al., J. R. Stat. Soc. B 64 (2002) 583, for normal laws.
        """
        fitter, factor = self.base.fitter, self.base.solution.factor
        prior = block_diag(fitter.prior(()), np.diag(fitter.pattern_prior))
        return float(len(prior) - np.trace(cho_solve(factor, prior)))

    @property
    def applied(self):
        """Whether held-out data speak for the extension, and nothing being wrong is not likelier."""
        if self.gained is None or self.misfit:
            return False
        answers, gas = self.probability[0], self.comparison.evidence
        sound = sum(p for answer, p in answers.items() if answer == "none" or answer in gas)
        return bool(self.gained.improves) and sound < EVEN

    @cached_property
    def p_value(self):
        """Probability of a misfit as large as the final fit's, priors included, by its noise alone."""
        return float(chdtrc(self.final.count, self.final.objective))

    @cached_property
    def unknown_shift(self):
        """Change (K,) [K] of the knots if what no effect explains were in the model."""
        last, left = self.selection.steps[-1], self.selection.unknown_class
        if left == EXCURSION:
            return excursion(self.model, self.final)
        names = [structure.id for structure in last.screen.structures]
        left = ONE_STEP if left == STEP else left
        if left not in names:
            return np.zeros(self.model.size)
        return Unknowns(last.screen).shift(last.screen, names.index(left))

    @cached_property
    def unknown(self):
        """Instrument and axis of what no effect explains, or of what names with reserve do; else None."""
        if self.selection.suspect is None:
            return None
        seen = seen_by(self.selection.suspect)
        sources = {one.kind: one.source for one in self.model.instruments}
        alone = seen["instrument"] if len(sources) > 1 else next(iter(sources.values()))
        return seen | {"instrument": sources.get(seen["instrument"], alone)}

    @cached_property
    def times(self):
        """Middles of all bins (t,) [s], of whichever instrument."""
        return np.unique(np.concatenate([instrument.time for instrument in self.model.instruments]))

    @cached_property
    def residuals(self):
        """Whitened residuals (n, C) per instrument of the base and of the extended fit."""
        return tuple(whitened(self.model, fit) for fit in (self.base.solution, self.final))

    @cached_property
    def paper_shift(self):
        """Change of the paper's temperature by an effect."""
        return PaperShift(self.model, self.base.solution, self.reading)

    @cached_property
    def span(self):
        """First and last time [s] between which shifts of the temperature are judged."""
        return judged_span(self.model, self.base.solution)

    @cached_property
    def phases(self):
        """(id, name, first, last) [s] of the parts of the test."""
        return show.phases(self.model, self.base.solution)

    @property
    def misfit(self):
        """Why the base model is not adequate, or ''."""
        last = self.final
        misfit = last.objective / last.count
        if not last.converged:
            return "The fit did not converge."
        chance = 1 + BY_CHANCE * np.sqrt(2 / last.count)
        wrong = misfit > max(LARGEST_MISFIT, chance)
        if self.selection.status == "null" and wrong:
            return f"Chi-squared per number stays at {misfit:.2f} although nothing explains it."
        if not self.model.plasma and self.selection.status != "unknown" and wrong:
            return (
                f"Chi-squared per number stays at {misfit:.2f} with what explains it best: this is not the"
                " light of a hot surface alone, or the calibration is of another instrument."
            )
        return ""

    @property
    def status(self):
        """Of the verdict: what the data of the test ask for, and what its gas asks of the simulation."""
        if self.misfit:
            return "not-adequate"
        status, rivals = self.selection.status, self.comparison.rivals
        if not rivals or status == "named+unknown":
            return status
        if status == "unknown":
            return "named+unknown"
        return "one-of" if status == "one-of" or any(rivals.values()) else "named"

    @property
    def named(self):
        """Settings that are named, those of the thermometer first; none where the model is not adequate."""
        return () if self.misfit else (*self.final.settings, *self.comparison.final.settings)

    @cached_property
    def pulls(self):
        """Entries of the parameters of the base model against what was known of them."""
        return pulls(self.model, self.final)

    @cached_property
    def probability(self):
        """Probability {answer: p}, and that of the first answer before it was made honest.

        Of the thermometer; and where nothing is wrong with it, of the simulation.
        """
        if self.misfit:
            return {}, 0.0
        log = self._log_weights()
        sound = log.pop("none")
        log |= {answer: sound + value for answer, value in self._of_gas().items()}
        # What the verdict says comes first: evidence by tangents and of single effects is not the last word.
        named = self.named[0].id if self.named else None
        stated = {"null": "none", "unknown": "unknown"}.get(self.status, named)
        log[stated] = max(log[stated], max(value for key, value in log.items() if key != stated) + AHEAD)
        gas = stated in self.comparison.evidence and self.status != "named+unknown"
        return honest(log, OF_GAS if gas else self.status)

    def _of_gas(self):
        """Log probabilities of the ids that change the gas, and of none."""
        log = weights_of_gas(self.comparison, len(self.effects))
        total = np.logaddexp.reduce(list(log.values()))
        return {answer: value - total for answer, value in log.items()}

    def _log_weights(self):
        """Logarithms of the weights of ids, none and unknown, for the thermometer."""
        screen, trials = self.first.screen, self.selection.trials
        evidence = linear_evidence(screen)
        log = {"none": np.log(PRIOR_NONE)}
        share = prior_share(len(self.effects))
        for index in best_by_id(screen.candidates, evidence):
            if screen.left[index] > LEAST_LEFT:
                log[screen.candidates[index].id] = share + float(evidence[index])
        for identity, value in trials.items():
            log[identity] = share + value + 0.5 * self.base.solution.objective
        for identity in [setting.id for setting in self.final.settings][:1]:
            log[identity] = max(log.get(identity, -np.inf), share + self.selection.evidence)
        log["unknown"] = np.log(PRIOR_UNKNOWN) + float(self.first.unknown.max())
        if self.final.settings and self.selection.status != "named+unknown":
            log["unknown"] = min(log["unknown"], max(log.values()) + BESIDE_NAMES)
        return log


def weights_of_gas(comparison, count):
    """Logarithms of the weights of the ids that change the gas, of `count` that there are, and of none;
    another strength of one radiating system is none."""
    found, share = comparison.evidence, prior_share(count)
    log = {one: share + value for one, value in found.items() if one != SYSTEM}
    spectroscopy = np.log(PRIOR_UNKNOWN) + found.get(SYSTEM, -np.inf)
    return log | {"none": float(np.logaddexp(np.log(PRIOR_NONE), spectroscopy))}


def gas_is_likelier(comparison, count):
    """Whether the first name of the gas is likelier than none: thresholds ask what chance may reach, this how
    probable an effect was before the data."""
    log = weights_of_gas(comparison, count)
    return all(log[setting.id] > log["none"] for setting in comparison.final.settings[:1])


def pulls(model, solution):
    """Entries of the parameters of the base model against what was known of them, after a fit; of a family
    the root mean square."""
    families, values = {}, {}
    for parameter, value in zip(model.parameters, solution.state.values, strict=True):
        families[parameter.id] = parameter
        values.setdefault(parameter.id, []).append(float(value - parameter.centre))
    rows = []
    for identity, parameter in families.items():
        several = values[identity]
        change = several[0] if len(several) == 1 else float(np.sqrt(np.mean(np.square(several))))
        rows.append(
            {
                "id": identity,
                "name": parameter.name,
                "value": change,
                "sigma": float(parameter.sigma),
                "pull": float(change / parameter.sigma),
                "unit": parameter.unit,
                "finding": bool(abs(change) > PULL * parameter.sigma),
            }
        )
    return rows
