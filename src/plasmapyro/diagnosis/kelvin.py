"""What an error costs in kelvin: in the paper's corrected temperature, and in the fitted one."""

import numpy as np

from plasmapyro.diagnosis.catalogue import EFFECTS
from plasmapyro.diagnosis.model import Setting
from plasmapyro.instrument.pyrometer import invert_ratio, signal_ratio

JUDGED = (18.0, 330.0)  # [s] after injection, between which shifts are judged
COLDEST = 900.0  # [K], below which the two bands say little


def paper_temperature(signals, moment, window, off, curve):
    r"""Corrected temperature as in the paper: the mean of a window taken away while the plasma burns.

    .. math:: T_{corr} = H_c^{-1}\left(\frac{S_1 - S_{1,ref}}{S_2 - S_{2,ref}}\right)

    Parameters
    ----------
    signals : (n, 2) array [A]
    moment : (n,) array [s]
    window : (first, last) [s]
    off : float [s]
    curve : (temperature (C,) [K], ratio (C,) [1]) of a black body

    Returns
    -------
    (n,) ndarray [K], NaN where there is none

    Notes
    -----
    Source: Fagnani et al., eqs. 6 and 10.
    """
    inside = (moment >= window[0]) & (moment <= window[1])
    reference = np.nanmean(signals[inside], axis=0) if inside.any() else np.zeros(2)
    corrected = signals - np.where((moment < off)[:, None], reference, 0.0)
    ratio = signal_ratio(corrected[:, 0], corrected[:, 1])
    temperature, _ = invert_ratio(ratio, *curve)
    return np.where(moment >= 0, temperature, np.nan)


class PaperShift:
    """Change of the paper's corrected temperature by a term, from the model's own signals."""

    def __init__(self, model, solution, window, curve):
        self.model, self.solution, self.window, self.curve = model, solution, window, curve
        kinds = [one.kind for one in model.instruments]
        self.which = kinds.index("pyrometer") if "pyrometer" in kinds and curve is not None else None
        if self.which is not None:
            self.moment = model.instruments[self.which].moment.mean(axis=1)
            temperature = model.history.basis(self.moment) @ solution.state.knots
            self.judged = (self.moment >= JUDGED[0]) & (self.moment <= JUDGED[1]) & (temperature > COLDEST)
            self.plain = self._read(())

    def _read(self, settings):
        state = self.solution.state
        signals = self.model.evaluate(self.which, state.knots, state.values, settings)
        return paper_temperature(signals, self.moment, self.window, self.model.off, self.curve)

    def __call__(self, identity, amplitude, shape):
        """Shift [K] and the time [s] where it is worst; (0, 0) without a pyrometer."""
        if self.which is None or "pyrometer" not in EFFECTS[identity].instruments:
            return 0.0, 0.0
        low, high = EFFECTS[identity].bounds
        used = float(np.clip(amplitude, low, high))
        scale = amplitude / used if used else 1.0
        change = np.where(self.judged, self._read((Setting(identity, used, shape),)) - self.plain, np.nan)
        if not np.isfinite(change).any():
            return 0.0, 0.0
        worst = int(np.nanargmax(np.abs(change)))
        return float(change[worst] * scale), float(self.moment[worst])


def fitted_shift(model, solution, found, index, amplitude):
    """Shift [K] of the fitted temperature if a term of some amplitude is left out, where it is worst, and
    when."""
    knots = model.history.knots
    judged = (knots >= JUDGED[0]) & (knots <= JUDGED[1]) & (solution.state.knots > COLDEST)
    change = np.where(judged, found.shift[:, index] * amplitude, 0.0)
    worst = int(np.argmax(np.abs(change)))
    return float(change[worst]), float(knots[worst])
