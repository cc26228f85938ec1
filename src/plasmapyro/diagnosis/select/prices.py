"""What an effect must bring to be named: first, further, beside something unknown."""

import numpy as np

from plasmapyro.diagnosis.fit.setting import FORMULA, KIN, SPILL

HALF = 0.5  # of the log Bayes factor of an unknown structure: an effect that explains so much, by an inexact
# formula, is named beside what it leaves
FOREIGN, AIR = "foreign matter", "air"  # classes of effects
CLEARLY = 0.9  # the same of names at the end: of those that explained less, 44 of 48 were wrong
SPECTRUM = 1 / 3  # the same of foreign matter, whose lines and bands are to each other as its excitation says
MARGIN = 3.0  # log Bayes factor by which an unknown structure must beat an effect
SHARE = 0.15  # of what an unknown structure explains: an effect beside it must explain as much
FREE = 5.0  # log evidence that the numbers of an effect cost, about


def needed(search, steps):
    """Chi-squared (candidates,) that a further effect must bring."""
    step, limits = steps[-1], search.thresholds
    if step.settings:
        return limits.third + _of_formulas(steps)
    return np.full(step.screen.count, limits.effect)


def _of_formulas(steps):
    """Chi-squared (candidates,) that inexact formulas of the effects fitted so far may leave to each."""
    gained = steps[0].gained(steps[-1].solution)
    screen, candidates = steps[0].screen, steps[-1].screen.candidates
    place = {
        (candidate.id, tuple(candidate.shape.items())): i for i, candidate in enumerate(screen.candidates)
    }
    here = [place[candidate.id, tuple(candidate.shape.items())] for candidate in candidates]
    information = screen.information[: screen.count, : screen.count]
    length = np.sqrt(np.maximum(np.diag(information), 1e-300))
    left = np.full(len(candidates), SPILL * gained)
    for setting in steps[-1].settings:
        shapes = [i for i, candidate in enumerate(screen.candidates) if candidate.id == setting.id]
        if not shapes:
            continue
        mine = max(shapes, key=lambda i: steps[0].gains[i])
        cosine = np.abs(information[mine, here]) / (length[mine] * length[here])
        left += np.where(cosine > KIN, FORMULA * steps[0].gains[mine], 0.0)
    return left


def holds(step, fit, price):
    """Whether a refit, non-linear and within its bounds, gains enough, as the tangent promised."""
    (new,) = {setting.id for setting in fit.settings} - {setting.id for setting in step.settings}
    least = min(p for p, candidate in zip(price, step.screen.candidates, strict=True) if candidate.id == new)
    return step.gained(fit) > least


def explains(step, fit, log_bayes):
    """Whether a refit, non-linear, gains as much as an unknown structure."""
    return 0.5 * step.gained(fit) - FREE > log_bayes - MARGIN


def much(step, fit, log_bayes):
    """Whether a refit explains much of an unknown structure: a formula errs, but not by all that is there."""
    before = {setting.id for setting in step.settings}
    (new,) = (setting.effect for setting in fit.settings if setting.id not in before)
    return 0.5 * step.gained(fit) > (SPECTRUM if new.klass == FOREIGN else HALF) * log_bayes


def outdone(names, evidence, log_bayes):
    """Whether what no cause describes is clearly likelier than names (settings) of some log evidence, which
    then say no more than what it looks like; of lines and bands a spectrum shows many at once."""
    spectra = any(one.effect.klass in (FOREIGN, AIR) for one in names)
    return bool(names) and evidence < (SPECTRUM if spectra else CLEARLY) * log_bayes


def beside(search, log_bayes):
    """Chi-squared that an effect must bring to be named beside an unknown structure."""
    return max(search.thresholds.third, 2 * SHARE * log_bayes)
