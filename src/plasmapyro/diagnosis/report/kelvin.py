"""What an error costs in kelvin: in the paper's corrected temperature, and in the fitted one."""

from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.experiment.signals import LEAST_SAMPLES, reference_signal
from plasmapyro.record.status import EXTRAPOLATED, VALID

COLDEST = 900.0  # [K], below which the two bands say little
SURFACE = 0.5  # [1] of the light: with less of it from the surface nothing is judged


def judged_span(model, solution):
    """First and last time [s] from the injection when a warm surface is most of what an instrument sees.

    (inf, -inf) if it never is.
    """
    first, last = np.inf, -np.inf
    for instrument, gas, predicted in zip(model.instruments, solution.gas, solution.prediction, strict=True):
        time = instrument.time
        share = np.median(1 - gas / np.where(predicted > 0, predicted, np.inf), axis=1)
        warm = model.history.basis(time) @ solution.state.knots > COLDEST
        seen = time[(time >= 0) & warm & (share >= SURFACE)]
        if seen.size:
            first, last = min(first, seen[0]), max(last, seen[-1])
    return first, last


def paper_temperature(signals, moment, record, reading, reference=None):
    """Corrected temperature (n,) [K] of the paper and its status (n,), from signals (n, 2) [A] on bins.

    `moment` (n,) [s] from the injection; `reference`: mean and standard uncertainty (2,) [A], of the samples
    of the test by default.
    """
    if reference is None:
        reference = reference_of(record)
    injected, shining = record.phases(moment)
    nowhere = np.zeros(moment.size, dtype=bool)
    return reading.corrected(signals.T, *reference, injected, shining, nowhere)[2:]


def reference_of(record):
    """Mean signals of the reference window and their standard uncertainties, (2, 2) [A]; NaN, and no
    temperature by the paper's method, where it holds too few samples."""
    bands = record.instrument("pyrometer")
    inside = record.in_window(bands.time)
    if (np.isfinite(bands.sound[inside]).sum(axis=0) < LEAST_SAMPLES).any():
        return np.full((2, 2), np.nan)
    return np.array([reference_signal(bands.time, row, record.window) for row in bands.sound.T]).T


def reference_weight(moment, number, record):
    """Weights (n,) of bins at some moments, with so many sound samples, in the mean of the reference window:
    of the nearest bin alone where the window is shorter than a bin, or holds lost samples."""
    weight = np.where(record.in_window(moment), number, 0.0)
    if not weight.any():
        away = np.where(number > 0, np.abs(moment - np.mean(record.window)), np.inf)
        weight[np.argmin(away)] = 1.0
    return weight


class PaperShift:
    """Change of the paper's corrected temperature by an effect, from the model's own signals."""

    def __init__(self, model, solution, reading):
        self.model, self.solution = model, solution
        kinds = [instrument.kind for instrument in model.instruments]
        self.which = kinds.index("pyrometer") if "pyrometer" in kinds and reading is not None else None
        if self.which is not None:
            one, record = model.instruments[self.which], model.record
            self.moment = one.time
            self.weight = reference_weight(self.moment, one.number.max(axis=1), record)
            _, state = self._read((), reading)
            self.judged = np.isin(state, (VALID, EXTRAPOLATED))
            # An effect may lead out of the range of the instrument: the curve goes on there.
            self.reading = replace(reading, instrument_range=np.array([0.0, np.inf]))
            self.plain, _ = self._read((), self.reading)

    def _read(self, settings, reading):
        state = self.solution.state
        signals = self.model.evaluate(
            self.which, state.knots, state.values, settings, gas_error=state.error_of_gas(self.which)
        )
        reference = np.average(signals, axis=0, weights=self.weight), np.zeros(2)
        return paper_temperature(signals, self.moment, self.model.record, reading, reference)

    def __call__(self, effect, amplitude, shape):
        """Shift [K] and the time [s] where it is worst; (0, 0) without a pyrometer."""
        if self.which is None or "pyrometer" not in effect.instruments:
            return 0.0, 0.0
        used = float(np.clip(amplitude, *effect.bounds))
        scale = amplitude / used if used else 1.0
        other, _ = self._read((Setting(effect, used, shape),), self.reading)
        change = np.where(self.judged, other - self.plain, np.nan)
        change[~np.isfinite(change)] = np.nan  # a ratio that no temperature gives
        if not np.isfinite(change).any():
            return 0.0, 0.0
        worst = int(np.nanargmax(np.abs(change)))
        return float(change[worst] * scale), float(self.moment[worst])


def fitted_shift(model, solution, screen, index, amplitude, span):
    """Largest shift [K] of the fitted temperature if an effect of some amplitude is left out, and when.

    `span` as from `judged_span`.
    """
    knots = model.history.knots
    judged = (knots >= span[0]) & (knots <= span[1]) & (solution.state.knots > COLDEST)
    change = np.where(judged, screen.shift[:, index] * amplitude, 0.0)
    worst = int(np.argmax(np.abs(change)))
    return float(change[worst]), float(knots[worst])
