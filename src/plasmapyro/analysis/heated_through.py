"""What a record says of the gas, where its surface is heated through the least reading behind it."""

import numpy as np
from scipy.optimize import least_squares

SPAN = 80.0  # [K] above the least reading that belong to its window
RISE, SIGMAS = 20.0, 4.0  # [K] and standard deviations that readings rise on both sides of the least
FALL, HIGH = 100.0, 300.0  # [K]: least fall from the cold side; level up to which both sides are compared
SLOWER = 1.3  # times the fall that the rise to an equal level takes: 1.8 for an even heating, 1 for a dip
MEDIAN = 5  # readings in a running median
ORDERS = range(1, 6)  # of the polynomial in time that the surface follows within the window
GAP = 3  # readings from one to the next in the window, at most
SPARE = 4  # readings in the window beyond the order
ROUGH = 2.0  # times the noise: what is left about a smooth course at most
MOST = 400  # readings in the fit
LARGEST_SHIFT = 3.0  # standard uncertainties by which the record may move the gas
FULL_COLD = 2.0  # spans: the first reading before the window counts up to here


def scatter(reading):
    """Standard deviation [K] of single readings about a smooth course, from third differences.

    Zero with fewer than a dozen readings.
    """
    good = reading[np.isfinite(reading)]
    if good.size < 12:
        return 0.0
    return float(np.median(np.abs(np.diff(good, 3))) / (0.6745 * np.sqrt(20.0)))


def heated_through(time, reading, display, turn, centre, covariance, noise):
    r"""Gas and moment of the least reading, where the surface is heated through it; None elsewhere.

    As a cold surface warms up behind gas, the display falls to the least that this gas lets any surface show,
    and rises again: whatever the surface, that reading belongs to the gas. In the window around it the
    course of the surface is a polynomial in time, fitted together with the gas:

    .. math:: \sum_i \Big(\frac{r_i - D(T(t_i), g)}{\sigma}\Big)^2
              + (g - g_0)^T C^{-1} (g - g_0) \to \min

    The order is that of the least :math:`n\ln\sigma^2 + p\ln n`; the noise is at least as stated.

    Parameters
    ----------
    time, reading : (t,) arrays [s], [K]
        NaN where there is no reading.
    display : callable
        Display [K] of surfaces (n,) [K] behind the gas g (2,).
    turn : callable
        Surface temperature [K] of the least display behind g, and that display [K].
    centre, covariance : (2,), (2, 2) arrays
        Of g, logarithm of the gas's signals over the emittance, before the record is seen.
    noise : float [K]
        Standard deviation of one reading.

    Returns
    -------
    tuple of (2,) array, (2, 2) array and float [s], or None
        Centre and covariance of g, moment of the turn. None where the readings do not fall and rise about
        their least, or where it is no reading that this gas allows.
    """
    good = np.flatnonzero(np.isfinite(reading))
    if good.size <= SPARE or not noise or not np.linalg.det(covariance) > 0:
        return None
    window = _window(time[good], reading[good], noise)
    if window is None:
        return None
    least, window = good[window[0]], good[window[1]]
    if window.size <= SPARE or np.diff(window).max() > GAP:  # the least reading itself may be missing
        return None
    window = window[:: -(-window.size // MOST)]
    half = np.ptp(time[window]) / 2
    x = (time[window] - time[window].mean()) / half
    root = np.linalg.cholesky(covariance)
    warm, lowest = turn(centre)
    shown = reading[window] + lowest - reading[window].min()
    cold_side = time[window] < time[least]
    start = _start(display, centre, warm, shown, cold_side)
    best = None
    for order in ORDERS:
        if window.size < order + SPARE:
            break
        guess = np.concatenate([[0.0, 0.0], np.polyfit(x, start, order)])

        def residual(p, sigma):
            surface = np.polyval(p[2:], x)
            return np.concatenate(
                [(reading[window] - display(surface, centre + root @ p[:2])) / sigma, p[:2]]
            )

        sigma = noise
        for _ in range(2):  # with the noise as stated, then as found
            found = least_squares(residual, guess, x_scale="jac", max_nfev=100, args=(sigma,))
            rest = sigma * found.fun[:-2]
            sigma = max(noise, float(np.sqrt(rest @ rest / (window.size - order - 1))))
            guess = found.x
        score = window.size * np.log(sigma**2) + order * np.log(window.size)
        if best is None or score < best[0]:
            best = score, found, sigma
    if best is None or best[2] > ROUGH * noise:
        return None
    found = best[1]
    shift, spread = found.x[:2], np.linalg.inv(found.jac.T @ found.jac)[:2, :2]
    if np.linalg.norm(shift) > LARGEST_SHIFT:
        return None
    gas = centre + root @ shift
    surface = np.polyval(found.x[2:], x)
    warm = turn(gas)[0]
    passed = np.flatnonzero((surface[:-1] < warm) & (surface[1:] >= warm))
    if passed.size != 1:
        return None
    k = passed[0]
    share = (warm - surface[k]) / (surface[k + 1] - surface[k])
    moment = time[window[k]] + share * (time[window[k + 1]] - time[window[k]])
    return gas, root @ spread @ root.T, float(moment)


def _window(time, reading, noise):
    """Place of the least reading and those around it; None where no surface was heated through it."""
    width = MEDIAN if reading.size > 6 * MEDIAN else 1
    padded = np.pad(reading, width // 2, mode="edge")
    smooth = np.median(np.lib.stride_tricks.sliding_window_view(padded, width), axis=-1)
    least = int(smooth.argmin())
    above = smooth - smooth[least]
    fall, rise = above[:least].max(initial=0.0), above[least:].max()
    if fall < FALL or rise < max(RISE, SIGMAS * noise):
        return None
    level = min(fall, rise, HIGH)
    fell = np.flatnonzero(above[:least] >= level)[-1]
    rose = least + np.flatnonzero(above[least:] >= level)[0]
    if time[rose] - time[least] < SLOWER * (time[least] - time[fell]):
        return None
    outside = np.flatnonzero(above > SPAN)
    first = outside[outside < least].max(initial=-1) + 1
    last = outside[outside > least].min(initial=reading.size)
    if first > 0 and above[first - 1] < FULL_COLD * SPAN:
        first -= 1
    return least, np.arange(first, last)


def _start(display, gas, warm, shown, cold_side):
    """Surfaces to begin with: cold before the least reading, hot after it."""
    cold, hot = np.linspace(warm - 400.0, warm, 201), np.linspace(warm, warm + 800.0, 401)
    return np.where(
        cold_side,
        np.interp(-shown, -display(cold, gas), cold),
        np.interp(shown, display(hot, gas), hot),
    )
