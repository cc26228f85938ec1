"""Effects that are switched on in a model, and the numbers of them that a fit moves."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import logsumexp

from plasmapyro.diagnosis.effects.effect import Effect

KIN = 0.4  # cosine beyond which an effect may be the misfit of another one's formula
FORMULA = 0.1  # [1], of the chi-squared that an effect gains: what its kin must bring besides,
SPILL = 0.03  # [1], and what any other effect must: formulas are inexact by a sixth
WIDE = 10.0  # priors of amplitudes in fits, over those of the catalogue
TAILS = np.array([0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0])
"""Widths of the normals, over the standard deviation of the catalogue, of which the prior of an amplitude is
the mean: faults are mostly small, and now and then gross."""
LARGE = TAILS[TAILS >= 1]  # what errors of a simulation do not hide


@dataclass(frozen=True)
class Setting:
    """An effect that is switched on: its amplitude and its other numbers."""

    effect: Effect
    amplitude: float
    shape: dict = field(default_factory=dict)

    @property
    def id(self):
        """That of the effect."""
        return self.effect.id

    def late(self, kind):
        """By how much [s] what a kind of instrument saw happened later than its clock says."""
        return 0.0 if self.effect.clock is None else self.effect.clock(self.amplitude, kind, **self.shape)

    def acts_on(self, kind):
        """Whether a kind of instrument is asked: of a clock every one."""
        return kind in self.effect.instruments or self.effect.clock is not None


@dataclass(frozen=True)
class FreeNumber:
    """One number of a setting that a fit moves, normal about `centre` before the data."""

    place: int  # of the setting
    name: str | None  # None: the amplitude
    centre: float
    sigma: float
    low: float
    high: float
    step: float  # for derivatives

    def at_end(self, value, share):
        """Whether a value lies within a share of the range [1] from one of its ends."""
        return min(value - self.low, self.high - value) <= share * (self.high - self.low)

    def exhausted(self, value, share):
        """Whether an amplitude is as large as it may be, but for a share [1] of that."""
        return max(value / self.high, value / self.low if self.low else 0.0) >= 1 - share


def free_numbers(settings):
    """The numbers of settings that a fit moves, as a list of `FreeNumber`."""
    free = []
    for place, setting in enumerate(settings):
        effect = setting.effect
        free.append(FreeNumber(place, None, 0.0, WIDE * effect.sigma, *effect.bounds, 0.02 * effect.step))
        for name, (low, high) in effect.shape_bounds.items():
            if name in setting.shape:  # a simpler version of the effect may lack it
                half = (high - low) / 2
                free.append(FreeNumber(place, name, low + half, half, low, high, 1e-3 * half))
    return free


def with_numbers(settings, numbers):
    """Settings with the amplitudes and shapes that a state holds."""
    result = [replace(setting, shape=dict(setting.shape)) for setting in settings]
    for free, number in zip(free_numbers(settings), numbers, strict=True):
        if free.name is None:
            result[free.place] = replace(result[free.place], amplitude=float(number))
        else:
            result[free.place].shape[free.name] = float(number)
    return tuple(result)


def numbers_of(settings):
    """The free numbers of settings as they stand."""
    return np.array(
        [
            settings[free.place].amplitude if free.name is None else settings[free.place].shape[free.name]
            for free in free_numbers(settings)
        ]
    )


def log_prior(free, numbers, widths=TAILS):
    r"""Log density of numbers before the data, without factors of :math:`\sqrt{2\pi}`, the prior that fits
    count for amplitudes taken out.

    .. math:: \sum_j \ln \frac1n \sum_k \frac{1}{k\sigma_j}
        \exp\left(-\frac{a_j^2}{2 k^2 \sigma_j^2}\right) + \frac{a_j^2}{2 (10 \sigma_j)^2}

    for amplitudes, with the `widths` k; :math:`-\ln \sigma_j` for shapes. From the smallest width on the
    density goes about with 1/a, so that of two errors as significant as each other the finer measured one is
    no less likely (H. Jeffreys, Proc. R. Soc. A 186 (1946) 453).

    Parameters
    ----------
    free : list of FreeNumber
    numbers : sequence of float
    widths : (k,) over those of the catalogue
    """
    total = 0.0
    for one, number in zip(free, numbers, strict=True):
        if one.name is None:
            wide = widths * one.sigma / WIDE
            density = logsumexp(-0.5 * (number / wide) ** 2 - np.log(wide)) - np.log(wide.size)
            total += density + 0.5 * (number / one.sigma) ** 2
        else:
            total -= np.log(one.sigma)
    return float(total)
