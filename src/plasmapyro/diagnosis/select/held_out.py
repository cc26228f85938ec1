"""What an extension is worth on data that the fit has not seen."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from plasmapyro.diagnosis.fit.normal import gram, own_patterns, pattern_sigmas
from plasmapyro.diagnosis.fit.setting import free_numbers
from plasmapyro.record.phases import afterwards, during

BLOCKS = (  # shares of the exposure: dense where the sample heats
    (0.01, 0.03),
    (0.04, 0.06),
    (0.08, 0.107),
    (0.107, 0.133),
    (0.133, 0.173),
    (0.173, 0.213),
    (0.213, 0.28),
    (0.28, 0.36),
    (0.36, 0.467),
    (0.467, 0.6),
    (0.6, 0.733),
    (0.733, 0.84),
    (0.84, 0.967),
)
AFTER_BLOCKS = ((0.02, 0.06), (0.1, 0.18), (0.22, 0.4))  # shares of the cooling
ENOUGH = 3.0  # log score by which held-out data must improve: odds of 20
SURE = 3.0  # standard errors of it
MOMENT = 0.6  # [1], of a gain: from one block, it speaks for something that happened then
CALIBRATED = ("ratio", "lamp")  # parameters of the base model that the calibration measured


@dataclass(frozen=True)
class Gain:
    """Log score of held-out blocks, and of the held-out calibration, with effects less without them."""

    blocks: tuple  # (start, end, difference)
    calibration: float
    total: float
    standard_error: float
    cross_instrument: float | None

    @property
    def improves(self):
        """Whether held-out data speak for the effects by more than `ENOUGH` and `SURE` standard errors."""
        return self.total > max(ENOUGH, SURE * self.standard_error)

    @property
    def of_a_moment(self):
        """Whether one block alone gives nearly all of the gain: most causes act throughout a phase."""
        scores = [score for *_, score in self.blocks]
        return len(scores) > 1 and max(scores) > MOMENT * self.total

    @property
    def silent(self):
        """Whether held-out data speak against the effects: no name stands on that."""
        return self.total < 0


def blocks_of(start, off, end):
    """Blocks (start, end) [s] that are held out, one at a time: what precedes the injection, parts of the
    exposure and of the cooling.

    Parameters
    ----------
    start, off, end : float [s] from the injection
        Of the record, and the end of the plasma.
    """
    rows = np.concatenate([during(BLOCKS, off), afterwards(AFTER_BLOCKS, off, end)])
    # In halves: the gas before the injection is known from nothing but the other half.
    before = [(start, start / 2), (start / 2, 0.0)] if start < 0 else []
    return [*before, *((float(a), float(b)) for a, b in rows if a < end and b > a)]


def normal_matrix(solution):
    """The matrix whose Cholesky factor a solution holds."""
    root = np.triu(solution.factor[0])
    return root.T @ root


def log_score(model, solution, chosen, matrix=None):
    r"""Log density of some bins given all others, linearised about the fit.

    .. math:: \ln p(y_b | y_{-b}) = -\tfrac12\left[ r'^T (\Sigma_b + J_b M^{-1} J_b^T)^{-1} r'
              + \ln\det(\Sigma_b + J_b M^{-1} J_b^T)\right], \qquad M = A - A_b

    with the residuals :math:`r'` of the fit without the block; :math:`\ln\det\Sigma_b`, the same for all
    models, is left out.

    Parameters
    ----------
    model : Model
    solution : Solution
    chosen : list per instrument of bool (n,)
    matrix : `normal_matrix` of the solution, optional

    Notes
    -----
    Source: Sherman-Morrison-Woodbury; A. Vehtari, A. Gelman & J. Gabry, Stat. Comput. 27 (2017) 1413.
    """
    columns = [c[s] for c, s in zip(solution.jacobian, chosen, strict=True)]
    residuals = [r[s] for r, s in zip(solution.residual, chosen, strict=True)]
    weighers = [w.of(s) for w, s in zip(solution.weighers, chosen, strict=True)]
    patterns = [
        (place, row[chosen[place]])
        for place, row in own_patterns(model.instruments, solution.plain, solution.gas_rows)
    ]
    block, vector = gram(columns, patterns, weighers, residuals)
    chi2 = sum(float(np.sum(r * w(r))) for r, w in zip(residuals, weighers, strict=True))
    return _held_out(solution, block, vector, chi2, matrix)


def calibration_score(model, solution, matrix=None):
    """Log density of what the calibrations say given the data of the test, as `log_score`.

    The calibrations are measurements like any other: ratio of the bands, source, error and dark of each
    channel.
    An effect that acts as a wrong calibration would, all test long, shows nowhere else.
    """
    size, count = model.size, len(model.parameters)
    total = solution.factor[0].shape[0]
    weight, off = np.zeros((total, total)), np.zeros(total)
    own = np.array([model.index[name] for name in CALIBRATED if name in model.index], dtype=int)
    weight[np.ix_(size + own, size + own)] = np.linalg.inv(np.linalg.inv(model.precision)[np.ix_(own, own)])
    off[size + own] = [model.parameters[place].centre - solution.state.values[place] for place in own]
    state, first = solution.state, size + count + len(free_numbers(solution.settings))
    # In the order of `own_patterns`; the errors of the gas are no calibration's.
    none = [None] * len(state.dark)
    found = zip(state.pattern, state.dark, none, none, strict=True)
    for instrument, values in zip(model.instruments, found, strict=True):
        for sigma, value in zip(pattern_sigmas(instrument), values, strict=True):
            if sigma.any():
                own = np.arange(first, first + sigma.size)
                if value is not None:
                    weight[own, own], off[own] = sigma**-2.0, -value
                first += sigma.size
    pull = weight @ off
    return _held_out(solution, weight, pull, float(off @ pull), matrix)


def _held_out(solution, block, vector, chi2, matrix=None):
    """Log density of a part of the data with the normal matrix, pull and chi-squared it brings to the fit."""
    matrix = normal_matrix(solution) if matrix is None else matrix
    rest = cho_factor(matrix - block + 1e-12 * np.diag(np.diag(matrix)))
    # Without the block its pull is missing, and the parameters move by M^-1 (g - g_b); what little g the fit
    # left weighs where the block alone holds a parameter.
    moved = cho_solve(rest, solution.score - vector)
    # r' = r - J_b moved; its weighted square and its projection on J_b
    chi2 = chi2 - 2 * moved @ vector + moved @ block @ moved
    pull = vector - block @ moved
    quadratic = chi2 - pull @ cho_solve(solution.factor, pull)
    log_determinant = 2 * (
        np.sum(np.log(np.abs(np.diag(solution.factor[0])))) - np.sum(np.log(np.abs(np.diag(rest[0]))))
    )
    return -0.5 * (quadratic + log_determinant)


def cross_condition(extended, base, other, size, other_size):
    r"""Log score of another test with the effects as one test found them, less that without them.

    .. math:: \ln\frac{p(y' | y)}{p(y' | \mathrm{base})} = -\tfrac12\left[D(a) - \chi^2_0
              + \ln\det(1 + C\Lambda) - g^T C (1 + \Lambda C)^{-1} g\right]

    with the numbers a of the effects and their covariance C from the first test; the objective D of the
    second test there, its gradient 2g and curvature :math:`2\Lambda`, from a fit of the same effects to it
    without their priors; and its objective :math:`\chi^2_0` without effects.

    Parameters
    ----------
    extended : Solution of the first test, with effects
    base, other : Solution of the second test without effects, and with those of the first
    size, other_size : numbers that come before those of the effects in their covariances

    Returns
    -------
    float

    Notes
    -----
    Source: Laplace's approximation; Gaussian integral over the numbers of the effects.
    """
    there = np.linalg.inv(other.covariance[other_size:, other_size:])
    prior = np.diag([number.sigma**-2.0 for number in free_numbers(other.settings)])
    centre = np.array([number.centre for number in free_numbers(other.settings)])
    covariance = extended.covariance[size:, size:]
    found, best = extended.state.amplitudes, other.state.amplitudes
    value = (
        other.objective
        + (found - best) @ there @ (found - best)
        - (found - centre) @ prior @ (found - centre)
    )
    gradient = there @ (found - best) - prior @ (found - centre)
    curvature = there - prior
    spread = np.eye(found.size) + curvature @ covariance
    _, log_determinant = np.linalg.slogdet(spread)
    eased = gradient @ covariance @ np.linalg.solve(spread, gradient)
    return float(-0.5 * (value - base.objective + log_determinant - eased))


def gain(model, base, extended):
    """Gain of the extended fit over the base fit.

    Parameters
    ----------
    model : Model
    base, extended : Solution
        Of the same data under the same noise.

    Returns
    -------
    Gain
    """
    found = []
    whole = [normal_matrix(solution) for solution in (extended, base)]

    def difference(function, *about):
        return float(function(model, extended, *about, whole[0]) - function(model, base, *about, whole[1]))

    times = [instrument.time for instrument in model.instruments]
    first, last = min(time.min() for time in times), max(time.max() for time in times)
    for start, end in blocks_of(first, model.off, last):
        chosen = [(time >= start) & (time < end) for time in times]
        if not any(part.any() for part in chosen):
            continue
        found.append((start, end, difference(log_score, chosen)))
    cross = None
    if len(model.instruments) == 2:
        chosen = [
            np.full(time.size, instrument.kind == "pyrometer")
            for time, instrument in zip(times, model.instruments, strict=True)
        ]
        cross = difference(log_score, chosen)
    calibration = difference(calibration_score)
    values = np.array([*(row[2] for row in found), calibration])
    return Gain(tuple(found), calibration, float(values.sum()), standard_error(values), cross)


def standard_error(values):
    r"""Standard error of the sum of differences (n,) of log scores.

    .. math:: s^2 = 2 \sum_b |D_b| + \left(\sum_{D_b < 0} D_b\right)^2

    The first is noise: two normal predictions d standard deviations apart have a log ratio of mean
    :math:`d^2/2` and variance :math:`d^2`. The second is an effect that is right in one phase and wrong in
    another. That blocks tell more or less of an effect is no error: they are not drawn alike.

    Notes
    -----
    Source: log ratio of normal densities, e.g. T. M. Cover & J. A. Thomas, Elements of Information Theory
    (2006), ch. 8 and 11.
    """
    against = np.minimum(values, 0.0).sum()
    return float(np.sqrt(2 * np.sum(np.abs(values)) + against**2))
