"""The light of the gas alone, as the instruments measured it, beside that of the simulation."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve

from plasmapyro.diagnosis.fit.model import WALK
from plasmapyro.diagnosis.fit.normal import pattern_sigmas
from plasmapyro.diagnosis.fit.setting import free_numbers
from plasmapyro.diagnosis.fit.slit import SeenSlit

# parameters that scale no signal
NO_GAIN = "emittance", "gas", "before_injection", "before_power", "clocks", "moments", "dark_drift"
MOST = 10.0  # [1] by which a model may differ from the data, for their errors to follow it
ANYTHING = 10.0  # [1] of the level, that a pattern may be of
DARK = 1e-3  # [1] of the level: less light is none


@dataclass(frozen=True)
class MeasuredGas:
    """Light of the gas after injection, channel by channel of all instruments.

    `value` (C,) over `level` (C,), the simulated light (or a share of its mean where it is dark);
    `covariance` (C, C) of `value`: noise, calibration, the surface; `relative` (C, k): roots r of the part
    that gains and calibrations have in it, in proportion to the light; `wavelength` (C,) [m];
    `instrument` (C,) the place of the instrument; `named` (C,): the most that effects of the gas which are
    named of the thermometer change; `slit`: a `SeenSlit`, or None.
    """

    value: np.ndarray
    covariance: np.ndarray
    relative: np.ndarray
    level: np.ndarray
    simulated: np.ndarray
    wavelength: np.ndarray
    instrument: np.ndarray
    named: np.ndarray
    slit: SeenSlit | None = None

    def covariance_about(self, light):
        r"""Covariance (C, C) of `value` whose relative errors are relative to some light L (C,).

        .. math:: C' = C + \sum_k (q r_k)(q r_k)^T - r_k r_k^T, \qquad q = L / y

        Where a model disagrees with the data in shape, errors that are relative to the data pull every fit to
        too little light.

        Source: S. Chiba & D. L. Smith, report ANL/NDM-121 (1991), on Peelle's pertinent puzzle.
        """
        ratio = np.where(self.value > DARK, light / np.maximum(self.value, DARK), 1.0)
        moved = self.relative * np.clip(ratio, 1 / MOST, MOST)[:, None]
        return self.covariance - self.relative @ self.relative.T + moved @ moved.T

    def without(self, pattern, multiplies):
        """The same, a pattern (c, 1) over the channels of the last instrument of any size in it: of gains if
        it `multiplies` light, else of light."""
        whole = np.zeros((self.value.size, 1))
        mine = self.instrument == self.instrument[-1]
        light = self.value[mine] if multiplies else self.level[mine].mean() / self.level[mine]
        whole[mine] = pattern * light[:, None]
        whole *= ANYTHING / np.abs(whole).max()
        return replace(self, covariance=self.covariance + whole @ whole.T)

    def of_last(self):
        """The same as the last instrument alone sees it: the light of the others may be any."""
        other = self.instrument != self.instrument[-1]
        return replace(self, covariance=self.covariance + np.diag(np.where(other, ANYTHING**2, 0.0)))

    def ratio_on(self, axis):
        """Measured over simulated light (K,) along an axis [m], by what the last instrument sees."""
        mine = self.instrument == self.instrument[-1]
        light = np.maximum(self.simulated[mine], DARK)
        order = np.argsort(self.wavelength[mine])
        return np.interp(axis, self.wavelength[mine][order], (self.value[mine] / light)[order])


def measured_gas(model, solution):
    """Measured light of the gas from the solution of a model with a free gas."""
    brightness = np.exp(solution.state.values[model.index["gas"]])
    levels = [model.gas_level(which) for which in range(len(model.instruments))]
    level, simulated = (np.concatenate(rows) for rows in zip(*levels, strict=True))
    lines = np.concatenate(solution.state.lines)
    value = brightness * (simulated / level + lines)
    places, at = [], len(solution.covariance)
    for one in model.instruments:
        for which, sigma in enumerate(pattern_sigmas(one)):
            if not sigma.any():
                continue
            if which == 2:
                places.append(np.arange(at, at + one.channels))
            at += one.channels
    places = np.concatenate([[model.size + model.index["gas"]], *places])
    scaling = [one.id not in NO_GAIN and not one.id.startswith(WALK) for one in model.parameters]
    gains = model.size + np.flatnonzero(scaling)
    count = places.size
    places = np.concatenate([places, gains])
    chosen = np.zeros((solution.factor[0].shape[0], places.size))
    chosen[places, np.arange(places.size)] = 1.0
    covariance = cho_solve(solution.factor, chosen)[places]
    slope = np.concatenate([value[:, None], brightness * np.eye(lines.size)], axis=1)
    root = np.linalg.inv(np.linalg.cholesky(covariance[count:, count:]))
    return MeasuredGas(
        value=value,
        covariance=slope @ covariance[:count, :count] @ slope.T,
        relative=slope @ covariance[:count, count:] @ root.T,
        level=level,
        simulated=simulated / level,
        wavelength=np.concatenate([_wavelength(one) for one in model.instruments]),
        instrument=np.concatenate(
            [np.full(one.channels, place) for place, one in enumerate(model.instruments)]
        ),
        named=_named(solution) / level,
    )


def _named(solution):
    """The most (C,) that effects of the gas in a fit change of the signals, at any time."""
    free = free_numbers(solution.settings)
    amplitude = np.where(
        [one.name is None and solution.settings[one.place].effect.stage == "gas" for one in free],
        solution.state.amplitudes,
        0.0,
    )
    columns = [one[..., one.shape[2] - len(free) :] for one in solution.jacobian]
    return np.concatenate([np.abs(one @ amplitude).max(axis=0) for one in columns])


def _wavelength(one):
    if one.weight is None:
        return one.wavelength
    return one.weight @ one.wavelength / one.weight.sum(axis=1)
