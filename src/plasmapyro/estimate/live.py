"""The joint estimate sample by sample: the model of the chain as a filter, for a test that is running."""

import dataclasses
from collections import deque
from functools import cache

import numpy as np

from plasmapyro.estimate import prepare, throughput
from plasmapyro.estimate.dynamics import FLICKER, GAS, SIZE, TEMPERATURE, Dynamics, transition
from plasmapyro.estimate.observations import constants, robust_sum, robust_weight
from plasmapyro.estimate.smoother import TELLING
from plasmapyro.estimate.stage import FIRST_RATE, GAS_START, KICK, START_DYNAMICS
from plasmapyro.instrument.calibration import EXTRAPOLATED, VALID
from plasmapyro.instrument.wander import WANDER
from plasmapyro.record import noise, status
from plasmapyro.record.binning import groups
from plasmapyro.record.budget import NORMAL_95

LONGEST = 20_000  # samples before the surface shines that tell the flicker
STEPS, FALL = 8, 1e-6  # Gauss-Newton steps of a sample, and the fall of the objective that ends them
HALVINGS = 6
MEMORY = 4 * prepare.NOISE_BLOCK  # samples from which noise is read, the least that tell it ...
AGAIN = 25  # ... every so many samples
USUAL = 300.0  # [s] of an exposure whose end is not known yet
FIRST_NOISE = 0.01  # [1] of a signal, until its own scatter tells
PAUSE, OFTEN = 5.0, 0.1  # [s] and [1] of the time so far: between two joint estimates
MEDIANS = 5  # of the samples that came while one was made
SIGHT = 3.0  # standard deviations of more light than the gas explains: a surface may be there


@dataclasses.dataclass(frozen=True)
class Reading:
    """What one sample says."""

    time: float  # [s] from the injection
    temperature: float  # [K] NaN where `state` allows none
    uncertainty: float  # [K] standard
    state: int  # as in `record.status`
    surface_share: tuple  # (2,) [1] of each signal
    surprise: float  # [1] robust sum of squares that prediction and sample disagree by, per band: 1 by chance

    @property
    def interval(self):
        """Ends of the 95 % interval [K], as those of the joint estimate."""
        factor = np.exp(NORMAL_95 * self.uncertainty / self.temperature)
        return self.temperature / factor, self.temperature * factor


class _Kept:
    """A table of an instrument that keeps its last answer: one sample asks for the same temperature often."""

    def __init__(self, table):
        self._table, self.temperatures, self.number = table, table.temperatures, getattr(table, "number", 0)
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
    sample, half the robust sum of squares J_k and the Gauss-Newton matrix H_k. From time to time the state
    becomes that of the joint estimate of all samples (`renewal.State`): with its throughput in doubt, its
    dynamics and its drift of the level. Samples tell nothing of the constants but of the gas: their
    uncertainty and its correlation with the state stay, the gain of the constants is nought; nor, as long as
    the gas hides the surface, of how much the gas has changed.

    Notes
    -----
    Sources: Bell & Cathey, IEEE Trans. Autom. Control 38, 294 (1993): the iterated update is a Gauss-Newton
    step; Schmidt, Adv. Control Syst. 3, 293 (1966): constants that are considered, not estimated. Samples
    linearised one by one would tell of a level that none of them sees (10 K in a minute at 1600 K).
    Deviation from the joint estimate: the noise is that of the samples so far. Each step starts from
    the prediction and, where there is more light than the gas explains, also from the temperature that would
    explain it: a cold surface has no slope to follow.
    """

    def __init__(self, record, calibration, response, settings, slope=0.0, renewal=None):
        """`record`: facts of the test, its instruments unused; `settings`: keywords of `posterior`;
        `renewal`: `renewal.Renewal`, or None: it then goes on from its first sample alone."""
        self.off, self._window, self._record = record.off, record.window, record
        self._renewal, self._asked, self._due = renewal, None, PAUSE
        self._rows, self._number = np.empty((LONGEST, 3)), 0  # all samples so far
        self.contradictions, self.throughput_chance = (), 0.0
        one = np.array([True])
        empty = prepare.Samples(
            np.zeros(1), np.zeros((2, 1)), np.ones((2, 1)), one, one, np.zeros(1, int), np.nan, np.nan
        )
        data = prepare.pyrometer_data(empty, response, calibration, np.zeros(2), slope)
        kept, one = {name: _Kept(row) for name, row in data.errors.items()}, np.ones((1, 1))
        self._data = dataclasses.replace(
            data, drift=one, parting=WANDER["ratio"] * one, table=_Kept(data.table), errors=kept
        )
        self._calibration, self._settings = calibration, settings
        self._dynamics = Dynamics(
            **START_DYNAMICS,
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
        """`Reading` of one more sample.

        `time` [s] from the injection, rising; `signal` (2,) [A], NaN where missing or at a limit.
        """
        signal = np.asarray(signal, dtype=float)
        self._learn(time, signal)
        if self._renewal is not None and time >= self._due and self._mean is not None:
            if self._asked is None or self._renewal.ready(time - self._asked):
                self._renew(time)
        self._keep(time, signal)
        if time < 0 or (self._mean is None and not (signal > 0).all()):
            return Reading(time, np.nan, np.nan, status.NOT_INJECTED, (np.nan, np.nan), np.nan)
        if self._mean is None:
            self._begin(signal)
        else:
            self._predict(time)
        return self._reading(time, *self._taken(time, signal, 1))

    def _taken(self, time, signal, count):
        """Move the state to the median of so many samples; it as data, and its matrix of the states."""
        self._time = time
        if abs(time - self.off) <= self._settings["plasma_off_time_span"]:
            signal = np.full(2, np.nan)  # the gas dies: neither there nor gone
        # Of what is due too: a sample that a logger lost as zero is not the more exact for it.
        due = sum(self._data.predict(self._mean[None, :SIZE], self._mean[SIZE:], self._of)[:2])[:, 0]
        spread = self._relative * np.maximum(np.abs(np.nan_to_num(signal)), due)
        spread = np.maximum(
            np.maximum(self._floor, spread), prepare.LEAST_NOISE * np.abs(self._mean[self._gas])
        )
        data = dataclasses.replace(
            self._data,
            signal=signal[:, None],
            noise=spread[:, None] / np.sqrt(count),
            shining=np.array([time <= self.off]),
        )
        return data, self._update(data)

    def _keep(self, time, signal):
        if self._number == len(self._rows):
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
        self._rows[self._number] = time, *signal
        self._number += 1

    def _renew(self, time):
        """Go on from the joint estimate that was asked for, if there is one, and ask for the next."""
        if self._asked is not None and (state := self._renewal.answer()) is not None:
            self.contradictions, self.throughput_chance = state.contradictions, state.throughput_chance
            if not state.contradictions:
                self._resume(state)
        end = max(USUAL, 2 * time) if np.isinf(self.off) else self.off  # of a plasma that burns
        self._renewal.ask(self._rows[: self._number], end)
        self._asked, self._due = time, time + max(PAUSE, OFTEN * time)

    def _resume(self, state):
        """Go on from a state of the past; what came since is taken as a few medians."""
        self._time, self._mean, self._covariance = state.time, state.mean, state.covariance
        self._held = self._constants()
        own = {name: getattr(self._dynamics, name) for name in ("flicker", "flicker_time")}
        self._dynamics = dataclasses.replace(state.dynamics, **own)  # there of means, perhaps
        rows = self._rows[: self._number]
        since = rows[np.searchsorted(rows[:, 0], state.time, "right") :].copy()
        since[np.abs(since[:, 0] - self.off) <= self._settings["plasma_off_time_span"], 1:] = np.nan
        group = groups(since[:, 0], (0.0, self.off), MEDIANS)[: len(since)]
        for one in np.unique(group):
            rows = since[group == one]
            good = rows[np.isfinite(rows).all(axis=1)]
            if len(good):
                time, *signal = np.median(good, axis=0)  # one sample lost as zero must not move them
                self._predict(time)
                self._taken(time, np.array(signal), len(good))

    def _begin(self, signal):
        settings, self._data = self._settings, dataclasses.replace(self._data, first_gas=signal)
        fixed = prepare.pyrometer_constants(
            self._record,
            self._data,
            self._calibration,
            signal,
            settings["gas_change"],
            settings["band_shift_uncertainty"],
        )
        fixed = fixed + constants(throughput.NAME, 0.0, np.sqrt(throughput.CHANCE) * throughput.WIDTH)
        fixed = fixed + constants("band_drift", 0.0, throughput.DRIFT)
        first = [settings["initial_temperature_uncertainty"], np.hypot(FIRST_RATE, KICK), GAS_START]
        self._of, self._gas = cache(fixed.where), SIZE + fixed.where("gas_signal")
        self._mean = np.concatenate([[settings["initial_temperature"], 0.0, 0.0, 0.0], fixed.mean])
        # Entries differ by twenty powers of ten: matrices are inverted in units of these deviations.
        self._scale = np.concatenate([first, [self._dynamics.flicker], fixed.deviation])
        self._first, self._held = self._mean.copy(), self._constants()
        self._forget()

    def _constants(self):
        """Places of those that samples do not tell: all but the light of the gas."""
        return np.setdiff1d(np.arange(SIZE, self._mean.size), self._gas)

    def _forget(self):
        self._mean = self._first.copy()
        self._covariance = np.diag(self._scale**2)

    def _predict(self, time):
        moved, added = transition(self._dynamics, np.array([self._time, time]), (0.0, self.off), 0.0)
        matrix = np.eye(self._mean.size)
        matrix[:SIZE, :SIZE] = moved[0]
        self._mean = matrix @ self._mean
        self._covariance = matrix @ self._covariance @ matrix.T
        self._covariance[:SIZE, :SIZE] += added[0]

    def _inverse_of(self, matrix, scale):
        outer = np.outer(scale, scale)
        return np.linalg.inv(matrix / outer) / outer

    def _update(self, data):
        """Move the state to what the sample says; the sample's own matrix (4, n) of the states.

        Samples that contradict the model beyond what numbers hold make it begin anew.
        """
        self._mean[TEMPERATURE] = np.clip(self._mean[TEMPERATURE], *data.table.temperatures)
        self._surprise = np.nan
        if not np.isfinite(data.signal).any():
            return np.zeros((SIZE, self._mean.size))
        try:
            matrix = self._moved(data)
            if np.isfinite(self._mean).all() and (np.diagonal(self._covariance) > 0).all():
                return matrix
        except ValueError:  # a singular matrix, a temperature that is none
            pass
        self._forget()
        return np.zeros((SIZE, self._mean.size))

    def _moved(self, data):
        weight = self._inverse_of(self._covariance, self._scale)
        gas = data.predict(self._mean[None, :SIZE], self._mean[SIZE:], self._of)[1][1, 0]
        amplitude = self._covariance[GAS, GAS] + self._covariance[FLICKER, FLICKER]
        doubt = SIGHT * np.hypot(data.noise[1, 0], gas * np.sqrt(amplitude))
        ends = []
        for start in self._starts(data, gas, doubt):
            ends.append(self._descend(start, weight, data))
            if ends[-1][0] < 0.5 * SIGHT**2:  # explained
                break
        least, mean = min(ends, key=lambda end: end[0])
        self._surprise = 2 * least / np.isfinite(data.signal).sum()
        # The matrix belongs to where the sample leads, not to the prediction: else thousands of them drift.
        rows, residual = data.of_sample(mean[None, :SIZE], mean[SIZE:], self._of)
        weighted = rows.T * robust_weight(residual)
        covariance = self._inverse_of(weight + weighted @ rows, 1 / self._scale)
        # A surface too cold to be seen has no slope: its first light would be taken for a gas that grows.
        hidden = data.predict(mean[None, :SIZE], mean[SIZE:], self._of)[0][1, 0] < doubt
        held = np.append(self._held, GAS) if hidden else self._held
        gain = covariance @ weighted
        gain[held] = 0.0
        left = np.eye(mean.size) - gain @ rows
        noise = gain / np.sqrt(np.maximum(robust_weight(residual), np.finfo(float).tiny))
        mean[held] = self._mean[held]
        self._mean, self._covariance = mean, left @ self._covariance @ left.T + noise @ noise.T
        return weighted[:SIZE] @ rows

    def _starts(self, data, gas, doubt):
        """The prediction, and the temperature that would explain the light beyond that of the gas."""
        yield self._mean
        body = data.predict(self._mean[None, :SIZE], self._mean[SIZE:], self._of)[0][1, 0]
        surplus = float(data.signal[1, 0] - gas)
        if surplus > doubt and abs(surplus - body) > doubt:
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
                if len(self._cold) > 1:
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
        cold = self._window
        before = time < -self._settings["injection_time_span"]
        deviation, correlation = noise.flicker(
            time, np.array(pair), [before, (time >= cold[0]) & (time <= cold[1])]
        )
        if np.isfinite(deviation):
            self._dynamics = dataclasses.replace(self._dynamics, flicker=deviation, flicker_time=correlation)

    def _reading(self, time, data, matrix):
        settings, path = self._settings, self._mean[None, :SIZE]
        temperature = float(self._mean[TEMPERATURE])
        deviation = float(np.sqrt(self._covariance[TEMPERATURE, TEMPERATURE]))
        by_gas = matrix[TEMPERATURE, GAS] / (
            matrix[GAS, GAS] + 1 / (self._covariance[GAS, GAS] + self._dynamics.flicker**2)
        )
        self._told.append((time, matrix[TEMPERATURE] - by_gas * matrix[GAS]))
        while self._told[0][0] < time - TELLING:
            self._told.popleft()
        surface, gas, _ = data.predict(path, self._mean[SIZE:], self._of)
        share = (surface / (surface + gas))[:, 0]
        largest = settings["largest_uncertainty"] * temperature
        told = sum(part for _, part in self._told)
        own, moved, hidden = told[TEMPERATURE], told[SIZE:], (share < settings["least_surface_share"]).all()
        if hidden and own > 0:  # the path may not know more than the samples about it by themselves
            alone = own + moved @ self._covariance[SIZE:, SIZE:] @ moved
            deviation = max(deviation, np.sqrt(alone) / own)
        low, high = self._calibration.fit_range.values
        if not np.isfinite(data.signal).any():
            dying = abs(time - self.off) <= settings["plasma_off_time_span"]
            state = status.STRADDLING if dying else status.MISSING
        elif (
            own * largest**2 <= 1 or deviation >= largest or (self.late and time <= self.off)
        ):  # a hot surface would pass for gas
            state = status.NO_SIGNAL
        elif hidden:
            state = status.GAS_DOMINATED
        else:
            state = EXTRAPOLATED if not low <= temperature <= high else VALID
        if self.contradictions:
            state = status.CONTRADICTED
        if state not in status.WITH_VALUE:
            temperature = deviation = np.nan
        return Reading(time, temperature, deviation, state, tuple(share), self._surprise)

    @property
    def alone(self):
        """Whether the joint estimate, from which it should go on, has no process any more."""
        return self._renewal is not None and self._renewal.lost

    @property
    def late(self):
        """Whether the first sample came after the reference window: what the gas shines is a guess then."""
        return self._number > 0 and self._rows[0, 0] > self._window[1]

    @property
    def started(self):
        """Whether a sample after the injection has come."""
        return self._mean is not None
