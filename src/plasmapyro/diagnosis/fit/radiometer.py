"""A radiometer of any bands in the place of the pyrometer: its bands, and an emissivity over wavelength."""

import logging
from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.fit.parameter import Parameter
from plasmapyro.record.emittance import ANY_LEVEL, UNTOLD, course, mean_emittance

LOG = logging.getLogger(__name__)
UNSEEN = 1e-3  # [1], of the response of a band that may lie outside the simulated spectra
GRID = 10e-9  # [m] on which shapes of the emissivity are held
# ASSUME: course of an emissivity over wavelength about the stated one, as of the estimate with `emissivity`.
COURSE, LENGTH = 0.1, 200e-9  # [1], [m]
LEAST = 1e-4  # of the largest variance: shapes of less are left out


def covered(frames, calibration, wavelength):
    """The bands that lie within simulated spectra (K,) [m], and their calibration.

    Parameters
    ----------
    frames : record.Instrument
    calibration : Dataset, contract 'radiometer_calibration'
    wavelength : (K,) array [m]

    Raises
    ------
    ValueError
        If there is none; a displayed ratio.
    """
    if why := refused(calibration, frames.band, wavelength):
        raise ValueError(why)
    kept = _within(calibration, frames.band, wavelength)
    lost = [band for place, band in enumerate(frames.band) if place not in kept]
    if lost:
        LOG.warning("bands beyond %s are left out: %s", _span(wavelength), ", ".join(lost))
    bands = tuple(frames.band[place] for place in kept)
    part = replace(frames, value=frames.value[:, kept], flag=frames.flag[:, kept], band=bands)
    return part, calibration.sel(band=list(bands))


def refused(calibration, bands, wavelength):
    """Why a diagnosis cannot take the bands of a calibration with spectra at wavelengths (K,) [m], or ""."""
    if calibration.attrs["calibration"] == "readings" and len(bands) == 2:
        return (
            "a displayed ratio has no level to diagnose by: `correct --estimator emissivity` takes it without"
            " a plasma, `correct-reading` behind one"
        )
    if not _within(calibration, bands, wavelength):
        return (
            f"a diagnosis needs a band within {_span(wavelength)}; the radiometer has none: compute the"
            " radiance over its range, or leave it out"
        )
    return ""


def _within(calibration, bands, wavelength):
    """Places of the bands that simulated spectra hold."""
    axis = calibration.wavelength.values
    outside = (axis < wavelength[0]) | (axis > wavelength[-1])
    curves = [calibration.responsivity.sel(band=band).values for band in bands]
    seen = [np.trapezoid(one * outside, axis) <= UNSEEN * np.trapezoid(one, axis) for one in curves]
    return [int(place) for place in np.flatnonzero(seen)]


def _span(wavelength):
    return f"the simulated spectra, {wavelength[0] * 1e9:.0f} to {wavelength[-1] * 1e9:.0f} nm"


def seen_part(name, axis, curve):
    """Wavelengths of a band where nodes are needed: all of a pyrometer's table."""
    if name == "pyrometer":
        return axis
    seen = np.flatnonzero(curve > 0)
    return axis[max(seen[0] - 1, 0) : seen[-1] + 2]


def of_an_emissivity(instruments, record, calibration):
    """The instruments before a surface whose emissivity bends over wavelength, as a smooth prior lets it.

    Where one band is all there is, its emissivity is what is stated.
    """
    every = np.concatenate([one.wavelength for one in instruments])
    grid = np.arange(every.min(), every.max() + GRID, GRID)
    variance, vector = np.linalg.eigh(course(grid, COURSE, LENGTH))
    kept = (variance > LEAST * variance[-1]) & (sum(one.channels for one in instruments) > 1)
    shapes = (vector * np.sqrt(np.maximum(variance, 0.0)))[:, kept]
    found = []
    for one in instruments:
        bent = np.array([np.interp(one.wavelength, grid, row) for row in shapes.T])
        bent = bent.reshape(-1, one.wavelength.size).T
        relative = mean_emittance(record.attributes, one.wavelength) / record.emittance
        own = {"relative": relative, "course": bent}
        if one.source == "radiometer":
            own["known"] = calibration["band_sensitivity_uncertainty"].values
            own["factor"] = np.nanmedian(np.abs(one.value), axis=0)  # bands differ in unit: noise is relative
        found.append(replace(one, **own))
    return found


def instead(base, instruments, record, calibration):
    """Parameters of the base model with an emissivity that bends; of a radiometer instead of a pyrometer
    where there is its `calibration`."""
    level = record.emittance_uncertainty / record.emittance or UNTOLD
    changed, left_out = {"emittance": level}, set()
    if calibration is not None:
        changed["lamp"], left_out = max(float(calibration.source_temperature_uncertainty), 1e-3), {"ratio"}
        if calibration.attrs["calibration"] == "relative":
            changed["gain_pyrometer"] = ANY_LEVEL
    kept = [replace(one, sigma=changed.get(one.id, one.sigma)) for one in base if one.id not in left_out]
    name = "course of the emissivity over wavelength"
    count = instruments[0].course.shape[1]
    return (*kept, *(Parameter(f"course_{place}", name, 1.0) for place in range(count)))
