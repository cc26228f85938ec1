r"""Azimuthal velocity of gas that enters with a swirl.

.. math:: \rho\,(u_z\,\partial_z w + u_r\,\partial_r w + u_r w/r)
    = \frac{1}{r^2}\,\partial_r(r^2 \tau_{r\theta}) + \partial_z\tau_{z\theta}, \qquad
    \tau_{r\theta} = \mu\,(\partial_r w - w/r),\; \tau_{z\theta} = \mu\,\partial_z w

It is linear in w for a given flow, and acts on the flow through the centrifugal force rho w^2 / r alone:
solved beside the induction equation, in the same loop. Weak form with weight r; streamline upwinding as in
`physics`. Walls at rest; at the inlet w = u_z tan(angle); gas that enters through an open boundary does not
turn.

Source: Bird, Stewart, Lightfoot, Transport Phenomena, 2nd ed., table B.6 (theta component). Deviation: the
dissipation by the swirl is left out of the energy equation (below 1e-4 of the Joule power).
"""

import numpy as np

from plasmapyro.flow.elements import Space
from plasmapyro.flow.geometry import WALLS
from plasmapyro.flow.linear import Factorised, dissection
from plasmapyro.flow.physics import SMALL_SPEED, stabilisation_time


class Swirl:
    """The azimuthal equation on the mesh of the flow.

    Parameters
    ----------
    mesh : MeshTri
        Boundaries `geometry.BOUNDARIES` and 'axis'.
    order : int
        Element order, 1 or 2.
    open_boundaries : names of the boundaries where gas may enter at rest.
    """

    def __init__(self, mesh, order, open_boundaries):
        self._space = Space(mesh, (order,))
        self._open = self._space.facets(open_boundaries) if open_boundaries else None
        held = [name for name in (*WALLS, "inlet", "axis") if len(mesh.boundaries.get(name, ()))]
        self._fixed = self._space.boundary_dofs(0, held)
        self._inlet = (
            self._space.boundary_dofs(0, ("inlet",)) if len(mesh.boundaries.get("inlet", ())) else []
        )
        self._free = np.setdiff1d(np.arange(self._space.size), self._fixed)
        self._factorised = Factorised(self._free, rank=dissection(mesh))

    def inlet_values(self, axial, angle):
        """Boundary values (size,) [m s-1] for inlet velocities `axial` at the dofs [m s-1]."""
        values = np.zeros(self._space.size)
        values[self._inlet] = axial[self._inlet] * np.tan(angle)
        return values

    def solve(self, axial, radial, density, viscosity, size, values, entering=None, source=None):
        """Steady azimuthal velocity of a given flow.

        Parameters
        ----------
        axial, radial : (E, Q) [m s-1]
        density, viscosity : (E, Q) [kg m-3], [Pa s]
        size : (E, Q) element size [m], as in `physics`
        values : (size,) [m s-1]
            Boundary values where fixed.
        entering : (facets, Q) [kg m-2 s-1], optional
            Mass flux into the domain at the open boundaries, >= 0.
        source : (E, Q) [N m-3], optional
            Azimuthal force.

        Returns
        -------
        dofs (size,) and values at the quadrature points (E, Q) [m s-1]
        """
        space, cells = self._space, self._space.cells
        speed = np.sqrt(axial**2 + radial**2 + SMALL_SPEED**2)
        tau = stabilisation_time(density, speed, viscosity, size, 0.0)
        form = np.zeros((*cells.r.shape, 3, 3))
        # Rows: factors of v, dv/dz, dv/dr; columns: of w, dw/dz, dw/dr.
        advection = np.stack([density * radial / cells.r, density * axial, density * radial], axis=-1)
        form[..., 0, :] = advection
        form[..., 0, 0] += viscosity / cells.r**2
        form[..., 0, 2] -= viscosity / cells.r
        form[..., 1, 1] += viscosity
        form[..., 2, 2] += viscosity
        form[..., 2, 0] -= viscosity / cells.r
        for row, velocity in ((1, axial), (2, radial)):
            form[..., row, :] += (tau * density * velocity)[..., None] * advection
        data = space.gathered(cells, space.element_matrices(cells, form))
        if entering is not None:
            edge = np.zeros((*self._open.r.shape, 3, 3))
            edge[..., 0, 0] = entering
            data = data + space.gathered(self._open, space.element_matrices(self._open, edge))
        matrix = space.matrix(data)
        load = np.zeros(space.size)
        if source is not None:
            rows = np.stack([source, tau * density * axial * source, tau * density * radial * source])
            load = space.residual(cells, rows)
        solution = np.zeros(space.size)
        solution[self._fixed] = values[self._fixed]
        right = (load - matrix @ solution)[self._free]
        if np.any(right):
            block = matrix[self._free][:, self._free].tocsr()
            block.sort_indices()
            solution[self._free] = self._factorised.solve(block, right)
        return solution, space.inputs(cells, solution)[0]
