"""What an extension is worth on data that the fit has not seen."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from plasmapyro.diagnosis.inference import free_numbers, gram, own_patterns, prior_of_patterns

BLOCKS = (  # [s] after injection
    (-20.0, -1.0),
    (3.0, 9.0),
    (12.0, 18.0),
    (24.0, 32.0),
    (40.0, 52.0),
    (64.0, 84.0),
    (108.0, 140.0),
    (180.0, 220.0),
    (252.0, 290.0),
)
AFTER_BLOCKS = ((2.0, 6.0), (10.0, 18.0), (22.0, 40.0))  # [s] after the end of the plasma
ENOUGH = 3.0  # log score by which held-out data must improve: odds of 20
CALIBRATED = ("ratio", "lamp")  # parameters of the base model that the calibration measured


@dataclass(frozen=True)
class Gain:
    """Log score of held-out blocks, and of the held-out calibration, with terms less without them."""

    blocks: tuple  # (start, end, difference)
    calibration: float
    total: float
    standard_error: float
    cross_instrument: float | None

    @property
    def improves(self):
        """Whether held-out data speak for the terms by more than `ENOUGH`.

        The standard error, from the scatter of the blocks, is reported, not asked for: a term that acts in
        one
        phase gains in few blocks, and the scatter is then as large as the gain.
        """
        return self.total > ENOUGH


def blocks_of(off):
    """Blocks (start, end) [s] that are held out, one at a time."""
    return tuple(block for block in BLOCKS if block[1] < off) + tuple(
        (off + a, off + b) for a, b in AFTER_BLOCKS
    )


def normal_matrix(solution):
    """The matrix whose Cholesky factor a solution holds."""
    root = np.triu(solution.factor[0])
    return root.T @ root


def log_score(model, solution, chosen, matrix=None):
    r"""Log density of some bins given all others, linearised about the fit.

    .. math:: \ln p(y_b | y_{-b}) = -\tfrac12\left[ r'^T (\Sigma_b + J_b M^{-1} J_b^T)^{-1} r'
              + \ln\det(\Sigma_b + J_b M^{-1} J_b^T)\right], \qquad M = A - A_b

    with the residuals :math:`r'` of the fit without the block; :math:`\ln\det\Sigma_b`, the same for all
    models, is
    left out.

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
        for place, row in own_patterns(model.instruments, solution.plain, solution.gas)
    ]
    block, vector = gram(columns, patterns, weighers, residuals)
    chi2 = sum(float(np.sum(r * w(r))) for r, w in zip(residuals, weighers, strict=True))
    return _held_out(solution, block, vector, chi2, matrix)


def calibration_score(model, solution, matrix=None):
    """Log density of what the calibrations say given the data of the test, as `log_score`.

    The calibrations are measurements like any other: ratio of the bands, source, error of each channel.
    A term that acts as a wrong calibration would, all test long, shows nowhere else.
    """
    size, count = model.size, len(model.parameters)
    total = solution.factor[0].shape[0]
    weight, off = np.zeros(total), np.zeros(total)
    for name in CALIBRATED:
        parameter, place = model.parameters[model.index[name]], model.index[name]
        weight[size + place] = parameter.sigma**-2.0
        off[size + place] = parameter.centre - solution.state.values[place]
    place = size + count + len(free_numbers(solution.settings))
    prior = prior_of_patterns(model.instruments)
    for one, pattern in zip(model.instruments, solution.state.pattern, strict=True):
        if one.pattern.any():
            own = slice(place, place + one.channels)
            weight[own], off[own] = prior[: one.channels], -pattern
            prior, place = prior[3 * one.channels :], place + 3 * one.channels
    return _held_out(solution, np.diag(weight), weight * off, float(weight @ off**2), matrix)


def _held_out(solution, block, vector, chi2, matrix=None):
    """Log density of a part of the data with the normal matrix, pull and chi-squared it brings to the fit."""
    matrix = normal_matrix(solution) if matrix is None else matrix
    rest = cho_factor(matrix - block + 1e-12 * np.diag(np.diag(matrix)))
    # The whole fit balances: without the block its pull is missing, and the parameters move by -M^-1 g_b.
    moved = -cho_solve(rest, vector)
    # r' = r - J_b moved; its weighted square and its projection on J_b
    chi2 = chi2 - 2 * moved @ vector + moved @ block @ moved
    pull = vector - block @ moved
    quadratic = chi2 - pull @ cho_solve(solution.factor, pull)
    log_determinant = 2 * (
        np.sum(np.log(np.abs(np.diag(solution.factor[0])))) - np.sum(np.log(np.abs(np.diag(rest[0]))))
    )
    return -0.5 * (quadratic + log_determinant)


def cross_condition(extended, base, other, size, other_size):
    r"""Log score of another test with the terms as one test found them, less that without them.

    .. math:: \ln\frac{p(y' | y)}{p(y' | \mathrm{base})} = -\tfrac12\left[D(a) - \chi^2_0
              + \ln\det(1 + C\Lambda) - g^T C (1 + \Lambda C)^{-1} g\right]

    with the numbers a of the terms and their covariance C from the first test; the objective D of the second
    test there, its gradient 2g and curvature :math:`2\Lambda`, from a fit of the same terms to it without the
    priors of the terms; and its objective :math:`\chi^2_0` without terms.

    Parameters
    ----------
    extended : Solution of the first test, with terms
    base, other : Solution of the second test without terms, and with those of the first
    size, other_size : numbers that come before those of the terms in their covariances

    Returns
    -------
    float

    Notes
    -----
    Source: Laplace's approximation; Gaussian integral over the numbers of the terms.
    """
    there = np.linalg.inv(other.covariance[other_size:, other_size:])
    prior = np.diag([number[3] ** -2.0 for number in free_numbers(other.settings)])
    centre = np.array([number[2] for number in free_numbers(other.settings)])
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

    times = [one.moment.mean(axis=1) for one in model.instruments]
    for start, end in blocks_of(model.off):
        chosen = [(time >= start) & (time < end) for time in times]
        if not any(part.any() for part in chosen):
            continue
        found.append((start, end, difference(log_score, chosen)))
    values = np.array([row[2] for row in found])
    spread = float(np.std(values, ddof=1) * np.sqrt(values.size)) if values.size > 1 else float("inf")
    cross = None
    if len(model.instruments) == 2:
        chosen = [
            np.full(time.size, one.kind == "pyrometer")
            for time, one in zip(times, model.instruments, strict=True)
        ]
        cross = difference(log_score, chosen)
    calibration = difference(calibration_score)
    return Gain(tuple(found), calibration, float(values.sum()) + calibration, spread, cross)
