r"""Newton's method for the flow and the induction equation together.

The Jacobian of the flow with frozen heating and forces, A, is factorised. What the unknowns change through
the induction equation, B, is applied without being assembled: temperature to conductivity, one solution with
the factors of the induction equation, heating and forces to residual. Then

.. math:: (A + B)\,\delta = -R, \qquad (I + B A^{-1})\,y = -R,\; \delta = A^{-1} y

B A^-1 is compact (the field follows the conductivity smoothly), so that GMRES needs a handful of iterations.

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
    block : function, b -> A^-1 b
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
    operator = LinearOperator((size, size), matvec=lambda y: y + rest(block(y)), dtype=float)
    solution, _ = gmres(
        operator, right_hand_side / scale, rtol=tolerance, atol=0.0, restart=LARGEST_SUBSPACE, maxiter=1
    )
    return scale * block(solution)
