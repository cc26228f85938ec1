"""Two clocks of one test: by how much spectra must be moved to fit the pyrometer."""

from typing import NamedTuple

import numpy as np
from scipy.integrate import cumulative_trapezoid

from plasmapyro.record import flags

FARTHEST, STEP = 1.5, 0.05  # [s]: up to where, and in which steps, it is looked for
FRAMES, DIM = 8, 0.02  # fewer spectra, brighter than so much of the brightest, do not tell a lag
CLEARER = 1.5  # times the residual at another lag; normal noise of 30 spectra makes it 1.3 once in 1000 cases
# Spectra that fit a surface, and how clear an offset must be: normal noise makes it so once in 1000 cases.
FEWER = {5: 18.0, 6: 6.5, 7: 4.0, 8: 3.0, 9: 2.4, 10: 2.1, 11: 1.9, 12: 1.8}
SMALLEST = 0.003  # [1] residual that harms nothing


def lag(time, pair, moments, light, length, lags, bends=False):
    """Root mean square (L,) of what is left if spectra are moved by `lags` (L,) [s] against the pyrometer.

    The light (S,), > 0, of a spectrum is taken as a sum of both bands `pair` (2, t), averaged over its
    exposure of `length` [s] about `moments` (S,) [s], and a constant: light adds up. Residuals are relative;
    NaN where an exposure has no samples. Where the light `bends` (counts of a detector, as they are) a sum of
    it and of its square is.
    """
    total = np.concatenate(
        [np.zeros((2, 1)), np.cumsum((pair[:, 1:] + pair[:, :-1]) / 2 * np.diff(time), axis=1)], axis=1
    )
    found = np.full(lags.size, np.nan)
    for index, shift in enumerate(lags):
        begin, end = moments + shift - length / 2, moments + shift + length / 2
        if begin.min() < time[0] or end.max() > time[-1]:
            continue
        means = [(np.interp(end, time, row) - np.interp(begin, time, row)) / length for row in total]
        design = np.stack([*means, np.ones_like(light), *([light**2] if bends else [])], axis=1)
        design = design / light[:, None]
        design = design / np.abs(design).max(axis=0)
        rest = 1 - design @ np.linalg.lstsq(design, np.ones_like(light), rcond=None)[0]
        found[index] = np.sqrt(np.sum(rest**2) / max(light.size - design.shape[1], 1))
    return found


class Offset(NamedTuple):
    """What `offset` tells, of so many spectra."""

    late: float  # [s]
    growth: np.ndarray  # (n,) [1/s], NaN where the signal does not tell it
    left: float  # [1] residual
    without: float  # [1] residual without an offset
    count: int


def offset(time, signal, moments, length, fitted, weight):
    r"""How late spectra are stated [s] against a pyrometer, from light of the surface alone.

    .. math:: \ln\frac{S(t_j)}{F_j} = a + b t_j + g_j \Delta, \qquad
              g_j = \frac{1}{l} \ln\frac{S(t_j + l/2)}{S(t_j - l/2)}

    S is the mean over the exposure of `length` l about each moment. Neither a level nor a window or emittance
    that drifts can pass for an offset: light that rises and light that falls tell it together.

    Parameters
    ----------
    time, signal : (t,) arrays [s], [A]
    moments : (n,) array [s] of spectra; exposures that hold a switch of the heat are to be left out
    fitted : (n,) array [1], what the surface that fits each spectrum gives in the band, in any unit
    weight : (n,) array, of each spectrum, one over its error

    Returns
    -------
    `Offset`, or None for fewer than five spectra.
    """
    known = np.isfinite(signal)
    if not known.any():
        return None
    whole = cumulative_trapezoid(signal[known], time[known], initial=0.0)

    def mean(begin, end):
        ends = (moments + shift for shift in (begin, end))
        first, last = (np.interp(one, time[known], whole, left=np.nan, right=np.nan) for one in ends)
        return (last - first) / (end - begin)

    with np.errstate(divide="ignore", invalid="ignore"):
        growth = np.log(mean(0.0, length) / mean(-length, 0.0)) / length
        level = np.log(mean(-length / 2, length / 2) / fitted)
    held = np.isfinite(growth) & np.isfinite(level)
    if held.sum() < min(FEWER):
        return None
    design = np.stack([np.ones(held.sum()), (moments - moments.mean())[held], growth[held]], axis=1)
    design, level = design * weight[held, None], level[held] * weight[held]
    found, left = _least_squares(design, level)
    _, without = _least_squares(design[:, :-1], level)
    return Offset(float(found[-1]), growth, left, without, int(held.sum()))


def _least_squares(design, values):
    """Numbers (p,) and standard deviation of what is left."""
    found = np.linalg.lstsq(design, values, rcond=None)[0]
    rest = values - design @ found
    return found, np.sqrt(np.sum(rest**2) / max(values.size - found.size, 1))


def within_second(test, left):
    """Seconds by which the spectra of a test must be moved, 0 to `left`, where their dates are whole seconds.

    They are cut off; 0 where the light does not tell how much.
    """
    exposure = float(test.attrs.get("spectrometer_integration_time", 0.0))
    bends = "counts" in test
    values = test["counts" if bends else "spectral_radiance"]
    values = values - test.get("background_counts", 0.0) if bends else values
    slit = float(test.attrs.get("spectrometer_fwhm", np.nan))
    values = flags.without_rays(values.values, test.wavelength.values, slit)
    whole = np.isfinite(values).all(axis=0)  # pixels without a saturated moment
    moments, light = test.spectrum_time.values, values[:, whole].mean(axis=1)
    pair = np.stack([test.signal_wide.values, test.signal_narrow.values])
    known = np.isfinite(pair).all(axis=0)
    time, pair = test.time.values[known], pair[:, known]
    if time.size < FRAMES or not whole.any() or exposure <= 0:
        return 0.0
    held = (light > DIM * np.nanmax(light)) & (moments > time[0] + exposure)
    held &= moments < time[-1] - exposure - FARTHEST
    if held.sum() < FRAMES:
        return 0.0
    lags = np.arange(0.0, FARTHEST, STEP)
    rest = lag(time, pair, moments[held], light[held], exposure, lags, bends)
    if np.isnan(rest).all() or rest[0] < max(CLEARER * np.nanmin(rest), SMALLEST):
        return 0.0
    best = float(lags[np.nanargmin(rest)])
    return best if best < left else 0.0  # a clock that is off by more is for a person to see
