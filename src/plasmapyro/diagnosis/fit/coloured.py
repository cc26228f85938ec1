"""Noise with a memory: how fast the values of a common factor part with the time between them."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

CLIP = 20.0  # times the median of the products of differences beyond which one is left out
LEAST_PAIRS = 12
USUAL, USUAL_FREEDOM = 2e-3, 6.0  # [1] ASSUME: pointing and light source from sample to sample, and how sure
THIRD = np.array(
    [1.0, -3.0, 3.0, -1.0]
)  # a third difference sees no heating, and no fit that follows the noise
TREND = 0.05  # [1] by which the factor may change on its way
TIMES = 24  # memories tried, from a sample to the longest lag
SURE = 9.0  # chi-squared that a memory must explain: three standard deviations


@dataclass(frozen=True)
class Coloured:
    """Relative noise of samples: variance `white` without memory, `variance` that decays over `time` [s]."""

    white: float = 0.0
    variance: float = 0.0
    time: float = 1.0

    @property
    def total(self):
        """Variance of one sample."""
        return self.white + self.variance

    def between(self, lag):
        """Half the mean square of the difference of two samples, some time [s] apart."""
        return self.white - self.variance * np.expm1(-lag / self.time)

    def of_mean(self, number, period):
        r"""Variance of the mean of n samples (n,), one each period [s].

        .. math:: w/n + 2 v r [1 - r (1 - e^{-1/r})], \qquad r = \tau/(n p)
        """
        ratio = self.time / (np.maximum(number, 1) * period)
        return self.white / np.maximum(number, 1) + self.variance * np.minimum(
            2 * ratio * (1 + ratio * np.expm1(-1 / ratio)), 1.0
        )


def coloured(one, other, error, chosen, phase, period, longest):
    """Noise that two records of the same factor share, by the products of their third differences.

    Parameters
    ----------
    one, other : (t,) logarithms of the factor; the same for one record
    error : (t,) variance [1] that both share besides
    chosen : (t,) bool
    phase : (t,) int, across which no difference is taken
    period : float [s] between samples
    longest : float [s], the longest lag: what is slower belongs to the model

    Returns
    -------
    Coloured

    Notes
    -----
    Source: structure functions, A. N. Kolmogorov, Dokl. Akad. Nauk SSSR 26 (1940) 115; the memory is the best
    of `TIMES`, the variances are non-negative least squares.
    """
    lags, rows = [], []
    lag = 1
    while lag == 1 or lag * period <= longest:
        first = np.arange(max(one.size - 3 * lag, 0))
        four = first + lag * np.arange(4)[:, None]
        level = one[four]
        whole = chosen[four].all(axis=0) & (phase[four[0]] == phase[four[3]])
        four = four[:, whole & (np.abs(level[3] - level[0]) < TREND)]
        product = (THIRD @ one[four]) * (THIRD @ other[four])
        kept = np.abs(product) <= CLIP * np.median(np.abs(product)) if product.size else product > 0
        if kept.sum() >= LEAST_PAIRS:
            own = (product - THIRD**2 @ error[four])[kept] / np.sum(THIRD**2)
            # Differences that overlap are no independent samples.
            spread = np.sqrt(np.mean(own**2) * 3 / kept.sum())
            lags.append(lag * period)
            rows.append((own.mean(), max(spread, 1e-300)))
        lag *= 2
    if not rows:
        return Coloured(white=few(one, other, error, chosen, phase))
    lags, (value, spread) = np.array(lags), np.array(rows).T
    plain, missed = nnls((1 / spread)[:, None], value / spread)
    best, least = Coloured(white=float(plain[0])), missed**2 - SURE
    for time in np.geomspace(period, max(longest, 2 * period), TIMES):
        columns = np.stack([np.ones_like(lags), _parted(lags / time)], axis=1)
        found, missed = nnls(columns / spread[:, None], value / spread)
        if missed**2 < least:
            best, least = Coloured(*map(float, found), float(time)), missed**2
    return best


def few(one, other, error, chosen, phase):
    r"""Variance of records too short for a memory: what differences show, pooled with what is usual.

    .. math:: s^2 = \frac{\nu_0 s_0^2 + \sum d d'/4}{\nu_0 + n/2 - 2}

    The posterior mean under an inverse chi-squared prior of :math:`\nu_0` degrees of freedom; n differences
    d of neighbours bring n/2.

    Notes
    -----
    Source: A. Gelman et al., Bayesian Data Analysis (3rd ed.), 2.6 and 3.3.
    """
    place = np.flatnonzero(chosen[1:] & chosen[:-1] & (phase[1:] == phase[:-1]))
    place = place[np.abs(one[place + 1] - one[place]) < TREND]
    if not chosen.any():
        return 0.0
    own = (one[place + 1] - one[place]) * (other[place + 1] - other[place]) - error[place] - error[place + 1]
    freedom = USUAL_FREEDOM + place.size / 2  # neighbours share a sample, and some of it is heating
    pooled = USUAL_FREEDOM * USUAL**2 + max(float(own.sum()) / 4, 0.0)
    return pooled / max(freedom - 2, 1.0)


def _parted(lag):
    """Variance of a third difference of samples of an exponential memory over that without any."""
    one = np.exp(-lag)
    return 1 - 1.5 * one + 0.6 * one**2 - 0.1 * one**3
