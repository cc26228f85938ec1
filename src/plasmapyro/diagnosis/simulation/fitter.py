"""Fits of power, brightness and effects of the simulated to the measured gas."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares
from scipy.special import chdtrc, chdtri

from plasmapyro.diagnosis.fit.build import GAS_SIGMA
from plasmapyro.diagnosis.fit.setting import LARGE, Setting, free_numbers, log_prior, numbers_of, with_numbers

LEAST, MOST = (-1.5, -3.0), (1.5, 3.0)  # of the logarithms of power and brightness
LEVEL = 0.01  # false alarms, if the errors of the simulation are those that it states
ANY = 20.0  # times the stated error of a strength: any strength
ROUNDS = 2  # of the fit without effects and the errors about it
ROUNDING = 1e-9  # [1], relative, added to a singular covariance


@dataclass(frozen=True)
class Fit:
    """A fit of the simulated to the measured light: logarithms of `power` and `brightness`, and `settings`.

    `covariance` of power, brightness and the numbers of the settings; `objective`: chi-squared with priors,
    and the logarithm of the determinant of the covariance of the data.
    """

    power: float
    brightness: float
    settings: tuple
    objective: float
    covariance: np.ndarray


def settled(simulated, settings=(), wrong=()):
    """Fitter whose errors of the simulation are relative to the light that it fits, and the fit.

    Relative to the measured light, errors would be small where this one is, and fits would err downwards.
    `settings`: effects that are switched on; `wrong`: radiating systems that may have any strength.

    Source: S. Chiba & D. L. Smith, report ANL/NDM-121 (1991), on Peelle's pertinent puzzle.
    """
    fitter, fit = Fitter(simulated, simulated.measured.simulated, wrong), None
    for _ in range(ROUNDS):
        fit = fitter.fit(settings, fit)  # from the last one: far from it there are other minima
        fitter = fitter.about(fit)
    return fitter, fitter.fit(settings, fit)


def log_bayes(fit, base):
    """Log Bayes factor of a fit over the one without effects, by Laplace's approximation."""
    volume = [np.linalg.slogdet(one.covariance)[1] for one in (fit, base)]
    prior = log_prior(free_numbers(fit.settings), numbers_of(fit.settings), LARGE)
    return float(0.5 * (base.objective - fit.objective + volume[0] - volume[1]) + prior)


class Fitter:
    """Fits of power, brightness and effects to the measured gas.

    Errors of the simulation are relative to some light (C,); systems that are `wrong` may have any strength.
    """

    def __init__(self, simulated, light, wrong=()):
        self.simulated, self.measured, self.wrong = simulated, simulated.measured, tuple(wrong)
        self.scale, self.sigma = light, np.array([simulated.power[1], GAS_SIGMA])
        self.centre = np.array([simulated.power[0], 0.0])
        wide, groups = np.ones((len(simulated.systems), 1)), []
        for name in wrong:
            if name in simulated.systems:
                wide[simulated.systems.index(name)] = ANY  # the first mode of a system is all of it
            else:
                groups.append(simulated.model.library.group_name.index(name))
        self.root = self.root_of(
            simulated.strength * wide, simulated.shape, simulated.group[groups], seen=light
        )

    def about(self, fit):
        """One whose errors of the simulation are relative to the light of a fit, and where it has that."""
        return Fitter(self.simulated.through(fit.settings), self.light(fit), self.wrong)

    def root_of(self, *modes, seen=None):
        """Cholesky factor (C, C) of the covariance of the data and of the errors that modes (M, C) state.

        The data err relative to themselves, or to the light `seen` (C,).
        """
        total = self.measured.covariance if seen is None else self.measured.covariance_about(seen)
        total = total + self.simulated.covariance(np.concatenate(modes), self.scale)
        total[np.diag_indices_from(total)] *= 1 + ROUNDING
        return cholesky(total, lower=True)

    def p_value(self, fit):
        """Probability [1] of a chi-squared as large, all errors of simulation and measurement considered."""
        rest = self.white(self.measured.value - self.light(fit))[0]
        return float(chdtrc(rest.size, rest @ rest))

    def spread(self, fit):
        """The Birge ratio [1] of a fit, squared: its chi-squared per number where that is above 1.

        Source: R. T. Birge, Phys. Rev. 40, 207 (1932).
        """
        rest = self.white(self.measured.value - self.light(fit))[0]
        return max(float(rest @ rest) / max(rest.size - len(fit.covariance), 1), 1.0)

    def light(self, fit):
        """Light (C,) of a fit, over the level."""
        return self.simulated.light(fit.power, fit.brightness, fit.settings)

    def white(self, rows, root=None):
        """Rows (m, C) whitened."""
        return solve_triangular(self.root if root is None else root, np.atleast_2d(rows).T, lower=True).T

    def fit(self, settings, start=None):
        """Fit with effects, from their numbers."""
        free = free_numbers(settings)
        first = (0.0, 0.0) if start is None else (start.power, start.brightness)
        low = np.array([*LEAST, *(number.low for number in free)])
        high = np.array([*MOST, *(number.high for number in free)])
        scale = np.array([*self.sigma, *(number.sigma for number in free)])
        centre = np.array([*self.centre, *(number.centre for number in free)])

        def residual(x):
            light = self.simulated.light(x[0], x[1], with_numbers(settings, x[2:]))
            rest = [self.white(self.measured.value - light)[0], (x - centre) / scale]
            return np.concatenate([*rest, self._off_slit(with_numbers(settings, x[2:]))])

        begin = np.clip(np.append(first, numbers_of(settings)), low, high)
        found = least_squares(residual, begin, bounds=(low, high), x_scale=0.1 * scale, diff_step=1e-4)
        covariance = np.linalg.pinv(found.jac.T @ found.jac)
        power, brightness = (float(x) for x in found.x[:2])
        objective = float(2 * found.cost + 2 * np.sum(np.log(np.diag(self.root))))
        return Fit(power, brightness, with_numbers(settings, found.x[2:]), objective, covariance)

    def _off_slit(self, settings):
        """Standard errors by which settings miss the width that lines show: one number or none."""
        seen = self.measured.slit
        return np.array([] if seen is None else [seen.misfit(settings)])

    def of_slit(self, settings):
        """Chi-squared that the width of the slit alone adds to a fit with settings."""
        return float(np.sum(self._off_slit(settings) ** 2))

    def by_light(self, fit):
        """The objective of a fit without `of_slit`."""
        return fit.objective - self.of_slit(fit.settings)

    def best(self, beside, effect):
        """The best fit with one more effect, of all its shapes and either sign: from the fit beside it, and
        of twice the amplitude from the simulated power: that fit may have taken it for power."""
        size = min(effect.sigma, max(effect.bounds) / 2)
        signs = (1.0,) if effect.bounds[0] >= 0 else (1.0, -1.0)
        fits = [
            self.fit((*beside.settings, Setting(effect, sign * times * size, dict(shape))), start)
            for shape in effect.shapes
            for sign in signs
            for times, start in ((1, beside), (2, None))
        ]
        return min(fits, key=lambda fit: fit.objective)

    def threshold(self, fit, draws, seed):
        """Chi-squared that the best effect gains in a share `LEVEL` of spectra in which nothing is wrong;
        that of one number where no effect is asked for."""
        if not self.simulated.effects:
            return float(chdtri(1, LEVEL))
        light, step = self.light(fit), 1e-3
        moved = (fit.power + step, fit.brightness), (fit.power, fit.brightness + step)
        base = self.white([(self.simulated.light(*place, fit.settings) - light) / step for place in moved])
        more = self.white(
            [
                self.simulated.light(
                    fit.power, fit.brightness, (*fit.settings, Setting(effect, effect.step, dict(shape)))
                )
                - light
                for effect in self.simulated.effects.values()
                for shape in effect.shapes
            ]
        )
        more /= np.maximum(np.linalg.norm(more, axis=1, keepdims=True), 1e-300)
        inverse = np.linalg.inv(base @ base.T + np.diag(self.sigma**-2.0))
        cross = more @ base.T
        left = 1 - np.einsum("ij,jk,ik->i", cross, inverse, cross)
        generator = np.random.default_rng(seed)
        drawn = generator.standard_normal((draws, base.shape[1]))
        drawn += (generator.standard_normal((draws, 2)) * self.sigma) @ base  # what the priors allow
        score = drawn @ more.T - (drawn @ base.T) @ inverse @ cross.T
        gains = np.where(left > 1e-6, score**2 / np.maximum(left, 1e-6), 0.0)
        return float(np.quantile(gains.max(axis=1), 1 - LEVEL))
