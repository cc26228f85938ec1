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
KAISER_SHAPE = 0.6 * np.pi * KAISER_POINTS  # pi/2 times points times (2 - 0.8): up to 0.8 of the highest


def broad_share(phase):
    r"""Share of a Fourier component that belongs to the broad part.

    .. math:: \chi(\theta) = \frac{\operatorname{erf} \frac{\theta + c \pi}{w \pi}
              - \operatorname{erf} \frac{\theta - c \pi}{w \pi}}{2 \operatorname{erf} \frac{c}{w}}

    with c = `CROSSING`, w = `TRANSITION`.

    Parameters
    ----------
    phase : array_like [1]
        Angular frequency times step of the coarse grid, :math:`\theta`.

    Returns
    -------
    ndarray [1]
        1 for the slowest, 0 for the fastest that the coarse grid holds; without a kink, so that the rest
        fades within a window as a Gaussian does.

    Notes
    -----
    Source: the splitting of P. P. Ewald, Ann. Phys. 369 (1921) 253, with the sharp part on the spot.
    """
    place = np.asarray(phase) / np.pi
    # erfc, not erf: the tail keeps its digits.
    share = erfc((place - CROSSING) / TRANSITION) - erfc((place + CROSSING) / TRANSITION)
    return share / (2 * erf(CROSSING / TRANSITION))


def kaiser(fraction):
    r"""Kaiser-Bessel kernel that puts a line on the coarse grid.

    .. math:: K(x) = \frac{\beta}{p \sinh\beta} I_0\left(\beta \sqrt{1 - (2 x / p)^2}\right)

    Parameters
    ----------
    fraction : (L,) [1]
        Of a step, from the edge of the kernel to the first point.

    Returns
    -------
    ndarray (p, L) [1]
        At the p = `KAISER_POINTS` points; of integral 1, and sum 1 to 1e-12.

    Notes
    -----
    Source: J. I. Jackson et al., IEEE Trans. Med. Imaging 10 (1991) 473.
    """
    place = 2 * (fraction + np.arange(KAISER_POINTS)[:, None]) / KAISER_POINTS - 1
    root = KAISER_SHAPE * np.sqrt(np.maximum(1 - place**2, 0))
    whole = KAISER_POINTS / KAISER_SHAPE * -np.expm1(-2 * KAISER_SHAPE) / 2
    return i0e(root) * np.exp(root - KAISER_SHAPE) / whole


def kaiser_transform(phase):
    r"""Fourier transform of the kernel.

    .. math:: \hat K(\theta) = \frac{\beta}{\sinh\beta} \frac{\sinh s}{s}, \qquad
              s = \sqrt{\beta^2 - (p \theta / 2)^2}

    Parameters
    ----------
    phase : array_like [1]
        Angular frequency times step of the coarse grid, 0 to pi.

    Returns
    -------
    ndarray [1]

    Notes
    -----
    Source: Jackson et al. (1991), equation 12.
    """
    root = np.sqrt(KAISER_SHAPE**2 - (KAISER_POINTS / 2 * np.asarray(phase)) ** 2)
    return KAISER_SHAPE / np.sinh(KAISER_SHAPE) * np.sinh(root) / root


@dataclass(frozen=True)
class SharpLines:
    """The lines whose windows reach the grid: which (N,), their first points on the grid with margins (N,).

    `rate` (R,) [1]: angular frequencies of a window; `place` (N, R) [1]: transform of a line of no width.
    """

    lines: np.ndarray
    start: np.ndarray
    rate: np.ndarray
    place: np.ndarray
    points: int


def sharp_lines(place, points, step):
    """Windows around lines at their places on the grid.

    Parameters
    ----------
    place : (L,) [1]
        Of the lines, in steps from the first point of the grid.
    points : int
        Of the grid.
    step : float [1]
        Of the grid, in the logarithm of the wavenumber.

    Returns
    -------
    SharpLines
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
        points,
    )


def sharp_part(windows, strength, relative, sigma):
    """Sum over the lines of the sharp parts of their Voigt profiles on the grid (G,).

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
    rate = windows.rate
    decay = relative[windows.lines, None] * -rate
    decay -= (sigma * rate) ** 2 / 2
    np.exp(decay, out=decay)
    decay *= strength[windows.lines, None]
    profiles = irfft(windows.place * decay, n=WINDOW, overwrite_x=True)
    total = np.zeros(windows.points + 2 * WINDOW)
    for start, profile in zip(windows.start.tolist(), profiles, strict=True):
        total[start : start + WINDOW] += profile
    return total[WINDOW : WINDOW + windows.points]
