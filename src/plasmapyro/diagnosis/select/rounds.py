"""Rounds of a search: forward with non-linear refits, backward, and what stays unknown."""

from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.select import prices
from plasmapyro.diagnosis.select.screen import best_by_id, best_pairs
from plasmapyro.diagnosis.select.search import REFITTED, at_end

MOST_EFFECTS = 3
NEAR_MISS = 0.5  # of what a further effect must bring: if its tangent promises so much, it is fitted
PAIR_PRICE = 1.5  # times the threshold that the second effect of a pair must bring
PAIR_FREE = 10.0  # log evidence that the numbers of two effects cost, about


def walk(search, steps, trials):
    """Rounds from the last of some until no effect is asked for.

    Parameters
    ----------
    search : Search
    steps : list of Step
    trials : dict
        Log evidence of the fits with a first effect goes into it, by id.

    Returns
    -------
    (steps, id of the unknown structure that is left, or None)
    """
    steps, seen = list(steps), set()
    while len(steps[-1].settings) < MOST_EFFECTS:
        names = frozenset((setting.id, *sorted(setting.shape)) for setting in steps[-1].settings)
        if names in seen:  # effects drive each other out in a circle: the best of them stand for all
            steps.append(min(steps, key=lambda step: step.solution.objective))
            return steps, left(search, steps[-1])
        seen.add(names)
        price = prices.needed(search, steps)
        if steps[-1].settings and not np.any(steps[-1].gains > price):
            steps[-1] = _tried(search, steps[-1], price)
        further, unknown = _next(search, steps[-1], price, trials)
        if further is None:
            return steps, unknown
        steps.append(further)
    return steps, None


def left(search, step):
    """Id of the unknown structure that a round leaves, or None."""
    return step.structure if step.unknown.max() > search.thresholds.unknown else None


def _next(search, step, price, trials):
    """The next round, or None and what stays unknown."""
    wanted = np.where(step.gains > price, step.gains, 0.0)
    first, limits, log_bayes = not step.settings, search.thresholds, float(step.unknown.max())
    chosen = None
    if np.any(wanted > 0):
        chosen = search.best_refit(step, wanted, trials if first else None)
    if chosen is not None and first and chosen.converged:  # else they were tried
        chosen = search.from_all_shapes(step, chosen)
    if chosen is None or not prices.holds(step, chosen, price) or (not first and at_end(chosen)):
        return None, left(search, step)
    best = best_by_id(step.screen.candidates, wanted)[0]
    evidence = search.evidence_of(step)[best]
    pair = best_pairs(step.screen, step.gains) if first else []
    if pair and pair[0][0] > step.gains[best] + PAIR_PRICE * limits.third:
        evidence = pair[0][0] / 2 - PAIR_FREE
    beaten = log_bayes > limits.unknown and log_bayes > evidence + prices.MARGIN
    if not beaten or prices.explains(step, chosen, log_bayes):
        return search.look(search.pruned(chosen)), None
    further = beside_unknown(search, step, chosen, wanted)
    return further, step.structure if further is None else None


def _tried(search, step, price):
    """The round with fits of the effects that the tangents nearly ask for.

    Where another parameter has taken up much of an effect, as the temperature of the cold surface does a
    glow, tangents promise a fifth of what a fit gains that moves both.
    """
    gains, refits = step.gains.copy(), dict(step.refits)
    share = np.where(gains > NEAR_MISS * price, gains / price, 0.0)
    for index in best_by_id(step.screen.candidates, share)[:REFITTED]:
        identity = step.screen.candidates[index].id
        if share[index] > 0 and identity not in refits:
            refits[identity] = search.extended(step, index)
            gains[index] = max(gains[index], step.gained(refits[identity]))
    return replace(step, gains=gains, refits=refits)


def beside_unknown(search, step, chosen, wanted):
    """The next round where an unknown structure explains more than an effect, or None: nothing is named.

    Parameters
    ----------
    search : Search
    step : Step
    chosen : Solution
        The best refit with one more effect.
    wanted : (candidates,) chi-squared of those that bring what they must, else 0
    """
    log_bayes = float(step.unknown.max())
    if prices.much(step, chosen, log_bayes):  # by chance one direction of many is not alike
        return search.look(search.pruned(chosen))
    least = prices.beside(search, log_bayes)
    # Tangents do not tell what the unknown structure would leave to an effect that was fitted; its formula
    # errs most where it changes most.
    far = [fit for fit in step.refits.values() if step.gained(fit) > least]
    if far:
        return search.look(search.pruned(max(far, key=search.evidence)))
    beside = np.where((wanted > 0) & (step.beside > least), step.beside, 0.0)
    if beside.any():
        return search.look(search.pruned(search.best_refit(step, beside)))
    return None
