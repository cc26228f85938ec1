"""Least squares with priors and structured noise: the fit of a model, and what is left beside it."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from plasmapyro.diagnosis.fit.model import INITIAL_TEMPERATURE
from plasmapyro.diagnosis.fit.normal import gram, own_patterns, pattern_sigmas, prior_of_patterns, score
from plasmapyro.diagnosis.fit.setting import free_numbers, log_prior, numbers_of, with_numbers
from plasmapyro.diagnosis.fit.weights import Weigher

FAR_OFF = 0.5  # [1]; steps of the logarithm of the brightness of the gas beyond this are cut
FAR_SHAPE = 0.1  # [1], of half the range of a shape: light that comes late has a valley for each second
LARGEST = 0.08  # [1], relative step of a temperature
MOST_STEPS = 100  # in the valley of an emittance that ages and a deposit 25 are too few, of a cold surface 60
AT_BOUND = 1e-9  # of the range of a number, from its end
STIFF = 1e8  # times the information of a number that a bound holds
STEEPEST = 1e3  # [1], of the objective: what a step that climbs may lead to
CONVERGED = 0.02  # of the objective, in units of chi-squared
FIRST_DAMPING, LEAST_DAMPING = 1e-3, 1e-7  # [1] of the diagonal: below, a step is a whole one
DAMPINGS = 16  # that are tried, each four times the last: to a hundred times the diagonal
CREEP, CREPT = 10, 1.0  # steps, and what so many may still gain of the objective where all of them are done
PATIENCE = 4  # steps without gain: what a step gains, weights that follow the light may take back


@dataclass(frozen=True)
class State:
    """Where a fit stands: knots (K,), values (V,), and for each instrument the pattern and the dark (C,)."""

    knots: np.ndarray
    values: np.ndarray
    pattern: tuple
    dark: tuple
    lines: tuple  # relative error (C,) of the gas in each channel
    before: tuple  # and what the gas before the injection errs by besides (C,)
    amplitudes: np.ndarray  # (E,) numbers of the effects that are switched on, see `free_numbers`

    def error_of_gas(self, which):
        """Errors (2, C) of the gas of an instrument: at all times, and before the injection besides."""
        return np.stack([self.lines[which], self.before[which]])


@dataclass(frozen=True)
class Solution:
    """A converged fit: its state, objective, and the pieces that tests of further effects need."""

    state: State
    settings: tuple
    objective: float
    chi2: float
    count: int
    converged: bool
    covariance: np.ndarray  # of knots, values, amplitudes
    prediction: tuple
    plain: tuple  # prediction without the patterns of the channels
    gas: tuple
    gas_rows: tuple  # (2, n, C) per instrument: changes by errors of its gas of 1, see `Fitter.gas_rows`
    residual: tuple
    factor: tuple  # Cholesky factor of the normal matrix of everything fitted
    score: np.ndarray  # of everything fitted, priors included: 0 but for what the last step left
    jacobian: tuple  # (n, C, K + V + E) per instrument
    weighers: tuple


def _at_bounds(state, settings):
    """Whether each free number of the settings (E,) lies at one of its bounds."""
    free = zip(state.amplitudes, free_numbers(settings), strict=True)
    return np.array([one.at_end(number, AT_BOUND) for number, one in free], dtype=bool)


@dataclass(frozen=True)
class _Place:
    """Predictions, slopes and light of the gas at a state, and what they make of the data."""

    predicted: list
    columns: list
    gas: list
    rows: list  # of the errors of the gas
    weighers: tuple
    chi2: float
    objective: float


class Fitter:
    """Fits a model, with any effects, to the data under one noise."""

    def __init__(self, model, noise, measured=None):
        self.model, self.noise = model, noise
        self.measured = measured or [instrument.value for instrument in model.instruments]
        self.rough = model.history.roughness()
        self.smooth = self.rough.T @ self.rough
        self.bulges = model.history.bulges()
        self.rest = np.full(model.size, INITIAL_TEMPERATURE)
        self.sigma = np.array([parameter.sigma for parameter in model.parameters])
        self.centre = np.array([parameter.centre for parameter in model.parameters])
        self.pattern_prior = prior_of_patterns(model.instruments)

    def start(self, knots, settings=()):
        """A state to begin with."""
        errors = [tuple(np.zeros(i.channels) for i in self.model.instruments)] * 4
        return State(np.asarray(knots, dtype=float), self.centre.copy(), *errors, numbers_of(settings))

    def predict(self, state, settings, *, slopes=False):
        """Prediction (n, C) per instrument, with the slopes by the knots if wanted."""
        now = with_numbers(settings, state.amplitudes)
        result = []
        for which, (pattern, dark) in enumerate(zip(state.pattern, state.dark, strict=True)):
            found = self.model.evaluate(
                which, state.knots, state.values, now, slopes=slopes, gas_error=state.error_of_gas(which)
            )
            value, slope = found if slopes else (found, None)
            result.append((value * (1 + pattern) + dark, slope, value))
        return result

    def jacobian(self, state, settings, predicted):
        """Columns (n, C, K + V + E) per instrument."""
        columns = []
        now = with_numbers(settings, state.amplitudes)
        for which, (_, slope, value) in enumerate(predicted):
            free = free_numbers(settings)
            whole = np.empty((*value.shape, slope.shape[2] + self.sigma.size + len(free)))
            whole[..., : slope.shape[2]], others = slope, whole[..., slope.shape[2] :]
            others[..., len(self.model.own) : self.sigma.size] = 0.0
            changes = np.zeros((len(self.model.own), *value.shape))  # written at once: whole lines of memory
            for j, (sigma, parameter) in enumerate(zip(self.sigma, self.model.own, strict=False)):
                if parameter.history or parameter.instrument not in (
                    None,
                    self.model.instruments[which].kind,
                ):
                    continue
                values = state.values.copy()
                step = 1e-3 * sigma
                values[j] += step
                changed = self.model.evaluate(
                    which, state.knots, values, now, gas_error=state.error_of_gas(which)
                )
                changes[j] = (changed - value) / step
            others[..., : len(changes)] = changes.transpose(1, 2, 0)
            gas = others[..., self.model.index["gas"], None]
            others[..., self.model.wandering] = gas * self.model.gas_histories[which].mean(axis=1)[:, None]
            others[..., self.model.places[which]] = self.model.persistent_columns(which, value)
            for j, number in enumerate(free):
                numbers = state.amplitudes.copy()
                numbers[j] += number.step
                changed = with_numbers(settings, numbers)
                other = self.model.evaluate(
                    which, state.knots, state.values, changed, gas_error=state.error_of_gas(which)
                )
                others[..., self.sigma.size + j] = (other - value) / number.step
            columns.append(whole)
        return columns

    def gas_rows(self, state, settings, predicted):
        """Changes (2, n, C) per instrument for errors of its gas of 1 in a channel alone: at all times, and
        before the injection besides. A level that all channels share stays."""
        now = with_numbers(settings, state.amplitudes)

        def changed(which, value, more):
            own = state.error_of_gas(which)
            return (
                self.model.evaluate(
                    which, state.knots, state.values, now, gas_error=own + more, level_error=own
                )
                - value
            )

        return [
            np.stack([changed(which, value, more) for more in ([[1.0], [0.0]], [[0.0], [1.0]])])
            for which, (_, _, value) in enumerate(predicted)
        ]

    def gas_of(self, columns):
        """Signal of the gas (n, C) per instrument."""
        place = self.model.size + self.model.index["gas"]
        return [column[..., place] for column in columns]

    def prior(self, settings):
        """Normal matrix (k, k) of the priors of knots, values and amplitudes."""
        size, free = self.model.size, free_numbers(settings)
        k = size + self.sigma.size + len(free)
        matrix = np.zeros((k, k))
        matrix[:size, :size] = self.smooth
        first = size + self.sigma.size
        matrix[size:first, size:first] = self.model.precision
        own = np.arange(first, k)
        matrix[own, own] = np.array([number.sigma for number in free]) ** -2.0
        return matrix

    def weighers(self, gas, values):
        """`Weigher` of each instrument about the signals (n, C) of the gas and the values of all light."""
        return tuple(Weigher(*three) for three in zip(self.noise, gas, values, strict=True))

    def objective(self, state, settings, predicted, weighers):
        """Chi-squared of the data and the whole objective."""
        chi2 = 0.0
        for residual, weigher in zip(self.residuals(predicted), weighers, strict=True):
            chi2 += float(np.sum(residual * weigher(residual)))
        penalty = np.sum((self.rough @ (state.knots - self.rest)) ** 2)
        penalty += np.sum(np.maximum(self.bulges @ state.knots, 0.0) ** 2)
        off = state.values - self.centre
        penalty += off @ self.model.precision @ off
        for one, number in zip(free_numbers(settings), state.amplitudes, strict=True):
            penalty += ((number - one.centre) / one.sigma) ** 2
        patterns = self._patterns(state)
        penalty += np.sum(self.pattern_prior * patterns**2)
        return chi2, chi2 + float(penalty)

    def _patterns(self, state):
        parts = [
            row
            for *four, one in zip(
                state.pattern, state.dark, state.lines, state.before, self.model.instruments, strict=True
            )
            for sigma, row in zip(pattern_sigmas(one), four, strict=True)
            if sigma.any()
        ]
        return np.concatenate(parts) if parts else np.zeros(0)

    def _with_patterns(self, flat):
        four, place = ([], [], [], []), 0
        for instrument in self.model.instruments:
            for rows, sigma in zip(four, pattern_sigmas(instrument), strict=True):
                if sigma.any():
                    rows.append(flat[place : place + instrument.channels])
                    place += instrument.channels
                else:
                    rows.append(np.zeros(instrument.channels))
        return tuple(tuple(rows) for rows in four)

    def fit(self, start, settings=(), steps=MOST_STEPS, tolerance=CONVERGED):
        """Damped Gauss-Newton steps from a state until the objective stands still.

        Signals grow exponentially with temperature: a full step along what temperature and emittance leave
        free ends beside the curved valley of the objective, and the next one leads back into it, further
        down. So an undamped step may climb, if the next one makes up for it, and any other may be followed by
        one back into the valley by the slopes where it began: a base fit of spectra alone had come to rest
        670 of chi-squared above the bottom, 150 K too cold.

        Returns
        -------
        Solution

        Notes
        -----
        Source: the watchdog technique of Chamberlain et al., Math. Program. Study 16 (1982) 1, with one step;
        second-order correction, J. Nocedal & S. J. Wright, Numerical Optimization (2006), section 15.6.
        """
        state, damping, converged = start, 0.0, False
        here = self._at(state, settings)
        left, bold = None, True  # where a climb began; whether climbs are tried
        best, idle, path = (state, here), 0, []
        for _ in range(steps):
            trial, objective, damping, whole = self._tried(state, settings, here, damping, bold and not left)
            limit = left[1].objective if left else here.objective
            better = objective <= limit + 1e-9 * abs(limit)
            # Back, and shorter steps from there on; also if the second step only undid the first.
            if left and not (better and limit - objective > tolerance):
                (state, here), left, bold, damping = left, None, False, FIRST_DAMPING
                continue
            if trial is None:
                converged = not left  # no step of any length improves: as close as rounding allows
                break
            left = None if better else (state, here)
            state, damping = trial, damping / 5 if damping > LEAST_DAMPING else 0.0
            converged = better and limit - objective < tolerance and whole
            here = self._at(state, settings)
            idle = 0 if here.objective < best[1].objective - tolerance else idle + 1
            best = min(best, (state, here), key=lambda one: one[1].objective)
            path.append(best[1].objective)
            converged = converged or idle >= PATIENCE and not left
            if converged:
                break
        else:  # along the cold of a surface that nobody sees steps may gain ever less without an end
            converged = len(path) > CREEP and path[-CREEP - 1] - path[-1] < CREPT
        if left or here.objective > best[1].objective + tolerance:  # what weights took back is no fit
            state, here = left or best
        return self._solution(state, settings, here, converged)

    def _at(self, state, settings):
        """The model and its slopes at a state."""
        predicted = self.predict(state, settings, slopes=True)
        columns = self.jacobian(state, settings, predicted)
        gas = self.gas_of(columns)
        predicted = self.predict(state, settings)
        rows = self.gas_rows(state, settings, predicted)
        weighers = self.weighers(gas, [p[0] for p in predicted])
        objective = self.objective(state, settings, predicted, weighers)
        return _Place(predicted, columns, gas, rows, weighers, *objective)

    def _tried(self, state, settings, here, damping, climb):
        """Next state, its objective, the damping used and whether the step was not cut; a step that climbs
        only if `climb`, and None for the state if no step improves."""
        rows = own_patterns(self.model.instruments, [p[2] for p in here.predicted], here.rows)
        matrix, vector = gram(here.columns, rows, here.weighers, self.residuals(here.predicted))
        prior = self.prior(settings)
        self._stiffen(matrix, state, prior)
        vector += self._pull(state, settings, prior)
        for _ in range(DAMPINGS):
            damped = matrix.copy()
            damped[np.diag_indices_from(damped)] *= 1 + damping
            try:
                trial, predicted, objective, whole = self._stepped(state, damped, vector, settings, here)
            except np.linalg.LinAlgError:  # by rounding, as far off as a climb may end
                damping, objective = max(4 * damping, FIRST_DAMPING), np.inf
                continue
            near = objective < STEEPEST * here.objective
            better = objective <= here.objective + 1e-9 * abs(here.objective)
            if better or climb and damping == 0.0 and near:
                return trial, objective, damping, whole
            if near:  # beside a curved valley: back into it by the same slopes
                there = score(here.columns, rows, here.weighers, self.residuals(predicted))
                there += self._pull(trial, settings, prior)
                trial, _, objective, _ = self._stepped(trial, damped, there, settings, here)
                if objective <= here.objective:
                    return trial, objective, damping, whole
            damping = 4 * damping or FIRST_DAMPING
        return None, objective, damping, False

    def _stepped(self, state, matrix, vector, settings, here):
        """State a step away, what it predicts, its objective by the weights of `here`, and whether the step
        was not cut."""
        free, size = free_numbers(settings), self.model.size
        k = size + self.sigma.size + len(free)
        step = self._within(matrix, vector, state, k, free)
        step[:size] = np.clip(step[:size], -LARGEST * state.knots, LARGEST * state.knots)
        share = self._limit(step, state, k, free)
        trial = self._moved(state, share * step, k, self._patterns(state), free)
        predicted = self.predict(trial, settings)
        _, objective = self.objective(trial, settings, predicted, here.weighers)
        return trial, predicted, objective, share == 1.0

    def residuals(self, predicted):
        """Measured less predicted (n, C) per instrument, 0 where nothing was measured."""
        return [
            np.where(np.isfinite(measured), measured - value, 0.0)
            for (value, _, _), measured in zip(predicted, self.measured, strict=True)
        ]

    def _stiffen(self, matrix, state, prior):
        """Add the priors to a normal matrix."""
        k, size = prior.shape[0], self.model.size
        matrix[:k, :k] += prior
        bulging = self.bulges[self.bulges @ state.knots > 0]
        matrix[:size, :size] += bulging.T @ bulging
        own = np.arange(k, matrix.shape[0])
        matrix[own, own] += self.pattern_prior

    def _pull(self, state, settings, prior):
        """What the priors add to a score."""
        here = np.concatenate([state.knots, state.values, state.amplitudes])
        centre = [number.centre for number in free_numbers(settings)]
        pull = prior @ (np.concatenate([self.rest, self.centre, centre]) - here)
        bulging = self.bulges[self.bulges @ state.knots > 0]
        pull[: self.model.size] -= bulging.T @ (bulging @ state.knots)
        return np.concatenate([pull, -self.pattern_prior * self._patterns(state)])

    @staticmethod
    def _within(matrix, vector, state, k, free):
        """Step of all numbers; those of effects that would leave their bounds stay where they are."""
        step = cho_solve(cho_factor(matrix), vector)
        first = k - len(free)
        leaving = []
        for j, (number, one) in enumerate(zip(state.amplitudes, free, strict=True)):
            there = number + step[first + j]
            if not one.low <= there <= one.high and one.at_end(number, AT_BOUND):
                leaving.append(first + j)
        if leaving:
            kept = np.setdiff1d(np.arange(vector.size), leaving)
            step = np.zeros_like(step)
            step[kept] = cho_solve(cho_factor(matrix[np.ix_(kept, kept)]), vector[kept])
        return step

    def _limit(self, step, state, k, free):
        """Share of a step that is taken: none further than tangents hold, none beyond a bound."""
        share = FAR_OFF / max(np.abs(step[self.model.size + self.model.index["gas"]]), 1e-12)
        for one, number, far in zip(free, state.amplitudes, step[k - len(free) : k], strict=True):
            room = one.high - number if far > 0 else number - one.low
            if abs(far) > room and not one.at_end(number, AT_BOUND):
                share = min(share, room / abs(far))
            if one.name is not None:
                share = min(share, FAR_SHAPE * one.sigma / max(abs(far), 1e-12))
        return min(1.0, share)

    def _moved(self, state, step, k, patterns, free):
        size, count = self.model.size, self.sigma.size
        pattern, dark, lines, before = self._with_patterns(patterns + step[k:])
        return State(
            np.clip(state.knots + step[:size], 250.0, 4500.0),
            state.values + step[size : size + count],
            pattern,
            dark,
            lines,
            before,
            np.clip(
                state.amplitudes + step[size + count : k],
                [number.low for number in free],
                [number.high for number in free],
            ),
        )

    def _solution(self, state, settings, here, converged):
        prior, columns, predicted, gas = self.prior(settings), here.columns, here.predicted, here.gas
        residuals = self.residuals(predicted)
        matrix, left = gram(
            columns,
            own_patterns(self.model.instruments, [p[2] for p in predicted], here.rows),
            here.weighers,
            residuals,
        )
        k = prior.shape[0]
        self._stiffen(matrix, state, prior)
        left += self._pull(state, settings, prior)
        factor = cho_factor(matrix)
        covariance = cho_solve(factor, np.eye(matrix.shape[0])[:, :k])[:k]
        # What a bound holds is no free direction: tests beside the fit must not move it.
        held = k - len(state.amplitudes) + np.flatnonzero(_at_bounds(state, settings))
        if held.size:
            matrix[held, held] *= STIFF
            factor = cho_factor(matrix)
            left[held] = 0.0
        return Solution(
            state=state,
            settings=with_numbers(settings, state.amplitudes),
            objective=here.objective,
            chi2=here.chi2,
            count=int(sum(np.isfinite(measured).sum() for measured in self.measured)),
            converged=converged,
            covariance=covariance,
            prediction=tuple(p[0] for p in predicted),
            plain=tuple(p[2] for p in predicted),
            gas=tuple(gas),
            gas_rows=tuple(here.rows),
            residual=tuple(residuals),
            factor=factor,
            score=left,
            jacobian=tuple(columns),
            weighers=here.weighers,
        )


def log_evidence(solution, size):
    r"""Log of the evidence of a fit with effects, up to what all fits of a data set share.

    .. math:: \ln Z = -\tfrac12 \chi^2_{MAP} + \tfrac12 \ln\det C_{effects} + \sum_j \ln \pi_j

    with the posterior covariance of the free numbers of the effects and their densities before the data: of
    amplitudes the mean of some normals (`setting.log_prior`), of shapes one. The prior of amplitudes in
    fits is taken out of chi-squared.

    Parameters
    ----------
    solution : Solution
    size : int
        Knots and values, which come before the numbers of the effects in the covariance.

    Notes
    -----
    Source: Laplace's approximation; D. J. C. MacKay, Information Theory (2003), chapter 28.
    """
    free = free_numbers(solution.settings)
    if not free:
        return -0.5 * solution.objective
    block = solution.covariance[size:, size:]
    _, log_determinant = np.linalg.slogdet(block)
    prior = log_prior(free, solution.state.amplitudes)
    return float(-0.5 * solution.objective + 0.5 * log_determinant + prior)
