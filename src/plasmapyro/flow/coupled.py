r"""Newton's method for the flow and the induction equation together.

The Jacobian of the flow with frozen heating and forces, A, is factorised. What the unknowns change through
the induction equation, B, is applied without being assembled: temperature to conductivity, one solution with
the factors of the induction equation, heating and forces to residual. Then

.. math:: (A + B)\,\delta = -R, \qquad (A + B) P\,y = -R,\; \delta = P y

with P the factors' A^-1. B A^-1 is compact (the field follows the conductivity smoothly), so that GMRES needs
a handful of iterations. A is applied itself: factors of single precision may change the number of
iterations, not what they converge to.

The solutions P y_k of the subspace are kept (flexible GMRES): their combination is the answer, without
another application of P, and P may change on the way.

Source: Saad, SIAM J. Sci. Comput. 14 (1993) 461, algorithm 2.2 (flexible GMRES); Knoll and Keyes, J. Comput.
Phys. 193 (2004) 357 (Jacobian-free Newton-Krylov with a block as preconditioner).
"""

import numpy as np

LARGEST_SUBSPACE = 20


def coupled_solution(block, rest, right_hand_side, tolerance):
    """Solve (A + B) x = b, of functions b -> P b and A P b, P near A^-1, and x -> B x.

    The residual relative to b is below the tolerance; after `LARGEST_SUBSPACE` iterations the best solution
    so far is returned: a step of Newton's method is not exact anyway. ArithmeticError if a product is not
    finite.
    """
    scale = np.linalg.norm(right_hand_side)
    if scale == 0:
        return np.zeros(len(right_hand_side))
    basis, solutions = [right_hand_side / scale], []
    hessenberg = np.zeros((LARGEST_SUBSPACE + 1, LARGEST_SUBSPACE))
    for k in range(LARGEST_SUBSPACE):
        solution, product = block(basis[k])
        solutions.append(solution)
        vector = product + rest(solution)
        for row, earlier in enumerate(basis):  # modified Gram-Schmidt
            hessenberg[row, k] = earlier @ vector
            vector -= hessenberg[row, k] * earlier
        hessenberg[k + 1, k] = np.linalg.norm(vector)
        if not np.isfinite(hessenberg[k + 1, k]):
            raise ArithmeticError(f"no finite product in iteration {k + 1} of GMRES")
        used, first = hessenberg[: k + 2, : k + 1], np.eye(k + 2)[0]
        weights = np.linalg.lstsq(used, first, rcond=None)[0]
        if np.linalg.norm(used @ weights - first) <= tolerance or hessenberg[k + 1, k] == 0:
            break
        basis.append(vector / hessenberg[k + 1, k])
    return scale * sum(weight * solution for weight, solution in zip(weights, solutions, strict=True))
