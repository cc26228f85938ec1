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

    `shapes`: for each field (E, Q, 3, l), value and gradient of its shape functions, shared by fields of one
    order; `dofs` (E, L): of all fields, one after the other; `z`, `r` (E, Q) [m];
    `weight` (E, Q): quadrature weight times 2 pi r [m3 for cells, m2 for facets];
    `normal` (2, E, Q): outward unit normal, None for cells.
    """

    shapes: tuple
    dofs: np.ndarray
    z: np.ndarray
    r: np.ndarray
    weight: np.ndarray
    normal: np.ndarray | None = None

    def local(self, field):
        """Columns of `dofs` that belong to field `field`."""
        sizes = [shape.shape[3] for shape in self.shapes]
        first = sum(sizes[:field])
        return slice(first, first + sizes[field])


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
        shapes = {}
        for order, basis in bases.items():
            shapes[order] = np.empty((elements, points, COMPONENTS, basis.Nbfun))
            for local, (function,) in enumerate(basis.basis):
                shapes[order][:, :, 0, local] = function
                shapes[order][:, :, 1, local] = function.grad[0]
                shapes[order][:, :, 2, local] = function.grad[1]
        dofs = [self.offsets[k] + bases[order].element_dofs.T for k, order in enumerate(self.orders)]
        return Patch(
            shapes=tuple(shapes[order] for order in self.orders),
            dofs=np.hstack(dofs).astype(np.int64),
            z=np.array(z),
            r=np.array(r),
            weight=2 * np.pi * r * first.dx,
            normal=None if normal is None else np.array(normal),
        )

    def _pattern(self):
        """Sparsity of the Jacobian: fields couple where their nodes share a cell.

        The nodes of a lower order are the first of a higher one: each field has the first part of each row of
        the matrix of nodes, which rises.
        """
        nodes = self._nodes(self.cells)
        ones = sparse.csr_matrix(
            (np.ones(nodes.size), (np.repeat(np.arange(len(nodes)), nodes.shape[1]), nodes.ravel()))
        )
        shared = (ones.T @ ones).tocsr()
        shared.sort_indices()
        of_order = {}
        for order, basis in self._bases.items():
            held = shared.indices < basis.N
            ends = np.concatenate([[0], np.cumsum(held)])[shared.indptr]
            of_order[order] = np.diff(ends), shared.indices[held]
        counts = [of_order[order][0] for order in self.orders]
        # (n + 1, N): entries of a row before those of each field
        self._before = np.cumsum([np.zeros_like(counts[0]), *counts], axis=0)
        sizes = np.diff(self.offsets)
        rows = np.concatenate([self._before[-1][:size] for size in sizes])
        self.indptr = np.concatenate([[0], np.cumsum(rows)]).astype(np.int32)
        self.indices = np.empty(self.indptr[-1], dtype=np.int32)
        for first, size in zip(self.offsets, sizes, strict=False):
            for field, order in enumerate(self.orders):
                count, found = of_order[order][0][:size], of_order[order][1]
                start = self.indptr[first : first + size] + self._before[field][:size]
                place = np.arange(count.sum()) + np.repeat(start - np.cumsum(count) + count, count)
                self.indices[place] = self.offsets[field] + found[: len(place)]
        shared.data = np.arange(shared.nnz) - np.repeat(shared.indptr[:-1], np.diff(shared.indptr))
        self._rank = shared  # of a node among those of a row
        self._known_places, self._known_products = {}, {}

    def _nodes(self, patch):
        """Nodes of the elements of a patch (E, l), those of the highest order."""
        field = int(np.argmax(self.orders))
        return patch.dofs[:, patch.local(field)] - self.offsets[field]

    def _places(self, patch):
        """Place in the CSR data of each entry of the element matrices (E L L,); kept for each patch."""
        if id(patch) not in self._known_places:
            nodes = self._nodes(patch)
            count = nodes.shape[1]
            rank = self._rank[np.repeat(nodes, count, axis=1).ravel(), np.tile(nodes, count).ravel()]
            rank = np.asarray(rank).reshape(-1, count, count)
            size = patch.dofs.shape[1]
            places = np.empty((len(nodes), size, size), dtype=np.intp)  # as `bincount` takes them
            for row in map(patch.local, range(len(self.orders))):
                first = self.indptr[patch.dofs[:, row]]
                for field in range(len(self.orders)):
                    column, test = patch.local(field), first.shape[1]
                    start = first + self._before[field][nodes[:, :test]]
                    trial = column.stop - column.start
                    places[:, row, column] = start[:, :, None] + rank[:, :test, :trial]
            self._known_places[id(patch)] = patch, places.ravel()
        return self._known_places[id(patch)][1]

    def inputs(self, patch, state):
        """Values and gradients (3 n, E, Q) of the fields with dof vector `state` at the quadrature points."""
        found = np.empty((COMPONENTS * len(self.orders), *patch.r.shape), dtype=state.dtype)
        for field in range(len(self.orders)):
            part = slice(COMPONENTS * field, COMPONENTS * (field + 1))
            found[part] = self.field_inputs(patch, field, state)
        return found

    @staticmethod
    def field_inputs(patch, field, state):
        """Value and gradient (3, E, Q) of one field."""
        shape = patch.shapes[field]
        elements, points, rows, local = shape.shape
        values = state[patch.dofs[:, patch.local(field)]][..., None]
        found = np.matmul(shape.reshape(elements, points * rows, local), values)
        return np.moveaxis(found.reshape(elements, points, rows), 2, 0)

    def residual(self, patch, densities):
        """Vector (size,) of the weak form with `densities` (3 n, E, Q)."""
        found = np.empty(patch.dofs.shape)
        for field, shape in enumerate(patch.shapes):
            elements, points, rows, local = shape.shape
            own = densities[rows * field : rows * (field + 1)]
            weighted = np.moveaxis(own * patch.weight, 0, 2).reshape(elements, 1, points * rows)
            found[:, patch.local(field)] = np.matmul(weighted, shape.reshape(elements, points * rows, local))[
                :, 0
            ]
        return np.bincount(patch.dofs.ravel(), found.ravel(), minlength=self.size)

    def load(self, cells, density):
        """Vector (size,) of the weak form of one field with the density (E, Q) of its values alone.

        As `residual`, faster: the values of the shape functions are the same in all cells.
        """
        found = (density * cells.weight) @ cells.shapes[0][0, :, 0]
        return np.bincount(cells.dofs.ravel(), found.ravel(), minlength=self.size)

    def cell_matrices(self, part, derivative):
        """Element matrices (e, L, L) of the slice `part` of the cells.

        As `element_matrices`, faster: with slopes along two sides of its cell instead of z and r the shape
        functions are the same in all cells, and the sums over quadrature points become one matrix product
        for each pair of fields.

        Parameters
        ----------
        part : slice
        derivative : function, seeds -> slopes of the 3 n densities, {direction: (Q, e)} each
            `seeds`: for each field input {direction: share}, a number or (e,); a direction is the value of a
            field or its slope along a side.
        """
        inverse = self._bases[max(self.orders)].mapping.invA[:, :, part]
        weight = np.ascontiguousarray(self.cells.weight[part].T)
        points, count = weight.shape
        fields = range(len(self.orders))
        forms = np.empty((len(fields), len(fields), COMPONENTS, COMPONENTS, points, count))
        seeds = []
        for value in range(0, COMPONENTS * len(fields), COMPONENTS):
            axes = ({value + 1 + side: inverse[side, axis] for side in range(2)} for axis in range(2))
            seeds += [{value: 1.0}, *axes]
        slopes = derivative(seeds)
        for test in fields:
            for trial in fields:
                for column in range(COMPONENTS):
                    own = (slopes[COMPONENTS * test + row] for row in range(COMPONENTS))
                    held, by_z, by_r = (row.get(COMPONENTS * trial + column, 0.0) * weight for row in own)
                    form = forms[test, trial, :, column]
                    form[0] = held
                    for row, (along_z, along_r) in enumerate(inverse, start=1):
                        form[row] = along_z * by_z + along_r * by_r
        matrices = np.empty((count, *2 * (self.cells.dofs.shape[1],)))
        for test in fields:
            for trial in fields:
                pair = self._products(self.orders[test], self.orders[trial])
                place = np.s_[:, self.cells.local(test), self.cells.local(trial)]
                summed = forms[test, trial].reshape(-1, count).T @ pair
                matrices[place] = summed.reshape(matrices[place].shape)
        return matrices

    def _products(self, *orders):
        """Products of shape functions and their slopes along the sides of a cell (9 Q, l l)."""
        if orders not in self._known_products:
            points = self._bases[max(self.orders)].X
            shapes = []
            for order in orders:
                element = ELEMENTS[order]()
                found = [element.lbasis(points, local) for local in range(self._bases[order].Nbfun)]
                shapes.append(np.stack([[value, *slopes] for value, slopes in found], axis=-1))
            pair = np.einsum("aqi,bqj->abqij", *shapes)
            self._known_products[orders] = pair.reshape(np.prod(pair.shape[:3]), -1)
        return self._known_products[orders]

    @staticmethod
    def element_matrices(patch, derivatives):
        """Element matrices (E, L, L) of a patch with density derivatives (E, Q, outputs, inputs)."""
        weighted = derivatives * patch.weight[:, :, None, None]
        elements, points, rows, _ = weighted.shape
        trial = np.empty((elements, points, rows, patch.dofs.shape[1]))
        for field, shape in enumerate(patch.shapes):
            own = slice(COMPONENTS * field, COMPONENTS * (field + 1))
            np.matmul(weighted[..., own], shape, out=trial[..., patch.local(field)])
        matrices = np.empty((elements, *2 * (patch.dofs.shape[1],)))
        for field, shape in enumerate(patch.shapes):
            own = slice(COMPONENTS * field, COMPONENTS * (field + 1))
            tests = shape.reshape(elements, points * COMPONENTS, -1).transpose(0, 2, 1)
            ahead = trial[:, :, own].reshape(elements, points * COMPONENTS, -1)
            np.matmul(tests, ahead, out=matrices[:, patch.local(field)])
        return matrices

    def gathered(self, patch, matrices):
        """CSR data (nnz,) of the sum of element matrices (E, L, L)."""
        return np.bincount(self._places(patch), matrices.ravel(), minlength=len(self.indices))

    def matrix(self, data):
        """Sparse matrix (size, size) of CSR `data` in the pattern of the space."""
        return sparse.csr_matrix((data, self.indices, self.indptr), shape=(self.size, self.size))
