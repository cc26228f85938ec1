"""How the surface temperature and the gas may change between two samples: the prior of the chain."""

import dataclasses

import numpy as np

# One state: temperature [K], its rate [K/s], gas amplitude less 1 (slow), its flicker.
TEMPERATURE, RATE, GAS, FLICKER = range(4)
SIZE = 4
SETTING_IN = 3.0  # [s] tau_k: over which the heat of a switch may set in


@dataclasses.dataclass(frozen=True)
class Dynamics:
    """Variances of the random changes. After a switch of the heat the temperature bends more than later."""

    quiet: float  # [K2 s-3] variance of the rate per second, long after a switch
    bending: float  # [K2 s-3] in addition, right after injection and the end of the plasma
    memory: float  # [s] over which that fades
    kick: float  # [K/s] standard deviation of the change of the rate at a switch, and of what follows it
    gas: float  # [s-1] variance of the gas amplitude per second
    gas_start: float  # [1] standard deviation of it right after injection, where it is 1 by definition
    flicker: float  # [1] standard deviation of the flicker
    flicker_time: float  # [s]
    start: float = 0.0  # [K] standard deviation of the change of the temperature at injection


def transition(dynamics, time, switches, injection_time):
    r"""Transition matrices and covariances from each sample to the next.

    .. math:: q = q_\infty + q_0 e^{-(t - t_s)/\tau} + \frac{k^2}{t - t_s} e^{-(t - t_s)/\tau_k}, \qquad
              Q_{T\dot T} = q\begin{pmatrix}\Delta^3/3 & \Delta^2/2\\ \Delta^2/2 & \Delta\end{pmatrix}

    Parameters
    ----------
    dynamics : Dynamics
    time : (n,) array [s], strictly increasing
    switches : floats [s]
        When the heat flux changes suddenly.
    injection_time : float [s]

    Returns
    -------
    matrix, covariance : (n - 1, 4, 4) ndarrays

    Notes
    -----
    The term of the kick k has no scale of time up to :math:`\tau_k`: a heat flux that sets in at once or
    within a second, and any power of time are as likely. Integrated Wiener process for the temperature
    (a cubic smoothing spline in the limit: Wahba, J. R. Stat. Soc. B 40, 364 (1978)), random walk for the
    gas, Ornstein-Uhlenbeck process for its flicker.
    """
    step = np.diff(time)
    middle = time[:-1] + step / 2
    level = np.full(step.size, dynamics.quiet)
    matrix, covariance = np.zeros((2, step.size, SIZE, SIZE))
    for moment in switches:
        after = middle >= moment
        since = middle[after] - moment
        level[after] += dynamics.bending * np.exp(-since / dynamics.memory)
        after = time[:-1] >= moment  # in the step of the switch itself the kick stands below
        since = middle[after] - moment
        level[after] += dynamics.kick**2 / since * np.exp(-since / SETTING_IN)
        for k in np.flatnonzero((time[:-1] < moment) & (time[1:] >= moment)):
            kicked = np.array([time[k + 1] - moment, 1.0])  # of temperature and rate at the next sample
            covariance[k, : RATE + 1, : RATE + 1] += dynamics.kick**2 * np.outer(kicked, kicked)
    memory = np.exp(-step / dynamics.flicker_time)
    matrix[:] = np.eye(SIZE)
    matrix[:, TEMPERATURE, RATE] = step
    matrix[:, FLICKER, FLICKER] = memory
    covariance[:, TEMPERATURE, TEMPERATURE] += level * step**3 / 3
    covariance[:, TEMPERATURE, RATE] += level * step**2 / 2
    covariance[:, RATE, TEMPERATURE] += level * step**2 / 2
    covariance[:, RATE, RATE] += level * step
    covariance[:, GAS, GAS] = dynamics.gas * step
    jump = (time[:-1] < injection_time) & (time[1:] >= injection_time)
    # The probe changes the jet: what the gas was before says nothing of its level after.
    matrix[jump, GAS, GAS] = 0.0
    covariance[jump, GAS, GAS] = dynamics.gas_start**2
    covariance[jump, TEMPERATURE, TEMPERATURE] += dynamics.start**2
    covariance[:, FLICKER, FLICKER] = dynamics.flicker**2 * (1 - memory**2)
    return matrix, covariance


class ChainPrior:
    """Quadratic form of the chain: its blocks, its value and its gradient at a path."""

    def __init__(self, matrix, covariance, first, first_covariance):
        self._matrix, self._first = matrix, first
        self._covariance, self._first_covariance = covariance, first_covariance
        self._weight = np.linalg.inv(covariance)
        self._first_weight = np.linalg.inv(first_covariance)
        self.log_determinant = np.linalg.slogdet(covariance)[1].sum() + np.linalg.slogdet(first_covariance)[1]

    def blocks(self):
        """Diagonal (n, 4, 4) and lower (n - 1, 4, 4) blocks of the precision matrix."""
        back = np.swapaxes(self._matrix, 1, 2) @ self._weight
        diagonal = np.zeros((len(self._matrix) + 1, SIZE, SIZE))
        diagonal[0] = self._first_weight
        diagonal[:-1] += back @ self._matrix
        diagonal[1:] += self._weight
        return diagonal, -np.swapaxes(back, 1, 2)

    def value_and_gradient(self, path):
        """Half the quadratic form at a path (n, 4), and its gradient (n, 4)."""
        change = path[1:] - np.einsum("kij,kj->ki", self._matrix, path[:-1])
        weighted = np.einsum("kij,kj->ki", self._weight, change)
        start = self._first_weight @ (path[0] - self._first)
        gradient = np.zeros_like(path)
        gradient[0] = start
        gradient[1:] += weighted
        gradient[:-1] -= np.einsum("kji,kj->ki", self._matrix, weighted)
        return 0.5 * (np.sum(change * weighted) + (path[0] - self._first) @ start), gradient

    def spread(self, information):
        r"""Covariances (n, 4, 4) of the states, each given all the data.

        .. math:: S_k = (1 + L_k^T P_k L_k)^{-1}, \quad C_k = 1 - P_k L_k S_k L_k^T, \quad
                  P_{k+1} = F_k C_k P_k F_k^T + Q_k

        .. math:: \Lambda_k = L_k S_k L_k^T + C_k^T F_k^T \Lambda_{k+1} F_k C_k, \qquad
                  \Sigma_k = P_k - P_k \Lambda_k P_k

        with :math:`L_k L_k^T`, `information` (n, 4, 4): what the data of each sample add.

        Source: Bierman, Automatica 9, 503 (1973), modified Bryson-Frazier smoother. In covariances, not in
        their inverses: what is nearly fixed from sample to sample has an inverse too large to hold the rest.
        """
        unit = np.sqrt(np.maximum(np.diagonal(information, axis1=1, axis2=2), np.finfo(float).tiny))
        value, vector = np.linalg.eigh(information / (unit[:, :, None] * unit[:, None, :]))
        root = unit[:, :, None] * vector * np.sqrt(np.maximum(value, 0.0))[:, None, :]
        predicted, kept, gained = (np.empty_like(information) for _ in range(3))
        now, one, steps = self._first_covariance, np.eye(SIZE), len(self._matrix)
        for k, own in enumerate(root):
            seen = now @ own
            gained[k] = own @ np.linalg.solve(one + own.T @ seen, own.T)
            predicted[k], kept[k] = now, one - now @ gained[k]
            if k < steps:
                now = self._matrix[k] @ kept[k] @ now @ self._matrix[k].T + self._covariance[k]
                now = (now + now.T) / 2
        later = np.zeros((SIZE, SIZE))
        for k in range(steps, -1, -1):
            if k < steps:
                moved = self._matrix[k] @ kept[k]
                later = moved.T @ later @ moved
            later = gained[k] + later
            predicted[k] -= predicted[k] @ later @ predicted[k]
        return predicted
