"""Rules for spectra, their dark and their files."""

import re
from datetime import timedelta

import numpy as np

from plasmapyro.quality.rule import DOUBT, rule
from plasmapyro.quality.series import SIGMA
from plasmapyro.radiation.planck import blackbody_radiance

NUMBER = re.compile(r"(\d+)(?!.*\d)", re.ASCII)  # the last number of a name


def _scatter(row):
    """Noise of one pixel from the differences of neighbours."""
    steps = np.diff(row[np.isfinite(row)])
    return float(SIGMA * np.median(np.abs(steps - np.median(steps))) / np.sqrt(2)) if steps.size else 0.0


def _numbers(names):
    found = [NUMBER.search(name.rsplit(".", 1)[0]) for name in names]
    return [int(match.group(1)) for match in found] if all(found) else []


@rule(
    "natural_order",
    looks_at="order of file names by their numbers, against that by letters",
    needs=("names", "ordered"),
    limit=0,
    unit="files",
    reason="1, 10, 2 by letters is 1, 2, 10 by numbers: times given by the order depend on it",
    says="the numbers in the file names have no leading zeros: the order taken is {first}, {second}, ...,"
    " {last} (by letters {other} would come second)",
    remedy="nothing, if that is the order in which they were taken",
    severity=DOUBT,
)
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


@rule(
    "missing_frame",
    looks_at="gaps in the numbers of the file names where times are given by the order",
    needs=("names", "ordered"),
    limit=0,
    unit="frames",
    reason="all spectra after a lost one would get a time one period too early",
    says="{count} numbers are missing in the file names, the first after {name}: all later spectra get"
    " times that are"
    " {period:g} s too early for each",
    remedy="put the lost file back, state the times by `from: date`, or read what follows as a test of its"
    " own",
)
def missing_frame(case, limit):
    numbers = _numbers(case.files["names"])
    if len(numbers) < 3:
        return None
    steps = np.diff(numbers)
    usual = int(np.median(steps))
    gaps = np.flatnonzero(steps != usual)
    if not gaps.size or usual < 1:
        return None
    time = case.test.spectrum_time.values
    return {
        "where": case.files["place"],
        "count": int(np.sum(steps[gaps] // usual - 1)) or gaps.size,
        "name": case.files["names"][gaps[0]],
        "period": float(np.median(np.diff(time))),
    }


@rule(
    "mixed_series",
    looks_at="file names that differ in more than their number",
    needs=("names", "ordered"),
    limit=0,
    unit="files",
    reason="a series has one name; a file of another one, a dark or a lamp among them, shifts all times",
    says="{name} does not belong to the series {first}, ...: its name differs in more than the number",
    remedy="move it out of the folder, or state the times by `from: date`",
)
def mixed_series(case, limit):
    names = case.files["names"]
    stems = [re.sub(r"\d+", "#", name) for name in names]
    usual = max(stems, key=stems.count)
    odd = [name for name, stem in zip(names, stems, strict=True) if stem != usual]
    if not odd or len(odd) > len(names) / 2:
        return None
    first = next(name for name, stem in zip(names, stems, strict=True) if stem == usual)
    return {"where": case.files["place"], "name": odd[0], "first": first}


@rule(
    "dates_against_order",
    looks_at="dates in the headers against the times given by the order of the files",
    needs=("names", "ordered", "dated"),
    limit=2.0,
    unit="s",
    reason="headers state whole seconds; two of them bound rounding at both ends",
    says="by its header {name} was taken {own:g} s after {first}, by `from: order` {given:g} s after it",
    remedy="correct `period`, put the files in order, or state the times by `from: date`",
)
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


@rule(
    "repeated_spectrum",
    looks_at="spectra that equal another one in every pixel",
    needs=("spectrometer",),
    limit=0,
    unit="spectra",
    reason="noise makes no two spectra equal: the same file was copied twice, or the program repeated a"
    " frame",
    says="the spectra at {first:g} and {second:g} s are equal in every pixel",
    remedy="remove the copy, or put the right file in its place",
)
def repeated_spectrum(case, limit):
    rows = np.nan_to_num(case.net)
    for index in np.flatnonzero((rows[1:] == rows[:-1]).all(axis=1)):
        time = case.test.spectrum_time.values
        return {"first": float(time[index]), "second": float(time[index + 1])}
    return None


@rule(
    "lone_spectrum",
    looks_at="light of a spectrum over that of the one before and of the one after",
    needs=("spectrometer", "plasma"),
    limit=0.2,
    unit="1",
    reason="a surface heats or cools; a spectrum brighter, or darker, than both its neighbours by a fifth was"
    " taken at another moment",
    says="{count} spectra do not lie between their neighbours, the first at {moment:g} s ({share:+.0%} or"
    " more)",
    remedy="see whether the files are in the order in which they were taken, and all of this test",
)
def lone_spectrum(case, limit):
    time, attrs = case.test.spectrum_time.values, case.test.attrs
    if time.size < 5 or not (case.light > 0).all():
        return None
    step = np.diff(np.log(case.light))
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


@rule(
    "gap_in_cycle",
    looks_at="intervals between spectra",
    needs=("spectrometer",),
    limit=1.5,
    unit="cycles",
    reason="spectra come in a cycle; half of one more is a frame that is lost",
    says="spectra come every {cycle:.4g} s, but {count} intervals are longer, the first from {begin:.6g} to"
    " {end:.6g} s",
    remedy="see whether files are lost",
    severity=DOUBT,
)
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
    return {
        "cycle": cycle,
        "count": long.size,
        "begin": float(time[place]),
        "end": float(time[place + 1]),
    }


@rule(
    "exposures_overlap",
    looks_at="exposure over the interval between spectra",
    needs=("spectrometer",),
    limit=1.02,
    unit="1",
    reason="an exposure ends before the next begins; 2 % for rounded times",
    says="exposures of {exposure:g} s follow one another every {cycle:.4g} s",
    remedy="correct the integration time or the period (which are in s)",
)
def exposures_overlap(case, limit):
    time = case.test.spectrum_time.values
    cycle = float(np.median(np.diff(time))) if time.size > 1 else np.inf
    if case.exposure <= limit * cycle:
        return None
    return {"exposure": case.exposure, "cycle": cycle}


@rule(
    "dark_constant",
    looks_at="scatter of the dark between pixels",
    needs=("counts",),
    limit=0.0,
    unit="count",
    reason="every converter has noise and every pixel a dark current of its own",
    says="the dark is {value:g} counts in every pixel: no spectrum of a detector",
    remedy="measure a dark with the shutter closed and the same settings",
)
def dark_constant(case, limit):
    dark = case.test.background_counts.values[1:-1]
    if np.ptp(dark) > limit:
        return None
    return {"where": _dark(case), "value": float(dark[0])}


def _dark(case):
    return case.files.get("background") or case.place


@rule(
    "dark_brighter",
    looks_at="net counts of the darkest exposure",
    needs=("counts",),
    limit=-3.0,
    unit="standard deviations",
    reason="light adds to the dark; below it by more than the noise, the dark holds light, or is of other"
    " settings",
    says="the dark is brighter than the spectrum at {moment:g} s in {share:.0%} of the pixels, by {value:.4g}"
    " counts in the middle",
    remedy="measure a dark with the shutter closed and the same settings; see whether light and dark are"
    " exchanged",
)
def dark_brighter(case, limit):
    noise = np.sqrt(2) * max(_scatter(case.test.background_counts.values), 1e-9)
    middle = np.nanmedian(case.net, axis=1)
    place = int(np.nanargmin(middle))
    if not middle[place] < limit * noise:
        return None
    return {
        "where": _dark(case),
        "moment": float(case.test.spectrum_time.values[place]),
        "share": float(np.nanmean(case.net[place] < 0)),
        "value": -float(middle[place]),
    }


@rule(
    "dark_like_light",
    looks_at="light of the plasma in the reference window over the noise",
    needs=("counts", "plasma"),
    limit=3.0,
    unit="standard deviations",
    reason="the plasma shines in the reference window, and its light stands out of the noise of the mean"
    " pixel",
    says="the dark equals the spectrum at {moment:g} s, when the plasma shines: the dark holds its light",
    remedy="measure a dark with the shutter closed; light of the plasma in it is taken off twice",
)
def dark_like_light(case, limit):
    time = case.test.spectrum_time.values
    low, high = case.test.attrs["reference_window"]
    for place in np.flatnonzero((time >= low) & (time <= high)):
        row = case.net[place]
        noise = max(_scatter(row), 1e-9) / np.sqrt(max(np.isfinite(row).sum(), 1))
        brightest = np.nanmax(np.nanmedian(case.net, axis=1))
        middle = abs(np.nanmean(row))
        if middle < max(limit * noise, 1e-4 * brightest):
            return {"where": _dark(case), "moment": float(time[place])}
    return None


@rule(
    "counts_as_radiance",
    looks_at="radiances that are whole numbers",
    needs=("spectral_radiance",),
    limit=0.999,
    unit="1",
    reason="converters count in whole numbers, calibrated radiances do not",
    says="all radiances are whole numbers times {unit:.3g}: they look like counts",
    remedy="state `quantity: counts` and a `background`, or check the `unit`",
)
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


@rule(
    "too_bright",
    looks_at="radiance of the brightest spectrum over that of a black body of 3500 K",
    needs=("spectral_radiance",),
    limit=1.0,
    unit="1",
    reason="no sample of a thermal protection system is hotter; in more than half of the pixels it is no"
    " line",
    says="the spectrum at {moment:g} s is brighter than a black body of 3500 K in {share:.0%} of the pixels",
    remedy="check the `unit`, and whether these are counts",
)
def too_bright(case, limit):
    bound = limit * blackbody_radiance(case.test.wavelength.values, 3500.0)
    share = np.mean(case.test.spectral_radiance.values > bound, axis=1)
    place = int(np.argmax(share))
    if share[place] <= 0.5:
        return None
    return {"moment": float(case.test.spectrum_time.values[place]), "share": float(share[place])}


@rule(
    "wavelength_range",
    looks_at="wavelengths of the pixels",
    needs=("spectrometer",),
    limit=1200.0,
    unit="nm",
    reason="silicon, of which these detectors are, sees 200 to 1200 nm",
    says="the pixels run from {first:.4g} to {last:.4g} nm, beyond what silicon sees (200 to 1200 nm)",
    remedy="check `wavelength_unit`",
)
def wavelength_range(case, limit):
    pixels = case.test.wavelength.values * 1e9
    if pixels[0] >= 190 and pixels[-1] <= limit:
        return None
    return {"first": float(pixels[0]), "last": float(pixels[-1])}


@rule(
    "width_of_spectrometer",
    looks_at="spectrometer_fwhm over the distance of the pixels",
    needs=("spectrometer",),
    limit=0.5,
    unit="pixels",
    reason="a slit images to a pixel or more, and to far less than a tenth of the range",
    says="spectrometer_fwhm is {width:.3g} nm, the pixels are {pixel:.3g} nm apart over {span:.4g} nm",
    remedy="state it in m (1.5 nm: 1.5e-9)",
)
def width_of_spectrometer(case, limit):
    pixels = case.test.wavelength.values * 1e9
    width, pixel = case.test.attrs["spectrometer_fwhm"] * 1e9, float(np.median(np.diff(pixels)))
    if limit * pixel <= width <= np.ptp(pixels) / 10:
        return None
    return {"width": width, "pixel": pixel, "span": float(np.ptp(pixels))}


@rule(
    "nonlinear_end",
    looks_at="raw counts over the limit of a 16-bit converter",
    needs=("counts",),
    limit=65535.0,
    unit="count",
    reason="spectrometers of this kind convert with 16 bits; more are sums, or counts per second",
    says="the counts reach {top:.5g}, more than a 16-bit converter gives",
    remedy="export raw counts of single scans or averages, and calibrate with such",
)
def nonlinear_end(case, limit):
    top = float(np.nanmax(case.test.counts.values))
    return {"top": top} if top > limit else None
