"""A gas that wanders more than was assumed: how much, by the data."""

import numpy as np
from scipy.special import chdtr, gammaincinv

KEPT = 0.7  # [1], of the second differences, the least ones: an event is no wandering
LEAST_RATIO = 1.3  # [1] of a variance beyond which it is raised
MOST = 0.03  # [1] standard deviation beyond which a gas does not wander but changes
NORMAL = float(chdtr(3, 2 * gammaincinv(0.5, KEPT))) / KEPT  # [1] mean of the least ones, of a normal law


def wandering(model, solution):
    r"""Standard deviation [1] of a brightness of the gas that wanders more than its prior allows, else None.

    .. math:: r = \frac{\langle d^2 \rangle + \langle \mathrm{var}\,d \rangle}{\sigma_d^2}

    with the second differences d of neighbouring knots after the fit, their posterior variance and their
    variance before the data; a drift has none, and the largest ones, which may be events, are left out, the
    mean of the rest being over what it is of a normal law. The prior's times the root of r, at most `MOST`.

    Notes
    -----
    Source: the maximisation step for a variance, A. P. Dempster et al., J. R. Stat. Soc. B 39 (1977) 1.
    """
    if not model.wandering:
        return None
    places = np.array(model.wandering)
    rows = np.diff(np.array([model.own[place].history[1] for place in places]).T, n=2, axis=0)
    own, sigma = model.size + places, model.own[places[0]].sigma
    prior = sigma**2 * np.sum(rows**2, axis=1)
    value = np.sort((rows @ solution.state.values[places]) ** 2 / prior)
    spread = np.einsum("ij,jk,ik->i", rows, solution.covariance[np.ix_(own, own)], rows) / prior
    ratio = value[: int(np.ceil(KEPT * value.size))].mean() / NORMAL + spread.mean()
    found = min(float(sigma * np.sqrt(ratio)), max(MOST, sigma))
    return found if found > sigma * np.sqrt(LEAST_RATIO) else None
