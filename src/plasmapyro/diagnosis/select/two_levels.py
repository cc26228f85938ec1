"""Whether values come in two kinds: two levels held against one lopsided hump with tails."""

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, gammaln, log_expit, logit

CLEARLY = 8.0  # of a log likelihood ratio: noise, normal, lopsided or of heavy tails, reaches 6 in 750 series
FEWEST = 3  # values of the rarer kind
RARE, FAR = (0.03, 0.1, 0.3), 0.5  # shares that a fit begins with, and where in such a tail its level is
LEAST_SCALE = 0.1  # [1] of the scatter: rounded values are no levels


def two_kinds(value, variance):
    r"""Whether values (n,), each with a variance (n,) of its own, are drawn from two levels.

    .. math:: \ln \frac{\max \prod_i [(1-p) N(x_i; m, s^2+v_i) + p N(x_i; m+a, s^2+v_i)]}
        {\max \prod_i t_\nu(x_i; m, s_\pm^2+v_i)} > `CLEARLY`

    with `FEWEST` values about the rarer level.

    Notes
    -----
    Chance makes a likelihood ratio R of two given laws larger than R with a probability below 1/R, whatever
    they are (J. Ville, Étude critique de la notion de collectif, 1939); fitting them costs some units of the
    logarithm.
    """
    middle = np.median(value)
    scale = 1.4826 * np.median(np.abs(value - middle))
    if not scale > 0:
        return False
    x, variance = (value - middle) / scale, variance / scale**2
    starts = [
        (0.0, sign * max(float(np.quantile(sign * x, 1 - FAR * share)), 1.0), 0.0, logit(share))
        for share in RARE
        for sign in (-1, 1)
    ]
    two, (*_, share) = _best(_of_two, starts, x, variance)
    starts = [(0.0, 0.0, freedom, side) for freedom in (1.0, 4.0) for side in (-1.0, 0.0, 1.0)]
    one, _ = _best(_of_one, starts, x, variance)
    return bool(two - one > CLEARLY and expit(-abs(share)) * x.size > FEWEST)


def _best(law, starts, x, variance):
    """Largest log likelihood of values (n,) under a law, and its numbers."""
    fits = [minimize(lambda q: -law(q, x, variance), start, method="Nelder-Mead") for start in starts]
    best = min(fits, key=lambda fit: fit.fun)
    return -float(best.fun), best.x


def _width(logarithm):
    return np.hypot(LEAST_SCALE, np.exp(logarithm))


def _of_two(numbers, x, variance):
    """Log likelihood of two levels: middle, distance, logarithm of the width, logit of a share."""
    middle, apart, width, share = numbers
    own = variance + _width(width) ** 2
    square = [(x - level) ** 2 / own for level in (middle, middle + apart)]
    parts = log_expit(-share) - square[0] / 2, log_expit(share) - square[1] / 2
    return np.sum(np.logaddexp(*parts) - np.log(2 * np.pi * own) / 2)


def _of_one(numbers, x, variance):
    """Log likelihood of Student's law of two pieces: middle, logarithms of the width, of the degrees of
    freedom and of the ratio of the widths to the right and to the left."""
    middle, width, freedom, lopsided = numbers
    left, right = (variance + _width(width + side) ** 2 for side in (-lopsided / 2, lopsided / 2))
    nu = np.exp(min(freedom, 12.0))
    norm = gammaln((nu + 1) / 2) - gammaln(nu / 2) - np.log(nu * np.pi) / 2
    norm = norm + np.log(2 / (np.sqrt(left) + np.sqrt(right)))
    own = np.where(x < middle, left, right)
    return np.sum(norm - (nu + 1) / 2 * np.log1p((x - middle) ** 2 / own / nu))
