r"""Newton's method for the flow and the induction equation together.

The Jacobian of the flow with frozen heating and forces, A, is factorised. What the unknowns change through
the induction equation, B, is applied without being assembled: temperature to conductivity, one solution with
the factors of the induction equation, heating and forces to residual. Then

.. math:: (A + B)\,\delta = -R, \qquad (A + B) P\,y = -R,\; \delta = P y

with P the factors' A^-1. B A^-1 is compact (the field follows the conductivity smoothly), so that GMRES needs
a handful of iterations. A is applied itself: factors of single precision may change the number of
iterations, not what they converge to.

Source: Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856 (GMRES); Knoll and Keyes, J. Comput. Phys.
193 (2004) 357 (Jacobian-free Newton-Krylov with a block as preconditioner).
"""

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

LARGEST_SUBSPACE = 20


def coupled_solution(block, rest, right_hand_side, tolerance):
    """Solve (A + B) x = b.

    Parameters
    ----------
    block : function, b -> P b and A P b, P near A^-1
    rest : function, x -> B x
    right_hand_side : (N,)
    tolerance : float [1]
        Of the residual relative to b. After `LARGEST_SUBSPACE` iterations the best solution so far is
        returned: a step of Newton's method is not exact anyway.
    """
    size = len(right_hand_side)
    scale = np.linalg.norm(right_hand_side)
    if scale == 0:
        return np.zeros(size)

    def applied(y):
        solution, product = block(y)
        return product + rest(solution)

    operator = LinearOperator((size, size), matvec=applied, dtype=float)
    solution, _ = gmres(
        operator, right_hand_side / scale, rtol=tolerance, atol=0.0, restart=LARGEST_SUBSPACE, maxiter=1
    )
    return scale * block(solution)[0]
