"""How much more than it states the simulation may err: rough bands, A values, systems of any strength."""

from copy import copy

import numpy as np

from plasmapyro.diagnosis.simulation.fitter import settled
from plasmapyro.diagnosis.simulation.systems import CLEARER

ALIKE = 9.2  # chi-squared by which the data tell two effects apart: 99 % of two degrees of freedom
MOST_WRONG = 3  # systems
MOST_GROUPS = 10  # the brightest, which may be of another strength,
MOST_FREE = 2  # and how many of them or of the systems together may stand for an effect
RARE = 7.4  # of the objective: an effect is one of forty, and before the data less probable than such errors
WRONG = 10.8  # chi-squared that a free strength must gain: 99.9 % of one degree of freedom
ROUGHNESS = (0.0, 0.02, 0.035, 0.06, 0.1, 0.2)  # [1] of the light of bands from channel to channel
SCATTER = (1.0, 1.5, 2.0, 3.0)  # [1] of A values over what is stated


def raise_errors(simulated, effects):
    """Give the errors of the simulation that it states too small the size that makes the data most probable.

    Lines of bands stand as close as pixels do: constants of a molecule that err in the fifth digit, or a
    branch without strength, move light from channel to channel without any change of a band (`ROUGHNESS`).
    Classes of A values promise what compilations of other authors do not always keep (`SCATTER`), unless one
    of some `effects` explains as much. Lines of a foreign atom, left out, pass for rough bands: these are as
    rough as they are beside the best of the effects.

    Returns
    -------
    Simulated
        As rough as it is without effects, which fits without any are held to; the same one if as rough.
    """
    simulated.roughness = likeliest(simulated, "roughness", ROUGHNESS)[0]
    base = settled(simulated)[1]
    rough, best = roughness_beside(simulated, effects)
    scatter, objective = likeliest(simulated, "scatter", SCATTER)
    if base.objective - objective > ALIKE and best > objective - CLEARER - RARE:
        simulated.scatter = scatter
        rough, best = roughness_beside(simulated, effects)
    if rough == simulated.roughness:
        return simulated
    plain, simulated.roughness = copy(simulated), rough
    return plain


def roughness_beside(simulated, effects, wrong=()):
    """The roughness of bands beside the best of some effects, no more than without, and the objective; what
    lines say of the slit counts as in the fit without effects: it is nothing that bands show."""
    fitter, base = settled(simulated, (), wrong)
    fits = [base, *(fitter.best(base, effect) for effect in effects.values())]
    alone = min(fits, key=fitter.by_light)
    unseen = fitter.of_slit(()) - fitter.of_slit(alone.settings)
    if fitter.by_light(base) - fitter.by_light(alone) < ALIKE:
        return simulated.roughness, alone.objective + unseen
    sizes = [size for size in ROUGHNESS if size <= simulated.roughness]
    rough, objective = likeliest(simulated, "roughness", sizes, wrong, alone.settings)
    return rough, objective + unseen


def likeliest(simulated, name, sizes, wrong=(), settings=()):
    """The size of an error by which the measured light is most probable, and the objective there, systems
    that are `wrong` of any strength; the error is left as it was."""
    before, found = getattr(simulated, name), {}
    for size in sizes:
        setattr(simulated, name, size)
        found[size] = settled(simulated, settings, wrong)[1].objective
    setattr(simulated, name, before)
    best = min(found, key=found.get)
    return best, found[best]


def least_likely(simulated, settings, wrong, kept=()):
    """The best of the fits in which one more radiating system may have any strength, with its fitter."""
    return min(_freed(simulated, settings, wrong, kept), key=lambda one: one[1].objective)


def spectroscopy(simulated, kept=()):
    """The objective of the best fit without effects in which up to `MOST_FREE` systems or groups of lines may
    have any strength, each the best beside those before it; those `kept` have what is stated."""
    wrong, best = (), np.inf
    for _ in range(MOST_FREE):
        fits = _freed(simulated, (), wrong, kept, groups=True)
        fitter, fit = min(fits, key=lambda one: one[1].objective)
        wrong, best = fitter.wrong, min(best, fit.objective)
    return best


def without_wrong(simulated, fitter, fit):
    """The fitter and fit in which systems whose strength is beyond what is stated may have any."""
    while len(fitter.wrong) < MOST_WRONG:
        tried = least_likely(simulated, fit.settings, fitter.wrong)
        if not fit.objective - tried[1].objective > WRONG:
            break
        fitter, fit = tried
    return fitter, fit


def _freed(simulated, settings, wrong, kept=(), groups=False):
    """Fitters and fits in which one more radiating system, or with `groups` one of the brightest groups of
    lines, may have any strength; those `kept` have what is stated."""
    names = list(dict.fromkeys(simulated.systems))
    if groups:
        order = np.argsort(-simulated.group.sum(axis=1))[:MOST_GROUPS]
        names += [simulated.model.library.group_name[place] for place in order]
    names = [one for one in dict.fromkeys(names) if one not in (*wrong, *kept)]
    return [settled(simulated, settings, (*wrong, one)) for one in names]
