r"""Temperature and emissivity together, from light in any number of channels.

.. math:: y_c = \int R_c(\lambda)\,\varepsilon(\lambda)\,B_\lambda(T)\,d\lambda + \sum_m z_m g_{mc}, \qquad
          \ln\varepsilon(\lambda) = \ln\bar\varepsilon(\lambda) + \sum_k a_k \phi_k(\lambda)

The coefficients have a unit normal prior each; 1/T has none. In Wien's limit an emissivity that changes as
:math:`\exp(c_2\delta/\lambda)` and a temperature with 1/T larger by :math:`\delta` give the same light: along
that direction only the prior decides, and `Posterior` says how much of the uncertainty that is.
"""

from typing import NamedTuple

import numpy as np

from plasmapyro.radiation.planck import planck_and_slope
from plasmapyro.record.emittance import course

KEPT = 1e-7  # of the largest variance: shapes of the emissivity of less are left out
STEPS = 400  # Gauss-Newton steps allowed; 5 to 10 suffice, 300 for a signal to noise of 1e5
LARGEST_STEP = 0.1  # relative, of 1/T in one of them
CONVERGED = 1e-6  # relative, of 1/T: 1 mK
UNIT = 1000.0  # [K] over T is what a state begins with: near Wien's limit ln(B) is straight in it
CHUNK = 2_000_000  # numbers held at once per array
FIRST_DAMPING = 1e-3  # of the diagonal, after a step that made it worse (Levenberg and Marquardt)
NO_WAY_DOWN = 1e6  # damping at which only rounding is left
ROUNDING = 1e-12  # relative, of the objective
TINY = 1e-12  # of the unit variance of a coefficient, so that a constant keeps an inverse
TRIALS = (250.0, 6000.0, 400)  # [K], [K] and number of the temperatures among which a fit begins


class Channels(NamedTuple):
    """What C channels see of B wavelengths: `weight` (C, B) signal per radiance; None: each is a pixel."""

    wavelength: np.ndarray  # (B,) [m]
    weight: np.ndarray | None = None

    def detect(self, radiance):
        """Signals (..., C) of radiances (..., B)."""
        return radiance if self.weight is None else radiance @ self.weight.T

    def slopes(self, radiance, basis):
        """Signals (..., C, K) of radiances (..., B) times each of K shapes (B, K)."""
        if self.weight is None:
            return radiance[..., None] * basis
        tensor = self.weight.T[:, :, None] * basis[:, None, :]
        flat = radiance @ tensor.reshape(len(basis), -1)
        return flat.reshape(*radiance.shape[:-1], *tensor.shape[1:])


class Prior(NamedTuple):
    """What is known of the emissivity before the light is seen."""

    logarithm: np.ndarray  # (B,) of its mean
    basis: np.ndarray  # (B, K) change of ln(emissivity) per unit of each coefficient


class Posterior(NamedTuple):
    """What is known afterwards, for n samples; the state is (1000 K/T, a, z)."""

    state: np.ndarray  # (n, 1 + K + M)
    covariance: np.ndarray  # (n, 1 + K + M, 1 + K + M)
    residual: np.ndarray  # (n, C) in standard deviations of the noise, NaN where there was no signal
    noise_only: np.ndarray  # (n,) relative standard uncertainty of T with all coefficients known
    converged: np.ndarray  # (n,) bool

    @property
    def evidence(self):
        """(n,) logarithm of the probability of the signal, by Laplace's method, but for a constant."""
        size = np.nansum(self.residual**2, axis=1) + np.sum(self.state[:, 1:] ** 2, axis=1)
        return (np.linalg.slogdet(self.covariance)[1] - size) / 2

    @property
    def temperature(self):
        """(n,) [K]."""
        return UNIT / self.state[:, 0]

    @property
    def relative_uncertainty(self):
        """(n,) relative standard uncertainty of T."""
        return np.sqrt(self.covariance[:, 0, 0]) / self.state[:, 0]


def smooth_prior(wavelength, mean, *, level, shape, length):
    """`Prior` of an emissivity that is smooth over wavelength.

    Parameters
    ----------
    wavelength : (B,) array [m]
    mean : (B,) array or float [1], > 0
    level : float [1]
        Standard deviation of the logarithm of the level as a whole.
    shape, length : see `record.emittance.course`
    """
    wavelength = np.asarray(wavelength, dtype=float)
    logarithm = np.log(np.broadcast_to(mean, wavelength.shape))
    return Prior(logarithm, modes(level**2 + course(wavelength, shape, length)))


def modes(covariance):
    """Shapes (B, K), each with a coefficient of variance 1, of a covariance (B, B): few where it is smooth.

    Source: Rasmussen & Williams, Gaussian Processes for Machine Learning (2006), sec. 4.3.
    """
    variance, vectors = np.linalg.eigh(covariance)
    kept = variance > KEPT * variance[-1]
    return (vectors * np.sqrt(np.maximum(variance, 0.0)))[:, kept][:, ::-1]


def infer(channels, prior, signal, noise, linear=None, known=None, begin=None, gains=None):
    """Temperature and coefficients of the largest posterior density, each sample by itself.

    Parameters
    ----------
    channels : Channels
    prior : Prior
    signal, noise : (n, C) arrays, same unit
        Standard uncertainty independent between channels; NaN in either: the channel is left out.
    linear : (n, C, M) array, optional
        Light g of unit coefficients z that adds: what is left of the gas, stray light.
    known : pair of (n, K + M + G) mean and (n, K + M + G, K + M + G) precision, optional
        Of the coefficients, instead of unit normals.
    begin : (n,) array [K], optional
        Temperatures to begin with, see `beginning`.
    gains : (n, C, G) array, optional
        Change of the logarithm of the light of the surface per unit of further coefficients.

    Returns
    -------
    Posterior
        NaN for samples without a channel.
    """
    signal, noise = (np.asarray(one, dtype=float) for one in (signal, noise))
    linear, gains = (np.zeros((*signal.shape, 0)) if one is None else one for one in (linear, gains))
    count = prior.basis.shape[1] + linear.shape[-1] + gains.shape[-1]
    begin = beginning(channels, prior, signal, noise) if begin is None else begin
    size = max(1, CHUNK // (signal.shape[1] * (1 + count) + channels.wavelength.size))
    parts = []
    for first in range(0, len(signal), size):
        rows = (one[first : first + size] for one in (signal, noise, linear, gains, begin))
        own = known and [one[first : first + size] for one in known]
        parts.append(_infer(channels, prior, *rows, own))
    return Posterior(*(np.concatenate(one) for one in zip(*parts, strict=True)))


def _weighted(signal, noise):
    """Signals and inverse noise (n, C), both 0 where there is none."""
    good = np.isfinite(signal) & np.isfinite(noise) & (noise > 0)
    return np.where(good, signal, 0.0), np.where(good, 1 / np.where(good, noise, 1.0), 0.0)


def _infer(channels, prior, signal, noise, linear, gains, begin, known):
    rows, count = len(signal), prior.basis.shape[1] + linear.shape[-1] + gains.shape[-1]
    signal, weight = _weighted(signal, noise)
    good = weight > 0
    linear = np.where(good[..., None], linear, 0.0)
    mean, precision = known or (np.zeros((rows, count)), np.broadcast_to(np.eye(count), (rows, count, count)))
    state = np.concatenate([np.zeros((rows, 1)), mean], axis=1)
    state[:, 0] = UNIT / begin
    shapes, last = prior.basis.shape[1], 1 + prior.basis.shape[1] + linear.shape[-1]
    full = np.zeros((rows, 1 + count, 1 + count))
    full[:, 1:, 1:] = precision

    def look(state):
        """Objective (n,), Jacobian and residuals, both in standard deviations."""
        body, by_kelvin = planck_and_slope(channels.wavelength, UNIT / state[:, 0])
        emissivity = np.exp(prior.logarithm + state[:, 1 : 1 + shapes] @ prior.basis.T)
        # Not over the light as seen: its noise, times a gain, would be learned as one, sample by sample.
        gain = np.exp(np.einsum("ncg,ng->nc", gains, state[:, last:]))[..., None]
        surface = channels.detect(emissivity * body)[..., None] * gain
        own = surface[..., 0] + np.einsum("ncm,nm->nc", linear, state[:, 1 + shapes : last])
        slope = channels.detect(-emissivity * by_kelvin * UNIT / state[:, :1] ** 2)[..., None] * gain
        parts = [slope, channels.slopes(emissivity * body, prior.basis) * gain, linear, surface * gains]
        rest = (signal - own) * weight
        off = state[:, 1:] - mean
        objective = np.sum(rest**2, axis=1) + np.einsum("ni,nij,nj->n", off, precision, off)
        return objective, np.concatenate(parts, axis=-1) * weight[..., None], rest

    now, jacobian, rest = look(state)
    damping, settled = np.zeros(rows), np.zeros(rows, dtype=bool)
    for turn in range(STEPS + 1):
        matrix = full + np.swapaxes(jacobian, 1, 2) @ jacobian
        matrix[:, 0, 0] += np.where(matrix[:, 0, 0] > 0, 0.0, 1.0)
        if turn == STEPS or settled.all():
            break
        pull = np.einsum("nck,nc->nk", jacobian, rest)
        pull[:, 1:] -= np.einsum("nij,nj->ni", precision, state[:, 1:] - mean)
        damped = matrix * (1 + damping[:, None, None] * np.eye(1 + count))
        move = np.linalg.solve(damped, pull[..., None])[..., 0]
        size = np.abs(move[:, :1] / state[:, :1])
        # A long step in T is shortened as a whole: the coefficients belong to it.
        move *= np.minimum(1.0, LARGEST_STEP / np.maximum(size, 1e-300))
        trial = state + np.where(settled[:, None], 0.0, move)
        then, slopes, left = look(trial)
        better = ~(then > now * (1 + ROUNDING))
        settled |= better & (size[:, 0] < CONVERGED) | (damping > NO_WAY_DOWN)
        state = np.where(better[:, None], trial, state)
        now, rest = np.where(better, then, now), np.where(better[:, None], left, rest)
        jacobian = np.where(better[:, None, None], slopes, jacobian)
        damping = np.where(better, damping / 10, np.maximum(10 * damping, FIRST_DAMPING))
    covariance = np.linalg.inv(matrix)
    enough = good.any(axis=1) & np.isfinite(state).all(axis=1)
    blank = np.where(enough, 1.0, np.nan)
    return Posterior(
        state * blank[:, None],
        covariance * blank[:, None, None],
        np.where(good & enough[:, None], rest, np.nan),
        blank / np.sqrt(matrix[:, 0, 0]) / state[:, 0],
        settled & enough,
    )


def beginning(channels, prior, signal, noise):
    """Temperature (n,) [K] at which the mean emissivity gives the signal of the clearest channel."""
    signal, weight = _weighted(signal, noise)
    trials = np.linspace(1 / TRIALS[1], 1 / TRIALS[0], TRIALS[2])
    mean = np.exp(prior.logarithm)
    curves = np.log(channels.detect(mean * planck_and_slope(channels.wavelength, 1 / trials)[0]))
    clearest = np.argmax(signal * weight, axis=1)
    seen = np.log(np.maximum(np.take_along_axis(signal, clearest[:, None], 1)[:, 0], 1e-300))
    inverse = np.empty(len(signal))
    for channel in np.unique(clearest):  # signals fall with 1/T
        rows = clearest == channel
        inverse[rows] = np.interp(-seen[rows], -curves[:, channel], trials)
    return 1 / inverse


def follow(channels, prior, kept, signal, noise, linear, gains=None, start=None):
    r"""As `infer`, for samples after one another: what is known of the coefficients carries over.

    .. math:: a_{n+1} = r_n\,a_n + \sqrt{1 - r_n^2}\,w_n

    The temperature is free from sample to sample.

    Parameters
    ----------
    channels, prior, signal, noise, linear, gains : as in `infer`
    kept : (n - 1, K + M + G) array [1]
        r of each coefficient from sample to sample: 0 for none, 1 for a constant.
    start : (K + M + G,) array, optional
        Variance of each coefficient before the first sample; 1 by default.

    Returns
    -------
    Posterior
        Of each sample, given all of them.

    Notes
    -----
    Source: extended Kalman filter, and Rauch, Tung & Striebel, AIAA J. 3, 1445 (1965), backwards. Samples
    that hold no light carry what is known over.
    """
    count = kept.shape[1]
    mean, covariance = np.zeros(count), np.diag(np.ones(count) if start is None else start + TINY)
    before, parts, begin = [], [], beginning(channels, prior, signal, noise)
    for n in range(len(signal)):
        before.append((mean, covariance))
        known = mean[None], np.linalg.inv(covariance)[None]
        one = slice(n, n + 1)
        own = None if gains is None else gains[one]
        parts.append(infer(channels, prior, signal[one], noise[one], linear[one], known, begin[one], own))
        if parts[-1].converged[0]:
            mean, covariance = parts[-1].state[0, 1:], parts[-1].covariance[0, 1:, 1:]
        if n < len(kept):
            mean = kept[n] * mean
            covariance = kept[n][:, None] * covariance * kept[n] + np.diag(1 - kept[n] ** 2 + TINY)
    found = Posterior(*(np.concatenate(one) for one in zip(*parts, strict=True)))
    later = None
    for n in range(len(signal) - 1, -1, -1):
        if later is not None:
            ahead, spread = before[n + 1]
            told = found.converged[n]
            state, own = found.state[n], found.covariance[n]
            if not told:  # of a sample without light, its temperature of no meaning
                state, own = np.append(0.0, before[n][0]), np.pad(before[n][1], ((1, 0), (1, 0)))
            gain = own[:, 1:] * kept[n] @ np.linalg.inv(spread)
            state = state + gain @ (later[0][1:] - ahead)
            own = own + gain @ (later[1][1:, 1:] - spread) @ gain.T
            if told:
                found.state[n], found.covariance[n] = state, own
            later = state, own
        elif found.converged[n]:
            later = found.state[n].copy(), found.covariance[n].copy()
    return found


def log_emissivity(posterior, logarithm, basis):
    """Logarithm of the emissivity (n, N) and its standard uncertainty (n, N).

    Parameters
    ----------
    posterior : Posterior
    logarithm, basis : (N,), (N, K) arrays
        Of the prior, at the wavelengths wanted; coefficients beyond K are no emissivity.
    """
    shapes = slice(1, 1 + basis.shape[1])
    value = logarithm + posterior.state[:, shapes] @ basis.T
    variance = np.einsum("bk,nkl,bl->nb", basis, posterior.covariance[:, shapes, shapes], basis)
    return value, np.sqrt(variance)
