"""Names for a measured pair of heat flux and Pitot pressure, with probability and size."""

from itertools import combinations

import numpy as np

from plasmapyro.diagnosis.select.probability import PRIOR_NONE, PRIOR_UNKNOWN, normalised, prior_share
from plasmapyro.facility.prediction import CARRIED, NOSES, PAIR_PRESSURE, RATES, Explanations, jets, weights

# Without a cause: a laminar jet, a good catalyst, momentum as computed, and the largest nose that may be.
ASSUMED = {"mixing": (0.0, 0.0), "recombination": (0.1, 1.0), "momentum": (1.0, 1.0)}
MOMENTUM = (0.76, 1.05)  # times the pressure: 10 degrees of swirl; coil and Lorentz force give 4 % at most
MOST_TOGETHER = 2
UNKNOWN_RANGE = 100.0  # ratio of the ends between which something unknown would put the heat flux
ENDS = (0.025, 0.975)
WORTH_TELLING = 0.02  # probability
TOLD = {  # of a cause: factor, form and unit in which its size is told
    "temperature": (1.0, ".0f", " K"),
    "power": (1e-3, ".0f", " kW in the gas"),
    "mixing": (1.0, ".3f", " torch radii"),
    "recombination": (1.0, ".2g", ""),
    "nose": (1e3, ".0f", " mm"),
    "momentum": (1.0, ".2f", " times the pressure"),
}
DECIDES = {  # of each cause: what tells whether it is one
    "mixing": "the temperature ahead of the probe",
    "recombination": "a second calorimeter, of another material",
    "nose": "a Pitot probe with another nose",
    "momentum": "the speed ahead of the probe",
}


def names_of(single):
    """Causes alone and two together."""
    sizes = range(1, MOST_TOGETHER + 1)
    return ["+".join(some) for size in sizes for some in combinations(single, size)]


NAMES = names_of(DECIDES)


def causes(
    heat_flux, pitot, *, admissible, flux_uncertainty, pressure_uncertainty, pressure=PAIR_PRESSURE,
    gas="air", nose=(NOSES[0], NOSES[-1]), draws=2000, seed=1,
):  # fmt: skip
    r"""What a pair says of recombination, Pitot nose, momentum and mixing, alone and together.

    .. math:: p(c) \propto \pi(c)\,\Big\langle N\big(\ln q;\,\ln q_c(p/m, \theta), \sigma\big)
              \Big\rangle_\theta

    over draws of what cause c leaves free (m: momentum) and of the errors of the pair; priors as for the
    effects of a diagnosis. The power is free: the pair says where on the curve of its jets it lies.

    Parameters
    ----------
    heat_flux : float [W m-2]
        On a hemisphere of 25 mm.
    pitot : float [Pa]
        Above the chamber pressure.
    admissible : pair of float [1]
        Recombination that the literature gives for the calorimeter.
    flux_uncertainty, pressure_uncertainty : float [1]
        Relative standard uncertainties.
    pressure : float [Pa]
        Of the chamber.
    gas : str
        'air' or 'N2'.
    nose : pair of float [m]
        Least and largest radius of the Pitot nose: a cause unless both are one.
    draws, seed : int

    Returns
    -------
    dict name -> (probability, {"temperature" [K], "power" [W] and each free quantity: 2.5 and 97.5 % ends})
        Of 'none', every cause and 'unknown', the likeliest first.
    """
    table = jets(gas)
    free = {"mixing": table.mixing[[0, -1]], "recombination": admissible, "momentum": MOMENTUM}
    free |= {"nose": nose} if nose[0] < nose[1] else {}
    names = names_of([one for one in DECIDES if one in free])
    log = {"unknown": np.log(PRIOR_UNKNOWN / np.log(UNKNOWN_RANGE))}
    sizes = {"unknown": {}}
    for name in ("none", *names):
        random = np.random.default_rng(seed)
        own = {one: free[one] for one in name.split("+") if one in free}
        ends = ASSUMED | {"nose": (nose[1], nose[1])} | own
        taken = {"mixing": random.uniform(*ends["mixing"], draws)}
        for one in ("recombination", "nose", "momentum"):
            taken[one] = np.exp(random.uniform(*np.log(ends[one]), draws))
        rates, warmth = random.integers(len(RATES), size=draws), random.uniform(size=draws)
        wall = Explanations(taken["recombination"], rates, taken["nose"], warmth)
        read = pitot * np.exp(pressure_uncertainty * random.standard_normal(draws)) / taken["momentum"]
        values, inside = (one[:, :, 0] for one in table.at(read[:, None], pressure, wall))
        share = weights(taken["mixing"], table.mixing)
        flux, kelvin, power = np.einsum("dm,dmq->qd", share, values[..., [0, 1, 4]])
        sigma = np.hypot(flux_uncertainty, CARRIED * (1 - np.einsum("dm,dm->d", share, inside)))
        likelihood = np.exp(-0.5 * ((np.log(heat_flux) - flux) / sigma) ** 2) / (sigma * np.sqrt(2 * np.pi))
        prior = np.log(PRIOR_NONE) if name == "none" else prior_share(len(names))
        log[name] = prior + np.log(np.mean(likelihood) + np.finfo(float).tiny)
        found = {"temperature": np.exp(kelvin), "power": np.exp(power)} | {one: taken[one] for one in own}
        sizes[name] = {one: _ends(value, likelihood) for one, value in found.items()}
    probability = normalised(log)
    return {name: (probability[name], sizes[name]) for name in sorted(log, key=log.get, reverse=True)}


def sentences(found):
    """What `causes` found: likely names with sizes, what each cause has in all, what decides next."""
    lines = []
    for name, (probability, sizes) in found.items():
        if probability >= WORTH_TELLING:
            told = ", ".join(_size(one, ends) for one, ends in sizes.items())
            lines.append(f"{name} {probability:.2f}" + (f": {told}" if told else ""))
    names = [one for one in DECIDES if one in found]
    whole = {one: sum(p for name, (p, _) in found.items() if one in name.split("+")) for one in names}
    lines.append("alone or with another: " + ", ".join(f"{one} {p:.2f}" for one, p in whole.items()))
    if found["unknown"][0] > 0.5:
        return [*lines, "nothing known reaches the pair: look at both readings and their units first"]
    doubted = min(names, key=lambda one: abs(whole[one] - 0.5))
    return [*lines, f"what decides next: {DECIDES[doubted]} (is it {doubted}?)"]


def _size(name, ends):
    factor, form, unit = TOLD[name]
    low, high = (f"{factor * one:{form}}" for one in ends)
    what = "" if name in ("temperature", "power") else f"{name} "
    return what + (low if low == high else f"{low} to {high}") + unit


def _ends(values, weight):
    order = np.argsort(values)
    mass = np.cumsum(weight[order])
    return tuple(np.interp(np.array(ENDS) * mass[-1], mass, values[order]))
