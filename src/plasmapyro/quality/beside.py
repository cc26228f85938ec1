"""Intervals of what stands beside a better estimate, or beside none: they hold what contradicts them."""

import numpy as np

from plasmapyro.quality.agreement import FITS, GOOD, NEAR
from plasmapyro.record import status
from plasmapyro.record.level import FAR, emittance_of_level, kelvin_of, leeway, unlike, unlike_level

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

    Samples of a pyrometer whose nearest spectrum is so have none either: they may see the same lamp. Spectra
    whose temperature the level of the pyrometer confirms keep theirs: a window fogged, an exposure changed.
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
        if "corrected_temperature" in result and calibration is not None and response is not None:
            bad &= ~_confirmed(result, attributes, calibration, response)
        result = blanked(_both_fits(result), "scaled_temperature", "spectrum_status", bad)
        if "corrected_temperature" in result:
            moments = result.spectrum_time.values
            bad = bad[np.searchsorted((moments[1:] + moments[:-1]) / 2, result.time.values)]
            bad &= np.isfinite(result.corrected_temperature.values)
            result = blanked(result, "corrected_temperature", "corrected_status", bad)
    return result


def _both_fits(result):
    """Fits whose intervals hold their difference where it exceeds both: other light or a bend is in one."""
    result, (one, other) = result.copy(), (result[name] for name in FITS)
    error = np.fmax(*(result[f"{name}_uncertainty"] for name in FITS))
    off = np.abs(one - other).where(np.abs(one - other) > error)
    for name in FITS if off.notnull().any() else ():
        widen(result, name, off)
    return _told(result, "scaled_temperature", "spectrum_status")


def _confirmed(result, attributes, calibration, response):
    """Spectra (S,) at whose temperature the level of both bands is the light of the surface as stated."""
    kelvin, error = (result[f"scaled_temperature{end}"].values for end in ("", "_uncertainty"))
    near = np.abs(result.time.values - result.spectrum_time.values[:, None]) <= NEAR
    known = np.flatnonzero(np.isfinite(kelvin) & np.isfinite(error) & near.any(axis=1))
    signals = np.array([result.corrected_signal.values[:, near[at]].mean(axis=1) for at in known])
    found = np.zeros(kelvin.size, dtype=bool)
    if known.size:
        rest = attributes, calibration, response
        asked, relative = emittance_of_level(signals.T, kelvin[known], error[known], *rest)
        with np.errstate(invalid="ignore"):
            off = np.abs(np.log(asked / attributes["emittance"])).max(axis=0)
        found[known] = off < FAR * relative
    return found


def with_estimate(fits, estimate):
    """Planck fits whose intervals hold temperature and emissivity together, of the same spectra.

    Both see the same light, and the latter takes no surface as grey. Where it has no temperature the nearest
    difference in time counts.
    """
    known = np.isin(estimate.spectral_status.values, GOOD) & (fits.spectrum_status.values == status.VALID)
    return _holding(fits, FITS, estimate.spectral_temperature.values, known)


def with_joint(correction, estimate):
    """The subtraction of a pyrometer whose intervals hold the joint estimate of the same light, as above."""
    known = np.isin(estimate.estimate_status.values, GOOD) & np.isin(correction.corrected_status.values, GOOD)
    return _holding(correction, ["corrected_temperature"], estimate.surface_temperature.values, known)


def _holding(part, names, other, known):
    """A result whose intervals of some temperatures hold another one (t,), told where `known` (t,)."""
    result = part.copy()
    for name in names if known.any() else ():
        time, off = part[part[name].dims[0]].values, np.abs(part[name] - other)
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
