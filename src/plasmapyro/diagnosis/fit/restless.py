"""What is larger or smaller than was assumed, by the data: how a gas and gains wander, how rough the series
of a furnace are, how well darks are known."""

import numpy as np
from scipy.linalg import cho_solve
from scipy.special import chdtr, gammaincinv

from plasmapyro.diagnosis.fit.normal import places_of_patterns
from plasmapyro.diagnosis.fit.persistent import COURSE_KNOTS

KEPT = 0.7  # [1], of the second differences, the least ones: an event is no wandering
LEAST_RATIO = 1.3  # [1] of a variance beyond which it is raised
MOST = 0.03  # [1] standard deviation beyond which a gas does not wander but changes
OF_SERIES = ("smooth_stray", "wander_smooth", "smooth_series")  # errors that each series draws anew
LEAST_TOLD, LARGEST = 3.0, 2.0  # numbers that the data tell, at least; factor of a step, at most
COURSE = "wander_course"
OF_GAINS = ("wander_pyrometer", "wander_ratio", "wander_spectrometer", COURSE)
LEAST_WANDER = 0.7  # [1] of what is assumed: seconds tell little of what drifts over minutes
LEAST_OF_COURSE = 0.2  # [1] of that of a course over wavelength: its knots lie as far apart as it drifts
ASSUMED = 4.0  # second differences that what is assumed counts as
SECOND = np.sqrt(6.0)  # [1] standard deviation of a second difference of independent numbers, over theirs
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
    sigma = model.own[places[0]].sigma
    square, spread = _bends(model, solution, rows, places, sigma)
    ratio = square + spread.mean()
    found = min(float(sigma * np.sqrt(ratio)), max(MOST, sigma))
    return found if found > sigma * np.sqrt(LEAST_RATIO) else None


def _bends(model, solution, rows, places, sigma):
    """Second differences `rows` (k, K) of a history by parameters at some places, see `_least`."""
    own = model.size + places
    scaled = rows / (sigma * np.sqrt(np.sum(rows**2, axis=1, keepdims=True)))
    return _least(scaled, solution.state.values[places], solution.covariance[np.ix_(own, own)])


def _least(rows, values, covariance):
    """Differences `rows` (k, K) of some values (K,), each over its standard deviation before the data: mean
    square [1] of the least ones, over what it is of a normal law, and variances (k,) [1] after the fit."""
    square = np.sort((rows @ values) ** 2)
    spread = np.einsum("ij,jk,ik->i", rows, covariance, rows)
    return square[: int(np.ceil(KEPT * square.size))].mean() / NORMAL, spread


def _smaller(square, spread):
    """Factor of a standard deviation by what `_least` gives, see `steadier`."""
    told = ASSUMED + np.sum(1 - spread)
    return float(np.sqrt((ASSUMED + spread.size * square) / told))


def rougher(model, solution):
    r"""Factors {id: f} of standard deviations of errors of series that are larger than assumed.

    .. math:: f^2 = \sum_i v_i^2 / \gamma, \quad \gamma = \sum_i (1 - \mathrm{var}\,v_i)

    with the values v after the fit and their variances, both over the prior's, so that :math:`\gamma` is the
    number of them that the data tell. Empty for one series, which does not tell a fault from what it draws.

    Notes
    -----
    Source: D. J. C. MacKay, Neural Computation 4 (1992) 415, eq. 4.9.
    """
    identities = np.array([one.id for one in model.parameters])
    if OF_SERIES[-1] not in identities:
        return {}
    sigma = np.array([one.sigma for one in model.parameters])
    value = solution.state.values / sigma  # they count from 0
    told = 1 - np.diag(solution.covariance)[model.size :][: sigma.size] / sigma**2
    factors = {}
    for identity in OF_SERIES:
        own = identities == identity
        square = np.sum(value[own] ** 2) / max(told[own].sum(), LEAST_TOLD)
        if square > LEAST_RATIO:
            factors[identity] = min(float(np.sqrt(square)), LARGEST)
    return factors


def steadier(model, solution):
    r"""Factors {id: f} of standard deviations of gains that wander less than is assumed.

    .. math:: f^2 = \frac{n_0 + \sum_i d_i^2/\sigma_i^2}{n_0 + \sum_i (1 - \mathrm{var}\,d_i/\sigma_i^2)}

    with the second differences d of neighbouring knots after the fit, taken as independent, and their
    variances, over those before the data, and `ASSUMED` for :math:`n_0`; what drifts or steps in a few knots
    is no wandering, so only the least ones are asked, as in `wandering`. At least `LEAST_WANDER`.

    Notes
    -----
    Source: D. J. C. MacKay, Neural Computation 4 (1992) 415, eq. 4.9, with an inverse gamma law before.
    """
    factors = {}
    for errors, places in zip(model.persistent, model.places, strict=True):
        identities = np.array([one.id for one in errors.parameters])
        for identity in OF_GAINS:
            own = np.flatnonzero(identities == identity)
            if not own.size:
                continue
            rows = np.diff(errors.time[:, own], n=2, axis=0)
            if identity == COURSE:
                rows = _of_course(errors, own)
            at = np.arange(places.start, places.stop)[own]
            sigma = errors.parameters[own[0]].sigma
            least = LEAST_OF_COURSE if identity == COURSE else LEAST_WANDER
            factor = max(_smaller(*_bends(model, solution, rows, at, sigma)), least)
            if factor < 1 / np.sqrt(LEAST_RATIO):
                factors[identity] = factor
    return factors


def _of_course(errors, own):
    """Second differences (k, K) of each shape of a course at its own knots, between which it is straight, by
    its parameters at some places among the persistent errors."""
    knots, count = np.linspace(*errors.knots[[0, -1]], COURSE_KNOTS), own.size // COURSE_KNOTS
    root = np.array([np.interp(knots, errors.knots, row) for row in errors.time[:, own[:COURSE_KNOTS]].T]).T
    return np.kron(np.eye(count), np.diff(root, n=2, axis=0))


def darker(model, solution):
    r"""Factors (instruments,) of the uncertainty of darks of channels, known better than is assumed.

    As `steadier`, with second differences d of the errors of neighbouring channels, each over its standard
    deviation: the noise of a dark is of each channel its own, what all have in common is something else.
    """
    factors = []
    for which, instrument in enumerate(model.instruments):
        if not instrument.dark.any():
            factors.append(1.0)
            continue
        own = places_of_patterns(model.instruments, len(solution.score))[which]["dark"]
        rows = np.diff(np.eye(instrument.channels) / instrument.dark, n=2, axis=0) / SECOND
        unit = np.zeros((len(solution.score), instrument.channels))
        unit[own] = np.eye(instrument.channels)
        covariance = cho_solve(solution.factor, unit)[own]
        factors.append(min(_smaller(*_least(rows, solution.state.dark[which], covariance)), 1.0))
    return factors
