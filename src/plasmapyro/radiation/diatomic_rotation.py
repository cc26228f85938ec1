"""Rotation and spin of diatomic states between Hund's cases (a) and (b), and the strengths of their lines."""

from dataclasses import dataclass

import numpy as np

FORBIDDEN = 1e12  # [m-1], energy given to basis functions with |Omega| > J, which do not exist


@dataclass(frozen=True)
class ElectronicState:
    """Symmetry and fine structure of an electronic state.

    Parameters
    ----------
    orbital : int
        Lambda, >= 0.
    spin : float [1]
        S.
    reflection : int
        +1 or -1 for Sigma+ or Sigma-; not used when Lambda > 0.
    inversion : str
        'g' or 'u' for two equal nuclei, '' for different nuclei.
    spin_orbit, spin_spin : float [m-1]
        A and lambda.
    """

    orbital: int
    spin: float
    reflection: int
    inversion: str
    spin_orbit: float = 0.0
    spin_spin: float = 0.0

    @property
    def projection(self):
        """Sigma of the basis functions, -S ... S, (2S + 1,)."""
        return np.arange(2 * self.spin + 1) - self.spin

    @property
    def multiplicity(self):
        """2S + 1."""
        return round(2 * self.spin + 1)


@dataclass(frozen=True)
class Levels:
    """Rotational levels of one electronic state; F counts the 2S + 1 components of a J.

    Parameters
    ----------
    state : ElectronicState
    quantum_number : (J,) [1]
        J, in steps of one.
    energy : (v, J, F) [m-1]
    vector : (v, J, Sigma, F) [1]
        Mixing of the case (a) functions with Lambda >= 0.
    exists : (v, J, F) bool
        Level is physical (enough ``|Omega| <= J``) and bound.
    """

    state: ElectronicState
    quantum_number: np.ndarray
    energy: np.ndarray
    vector: np.ndarray
    exists: np.ndarray


def rotational_levels(state, quantum_number, term, bound):
    r"""`Levels` of one electronic state from its rotationless-spin terms, exact in :math:`N^2`.

    .. math::

        H = E_v(\hat N^2) + A\,\hat L_z \hat S_z + \tfrac23 \lambda (3 \hat S_z^2 - \hat S^2),
        \qquad \hat N = \hat J - \hat S, \\
        \langle\Sigma|\hat N^2|\Sigma\rangle = J(J+1) + S(S+1) - 2 \Omega \Sigma, \\
        \langle\Sigma + 1|\hat N^2|\Sigma\rangle =
            -\sqrt{[J(J+1) - \Omega(\Omega+1)][S(S+1) - \Sigma(\Sigma+1)]}

    :math:`\hat N^2` has only the eigenvalues N(N+1), N = J-S ... J+S, so the polynomial through
    :math:`E_v` at those N is the operator function itself.

    Source: J. T. Hougen, The Calculation of Rotational Energy Levels and Rotational Line Intensities in
    Diatomic Molecules, NBS Monograph 115 (1970), sections 2.1 and 4. No offset :math:`-\Lambda^2` goes
    with :math:`\hat N^2`: the term values of Laher & Gilmore (1991) contain it.
    ASSUME: no Lambda doubling (below 1 cm-1) and no spin-rotation interaction (0.003 N cm-1 in N2 A).

    Parameters
    ----------
    state : ElectronicState
    quantum_number : (J,) [1]
        J >= 0, integer or half-integer as S.
    term : (v, N) [m-1]
        :math:`E_v(N)` for N = 0, 1, ... up to max(J) + S at least.
    bound : (v, N) bool
        Whether that level is bound.
    """
    momentum = np.asarray(quantum_number, dtype=float)
    sigma, spin = state.projection, state.spin
    omega = state.orbital + sigma
    square = (momentum * (momentum + 1))[:, None]
    diagonal = square + spin * (spin + 1) - 2 * omega * sigma
    raising = np.maximum(square - omega[:-1] * (omega[:-1] + 1), 0.0)
    coupling = -np.sqrt(raising * (spin * (spin + 1) - sigma[:-1] * (sigma[:-1] + 1)))
    size = state.multiplicity
    index = np.arange(size)
    rotation = np.zeros((len(momentum), size, size))
    rotation[:, index, index] = diagonal
    rotation[:, index[1:], index[:-1]] = rotation[:, index[:-1], index[1:]] = coupling

    node = np.rint(np.maximum(momentum - spin, 0.0)).astype(int)[:, None] + index
    hamiltonian = _operator_function(rotation, (node * (node + 1)).astype(float), term[:, node])
    fine = state.spin_orbit * state.orbital * sigma
    fine = fine + state.spin_spin * (2 * sigma**2 - 2 / 3 * spin * (spin + 1))
    missing = np.abs(omega) > momentum[:, None]
    hamiltonian[..., index, index] += fine + FORBIDDEN * missing
    energy, vector = np.linalg.eigh(hamiltonian)
    exists = bound[:, node].all(axis=2)[..., None] & (energy < FORBIDDEN / 2)
    return Levels(state, momentum, energy, vector, exists)


def _operator_function(matrix, node, value):
    """Newton polynomial through (node, value) of a matrix: (J, S, S), (J, S), (v, J, S) -> (v, J, S, S)."""
    size = matrix.shape[-1]
    difference = value.copy()
    result = np.zeros((*value.shape[:2], size, size))
    product = np.broadcast_to(np.eye(size), matrix.shape)
    for order in range(size):
        result += difference[..., 0, None, None] * product
        product = product @ (matrix - node[:, order, None, None] * np.eye(size))
        if order + 1 < size:
            spacing = node[:, order + 1 :] - node[:, : size - order - 1]
            difference = (difference[..., 1:] - difference[..., :-1]) / spacing
    return result


def parity(levels):
    r"""Total parity (v, J, F), +1 or -1, of the levels of a Sigma state.

    .. math:: \sigma_v |\Sigma; J\rangle = \pm (-1)^{J - S} |-\Sigma; J\rangle

    with the upper sign for :math:`\Sigma^+`. Source: H. Lefebvre-Brion, R. W. Field, The Spectra and Dynamics
    of Diatomic Molecules (2004), eq. 3.2.86; the factor (-1)^(2 Sigma) is the same for all functions of a
    state.
    """
    mirrored = (levels.vector * levels.vector[:, :, ::-1, :]).sum(axis=2)
    sign = levels.state.reflection * (-1.0) ** np.rint(levels.quantum_number - levels.state.spin)
    return np.rint(mirrored) * sign[:, None]


def clebsch_gordan(lower, step, projection, component):
    r"""Clebsch-Gordan coefficient [1] of one photon and a rotating molecule.

    .. math:: \langle J''\,\Omega''\;1\,q | J'\,\Omega'\rangle, \qquad \Omega'' = \Omega' - q

    with `lower` J'', `step` J' - J'' and `component` q among -1, 0, 1, `projection` Omega'; 0 where a
    projection exceeds its J. Source: E. U. Condon, G. H. Shortley, The Theory of Atomic Spectra (1935), table
    2 of chapter III.
    """
    j, m = np.broadcast_arrays(np.asarray(lower, dtype=float), np.asarray(projection, dtype=float))
    allowed = (np.abs(m) <= j + step) & (np.abs(m - component) <= j) & (j + step >= 0)
    if step <= 0:
        allowed &= j > 0
    safe = np.where(j > 0, j, 1.0)
    # (numerator under the root, denominator, sign)
    if component == 0:
        parts = {
            1: ((j - m + 1) * (j + m + 1), (2 * j + 1) * (j + 1), 1.0),
            0: (m**2, safe * (safe + 1), np.sign(m)),
            -1: ((j - m) * (j + m), safe * (2 * safe + 1), -1.0),
        }
    else:
        n = component * m
        parts = {
            1: ((j + n) * (j + n + 1), (2 * j + 1) * (2 * j + 2), 1.0),
            0: ((j + n) * (j - n + 1), 2 * safe * (safe + 1), -float(component)),
            -1: ((j - n) * (j - n + 1), 2 * safe * (2 * safe + 1), 1.0),
        }
    numerator, denominator, sign = parts[step]
    return np.where(allowed, sign * np.sqrt(np.where(allowed, numerator / denominator, 0.0)), 0.0)
