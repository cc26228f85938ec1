"""What chance may reach: thresholds from scores drawn as if nothing were wrong."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh
from scipy.stats import chi2

from plasmapyro.diagnosis.select.screen import LEAST_LEFT, gain
from plasmapyro.diagnosis.select.unknowns import Unknowns

LEVEL = 0.01  # false alarms of each of the two tests, if the linearised model were exact
LEAST_UNKNOWN = 4.0  # log Bayes factor below which nothing is called unknown: templates err a little
ROUNDING = 1e-8  # [1], relative, added to a covariance that is singular but for rounding


@dataclass(frozen=True)
class Thresholds:
    """Calibrated by scores drawn as if nothing were wrong."""

    effect: float
    unknown: float
    third: float
    draws: int
    seed: int
    largest: np.ndarray  # sorted largest gains of the draws
    largest_unknown: np.ndarray

    def p_effect(self, value):
        """Share of the draws beyond a gain; never 0."""
        return (1 + np.sum(self.largest >= value)) / (1 + self.largest.size)

    def p_unknown(self, value):
        """Share of the draws beyond a log Bayes factor; never 0."""
        return (1 + np.sum(self.largest_unknown >= value)) / (1 + self.largest_unknown.size)


def calibrated(screen, draws, seed):
    """Thresholds of a screen from simulated scores: the price of looking at many effects is in them."""
    scores = simulated(screen, draws, np.random.default_rng(seed))
    information = np.diag(screen.information)[: screen.count]
    gains = gain(scores[:, : screen.count], information, screen.left[: screen.count])
    best = np.sort(gains.max(axis=1))
    unknown = np.sort(Unknowns(screen)(scores).max(axis=1)) if screen.structures else np.full(draws, -np.inf)
    return Thresholds(
        effect=float(np.quantile(best, 1 - LEVEL)),
        unknown=max(float(np.quantile(unknown, 1 - LEVEL)), LEAST_UNKNOWN) if screen.structures else np.inf,
        third=_rarer(float(np.quantile(best, 1 - LEVEL)), 10.0),
        draws=draws,
        seed=seed,
        largest=best,
        largest_unknown=unknown,
    )


def _rarer(largest, times):
    """What the largest of many gains exceeds so many times more rarely than some value: each has the tail of
    chi-squared of one degree of freedom, and of a few thousand draws the rarest tell little."""
    return float(chi2.isf(chi2.sf(largest, 1) / times, 1))


def simulated(screen, draws, generator):
    """Scores (draws, m) if nothing were wrong: normal with the information as covariance."""
    alive = (screen.left > LEAST_LEFT) & (np.diag(screen.information) > 0)
    length = np.sqrt(np.where(alive, np.diag(screen.information), 1.0))
    relative = np.where(alive[:, None] & alive[None], screen.information / np.outer(length, length), 0.0)
    length = np.where(alive, length, 0.0)
    root = _root(relative)
    return (generator.standard_normal((draws, length.size)) @ root.T) * length


def _root(relative):
    """A root of correlations (m, m): the Cholesky factor, or, where rounding has made eigenvalues negative,
    that of the others."""
    relative[np.diag_indices_from(relative)] = 1 + ROUNDING
    try:
        return cholesky(relative, lower=True, check_finite=False)
    except LinAlgError:
        value, vector = eigh(relative)
        return vector * np.sqrt(np.maximum(value, 0.0))
