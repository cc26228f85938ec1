"""Noise with a memory: how fast the values of a common factor part with the time between them."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

CLIP = 20.0  # times the median of the products of differences beyond which one is left out
LEAST_PAIRS = 12
USUAL, USUAL_FREEDOM = 2e-3, 6.0  # [1] ASSUME: pointing and light source from sample to sample, and how sure
THIRD = np.array(
    [1.0, -3.0, 3.0, -1.0]
)  # a third difference sees no heating, and no fit that follows the noise
TREND = 0.05  # [1] by which the factor may change on its way
TIMES = 12  # memories of which noise may be made, from a sample to the longest lag
SHORTEST = 1e-6  # memories of an exposure; the formula for less is 0/0
KNOWN = 0.3  # [1], of the variance that is taken out: how well it is known
INEXACT = 0.003  # [1], of the largest value: what exponential memories describe; real noise begins smoothly
FINEST = 3e-5  # [1] to which a fit follows light without noise: what it misses has no memory of its own
SLOWEST = 100.0  # [s], of 1/f noise
OVERLAP = 2.3  # third differences for one independent one
PARTED = np.array([-1.5, 0.6, -0.1])  # share in a third difference of what is one, two and three away
LOOSE = 5.0  # [1] ASSUME: the factor to which it is known how usual instruments flicker
SURE = 9.0  # chi-squared that a memory must explain: three standard deviations


@dataclass(frozen=True)
class Coloured:
    """Relative noise of samples: variance `white` without memory, and parts of some `variance` that decay
    over some `time` [s] each."""

    white: float = 0.0
    variance: float | np.ndarray = 0.0
    time: float | np.ndarray = 1.0

    @property
    def total(self):
        """Variance of one sample."""
        return self.white + float(np.sum(self.variance))

    @property
    def remembers(self):
        """Whether samples know of those before."""
        return bool(np.any(self.variance))

    def slower(self, time):
        """Variance of the parts that last longer than a time [s]."""
        variance, own = np.atleast_1d(self.variance), np.atleast_1d(self.time)
        return float(np.sum(variance[own > time]))

    def _parts(self, function, over):
        """Sum of the variances of the parts times a function (p, ...) of lags or ratios."""
        variance, time = np.atleast_1d(self.variance), np.atleast_1d(self.time)
        return np.tensordot(variance, function(np.multiply.outer(1 / time, over)), axes=1)

    def between(self, lag):
        """Half the mean square of the difference of two samples, some time [s] apart."""
        return self.white - self._parts(lambda x: np.expm1(-x), lag)

    def parted(self, lag):
        """Variance of a third difference of samples, one each lag [s], over that of independent ones of
        variance 1."""
        return self.white + self._parts(_parted, lag)

    def of_mean(self, number, period):
        r"""Variance of the mean of n samples (n,), one each period [s].

        .. math:: w/n + 2 v r [1 - r (1 - e^{-1/r})], \qquad r = \tau/(n p)
        """
        number = np.maximum(number, 1)
        return self.white / number + self._parts(_mean, number * period)

    def scaled(self, share):
        """The same with all variances times a number."""
        return replace(self, white=self.white * share, variance=np.multiply(self.variance, share))

    def with_memory_of(self, other):
        """The same total, with the parts of another record of the factor if this one shows none."""
        if self.remembers:
            return self
        return replace(other, white=max(self.total - other.slower(0.0), 0.0))

    def seen_over(self, exposure):
        """The same as exposures [s] see it: parts averaged over each, what has no memory gone."""
        share = _mean(exposure / np.atleast_1d(self.time))
        return replace(self, white=0.0, variance=np.multiply(self.variance, share))


def _mean(x):
    """Variance of a mean over x memories of noise of variance 1."""
    x = np.maximum(x, SHORTEST)
    return np.minimum(2 / x * (1 + np.expm1(-x) / x), 1.0)


def coloured(one, other, error, chosen, phase, period, longest):
    """Noise that two records of the same factor share, by the products of their third differences.

    Parameters
    ----------
    one, other : (t,) logarithms of the factor; the same for one record
    error : (t,) variance [1] that both share besides, or (share (t,), `Coloured`) of a factor of a share of
        the light
    chosen : (t,) bool
    phase : (t,) int, across which no difference is taken
    period : float [s] between samples
    longest : float [s], the longest lag: what is slower belongs to the model

    Returns
    -------
    Coloured

    Notes
    -----
    Source: structure functions, A. N. Kolmogorov, Dokl. Akad. Nauk SSSR 26 (1940) 115; the
    variances of `TIMES` memories are non-negative least squares.
    """
    part, besides = error if isinstance(error, tuple) else (np.ones(one.size), None)
    lags, rows = [], []
    lag = 1
    while lag == 1 or lag * period <= longest:
        first = np.arange(max(one.size - 3 * lag, 0))
        four = first + lag * np.arange(4)[:, None]
        level = one[four]
        whole = chosen[four].all(axis=0) & (phase[four[0]] == phase[four[3]])
        four = four[:, whole & (np.abs(level[3] - level[0]) < TREND)]
        product = (THIRD @ one[four]) * (THIRD @ other[four])
        middle = np.median(np.abs(product)) if product.size else 0.0
        kept = np.abs(product) <= CLIP * middle
        if kept.sum() >= LEAST_PAIRS and middle > 0:
            out = THIRD**2 @ (error[four] if besides is None else part[four] * besides.parted(lag * period))
            own, out = (product - out)[kept] / np.sum(THIRD**2), out[kept]
            # Faint samples tell little: their errors are larger than what is sought.
            weight = (middle / (out + middle)) ** 2
            weight /= weight.sum()
            # Differences that overlap are no independent samples.
            spread = np.sqrt(3 * np.sum((weight * own) ** 2))
            if besides is not None:
                spread = np.hypot(spread, KNOWN * (weight @ out) / np.sum(THIRD**2))
            lags.append(lag * period)
            # Without a memory the products would scatter as those of neighbours do, and no more.
            scatter = np.sqrt(weight @ own**2)
            usual = min(rows[0][2], scatter) if rows else scatter
            rows.append((weight @ own, max(spread, 1e-300), usual, spread * usual / max(scatter, 1e-300)))
        lag *= 2
    if not rows:
        plain = error if besides is None else part * besides.total
        return Coloured(white=few(one, other, plain, chosen, phase))
    lags, (value, *spreads) = np.array(lags), np.array(rows)[:, [0, 1, 3]].T
    times = np.geomspace(period, max(longest, 2 * period), TIMES)
    columns = np.stack([np.ones_like(lags), *(_parted(lags / time) for time in times)], axis=1)
    spread, without = (np.hypot(one, INEXACT * value.max()) for one in spreads)
    missed, left = (nnls(one / without[:, None], value / without)[1] for one in (columns[:, :1], columns))
    plain, found = (nnls(one / spread[:, None], value / spread)[0] for one in (columns[:, :1], columns))
    if left**2 > missed**2 - SURE or found[1:].sum() < FINEST**2:
        return Coloured(white=float(plain[0]))
    kept = np.flatnonzero(found[1:] > 0)
    return Coloured(float(found[0]), found[1:][kept], times[kept])


def flickering(values, phase, period, usual, longest=SLOWEST):
    r"""What lasts of noise as 1/f noise does, over the rest of it: one variance v in each octave of time
    from a sample to the `longest` [s].

    Third differences of means over 1, 2, 4, ... samples tell it, white noise of a mean falling as its number;
    v is the posterior mean, its logarithm before the data normal about the `usual` one, `LOOSE` wide.

    Parameters
    ----------
    values : (t,), one sample each `period` [s] but between phases
    phase : (t,) int
    usual : float [1], of the variance without memory

    Returns
    -------
    Coloured, without its white part.

    Notes
    -----
    Source: A. van der Ziel, Physica 16 (1950) 359, on 1/f noise as a sum of memories; D. W. Allan,
    Proc. IEEE 54 (1966) 221, on differences of means.
    """
    times = period * 2.0 ** np.arange(1 + max(int(np.log2(longest / period)), 1))
    rows, number = [], 1
    while number * period <= longest:
        squares = []
        for one in np.unique(phase):
            own = values[phase == one]
            mean = own[: own.size // number * number].reshape(-1, number).mean(axis=1)
            squares.append(np.convolve(mean, THIRD, "valid") ** 2 if mean.size >= THIRD.size else mean[:0])
        square = np.concatenate([[], *squares]) / np.sum(THIRD**2)
        if square.size < LEAST_PAIRS:
            break
        square = number * square[square <= CLIP * np.median(square)]
        rows.append((number, square.mean(), np.sqrt(2 * OVERLAP / square.size)))
        number *= 2
    if not rows or not rows[0][1] > 0:
        return Coloured()
    number, value, spread = np.array(rows).T
    x = np.divide.outer(number * period, times)
    beside = np.exp(-x * np.arange(3)[:, None, None]) * (np.expm1(-x) / x) ** 2
    lasting = number * (_mean(x) + np.tensordot(PARTED, beside, axes=1)).sum(axis=1)
    tried = usual * LOOSE ** np.linspace(-2, 2, 41)  # the law of its logarithm, to two standard deviations
    expected = 1 + tried[:, None] * lasting
    weight = (spread * expected) ** -2.0  # errors are relative to what is expected
    white = np.sum(weight * expected * value, axis=1) / np.sum(weight * expected**2, axis=1)
    misfit = np.sum(weight * (value / white[:, None] - expected) ** 2, axis=1)
    misfit += 2 * np.log(expected).sum(axis=1) + (np.log(tried / usual) / np.log(LOOSE)) ** 2
    likely = np.exp(-0.5 * (misfit - misfit.min()))
    return Coloured(0.0, np.full(times.size, likely @ tried / likely.sum()), times)


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
