"""Intervals of what stands beside a better estimate, or beside none: they hold what contradicts them."""

import numpy as np

from plasmapyro.quality.agreement import FITS, GOOD
from plasmapyro.record import status
from plasmapyro.record.level import emittance_of_level, kelvin_of, leeway, unlike, unlike_level

LARGEST = 0.2  # [1] of a temperature: 318 K, the range of the pyrometer, of 1600 K; more tells none
BESIDE = {  # what else is told of a temperature
    "corrected_temperature": ("relative_error",),
    "scaled_temperature": ("spectrometer_temperature",),
}


def widen(result, name, change):
    """Add a change (t,) [K] of a temperature to its uncertainty and interval, as one more standard error."""
    known = result[f"{name}_uncertainty"]
    wider = np.hypot(known, change.fillna(0.0).values)
    if f"{name}_interval" in result:
        middle, ends = result[name], result[f"{name}_interval"]
        result[f"{name}_interval"] = (middle * (ends / middle) ** (wider / known)).transpose(*ends.dims)
    result[f"{name}_uncertainty"] = wider


def blanked(part, name, state, bad):
    """A result without values of a temperature, and what is told of it, where `bad` (t,): contradicted."""
    kinds = [kind for kind in part.data_vars if kind.startswith((name, *BESIDE.get(name, ())))]
    changed = {kind: part[kind].copy(data=np.where(bad, np.nan, part[kind].values)) for kind in kinds}
    changed[state] = part[state].copy(data=np.where(bad, np.int8(status.CONTRADICTED), part[state].values))
    return part.assign(changed)


def of_surface(result, attributes, calibration=None, response=None):
    """A correction without values where the level is no light of the temperature: `level.unlike`.

    Samples of a pyrometer whose nearest spectrum is so have none either: they may see the same lamp.
    Arguments as of `emittance_of_level`; without calibration and response its own level is not asked.
    """
    if "corrected_temperature" in result and calibration is not None and response is not None:
        known = (
            result[f"corrected_{name}"].values
            for name in ("signal", "temperature", "temperature_uncertainty")
        )
        bad = unlike_level(*known, attributes, calibration, response)
        result = blanked(result, "corrected_temperature", "corrected_status", bad)
    if "apparent_emittance" in result:
        scale, error = (result[f"apparent_emittance{end}"].values for end in ("", "_uncertainty"))
        stated = attributes["emittance"]
        relative = np.hypot(error / scale, attributes["emittance_uncertainty"] / stated)
        bad = unlike(np.log(scale / stated), leeway(relative, attributes, instrument="spectrometer"))
        result = blanked(result, "scaled_temperature", "spectrum_status", bad)
        if "corrected_temperature" in result:
            moments = result.spectrum_time.values
            bad = bad[np.searchsorted((moments[1:] + moments[:-1]) / 2, result.time.values)]
            bad &= np.isfinite(result.corrected_temperature.values)
            result = blanked(result, "corrected_temperature", "corrected_status", bad)
    return result


def with_estimate(fits, estimate):
    """Planck fits whose intervals hold temperature and emissivity together, of the same spectra.

    Both see the same light, and the latter takes no surface as grey. Where it has no temperature the nearest
    difference in time counts.
    """
    known = np.isin(estimate.spectral_status.values, GOOD) & (fits.spectrum_status.values == status.VALID)
    result, time = fits.copy(), fits.spectrum_time.values
    for name in FITS if known.any() else ():
        off = np.abs(fits[name] - estimate.spectral_temperature.values)
        widen(result, name, off.copy(data=np.interp(time, time[known], off.values[known])))
    return result


def with_level(result, attributes, calibration, response):
    """A correction beside which nothing is recommended: its intervals hold the temperature of the level, too.

    Of level and colour one is wrong, and nobody knows which: the difference is one more standard error. A
    temperature of which more than `LARGEST` is uncertain then is contradicted. Arguments as of
    `emittance_of_level`; without calibration and response the pyrometer stays as it is.
    """
    result = result.copy()
    if "corrected_temperature" in result and calibration is not None and response is not None:
        kelvin, error = (result[f"corrected_temperature{end}"] for end in ("", "_uncertainty"))
        known, off = np.isfinite(kelvin.values), np.zeros(kelvin.size)
        signals = result.corrected_signal.values[:, known], kelvin.values[known], error.values[known]
        asked, _ = emittance_of_level(*signals, attributes, calibration, response)
        off[known] = np.abs(np.log(asked / attributes["emittance"])).max(axis=0, initial=0.0)
        widen(result, "corrected_temperature", kelvin_of(off, kelvin))
        result = _told(result, "corrected_temperature", "corrected_status")
    if "apparent_emittance" in result:
        off, middle = (
            np.log(result.apparent_emittance / attributes["emittance"]),
            float(result.wavelength.mean()),
        )
        for name in FITS:
            widen(result, name, kelvin_of(off, result[name], middle))
        result = _told(result, "scaled_temperature", "spectrum_status")
    return result


def _told(result, name, state):
    return blanked(result, name, state, (result[f"{name}_uncertainty"] > LARGEST * result[name]).values)
