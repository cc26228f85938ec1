"""Whether names are certain, or whether one cause that the catalogue lacks might lie behind them."""

import numpy as np

from plasmapyro.diagnosis.fit.setting import free_numbers

NEIGHBOUR = 30.0  # [degree] from the first name within which a cause that the catalogue lacks may lie,
SAME = 15.0  # [degree] and beyond which it is not of the same class
LEAST, MOST = (float(np.tan(np.radians(one)) ** 2) for one in (SAME, NEIGHBOUR))
WRONG_FORMULA = 0.1  # [1], of the chi-squared that the names explain: a rest as large is not their formulas'
CANCELLING = 4.0  # times what names explain together that each alone would: equal ones at 41 degrees
LARGEST = 1e-3  # [1], of an amplitude, from the largest that it may have
AT_END = 0.01  # [1], of the range of a shape: nearer to its end the data want a shape beyond
LOSSES = ("winD", "winE", "winD_sl", "winE_sl")  # a deposit makes no window clearer
SURE = 3.0  # standard deviations

BEATEN = "beaten"
SENTENCES = {
    "unconfirmed": "Data that are left out of the fit do not confirm these names by three standard errors.",
    "moment": "Nearly all that speaks for these names are a few seconds: something may have happened then.",
    "rest": "The data reject these names as an exact fit: a formula is inexact, or another cause is behind.",
    "one": "The first cause explains so much more than the others that one cause like it, but missing in the"
    " catalogue, would look the same.",
    "shape": "A name fits only with a shape at the end of what its cause may have: it may be another cause.",
    "end": "A name fits only if it is as large as its cause may be: it may be another cause.",
    "sign": "A window that grows clearer is unlikely: it may be another cause.",
    "alike": "Two names look alike in the data: together they may be one cause that the catalogue lacks.",
    BEATEN: "What no cause describes is likelier than these names with all their free numbers: it may be"
    " another cause.",
    "bent": "A name would fit clearly better if it changed otherwise over wavelength, time, temperature or"
    " signal: it may be another cause.",
    "strained": "Beside these names something that was known is off by more than three standard deviations.",
    "own": "Other names explain as much, but only if something that was known is far off.",
    "weak": "Beside these names others were dropped whose size the data do not tell from nought.",
    "cancel": "The names nearly cancel each other: what is left may be one cause that the catalogue lacks.",
}


def reserve(steps, third, sets=()):
    r"""Why the names of the last of some rounds are not certain.

    A cause outside the catalogue at an angle :math:`\theta` from a named one is imitated by this one, and
    :math:`\tan^2\theta` of the chi-squared that it explains is left: to other names, or as a rest.

    Parameters
    ----------
    steps : sequence of Step, the base fit first
    third : float
        Chi-squared that one more effect would have to gain.
    sets : sequence of sequences of ids
        Of each name, itself first, those that the data do not tell from it.

    Returns
    -------
    str
        "rest": what remains is beyond noise and beyond a tenth of what the names explain; "one": a later name
        explains :math:`\tan^2 15°` to :math:`\tan^2 30°` of what those before it do; "cancel": amplitudes a
        with covariance C and :math:`\sum_i a_i^2 (C^{-1})_{ii} > 4\, a^T C^{-1} a`; "shape": a shape ends
        within a hundredth of its range from an end at which none is looked for; "end": an amplitude is as
        large as it may be; "sign": a deposit is negative by three standard deviations; "alike": two names
        stand in each other's set; "" if none of these.
    """
    objective = {}  # of the last fit with so many effects
    for step in steps:
        objective[len(step.solution.settings)] = step.solution.objective
    count = len(steps[-1].solution.settings)
    if count == 0:
        return ""
    rest = float(np.max(steps[-1].gains, initial=0.0))
    if rest > max(third, WRONG_FORMULA * (objective[0] - objective[count])):
        return "rest"
    for many in range(2, count + 1):
        if many not in objective or many - 1 not in objective:
            continue
        more = objective[many - 1] - objective[many]
        before = objective[0] - objective[many - 1]
        if LEAST * before < more < MOST * before:
            return "one"
    if cancellation(steps[-1].solution) > CANCELLING:
        return "cancel"
    if any(ids[0] in other[1:] and other[0] in ids[1:] for ids in sets for other in sets):
        return "alike"
    return implausible(steps[-1].solution)


def implausible(solution):
    """ "shape", "end" or "sign" if a number of a name is none that its cause is likely to have, else ""."""
    free, size = free_numbers(solution.settings), len(solution.covariance)
    for j, one in enumerate(free):
        effect, number = solution.settings[one.place].effect, solution.state.amplitudes[j]
        tried = {shape.get(one.name) for shape in effect.shapes}
        nearest = one.low if number - one.low < one.high - number else one.high
        if one.name in effect.shapes[0] and one.at_end(number, AT_END) and nearest not in tried:
            return "shape"
        if one.name is None and one.exhausted(number, LARGEST):
            return "end"
        error = np.sqrt(solution.covariance[size - len(free) + j, size - len(free) + j])
        if one.name is None and effect.id in LOSSES and number < -SURE * error:
            return "sign"
    return ""


def cancellation(solution):
    """Chi-squared of all names, each with its fitted amplitude alone, over that of all together [1]."""
    free = free_numbers(solution.settings)
    place = [j for j, number in enumerate(free) if number.name is None]
    amplitude = solution.state.amplitudes[place]
    own = slice(len(solution.covariance) - len(free), None)
    covariance = solution.covariance[own, own]
    scale = np.sqrt(np.diag(covariance))
    information = np.linalg.inv(covariance / np.outer(scale, scale)) / np.outer(scale, scale)
    information = information[np.ix_(place, place)]
    together = amplitude @ information @ amplitude
    return float(np.sum(amplitude**2 * np.diag(information)) / max(together, 1e-300))
