"""Whether names are certain, or whether one cause that the catalogue lacks might lie behind them."""

import numpy as np

from plasmapyro.diagnosis.inference import free_numbers

NEIGHBOUR = 30.0  # [degree] from the first name within which a cause that the catalogue lacks may lie,
SAME = 15.0  # [degree] and beyond which it is not of the same class
LEAST, MOST = (float(np.tan(np.radians(one)) ** 2) for one in (SAME, NEIGHBOUR))
WRONG_FORMULA = 0.1  # [1], of the chi-squared that the names explain: a rest as large is not their formulas'
CANCELLING = 4.0  # times what names explain together that each alone would: equal ones at 41 degrees

SENTENCES = {
    "rest": "The data reject these names as an exact fit: a formula is inexact, or another cause is behind.",
    "one": "What was named later is so much less than what was before that one cause, near the first but"
    " missing in the catalogue, would look the same.",
    "cancel": "The names nearly cancel each other: what is left may be one cause that the catalogue lacks.",
}


def reserve(steps, third):
    r"""Why the names of the last of some rounds are not certain.

    A cause outside the catalogue at an angle :math:`\theta` from a named one is imitated by this one, and
    :math:`\tan^2\theta` of the chi-squared that it explains is left: to other names, or as a rest.

    Parameters
    ----------
    steps : sequence of Step, the base fit first
    third : float
        Chi-squared that one more term would have to gain.

    Returns
    -------
    str
        "rest": what remains is beyond noise and beyond a tenth of what the names explain; "one": a later name
        explains :math:`\tan^2 15°` to :math:`\tan^2 30°` of what those before it do; "cancel": amplitudes a
        with covariance C and :math:`\sum_i a_i^2 (C^{-1})_{ii} > 4\, a^T C^{-1} a`; "" if none of these.
    """
    objective = {}  # of the last fit with so many terms
    for step in steps:
        objective[len(step.solution.settings)] = step.solution.objective
    count = len(steps[-1].solution.settings)
    if count == 0:
        return ""
    rest = float(np.max(steps[-1].gains, initial=0.0))
    if rest > max(third, WRONG_FORMULA * (objective[0] - objective[count])):
        return "rest"
    for terms in range(2, count + 1):
        if terms not in objective or terms - 1 not in objective:
            continue
        more = objective[terms - 1] - objective[terms]
        before = objective[0] - objective[terms - 1]
        if LEAST * before < more < MOST * before:
            return "one"
    return "cancel" if cancellation(steps[-1].solution) > CANCELLING else ""


def cancellation(solution):
    """Chi-squared of all names, each with its fitted amplitude alone, over that of all together [1]."""
    free = free_numbers(solution.settings)
    place = [j - len(free) for j, (_, name, *_) in enumerate(free) if name is None]
    amplitude = solution.state.amplitudes[place]
    information = np.linalg.inv(solution.covariance[np.ix_(place, place)])
    together = amplitude @ information @ amplitude
    return float(np.sum(amplitude**2 * np.diag(information)) / max(together, 1e-300))
