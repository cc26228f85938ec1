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

from plasmapyro.flow.evaluate import temperature_at
from plasmapyro.flow.physics import LOG_TEMPERATURE

SAFETY, SAFETY_OF_TWO = 1.25, 3.0
TAKEN_ORDER = 2.0
ORDER_RANGE = (1.0, 3.0)


def mesh_error(known, coarser, ratio):
    """Estimated error (N,) [K] of the temperature at the nodes of ln T, and the observed order.

    `coarser`: one or two Solutions on cells `ratio` > 1 times as large, and its square; the order of two
    meshes is NaN.
    """
    space = known.problem.space
    points = space.points(LOG_TEMPERATURE)
    fine = np.exp(known.state[space.field(LOG_TEMPERATURE)])
    middle, *coarse = (temperature_at(other.problem, other.state, points) for other in coarser)
    if not coarse:
        return SAFETY_OF_TWO * np.abs(middle - fine) / (ratio**TAKEN_ORDER - 1), np.nan
    weight = space.node_weights(LOG_TEMPERATURE)

    def norm(difference):
        return np.sqrt((weight * difference**2).sum() / weight.sum())

    order = float(np.log(norm(coarse[0] - middle) / norm(middle - fine)) / np.log(ratio))
    used = float(np.clip(order, *ORDER_RANGE))
    first = np.abs(middle - fine) / (ratio**used - 1)
    second = np.abs(coarse[0] - fine) / (ratio ** (2 * used) - 1)
    return SAFETY * np.maximum(first, second), order
