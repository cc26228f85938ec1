"""Linearised tests around a fit: every effect that is looked for, and structures that no effect describes."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve, solve_triangular
from scipy.special import logsumexp

from plasmapyro.diagnosis.effects.effect import Effect
from plasmapyro.diagnosis.fit.normal import gram, own_patterns
from plasmapyro.diagnosis.fit.setting import TAILS, Setting
from plasmapyro.diagnosis.select.structures import MOVED, WALK_STEPS, structures_of

# What the base parameters must leave [1] of the information of a direction for it to be seen, in gains,
# names, probabilities and words alike: slopes by differences err by some 1e-5, and what is left of a
# direction by the square of that. Of the 1e9 that fast instruments hold, a millionth is much.
LEAST_LEFT = 1e-9


@dataclass(frozen=True)
class Candidate:
    """An effect at one shape, linearised by an amplitude of `step`, that of the effect if None."""

    effect: Effect
    shape: dict
    step: float | None = None

    @property
    def id(self):
        """That of the effect."""
        return self.effect.id


@dataclass(frozen=True)
class Screen:
    """What the data say about directions beside the base fit.

    `score` (m,) and `information` (m, m) of all columns (candidates first) with the fitted parameters
    projected out; `left` (m,) the share of each column's information that the base parameters leave.
    """

    candidates: tuple
    structures: tuple
    score: np.ndarray
    information: np.ndarray
    left: np.ndarray
    shift: np.ndarray  # (K, m) [K] change of the fitted knots per unit of a column that is left out

    @property
    def count(self):
        """Number of candidates, each at each of its shapes."""
        return len(self.candidates)

    def gains(self):
        """Chi-squared gained by each candidate alone (candidates,)."""
        return gain(
            self.score[: self.count], np.diag(self.information)[: self.count], self.left[: self.count]
        )

    def linear(self):
        """Best number of each candidate alone along its column, see `Effect.linear_of`."""
        own = np.diag(self.information)[: self.count]
        return self.score[: self.count] / np.where(own > 0, own, np.inf)

    def amplitudes(self):
        """Best amplitude of each candidate alone."""
        return np.array(
            [
                candidate.effect.amplitude_of(x)
                for candidate, x in zip(self.candidates, self.linear(), strict=True)
            ]
        )

    def ends(self):
        """Least and largest number of each candidate along its column (2, candidates)."""
        effects = [candidate.effect for candidate in self.candidates]
        return np.array([[one.linear_of(end) for end in one.bounds] for one in effects]).T

    def signed_gains(self):
        """As `gains`, but 0 where the best amplitude lies outside what the effect allows."""
        low, high = self.ends()
        size = self.linear()
        # One standard deviation of slack: the linear estimate is not the last word.
        slack = 1 / np.sqrt(np.maximum(np.diag(self.information)[: self.count], 1e-300))
        allowed = (size > low - slack) & (size < high + slack) | (low < 0) & (high > 0)
        return np.where(allowed, self.gains(), 0.0)


def gain(score, information, left):
    """Chi-squared gained along directions."""
    usable = (information > 0) & (left > LEAST_LEFT)
    return np.where(usable, score**2 / np.where(usable, information, 1.0), 0.0)


def columns_of_candidates(model, solution, effects):
    """Linearised columns (n, C, m) per instrument of effects at every shape, and who they are.

    Of an instrument that stands alone its surface knows no clock, only the end of the plasma does, between
    two samples: its clock is asked by finite shifts as well.
    """
    alone = len(model.instruments) == 1
    candidates = tuple(
        Candidate(effect, dict(shape), step)
        for effect in effects.values()
        if set(effect.instruments) & {instrument.kind for instrument in model.instruments}
        for shape in effect.shapes
        for step in (None, *(MOVED if alone and effect.clock else ()))
    )
    state, base = solution.state, solution.settings
    columns = []
    for which, instrument in enumerate(model.instruments):
        error = state.error_of_gas(which)
        plain = model.evaluate(which, state.knots, state.values, base, gas_error=error)
        rows = np.zeros((*plain.shape, len(candidates)))
        for j, candidate in enumerate(candidates):
            effect = candidate.effect
            step = candidate.step or effect.step
            setting = Setting(effect, step, candidate.shape)
            if not setting.acts_on(instrument.kind):
                continue
            changed = model.evaluate(which, state.knots, state.values, (*base, setting), gas_error=error)
            rows[..., j] = (changed - plain) / step
        columns.append(rows)
    return candidates, columns


def screen(model, solution, effects, structures=True, steps=WALK_STEPS):
    """Score and information of all candidates and structures, base parameters projected out.

    Parameters
    ----------
    model : Model
    solution : Solution
    effects : mapping id -> Effect, those that are looked for
    structures : bool
        Whether unknown structures are looked for as well.
    steps : int
        Of those that wander.

    Returns
    -------
    Screen
    """
    candidates, columns = columns_of_candidates(model, solution, effects)
    classes, patterns, products, more = (), [], None, 0
    if structures:
        classes, products, patterns = structures_of(model, solution, steps)
        more = products[0][1].shape[2]
    fitted = solution.jacobian[0].shape[2]
    dense = [np.concatenate(parts, axis=2) for parts in zip(solution.jacobian, columns, strict=True)]
    mine = own_patterns(model.instruments, solution.plain, solution.gas_rows)
    matrix, vector = gram(dense, [*mine, *patterns], solution.weighers, solution.residual, products)
    tests = dense[0].shape[2] - fitted + more
    base_patterns = sum(row.shape[1] for _, row in mine)
    first = fitted + tests
    base = np.r_[0:fitted, first : first + base_patterns]
    rest = np.r_[fitted:first, first + base_patterns : matrix.shape[0]]
    cross = matrix[np.ix_(base, rest)]
    own = matrix[np.ix_(rest, rest)]
    half = solve_triangular(solution.factor[0], cross, trans="T")
    projected = own - half.T @ half
    plain = np.diag(own)
    left = np.diag(projected) / np.where(plain > 0, plain, np.inf)
    # What the fit has left undone is none of the others' business.
    score = vector[rest] - cross.T @ cho_solve(solution.factor, solution.score)
    knots = cho_solve(solution.factor, np.eye(len(cross))[:, : model.size])
    return Screen(candidates, classes, score, projected, left, knots.T @ cross)


def angles(information):
    """Angles (m, m) [degrees] between directions in the metric of the data, 90 where one is invisible."""
    length = np.sqrt(np.maximum(np.diag(information), 0))
    safe = np.where(length > 0, length, np.inf)
    cosine = np.abs(information) / np.outer(safe, safe)
    return np.degrees(np.arccos(np.clip(cosine, 0, 1)))


def linear_evidence(screen):
    """Log Bayes factor (candidates,) of each over no effect, by the prior of `setting.log_prior`."""
    own = np.diag(screen.information)[: screen.count]
    sigma2 = np.array([(TAILS * candidate.effect.sigma) ** 2 for candidate in screen.candidates]).T
    score = screen.score[: screen.count]
    usable = screen.left[: screen.count] > LEAST_LEFT
    value = -0.5 * np.log1p(sigma2 * own) + 0.5 * score**2 / (own + 1 / sigma2)
    value = logsumexp(value, axis=0) - np.log(TAILS.size)
    return np.where(usable, value, -np.inf)


def best_by_id(candidates, values):
    """Index of the best shape of each id, best first."""
    best = {}
    for index, (candidate, value) in enumerate(zip(candidates, values, strict=True)):
        if candidate.id not in best or value > values[best[candidate.id]]:
            best[candidate.id] = index
    return sorted(best.values(), key=lambda index: -values[index])


def best_pairs(screen, allowed, count=1):
    """Pairs of candidates that together gain most, by the linear estimate, each pair of ids once, with
    amplitudes that both may have.

    Returns
    -------
    list of (gain, (first, second) places, (first, second) numbers along their columns), best first
    """
    chosen = np.flatnonzero(allowed > 0)
    if chosen.size < 2:
        return []
    info = screen.information[np.ix_(chosen, chosen)]
    own, score = np.diag(info), screen.score[chosen]
    determinant = np.outer(own, own) - info**2
    apart = determinant > 0.05 * np.outer(own, own)
    ids = np.array([screen.candidates[index].id for index in chosen])
    apart &= ids[:, None] != ids[None]
    safe = np.where(apart, determinant, 1.0)
    numbers = (score[:, None] * own[None] - score[None] * info) / safe  # of the first of each pair
    low, high = screen.ends()[:, chosen]
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
