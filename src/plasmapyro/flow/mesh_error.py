r"""Error of the temperature from solutions on three meshes.

With cell sizes h, r h and r^2 h, the differences of the solutions give the observed order p, and the order
the error of the finest one:

.. math:: p = \ln\frac{\|T_{r^2 h} - T_{rh}\|}{\|T_{rh} - T_h\|} / \ln r, \qquad
    \delta T = 1.25\,\max\left(\frac{|T_{rh} - T_h|}{r^p - 1}, \frac{|T_{r^2 h} - T_h|}{r^{2p} - 1}\right)

The norm is the root mean square over the volume of the flow. At a point where one difference passes through
zero the other one stands. Where only the first coarser mesh has a solution, p = 2 is taken for granted and
the safety factor is 3.

Source: Roache, J. Fluids Eng. 116 (1994) 405 (grid convergence index, safety factor 1.25 for three meshes, 3
for two). Deviation: one order for the whole field, limited to 1...3, since orders of single points scatter on
meshes that are not nested.
"""

import numpy as np
from scipy.spatial import cKDTree

from plasmapyro.flow.physics import LOG_TEMPERATURE

SAFETY, SAFETY_OF_TWO = 1.25, 3.0
TAKEN_ORDER = 2.0
ORDER_RANGE = (1.0, 3.0)
NEAREST = 24  # triangles around a point among which the one that holds it is looked for


def nodal_values(problem, state, field, points):
    """Field `field` of a Taylor-Hood or linear solution at any points (2, N), in the unit of its dofs.

    A point just outside (on the chord of a finer outline) takes the value of the nearest triangle, continued.
    """
    mesh = problem.mesh
    _, near = cKDTree(mesh.p[:, mesh.t].mean(axis=1).T).query(points.T, k=min(NEAREST, mesh.nelements))
    corners = mesh.p[:, mesh.t[:, near]]  # (2, 3, N, NEAREST)
    (z0, z1, z2), (r0, r1, r2) = corners
    z, r = points[0][:, None], points[1][:, None]
    twice = (z1 - z0) * (r2 - r0) - (z2 - z0) * (r1 - r0)
    second = ((z - z0) * (r2 - r0) - (z2 - z0) * (r - r0)) / twice
    third = ((z1 - z0) * (r - r0) - (z - z0) * (r1 - r0)) / twice
    area = np.stack([1 - second - third, second, third])
    best = area.min(axis=0).argmax(axis=1)
    place = np.arange(len(best))
    a, b, c = area[:, place, best]
    dofs = problem.space.element_dofs(field)[:, near[place, best]]
    values = state[problem.space.field(field)][dofs]
    if len(dofs) == 3:
        return a * values[0] + b * values[1] + c * values[2]
    shape = [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * a * c]
    return sum(weight * value for weight, value in zip(shape, values, strict=True))


def mesh_error(problem, state, coarser, ratio):
    """Estimated error of the temperature at the nodes of ln T [K], and the observed order.

    Parameters
    ----------
    problem, state : the finest solution
    coarser : one or two pairs (problem, state), the first with cells `ratio` times as large, the second with
        cells `ratio`^2 times as large.
    ratio : float [1], > 1

    Returns
    -------
    error (N,) [K] and order; NaN for the order of two meshes
    """
    points = problem.space.points(LOG_TEMPERATURE)
    fine = np.exp(state[problem.space.field(LOG_TEMPERATURE)])
    middle, *coarse = (
        np.exp(nodal_values(other, found, LOG_TEMPERATURE, points)) for other, found in coarser
    )
    if not coarse:
        return SAFETY_OF_TWO * np.abs(middle - fine) / (ratio**TAKEN_ORDER - 1), np.nan
    weight = problem.space.node_weights(LOG_TEMPERATURE)

    def norm(difference):
        return np.sqrt((weight * difference**2).sum() / weight.sum())

    order = float(np.log(norm(coarse[0] - middle) / norm(middle - fine)) / np.log(ratio))
    used = float(np.clip(order, *ORDER_RANGE))
    first = np.abs(middle - fine) / (ratio**used - 1)
    second = np.abs(coarse[0] - fine) / (ratio ** (2 * used) - 1)
    return SAFETY * np.maximum(first, second), order
