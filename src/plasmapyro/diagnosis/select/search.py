"""A model to be fitted with effects that are looked for: fits, and what the data say beside one."""

from dataclasses import dataclass, field, replace

import numpy as np

from plasmapyro.diagnosis.effects.catalogue import without
from plasmapyro.diagnosis.fit.inference import Fitter, Solution, log_evidence
from plasmapyro.diagnosis.fit.model import Model
from plasmapyro.diagnosis.fit.noise import period_of
from plasmapyro.diagnosis.fit.setting import Setting, free_numbers, numbers_of
from plasmapyro.diagnosis.select.screen import Screen, best_by_id, linear_evidence, screen
from plasmapyro.diagnosis.select.structures import SMOOTH_MAP
from plasmapyro.diagnosis.select.thresholds import Thresholds
from plasmapyro.diagnosis.select.unknowns import Unknowns

PULL = 3.0  # prior standard deviations beyond which a parameter of the base model is a finding
AT_END = 1e-3  # [1], of the largest amplitude
AT_END_PRICE = 10.0  # log evidence by which an effect at the end of its range must beat one that is not
NEARLY = 3.0  # log Bayes factor within which a smooth map says no more than a structure of one axis
REFITTED = 3  # effects that are fitted anew, of those that explain about as much as the best


@dataclass(frozen=True)
class Step:
    """One round: what the screen beside the current fit says."""

    solution: Solution
    screen: Screen
    gains: np.ndarray
    unknown: np.ndarray  # log Bayes factor per class of structures
    beside: np.ndarray  # as `gains`, with the most likely unknown structure in the data too
    refits: dict = field(default_factory=dict)  # id -> fit with one more effect

    @property
    def settings(self):
        """The effects of the fit."""
        return self.solution.settings

    @property
    def structure(self):
        """Id of the most likely unknown structure."""
        return self.likeliest(self.unknown)

    def likeliest(self, unknown):
        """Id of the structure of the largest of log Bayes factors (classes,); of those nearly as likely, one
        along a single axis."""
        order = np.argsort(-unknown, kind="stable")
        near = [self.screen.structures[i].id for i in order if unknown[i] > unknown.max() - NEARLY]
        return next((one for one in near if one != SMOOTH_MAP), near[0])

    def gained(self, solution):
        """Chi-squared that another fit gains."""
        return self.solution.objective - solution.objective


def setting_of(candidate, number):
    """The candidate as a setting to begin a fit with, from its number along its column."""
    effect = candidate.effect
    limit = 6 * effect.sigma
    amplitude = np.clip(np.clip(effect.amplitude_of(number), *effect.bounds), -limit, limit)
    return Setting(effect, float(amplitude), {name: float(value) for name, value in candidate.shape.items()})


def at_end(solution):
    """Whether the newest amplitude is as large as its effect may make it: no measure of its cause."""
    last = len(solution.settings) - 1
    for one, number in zip(free_numbers(solution.settings), solution.state.amplitudes, strict=True):
        if (one.place, one.name) == (last, None):
            return bool(one.exhausted(number, AT_END))
    return False


@dataclass
class Search:
    """The model, what fits it, the effects {id: Effect} that are looked for, and what they must bring."""

    model: Model
    fitter: Fitter
    effects: dict
    thresholds: Thresholds | None = None

    def look(self, solution):
        """Screen beside a fit."""
        used = {setting.id for setting in solution.settings}
        others = without(self.effects, used & set(self.effects))
        seen = screen(self.model, solution, others)
        gains = seen.signed_gains()
        if not seen.structures:
            return Step(solution, seen, gains, np.full(1, -np.inf), gains)
        unknowns = Unknowns(seen)
        unknown = unknowns(seen.score)
        beside = unknowns.gains_beside(seen, int(unknown.argmax()))
        return Step(solution, seen, gains, unknown, np.where(gains > 0, beside, 0.0))

    def fit(self, solution, settings):
        """Fit with settings, started from another fit."""
        start = replace(solution.state, amplitudes=numbers_of(settings))
        return self.fitter.fit(start, settings)

    def extended(self, step, index):
        """Fit with one more candidate, and from where its effect `starts`; from its other shapes too if it
        comes to no rest, or is a finite step: between two samples nothing pulls."""
        found, candidate = self._from(step, index), step.screen.candidates[index]
        newest = found.settings[-1]
        if newest.effect.starts and len(self.model.instruments) > 1:  # one alone differs from no other clock
            begun = [(*step.settings, replace(newest, shape=dict(one))) for one in newest.effect.starts]
            # Without a clock the base model has moved its own as far as it goes.
            begin = step.solution if newest.effect.clock is None else found
            found = _best([found, *(self.fit(begin, settings) for settings in begun)])
        if newest.effect.clock is not None and "clocks" in self.model.index:  # one alone has none of its own
            found = _best([found, *self._own_clock(step, newest)])
        if candidate.step is not None:
            found = self.from_all_shapes(step, found)
            return _best([found, *self._beside(found)])
        return found if found.converged else self.from_all_shapes(step, found)

    def _own_clock(self, step, newest):
        """Fit begun with the clock that the base model has moved far as that of the effect: once it is moved,
        no tangent leads back."""
        solution, place = step.solution, self.model.index["clocks"]
        own, values = self.model.parameters[place], solution.state.values.copy()
        moved = float(values[place] - own.centre)
        if abs(moved) > PULL * own.sigma:
            values[place] = own.centre
            begin = replace(solution, state=replace(solution.state, values=values))
            yield self.fit(begin, (*step.settings, replace(newest, amplitude=moved, shape={})))

    def _beside(self, found):
        """Fits begun half a sample to either side of the newest effect, a clock: behind the next sample lies
        another valley, which may be the deeper one."""
        *others, newest = found.settings
        for away in (-0.5, 0.5):
            moved = newest.amplitude + away * period_of(self.model.instruments[0])
            yield self.fit(found, (*others, replace(newest, amplitude=moved)))

    def from_all_shapes(self, step, fit):
        """The best of a fit and those from the other shapes of its newest effect, which promise less.

        The valley between amplitude and shape is long and curved, and from where a light lags by 3 s no
        tangent leads to one that is weaker and lags by 9 s.
        """
        name, gains = fit.settings[-1].id, step.gains
        same = [place for place, one in enumerate(step.screen.candidates) if one.id == name]
        others = sorted(same, key=lambda place: -gains[place])[1:]
        return _best([fit, *(self._from(step, place) for place in others)])

    def _from(self, step, index):
        """Fit with one more candidate, begun without it; from its linear estimate where its shape counts,
        which nothing pulls at an amplitude of zero."""
        candidate = step.screen.candidates[index]
        number = step.screen.linear()[index]
        if candidate.step is not None:
            number = candidate.effect.linear_of(candidate.step)
        elif not candidate.shape and not candidate.effect.quadratic:
            number = 0.0  # the first step moves all numbers along the tangent, not this one alone
        return self.fit(step.solution, (*step.settings, setting_of(candidate, number)))

    def best_refit(self, step, gains, trials=None):
        """The best of the refits of the candidates that explain about as much."""
        order = best_by_id(step.screen.candidates, gains)
        near = [index for index in order if gains[index] > 0.5 * gains[order[0]]][:REFITTED]
        fits = []
        for index in near:
            fits.append(self._refit(step, index))
            if trials is not None:
                trials[step.screen.candidates[index].id] = self.evidence(fits[-1])
        return max(fits, key=lambda fit: self.evidence(fit) - AT_END_PRICE * at_end(fit))

    def _refit(self, step, index):
        """Fit with one more candidate: the one there is, unless the tangent promises more."""
        there = step.refits.get(step.screen.candidates[index].id)
        if there is not None and step.gained(there) >= step.gains[index]:
            return there
        return self.extended(step, index)

    def pruned(self, solution):
        """The fit without effects that no longer bring the threshold."""
        while len(solution.settings) > 1:
            fits = [
                self.fit(solution, tuple(kept for kept in solution.settings if kept is not dropped))
                for dropped in solution.settings
            ]
            least = min(fits, key=lambda fit: fit.objective)
            if least.objective - solution.objective > self.thresholds.effect:
                break
            solution = least
        return solution

    def evidence(self, solution):
        """Log evidence of a fit."""
        return log_evidence(solution, self.model.size + len(self.model.parameters))

    def evidence_of(self, step):
        """Log Bayes factor (candidates,), from the fits that exist, else by the linear estimate."""
        evidence, plain = linear_evidence(step.screen), self.evidence(step.solution)
        for place, candidate in enumerate(step.screen.candidates):
            if candidate.id in step.refits:
                evidence[place] = max(evidence[place], self.evidence(step.refits[candidate.id]) - plain)
        return evidence


def _best(fits):
    """The lowest of the fits that come to rest, or of all."""
    return min(fits, key=lambda one: (not one.converged, one.objective))
