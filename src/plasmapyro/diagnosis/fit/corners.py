"""Bins that end where the rate of a surface changes at once: it begins or ceases to melt, its flux jumps.

Within a bin of seconds the temperature is a smooth curve. A corner in it bends all others, and emittance and
black body with them, since each reads that curve at another temperature.
"""

import numpy as np

BLOCKS = 8  # means of samples on either side: what is shorter than one counts as their scatter
FEWEST = 5  # of them
CLEAR = 6.0  # standard deviations of the change of slope
BEYOND = 3.0  # prior standard deviations of what a second derivative makes of it
LEAST_CORNER = 0.3  # [K] by which a bin that holds it is off
CONTINUOUS = 0.25  # [1] of the change within the reach: by so much the level may jump
FOLLOWED = 1.0  # [K] of the same in the bins beside a corner


def around(edges, time, kelvin, history):
    r"""Edges (m,) [s] that hold the corners of a surface, with bins that grow from there to the usual ones.

    On both sides of a moment c, over the length W of the bin that holds it,

    .. math:: T = a + b\,(t - c) + H(t - c)\,[j + d\,(t - c)]

    is fitted: a corner is a change d far beyond its error and :math:`W T''`, with no step j, which a surface
    cannot have.

    Parameters
    ----------
    edges : (n,) array [s]
    time, kelvin : (s,) arrays [s], [K]
        Of samples that see the surface.
    history : model.History
        Its prior of the second derivative, and the end of the plasma.
    """
    step, found = np.median(np.diff(time)), []
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        reach = max(end - begin, FEWEST * step)
        fits = [(_fit(one, reach, time, kelvin, history), one) for one in np.linspace(begin, end, 9)[:-1]]
        (score, change), place = max(fits)
        if score:
            fine = np.linspace(place - reach / 8, place + reach / 8, 9)
            (score, change), place = max((_fit(one, reach, time, kelvin, history), one) for one in fine)
            found.append((score, place, abs(change), reach))
    taken = []
    for score, place, change, reach in sorted(found, reverse=True):
        if score and all(abs(place - other) > reach for other in taken):
            taken.append(place)
            edges = _with(edges, place, max(min(FOLLOWED / change, reach / 2), step), reach)
    return edges


def _fit(moment, reach, time, kelvin, history):
    """Change of the slope over its error, 0 if it is none, and the change [K/s]."""
    if moment - reach < 0 or moment - reach < history.off < moment + reach:
        return 0.0, 0.0
    inside = np.abs(time - moment) < reach
    block = np.floor((time[inside] - moment) / reach * BLOCKS)
    _, place, count = np.unique(block, return_inverse=True, return_counts=True)
    own, value = (np.bincount(place, one[inside]) / count for one in (time, kelvin))
    away = (own - moment) / reach
    late = away >= 0
    if min(late.sum(), (~late).sum()) < FEWEST:
        return 0.0, 0.0
    columns = np.stack([np.ones(own.size), away, late, late * away], axis=1)
    best, _, _, _ = np.linalg.lstsq(columns, value, rcond=None)
    scatter = np.sum((value - columns @ best) ** 2) / (own.size - 4)
    error = np.sqrt(scatter * np.diag(np.linalg.inv(columns.T @ columns)))
    jump, change = abs(best[2]), abs(best[3])
    usual = BEYOND * float(history.bending(moment)) * reach**2
    corner = change > max(CLEAR * error[3], usual, 8 * LEAST_CORNER)
    corner &= jump < max(3 * error[2], CONTINUOUS * change)
    return (change / error[3] if corner else 0.0), change / reach


def _with(edges, place, least, usual):
    """The edges with one at a place, and bins that double from `least` to the `usual` [s] on either side."""
    sizes = least * 2.0 ** (np.arange(60) // 2)
    sizes = sizes[sizes < usual]
    away = np.concatenate([[0.0], np.cumsum(sizes)])
    kept = edges[np.abs(edges - place) > away[-1] + least / 2]
    return np.unique(np.concatenate([kept, place - away, place + away]))
