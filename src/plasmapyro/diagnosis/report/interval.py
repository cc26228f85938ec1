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

    Source: JCGM 101:2008 (GUM Supplement 1), 6.4.2 and 7.7: propagated distributions, not their variances.

    Parameters
    ----------
    sigma, bound : arrays of one shape, the unit of the number
        Standard deviation of the normal error, half width a of the rectangular one; either may be 0.
    level : float
        Probability p inside.

    Returns
    -------
    ndarray, the unit of the number
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


def estimated_beside_bounded(variance, covariance, prior):
    r"""Half width of the 95 % interval of a number fitted beside a bounded one, as if that were normal.

    Of a bounded error u, uniform with the standard deviation :math:`\sigma_u` before the data, the posterior
    mean leaves :math:`\mathrm{cov}(T, u)\,u/\sigma_u^2` in T, bounded by :math:`a = \sqrt 3\,
    |\mathrm{cov}(T, u)|/\sigma_u`; the other errors are normal with the rest of the variance.

    Source: linear Gaussian estimation, e.g. C. E. Rasmussen and C. K. I. Williams, Gaussian Processes (2006),
    eq. A.6, for the true instead of the assumed law of u.

    Parameters
    ----------
    variance, covariance : arrays of one shape, [T^2], [T u]
        Posterior variance of T, and its covariance with u, both with a normal prior of u.
    prior : float
        Standard deviation of u before the data.

    Returns
    -------
    ndarray, the unit of T
    """
    share = np.abs(covariance) / prior
    return half_width(np.sqrt(np.maximum(variance - share**2, 0.0)), np.sqrt(3.0) * share)


def _integral(x):
    """Integral of the normal distribution function from -inf to x."""
    return x * ndtr(x) + np.exp(-0.5 * x**2) / np.sqrt(2 * np.pi)
