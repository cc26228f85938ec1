"""Rules for spectra, their dark and their files."""

import re
from datetime import timedelta
from functools import lru_cache

import numpy as np

from plasmapyro.identification.species import catalogue
from plasmapyro.instrument.spectrometer import NORMAL_MAD
from plasmapyro.quality.rule import rule
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import flags, foreign
from plasmapyro.refraction import vacuum_wavelength

NO_LIGHT = 1e-3  # of the brightest spectrum: a dark within the series
LISTED = 5  # wavelengths
# Of the lines of a plasma: what test gases are made of, those above a share of the strongest of its species,
# and what stands out of the spectrum of the window: so many at least, the clearest ten, held to so near.
PLASMA = ("N I", "O I", "C I", "H I", "Ar I")
STRONG, EXCITATION = 0.15, 8000.0  # [1], [K]
FEWEST, CLEAREST, LEAST_NEAR = 5, 10, 0.3e-9  # [m]
RED = (600e-9, 1200e-9)  # [m] where their lines are clearer than heads of bands
NUMBER = re.compile(r"(\d+)(?!.*\d)", re.ASCII)  # the last number of a name


def _scatter(row):
    """Noise of one pixel from the differences of neighbours."""
    steps = np.diff(row[np.isfinite(row)])
    return float(NORMAL_MAD * np.median(np.abs(steps - np.median(steps))) / np.sqrt(2)) if steps.size else 0.0


def _numbers(names):
    found = [NUMBER.search(name.rsplit(".", 1)[0]) for name in names]
    return [int(match.group(1)) for match in found] if all(found) else []


@rule()
def natural_order(case, limit):
    names = case.files["names"]
    if names == sorted(names):
        return None
    return {
        "where": case.files["place"],
        "first": names[0],
        "second": names[1],
        "last": names[-1],
        "other": sorted(names)[1],
    }


@rule(misdates=True)
def missing_frame(case, limit):
    numbers = _numbers(case.files["names"])
    if len(numbers) < 3:
        return None
    steps = np.diff(numbers)
    usual = int(np.median(steps))
    gaps = np.flatnonzero(steps > usual)  # a number that stands twice is of a copy, or of another series
    if not gaps.size or usual < 1:
        return None
    time = case.test.spectrum_time.values
    return {
        "where": case.files["place"],
        "count": int(np.sum(-(-steps[gaps] // usual) - 1)),
        "name": case.files["names"][gaps[0]],
        "period": float(np.median(np.diff(time))),
    }


@rule()
def mixed_series(case, limit):
    names = case.files["names"]
    stems = [re.sub(r"\d+", "#", name) for name in names]
    usual = max(stems, key=stems.count)
    odd = [name for name, stem in zip(names, stems, strict=True) if stem != usual]
    if not odd or len(odd) > len(names) / 2:
        return None
    first = next(name for name, stem in zip(names, stems, strict=True) if stem == usual)
    return {"where": case.files["place"], "name": odd[0], "first": first}


@rule(misdates=True)
def dates_against_order(case, limit):
    dates, time = case.files["dates"], case.test.spectrum_time.values
    own = np.array([(date - dates[0]) / timedelta(seconds=1) for date in dates])
    off = np.abs(own - (time - time[0]))
    if not off.max() > limit:
        return None
    place = int(np.argmax(off > limit))
    return {
        "where": case.files["place"],
        "name": case.files["names"][place],
        "first": case.files["names"][0],
        "own": float(own[place]),
        "given": float(time[place] - time[0]),
    }


@rule()
def repeated_spectrum(case, limit):
    rows, lost = np.nan_to_num(case.net), np.isnan(case.net).all(axis=1)
    for index in np.flatnonzero((rows[1:] == rows[:-1]).all(axis=1) & ~lost[1:]):
        time = case.test.spectrum_time.values
        return {"first": float(time[index]), "second": float(time[index + 1])}
    return None


@rule()
def lone_spectrum(case, limit):
    time, attrs = case.test.spectrum_time.values, case.test.attrs
    if time.size < 5 or not (case.light > 0).any():
        return None
    step = np.diff(np.log(np.maximum(case.light, NO_LIGHT * np.nanmax(case.light))))
    # At the injection and the end of the plasma light may come and go within an exposure.
    cycle = np.median(np.diff(time))
    switch = [np.abs(time - attrs[name]) <= cycle for name in ("injection_time", "plasma_off_time")]
    off = np.where((step[:-1] * step[1:] < 0) & ~np.any(switch, axis=0)[1:-1], step[:-1], 0.0)
    far = np.flatnonzero(np.minimum(np.abs(off), np.abs(step[1:])) > limit)
    if not far.size:
        return None
    first = far[0]
    least = np.sign(off[first]) * min(abs(off[first]), abs(step[first + 1]))
    return {"count": far.size, "moment": float(time[first + 1]), "share": float(np.expm1(least))}


@rule()
def gap_in_cycle(case, limit):
    time = case.test.spectrum_time.values
    if time.size < 4:
        return None
    interval = np.diff(time)
    cycle = float(np.median(interval))
    long = np.flatnonzero(interval > limit * cycle + 1.0)  # [s] dates in headers are whole seconds
    if not long.size:
        return None
    place = long[0]
    return {"cycle": cycle, "count": long.size, "begin": float(time[place]), "end": float(time[place + 1])}


@rule()
def exposures_overlap(case, limit):
    time = case.test.spectrum_time.values
    cycle = float(np.median(np.diff(time))) if time.size > 1 else np.inf
    if case.exposure <= limit * cycle:
        return None
    return {"exposure": case.exposure, "cycle": cycle}


@rule()
def dark_constant(case, limit):
    dark = case.test.background_counts.values[1:-1]
    dark = dark[np.isfinite(dark)]
    if not dark.size or np.ptp(dark) > limit:
        return None
    return {"where": _dark(case), "value": float(dark[0])}


def _dark(case):
    return case.files.get("background") or case.place


@rule()
def dark_brighter(case, limit):
    noise = np.sqrt(2) * max(_scatter(case.test.background_counts.values), 1e-9)
    middle = np.nan_to_num(case.middle, nan=np.inf)
    place = int(np.argmin(middle))
    if not middle[place] < limit * noise:
        return None
    return {
        "where": _dark(case),
        "moment": float(case.test.spectrum_time.values[place]),
        "share": float(np.nanmean(case.net[place] < 0)),
        "value": -float(middle[place]),
    }


@rule()
def dark_like_light(case, limit):
    time, width = case.test.spectrum_time.values, float(case.test.attrs["spectrometer_fwhm"])
    low, high = case.test.attrs["reference_window"]
    places = np.flatnonzero((time >= low) & (time <= high) & np.isfinite(case.middle))
    sharp = flags.sharper(case.net, case.test.wavelength.values, width)  # dead and hot pixels are no light
    for place in places:
        row = np.where(sharp[place], np.nan, case.net[place])
        noise = max(_scatter(row), 1e-9) / np.sqrt(max(np.isfinite(row).sum(), 1))
        brightest = np.nanmax(case.middle)
        middle = abs(np.nanmean(row))
        if middle < max(limit * noise, 1e-4 * brightest):
            return {"where": _dark(case), "moment": float(time[place])}
    return None


@rule()
def counts_as_radiance(case, limit):
    values = case.test.spectral_radiance.values
    values = values[np.isfinite(values) & (values != 0)]
    for unit in 10.0 ** np.arange(0, 14):
        scaled = values / unit
        if np.median(np.abs(scaled)) < 100:
            break
        if np.median(np.abs(scaled)) < 1e6 and np.mean(np.abs(scaled - np.round(scaled)) < 1e-6) > limit:
            return {"unit": unit}
    return None


@rule()
def too_bright(case, limit):
    bound = limit * blackbody_radiance(case.test.wavelength.values, 3500.0)
    share = np.mean(case.test.spectral_radiance.values > bound, axis=1)
    place = int(np.argmax(share))
    if share[place] <= 0.5:
        return None
    return {"moment": float(case.test.spectrum_time.values[place]), "share": float(share[place])}


@rule()
def wavelength_range(case, limit):
    pixels = case.test.wavelength.values * 1e9
    if pixels[0] >= 190 and pixels[-1] <= limit:
        return None
    return {"first": float(pixels[0]), "last": float(pixels[-1])}


@rule()
def lines_elsewhere(case, limit):
    time, wavelength = case.test.spectrum_time.values, case.test.wavelength.values
    low, high = case.test.attrs["reference_window"]
    width, light = float(case.test.attrs["spectrometer_fwhm"]), case.net[(time >= low) & (time <= high)]
    if not len(light):
        return None
    seen = foreign.narrow_light(wavelength, light, width)
    seen = seen[(seen > RED[0]) & (seen < RED[1])][:CLEAREST]
    near = max(width / 4, 1.5 * float(np.median(np.diff(wavelength))), LEAST_NEAR)
    if seen.size < FEWEST:
        return None
    off = np.abs(lines_of_plasmas() - seen[:, None]).min(axis=1) > near
    if off.mean() <= 1 - limit:
        return None
    places = ", ".join(f"{place * 1e9:.4g}" for place in np.sort(seen[off])[:LISTED])
    return {"off": int(off.sum()), "count": seen.size, "places": places}


@lru_cache(maxsize=1)
def lines_of_plasmas():
    """Wavelengths (n,) [m] in vacuum of the stronger lines of `PLASMA` in the `RED`."""
    parts = [one.between(*RED) for one in catalogue() if one.name in PLASMA]
    return vacuum_wavelength(
        np.concatenate([one.wavelength[one.light(EXCITATION, 0.0) > STRONG] for one in parts])
    )


@rule()
def width_of_spectrometer(case, limit):
    pixels = case.test.wavelength.values * 1e9
    width, pixel = case.test.attrs["spectrometer_fwhm"] * 1e9, float(np.median(np.diff(pixels)))
    if limit * pixel <= width <= np.ptp(pixels) / 10:
        return None
    return {"width": width, "pixel": pixel, "span": float(np.ptp(pixels))}


@rule()
def nonlinear_end(case, limit):
    top = float(np.nanmax(case.test.counts.values))
    return {"top": top} if top > limit else None


@rule()
def narrow_light(case, limit):
    if "plasma" in case.holds or not {"spectral_radiance", "spectrometer_calibration"} & case.holds:
        return None
    light, wavelength = case.net, case.test.wavelength.values
    if "spectral_radiance" not in case.holds:
        factor = case.spectrometer_calibration.calibration_factor.values
        if factor.size != wavelength.size:
            return None
        light = light * factor
    found = foreign.narrow_light(wavelength, light, float(case.test.attrs["spectrometer_fwhm"]), limit)
    if not found.size:
        return None
    return {"places": ", ".join(f"{place * 1e9:.4g}" for place in found[:LISTED])}
