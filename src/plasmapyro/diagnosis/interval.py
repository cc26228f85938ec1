"""Intervals of a number that errs by a normal and by a bounded error."""

import numpy as np
from scipy.optimize.elementwise import find_root
from scipy.special import ndtr

LEVEL = 0.95
FARTHEST = 38.0  # standard deviations: nothing is left beyond in double precision
NARROW = 1e-4  # [1], of the other error


def half_width(sigma, bound, level=LEVEL):
    r"""Half width q of the central interval of a normal plus a rectangular error.

    .. math:: P(|u + n| < q) = p, \quad u \in [-a, a] \text{ uniform}, \; n \sim N(0, \sigma)

    With :math:`G(x) = x \Phi(x) + \phi(x)` the left side is :math:`\sigma [G((q+a)/\sigma) -
    G((q-a)/\sigma)] / a - 1`.

    Parameters
    ----------
    sigma, bound : arrays of one shape, the unit of the number
        Standard deviation of the normal error, half width a of the rectangular one; either may be 0.
    level : float
        Probability p inside.

    Returns
    -------
    ndarray, the unit of the number

    Notes
    -----
    Source: JCGM 101:2008 (GUM Supplement 1), 6.4.2 and 7.7: propagated distributions, not their variances.
    """
    sigma, bound = np.broadcast_arrays(np.asarray(sigma, dtype=float), np.asarray(bound, dtype=float))
    scale = np.hypot(sigma, bound)
    safe = np.where(scale > 0, scale, 1.0)
    # At the ends, where one error is all, the law of the other is that of a narrow one.
    s, a = np.maximum(sigma / safe, NARROW), np.maximum(bound / safe, NARROW)

    def miss(q, s, a):
        return s * (_integral((q + a) / s) - _integral((q - a) / s)) / a - 1 - level

    found = find_root(miss, (np.zeros_like(s), a + FARTHEST * s), args=(s, a))
    return found.x * scale


def _integral(x):
    """Integral of the normal distribution function from -inf to x."""
    return x * ndtr(x) + np.exp(-0.5 * x**2) / np.sqrt(2 * np.pi)
