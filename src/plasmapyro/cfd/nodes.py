"""From values in cells to values at nodes."""

import numpy as np
from scipy import sparse

REGULARISATION = 1e-10  # of the normal equations: a stencil in one line keeps a slope along it only
LARGEST_FACTOR = 2.0  # by which a value at a node may exceed those in the cells around it


def to_nodes(points, cells, values):
    r"""Values at the nodes of a grid from values at the centres of its cells.

    At each node the linear function that fits the cells around it and their neighbours best (weights one over
    the square of the distance) is evaluated: exact for linear fields, second order for smooth ones, in the
    interior and on the boundary.

    .. math:: \min_{f, g} \sum_c w_c (f + g \cdot (x_c - x_n) - f_c)^2

    Source: Barth & Jespersen 1989 (AIAA 89-0366), least-squares reconstruction.
    ASSUME: where all cells around are positive, the extrapolation to a boundary stays between half the
    smallest and twice the largest of them.

    Parameters
    ----------
    points : ndarray (N, d)
    cells : list of ndarray of int, each (M_k, corners)
    values : ndarray (cells, quantities)
        In the order of `cells`.

    Returns
    -------
    ndarray (N, quantities)
        NaN at nodes of no cell.
    """
    cell_count = sum(len(block) for block in cells)
    row = np.concatenate([block.ravel() for block in cells])
    corners = np.repeat([block.shape[1] for block in cells], [len(block) for block in cells])
    column = np.repeat(np.arange(cell_count), corners)
    touch = sparse.csr_matrix((np.ones(row.size), (row, column)), shape=(len(points), cell_count))
    centre = np.concatenate([points[block].mean(axis=1) for block in cells])
    stencil = (touch @ (touch.T @ touch)).tocoo()
    node, cell = stencil.row, stencil.col
    offset = centre[cell] - points[node]
    # Scaled by the size of the stencil, so that the regularisation means the same everywhere.
    scale = np.zeros(len(points))
    np.maximum.at(scale, node, np.linalg.norm(offset, axis=1))
    offset /= np.where(scale > 0, scale, 1.0)[node, None]
    weight = 1 / np.maximum((offset**2).sum(axis=1), 1e-12)
    basis = np.concatenate([np.ones((len(cell), 1)), offset], axis=1)
    size = basis.shape[1]
    matrix = np.zeros((len(points), size, size))
    right = np.zeros((len(points), size, values.shape[1]))
    for i in range(size):
        for j in range(size):
            product = weight * basis[:, i] * basis[:, j]
            matrix[:, i, j] = np.bincount(node, product, minlength=len(points))
        for k in range(values.shape[1]):
            product = weight * basis[:, i] * values[cell, k]
            right[:, i, k] = np.bincount(node, product, minlength=len(points))
    used = matrix[:, 0, 0] > 0
    matrix[:, range(1, size), range(1, size)] += REGULARISATION * matrix[:, 0, 0][:, None]
    result = np.full((len(points), values.shape[1]), np.nan)
    result[used] = np.linalg.solve(matrix[used], right[used])[:, 0]
    return _bounded(result, node, cell, values)


def _bounded(result, node, cell, values):
    """Keep positive fields positive at nodes that lie outside the centres of all cells."""
    low = np.full(result.shape, np.inf)
    high = np.full(result.shape, -np.inf)
    np.minimum.at(low, node, values[cell])
    np.maximum.at(high, node, values[cell])
    positive = low > 0
    bounded = np.clip(
        result, np.where(positive, low, 0) / LARGEST_FACTOR, np.where(positive, high, 0) * LARGEST_FACTOR
    )
    return np.where(positive, bounded, result)
