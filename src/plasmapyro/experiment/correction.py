"""Temperatures of the pyrometer, before and after the correction, with status and uncertainty."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.experiment.signals import corrected_signal, corrected_signal_uncertainty
from plasmapyro.instrument.calibration import (
    invert_quadratic,
    invert_quadratic_freely,
    require_rising,
    spread,
)
from plasmapyro.instrument.pyrometer import signal_ratio
from plasmapyro.progress import step
from plasmapyro.record.budget import Input, combined
from plasmapyro.record.status import GAS_DOMINATED, MISSING, NO_SIGNAL, NOT_INJECTED, SATURATED, WITH_VALUE

MOST_DRAWN = 20_000  # samples of a record that have draws of their own
BLOCK = 512  # samples whose draws are held at once
LEAST_SLOPE = 0.01  # of a draw: emittances are > 0
STEP = 0.1  # of a standard uncertainty, for slopes
VALIDATED = 1.1  # [1] of a Monte Carlo over a linear uncertainty: a weak signal bends the curve


def read_measured(reading, signals, saturated):
    """Temperature (t,) [K] the pyrometer reads from its signals (2, t) [A] as they are, and its status (t,).

    NaN unless the status is valid or extrapolated. Source: Fagnani et al., eq. 6 and sec. 5.2. Deviation: the
    paper takes the surface as grey (slope 1).
    """
    ratio = signal_ratio(*signals) / reading.slope
    temperature, status = invert_quadratic(ratio, *reading.fit)
    status[np.isnan(ratio)] = NO_SIGNAL
    status[saturated] = SATURATED
    status[np.isnan(signals).any(axis=0)] = MISSING
    return np.where(np.isin(status, WITH_VALUE), temperature, np.nan), status


def read_corrected(reading, signals, corrected, uncertainty, injected, saturated):
    """Temperature (t,) [K] from the corrected signals (2, t) [A] and their uncertainty, and its status (t,).

    NaN unless the status is valid, extrapolated or gas dominated. The first that holds: not injected,
    missing, saturated, no signal, below or above the range, gas dominated, extrapolated, valid. Source:
    Fagnani et al., eqs. 6 and 13, sec. 5.2.
    """
    detected = (corrected > reading.detection_level * uncertainty).all(axis=0)
    ratio = np.where(detected, signal_ratio(*corrected), np.nan) / reading.slope
    temperature, status = invert_quadratic(ratio, *reading.fit)
    share = np.where(detected, corrected, np.nan) / signals
    status[(share < reading.least_surface_share).any(axis=0) & np.isfinite(temperature)] = GAS_DOMINATED
    status[~detected] = NO_SIGNAL
    status[saturated] = SATURATED
    status[np.isnan(corrected).any(axis=0)] = MISSING
    status[~injected] = NOT_INJECTED
    return np.where(np.isin(status, WITH_VALUE), temperature, np.nan), status


@dataclass(frozen=True)
class Reading:
    """How the paper's method reads a temperature from two signals: curve of the calibration and limits.

    The ratio is divided by `slope`, the emittance of the surface in the wide band over that in the narrow
    one. A corrected signal of fewer uncertainties than `detection_level` is no signal; one that is a smaller
    share of the measured one than `least_surface_share` is dominated by the gas.
    """

    coefficient: np.ndarray  # (3,) of the quadratic fit of the ratio
    fit_range: np.ndarray  # (2,) [K]
    instrument_range: np.ndarray  # (2,) [K]
    slope: float  # [1]
    signal_uncertainty: float  # [1] relative, of one signal
    gas_variation: float  # [1] relative, of the gas about the reference
    detection_level: float  # [1]
    least_surface_share: float  # [1]
    covariance: np.ndarray | None = None  # (3, 3) of the fit
    slope_uncertainty: float = 0.0  # [1] absolute
    floor: np.ndarray | float = 0.0  # (2,) [A] noise of a signal without light

    @classmethod
    def of(cls, calibration, slope, **more):
        """From a dataset of the contract 'calibration' and the fields after `slope` by name.

        ValueError if the ratio of the calibration does not rise over its range.
        """
        fit = [calibration[name].values for name in ("fit_coefficient", "fit_range", "instrument_range")]
        require_rising(*fit)
        return cls(*fit, slope, **more, covariance=calibration["fit_covariance"].values)

    @property
    def fit(self):
        """What `instrument.calibration.invert_quadratic` needs besides the ratio."""
        return self.coefficient, self.fit_range, self.instrument_range

    def error(self, signals):
        """Standard uncertainty (2, t) [A] of signals (2, t): a share of them, and the noise without light."""
        floor = np.broadcast_to(self.floor, 2)[:, None]
        return np.hypot(self.signal_uncertainty * signals, floor)

    def corrected(self, signals, reference, reference_uncertainty, injected, shining, saturated):
        r"""Signals (2, t) [A] of the surface, their uncertainty, temperature (t,) [K] and status (t,).

        .. math:: T_{corr} = H_c^{-1}\!\left(\frac{S_1 - S_{1,ref}}{S_2 - S_{2,ref}}\right)

        `reference`, `reference_uncertainty` (2,) [A], see `signals.reference_signal`. Source: Fagnani et al.,
        eqs. 6 and 13, with the quadratic fit of the calibration points (sec. 3.2).
        """
        corrected = corrected_signal(signals, reference, injected, shining)
        uncertainty = corrected_signal_uncertainty(
            signals, reference, reference_uncertainty, shining, self.signal_uncertainty, self.gas_variation
        )
        uncertainty = np.hypot(uncertainty, self.error(np.zeros_like(signals)))
        return (
            corrected,
            uncertainty,
            *read_corrected(self, signals, corrected, uncertainty, injected, saturated),
        )


def temperature_uncertainty(reading, signals, gas, gas_uncertainty, draws, generator):
    """Standard uncertainty (t,) [K] of a temperature read from two signals less those of the gas.

    Every draw takes its own calibration, its own level of the gas (common to both bands: the gas brightens as
    a whole), its own error of the reference mean, and its own error of each signal. Of a long record
    `MOST_DRAWN` samples are drawn, and each other one takes what the one of the most alike signals got. NaN
    where a sample is missing, or where so many draws have no temperature that the central 68 % of them is not
    closed.

    `signals` (2, t) [A] are measured; `gas` (2, t) [A] is 0 where nothing is taken away, `gas_uncertainty`
    (2, t) [A] that of the reference mean.

    Source: Fagnani et al., sec. 3.2 (Monte Carlo through every step; 3 K and 1 %). Deviation: the variation
    of the gas is an input; the paper assumes none.
    """
    if signals.shape[1] > MOST_DRAWN:
        return _of_alike(reading, signals, gas, gas_uncertainty, draws, generator)
    fits = generator.multivariate_normal(reading.coefficient, reading.covariance, size=draws)[:, None, :]
    level = reading.gas_variation * generator.standard_normal((draws, 1))
    offset = generator.standard_normal((2, draws, 1))
    slope = reading.slope
    if reading.slope_uncertainty > 0:
        slope = slope + reading.slope_uncertainty * generator.standard_normal((draws, 1))
        slope = np.maximum(slope, LEAST_SLOPE)
    result, error = np.full(signals.shape[1], np.nan), reading.error(signals)
    for first in range(0, signals.shape[1], BLOCK):
        step(f"{draws} draws of each sample, from sample", first, signals.shape[1])
        part = slice(first, first + BLOCK)
        noise = generator.standard_normal((2, draws, signals[0, part].size))
        wide, narrow = (
            signals[band, part]
            + error[band, part] * noise[band]
            - gas[band, part] * (1 + level)
            - gas_uncertainty[band, part] * offset[band]
            for band in (0, 1)
        )
        result[part] = spread(_ranked_temperature(wide / slope, narrow, fits, reading.fit_range))
    return result


def _of_alike(reading, signals, gas, gas_uncertainty, draws, generator):
    """As `temperature_uncertainty`, from samples evenly among those with signals and with or without gas."""
    from scipy.spatial import KDTree

    result = np.full(signals.shape[1], np.nan)
    usable, behind = (signals > 0).all(axis=0), (gas > 0).any(axis=0)
    for part in (np.flatnonzero(usable & behind), np.flatnonzero(usable & ~behind)):
        if not part.size:
            continue
        own = signals[:, part]
        error = np.hypot(reading.error(own), reading.gas_variation * gas[:, part])
        # Where little but gas is left a draw sees the distance to zero, else the level of the signals.
        like = np.concatenate([np.arcsinh((own - gas[:, part]) / error), np.log(own)]).T
        drawn = np.unique(np.linspace(0, part.size - 1, MOST_DRAWN // 2).astype(int))
        chosen = part[drawn]
        known = temperature_uncertainty(
            reading, signals[:, chosen], gas[:, chosen], gas_uncertainty[:, chosen], draws, generator
        )
        result[part] = known[KDTree(like[drawn]).query(like)[1]]
    return result


def _ranked_temperature(wide, narrow, fits, fit_range):
    """Temperature of each draw; without one, +inf (no narrow signal) or -inf (no wide one)."""
    ratio = signal_ratio(wide, narrow)
    temperature = invert_quadratic_freely(ratio, fits, fit_range)
    lost = np.isnan(ratio) & np.isfinite(wide) & np.isfinite(narrow)
    return np.where(lost, np.where(narrow <= 0, np.inf, -np.inf), temperature)


def budget_of(reading, signals, gas, gas_uncertainty, monte_carlo=None):
    r"""What each input adds to the uncertainty of a temperature read from two signals less those of the gas.

    .. math:: T = H_c^{-1}\!\left(\frac{S_1 - g\,G_1 - o_1}{(S_2 - g\,G_2 - o_2)\,s}\right)

    with the level g of the gas, an error o of its mean, and the slope s of the emittance. Arguments as of
    `temperature_uncertainty`, whose result is `monte_carlo` (t,) [K]: where that exceeds the linear
    uncertainty by more than a tenth, all contributions grow in proportion.

    Source: JCGM 100:2008, eqs. 10 and 13 (the three coefficients are correlated); 101:2008, sec. 8, for the
    comparison with Monte Carlo.
    """

    errors = reading.error(signals)

    def read(wide=0.0, narrow=0.0, level=0.0, means=(0.0, 0.0), tilt=0.0, moved=0.0):
        pair = [
            row + own_error * error - own * (1 + reading.gas_variation * level) - spread_ * mean
            for row, own_error, own, spread_, error, mean in zip(
                signals, errors, gas, gas_uncertainty, (wide, narrow), means, strict=True
            )
        ]
        slope = max(reading.slope + reading.slope_uncertainty * tilt, LEAST_SLOPE)
        ratio = signal_ratio(*pair) / slope
        found = invert_quadratic_freely(ratio, reading.coefficient + moved, reading.fit_range)
        return np.where(np.isfinite(found), found, np.nan)

    def by(**error):
        ends = [
            read(**{name: sign * STEP * np.asarray(value) for name, value in error.items()})
            for sign in (1, -1)
        ]
        return (ends[0] - ends[1]) / (2 * STEP)

    values, vectors = np.linalg.eigh(reading.covariance)
    of_curve = [
        by(moved=np.sqrt(max(value, 0.0)) * row) for value, row in zip(values, vectors.T, strict=True)
    ]
    means = [float(row.max()) for row in gas_uncertainty]
    one, varied = reading.signal_uncertainty, reading.gas_variation
    found = [
        Input("signal of the wide band", "noise", by(wide=1.0), one, "1"),
        Input("signal of the narrow band", "noise", by(narrow=1.0), one, "1"),
        Input("mean of the reference, wide band", "gas", by(means=(1.0, 0.0)), means[0], "A"),
        Input("mean of the reference, narrow band", "gas", by(means=(0.0, 1.0)), means[1], "A"),
        Input("brightness of the gas since the reference", "gas", by(level=1.0), varied, "1"),
        Input(
            "calibration curve (its source and its signals)", "calibration", np.sqrt(sum(np.square(of_curve)))
        ),
        Input(
            "emittance of the wide over the narrow band",
            "emittance",
            by(tilt=1.0),
            reading.slope_uncertainty,
            "1",
        ),
    ]
    if monte_carlo is None:
        return found
    with np.errstate(invalid="ignore", divide="ignore"):
        excess = monte_carlo / combined(found)
    excess = np.where(excess > VALIDATED, excess, 1.0)
    return [one._replace(contribution=one.contribution * excess) for one in found]
