r"""Conduction of heat through the heat-flux potential.

.. math:: S(T) = \int_{T_0}^T \kappa\,dT', \qquad \nabla\cdot(\kappa\nabla T) = \nabla^2 S

S, not T, is interpolated between the nodes (S_j = S(T_j)). Near a wall the heat flux is uniform and S is
linear in the distance however much kappa varies; with T interpolated, cells in which kappa doubles leave a
nearly singular matrix. The discrete operator is a constant matrix applied to S_j, its derivative that matrix
times kappa_j.

Source: Fletcher, Comput. Methods Appl. Mech. Eng. 37 (1983) 225 (group finite elements: nonlinear functions
are interpolated at the nodes); heat-flux potential after Kirchhoff, Vorlesungen ueber die Theorie der Waerme
(1894).
"""

import numpy as np

from plasmapyro.flow.physics import LOG_TEMPERATURE, ROW_SCALE


class Conduction:
    """Conduction term of the energy rows on the space of the four flow fields, weight 2 pi r."""

    def __init__(self, space):
        cells = space.cells
        self._dofs = space.element_dofs(LOG_TEMPERATURE).T  # within the field
        self.columns = cells.local(LOG_TEMPERATURE)
        self._field, self._size = space.field(LOG_TEMPERATURE), space.size
        slope = cells.shapes[LOG_TEMPERATURE][:, :, 1:]
        scale = ROW_SCALE[3 * LOG_TEMPERATURE]
        self._stiffness = scale * np.einsum("eqdi,eq,eqdj->eij", slope, cells.weight, slope, optimize=True)

    def residual(self, state, properties):
        """Vector (size,): zero but for the energy rows."""
        potential, _ = properties.heat_flux_potential(np.exp(state[self._field]))
        rows = np.einsum("eij,ej->ei", self._stiffness, potential[self._dofs])
        count = self._field.stop - self._field.start
        found = np.zeros(self._size)
        found[self._field] = np.bincount(self._dofs.ravel(), rows.ravel(), minlength=count)
        return found

    def element_matrices(self, state, properties, part):
        """Derivative of the energy rows of some elements by their ln T (E, L, L)."""
        temperature = np.exp(state[self._field])
        slope = properties.heat_flux_potential(temperature)[1] * temperature
        return self._stiffness[part] * slope[self._dofs[part]][:, None, :]
