"""How two clocks of a test differ, by the light of its surface, and which temperatures that moves."""

from typing import NamedTuple

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.instrument.pyrometer import blackbody_signals
from plasmapyro.record import status
from plasmapyro.record.clock import CLEARER, FEWER, offset
from plasmapyro.record.level import EFFECTIVE

TEMPERATURES = {  # of results, and their status
    "corrected_temperature": "corrected_status",
    "scaled_temperature": "spectrum_status",
    "surface_temperature": "estimate_status",
}
FARTHEST, LEAST_STEP = 12.0, 0.25  # [s] up to where an offset is looked for, in exposures or these steps
ALONE = ("corrected_temperature", "scaled_temperature")  # of one instrument


class Clocks(NamedTuple):
    """An offset, and by how much it moves a temperature."""

    late: float  # [s] spectra against the pyrometer
    moments: np.ndarray  # (n,) [s]
    moved: np.ndarray  # (n,) [K] at these, `late` times the rate of change
    switches: list  # [s] of the heat

    def beyond(self, part, name, limit):
        """Where (t,) a temperature of a result has moved by more than `limit` of its uncertainties."""
        time, error = (part[one].values for one in (*part[name].dims, f"{name}_uncertainty"))
        moved = np.zeros(time.size)
        own, phase = (np.searchsorted(self.switches, one) for one in (self.moments, time))
        for one in np.unique(own):  # rates jump where the heat is switched
            here = phase == one
            moved[here] = np.interp(time[here], self.moments[own == one], self.moved[own == one])
        held = np.isin(part[TEMPERATURES[name]].values, status.WITH_VALUE)
        return held & (np.abs(moved) > limit * error)


def clocks(case, limit):
    """`Clocks` of a correction; None where its light tells no offset, or one that harms nothing.

    That is one that moves no temperature of a single instrument by more than `limit` uncertainties. What it
    cannot follow the joint estimate says itself.
    """
    result = case.result
    if case.response is None:
        return None
    switches = [result.attrs[name] for name in ("injection_time", "plasma_off_time") if name in result.attrs]
    moments = result.spectrum_time.values
    kelvin, clear, emittance = (
        result[name].values for name in ("scaled_temperature", "signal_to_noise", "apparent_emittance")
    )
    good = (result.spectrum_status.values == status.VALID) & (clear > 0)
    good &= np.all([np.abs(moments - switch) > case.exposure for switch in switches], axis=0)
    moments, kelvin = moments[good], kelvin[good]
    fitted = emittance[good] * blackbody_signals(kelvin, case.response)[1]
    narrow = result.corrected_signal.values[1]
    step = max(case.exposure, LEAST_STEP)
    shifts = np.arange(-np.floor(FARTHEST / step), np.floor(FARTHEST / step) + 1) * step
    tried = [
        offset(result.time.values, narrow, moments - shift, case.exposure, fitted, clear[good])
        for shift in shifts
    ]
    stated = tried[shifts.size // 2]
    near = [  # no spectrum may leave the record, nor the step in which growth is one number
        (one.left, shift + one.late, one)
        for shift, one in zip(shifts, tried, strict=True)
        if stated and one and one.count >= stated.count and abs(one.late) <= step
    ]
    if not near:
        return None
    left, late, best = min(near, key=lambda row: row[0])
    if stated.without < FEWER.get(best.count, CLEARER) * left:
        return None
    # Between where a spectrum is stated and where it belongs; Wien's law.
    growth = np.nanmax(np.abs([stated.growth, best.growth]), axis=0)
    rate = growth * kelvin**2 * EFFECTIVE / SECOND_RADIATION
    known = np.isfinite(rate)
    found = Clocks(late, moments[known], late * rate[known], switches)
    return found if any(found.beyond(result, name, limit).any() for name in ALONE) else None
