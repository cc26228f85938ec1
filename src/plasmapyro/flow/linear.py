"""Sparse direct solution with many matrices of one sparsity pattern.

Nested dissection (METIS) of the graph of mesh nodes, computed once, then SuperLU without column reordering.
Keeping the unknowns of a node together and preferring diagonal pivots leaves the fill of the dissection: 21
million entries and 0.7 s for 97 000 unknowns, where SuperLU's own column ordering takes 9 s.

Factors may be kept in single precision: 0.5 s and half the memory. They solve to 5e-5, plenty inside an
iteration that applies the matrix itself; refinement brings a direct solution to `RESIDUAL_LIMIT`.

Source: Carson and Higham, SIAM J. Sci. Comput. 40 (2018) A817 (refinement with factors of lower precision).
"""

import numpy as np
import pymetis
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

# A diagonal pivot is kept unless it is that much smaller than the largest of its column. The zero diagonal
# of the Taylor-Hood pressure block has filled in by the time its node is reached; 1e-3 and 1e-6 give the
# same accuracy.
PIVOT_THRESHOLD = 1e-4
RESIDUAL_LIMIT = 1e-6  # relative; the factorisations in use leave 1e-13, in single precision 5e-5
ROUGH_LIMIT = 1e-2  # the same of one solution inside an iteration
REFINEMENTS = 3


class Factorised:
    """Solver for matrices that share the pattern of the first one.

    Parameters
    ----------
    groups : (N,) integer array
        Node of each unknown; the unknowns of a node are eliminated one after the other, in their own order.
    kept : (N,) integer array, optional
        Rows and columns of the matrices that make up the system; all if not given.
    """

    def __init__(self, groups, kept=None):
        self._groups, self._kept = np.asarray(groups), kept
        self._order = None

    def solve(self, matrix, right_hand_side):
        """Solve A x = b for a CSR matrix A, real or complex; raises as `Factors.solve`."""
        return self.system(matrix).factors().solve(right_hand_side)

    def system(self, matrix):
        """The System of a CSR matrix, real or complex."""
        if self._order is None:
            self._analyse(matrix)
        size = len(self._order)
        permuted = sparse.csc_matrix(
            (matrix.data[self._places], self._indices, self._indptr), shape=(size, size)
        )
        return System(permuted, self._order)

    def _analyse(self, matrix):
        """Fill-reducing order, and where the entries of `matrix` go in the permuted columns."""
        numbered = sparse.csr_matrix(
            (np.arange(1, matrix.nnz + 1, dtype=np.int32), matrix.indices, matrix.indptr), shape=matrix.shape
        )
        if self._kept is not None:
            numbered = numbered[self._kept][:, self._kept]
        self._order = _node_dissection(numbered, self._groups)
        permuted = numbered[self._order][:, self._order].tocsc()
        permuted.sort_indices()
        permuted.data -= 1
        self._places, self._indices, self._indptr = permuted.data, permuted.indices, permuted.indptr


class System:
    """A matrix in the order of elimination; made by `Factorised.system`."""

    def __init__(self, permuted, order):
        self.permuted, self.order = permuted, order

    def factors(self, precision=None):
        """Factors, for any number of right-hand sides; `precision`: their dtype, that of the matrix if None.

        Raises
        ------
        ArithmeticError
            If the matrix is singular.
        """
        matrix = self.permuted
        try:
            factors = splu(
                matrix if precision is None else matrix.astype(precision),
                permc_spec="NATURAL",
                diag_pivot_thresh=PIVOT_THRESHOLD,
                options={"SymmetricMode": True},
            )
        except RuntimeError as fault:
            raise ArithmeticError(f"singular matrix of {matrix.shape[0]} unknowns ({fault})") from None
        return Factors(self, factors, np.dtype(precision or matrix.dtype))


class Factors:
    """A factorised matrix; made by `System.factors`."""

    def __init__(self, system, factors, precision):
        self._matrix, self._order = system.permuted, system.order
        self._factors, self._precision = factors, precision

    def solve(self, right_hand_side):
        """Solve A x = b.

        Raises
        ------
        ArithmeticError
            If the residual shows that the factorisation lost its accuracy.
        """
        permuted = right_hand_side[self._order]
        limit = RESIDUAL_LIMIT * np.linalg.norm(permuted)
        solution = self._applied(permuted)
        rest = permuted - self._matrix @ solution
        for _ in range(REFINEMENTS if self._precision != self._matrix.dtype else 0):
            if np.linalg.norm(rest) <= limit:
                break
            solution += self._applied(rest)
            rest = permuted - self._matrix @ solution
        _held(np.linalg.norm(rest), limit, len(solution))
        return self._in_place(solution)

    def solve_roughly(self, right_hand_side):
        """A solution x of A x = b to `ROUGH_LIMIT`, and the product A x; raises as `solve`."""
        permuted = right_hand_side[self._order]
        solution = self._applied(permuted)
        product = self._matrix @ solution
        _held(np.linalg.norm(product - permuted), ROUGH_LIMIT * np.linalg.norm(permuted), len(solution))
        return self._in_place(solution), self._in_place(product)

    def _applied(self, permuted):
        solution = self._factors.solve(permuted.astype(self._precision, copy=False))
        return solution.astype(self._matrix.dtype, copy=False)

    def _in_place(self, permuted):
        found = np.empty_like(permuted)
        found[self._order] = permuted
        return found


def _held(error, limit, size):
    if not error <= limit:
        raise ArithmeticError(f"inaccurate factorisation: residual {error:g} of {size} unknowns")


def _node_dissection(matrix, groups):
    nodes, member = np.unique(groups, return_inverse=True)
    gather = sparse.csr_matrix((np.ones(len(member)), (np.arange(len(member)), member)))
    ones = sparse.csr_matrix((np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
    graph = gather.T @ (ones + ones.T) @ gather
    graph = (graph - sparse.diags(graph.diagonal())).tocsr()
    graph.eliminate_zeros()
    order, _ = pymetis.nested_dissection(adjacency=pymetis.CSRAdjacency(graph.indptr, graph.indices))
    rank = np.empty(len(nodes), dtype=np.int64)
    rank[np.asarray(order)] = np.arange(len(nodes))
    return np.argsort(rank[member], kind="stable")
