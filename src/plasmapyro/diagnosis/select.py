"""Which terms the data ask for: forward steps with non-linear refits, backward steps, and what stays
unknown."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import chi2

from plasmapyro import progress
from plasmapyro.diagnosis import strengths
from plasmapyro.diagnosis.catalogue import EFFECTS
from plasmapyro.diagnosis.inference import Solution, log_evidence, numbers_of
from plasmapyro.diagnosis.model import Setting
from plasmapyro.diagnosis.reserve import reserve
from plasmapyro.diagnosis.screen import Screen, Unknowns, angles, gain, screen, simulated

MOST_TERMS = 3
REFITTED = 3  # terms that are fitted anew, of those that explain about as much as the best
ALIKE = 9.2  # chi-squared by which the data tell two terms apart: 99 % of two degrees of freedom
SAME_ANGLE = 15.0  # [degree] below which two terms are one class
ALONE = float(chi2.ppf(0.99, 1))  # chi-squared of a single test
PULL = 3.0  # prior standard deviations beyond which a parameter of the base model is a finding
MARGIN = 3.0  # log Bayes factor by which an unknown structure must beat a term
WANDER = "gas_drift"  # the term that may follow the brightness of the gas freely
LEVEL = 0.01  # false alarms of each of the two tests, if the linearised model were exact
LEAST_UNKNOWN = 4.0  # log Bayes factor below which nothing is called unknown: templates err a little
PAIR_PRICE = 1.5  # times the threshold that the second term of a pair must bring
PAIRS = 3  # of terms, fitted from the start, of those
NEARLY = 0.95  # that promise as much of what the best pair does
ENOUGH = 0.9  # of the log Bayes factor of an unknown structure: a term that explains so much, and leaves
# no more than the rest, stands for it; forty free steps find more than one cause leaves
SHARE = 0.15  # of what an unknown structure explains: a term beside it must explain as much
KIN = 0.4  # cosine beyond which a term may be the misfit of another one's formula
NEAR_MISS = 0.5  # of what a further term must bring: if its tangent promises so much, it is fitted
FAR_FITS = 2  # of the terms that may stand behind moved strengths
WORTH = 5.0  # chi-squared that a term must promise by the strengths of the gas to be fitted from there
FORMULA = 0.1  # [1], of the chi-squared that a term gains: what its kin must bring besides,
SPILL = 0.03  # [1], and what any other term must: formulas are inexact by a sixth


@dataclass(frozen=True)
class Thresholds:
    """Calibrated by scores drawn as if nothing were wrong."""

    effect: float
    unknown: float
    third: float
    draws: int
    seed: int
    largest: np.ndarray  # sorted largest gains of the draws
    largest_unknown: np.ndarray

    def p_effect(self, value):
        """Share of the draws beyond a gain; never 0."""
        return (1 + np.sum(self.largest >= value)) / (1 + self.largest.size)

    def p_unknown(self, value):
        """Share of the draws beyond a log Bayes factor; never 0."""
        return (1 + np.sum(self.largest_unknown >= value)) / (1 + self.largest_unknown.size)


def calibrated(found, draws, seed):
    """Thresholds of a screen from simulated scores: the price of looking at many terms is in them."""
    scores = simulated(found, draws, np.random.default_rng(seed))
    own = np.diag(found.information)[: found.count]
    gains = gain(scores[:, : found.count], own, found.left[: found.count])
    best = np.sort(gains.max(axis=1))
    unknown = np.sort(Unknowns(found)(scores).max(axis=1)) if found.structures else np.full(draws, -np.inf)
    c1 = float(np.quantile(best, 1 - LEVEL))
    return Thresholds(
        effect=c1,
        unknown=max(float(np.quantile(unknown, 1 - LEVEL)), LEAST_UNKNOWN) if found.structures else np.inf,
        third=float(np.quantile(best, 1 - LEVEL / 10)),
        draws=draws,
        seed=seed,
        largest=best,
        largest_unknown=unknown,
    )


@dataclass(frozen=True)
class Step:
    """One round: what the screen beside the current fit says."""

    solution: Solution
    found: Screen
    gains: np.ndarray
    unknown: np.ndarray  # log Bayes factor per class of structures
    beside: np.ndarray  # as `gains`, with the most likely unknown structure in the data too
    refits: dict = field(default_factory=dict)  # id -> fit with one more term, started far from here


@dataclass(frozen=True)
class Selection:
    """The outcome: rounds, the terms and their fit, who could stand in for each, and what remains."""

    steps: tuple
    final: Solution
    sets: tuple  # per term, ids of the candidates that explain the same
    trials: dict  # id -> objective of its refit as the first term
    status: str
    unknown_class: str | None
    thresholds: Thresholds
    reserve: str = ""  # why the names are not certain, see `reserve`


def linear_evidence(found):
    """Log Bayes factor of each candidate over no term, Gaussian prior of its amplitude (candidates,)."""
    own = np.diag(found.information)[: found.count]
    sigma2 = np.array([candidate.sigma**2 for candidate in found.candidates])
    score = found.score[: found.count]
    usable = found.left[: found.count] > 1e-6
    value = -0.5 * np.log1p(sigma2 * own) + 0.5 * score**2 / (own + 1 / sigma2)
    return np.where(usable, value, -np.inf)


def best_by_id(candidates, values):
    """Index of the best shape of each id, best first."""
    best = {}
    for index, (candidate, value) in enumerate(zip(candidates, values, strict=True)):
        if candidate.id not in best or value > values[best[candidate.id]]:
            best[candidate.id] = index
    return sorted(best.values(), key=lambda index: -values[index])


def _structure(step):
    """Id of the most likely unknown structure."""
    return step.found.structures[int(step.unknown.argmax())].id


def best_pairs(found, allowed, count=1):
    """Pairs of candidates that together gain most, by the linear estimate, each pair of ids once, with
    amplitudes that both may have.

    Returns
    -------
    list of (gain, (first, second) places, (first, second) numbers along their columns), best first
    """
    chosen = np.flatnonzero(allowed > 0)
    if chosen.size < 2:
        return []
    info = found.information[np.ix_(chosen, chosen)]
    own, score = np.diag(info), found.score[chosen]
    determinant = np.outer(own, own) - info**2
    apart = determinant > 0.05 * np.outer(own, own)
    ids = np.array([found.candidates[index].id for index in chosen])
    apart &= ids[:, None] != ids[None]
    safe = np.where(apart, determinant, 1.0)
    numbers = (score[:, None] * own[None] - score[None] * info) / safe  # of the first of each pair
    low, high = found.ends()[:, chosen]
    slack = np.sqrt(own[None] / safe)  # one standard deviation, as for one alone
    within = (numbers > low[:, None] - slack) & (numbers < high[:, None] + slack)
    both = np.where(apart & within & within.T, numbers * score[:, None] + numbers.T * score[None], 0.0)
    pairs, seen = [], set()
    for place in np.argsort(-both, axis=None, kind="stable"):
        one, two = np.unravel_index(place, both.shape)
        if len(pairs) == count or not both[one, two] > 0:
            break
        if frozenset((ids[one], ids[two])) not in seen:
            seen.add(frozenset((ids[one], ids[two])))
            places = int(chosen[one]), int(chosen[two])
            pairs.append((float(both[one, two]), places, (numbers[one, two], numbers[two, one])))
    return pairs


def _setting(candidate, number):
    """A term to begin a fit with, from its number along its column."""
    effect = EFFECTS[candidate.id]
    limit = 6 * effect.sigma
    amplitude = np.clip(np.clip(effect.amplitude_of(number), *effect.bounds), -limit, limit)
    return Setting(
        candidate.id, float(amplitude), {name: float(value) for name, value in candidate.shape.items()}
    )


class Selector:
    """Walks from the base fit to the terms the data ask for."""

    def __init__(self, model, fitter, thresholds=None, exclude=(), draws=2000, seed=1):
        self.model, self.fitter, self.exclude = model, fitter, tuple(exclude)
        self.thresholds, self.draws, self.seed = thresholds, draws, seed

    def look(self, solution):
        """Screen beside a fit."""
        used = {setting.id for setting in solution.settings}
        found = screen(self.model, solution, exclude=(*self.exclude, *used))
        gains = found.signed_gains()
        refits = self._far_away(solution, used)
        for place, one in enumerate(found.candidates):
            if one.id in refits:
                gains[place] = max(gains[place], solution.objective - refits[one.id].objective)
        if not found.structures:
            return Step(solution, found, gains, np.full(1, -np.inf), gains, refits)
        unknowns = Unknowns(found)
        unknown = unknowns(found.score)
        beside = unknowns.gains_beside(found, int(unknown.argmax()))
        return Step(solution, found, gains, unknown, np.where(gains > 0, beside, 0.0), refits)

    def _far_away(self, solution, used):
        """Fits with a term that may stand behind strengths of the gas that the base parameters took up.

        Tangents about the fit do not show such a term: lines twice as bright have moved the power and the
        groups of lines to where a small change of the term helps no more.
        """
        terms = [one for one in strengths.BEHIND if one not in (*used, *self.exclude)]
        fits = {}
        ranking = strengths.behind(self.model, solution.state.values, terms)
        for promised, identity, amplitude, values in ranking[:FAR_FITS]:
            if promised < WORTH:
                break
            low, high = EFFECTS[identity].bounds
            settings = (*solution.settings, Setting(identity, float(np.clip(amplitude, low, high))))
            start = replace(solution.state, values=values, amplitudes=numbers_of(settings))
            fits[identity] = self.fitter.fit(start, settings)
        return fits

    def _needed(self, steps):
        """Chi-squared (candidates,) that a further term must bring.

        ASSUME: a power that leaves its prior is a finding by itself, whichever term of the gas stands behind
        it: one test, not one of many. As long as it does not, fits from far away are more than the tests by
        tangents that the thresholds know of: in 4 of 113 nulls one of them passed the threshold of these.
        """
        step, limits = steps[-1], self.thresholds
        needed = np.full(step.found.count, limits.effect)
        if step.solution.settings:
            needed = limits.third + self._of_formulas(steps)
        alone = np.array([one.id in step.refits for one in step.found.candidates])
        if self._too_strong(step.solution):
            needed = np.where(alone, np.minimum(needed, ALONE), needed)
        else:
            needed = np.where(alone, np.maximum(needed, limits.third), needed)
        return needed

    def fit(self, solution, settings):
        """Fit with terms, started from another fit."""
        start = replace(solution.state, amplitudes=numbers_of(settings))
        return self.fitter.fit(start, settings)

    def extended(self, step, index):
        """Fit with one more candidate, from its linear estimate."""
        setting = _setting(step.found.candidates[index], step.found.linear()[index])
        return self.fit(step.solution, (*step.solution.settings, setting))

    def run(self, base):
        """Select terms beside the base fit.

        Returns
        -------
        Selection
        """
        progress.step("diagnosis: effects one by one against simulated nulls", self.draws)
        first, trials = self.look(base), {}
        if self.thresholds is None:
            self.thresholds = calibrated(first.found, self.draws, self.seed)
        limits = self.thresholds
        steps, unknown = self._walk([first], trials)
        if steps[-1].solution.settings or unknown:
            steps, unknown = self._by_pair(steps, unknown)
        steps, unknown = self._by_pull(steps, unknown)
        final = steps[-1].solution
        sets = tuple(
            self._set(first, setting.id) + self._behind(steps, setting.id) for setting in final.settings
        )
        sets = tuple(tuple(dict.fromkeys(ids)) for ids in sets)
        doubt = "" if unknown else reserve(steps, limits.third, sets)
        status = self._status(final, unknown or doubt, sets)
        return Selection(tuple(steps), final, sets, trials, status, unknown, limits, doubt)

    def _walk(self, steps, trials):
        """Rounds from the last of `steps` until no term is asked for, and the unknown structure that is left
        or None; fits with a first term go into `trials`."""
        steps, unknown, seen, limits = list(steps), None, set(), self.thresholds
        step = steps[-1]
        while len(step.solution.settings) < MOST_TERMS:
            terms = frozenset((setting.id, *sorted(setting.shape)) for setting in step.solution.settings)
            if terms in seen:  # terms drive each other out in a circle: the best of them stands for all
                step = min(steps, key=lambda one: one.solution.objective)
                steps.append(step)
                if step.unknown.max() > limits.unknown:
                    unknown = _structure(step)
                break
            seen.add(terms)
            first = not step.solution.settings
            needed = self._needed(steps)
            if not first and not np.any(step.gains > needed):
                step = steps[-1] = self._tried(step, needed)
            wanted = np.where(step.gains > needed, step.gains, 0.0)
            order = best_by_id(step.found.candidates, wanted)
            best = order[0] if order else None
            evidence = self._evidence_of(step)
            top_unknown = float(step.unknown.max())
            enough = best is not None and wanted[best] > 0
            chosen = self._best_refit(step, wanted, trials if first else None) if enough else None
            enough = enough and self._holds(step, chosen, needed)
            if not enough:
                if top_unknown > limits.unknown:
                    wandering = self._wandering(step)
                    if wandering is not None:
                        step = self.look(wandering)
                        steps.append(step)
                        continue
                    unknown = _structure(step)
                break
            best_evidence = evidence[best]
            pair = best_pairs(step.found, step.gains) if first else []
            if pair and pair[0][0] > step.gains[best] + PAIR_PRICE * limits.third:
                best_evidence = pair[0][0] / 2 - 10.0
            beaten = top_unknown > limits.unknown and top_unknown > best_evidence + MARGIN
            if beaten and not self._explains(chosen, step, top_unknown):
                further = self._beside_unknown(step, chosen, wanted, top_unknown)
                if further is None:
                    unknown = _structure(step)
                    break
                step = further
            else:
                step = self.look(self._pruned(chosen))
            steps.append(step)
        return steps, unknown

    def _tried(self, step, needed):
        """The round with fits of the terms that the tangents nearly ask for.

        Where another parameter has taken up much of a term, as the temperature of the cold surface does a
        glow, tangents promise a fifth of what a fit gains that moves both.
        """
        gains, refits = step.gains.copy(), dict(step.refits)
        share = np.where(gains > NEAR_MISS * needed, gains / needed, 0.0)
        for index in best_by_id(step.found.candidates, share)[:REFITTED]:
            identity = step.found.candidates[index].id
            if share[index] > 0 and identity not in refits:
                refits[identity] = self.extended(step, index)
                gained = step.solution.objective - refits[identity].objective
                gains[index] = max(gains[index], gained)
        return replace(step, gains=gains, refits=refits)

    def _beside_unknown(self, step, chosen, wanted, top_unknown):
        """The next round where an unknown structure explains more than a term, or None: nothing is named."""
        if 0.5 * (step.solution.objective - chosen.objective) - 5.0 > ENOUGH * top_unknown:
            further = self.look(self._pruned(chosen))
            if further.unknown.max() <= max(self.thresholds.unknown, (1 - ENOUGH) * top_unknown):
                return further
        far = self._mostly(step, top_unknown)
        if far is not None:
            return self.look(self._pruned(far))
        least = max(self.thresholds.third, 2 * SHARE * top_unknown)
        beside = np.where((wanted > 0) & (step.beside > least), step.beside, 0.0)
        if beside.any():
            return self.look(self._pruned(self._best_refit(step, beside)))
        wandering = self._wandering(step)
        return None if wandering is None else self.look(wandering)

    def _by_pair(self, steps, unknown):
        """Rounds that begin with two terms at once, if these explain the data better than `steps` do.

        The first of two terms taken alone takes up what belongs to the other, and leads away from both.
        """
        first, last, limits = steps[0], steps[-1].solution, self.thresholds
        pairs = best_pairs(first.found, first.gains, PAIRS)
        named = {setting.id for setting in last.settings}
        alone = float(first.gains.max(initial=0.0))
        if not pairs or pairs[0][0] < alone + PAIR_PRICE * limits.third:
            return steps, unknown
        fits = []
        for promised, places, numbers in pairs:
            settings = [_setting(first.found.candidates[i], n) for i, n in zip(places, numbers, strict=True)]
            known = named >= {setting.id for setting in settings}
            if known and promised == pairs[0][0]:
                break  # what promises most is what was found
            if not known and promised > NEARLY * pairs[0][0]:
                fits.append(self._pruned(self.fit(first.solution, tuple(settings))))
        fits = [one for one in fits if len(one.settings) > 1]
        if not fits:
            return steps, unknown
        pair = max(fits, key=self.evidence)
        # The stronger of the two by itself is the round between.
        single = min(
            (
                self.fit(pair, tuple(one for one in pair.settings if one is not drop))
                for drop in pair.settings
            ),
            key=lambda one: one.objective,
        )
        rounds, rest = self._walk([first, self.look(single), self.look(pair)], {})
        other = rounds[-1].solution
        price = limits.third + FORMULA * (first.solution.objective - last.objective)
        more = max(len(other.settings) - len(last.settings), 0) if not unknown else 0
        worth = self._worth(rounds[-1], rest) - self._worth(steps[-1], unknown)
        if worth > MARGIN and last.objective - other.objective > more * price:
            return rounds, rest
        return steps, unknown

    def _by_pull(self, steps, unknown):
        """Rounds that end with a term of the gas as a whole, if its power left its prior and none is named.

        ASSUME: such a power is a finding even where no term explains the spectra better than it does. What
        doubles a line differs from a power by some per cent of it, as the formulas may; a fit with the term
        may therefore be worse by as much as the prior of the power has cost.
        """
        step = steps[-1]
        used = {setting.id for setting in step.solution.settings}
        if not self._too_strong(step.solution) or used & set(strengths.BEHIND) or len(used) >= MOST_TERMS:
            return steps, unknown
        worst = step.solution.objective + self._pull(step.solution) ** 2
        good = [one for one in step.refits.values() if one.objective < worst and not self._too_strong(one)]
        if not good:
            return steps, unknown
        further = self.look(max(good, key=self.evidence))
        left = _structure(further) if further.unknown.max() > self.thresholds.unknown else None
        return [*steps, further], left

    def _behind(self, steps, identity):
        """Ids of the other terms of the gas as a whole, if one is named for a power that left its prior.

        Which of them it is, formulas exact to some per cent do not tell.
        """
        if identity not in strengths.BEHIND or not self._too_strong(steps[0].solution):
            return ()
        named = {setting.id for setting in steps[-1].solution.settings}
        tried = {one for step in steps for one in step.refits if one in strengths.BEHIND}
        return tuple(sorted(tried - named))

    def _worth(self, step, unknown):
        """Log evidence of a round; what is left unknown counts as explained, but for `ENOUGH`."""
        return self.evidence(step.solution) + (ENOUGH * float(step.unknown.max()) if unknown else 0.0)

    def _evidence_of(self, step):
        """Log Bayes factor (candidates,), from the fits that exist, else by the linear estimate."""
        evidence, plain = linear_evidence(step.found), self.evidence(step.solution)
        for place, one in enumerate(step.found.candidates):
            if one.id in step.refits:
                evidence[place] = max(evidence[place], self.evidence(step.refits[one.id]) - plain)
        return evidence

    def _wandering(self, step):
        """Fit with a brightness of the gas that wanders freely, if that is the structure found and none is
        in."""
        found = _structure(step)
        used = [setting.id for setting in step.solution.settings]
        if found != "walk_gas" or WANDER in self.exclude or len(used) >= MOST_TERMS:
            return None
        others = tuple(s for s in step.solution.settings if s.id != WANDER)
        already = [s for s in step.solution.settings if s.id == WANDER]
        if already and already[0].shape:
            return None
        shape = {name: 0.0 for name in EFFECTS[WANDER].shape_bounds}
        amplitude = already[0].amplitude if already else 0.0
        return self.fit(step.solution, (*others, Setting(WANDER, amplitude, shape)))

    @staticmethod
    def _holds(step, chosen, needed):
        """Whether the refit, non-linear and within its bounds, gains enough, as the tangent promised."""
        (new,) = {one.id for one in chosen.settings} - {one.id for one in step.solution.settings}
        least = min(n for n, one in zip(needed, step.found.candidates, strict=True) if one.id == new)
        return step.solution.objective - chosen.objective > least

    def _explains(self, chosen, step, top_unknown):
        """Whether the refit, non-linear, gains as much as the unknown structure."""
        gained = step.solution.objective - chosen.objective
        return 0.5 * gained - 5.0 > top_unknown - MARGIN

    def _too_strong(self, solution):
        """Whether the power of a fit has left its prior."""
        return abs(self._pull(solution)) > PULL

    def _pull(self, solution):
        """Prior standard deviations [1] by which the power of a fit is off."""
        place = self.model.index["power"]
        return solution.state.values[place] / self.model.parameters[place].sigma

    def _mostly(self, step, top_unknown):
        """Best of the fits from far away that explains enough to be named beside what stays unknown, or None.

        Tangents do not tell what the unknown structure would leave to such a term; its formula errs most
        where it changes most.
        """
        limit = max(self.thresholds.third, 2 * SHARE * top_unknown)
        good = [one for one in step.refits.values() if step.solution.objective - one.objective > limit]
        return max(good, key=self.evidence, default=None)

    def _of_formulas(self, steps):
        """Chi-squared (candidates,) that inexact formulas of the terms fitted so far may leave to each."""
        gained = steps[0].solution.objective - steps[-1].solution.objective
        found, candidates = steps[0].found, steps[-1].found.candidates
        place = {(one.id, tuple(one.shape.items())): i for i, one in enumerate(found.candidates)}
        here = [place[one.id, tuple(one.shape.items())] for one in candidates]
        information = found.information[: found.count, : found.count]
        length = np.sqrt(np.maximum(np.diag(information), 1e-300))
        left = np.full(len(candidates), SPILL * gained)
        for setting in steps[-1].solution.settings:
            own = [i for i, one in enumerate(found.candidates) if one.id == setting.id]
            if not own:
                continue
            mine = max(own, key=lambda i: steps[0].gains[i])
            cosine = np.abs(information[mine, here]) / (length[mine] * length[here])
            left += np.where(cosine > KIN, FORMULA * steps[0].gains[mine], 0.0)
        return left

    def _best_refit(self, step, gains, trials=None):
        """The best of the refits of the candidates that explain about as much."""
        order = best_by_id(step.found.candidates, gains)
        top = gains[order[0]]
        near = [index for index in order if gains[index] > 0.5 * top][:REFITTED]
        fits = []
        for index in near:
            fits.append(self._refit(step, index))
            if trials is not None:
                trials[step.found.candidates[index].id] = self.evidence(fits[-1])
        return max(fits, key=self.evidence)

    def _refit(self, step, index):
        """Fit with one more candidate: the one there is from far away, unless only the tangent saw it."""
        far = step.refits.get(step.found.candidates[index].id)
        if far is not None and step.solution.objective - far.objective >= step.gains[index]:
            return far
        return self.extended(step, index)

    def evidence(self, solution):
        """Log evidence of a fit."""
        return log_evidence(solution, self.model.size + len(self.model.parameters))

    def _pruned(self, solution):
        """The fit without terms that no longer bring the threshold."""
        while len(solution.settings) > 1:
            without = []
            for drop in range(len(solution.settings)):
                kept = tuple(s for place, s in enumerate(solution.settings) if place != drop)
                without.append(self.fit(solution, kept))
            least = min(without, key=lambda one: one.objective)
            (lost,) = {one.id for one in solution.settings} - {one.id for one in least.settings}
            limit = ALONE if lost in strengths.BEHIND and self._too_strong(least) else self.thresholds.effect
            if least.objective - solution.objective > limit:
                break
            solution = least
        return solution

    def _set(self, step, identity):
        """Ids that the data do not tell from a term: nearly the same gain, or nearly the same direction."""
        found, gains = step.found, step.gains
        order = best_by_id(found.candidates, gains)
        mine = next((i for i in order if found.candidates[i].id == identity), None)
        if mine is None:
            return (identity,)
        angle = angles(found.information[: found.count, : found.count])[mine]
        own = gains[mine]
        alike = [
            found.candidates[i].id
            for i in order
            if i != mine
            and found.left[i] > 1e-6
            and (angle[i] < SAME_ANGLE or (own - gains[i] < ALIKE and angle[i] < 45.0))
        ]
        return (identity, *alike)

    @staticmethod
    def _status(final, unknown, sets):
        if not final.settings:
            return "unknown" if unknown else "null"
        if unknown:
            return "named+unknown"
        return "one-of" if any(len(one) > 1 for one in sets) else "named"
