"""Names that their own fit speaks against: something is there, but not they, or not they alone."""

from collections import Counter
from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.fit.build import OF_GAS
from plasmapyro.diagnosis.fit.setting import free_numbers
from plasmapyro.diagnosis.select.prices import CLEARLY
from plasmapyro.diagnosis.select.screen import best_by_id
from plasmapyro.diagnosis.select.search import PULL
from plasmapyro.diagnosis.select.selection import alike

TOLD = 2.0  # standard errors, shapes free; see docs/decisions.md
FAR = 5.0  # prior standard deviations that a number known before is off beside names that are not right
OWN = {  # effect that a number of the base model is, where it is far off
    "clocks": "clock",
    "ratio": "phi",
    "emittance_slope": "eps_slope",
    "edge_wide": "edge1",
    "edge_narrow": "edge2",
    "tail": "resp_long",
    "dark_drift": "off_s",
}


def told(search, selection):
    """A selection without names of which it is doubted that they are right, and whose amplitudes are within
    `TOLD` standard errors of nought, or beside which a number that was known is `FAR` off, unless the effect
    that this number is explains as much, or it is as far off without them.

    Where a formula is not that of the cause its shape goes as far as it may, and the amplitude that is left
    may as well vanish, or emittance, clocks and calibrations go where they cannot be. Of several names that
    are not told from nought that one is dropped first without which the fit is best.

    Parameters
    ----------
    search : Search
    selection : Selection

    Returns
    -------
    Selection, the same if there is nothing to drop
    """
    first, doubtful = selection.steps[0], selection.status == "named+unknown"
    if strained(search.model, selection.final) > PULL:
        selection = selection.doubted("strained")
    if selection.status != "named+unknown":
        return selection
    if _blamed(search.model, first.solution, selection.final):
        own = _own_effect(search, first, selection.final)
        return (
            selection.unnamed() if own is None else _with(search, selection, [first, search.look(own)], "own")
        )
    steps = list(selection.steps)
    while doubtful:  # what a number that is off alone makes doubtful may be the cause of that
        solution = steps[-1].solution
        sizes = zip(solution.settings, _sizes(search, solution), strict=True)
        weak = [one for one, size in sizes if size < TOLD]
        if not weak:
            break
        if len(solution.settings) == 1:
            return selection.unnamed()
        fits = [
            search.fit(solution, tuple(kept for kept in solution.settings if kept is not dropped))
            for dropped in weak
        ]
        steps.append(search.look(min(fits, key=lambda fit: fit.objective)))
    if len(steps) == len(selection.steps):
        return selection
    if _blamed(search.model, first.solution, steps[-1].solution):
        return selection.unnamed()
    return _with(search, selection, steps, "weak")


def _with(search, selection, steps, reason):
    """The selection with other rounds, of which the last holds its names, with reserve for a reason."""
    first, final = steps[0], steps[-1].solution
    return replace(
        selection,
        steps=tuple(steps),
        final=final,
        sets=tuple(alike(first, setting.id) for setting in final.settings),
        reserve=reason,
        evidence=search.evidence(final) - search.evidence(first.solution),
    )


def strained(model, solution):
    """Largest distance of a number of surface or instruments from what was known of it, in its prior standard
    deviations; gains that wander are series of small ones and not asked."""
    return max(_distances(model, solution).values(), default=0.0)


def _blamed(model, before, now):
    """Whether in a fit a number is far off that has an effect of its own, or that is farther off than in the
    one `before` its names: an emittance that was stated too surely says nothing of them."""
    there = _distances(model, before)
    sizes = _distances(model, now).items()
    return any(size > FAR and (name in OWN or size > there[name] + 1) for name, size in sizes)


def _distances(model, solution):
    numbers = list(zip(model.parameters, solution.state.values, strict=True))
    count = Counter(parameter.id for parameter, _ in numbers)
    return {
        parameter.id: abs(value - parameter.centre) / parameter.sigma
        for parameter, value in numbers
        if parameter.id not in OF_GAS and not parameter.history and count[parameter.id] == 1
    }


def _own_effect(search, first, solution):
    """The fit with the one effect that a number far off in `solution` is, or None: where it explains nearly
    as much as other names beside it do, it is the one. Another name may share with a number what both are."""
    far = {OWN.get(name) for name, size in _distances(search.model, solution).items() if size > FAR}
    far -= {setting.id for setting in solution.settings}
    candidates = first.screen.candidates
    fits = [
        search.extended(first, index)
        for index in best_by_id(candidates, first.gains)
        if candidates[index].id in far
    ]
    best = max(fits, key=search.evidence, default=None)
    if best is None or _blamed(search.model, first.solution, best):
        return None
    return best if first.gained(best) > CLEARLY * first.gained(solution) else None


def _sizes(search, solution):
    """Amplitudes of the effects of a fit, in order, over their standard errors with all else free."""
    first = search.model.size + len(search.model.parameters)
    error = np.sqrt(np.diag(solution.covariance)[first:])
    free = zip(free_numbers(solution.settings), solution.state.amplitudes, error, strict=True)
    return [abs(number) / own for one, number, own in free if one.name is None]
