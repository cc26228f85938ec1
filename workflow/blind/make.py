"""A case becomes a test file, and a truth that stays in this process until the diagnosis is done."""

import dataclasses
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache, partial

import numpy as np
import xarray as xr
from twin import campaign, hidden
from twin.sample import history

from blind import bench
from blind.draw import LABORATORIES, PUZZLE
from blind.metric import Metric


@dataclass(frozen=True)
class Made:
    """A case with everything that is true about it; `test` is all that the analyser gets."""

    case: object
    base: bench.Base
    effects: tuple  # of dicts: effect, amplitude, shape, snr
    test: xr.Dataset
    metric: Callable | None = None  # makes the `Metric` of the base, once

    def truth(self):
        """What was hidden, for the record."""
        return {"case": self.case.as_dict(), "base": asdict(self.base), "effects": list(self.effects)}

    def angle(self, one, other):
        """Degrees between the signatures of two effects."""
        return self.metric().angle(one, other, {e["effect"]: e for e in self.effects})

    def temperature(self, time):
        """True surface temperature (t,) [K]."""
        sample = dataclasses.replace(campaign.Sample(), emittance=self.base.emittance, **self.base.sample)
        return history(sample, np.asarray(time, dtype=float), 300.0)


class BeyondRange(ValueError):
    """The amplitude that the SNR asks for is not physically sensible."""


def make(case, workbench):
    """Make a case from a `Bench`; BeyondRange if an effect cannot reach its SNR within its range."""
    if case.kind == "puzzle":
        return _puzzle(case, workbench)
    base = bench.draw_base(case.seed, LABORATORIES)
    metric = cache(partial(Metric, workbench, base))
    effects = tuple(_sized(metric(), *one) for one in case.effects)
    gas, scene = workbench.gas(base), workbench.scene(base)
    test, _ = workbench.record(bench.apply(scene, gas, effects, case.noise), gas, base)
    return Made(case, base, effects, test, metric)


def _sized(metric, effect, snr, sign, shape):
    """The effect with the amplitude that gives the SNR; signatures may be curved, so it is iterated."""
    entry = hidden.EFFECTS[effect]
    amplitude, power, before = sign * entry.unit * 0.1, 1.0, None
    for _ in range(5):
        amplitude = float(np.clip(amplitude, entry.low, entry.high))
        _, size = metric.signature([{"effect": effect, "amplitude": amplitude, "shape": shape}])
        if before is not None and amplitude != before[0]:
            # Spreads and widths act by their square: the power is measured, or the steps would swing.
            measured = np.log(size / before[1]) / np.log(amplitude / before[0])
            power = float(np.clip(measured, 0.5, 3.0))
        before = amplitude, size
        wanted = amplitude * (snr / size) ** (1 / power)
        if abs(wanted / amplitude - 1) < 0.02:
            break
        amplitude = wanted
    if not entry.low <= amplitude <= entry.high:
        raise BeyondRange(f"{effect} at SNR {snr:g} needs the amplitude {amplitude:.3g}")
    return {"effect": effect, "amplitude": float(amplitude), "shape": shape, "snr": snr}


def _puzzle(case, workbench):
    """Light stronger than the simulated power of 60 kW gives, for one of six reasons."""
    base = bench.draw_base(case.seed, LABORATORIES, condition="60kW", power_error=0.03)
    effect, amplitude, shape = PUZZLE[case.options["explanation"]]
    gas, scene = workbench.gas(base), workbench.scene(base)
    if effect == "path":
        gas = dataclasses.replace(gas, radiance=gas.radiance * (1 + amplitude))
    elif effect == "calibration":
        scene = dataclasses.replace(scene, spectrometer_output=lambda rate, time: rate * (1 + amplitude))
    else:
        scene = hidden.hide(scene, effect, amplitude, gas, shape)
    test, _ = workbench.record(scene, gas, base)
    made = {"effect": effect, "amplitude": amplitude, "shape": shape, "snr": None}
    return Made(case, base, (made,), test, cache(partial(Metric, workbench, base)))
