"""Search for bands with the smallest total error: a seeded global search, a coarse grid, a Pareto front."""

from itertools import count

import numpy as np

from plasmapyro.progress import step

STRAYED = 10.0  # [1], score of a design without any signal


def optimise(score, bands, wavelength_range, width_range, *, seed, population, generations, start=None):
    """Centres and widths with the smallest score, by differential evolution.

    Parameters
    ----------
    score : callable (centre (D, N), fwhm (D, N)) -> (D,)
    bands : int, N
    wavelength_range, width_range : (low, high) [m]
        Every band lies wholly within the wavelengths.
    seed : int
        Same seed, same design.
    population, generations : int
        Population per unknown, most generations.
    start : (centre (N,), fwhm (N,)) [m], optional
        A design to begin with besides the random ones; the result is never worse.

    Returns
    -------
    centre, fwhm : (N,) [m], bands in the order of their centres
    value : float
    """
    low, high = width_range

    def unfold(unit):
        fwhm = low * (high / low) ** unit[bands:].T
        room = np.diff(wavelength_range)[0] - fwhm
        return wavelength_range[0] + fwhm / 2 + unit[:bands].T * room, fwhm

    def values(unit):
        centre, fwhm = unfold(unit.reshape(2 * bands, -1))
        order = np.argsort(centre, axis=1)
        result = score(np.take_along_axis(centre, order, 1), np.take_along_axis(fwhm, order, 1))
        return np.where(np.isfinite(result), result, STRAYED)

    def fold(centre, fwhm):
        room = np.diff(wavelength_range)[0] - fwhm
        place = (centre - fwhm / 2 - wavelength_range[0]) / room
        return np.clip(np.concatenate([place, np.log(fwhm / low) / np.log(high / low)]), 0.0, 1.0)

    generation = count(1)

    def watch(intermediate_result):
        step(
            f"search of {bands} bands, generation",
            next(generation),
            generations,
            f"score {intermediate_result.fun:.4g}",
        )

    from scipy.optimize import differential_evolution  # 0.3 s, which spectra do not cost

    found = differential_evolution(
        values,
        [(0.0, 1.0)] * (2 * bands),
        seed=seed,
        popsize=population,
        maxiter=generations,
        tol=1e-6,
        polish=False,
        updating="deferred",
        vectorized=True,
        x0=None if start is None else fold(*map(np.asarray, start)),
        callback=watch,
    )
    centre, fwhm = (row[0] for row in unfold(found.x[:, None]))
    order = np.argsort(centre)
    return centre[order], fwhm[order], float(found.fun)


def pairs(centre):
    """All pairs (P, 2) of rows whose first centre is the shorter one."""
    first, second = np.triu_indices(len(centre), 1)
    ordered = np.stack([first, second], axis=1)
    swap = centre[first] > centre[second]
    ordered[swap] = ordered[swap][:, ::-1]
    return ordered[centre[ordered[:, 0]] < centre[ordered[:, 1]]]


def pareto_front(benefit, cost):
    """Mark (D,) the designs to which no other is at least as good in both and better in one; never NaN."""
    benefit, cost = np.asarray(benefit, dtype=float), np.asarray(cost, dtype=float)
    front = np.zeros(benefit.shape, dtype=bool)
    usable = np.flatnonzero(np.isfinite(benefit) & np.isfinite(cost))
    best = np.inf
    for design in usable[np.lexsort((cost[usable], -benefit[usable]))]:
        if cost[design] < best:
            front[design], best = True, cost[design]
    return front
