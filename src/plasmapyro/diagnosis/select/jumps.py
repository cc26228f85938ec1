"""Whether something changes from one sample to the next: a clock that loses some, a range, a loose fibre."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from plasmapyro.diagnosis.fit.outliers import slow_part

SIDES, LONGEST_SIDE = (12, 24), 12.0  # samples before and after a jump, and how long they may last [s]
REACH, LEAST_REACH = 20, 40  # sides of samples before and after that tell what is usual; samples, at least
BEYOND = 0.9, 1.645  # share of normal deviations that are smaller than so many standard ones
# Nearest samples, and how much [1] of a jump they show: light that swings is none, nor a surface that is
# heated more from one moment on, which knots round off.
SHORT, AT_ONCE = (6, 3), 0.7
SPIKE = 3.0  # scatters from the neighbours beyond which a sample counts as no more
ENDS = 8  # samples at either end that tell none
LEAST = 60  # samples


def largest_jump(gain, error, period):
    """Largest jump of gains (n,) with standard deviations (n,), over the usual ones, and where it is.

    Straight lines through the samples on both sides end apart by it, and shorter ones by most of that. Usual
    is what nine tenths of the jumps about stay below: half of them would, of a gain that swings, lie on
    straight pieces. Never less than the noise.
    """
    best, place = 0.0, None
    if gain.size < LEAST:
        return best, place
    gain = without_spikes(gain, error)
    nearest = [sliding_window_view(gain, 2 * one) @ _law(one) for one in SHORT]
    for side in SIDES:
        if side * period > LONGEST_SIDE or gain.size < 2 * (side + LEAST_REACH):
            continue
        law = _law(side)
        jump = sliding_window_view(gain, 2 * side) @ law
        size = np.abs(jump) / np.sqrt(sliding_window_view(error, 2 * side) ** 2 @ law**2)
        centres = np.append(np.arange(0, size.size - 1, side), size.size - 1)
        usual = np.interp(np.arange(size.size), centres, [_usual(size, at, side) for at in centres])
        parts = [
            row[side - one : gain.size - side - one + 1] for one, row in zip(SHORT, nearest, strict=True)
        ]
        within = np.min(parts * np.sign(jump), axis=0)
        size = np.where(within > AT_ONCE * np.abs(jump), size / np.maximum(usual, 1.0), 0.0)
        size[:ENDS] = size[-ENDS:] = 0.0
        if size.max() > best:
            best, place = float(size.max()), int(size.argmax()) + side
    return best, place


def _law(side):
    """Weights (2 side,) of samples in the jump between straight lines before and after the middle."""
    away = np.arange(side) + 0.5
    bent = away - away.mean()
    end = 1 / side - away.mean() * bent / np.sum(bent**2)
    return np.concatenate([-end[::-1], end])


def _usual(size, at, side):
    """Scale of jumps (n,) about a place."""
    reach = max(LEAST_REACH, REACH * side)
    return np.quantile(size[max(at - reach, 0) : at + reach + 1], BEYOND[0]) / BEYOND[1]


def without_spikes(gain, error):
    """Gains (n,) no farther from the median of their neighbours, which keeps a step, than noise lies."""
    slow = slow_part(gain[:, None], np.ones(gain.size, dtype=bool), np.zeros(gain.size, dtype=int))[:, 0]
    away = (gain - slow) / error
    most = SPIKE * 1.4826 * np.median(np.abs(away))
    return slow + np.clip(away, -most, most) * error
