"""Linear algebra of a chain of states with a few constants: block tridiagonal with a border."""

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cho_solve_banded, cholesky_banded

PIECE = 64  # rows of a product of tall matrices: enough to be fast, too few for threads


def lower_band(diagonal, below):
    """Lower band storage of a symmetric block tridiagonal matrix.

    Parameters
    ----------
    diagonal : (n, d, d) array
    below : (n - 1, d, d) array
        Block of row k + 1 and column k.

    Returns
    -------
    (2 d, n d) ndarray, for `scipy.linalg.cholesky_banded(..., lower=True)`
    """
    count, size, _ = diagonal.shape
    band = np.zeros((2 * size, count, size))
    for row in range(size):
        for column in range(size):
            if row >= column:
                band[row - column, :, column] = diagonal[:, row, column]
            band[size + row - column, :-1, column] = below[:, row, column]
    return band.reshape(2 * size, count * size)


class Factor:
    """Cholesky factor of a block tridiagonal matrix."""

    def __init__(self, diagonal, below):
        self._factor = cholesky_banded(lower_band(diagonal, below), lower=True, check_finite=False)

    def solve(self, right):
        """Solution of the system for right sides (n d, ...)."""
        return cho_solve_banded((self._factor, True), right, check_finite=False)

    def log_determinant(self):
        """Logarithm of the determinant."""
        return 2 * np.log(self._factor[0]).sum()


def inner(left, right):
    """left^T right of two tall matrices (n, p) and (n, q), in pieces that no linear algebra gives to threads.

    These wait for each other where other work keeps the processors busy: an estimate that took 7 s took 53 s.
    """
    whole = len(left) // PIECE * PIECE
    first, second = (rows[:whole].reshape(-1, PIECE, rows.shape[1]) for rows in (left, right))
    return np.matmul(np.swapaxes(first, 1, 2), second).sum(axis=0) + left[whole:].T @ right[whole:]


def solve_bordered(factor, border, corner, right, right_constant):
    r"""Solve :math:`\begin{pmatrix}A & B\\ B^T & C\end{pmatrix}` for one right side.

    Parameters
    ----------
    factor : Factor of A
    border : (n d, p) array
    corner : (p, p) array
    right : (n d,) array
    right_constant : (p,) array

    Returns
    -------
    states : (n d,) ndarray
    constants : (p,) ndarray
    effect : (n d, p) ndarray
        A^-1 B: how the states follow the constants, with the opposite sign.
    covariance : (p, p) ndarray
        Of the constants, the states marginalised: the inverse of C - B^T A^-1 B.
    """
    effect = factor.solve(border)
    own = factor.solve(right)
    complement = cho_factor(corner - inner(border, effect), lower=True)
    constants = cho_solve(complement, right_constant - inner(border, own[:, None])[:, 0])
    return own - effect @ constants, constants, effect, cho_solve(complement, np.eye(len(corner)))
