"""What if a pyrometer alone does not see the light, or the ratio, that calibration and emittance tell?"""

from dataclasses import replace

import numpy as np

from plasmapyro.estimate.smoother import Fit, Spread, again, cost, spread_of
from plasmapyro.record.emittance import RATIO_CHANCE, RATIO_WIDTH
from plasmapyro.record.emittance import THROUGHPUT_CHANCE as CHANCE
from plasmapyro.record.emittance import THROUGHPUT_WIDTH as WIDTH

NAME = "band_level"  # the constant: logarithm of the light that the bands see over what is stated
GAINS, SHIFTS = "gain_error", "band_shift"
RATIO_SHIFT = 2e-9  # [m] a slope of the emittance tilts the response as well, and so acts as a shift of it
DRIFT = 0.02  # [1] ASSUME standard deviation of the level at the end of the record
STEP, STEPS = 0.15, 12  # [1] between the levels that are tried, and how many to each side
MOST_ODDS = 50.0  # [1] logarithm of them
HOPELESS = 16.0  # logarithm of a probability over that of the best level below which none follows


def in_doubt(chain, observations, fixed, found, prior=CHANCE):
    r"""The fit, its uncertainty and its priors, with a throughput, or a ratio, that is as stated, or not.

    .. math:: p(z) = (1 - c)\,\delta(z) + c\,N(z; 0, s^2), \qquad
              w_k \propto p(z_k)\,e^{-E(z_k)}

    with the marginal density exp(-E) of the data for a level z (`smoother.cost`). A ratio that is not as
    stated frees the gains of the bands, at z = 0: level and ratio are two numbers, and which of them is
    wrong a pyrometer alone cannot tell. Path and constants are means over what is tried, and their
    covariances those of the mixture.

    Parameters
    ----------
    fixed : Constants, one of them `NAME`, all but fixed at 0
    found : Fit, with throughput and ratio as stated
    prior : float [1], c, chance that the throughput is not

    Returns
    -------
    found : Fit
    spread : Spread
        `across` is that within what is tried; that of the throughput holds all that the mixture adds.
    fixed : Constants, with the prior of a throughput that is not as stated
    facts : dict
        `throughput_chance` [1] that it is not as stated, given the data; `throughput` [1] then, and
        `throughput_uncertainty` of its logarithm; `ratio_chance` [1] that the ratio is not.

    Notes
    -----
    Not in the paper: quadrature over one constant whose prior is no normal law.
    """
    place, ramps = fixed.where(NAME)[0], fixed.where("band_drift")
    if ramps.size:  # what drifts bends level against ratio as a throughput does
        drifting = fixed.deviation.copy()
        drifting[ramps] = DRIFT / np.sqrt(ramps.size)
        drifting = replace(fixed, deviation=drifting)
        freed = again(chain, observations, drifting, found)
        if freed.converged:
            fixed, found = drifting, freed
    tried, costs, levels = [found], [cost(chain, observations, fixed, found)], [0.0]
    for sign in (1, -1):
        now = found
        for step in range(1, STEPS + 1):
            level = sign * step * STEP
            now = _at(chain, observations, fixed, now, place, level)
            price = cost(chain, observations, _held(fixed, place, level), now) + 0.5 * (level / WIDTH) ** 2
            if not now.converged or price > min(costs) + HOPELESS:
                break
            tried.append(now)
            costs.append(price)
            levels.append(level)
    weight = np.exp(min(costs) - np.array(costs)) * prior * STEP / (WIDTH * np.sqrt(2 * np.pi))
    stated = np.exp(min(costs) - costs[0]) * (1 - prior) * (1 - RATIO_CHANCE)
    middle = np.average(levels, weights=weight)
    uncertain = float(np.sqrt(np.average((levels - middle) ** 2, weights=weight)))
    off = weight.sum()
    weight[0] += stated
    priors = [_held(fixed, place, level) for level in levels]
    freed, other, price = _of_any_ratio(chain, observations, fixed, found)
    if other.converged:  # odds within what can be counted
        ratio = np.exp(np.clip(min(costs) - price, -MOST_ODDS, MOST_ODDS)) * (1 - prior) * RATIO_CHANCE
        tried, priors, weight = [*tried, other], [*priors, freed], np.append(weight, ratio)
    weight /= (whole := weight.sum())
    facts = {
        "throughput_chance": float(off / whole),
        "throughput": float(np.exp(middle)),
        "throughput_uncertainty": uncertain,
        "ratio_chance": float(weight[len(levels) :].sum()),
    }
    spreads = [spread_of(chain, observations, one, at) for one, at in zip(priors, tried, strict=True)]

    def mean(rows):
        return sum(own * row for own, row in zip(weight, rows, strict=True))

    path, values = mean([one.path for one in tried]), mean([one.values for one in tried])
    off = [(one.path - path, one.values - values) for one in tried]
    across = mean([one.across for one in spreads])
    own = np.sqrt(mean([moved[:, 0] ** 2 for moved, _ in off]))
    across[:, place] = WIDTH * np.copysign(own, mean([moved[:, 0] * by[place] for moved, by in off]))
    deviation = fixed.deviation.copy()
    deviation[place] = WIDTH
    return (
        Fit(path, values, found.dynamics, tried[-1].steps, found.converged),
        Spread(
            mean(
                [
                    one.path + moved[:, :, None] * moved[:, None, :]
                    for one, (moved, _) in zip(spreads, off, strict=True)
                ]
            ),
            mean([one.constants + np.outer(by, by) for one, (_, by) in zip(spreads, off, strict=True)]),
            across,
            mean([one.alone for one in spreads]),
            mean(
                [
                    one.last + np.outer(by, by)
                    for one, by in zip(spreads, [np.append(moved[-1], by) for moved, by in off], strict=True)
                ]
            ),
        ),
        replace(fixed, deviation=deviation),
        facts,
    )


def _held(fixed, place, level):
    """Constants with another level, all but fixed as well."""
    mean = fixed.mean.copy()
    mean[place] = level
    return replace(fixed, mean=mean)


def _of_any_ratio(chain, observations, fixed, near):
    """Priors with the gains of the bands freed, the fit, and minus the logarithm of its marginal density."""
    deviation = fixed.deviation.copy()
    for name, width in ((GAINS, RATIO_WIDTH / np.sqrt(2)), (SHIFTS, RATIO_SHIFT)):
        places = fixed.where(name)
        deviation[places] = np.hypot(deviation[places], width)
    freed = replace(fixed, deviation=deviation)
    found = again(chain, observations, freed, near)
    price = cost(chain, observations, freed, found) + np.log(deviation / fixed.deviation).sum()
    return freed, found, price


def _at(chain, observations, fixed, near, place, level):
    """The fit at another level, from one near to it."""
    values = near.values.copy()
    values[place] = level
    return again(chain, observations, _held(fixed, place, level), replace(near, values=values))
