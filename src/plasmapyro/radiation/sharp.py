"""Spectra of few lines in two parts: broad, on a coarse grid, and sharp, in a window around each line."""

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft
from scipy.special import erf, erfc, i0e

COARSENING = 8  # grid steps in one of the coarse grid
WINDOW = 320  # grid points around a line; 1e-8 of a sharp part lies beyond
CROSSING = 0.41  # [1], of the highest angular frequency of the coarse grid, where half of it is sharp
TRANSITION = 0.137  # [1], same, width of the crossing; 1e-9 of the highest frequency is broad
KAISER_POINTS = 16  # of the coarse grid that take a line; its transform repeats at 1e-9 and less
IMAGED = 0.6  # [1], angular frequency times grid step from which the image beyond the grid's highest counts
RESOLVED = 2.1  # Doppler sigma in grid steps from which less than exp(-(2.1 pi)^2 / 2) = 4e-10 lies beyond it
KAISER_SHAPE = 0.6 * np.pi * KAISER_POINTS  # pi/2 times points times (2 - 0.8): up to 0.8 of the highest


def broad_share(phase):
    r"""Share of a Fourier component that belongs to the broad part.

    .. math:: \chi(\theta) = \frac{\operatorname{erf} \frac{\theta + c \pi}{w \pi}
              - \operatorname{erf} \frac{\theta - c \pi}{w \pi}}{2 \operatorname{erf} \frac{c}{w}}

    with c = `CROSSING`, w = `TRANSITION`.

    Source: the splitting of P. P. Ewald, Ann. Phys. 369 (1921) 253, with the sharp part on the spot.

    Parameters
    ----------
    phase : array_like [1]
        Angular frequency times step of the coarse grid, :math:`\theta`.

    Returns
    -------
    ndarray [1]
        1 for the slowest, 0 for the fastest that the coarse grid holds; without a kink, so that the rest
        fades within a window as a Gaussian does.
    """
    place = np.asarray(phase) / np.pi
    # erfc, not erf: the tail keeps its digits.
    share = erfc((place - CROSSING) / TRANSITION) - erfc((place + CROSSING) / TRANSITION)
    return share / (2 * erf(CROSSING / TRANSITION))


def kaiser(fraction):
    r"""Kaiser-Bessel kernel (p, L) [1] that puts lines on the coarse grid, at p = `KAISER_POINTS` points.

    .. math:: K(x) = \frac{\beta}{p \sinh\beta} I_0\left(\beta \sqrt{1 - (2 x / p)^2}\right)

    `fraction` (L,): of a step, from the edge of the kernel to the first point; of integral 1, and sum 1 to
    1e-12. Source: J. I. Jackson et al., IEEE Trans. Med. Imaging 10 (1991) 473.
    """
    place = 2 * (fraction + np.arange(KAISER_POINTS)[:, None]) / KAISER_POINTS - 1
    root = KAISER_SHAPE * np.sqrt(np.maximum(1 - place**2, 0))
    whole = KAISER_POINTS / KAISER_SHAPE * -np.expm1(-2 * KAISER_SHAPE) / 2
    return i0e(root) * np.exp(root - KAISER_SHAPE) / whole


def kaiser_transform(phase):
    r"""Fourier transform of the kernel, at angular frequencies times the step of the coarse grid, 0 to pi.

    .. math:: \hat K(\theta) = \frac{\beta}{\sinh\beta} \frac{\sinh s}{s}, \qquad
              s = \sqrt{\beta^2 - (p \theta / 2)^2}

    Source: Jackson et al. (1991), equation 12.
    """
    root = np.sqrt(KAISER_SHAPE**2 - (KAISER_POINTS / 2 * np.asarray(phase)) ** 2)
    return KAISER_SHAPE / np.sinh(KAISER_SHAPE) * np.sinh(root) / root


@dataclass(frozen=True)
class SharpLines:
    """The lines whose windows reach the grid: which (N,), their first points on the grid with margins (N,).

    `rate` (R,) [1]: angular frequencies of a window; `place` (N, R) [1]: transform of a line of no width;
    `turn` (N,) [1]: phase of its image beyond the highest frequency; `step` of the grid.
    """

    lines: np.ndarray
    start: np.ndarray
    rate: np.ndarray
    place: np.ndarray
    turn: np.ndarray
    points: int
    step: float


def sharp_lines(place, points, step):
    """Windows around lines at places (L,) on the grid, in steps from its first point.

    `step` [1] of the grid's `points`, in the logarithm of the wavenumber.
    """
    nearest = np.rint(place).astype(int)
    lines = np.flatnonzero((nearest > -WINDOW // 2) & (nearest < points + WINDOW // 2))
    phase = 2 * np.pi * np.arange(WINDOW // 2 + 1) / WINDOW
    # From the first point of the window to the line.
    offset = (place - nearest)[lines] + WINDOW // 2
    return SharpLines(
        lines,
        nearest[lines] + WINDOW // 2,
        phase / step,
        np.exp(-1j * phase * offset[:, None]) * ((1 - broad_share(COARSENING * phase)) / step),
        np.exp(2j * np.pi * offset),
        points,
        step,
    )


def sharp_part(windows, strength, relative, sigma):
    """Sum over the lines of the sharp parts of their Voigt profiles on the grid (G,).

    Source: Poisson's sum. A profile that the grid hardly resolves is sampled, not cut off at the highest
    frequency of the grid, which would make it ring below zero: its first image is added there.

    Parameters
    ----------
    windows : SharpLines
    strength, relative : (L,) [any], [1]
        Of all lines: integral, and Lorentz half width over wavenumber.
    sigma : float [1]
        Relative Doppler standard deviation.

    Returns
    -------
    ndarray (G,) [strength]
        Per unit of the logarithm of the wavenumber, as `opacity.spread`.
    """
    width, own = relative[windows.lines, None], strength[windows.lines, None]
    wave = windows.place * _transform(own, width, sigma, windows.rate)
    if sigma < RESOLVED * windows.step:
        high = np.flatnonzero(windows.rate * windows.step > IMAGED)
        image = _transform(own, width, sigma, 2 * np.pi / windows.step - windows.rate[high])
        wave[:, high] += windows.turn[:, None] * windows.place[:, high] * image
    profiles = irfft(wave, n=WINDOW, overwrite_x=True)
    total = np.zeros(windows.points + 2 * WINDOW)
    for start, profile in zip(windows.start.tolist(), profiles, strict=True):
        total[start : start + WINDOW] += profile
    return total[WINDOW : WINDOW + windows.points]


def _transform(strength, relative, sigma, rate):
    """Fourier transforms (N, R) of Voigt profiles at their centres; strength, relative (N, 1)."""
    decay = relative * -rate
    decay -= (sigma * rate) ** 2 / 2
    np.exp(decay, out=decay)
    decay *= strength
    return decay
