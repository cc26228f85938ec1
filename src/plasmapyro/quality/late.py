"""How two clocks of a test differ, by the light of its surface, and which temperatures that moves."""

from typing import NamedTuple

import numpy as np

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.instrument.pyrometer import blackbody_signals
from plasmapyro.record import status
from plasmapyro.record.clock import CLEARER, offset
from plasmapyro.record.level import EFFECTIVE

TEMPERATURES = {  # of results, and their status
    "corrected_temperature": "corrected_status",
    "scaled_temperature": "spectrum_status",
    "surface_temperature": "estimate_status",
}
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
    told = offset(result.time.values, narrow, moments, case.exposure, fitted, clear[good])
    if told is None:
        return None
    late, growth, clearer = told
    if clearer < CLEARER:
        return None
    rate = growth * kelvin**2 * EFFECTIVE / SECOND_RADIATION  # Wien's law
    known = np.isfinite(rate)
    found = Clocks(late, moments[known], late * rate[known], switches)
    return found if any(found.beyond(result, name, limit).any() for name in ALONE) else None
