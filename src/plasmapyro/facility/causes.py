"""Names for a measured pair of heat flux and Pitot pressure, with probability and size."""

import numpy as np

from plasmapyro.diagnosis.select.probability import PRIOR_NONE, PRIOR_UNKNOWN, normalised, prior_share
from plasmapyro.facility.prediction import CARRIED, NOSES, PAIR_PRESSURE, RATES, Explanations, jets, weights

ASSUMED = {"recombination": (0.1, 1.0), "nose": (NOSES[-1], NOSES[-1]), "mixing": (0.0, 0.0)}
SINGLE = ("mixing", "recombination", "nose")
NAMES = ["+".join(name for k, name in enumerate(SINGLE) if bits >> k & 1) for bits in range(1, 8)]
UNKNOWN_RANGE = 100.0  # ratio of the ends between which something unknown would put the heat flux
ENDS = (0.025, 0.975)


def causes(heat_flux, pitot, *, admissible, flux_uncertainty, pressure_uncertainty, draws=2000, seed=1):
    r"""What a pair says of recombination, Pitot nose and mixing, alone and together.

    .. math:: p(c) \propto \pi(c)\,\Big\langle N\big(\ln q;\,\ln q_c(p, \theta), \sigma\big)\Big\rangle_\theta

    over draws of what cause c leaves free and of the errors of the pair. Without a cause the wall is a good
    catalyst (0.1 to 1), the nose has 25 mm and the jet is laminar; priors as for the effects of a diagnosis.

    Parameters
    ----------
    heat_flux : float [W m-2]
    pitot : float [Pa]
        In air, 50 mbar of chamber pressure.
    admissible : pair of float [1]
        Recombination that the literature gives for the calorimeter.
    flux_uncertainty, pressure_uncertainty : float [1]
        Relative standard uncertainties.
    draws, seed : int

    Returns
    -------
    dict name -> (probability, {"temperature" [K] and each free quantity: 2.5 and 97.5 % ends})
        Of 'none', `NAMES` and 'unknown', the likeliest first.
    """
    free = {"mixing": jets().mixing[[0, -1]], "recombination": admissible, "nose": NOSES[:: len(NOSES) - 1]}
    log = {"unknown": np.log(PRIOR_UNKNOWN / np.log(UNKNOWN_RANGE))}
    sizes = {"unknown": {}}
    for name in ("none", *NAMES):
        random = np.random.default_rng(seed)
        own = ASSUMED | {one: free[one] for one in name.split("+") if one in free}
        taken = {"mixing": random.uniform(*own["mixing"], draws)}
        for one in ("recombination", "nose"):
            taken[one] = np.exp(random.uniform(*np.log(own[one]), draws))
        rates, warmth = random.integers(len(RATES), size=draws), random.uniform(size=draws)
        wall = Explanations(taken["recombination"], rates, taken["nose"], warmth)
        read = pitot * np.exp(pressure_uncertainty * random.standard_normal(draws))
        values, inside = (one[:, :, 0] for one in jets().at(read[:, None], PAIR_PRESSURE, wall))
        share = weights(taken["mixing"], jets().mixing)
        flux, kelvin = np.einsum("dm,dmq->qd", share, values[..., :2])
        sigma = np.hypot(flux_uncertainty, CARRIED * (1 - np.einsum("dm,dm->d", share, inside)))
        likelihood = np.exp(-0.5 * ((np.log(heat_flux) - flux) / sigma) ** 2) / (sigma * np.sqrt(2 * np.pi))
        prior = np.log(PRIOR_NONE) if name == "none" else prior_share(len(NAMES))
        log[name] = prior + np.log(np.mean(likelihood) + np.finfo(float).tiny)
        found = {"temperature": np.exp(kelvin)} | {one: taken[one] for one in name.split("+") if one in free}
        sizes[name] = {one: _ends(value, likelihood) for one, value in found.items()}
    probability = normalised(log)
    return {name: (probability[name], sizes[name]) for name in sorted(log, key=log.get, reverse=True)}


def _ends(values, weight):
    order = np.argsort(values)
    mass = np.cumsum(weight[order])
    return tuple(np.interp(np.array(ENDS) * mass[-1], mass, values[order]))
