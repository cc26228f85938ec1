"""Other ways to the effects than one by one: by two at once, or by the other window."""

from plasmapyro.diagnosis.fit.setting import FORMULA, Setting
from plasmapyro.diagnosis.select import prices
from plasmapyro.diagnosis.select.rounds import PAIR_PRICE, walk
from plasmapyro.diagnosis.select.screen import best_pairs
from plasmapyro.diagnosis.select.search import setting_of

PAIRS = 3  # of effects, fitted from the start, of those
NEARLY = 0.95  # that promise as much of what the best pair does
CLEARER = 3.0  # log odds of a window that takes a deposit against one that grows clearer
OTHER = {"winD": "winE", "winE": "winD", "winD_sl": "winE_sl", "winE_sl": "winD_sl"}
COUNTED = 0.9  # of the log Bayes factor of what a round leaves unknown, where rounds are compared


def by_pair(search, steps, unknown):
    """Rounds that begin with two effects at once, if these explain the data better than `steps` do.

    The first of two effects taken alone takes up what belongs to the other, and leads away from both.

    Parameters
    ----------
    search : Search
    steps : list of Step, the base fit first
    unknown : id of the unknown structure that they leave, or None

    Returns
    -------
    (steps, unknown)
    """
    first, last, limits = steps[0], steps[-1].solution, search.thresholds
    fits = _pairs(search, first, last)
    if not fits:
        return steps, unknown
    pair = max(fits, key=search.evidence)
    # The stronger of the two by itself is the round between.
    alone = [search.fit(pair, tuple(s for s in pair.settings if s is not drop)) for drop in pair.settings]
    single = min(alone, key=lambda fit: fit.objective)
    rounds, rest = walk(search, [first, search.look(single), search.look(pair)], {})
    other = rounds[-1].solution
    price = limits.third + FORMULA * first.gained(last)
    more = max(len(other.settings) - len(last.settings), 0) if not unknown else 0
    worth = _worth(search, rounds[-1], rest) - _worth(search, steps[-1], unknown)
    if worth > prices.MARGIN and last.objective - other.objective > more * price:
        return rounds, rest
    return steps, unknown


def _pairs(search, first, last):
    """Fits with two effects that together promise more than one, and that `last` does not hold."""
    pairs = best_pairs(first.screen, first.gains, PAIRS)
    best_alone = float(first.gains.max(initial=0.0))
    if not pairs or pairs[0][0] < best_alone + PAIR_PRICE * search.thresholds.third:
        return []
    named, most = {setting.id for setting in last.settings}, pairs[0][0]
    fits = []
    for promised, places, numbers in pairs:
        candidates = [first.screen.candidates[place] for place in places]
        settings = tuple(setting_of(*pair) for pair in zip(candidates, numbers, strict=True))
        known = named >= {setting.id for setting in settings}
        if known and promised == most:
            break  # what promises most is what was found
        if not known and promised > NEARLY * most:
            fits.append(search.pruned(search.fit(first.solution, settings)))
    return [fit for fit in fits if len(fit.settings) > 1]


def _worth(search, step, unknown):
    """Log evidence of a round; what is left unknown counts as explained, by `COUNTED` of it."""
    return search.evidence(step.solution) + (COUNTED * float(step.unknown.max()) if unknown else 0.0)


def by_other_window(search, steps, unknown):
    """Rounds that go on from a loss of the other window where one was found to grow clearer, if they explain
    nearly as much: beside a change of the emittance the two are each other's opposite.

    Parameters and what is returned as of `by_pair`.
    """
    last = steps[-1]
    # Of an instrument that the test lacks no effect is a candidate.
    free = {one.id for one in last.screen.candidates} - {setting.id for setting in last.settings}
    for place, one in enumerate(last.settings):
        other = search.effects.get(OTHER.get(one.id, ""))
        if other is None or other.id not in free or one.amplitude >= 0:
            continue
        settings = list(last.settings)
        settings[place] = Setting(other, -one.amplitude, one.shape)
        turned = search.look(search.fit(last.solution, tuple(settings)))
        rounds, rest = walk(search, [*steps[:-1], turned], {})
        if _worth(search, rounds[-1], rest) > _worth(search, last, unknown) - CLEARER:
            return rounds, rest
    return steps, unknown
