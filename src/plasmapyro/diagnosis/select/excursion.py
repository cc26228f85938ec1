"""A temperature that leaves its course for a moment and comes back to it.

A path may heat as fast as its light shows, so it follows a flake that crosses the view, by 115 K in a test.
From a flux that jumps for seconds its shape does not tell it; either is said, and widens the interval there.
"""

import numpy as np

from plasmapyro.diagnosis.fit.model import INITIAL_TEMPERATURE, History

LENGTHS = (4.0, 6.0, 9.0, 14.0, 20.0, 30.0, 45.0)  # [s]
STANDS, LEAST = 8.0, 3.0  # standard deviations of chi-squared, and [K] at its most
FREE = 1e3  # [K]: of the level and the slope of a path
EXCURSION = "left_both"
NAME = "something that crosses the view, or a flux that jumps for a moment"


def excursion(model, solution):
    r"""Change (K,) [K] of the knots by what lies between the course before and after; None without any.

    With the fitted knots x, their covariance C and that of the usual prior of a heating surface P,

    .. math:: g = (P + C)^{-1} (x - T_0), \quad d_I = [(P + C)^{-1}]_{II}^{-1} g_I, \quad
              \chi^2_I = g_I^T d_I

    are the distance of some knots I from what all others foretell, and its size: the best-parted of the
    moments while the plasma burns, with as much time on both sides, if it holds most of what is unusual and
    turns back: what only heats fast, as bins cannot follow, is no excursion.

    Notes
    -----
    Source: what all others foretell of some numbers of a normal law, S. Sundararajan and S. S. Keerthi,
    Neural Comput. 13 (2001) 1103, for blocks of them.
    """
    history, size = model.history, model.size
    if not (model.plasma and history.cold):
        return None
    rows = History(history.knots, history.off).roughness()
    prior = np.linalg.inv(rows.T @ rows + np.eye(size) / FREE**2)
    inverse = np.linalg.inv(prior + solution.covariance[:size, :size])
    kelvin = solution.state.knots
    away = kelvin - INITIAL_TEMPERATURE
    score = inverse @ away
    most, found = 0.0, None
    for inside in _moments(history):
        own = np.linalg.solve(inverse[np.ix_(inside, inside)], score[inside])
        square, count = score[inside] @ own, inside.size
        apart = (square - count) / np.sqrt(2 * count)
        stands = apart > max(most, STANDS) and 2 * square > away @ score
        if stands and _turns_back(kelvin, inside) > LEAST:
            most, found = apart, np.zeros(size)
            found[inside] = own
    return found


def _turns_back(kelvin, inside):
    """By how much [K] some knots are above both that enclose them, or below."""
    ends = kelvin[[inside[0] - 1, inside[-1] + 1]]
    return max(kelvin[inside].max() - ends.max(), ends.min() - kelvin[inside].min())


def name(model, change):
    """Name of what changes the knots (K,) [K], with its most and when."""
    place = np.abs(change).argmax()
    return f"{NAME} ({change[place]:+.0f} K {model.history.knots[place]:.0f} s after the injection)"


def _moments(history):
    """Places (m,) of the knots of each moment."""
    knots = history.knots
    for length in LENGTHS:
        for middle in knots[(knots > length) & (knots < history.off - length)]:
            yield np.flatnonzero(np.abs(knots - middle) <= length / 2)
