"""A test bench: pyrometers by bands and detector in, their errors in front of a set of gases out."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.analysis.error import error_limit
from plasmapyro.constants import ELEMENTARY_CHARGE, LIGHT_SPEED, PLANCK
from plasmapyro.design import budget
from plasmapyro.design.bands import air_loss, detector_row, efficiency, transmittance
from plasmapyro.radiation.bandsignal import respond
from plasmapyro.tables import Table

REFERENCE_TEMPERATURE = 1500.0  # [K], of mean wavelengths and of the sensitivity that is quoted
PEAK_RESPONSIVITY = 0.6  # [A W-1], ASSUME: of a published response, which is normalised; noise only
USABLE = 0.1  # [1], of the peak efficiency: where a detector counts as blind


def limit_of(temperature, error, level):
    """Temperature [K] above which an error (..., T) of any sign stays below a level (...): the lowest of the
    rising temperatures (T,) if it does at all of them, NaN if not even at the highest."""
    limit, status = error_limit(temperature, np.abs(error), level)
    return np.where(status == -1, temperature[0], limit)


@dataclass(frozen=True)
class Bench:
    """`edges` (B + 1,) [m] of the bins, `gas` (C, B) [W m-2 sr-1 m-1] of which the first `scored` count in a
    score, temperatures (T,) [K] and emittances (E,) [1] to be averaged over, the instrument's stated
    properties and tables."""

    edges: np.ndarray
    gas: np.ndarray
    scored: int
    temperature: np.ndarray
    emittance: np.ndarray
    receiver: budget.Receiver
    uncertainties: budget.Uncertainties
    detectors: Table
    silicon: Table
    silicon_thickness: float
    air: Table

    @property
    def wavelength(self):
        """Middle of each bin (B,) [m]."""
        return (self.edges[1:] + self.edges[:-1]) / 2

    def usable_range(self, detector):
        """Shortest and longest bin edge [m] between which a detector sees a tenth of its peak or more."""
        seen = self._efficiency(detector)
        used = np.flatnonzero(
            seen >= USABLE * self.detectors["efficiency"][detector_row(detector, self.detectors)]
        )
        return (
            (self.edges[used[0]], self.edges[used[-1] + 1]) if used.size else (self.edges[0], self.edges[0])
        )

    def currents(self, detector, centre, fwhm, shape):
        """Currents of filters (D, N) [m] before one detector."""
        responses = transmittance(self.edges, centre, fwhm, shape) * self._efficiency(detector)
        return self._currents(
            responses, self.detectors["resistance_area"][detector_row(detector, self.detectors)]
        )

    def currents_of(self, wavelength, responsivities):
        """Currents of one pyrometer given by its normalised responses to power (N, R) at wavelengths
        (R,) [m]."""
        middle = self.wavelength
        curves = np.array([respond(middle, wavelength, row) for row in responsivities])
        quantum = PEAK_RESPONSIVITY * PLANCK * LIGHT_SPEED / (ELEMENTARY_CHARGE * middle)
        resistance = self.detectors["resistance_area"][detector_row("silicon", self.detectors)]
        return self._currents((curves * quantum)[None], resistance)

    def weights(self, signal):
        """Contrast of each design (D, N), `budget.contrast` with the mean square of what the gas adds."""
        grey = self.emittance.mean()
        black = budget.at_temperature(signal.black, [REFERENCE_TEMPERATURE])[..., 0]
        added = np.log1p(signal.gas[..., : self.scored] / (grey * black[..., None]))
        covariance = np.einsum("dic,djc->dij", added, added) / added.shape[-1]
        return budget.contrast(signal, self.uncertainties, covariance, REFERENCE_TEMPERATURE)

    def parts(self, signal, weights):
        """Errors (source, D, scored, E, T) of designs over the ranges of the bench; see `budget.errors`."""
        gas = signal.gas[..., : self.scored]
        given = self.temperature, self.emittance, self.receiver, self.uncertainties
        return budget.errors(signal, weights, gas, *given)

    def score(self, signal):
        """Root mean square of the total error (D,) [1]."""
        return budget.score(self.parts(signal, self.weights(signal)))

    def gas_error(self, signal, weights, temperature, emittance, gas=None, reflected=None):
        """Error that the gas causes (D, C, E, T) [1], signed, NaN where there is no reading."""
        gas = signal.gas if gas is None else gas
        black = budget.at_temperature(signal.black, temperature)[:, :, None, None, :]
        grey = np.asarray(emittance, dtype=float)[:, None]
        measured = black * grey + gas[:, :, :, None, None]
        if reflected is not None:
            measured = measured + (1 - grey) * reflected[:, :, :, None, None]
        measured = np.where(measured > 0, measured, np.nan)  # more was subtracted than there is: no reading
        return budget.read(signal, weights, measured, grey) / temperature - 1

    def _efficiency(self, detector):
        return efficiency(detector, self.wavelength, self.detectors, self.silicon, self.silicon_thickness)

    def _currents(self, responses, resistance_area):
        loss = air_loss(self.edges, self.air) * self.uncertainties.air_path
        area = np.full(len(responses), resistance_area)
        return budget.currents(
            responses, self.edges, self.gas, self.receiver, area, loss, REFERENCE_TEMPERATURE
        )
