"""How finely values were written down: steps of a converter, or the digits of a log."""

from dataclasses import dataclass

import numpy as np

GROUP = 64  # neighbouring values that tell how far apart values are there
SAME = 1e-6  # [1]: values that differ by less are the same one, written twice
UNIFORM = 12.0  # variance of an error that is uniform over a step, in its squares: one over this


@dataclass(frozen=True)
class Rounding:
    """Steps between the values of one channel over its level, as recorded.

    `level` (g,) of groups of values, in rising order; `step` (g,) between neighbouring values there, in their
    unit; `moving` (g,) share of the samples that differ from the one before.
    """

    level: np.ndarray
    step: np.ndarray
    moving: np.ndarray

    def variance(self, level, number):
        r"""Variance that rounding gives to means of some samples.

        .. math:: \sigma^2 = \frac{q^2}{12\,[1 + (n - 1) f^2]}

        with the step q and the share f of samples that are another value than the one before: only where
        noise or heating moves them do samples err on their own. The square is a rule of thumb: at most 1.2
        times too small and 2.6 times too large, for noise from a fiftieth of a step to twelve. Source:
        uniform error of rounding, JCGM 100:2008 (GUM), F.2.2.1; of independent ones, the mean.
        """
        if not self.level.size:
            return np.zeros(np.broadcast_shapes(np.shape(level), np.shape(number)))
        step, moving = (np.interp(level, self.level, values) for values in (self.step, self.moving))
        return step**2 / UNIFORM / (1 + (np.maximum(number, 1) - 1) * moving**2)


def rounding(values):
    """`Rounding` of the samples (t,) of one channel in the order of time, NaN where none is."""
    values = values[np.isfinite(values)]
    if values.size < 2:
        return Rounding(*np.zeros((3, 0)))
    order = np.argsort(values, kind="stable")
    change = np.append(True, np.abs(np.diff(values)) > SAME * np.abs(values[1:]))
    level, step, moving = [], [], []
    for group in np.array_split(order, max(values.size // GROUP, 1)):
        own = values[group]
        apart = np.diff(own)
        apart = apart[apart > SAME * np.abs(own[1:])]
        level.append(own.mean())
        tied = apart.size < own.size - 1  # values that never meet were written finer than they lie
        step.append((apart.min() if tied else 0.0) if apart.size else np.nan)
        moving.append(change[group].mean())
    level, step = np.array(level), np.array(step)
    known = np.isfinite(step)
    if not known.any():  # one value all along
        return Rounding(*np.zeros((3, 0)))
    return Rounding(level, np.interp(level, level[known], step[known]), np.array(moving))
