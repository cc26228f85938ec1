"""The most probable path and constants, their uncertainty, and how fast the temperature may bend."""

import dataclasses
from functools import reduce
from operator import add

import numpy as np

from plasmapyro import progress
from plasmapyro.estimate.banded import Factor, inner, solve_bordered
from plasmapyro.estimate.dynamics import GAS, RATE, SIZE, TEMPERATURE, ChainPrior, transition
from plasmapyro.estimate.observations import robust_sum

STEPS = 150  # Gauss-Newton steps allowed
HALVINGS = 12
TELLING = 1.0  # [s] span whose samples must tell the temperature by themselves
NO_RATE = 1e-3  # [K/s] below which a surface shines alike all the time
CONVERGED = 1e-3  # fall of half the sum of squares in a whole step that ends the iteration
SEARCH = {"maxfev": 70, "xatol": 0.05, "fatol": 0.2}
FITTED = ("quiet", "bending", "memory", "kick")
LIMITS = ((1e-4, 1e3), (1e-3, 1e5), (1.0, 200.0), (0.1, 1e3))  # of these


@dataclasses.dataclass(frozen=True)
class Chain:
    """The axis of the path, its switches, and the distribution of its first state."""

    time: np.ndarray
    switches: tuple
    injection_time: float
    first: np.ndarray  # (4,)
    first_covariance: np.ndarray  # (4, 4)

    def prior(self, dynamics):
        """Prior of the path under given dynamics."""
        moved = transition(dynamics, self.time, self.switches, self.injection_time)
        return ChainPrior(*moved, self.first, self.first_covariance)


@dataclasses.dataclass(frozen=True)
class Fit:
    """Path (n, 4) and constants (p,), under dynamics of the largest likelihood."""

    path: np.ndarray
    values: np.ndarray
    dynamics: object
    steps: int
    converged: bool


@dataclasses.dataclass(frozen=True)
class Spread:
    """Uncertainty of a fit."""

    path: np.ndarray  # (n, 4, 4) covariance of each state, the constants marginalised
    constants: np.ndarray  # (p, p) covariance
    across: np.ndarray  # (n, p) covariance of each temperature with the constants
    alone: np.ndarray  # (n,) [K] standard, of a temperature from the samples about it by themselves
    last: np.ndarray  # (4 + p, 4 + p) covariance of the last state and the constants


def fit(chain, observations, prior_constants, dynamics, path, values, rounds):
    """`Fit` of the largest posterior density, with dynamics of the largest likelihood.

    Gauss-Newton steps, halved until the objective falls; between rounds the four numbers that say how
    fast the temperature bends are fitted by the marginal likelihood of the linearised problem.

    Parameters
    ----------
    chain : Chain
    observations : list of PyrometerData, SpectrometerData
    prior_constants : Constants
    dynamics : Dynamics
        Where the search starts; only those `FITTED` are.
    path : (n, 4) array
    values : (p,) array
    rounds : int
        Alternations of path and dynamics.
    """
    steps = 0
    for turn in range(rounds):
        progress.step("joint estimate, round", turn + 1, rounds + 1, f"{steps} Gauss-Newton steps")
        path, values, _, used = _descend(chain, observations, prior_constants, dynamics, path, values)
        steps += used
        dynamics = fitted_dynamics(chain, observations, prior_constants, dynamics, path, values)
    path, values, done, used = _descend(chain, observations, prior_constants, dynamics, path, values)
    return Fit(path, values, dynamics, steps + used, done)


def misfit(chain, observations, prior_constants, found):
    """What a fit makes least: half the sum of squares of data and priors."""
    return _objective(chain.prior(found.dynamics), observations, prior_constants, found.path, found.values)


def cost(chain, observations, prior_constants, found):
    """Minus the logarithm of the marginal density of the data at a fit (Laplace), but for a constant."""
    prior = chain.prior(found.dynamics)
    factor, gathered, _ = _normal_equations(prior, observations, prior_constants, found.path, found.values)
    border = gathered.border.reshape(-1, found.values.size)
    corner = gathered.corner + np.diag(prior_constants.deviation**-2.0) - inner(border, factor.solve(border))
    determinants = factor.log_determinant() + np.linalg.slogdet(corner)[1]
    return misfit(chain, observations, prior_constants, found) + 0.5 * determinants


def again(chain, observations, prior_constants, found):
    """The fit with other priors of its constants, dynamics as they are."""
    path, values = found.path, found.values
    path, values, done, used = _descend(chain, observations, prior_constants, found.dynamics, path, values)
    return Fit(path, values, found.dynamics, found.steps + used, found.converged and done)


def spread_of(chain, observations, prior_constants, found):
    """`Spread` of a fit, the problem linearised there."""
    count, size = len(found.path), len(found.values)
    prior = chain.prior(found.dynamics)
    factor, gathered, _ = _normal_equations(prior, observations, prior_constants, found.path, found.values)
    corner = gathered.corner + np.diag(prior_constants.deviation**-2.0)
    _, _, effect, covariance = solve_bordered(
        factor, gathered.border.reshape(count * SIZE, size), corner, np.zeros(count * SIZE), np.zeros(size)
    )
    effect = effect.reshape(count, SIZE, size)
    own = prior.spread(gathered.state_matrix)
    own = own + effect @ covariance @ np.swapaxes(effect, 1, 2)
    told = _told(gathered, own[:, GAS, GAS] + found.dynamics.flicker**2)
    signal, slope, _ = observations[0].table(found.path[:, TEMPERATURE])
    fold = np.mean(signal / slope, axis=1)
    half = np.minimum(fold / np.maximum(np.abs(found.path[:, RATE]), NO_RATE), TELLING / 2)
    # How the ratio wanders from second to second is told by the continuity of the path itself.
    free, wander = covariance.copy(), prior_constants.where("ratio_wander")
    free[wander], free[:, wander] = 0.0, 0.0
    free[wander, wander] = prior_constants.deviation[wander] ** 2
    alone = _alone(chain.time, *told, free, fold, half)
    across = -effect[-1] @ covariance
    last = np.block([[own[-1], across], [across.T, covariance]])
    return Spread(own, covariance, -effect[:, TEMPERATURE] @ covariance, alone, last)


def _told(gathered, gas_variance):
    """Information (n,) of each sample on its temperature, (n,) its pull on the path, and (n, p) how much of
    it the constants move, the gas marginalised with its variance."""
    matrix = gathered.state_matrix
    by_gas = matrix[:, TEMPERATURE, GAS] / (matrix[:, GAS, GAS] + 1 / gas_variance)

    def without_gas(rows):
        return rows[:, TEMPERATURE] - (by_gas * rows[:, GAS].T).T

    own = matrix[:, TEMPERATURE, TEMPERATURE] - by_gas * matrix[:, TEMPERATURE, GAS]
    return own, without_gas(gathered.state_gradient), without_gas(gathered.border)


def _alone(time, information, pull, leaning, covariance, fold, half):
    r"""Standard uncertainty (n,) [K] of temperatures without the continuity of the path.

    .. math:: u^2 = \frac{1}{d^2}\left(\frac{1}{I} + \frac{b^T C\,b}{I^2}\right) + (T_e \ln d)^2, \qquad
              d = 1 - \frac{g}{I T_e}

    Sums I of the information, g of the pull on the path and b of what the constants move run over the
    samples within `half` (n,) [s], in which the surface shines nearly alike; C is the covariance of the
    constants. By themselves these samples see d times the light of the path, which T_e, `fold` (n,) [K],
    multiplies by e; where that is less, a kelvin makes less of it. Infinite where they see none.
    """
    first = np.searchsorted(time, time - half)
    last = np.searchsorted(time, time + half, side="right")
    rows = np.column_stack([information, pull, leaning])
    total = np.concatenate([np.zeros((1, rows.shape[1])), np.cumsum(rows, axis=0)])
    around = total[last] - total[first]
    told, pulled, moved = around[:, 0], around[:, 1], around[:, 2:]
    told = np.where(told > 0, told, np.nan)
    dim = 1 - pulled / told / fold
    dim = np.where(dim > 0, dim, np.nan)
    variance = 1 / told + np.sum(moved @ covariance * moved, axis=1) / told**2
    variance = variance / np.minimum(dim, 1.0) ** 2 + (fold * np.log(dim)) ** 2
    return np.sqrt(np.nan_to_num(variance, nan=np.inf))


def _gather(observations, prior_constants, path, values):
    return reduce(add, (one.information(path, values, prior_constants.where) for one in observations))


def _normal_equations(prior, observations, prior_constants, path, values):
    gathered = _gather(observations, prior_constants, path, values)
    diagonal, below = prior.blocks()
    return Factor(diagonal + gathered.state_matrix, below), gathered, prior.value_and_gradient(path)


def _objective(prior, observations, prior_constants, path, values):
    where = prior_constants.where
    data = sum(robust_sum(one.residual(path, values, where)) for one in observations)
    pull = (values - prior_constants.mean) / prior_constants.deviation
    return data + prior.value_and_gradient(path)[0] + 0.5 * pull @ pull


def _descend(chain, observations, prior_constants, dynamics, path, values):
    """Gauss-Newton with halved steps: the objective never rises."""
    prior = chain.prior(dynamics)
    count, size = len(path), len(values)
    precision = prior_constants.deviation**-2.0
    now = _objective(prior, observations, prior_constants, path, values)
    for step in range(STEPS):
        factor, gathered, (_, slope) = _normal_equations(prior, observations, prior_constants, path, values)
        move, change, *_ = solve_bordered(
            factor,
            gathered.border.reshape(count * SIZE, size),
            gathered.corner + np.diag(precision),
            -(gathered.state_gradient + slope).ravel(),
            -(gathered.constant_gradient + precision * (values - prior_constants.mean)),
        )
        move, length = move.reshape(count, SIZE), 1.0
        for _ in range(HALVINGS):
            trial = path + length * move, values + length * change
            trial[0][:, TEMPERATURE] = np.clip(trial[0][:, TEMPERATURE], *observations[0].table.temperatures)
            then = _objective(prior, observations, prior_constants, *trial)
            if then <= now:
                break
            length /= 2
        else:
            return path, values, True, step + 1
        (path, values), fall, now = trial, now - then, then
        if fall < CONVERGED and length == 1.0:  # a shortened step falls little wherever it stands
            return path, values, True, step + 1
    return path, values, False, STEPS


def fitted_dynamics(chain, observations, prior_constants, dynamics, path, values):
    r"""Dynamics of the largest marginal likelihood, the problem linearised at a path.

    .. math:: -2\ln p(y \mid q) = 2J_0 - b^T A^{-1} b + \ln\det A + \sum_k \ln\det Q_k

    with the constants held at their present values. A prior of the path that is broader than the data ask
    for prefers hot paths, on which a kelvin makes less of a signal, and so pulls level and emittance.
    """
    from scipy.optimize import minimize

    gathered = _gather(observations, prior_constants, path, values)
    low, high = np.log(np.array(LIMITS)).T

    def with_parameters(logarithms):
        held = np.exp(np.clip(logarithms, low, high))
        return dataclasses.replace(dynamics, **dict(zip(FITTED, held, strict=True)))

    def misfit(logarithms):
        prior = chain.prior(with_parameters(logarithms))
        diagonal, below = prior.blocks()
        value, slope = prior.value_and_gradient(path)
        factor = Factor(diagonal + gathered.state_matrix, below)
        right = (gathered.state_gradient + slope).ravel()
        penalty = np.sum((logarithms - np.clip(logarithms, low, high)) ** 2) * 1e3
        return (
            2 * value
            - right @ factor.solve(right)
            + factor.log_determinant()
            + prior.log_determinant
            + penalty
        )

    start = np.log([getattr(dynamics, name) for name in FITTED])
    simplex = np.vstack([start, start + np.diag([1.5, 1.5, 0.7, -1.5])])
    found = minimize(misfit, start, method="Nelder-Mead", options=SEARCH | {"initial_simplex": simplex})
    return with_parameters(found.x)
