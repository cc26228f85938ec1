"""Constants of the joint estimate against the exact evidence of linear Gaussian models."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.special import logsumexp
from scipy.stats import multivariate_normal, norm

from plasmapyro.estimate.dynamics import SIZE, TEMPERATURE, Dynamics
from plasmapyro.estimate.observations import Information, constants
from plasmapyro.estimate.smoother import Chain, fit, spread_of
from plasmapyro.estimate.throughput import CHANCE, GAINS, NAME, RATIO_CHANCE, RATIO_WIDTH, WIDTH, in_doubt
from plasmapyro.record.budget import of_family, remainder

TIME = np.linspace(0.0, 20.0, 60)
QUIET = 25.0  # [K2 s-3]
START, RATE_START = 40.0, 20.0  # [K], [K/s] standard deviations of the first state, mean 0
NOISE = 2.0
PRIOR = 0.05  # standard deviation of the logarithm of the gain
DYNAMICS = Dynamics(QUIET, 1e-12, 1.0, 0.0, 1e-4, 1e-3, 0.01, 0.3)


class Alike:
    """Light that hardly changes with the temperature."""

    temperatures = (-1e6, 1e6)

    def __call__(self, kelvin):
        return np.full((len(kelvin), 1), 1e9), np.ones((len(kelvin), 1)), None


@dataclasses.dataclass(frozen=True)
class Scaled:
    """Signal = e^theta T + noise: the smaller T, the cheaper its path, and theta makes good for it."""

    signal: np.ndarray
    noise: float = NOISE
    table = Alike()

    def slope(self, path, values):
        """Whitened, by the temperature."""
        return np.full(len(path), np.exp(values[0])) / self.noise

    def residual(self, path, values, of):
        return (self.signal - np.exp(values[0]) * path[:, TEMPERATURE]) / self.noise

    def state_matrix(self, path, values, of):
        matrix = np.zeros((len(path), SIZE, SIZE))
        matrix[:, TEMPERATURE, TEMPERATURE] = self.slope(path, values) ** 2
        return matrix

    def information(self, path, values, of):
        slope, rest = self.slope(path, values), self.residual(path, values, of)
        by_constant = np.exp(values[0]) * path[:, TEMPERATURE] / self.noise
        gradient, border = np.zeros((len(path), SIZE)), np.zeros((len(path), SIZE, 1))
        gradient[:, TEMPERATURE] = -slope * rest
        border[:, TEMPERATURE, 0] = slope * by_constant
        return Information(
            0.5 * rest @ rest,
            gradient,
            self.state_matrix(path, values, of),
            border,
            np.array([[by_constant @ by_constant]]),
            np.array([-by_constant @ rest]),
        )


def covariance():
    """Of an integrated Wiener process with a random start, closed form."""
    first, last = np.minimum.outer(TIME, TIME), np.maximum.outer(TIME, TIME)
    walk = QUIET * first**2 * (3 * last - first) / 6
    return START**2 + RATE_START**2 * first * last + walk


def most_probable(signal):
    """Logarithm of the gain of the largest exact posterior density, the path integrated out."""
    prior = covariance()

    def cost(value):
        whole = np.exp(2 * value) * prior + NOISE**2 * np.eye(TIME.size)
        return -multivariate_normal(None, whole).logpdf(signal) - norm(0, PRIOR).logpdf(value)

    return minimize_scalar(cost, bounds=(-0.5, 0.5), method="bounded", options={"xatol": 1e-6}).x


@dataclasses.dataclass(frozen=True)
class Logarithmic(Scaled):
    """Signal = theta + x + noise, as the logarithm of a hot surface's light over x = T0 (2 - T0 / T)."""

    def slope(self, path, values):
        return np.ones(len(path)) / self.noise

    def residual(self, path, values, of):
        return (self.signal - values[0] - path[:, TEMPERATURE]) / self.noise

    def information(self, path, values, of):
        slope, rest = self.slope(path, values), self.residual(path, values, of)
        gradient, border = np.zeros((len(path), SIZE)), np.zeros((len(path), SIZE, 1))
        gradient[:, TEMPERATURE], border[:, TEMPERATURE, 0] = -slope * rest, slope**2
        matrix = self.state_matrix(path, values, of)
        half, corner = 0.5 * rest @ rest, np.array([[slope @ slope]])
        return Information(half, gradient, matrix, border, corner, np.array([-slope @ rest]))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_level_over_the_inverse_temperature_is_that_of_the_exact_evidence(seed):
    """There the most probable path and constants need no correction; over T the path is too cold."""
    random = np.random.default_rng(seed)
    truth = random.multivariate_normal(np.zeros(TIME.size), covariance())
    signal = truth + NOISE * random.standard_normal(TIME.size)
    spread = np.diag([START**2, RATE_START**2, 1e-6, 1e-4])
    chain, start = Chain(TIME, (), -1.0, np.zeros(4), spread), np.zeros((TIME.size, SIZE))
    start[:, TEMPERATURE] = signal
    level = constants("level", 0, NOISE)
    found = fit(chain, [Logarithmic(signal)], level, DYNAMICS, start, np.zeros(1), 0)
    whole = covariance() + NOISE**2 * (np.eye(TIME.size) + 1.0)
    exact = NOISE**2 * np.linalg.solve(whole, signal).sum()
    assert found.values[0] == pytest.approx(exact, abs=1e-3 * NOISE)
    gain = constants("gain", 0, PRIOR)
    joint = fit(chain, [Scaled(signal)], gain, DYNAMICS, start, np.zeros(1), 0)
    assert joint.values[0] - most_probable(signal) > 0.3 * PRIOR


def test_the_estimate_follows_what_is_stated_and_its_noise_as_the_budget_says():
    random = np.random.default_rng(6)
    truth = 30 + 8 * np.sin(TIME / 2)
    spread = np.diag([START**2, RATE_START**2, 1e-6, 1e-4])
    chain = Chain(TIME, (), -1.0, np.zeros(4), spread)
    start = np.zeros((TIME.size, SIZE))
    start[:, TEMPERATURE] = truth

    def path(signal, stated=0.0):
        gain = constants("gain", stated, PRIOR)
        found = fit(chain, [Scaled(signal)], gain, DYNAMICS, start, np.zeros(1), 0)
        return found, spread_of(chain, [Scaled(signal)], gain, found)

    found, uncertain = path(truth)
    row = of_family("gain", "calibration", uncertain.across, np.array([PRIOR]))
    step = 0.05 * PRIOR
    ends = [path(truth, sign * step)[0].path[:, TEMPERATURE] for sign in (1, -1)]
    slope = (ends[0] - ends[1]) / (2 * step)
    np.testing.assert_allclose(row.contribution, slope * PRIOR, rtol=0.02)  # steps end at CONVERGED
    # The rest is noise and the smoothness of the path: Monte Carlo over both, JCGM 101.
    rest = remainder(uncertain.path[:, TEMPERATURE, TEMPERATURE], [row])
    draws = 300
    paths = random.multivariate_normal(np.zeros(TIME.size), covariance(), draws)
    signals = paths + NOISE * random.standard_normal(paths.shape)
    held = constants("gain", 0.0, 1e-9)
    read = [
        fit(chain, [Scaled(one)], held, DYNAMICS, start, np.zeros(1), 0).path[:, TEMPERATURE]
        for one in signals
    ]
    # With the gain known; what its fit adds to the noise is less than a tenth here.
    known = np.std(read - paths, axis=0)
    assert np.median(known / rest) == pytest.approx(1.0, abs=0.1 + 3 / np.sqrt(2 * draws))


def test_without_its_continuity_a_path_is_known_from_the_samples_about_each_by_themselves():
    signal = np.where(TIME > 10, 60.0, 30.0)  # a step, which no path of this kind follows
    chain = Chain(TIME, (), -1.0, np.zeros(4), np.diag([START**2, RATE_START**2, 1e-6, 1e-4]))
    start, held = np.zeros((TIME.size, SIZE)), constants("gain", 0.0, 1e-9)
    found = fit(chain, [Scaled(signal)], held, DYNAMICS, start, np.zeros(1), 0)
    loose = constants("gain", 0.0, PRIOR)
    one = spread_of(chain, [Scaled(signal)], held, found)
    both = spread_of(chain, [Scaled(signal)], loose, found)
    path = found.path[:, TEMPERATURE]
    for at in (0, 29, 40):  # three samples lie within a second, two at the begin
        near = np.abs(TIME - TIME[at]) <= 0.5
        off = np.mean(signal[near] - path[near])
        assert one.alone[at] == pytest.approx(np.hypot(NOISE / np.sqrt(near.sum()), off), rel=1e-4)
        moved = np.mean(path[near]) * np.sqrt(both.constants[0, 0])
        assert both.alone[at] == pytest.approx(np.hypot(one.alone[at], moved), rel=1e-4)
    assert one.alone[29] > 2 * np.sqrt(one.path[29, TEMPERATURE, TEMPERATURE])


@pytest.mark.parametrize("louder", [1.0, 1.7, 0.6])
def test_a_throughput_in_doubt_has_the_exact_moments_of_its_mixture(louder):
    random = np.random.default_rng(8)
    truth = random.multivariate_normal(np.zeros(TIME.size), covariance())
    signal = louder * truth + NOISE * random.standard_normal(TIME.size)
    chain = Chain(TIME, (), -1.0, np.zeros(4), np.diag([START**2, RATE_START**2, 1e-6, 1e-4]))
    start = np.zeros((TIME.size, SIZE))
    start[:, TEMPERATURE] = signal
    stated = constants(NAME, 0, 1e-6)
    near = fit(chain, [Scaled(signal)], stated, DYNAMICS, start, np.zeros(1), 0)
    found, spread, loose, facts = in_doubt(chain, [Scaled(signal)], stated, near)

    levels, moments = np.append(0.0, np.linspace(-0.9, 0.9, 181)), []
    for level in levels:
        seen = np.exp(level) * covariance()
        whole = np.exp(level) * seen + NOISE**2 * np.eye(TIME.size)
        own = covariance() - seen @ np.linalg.solve(whole, seen)
        likely = multivariate_normal(None, whole).logpdf(signal)
        moments.append((likely, seen @ np.linalg.solve(whole, signal), np.diag(own)))
    likely, paths, variances = map(np.array, zip(*moments, strict=True))
    weight = CHANCE * 0.01 * norm(0, WIDTH).pdf(levels)
    weight[0] = 1 - CHANCE
    weight *= np.exp(likely - likely.max())
    weight /= weight.sum()
    path = weight @ paths
    deviation = np.sqrt(weight @ (variances + (paths - path) ** 2))
    assert facts["throughput_chance"] == pytest.approx(1 - weight[0], abs=0.02)
    assert facts["throughput"] == pytest.approx(np.exp(weight[1:] @ levels[1:] / weight[1:].sum()), rel=0.03)
    np.testing.assert_allclose(found.path[:, TEMPERATURE], path, atol=0.1 * deviation.max())
    np.testing.assert_allclose(np.sqrt(spread.path[:, TEMPERATURE, TEMPERATURE]), deviation, rtol=0.1)
    row = of_family(NAME, "calibration", spread.across, loose.deviation)
    between = np.sqrt(weight @ (paths - path) ** 2)
    np.testing.assert_allclose(np.abs(row.contribution), between, atol=0.1 * between.max())


@dataclasses.dataclass(frozen=True)
class Pair:
    """Signals (2, t) = e^(z + g_i) T + noise: what gains share is the level, what they do not the ratio."""

    signal: np.ndarray
    table = Alike()

    def gains(self, values, of):
        return np.exp(values[of(NAME)] + values[of(GAINS)])[:, None]

    def residual(self, path, values, of):
        return (self.signal - self.gains(values, of) * path[:, TEMPERATURE]) / NOISE

    def state_matrix(self, path, values, of):
        matrix = np.zeros((len(path), SIZE, SIZE))
        matrix[:, TEMPERATURE, TEMPERATURE] = np.sum((self.gains(values, of) / NOISE) ** 2)
        return matrix

    def information(self, path, values, of):
        rest, slope = self.residual(path, values, of), self.gains(values, of) / NOISE
        by = np.zeros((2, len(path), values.size))
        for band, place in enumerate(of(GAINS)):
            by[band][:, [place, of(NAME)[0]]] = (slope * path[:, TEMPERATURE])[band][:, None]
        gradient, border = np.zeros((len(path), SIZE)), np.zeros((len(path), SIZE, values.size))
        gradient[:, TEMPERATURE] = -np.sum(slope * rest, axis=0)
        border[:, TEMPERATURE] = np.einsum("b,bnp->np", slope[:, 0], by)
        corner, constant = np.einsum("bnp,bnq->pq", by, by), -np.einsum("bnp,bn->p", by, rest)
        half = 0.5 * np.sum(rest**2)
        return Information(half, gradient, self.state_matrix(path, values, of), border, corner, constant)


@pytest.mark.parametrize("off", [0.0, 0.015, 0.02])
def test_a_ratio_in_doubt_has_the_exact_chance(off):
    """Against two gains and the level, integrated over on a grid: T leaves two numbers per mode."""
    tight, random = 0.005, np.random.default_rng(9)
    truth = random.multivariate_normal(np.zeros(TIME.size), covariance())
    signal = truth * np.exp(off * np.array([[0.5], [-0.5]])) + NOISE * random.standard_normal((2, TIME.size))
    power, modes = np.linalg.eigh(covariance())
    seen = signal @ modes

    def evidence(level, width):
        """Logarithm of the density of the signals with gains (2,) of a standard deviation."""
        apart, both = np.linspace(-5.0, 5.0, 201)[:, None] * width, np.linspace(-4.0, 4.0, 15) * width
        gain = np.exp(level + np.stack([both + apart / 2, both - apart / 2]))
        whole = NOISE**2 + power * np.sum(gain**2, axis=0)[..., None]
        along = np.einsum("bij,bm->ijm", gain, seen) ** 2 * power / whole
        likely = np.sum((along - np.sum(seen**2, axis=0)) / NOISE**2 - np.log(whole), axis=-1) / 2
        own = norm(0, np.sqrt(2) * width).logpdf(apart) + norm(0, width / np.sqrt(2)).logpdf(both)
        return logsumexp(likely + own) + np.log((apart[1, 0] - apart[0, 0]) * (both[1] - both[0]))

    levels = np.linspace(-0.9, 0.9, 19)
    free = logsumexp([evidence(z, tight) + norm(0, WIDTH).logpdf(z) for z in levels]) + np.log(0.1)
    wide = np.hypot(tight, RATIO_WIDTH / np.sqrt(2))
    log = np.array([evidence(0.0, tight), free, evidence(0.0, wide)])
    log += np.log([(1 - CHANCE) * (1 - RATIO_CHANCE), CHANCE, (1 - CHANCE) * RATIO_CHANCE])
    exact = np.exp(log - logsumexp(log))

    chain = Chain(TIME, (), -1.0, np.zeros(4), np.diag([START**2, RATE_START**2, 1e-6, 1e-4]))
    stated = constants(GAINS, np.zeros(2), tight) + constants(NAME, 0, 1e-6)
    start = np.zeros((TIME.size, SIZE))
    start[:, TEMPERATURE] = signal.mean(axis=0)
    near = fit(chain, [Pair(signal)], stated, DYNAMICS, start, np.zeros(3), 0)
    facts = in_doubt(chain, [Pair(signal)], stated, near)[3]
    assert facts["ratio_chance"] == pytest.approx(exact[2], abs=0.03), exact
    assert facts["throughput_chance"] == pytest.approx(exact[1], abs=0.03)
