"""Finite-element space of several scalar fields on one triangle mesh, and the assembly of pointwise physics.

A weak form  sum_f int [v F_f0 + dv/dz F_f1 + dv/dr F_f2] w dz dr = 0  is given by a pointwise function from
the 3 n field inputs (value, d/dz, d/dr of every field) to the 3 n densities F; this module turns densities
into a residual vector and density derivatives into a sparse Jacobian. scikit-fem provides mesh topology,
dofs, bases and quadrature.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from skfem import CellBasis, ElementTriP1, ElementTriP2, FacetBasis

ELEMENTS = {1: ElementTriP1, 2: ElementTriP2}
QUADRATURE_ORDER = {1: 2, 2: 4}  # by highest element order: exact mass matrix, 3 and 6 points
COMPONENTS = 3  # value, d/dz, d/dr


@dataclass(frozen=True)
class Patch:
    """A set of elements (cells, or boundary facets of cells) with its quadrature.

    `shape` (E, Q, 3 n, L): inputs of every local dof; `dofs` (E, L); `z`, `r` (E, Q) [m];
    `weight` (E, Q): quadrature weight times 2 pi r [m3 for cells, m2 for facets];
    `normal` (2, E, Q): outward unit normal, None for cells.
    """

    shape: np.ndarray
    dofs: np.ndarray
    z: np.ndarray
    r: np.ndarray
    weight: np.ndarray
    normal: np.ndarray | None = None


class Space:
    """Layout of n fields of element order `orders` on `mesh`: dofs of field 0, then of field 1, ..."""

    def __init__(self, mesh, orders):
        self.mesh = mesh
        self.orders = tuple(orders)
        self._quadrature = QUADRATURE_ORDER[max(self.orders)]
        self._bases = {
            order: CellBasis(mesh, ELEMENTS[order](), intorder=self._quadrature) for order in set(orders)
        }
        counts = [self._bases[order].N for order in self.orders]
        self.offsets = np.concatenate([[0], np.cumsum(counts)])
        self.size = int(self.offsets[-1])
        self.cells = self._patch(self._bases)
        self._pattern()

    def field(self, index):
        """Slice of field `index` in the vector of all dofs."""
        return slice(self.offsets[index], self.offsets[index + 1])

    def points(self, index):
        """Coordinates (2, N) of the dofs of field `index` [m]."""
        return self._bases[self.orders[index]].doflocs

    def boundary_dofs(self, index, names):
        """Sorted dofs (within the field) of field `index` on the named boundaries."""
        facets = np.unique(np.concatenate([self.mesh.boundaries[name] for name in names]))
        return np.unique(self._bases[self.orders[index]].get_dofs(facets).flatten())

    def element_dofs(self, index):
        """Dofs (within the field) of field `index` by element (3 or 6, E): vertices, then edges."""
        return self._bases[self.orders[index]].element_dofs

    def node_weights(self, index):
        """Volume that each dof of field `index` stands for (N,) [m3]: an equal share of its elements'."""
        dofs = self.element_dofs(index)
        share = np.broadcast_to(self.cells.weight.sum(axis=1) / len(dofs), dofs.shape)
        return np.bincount(dofs.ravel(), share.ravel(), minlength=self._bases[self.orders[index]].N)

    def subset(self, elements):
        """Patch of some of the cells, by their index in the mesh."""
        return self._patch(
            {
                order: CellBasis(self.mesh, ELEMENTS[order](), intorder=self._quadrature, elements=elements)
                for order in self._bases
            }
        )

    def nodes(self):
        """Node of every dof: the dofs of all fields at one mesh vertex or edge midpoint share a number."""
        return np.concatenate([np.arange(self._bases[order].N) for order in self.orders])

    def facets(self, names):
        """Patch of the named boundaries."""
        facets = np.concatenate([self.mesh.boundaries[name] for name in names])
        bases = {
            order: FacetBasis(self.mesh, ELEMENTS[order](), facets=facets, intorder=self._quadrature)
            for order in self._bases
        }
        return self._patch(bases, normal=next(iter(bases.values())).normals)

    def _patch(self, bases, normal=None):
        first = next(iter(bases.values()))
        z, r = first.global_coordinates()
        elements, points = first.dx.shape
        blocks, dofs = [], []
        for index, order in enumerate(self.orders):
            basis = bases[order]
            block = np.zeros((elements, points, COMPONENTS * len(self.orders), basis.Nbfun))
            for local, (function,) in enumerate(basis.basis):
                block[:, :, COMPONENTS * index, local] = function
                block[:, :, COMPONENTS * index + 1, local] = function.grad[0]
                block[:, :, COMPONENTS * index + 2, local] = function.grad[1]
            blocks.append(block)
            dofs.append(self.offsets[index] + basis.element_dofs.T)
        return Patch(
            shape=np.ascontiguousarray(np.concatenate(blocks, axis=3)),
            dofs=np.hstack(dofs).astype(np.int64),
            z=np.array(z),
            r=np.array(r),
            weight=2 * np.pi * r * first.dx,
            normal=None if normal is None else np.array(normal),
        )

    def _pattern(self):
        """Sparsity of the Jacobian, and where each entry of an element matrix goes."""
        ones = sparse.csr_matrix(
            (np.ones(self.cells.dofs.size), (self._rows(self.cells), self.cells.dofs.ravel())),
            shape=(len(self.cells.dofs), self.size),
        )
        pattern = (ones.T @ ones).tocsr()
        pattern.sort_indices()
        self.indptr, self.indices = pattern.indptr, pattern.indices
        self._keys = _keys(np.repeat(np.arange(self.size), np.diff(self.indptr)), self.indices, self.size)
        self._cell_places = self._places(self.cells)

    @staticmethod
    def _rows(patch):
        return np.repeat(np.arange(len(patch.dofs)), patch.dofs.shape[1])

    def _places(self, patch):
        rows = np.repeat(patch.dofs, patch.dofs.shape[1], axis=1).ravel()
        columns = np.tile(patch.dofs, (1, patch.dofs.shape[1])).ravel()
        return np.searchsorted(self._keys, _keys(rows, columns, self.size))

    def inputs(self, patch, state):
        """Values and gradients (3 n, E, Q) of the fields with dof vector `state` at the quadrature points."""
        return np.moveaxis(np.matmul(patch.shape, state[patch.dofs][:, None, :, None])[..., 0], 2, 0)

    def residual(self, patch, densities):
        """Vector (size,) of the weak form with `densities` (3 n, E, Q)."""
        elements, points, rows, local = patch.shape.shape
        weighted = np.moveaxis(densities * patch.weight, 0, 2).reshape(elements, 1, points * rows)
        contribution = np.matmul(weighted, patch.shape.reshape(elements, points * rows, local))[:, 0]
        return np.bincount(patch.dofs.ravel(), contribution.ravel(), minlength=self.size)

    @staticmethod
    def element_matrices(patch, derivatives, part=slice(None)):
        """Element matrices (E, L, L) of some elements with density derivatives (E, Q, outputs, inputs)."""
        shape = patch.shape[part]
        elements, points, rows, local = shape.shape
        weighted = derivatives * patch.weight[part][:, :, None, None]
        trial = np.matmul(weighted, shape).reshape(elements, points * rows, local)
        return np.matmul(shape.reshape(elements, points * rows, local).transpose(0, 2, 1), trial)

    def gathered(self, patch, matrices):
        """CSR data (nnz,) of the sum of element matrices (E, L, L)."""
        places = self._cell_places if patch is self.cells else self._places(patch)
        return np.bincount(places, matrices.ravel(), minlength=len(self.indices))

    def matrix(self, data):
        """Sparse matrix (size, size) of CSR `data` in the pattern of the space."""
        return sparse.csr_matrix((data, self.indices, self.indptr), shape=(self.size, self.size))


def _keys(rows, columns, size):
    return rows.astype(np.int64) * size + columns
