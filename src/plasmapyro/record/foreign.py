"""Narrow light before a hot surface that shines without a plasma: a laser or a lamp in the view."""

from dataclasses import replace

import numpy as np

from plasmapyro.instrument.spectrometer import local_noise

SURE = 8.0  # standard deviations by which it stands out
LEAST = 0.03  # [1] of the light beside it: responses are smooth to a per cent
GROWN = 1.2  # what is narrow does not grow so much where twice the width is looked at
LEAST_PIXELS = 3  # of a width
BLOCK = 40  # pixels of one estimate of their noise
MOST = 0.5  # [1] of the pixels that must be left
REACH = 2.0  # widths of the slit to either side that hold it


def narrow_light(wavelength, light, slit, sure=SURE):
    """Where light stands out of what is beside it, no wider than a line: wavelengths [m], strongest first.

    `light` (S, W): spectra, calibrated but for a factor, NaN where there is none; `slit` [m]: full width at
    half maximum of a line, which must stand out by `sure` standard deviations. Means over one width less
    those between one and two widths to either side. The light of a surface is convex where it is steep, so
    that this is negative.
    """
    good = np.isfinite(light).all(axis=0)
    wavelength, mean = wavelength[good], light[:, good].mean(axis=0)
    if wavelength.size < BLOCK:
        return np.zeros(0)
    noise = local_noise(mean, BLOCK)
    width = max(slit, LEAST_PIXELS * np.median(np.diff(wavelength)))
    excess, error, beside = _excess(wavelength, mean, noise, width)
    wider = _excess(wavelength, mean, noise, 2 * width)[0]
    with np.errstate(invalid="ignore"):
        clear = (excess > sure * error) & (excess > LEAST * np.abs(beside))
        clear &= ~(wider > GROWN * excess)
    found = []
    for pixel in np.argsort(-np.where(clear, excess, -np.inf)):
        if not clear[pixel]:
            break
        if all(abs(wavelength[pixel] - other) > REACH * width for other in found):
            found.append(wavelength[pixel])
    return np.array(found)


def _excess(wavelength, mean, noise, width):
    """Excess (W,) of the mean over a width about each pixel, its standard error, and what is beside it."""

    def window(low, high):
        first, last = (np.searchsorted(wavelength, wavelength + end * width) for end in (low, high))
        count = (last - first).astype(float)
        outside = (wavelength + low * width < wavelength[0]) | (wavelength + high * width > wavelength[-1])
        count[outside | (count == 0)] = np.nan
        sums = [np.append(0.0, np.cumsum(one)) for one in (mean, noise**2)]
        return (sums[0][last] - sums[0][first]) / count, (sums[1][last] - sums[1][first]) / count**2

    (middle, own), (left, before), (right, after) = (window(*one) for one in ((-0.5, 0.5), (-2, -1), (1, 2)))
    return middle - (left + right) / 2, np.sqrt(own + (before + after) / 4), (left + right) / 2


def without_narrow_light(record):
    """A record without a plasma with no value where its spectra hold narrow light, unless that is most."""
    frames = record.instrument("spectrometer")
    if frames is None or record.window:
        return record
    slit = float(record.attributes["spectrometer_fwhm"])
    kept = np.ones(frames.wavelength.size, bool)
    for place in narrow_light(frames.wavelength, frames.sound, slit):
        kept &= np.abs(frames.wavelength - place) > REACH * slit
    if kept.all() or kept.mean() < MOST:
        return record
    clean = replace(frames, value=np.where(kept, frames.value, np.nan))
    return replace(record, instruments=tuple(clean if one is frames else one for one in record.instruments))
