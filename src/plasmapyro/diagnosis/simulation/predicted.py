"""How well a simulation foretells the gas of a test that it has not seen."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.experiment.correction import Reading
from plasmapyro.experiment.signals import reference_signal
from plasmapyro.record.record import record_of
from plasmapyro.record.status import VALID

BLOCK = 25e-9  # [m] of wavelength over which light is compared
STATED = 0.1  # [1] ASSUME: relative error of the simulated light in a block, for the log score


@dataclass(frozen=True)
class Prediction:
    """Simulated gas beside that of a test in its reference window.

    `signal` (2,) and `spectrum` (B,): logarithm of simulated over measured light, in the bands and in blocks
    of wavelength; `temperature` (t,) [K] read from the signals less the simulated instead of the measured
    gas, less the one read with the measured gas; NaN where either is not valid; `bands` (2, 2)
    [W m-2 sr-1]: the simulated, and the measured light of the gas in the bands;
    `wavelength` (B,) [m]: the middles of the blocks.
    """

    signal: np.ndarray
    spectrum: np.ndarray
    temperature: np.ndarray
    bands: np.ndarray
    wavelength: np.ndarray

    @property
    def kelvin(self):
        """Root mean square error [K] of the temperature; NaN without a valid one."""
        known = self.temperature[np.isfinite(self.temperature)]
        return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")

    @property
    def log_score(self):
        r"""Log density (2 + B,) of each number, up to a constant: :math:`-e^2/2s^2`, s is `STATED`."""
        return -0.5 * (np.concatenate([self.signal, self.spectrum]) / STATED) ** 2


def predicted(test, radiation, reading, calibration, spectrometer_calibration, *, saturation_counts):
    """What a simulation ('radiation', of its condition) foretells of the gas of a test with both instruments.

    Raw counts from `saturation_counts` on are saturated. Source: Fagnani et al., eq. 12, with the simulated
    for the measured reference.
    """
    calibrations = {"pyrometer": calibration, "spectrometer": spectrometer_calibration}
    record = record_of(test, calibrations, saturation_counts=saturation_counts)
    bands, frames = (record.instrument(name) for name in calibrations)
    measured = np.array([reference_signal(bands.time, row, record.window) for row in bands.sound.T]).T
    sensitivity = calibration["absolute_sensitivity"].values
    simulated = radiation["band_signal"].values * sensitivity
    injected, shining = record.phases(bands.time)
    nowhere = np.zeros(bands.time.size, dtype=bool)
    read = [
        reading.corrected(bands.sound.T, level, measured[1], injected, shining, nowhere)[2:]
        for level in (simulated, measured[0])
    ]
    valid = (read[0][1] == VALID) & (read[1][1] == VALID) & shining
    half = frames.integration_time / 2  # an exposure across the injection sees the jet without the sample
    inside = record.in_window(frames.time - half) & record.in_window(frames.time + half)
    spectra = np.nanmean(frames.sound[inside], axis=0)
    light = np.interp(frames.wavelength, radiation["wavelength_slit"], radiation["gas_radiance_slit"])
    block = (frames.wavelength // BLOCK).astype(int)
    usable = np.isfinite(spectra)
    sums = [np.bincount(block[usable], values[usable]) for values in (light, spectra)]
    seen = (sums[0] > 0) & (sums[1] > 0)
    return Prediction(
        np.log(simulated / measured[0]),
        np.log(sums[0][seen] / sums[1][seen]),
        np.where(valid, read[0][0] - read[1][0], np.nan),
        np.array([simulated, measured[0]]) / sensitivity,
        (np.flatnonzero(seen) + 0.5) * BLOCK,
    )


def foretold(tests, calibration, spectrometer_calibration, *, limits, saturation_counts):
    """What simulations foretell of the gas of tests: name -> a `Prediction` for each simulation.

    `tests`: name -> (test, then Datasets of the contract 'radiation'); `limits`: as of `stage.diagnose`.
    """
    found = {}
    for name, (test, *simulated) in tests.items():
        reading = Reading.of(calibration, float(test.attrs.get("emittance_slope", 1.0)), **limits)
        found[name] = [
            predicted(
                test,
                radiation,
                reading,
                calibration,
                spectrometer_calibration,
                saturation_counts=saturation_counts,
            )
            for radiation in simulated
        ]
    return found
