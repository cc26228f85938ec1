"""Wigner's symbols by Racah's formulas; quantum numbers may be halves and arrays."""

from functools import cache

import numpy as np
from scipy.special import gammaln


def _log_factorial(number):
    return gammaln(np.asarray(number) + 1.0)


@cache
def six_j(a, b, c, d, e, f):
    """6j symbol {a b c; d e f}; zero outside the triangles."""
    triads = ((a, b, c), (a, e, f), (d, b, f), (d, e, c))
    if not all(abs(x - y) <= z <= x + y for x, y, z in triads):
        return 0.0
    log = sum(
        0.5 * (_log_factorial([x + y - z, x - y + z, -x + y + z]).sum() - _log_factorial(x + y + z + 1))
        for x, y, z in triads
    )
    total, fours = 0.0, (a + b + d + e, b + c + e + f, a + c + d + f)
    for t in range(int(max(map(sum, triads))), int(min(fours)) + 1):
        parts = [t - sum(one) for one in triads] + [one - t for one in fours]
        total += (-1) ** t * np.exp(log + _log_factorial(t + 1) - _log_factorial(parts).sum())
    return float(total)


def three_j_square_root(j, omega, lower_j, q):
    """(-1)-free amplitude of the 3j symbol (J 1 J''; -Omega q Omega''), Omega'' = Omega - q, for arrays J.

    The closed forms of Edmonds (1957, table 2) for one unit of angular momentum, with the relative signs
    that a sum over Omega needs.
    """
    low = omega - q
    j, lower_j = np.broadcast_arrays(np.asarray(j, dtype=float), np.asarray(lower_j, dtype=float))
    result = np.zeros(j.shape)
    for step in (-1, 0, 1):
        here = (lower_j == j + step) & (np.abs(omega) <= j) & (np.abs(low) <= lower_j) & (lower_j >= 0)
        here &= ~((step == 0) & (j == 0))
        result[here] = _unit(j[here], omega, q, step)
    return result


def _unit(j, omega, q, step):
    """<J Omega | C^1_q | J'' Omega-q> up to a factor that depends on J and J'' alone."""
    low_j, low = j + step, omega - q
    # Clebsch-Gordan coefficient <J'' low 1 q | J omega> over sqrt(2J+1), by cases of J - J'' = -step.
    if step == -1:
        square = {
            1: (low_j + low + 1) * (low_j + low + 2),
            0: 2 * (low_j - low + 1) * (low_j + low + 1),
            -1: (low_j - low + 1) * (low_j - low + 2),
        }[q] / ((2 * low_j + 1) * (2 * low_j + 2))
        sign = 1.0
    elif step == 0:
        square = {
            1: (low_j + low + 1) * (low_j - low),
            0: 2 * low**2 * np.ones_like(j),
            -1: (low_j - low + 1) * (low_j + low),
        }[q] / (2 * low_j * (low_j + 1))
        sign = {1: -1.0, 0: np.sign(low), -1: 1.0}[q]
    else:
        square = {
            1: (low_j - low - 1) * (low_j - low),
            0: 2 * (low_j - low) * (low_j + low),
            -1: (low_j + low - 1) * (low_j + low),
        }[q] / (2 * low_j * (2 * low_j + 1))
        sign = {1: 1.0, 0: -1.0, -1: 1.0}[q]
    return sign * np.sqrt(np.maximum(square, 0) / (2 * j + 1))
