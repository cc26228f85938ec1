"""Names with reserve whose sizes the fit does not tell from nought: something is there, but not they."""

from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.fit.setting import free_numbers

TOLD = 2.0  # standard errors, shapes free; see docs/decisions.md


def told(search, selection):
    """A selection without names of which it is doubted that they are right, and whose amplitudes are within
    `TOLD` standard errors of nought.

    Where a formula is not that of the cause its shape goes as far as it may, and the amplitude that is left
    may as well vanish. Of several such names that one is dropped first without which the fit is best.

    Parameters
    ----------
    search : Search
    selection : Selection

    Returns
    -------
    Selection, the same if there is nothing to drop
    """
    steps = list(selection.steps)
    while selection.status == "named+unknown":
        solution = steps[-1].solution
        weak = [
            one for one, size in zip(solution.settings, _sizes(search, solution), strict=True) if size < TOLD
        ]
        if not weak:
            break
        if len(solution.settings) == 1:
            return selection.unnamed()
        fits = [
            search.fit(solution, tuple(kept for kept in solution.settings if kept is not dropped))
            for dropped in weak
        ]
        steps.append(search.look(min(fits, key=lambda fit: fit.objective)))
    final = steps[-1].solution
    if final is selection.steps[-1].solution:
        return selection
    names = {setting.id for setting in final.settings}
    return replace(
        selection, steps=tuple(steps), final=final, sets=tuple(s for s in selection.sets if s[0] in names)
    )


def _sizes(search, solution):
    """Amplitudes of the effects of a fit, in order, over their standard errors with all else free."""
    first = search.model.size + len(search.model.parameters)
    error = np.sqrt(np.diag(solution.covariance)[first:])
    free = zip(free_numbers(solution.settings), solution.state.amplitudes, error, strict=True)
    return [abs(number) / own for one, number, own in free if one.name is None]
