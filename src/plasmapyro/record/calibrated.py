"""Radiances out of what a spectrometer wrote down."""

import numpy as np

from plasmapyro.instrument.raw_counts import above_baseline
from plasmapyro.instrument.spectrometer import USABLE, measured_radiance
from plasmapyro.refraction import vacuum_wavelength

SAME_PIXEL = 1e-11  # [m] programs print 2 to 4 digits of a nanometre; pixels are ten times as far apart


def on_same_wavelengths(first, second):
    """Whether two datasets hold the same pixels, up to the digits that programs print."""
    mine, its = first.wavelength.values, second.wavelength.values
    return mine.size == its.size and np.allclose(mine, its, rtol=0, atol=SAME_PIXEL)


def of_pixels(calibration, test):
    """A spectrometer's calibration for the pixels of a test that holds only some of them, else as it is."""
    own, wanted = calibration.wavelength.values, test.wavelength.values
    nearest = np.abs(own[:, None] - wanted).argmin(axis=0)
    some = wanted.size < own.size and np.allclose(own[nearest], wanted, rtol=0, atol=SAME_PIXEL)
    return calibration.isel(wavelength=nearest) if some else calibration


def _span(dataset):
    values = dataset.wavelength.values * 1e9
    return f"{values.size} pixels from {values[0]:.3f} to {values[-1]:.3f} nm"


def _apart(calibration, test):
    """What as many pixels of two datasets differ by, and what that looks like."""
    first, second = (one.wavelength.values for one in (calibration, test))
    if first.size != second.size:
        return ""
    off = np.abs(second - first)
    words = f", up to {off.max() * 1e9:.2g} nm apart"
    if np.allclose(off, vacuum_wavelength(first) - first, rtol=0.2, atol=0):
        return words + ", as air from vacuum: state `wavelengths` of both as they are"
    close = off.max() < np.abs(np.diff(first)).min() / 2
    return words + (": were they printed with fewer digits, or calibrated anew in between?" if close else "")


def halves(radiance):
    """Mean radiance (2, S) of the pixels of shorter and of longer wavelength; NaN without a usable one."""
    good = np.isfinite(radiance)
    middle = np.searchsorted(np.cumsum(good.any(axis=0)), good.any(axis=0).sum() / 2)
    parts = [slice(None, middle), slice(middle, None)]
    count = np.array([good[:, part].sum(axis=1) for part in parts])
    total = np.array([np.where(good[:, part], radiance[:, part], 0.0).sum(axis=1) for part in parts])
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def calibrated_radiance(test, calibration, saturation_counts):
    """Radiance (S, W), NaN where unusable; status (W,) of the pixels; where the converter clipped (S, W)."""
    if calibration is None:
        if "spectral_radiance" not in test.variables:
            raise ValueError(
                "the test holds counts: a spectrometer calibration is needed (in the workflow:"
                " calibrated_spectra: false in the file of the test, and instrument.spectrometer_counts)"
            )
        pixels = np.full(test.sizes["wavelength"], USABLE, dtype="int8")
    else:
        if not on_same_wavelengths(calibration, test):
            raise ValueError(
                "the spectrometer calibration and the test are not on the same wavelengths:"
                f" {_span(calibration)} against {_span(test)}{_apart(calibration, test)}"
            )
        pixels = calibration.pixel_status.values.astype("int8")
    shape = test.sizes["spectrum_time"], test.sizes["wavelength"]
    saturated = test.saturated.values > 0 if "saturated" in test.variables else np.zeros(shape, dtype=bool)
    if "spectral_radiance" in test.variables:
        good = (pixels == USABLE) & ~saturated
        return np.where(good, test.spectral_radiance.values, np.nan), pixels, saturated
    raw = test.counts.values.astype(float)
    saturated |= raw >= saturation_counts
    raw[saturated] = np.nan
    background = test.background_counts.values
    if "linearity_coefficient" in calibration:
        # As the counts of the source were treated, so are these.
        if test.attrs.get("counts_linearised") and calibration.sizes["linearity_power"] > 1:
            raise ValueError(
                "the counts of the test are linearised already, those of the calibration were not: switch the"
                " correction off in the spectrometer's program, or calibrate with linearised counts"
            )
        if test.attrs.get("exposures_joined") and calibration.sizes["linearity_power"] > 1:
            raise ValueError(
                "the spectra of the test have several exposures, and by its calibration the detector is"
                " not linear in its counts: put each exposure in a test of its own"
            )
        masked = calibration.masked_pixel.values if "masked_pixel" in calibration else []
        raw, background = (
            above_baseline(values, calibration.linearity_coefficient.values, masked)
            for values in (raw, background)
        )
    radiance = measured_radiance(
        raw, background, calibration.calibration_factor.values, test.attrs["spectrometer_integration_time"]
    )
    return radiance, pixels, saturated
