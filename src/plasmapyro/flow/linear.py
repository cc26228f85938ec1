"""Sparse direct solution with many matrices of one sparsity pattern.

Nested dissection (METIS) of the vertices of the mesh, computed once, then SuperLU without column reordering.
Keeping the unknowns of a node together and preferring diagonal pivots leaves the fill of the dissection: 21
million entries and 0.7 s for 97 000 unknowns, where SuperLU's own column ordering takes 9 s. An edge goes
with the first of its ends: it joins a separator only where both ends do. That fills 3 % less than the
dissection of the graph of all nodes, in a tenth of the time. It goes right before that end, whose pressure,
with nothing on the diagonal, has a pivot by then.

Factors may be kept in single precision: 0.5 s and half the memory. They solve to 1e-4, plenty inside an
iteration that applies the matrix itself; iterative refinement brings a direct solution to 1e-10. Where they
fail, they are made again in the precision of the matrix.

Source: Carson and Higham, SIAM J. Sci. Comput. 40 (2018) A817 (refinement with factors of lower precision).
"""

import logging

import numpy as np
import pymetis
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

log = logging.getLogger(__name__)

# A diagonal pivot is kept unless it is that much smaller than the largest of its column. The zero diagonal
# of the Taylor-Hood pressure block has filled in by the time its node is reached; 1e-3 and 1e-6 give the
# same accuracy.
PIVOT_THRESHOLD = 1e-4
RESIDUAL_LIMIT = 1e-6  # relative; the factorisations in use leave 1e-13, in single precision 1e-4
ROUGH_LIMIT = 1e-2  # the same of a solution inside an iteration
REFINED, REFINEMENTS = 1e-10, 4  # residual that refinement aims at, and its most rounds
SINGLE = {"d": np.dtype(np.float32), "D": np.dtype(np.complex64)}


class Factorised:
    """Solver for matrices that share the pattern of the first one.

    `groups` (N,): node of each unknown; the unknowns of a node are eliminated one after the other, in their
    own order. `kept`: rows and columns that make up the system, all by default. `rank`: place of each node in
    the order of elimination, see `dissection`; from the graph of the first matrix by default.
    """

    def __init__(self, groups, kept=None, rank=None):
        self._groups, self._kept, self._rank = np.asarray(groups), kept, rank
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
        if self._rank is None:
            self._rank = _rank_of_groups(numbered, self._groups)
        self._order = np.argsort(self._rank[self._groups], kind="stable")
        permuted = numbered[self._order][:, self._order].tocsc()
        permuted.sort_indices()
        permuted.data -= 1
        self._places, self._indices, self._indptr = permuted.data, permuted.indices, permuted.indptr


class System:
    """A matrix in the order of elimination; made by `Factorised.system`."""

    def __init__(self, permuted, order):
        self.permuted, self.order = permuted, order

    def factors(self, *, single=False):
        """Factors, for any number of right-hand sides; in single precision if asked for.

        ArithmeticError if the matrix is singular.
        """
        return Factors(self, SINGLE[self.permuted.dtype.char] if single else self.permuted.dtype)


class Factors:
    """A factorised matrix; made by `System.factors`."""

    def __init__(self, system, precision):
        self._matrix, self._order = system.permuted, system.order
        self._factorise(precision)

    def _factorise(self, precision):
        try:
            self._factors = splu(
                self._matrix.astype(precision, copy=False),
                permc_spec="NATURAL",
                diag_pivot_thresh=PIVOT_THRESHOLD,
                options={"SymmetricMode": True},
            )
        except RuntimeError as fault:
            if precision != self._matrix.dtype:
                self._again(fault)
                return
            size = self._matrix.shape[0]
            raise ArithmeticError(f"singular matrix of {size} unknowns ({fault})") from None
        self._precision = precision

    def _again(self, fault):
        log.info("factors of %s in double precision after: %s", self._matrix.shape, fault)
        self._factorise(self._matrix.dtype)

    def solve(self, right_hand_side):
        """Solve A x = b.

        ArithmeticError if the residual shows that the factorisation lost its accuracy.
        """
        permuted = right_hand_side[self._order]
        size = np.linalg.norm(permuted)
        solution = self._applied(permuted)
        rest = permuted - self._matrix @ solution
        for _ in range(REFINEMENTS if self._is_single else 0):
            if np.linalg.norm(rest) <= REFINED * size:
                break
            solution += self._applied(rest)
            rest = permuted - self._matrix @ solution
        if self._inaccurate(np.linalg.norm(rest), RESIDUAL_LIMIT * size):
            return self.solve(right_hand_side)
        return self._in_place(solution)

    def solve_roughly(self, right_hand_side):
        """A solution x of A x = b to `ROUGH_LIMIT`, and the product A x; raises as `solve`."""
        permuted = right_hand_side[self._order]
        solution = self._applied(permuted)
        product = self._matrix @ solution
        if self._inaccurate(np.linalg.norm(product - permuted), ROUGH_LIMIT * np.linalg.norm(permuted)):
            return self.solve_roughly(right_hand_side)
        return self._in_place(solution), self._in_place(product)

    @property
    def fill(self):
        """Number of entries of the factors."""
        return self._factors.nnz

    @property
    def _is_single(self):
        return self._precision != self._matrix.dtype

    def _inaccurate(self, error, limit):
        """Whether a residual is too large; then the factors are others, or ArithmeticError is raised."""
        if error <= limit:
            return False
        fault = f"inaccurate factorisation: residual {error:g} of {len(self._order)} unknowns"
        if not self._is_single:
            raise ArithmeticError(fault)
        self._again(fault)
        return True

    def _applied(self, permuted):
        solution = self._factors.solve(permuted.astype(self._precision, copy=False))
        return solution.astype(self._matrix.dtype, copy=False)

    def _in_place(self, permuted):
        found = np.empty_like(permuted)
        found[self._order] = permuted
        return found


def dissection(mesh):
    """Place in the order of elimination of the vertices of a triangle mesh, then of its edges."""
    ends = mesh.facets
    size = mesh.nvertices
    graph = sparse.coo_matrix((np.ones(ends.shape[1]), ends), shape=(size, size))
    rank = _dissected((graph + graph.T).tocsr())
    first, last = np.sort(rank[ends], axis=0)
    order = np.lexsort((np.concatenate([np.full(size, size), last]), np.concatenate([rank, first])))
    return _places(order)


def _rank_of_groups(matrix, groups):
    nodes, member = np.unique(groups, return_inverse=True)
    gather = sparse.csr_matrix((np.ones(len(member)), (np.arange(len(member)), member)))
    ones = sparse.csr_matrix((np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
    graph = gather.T @ (ones + ones.T) @ gather
    graph = (graph - sparse.diags(graph.diagonal())).tocsr()
    graph.eliminate_zeros()
    rank = np.zeros(nodes.max() + 1, dtype=np.int64)
    rank[nodes] = _dissected(graph)
    return rank


def _dissected(graph):
    order, _ = pymetis.nested_dissection(adjacency=pymetis.CSRAdjacency(graph.indptr, graph.indices))
    return _places(np.asarray(order))


def _places(order):
    places = np.empty(len(order), dtype=np.int64)
    places[order] = np.arange(len(order))
    return places
