"""The joint estimate sample by sample: the model of the chain as a filter, for a test that is running."""

import dataclasses
from collections import deque
from functools import cache

import numpy as np

from plasmapyro.estimate import noise, prepare
from plasmapyro.estimate.dynamics import FLICKER, GAS, RATE, SIZE, TEMPERATURE, Dynamics, transition
from plasmapyro.estimate.observations import robust_sum, robust_weight
from plasmapyro.estimate.stage import FIRST_RATE, GAS_START, KICK, NORMAL_95, START_DYNAMICS, TELLING
from plasmapyro.instrument.calibration import EXTRAPOLATED, VALID
from plasmapyro.record import status

LONGEST = 20_000  # samples before the surface shines that tell the flicker
STEPS, FALL = 8, 1e-9  # Gauss-Newton steps of a sample, and the fall of the objective that ends them
HALVINGS = 6
MEMORY = 4 * prepare.NOISE_BLOCK  # samples from which noise is read, the least that tell it ...
AGAIN = 25  # ... every so many samples
USUAL = 300.0  # [s] of an exposure whose end is not known yet
FIRST_NOISE = 0.01  # [1] of a signal, until its own scatter tells
SIGHT = 3.0  # standard deviations of more light than the gas explains: a surface may be there


@dataclasses.dataclass(frozen=True)
class Reading:
    """What one sample says."""

    time: float  # [s] from the injection
    temperature: float  # [K] NaN where `state` allows none
    uncertainty: float  # [K] standard
    state: int  # as in `record.status`
    surface_share: tuple  # (2,) [1] of each signal
    residual: tuple  # (2,) whitened, of the prediction after the sample

    @property
    def interval(self):
        """Ends of the 95 % interval [K], as those of the joint estimate."""
        factor = np.exp(NORMAL_95 * self.uncertainty / self.temperature)
        return self.temperature / factor, self.temperature * factor


class _Kept:
    """A table of an instrument that keeps its last answer: one sample asks for the same temperature often."""

    def __init__(self, table):
        self._table, self.temperatures = table, table.temperatures
        self._asked, self._answer = None, None

    def __call__(self, temperature):
        if np.size(temperature) > 1:
            return self._table(temperature)
        if self._asked != float(temperature[0]):
            self._asked, self._answer = float(temperature[0]), self._table(temperature)
        return self._answer


class Filter:
    r"""Iterated Kalman filter of temperature, its rate, gas and flicker, the constants as further states.

    .. math:: x^+ = \arg\min_x\; \tfrac12 (x - x^-)^T (P^-)^{-1} (x - x^-) + J_k(x), \qquad
              P^+ = \bigl[(P^-)^{-1} + H_k\bigr]^{-1}

    with the prediction x^-, P^- of `dynamics.transition` and, of `observations.PyrometerData` for one
    sample, half the robust sum of squares J_k and the Gauss-Newton matrix H_k. The constants then move
    against the slope of half the log-determinant that the sample adds, as in `smoother.marginalised`.

    Notes
    -----
    Sources: Bell & Cathey, IEEE Trans. Autom. Control 38, 294 (1993): the iterated update is a Gauss-Newton
    step. Deviation from the joint estimate: samples before injection only tell the noise; how fast the
    temperature may bend is given, not fitted; the noise is that of the samples so far. Each step starts from
    the prediction and, where there is more light than the gas explains, also from the temperature that would
    explain it: a cold surface has no slope to follow.
    """

    def __init__(self, record, calibration, response, settings, dynamics=None, slope=0.0):
        """`record`: facts of the test (a Record, its instruments unused); `settings`: keywords of `estimate`;
        `dynamics`: the three numbers of `START_DYNAMICS`, where an earlier estimate found others."""
        self.off, self._window, self._record = record.off, record.window, record
        one = np.array([True])
        empty = prepare.Samples(
            np.zeros(1), np.zeros((2, 1)), np.ones((2, 1)), one, one, np.zeros(1, int), np.nan, np.nan
        )
        data = prepare.pyrometer_data(empty, response, calibration, slope)
        self._data = dataclasses.replace(data, table=_Kept(data.table), shifted=_Kept(data.shifted))
        self._calibration, self._settings = calibration, settings
        self._dynamics = Dynamics(
            **(START_DYNAMICS | (dynamics or {})),
            kick=KICK,
            gas=settings["gas_drift"] ** 2 / (record.off if np.isfinite(record.off) else USUAL),
            gas_start=GAS_START,
            flicker=settings["gas_flicker"],
            flicker_time=settings["gas_flicker_time"],
        )
        inverse = np.linspace(1 / 3900.0, 1 / 250.0, 500)
        self._inverse, self._curve = inverse, np.log(self._data.table(1 / inverse)[0][:, 1])
        self._past, self._count = deque(maxlen=MEMORY), 0
        self._floor, self._relative = np.zeros(2), np.full(2, FIRST_NOISE)
        self._time = self._mean = self._covariance = None
        self._told, self._cold = deque(), deque(maxlen=LONGEST)
        self._flicker_known = False

    def step(self, time, signal):
        """Take one sample.

        Parameters
        ----------
        time : float [s] from the injection, rising
        signal : (2,) floats [A], NaN where missing or at a limit

        Returns
        -------
        Reading
        """
        signal = np.asarray(signal, dtype=float)
        self._learn(time, signal)
        if time < 0 or (self._mean is None and not (signal > 0).all()):
            nothing = (np.nan, np.nan)
            return Reading(time, np.nan, np.nan, status.NOT_INJECTED, nothing, nothing)
        if self._mean is None:
            self._begin(signal)
        else:
            self._predict(time)
        self._time = time
        shining = time <= self.off
        if abs(time - self.off) <= self._settings["plasma_off_time_span"]:
            signal = np.full(2, np.nan)  # the gas dies: neither there nor gone
        spread = np.maximum(self._floor, self._relative * np.abs(np.nan_to_num(signal)))
        data = dataclasses.replace(
            self._data,
            signal=signal[:, None],
            noise=np.maximum(spread, prepare.LEAST_NOISE * np.abs(self._mean[self._gas]))[:, None],
            shining=np.array([shining]),
        )
        matrix = self._update(data)
        return self._reading(time, data, matrix)

    def _begin(self, signal):
        settings = self._settings
        fixed = prepare.pyrometer_constants(
            self._record,
            self._data,
            self._calibration,
            signal,
            settings["gas_change"],
            settings["band_shift_uncertainty"],
        )
        first = [settings["initial_temperature_uncertainty"], np.hypot(FIRST_RATE, KICK), GAS_START]
        self._of, self._gas = cache(fixed.where), SIZE + fixed.where("gas_signal")
        self._mean = np.concatenate([[settings["initial_temperature"], 0.0, 0.0, 0.0], fixed.mean])
        # Entries differ by twenty powers of ten: matrices are inverted in units of these deviations.
        self._scale = np.concatenate([first, [self._dynamics.flicker], fixed.deviation])
        self._first = self._mean.copy()
        self._forget()

    def _forget(self):
        self._mean = self._first.copy()
        self._covariance = np.diag(self._scale**2)
        self._by_constants = np.zeros((self._mean.size - SIZE, SIZE, SIZE))  # of the chain's covariance

    def _predict(self, time):
        moved, added = transition(self._dynamics, np.array([self._time, time]), (0.0, self.off), 0.0)
        matrix = np.eye(self._mean.size)
        matrix[:SIZE, :SIZE] = moved[0]
        self._mean = matrix @ self._mean
        self._covariance = matrix @ self._covariance @ matrix.T
        self._covariance[:SIZE, :SIZE] += added[0]
        self._by_constants = moved[0] @ self._by_constants @ moved[0].T

    def _inverse_of(self, matrix, scale):
        outer = np.outer(scale, scale)
        return np.linalg.inv(matrix / outer) / outer

    def _update(self, data):
        """Move the state to what the sample says; the sample's own matrix (4, 4) of the states.

        Samples that contradict the model beyond what numbers hold make it begin anew.
        """
        self._mean[TEMPERATURE] = np.clip(self._mean[TEMPERATURE], *data.table.temperatures)
        if not np.isfinite(data.signal).any():
            return np.zeros((SIZE, SIZE))
        try:
            matrix = self._moved(data)
            if np.isfinite(self._mean).all() and (np.diagonal(self._covariance) > 0).all():
                return matrix
        except ValueError:  # a singular matrix, a temperature that is none
            pass
        self._forget()
        return np.zeros((SIZE, SIZE))

    def _moved(self, data):
        weight = self._inverse_of(self._covariance, self._scale)
        ends = [self._descend(start, weight, data) for start in self._starts(data)]
        _, mean = min(ends, key=lambda end: end[0])
        # The matrix belongs to where the sample leads, not to the prediction: else thousands of them drift.
        rows, residual = data.of_sample(mean[None, :SIZE], mean[SIZE:], self._of)
        weighted = rows.T * robust_weight(residual)
        total = weight + weighted @ rows
        self._mean = mean
        self._covariance = self._inverse_of(total, 1 / self._scale)
        slope = self._slope_of_determinant(weight, total, data)
        self._mean = mean - self._covariance[:, SIZE:] @ slope
        self._mean[TEMPERATURE] = np.clip(self._mean[TEMPERATURE], *data.table.temperatures)
        return weighted[:SIZE] @ rows[:, :SIZE]

    def _slope_of_determinant(self, weight, total, data):
        r"""Slope (p,) by the constants of what the sample adds to half ln det A, the state following them.

        .. math:: \tfrac12\,\mathrm{tr}\,C^+ (W' + H') - \tfrac12\,\mathrm{tr}\,C^- W', \qquad
                  W' = -W C^{-\prime} W, \quad C^{+\prime} = -C^+ (W' + H') C^+

        with C the covariance of the chain's state given the constants, W its inverse before the sample.
        """
        own = weight[:SIZE, :SIZE]
        before, after = np.linalg.inv(own), np.linalg.inv(total[:SIZE, :SIZE])
        follows = -after @ total[:SIZE, SIZE:]
        old = -own @ self._by_constants @ own
        both = old + self._matrix_by_constants(follows, data)
        self._by_constants = -after @ both @ after
        return 0.5 * (np.einsum("ij,pji->p", after, both) - np.einsum("ij,pji->p", before, old))

    def _matrix_by_constants(self, follows, data):
        """Derivative (p, 4, 4) of the sample's matrix by the constants; `follows` (4, p): of the state."""
        of, path, values = self._of, self._mean[None, :SIZE], self._mean[SIZE:]
        surface, gas, slope = data.predict(path, values, of)
        weight = robust_weight((data.signal - surface - gas) / data.noise)[:, 0]
        _, first, second = data.table(path[:, TEMPERATURE])
        leverage, result = data.leverage(path[:, TEMPERATURE]), 0.0
        for band in (0, 1):
            row = np.zeros(SIZE)
            row[TEMPERATURE] = slope[band, 0] / data.noise[band, 0]
            row[[GAS, FLICKER]] = gas[band, 0] / data.noise[band, 0]
            body, light = np.zeros((2, values.size))  # logarithmic derivatives of its two parts
            body[of("log_emittance")] = body[of("gain_error")[band]] = 1.0
            body[of("source_error")] = -data.source_slope[band]
            body[of("band_shift")[band]] = leverage[band, 0]
            body += second[0, band] / first[0, band] * follows[TEMPERATURE]
            light[of("gas_signal")[band]] = 1 / values[of("gas_signal")[band]]
            light += follows[GAS] + follows[FLICKER]
            change = light[:, None] * row
            change[:, TEMPERATURE] = body * row[TEMPERATURE]
            outer = change[:, :, None] * row
            result = result + weight[band] * (outer + np.swapaxes(outer, 1, 2))
        return result

    def _starts(self, data):
        """The prediction, and the temperature that would explain the light beyond that of the gas."""
        yield self._mean
        body, gas, _ = data.predict(self._mean[None, :SIZE], self._mean[SIZE:], self._of)
        surplus = float(data.signal[1, 0] - gas[1, 0])
        amplitude = self._covariance[GAS, GAS] + self._covariance[FLICKER, FLICKER]
        doubt = np.hypot(data.noise[1, 0], gas[1, 0] * np.sqrt(amplitude))
        if surplus > SIGHT * doubt and abs(surplus - body[1, 0]) > SIGHT * doubt:
            brightness = np.log(surplus) - self._mean[SIZE + self._of("log_emittance")[0]]
            other = self._mean.copy()
            other[TEMPERATURE] = 1 / np.interp(brightness, self._curve[::-1], self._inverse[::-1])
            yield other

    def _descend(self, mean, weight, data):
        """Least objective from a start, and where it is."""
        for _ in range(STEPS):
            rows, residual = data.of_sample(mean[None, :SIZE], mean[SIZE:], self._of)
            weighted = rows.T * robust_weight(residual)
            change = mean - self._mean
            slope = weight @ change
            now = 0.5 * change @ slope + robust_sum(residual)
            slope -= weighted @ np.nan_to_num(residual)
            move, length = -self._inverse_of(weight + weighted @ rows, 1 / self._scale) @ slope, 1.0
            if -slope @ move < FALL:  # twice what the step gains: small for one sample, not for thousands
                mean = mean + move
                mean[TEMPERATURE] = np.clip(mean[TEMPERATURE], *data.table.temperatures)
                break
            for _ in range(HALVINGS):
                trial = mean + length * move
                trial[TEMPERATURE] = np.clip(trial[TEMPERATURE], *data.table.temperatures)
                change = trial - self._mean
                residual = data.residual(trial[None, :SIZE], trial[SIZE:], self._of)
                if 0.5 * change @ weight @ change + robust_sum(residual) <= now:
                    break
                length /= 2
            else:
                break
            mean = trial
        return now, mean

    def _learn(self, time, signal):
        """Noise of the signals and, when the reference window ends, flicker of the gas, from the past."""
        self._past.append((time, *signal))
        self._count += 1
        if not self._flicker_known:
            self._cold.append((time, *signal))
            if time > self._window[1]:
                self._flicker_known = True
                self._learn_flicker(*np.array(self._cold).T)
        if self._count % AGAIN or len(self._past) < MEMORY:
            return
        pair = np.array(self._past).T[1:]
        if (np.isfinite(pair).sum(axis=1) > MEMORY // 2).all():
            # What the last samples say holds near their level: carried on as a share of the signal, it is too
            # much for a brighter surface, never too little.
            try:
                self._floor, relative = noise.signal_noise(pair, prepare.NOISE_BLOCK)
            except ValueError:  # samples without any noise: what was known before holds on
                return
            level = np.abs(np.nanmedian(pair[:, -prepare.NOISE_BLOCK :], axis=1))
            self._relative = np.hypot(self._floor / level, relative)

    def _learn_flicker(self, time, *pair):
        pair, cold = np.array(pair), self._window
        before = time < -self._settings["injection_time_span"]
        deviation, correlation = noise.flicker(time, pair, [before, (time >= cold[0]) & (time <= cold[1])])
        if np.isfinite(deviation):
            self._dynamics = dataclasses.replace(self._dynamics, flicker=deviation, flicker_time=correlation)

    def _reading(self, time, data, matrix):
        settings, path = self._settings, self._mean[None, :SIZE]
        temperature = float(self._mean[TEMPERATURE])
        deviation = float(np.sqrt(self._covariance[TEMPERATURE, TEMPERATURE]))
        own = matrix[TEMPERATURE, TEMPERATURE] - matrix[TEMPERATURE, GAS] ** 2 / (
            matrix[GAS, GAS] + 1 / (self._covariance[GAS, GAS] + self._dynamics.flicker**2)
        )
        self._told.append((time, own))
        while self._told[0][0] < time - TELLING:
            self._told.popleft()
        surface, gas, _ = data.predict(path, self._mean[SIZE:], self._of)
        share = (surface / (surface + gas))[:, 0]
        largest = settings["largest_uncertainty"] * temperature
        told = sum(part for _, part in self._told) * largest**2 > 1
        low, high = self._calibration.fit_range.values
        if not np.isfinite(data.signal).any():
            state = status.MISSING
        elif not told or deviation >= largest:
            state = status.NO_SIGNAL
        elif (share < settings["least_surface_share"]).all():
            state = status.GAS_DOMINATED
        else:
            state = EXTRAPOLATED if not low <= temperature <= high else VALID
        if state not in status.WITH_VALUE:
            temperature = deviation = np.nan
        residual = data.residual(path, self._mean[SIZE:], self._of)[:, 0]
        return Reading(time, temperature, deviation, state, tuple(share), tuple(residual))

    @property
    def started(self):
        """Whether a sample after the injection has come."""
        return self._mean is not None

    @property
    def rate(self):
        """How fast the temperature changes now [K/s], and its standard uncertainty."""
        return float(self._mean[RATE]), float(np.sqrt(self._covariance[RATE, RATE]))
