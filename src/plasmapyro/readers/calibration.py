"""A calibration folder: what calibration.yaml says about raw files of the pyrometer and the spectrometer."""

from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.instrument.calibration import LEAST_POINTS
from plasmapyro.instrument.raw_counts import certified_source
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.readers import andor, columns, description, ocean
from plasmapyro.readers.instrument import read_instrument
from plasmapyro.readers.spectrometer import require_alike, vacuum
from plasmapyro.readers.text import Refusal, checked, fault, refuse, refuse_all
from plasmapyro.record.emittance import mean_emittance
from plasmapyro.tables import ORIGINS, weakest

NAME = "calibration.yaml"
GUIDE = "see docs/your-own-data.md"
POINTS = ("source_temperature", "signal_wide", "signal_narrow")
INSTRUMENTS = ("pyrometer", "spectrometer", "radiometer")
MOST_EXPOSURES = 200


def describes(folder):
    """Whether a folder holds a description of calibration files."""
    return (Path(folder) / NAME).is_file()


def instruments(folder):
    """Names of the instruments that calibration.yaml describes; Refusal without such a file."""
    return [name for name in INSTRUMENTS if name in _described(folder)[0]]


def check_calibration(folder):
    """Everything that is wrong with a calibration folder, at once; an empty list if nothing is."""
    try:
        present = instruments(folder)
        if not present:
            return [fault(Path(folder) / NAME, "describes no pyrometer, spectrometer or radiometer", GUIDE)]
    except Refusal as reason:
        return reason.messages
    found = []
    readers = {"pyrometer": read_points, "spectrometer": read_exposures, "radiometer": read_bands}
    for read in [readers[name] for name in present]:
        try:
            read(folder)
            if read is read_exposures:
                read_line_lamp(folder)
        except Refusal as reason:
            found += [message for message in reason.messages if message not in found]
    return found


def read_points(folder):
    """Calibration points of the pyrometer (contract 'calibration_points') that calibration.yaml names."""
    section, origin = _section(folder, "pyrometer")
    name = section.file("file", "calibration_points.csv")
    marks, wanted = columns.marks(section), columns.wanted(section, POINTS, needed=POINTS)
    window = _share(section, "window_transmittance", 1.0)
    section.close()
    if section.faults:
        raise Refusal(section.faults)
    path = Path(folder) / name
    found = columns.read_table(path, wanted, *marks)
    bad = {key: np.flatnonzero(~(row > 0)) for key, row in found.items()}
    messages = [
        fault(
            path,
            f"row {rows[0] + 1} of the data: {key} is {found[key][rows[0]]:g}, must be > 0",
            "correct it",
        )
        for key, rows in bad.items()
        if rows.size
    ]
    if messages:
        raise Refusal(messages)
    if (different := np.unique(found["source_temperature"]).size) < LEAST_POINTS:
        what = f"holds {different} different source temperatures, and a curve needs {LEAST_POINTS}"
        refuse(path, what, "measure more points, below and above those of the tests")
    for band in POINTS[1:]:  # as they would be through the window that stood before the test only
        found[band] = found[band] * window
    dataset = xr.Dataset({key: ("calibration_point", found[key]) for key in POINTS}, attrs={"origin": origin})
    return checked(dataset, "calibration_points", path)


def read_bands(folder):
    """Bands of a radiometer, and its calibration points if it does not show temperatures.

    Response as of `read_instrument`, its origin the weaker of both; points: `source_temperature` (N,) [K],
    and the signals (N,) of each band by its name. calibration.yaml names both files under `radiometer`.
    """
    section, origin = _section(folder, "radiometer")
    faults, name = section.faults, section.file("instrument", needed=True)
    table, marks = section.file("file", "calibration_points.csv"), columns.marks(section)
    if faults:
        raise Refusal(faults)
    response = read_instrument(Path(folder) / name)
    response.attrs["origin"] = weakest([origin, response.attrs["origin"]])
    section.used.add("columns")
    if response.attrs["calibration"] == "readings":
        section.close()
        points = {}
    else:
        kinds = {"source_temperature": "source_temperature"}
        kinds |= dict.fromkeys(response.band.values.tolist(), "radiometer_signal")
        wanted = columns.wanted(section, tuple(kinds), kinds, needed=kinds)
        section.close()
        points = {} if faults else columns.read_table(Path(folder) / table, wanted, *marks)
    for key, row in points.items():
        if (
            not (row[np.isfinite(row)] > 0).all()
            or np.isnan(row).all()
            or "temp" in key
            and np.isnan(row).any()
        ):
            faults.append(fault(Path(folder) / table, f"{key} must be > 0 in every row", "correct it"))
    if faults:
        raise Refusal(faults)
    return response, points


def read_exposures(folder):
    """Raw exposures of a source in front of the spectrometer, with what its radiance is certified to be.

    Contract 'spectrometer_exposures'; attributes as in `calibrate_exposures`: `linearity_coefficients`,
    `linearity_uncertainty`, `masked_pixels`, `dim_range` [m], `hot_threshold`, `transmittance` and, where
    stated, `saturation_counts`. calibration.yaml names the files under `spectrometer`.
    """
    section, origin = _section(folder, "spectrometer")
    folder, path, faults = Path(folder), section.path, section.faults
    medium = section.text("wavelengths", "air", choices=("air", "vacuum"))
    column = section.text("column")
    detector = _detector(section)
    kind = section.text("format", "ocean", choices=("ocean", "andor"))
    read = {"ocean": ocean.read_spectrum, "andor": andor.mean_spectrum}[kind]
    source = _source(section.section("source")) if "source" in section else None
    if source is None:
        section.used.add("source")
        if "source" not in section:
            section.blame("source", "is missing", "state `temperature_k`, or a `certificate` of a lamp")
    exposures = _exposures(section)
    _line_lamp(section)
    section.close()
    if faults:
        raise Refusal(faults)
    settings = {"quantity": "counts", "column": column}
    spectra, lights, darks, times = [], [], [], []
    for exposure in exposures:
        try:
            paths = [folder / exposure[key] for key in ("light", "dark")]
            pair = [read(one) for one in paths]
            times.append(_integration_time(folder, exposure, pair))
            rows = [ocean.column_of(*one, settings) for one in zip(paths, pair, strict=True)]
            first = spectra[0] if spectra else pair[0]
            for one in zip(paths, pair, strict=True):
                require_alike(*one, folder / exposures[0]["light"], first, ())
        except Refusal as reason:
            faults += reason.messages
            continue
        if any(one.linearised for one in pair) and len(detector["linearity_coefficients"]) > 1:
            faults.append(
                fault(
                    folder / exposure["light"],
                    "is linearised already by the spectrometer's program",
                    "remove linearity_coefficients, or switch that correction off",
                )
            )
        spectra.append(pair[0])
        lights.append(rows[0])
        darks.append(rows[1])
    refuse_all(folder, faults)
    wavelength = vacuum(folder / exposures[0]["light"], spectra[0].wavelength, medium)
    pixels = detector.get("masked_pixels", [])
    if any(not -wavelength.size <= pixel < wavelength.size for pixel in pixels):
        refuse(path, f"masked_pixels: not all of {pixels} exist among {wavelength.size}", "correct them")
    lost = ocean.clipped(np.array([*lights, *darks]))
    if lost.any():  # the plateau is the limit of the converter, for all exposures of this detector
        plateau = float(np.array([*lights, *darks])[lost].min())
        detector["saturation_counts"] = min(plateau, detector.get("saturation_counts", plateau))
    radiance, uncertainty = _radiance_of(folder, source, wavelength)
    dataset = xr.Dataset(
        {
            "exposure_counts": (("exposure", "wavelength"), np.array(lights)),
            "exposure_dark": (("exposure", "wavelength"), np.array(darks)),
            "exposure_time": ("exposure", times),
            "source_radiance": ("wavelength", radiance),
            "source_radiance_uncertainty": ("wavelength", uncertainty),
        },
        {"wavelength": wavelength},
        {"origin": origin, **detector},
    )
    return checked(dataset, "spectrometer_exposures", path)


def read_line_lamp(folder):
    """Spectrum of a Hg(Ar) lamp, if calibration.yaml names one under `spectrometer.line_lamp`, or None.

    Wavelength (W,) [m] in vacuum; counts (W,) without the dark, NaN where clipped; stated rough width [m].
    """
    values, faults = _described(folder)
    section = description.Section(values, Path(folder) / NAME, "", faults).section("spectrometer")
    lamp = _line_lamp(section)
    if faults:
        raise Refusal(faults)
    if lamp is None:
        return None
    medium = section.text("wavelengths", "air", choices=("air", "vacuum"))
    settings = {"quantity": "counts", "column": section.text("column")}
    paths = [Path(folder) / lamp[key] for key in ("light", "dark")]
    light, dark = (ocean.read_spectrum(path) for path in paths)
    require_alike(paths[1], dark, paths[0], light, of="a dark")
    rows = [ocean.column_of(*one, settings) for one in zip(paths, (light, dark), strict=True)]
    net = np.where(ocean.clipped(rows[0]), np.nan, rows[0] - rows[1])
    return vacuum(paths[0], light.wavelength, medium), net, lamp["fwhm"]


def _line_lamp(section):
    if "line_lamp" not in section:
        return None
    lamp = section.section("line_lamp")
    found = {key: lamp.file(key, needed=True) for key in ("light", "dark")}
    width = lamp.number("fwhm_nm", above=0, needed=True)
    found["fwhm"] = None if width is None else width * 1e-9
    lamp.close()
    return found


def _described(folder):
    """Values of calibration.yaml and an empty list for faults."""
    folder = Path(folder)
    if not folder.is_dir():
        refuse(folder, "no such folder", "check its name")
    if not describes(folder) and (found := description.nearly(folder / NAME)):
        refuse(folder, f"holds no {NAME}", f"rename {found}")
    return description.load(folder / NAME), []


def _section(folder, instrument):
    """The section of calibration.yaml about an instrument, with the faults found so far, and the origin."""
    values, faults = _described(folder)
    top = description.Section(values, Path(folder) / NAME, "", faults)
    origin = top.text("origin", choices=ORIGINS, needed=True)
    top.text("title")
    top.used |= set(INSTRUMENTS)
    top.close()
    if instrument not in top:
        top.blame(instrument, "is missing", f"describe its calibration; {GUIDE}")
        raise Refusal(top.faults)
    return top.section(instrument), origin


def _share(section, key, default):
    value = section.number(key, default, above=0)
    if value > 1:
        section.blame(key, f"must be at most 1; got {value:g}", "state it as a fraction")
    return value


def _detector(section):
    """Attributes that describe the detector and what stood in the light."""
    found = {
        "linearity_coefficients": section.numbers("linearity_coefficients") or [1.0],
        "linearity_uncertainty": section.number("linearity_uncertainty", 0.0),
        "hot_threshold": section.number("hot_threshold", 8.0, above=0),
        # The filter dims only the source, the window only the test.
        "transmittance": _share(section, "filter_transmittance", 1.0)
        / _share(section, "window_transmittance", 1.0),
    }
    if not 0 <= found["linearity_uncertainty"] < 1:
        section.blame("linearity_uncertainty", "must lie in 0 to 1", "state it as a fraction")
    asked = {
        "masked_pixels": section.numbers("masked_pixels", kind=int),
        "dim_range": [edge * 1e-9 for edge in section.numbers("dim_range_nm", 2) or []],
        "saturation_counts": section.number("saturation_counts", above=0),
    }
    return found | {name: value for name, value in asked.items() if value}


def _source(section):
    """The source: a black body of known temperature or a table of certified radiance."""
    found = {}
    if "temperature_k" in section or "certificate" not in section:
        found["temperature"] = section.number("temperature_k", above=200, needed=True)
        found["temperature_uncertainty"] = section.number("temperature_uncertainty_k", needed=True)
        found |= section.emittance() or {"emittance": 1.0}
        if not 0 < found["emittance"] <= 1:
            section.blame("emittance", f"must lie in (0, 1]; got {found['emittance']:g}", "correct it")
        if found["temperature"] is not None and found["temperature"] > 1e4:
            section.blame("temperature_k", "must be at most 10000 K", "correct it")
        if (found["temperature_uncertainty"] or 0) < 0:
            section.blame("temperature_uncertainty_k", "must be >= 0", "correct it")
    else:
        found["certificate"] = section.file("certificate")
        found["uncertainty"] = section.number("uncertainty", above=0, needed=True)
        if (found["uncertainty"] or 0) >= 1:
            section.blame("uncertainty", "must be below 1", "state it as a fraction")
        table = ("wavelength", "spectral_radiance")
        found["columns"] = columns.wanted(section, table, needed=table)
        found["medium"] = section.text("wavelengths", "air", choices=("air", "vacuum"))
    section.close()
    return found


def _exposures(section):
    words = section.raw("exposures", needed=True)
    if words is None:
        return []
    if not isinstance(words, list) or not 0 < len(words) <= MOST_EXPOSURES:
        section.blame("exposures", f"must be a list of 1 to {MOST_EXPOSURES} exposures", GUIDE)
        return []
    found = []
    for index, values in enumerate(words):
        one = description.Section(values, section.path, f"spectrometer.exposures[{index}]", section.faults)
        dark = "baseline" if "baseline" in one else "dark"
        found.append({"light": one.file("light", needed=True), "dark": one.file(dark, needed=True)})
        found[-1]["baseline"] = dark == "baseline"
        found[-1]["integration_time"] = one.number("integration_time", above=0)
        one.close()
    return found


def _integration_time(folder, exposure, pair):
    """Integration time [s] of an exposure and its dark; they must agree, but for a mere baseline."""
    asked = pair[:1] if exposure["baseline"] else pair
    stated = {exposure["integration_time"], *(one.integration_time for one in asked)} - {None}
    path = folder / exposure["light"]
    if not stated:
        refuse(path, "its header states no integration time", "state `integration_time` [s] of the exposure")
    if max(stated) > min(stated) * (1 + 1e-6):
        listed = " and ".join(f"{value:g} s" for value in sorted(stated))
        refuse(
            path,
            f"integration times differ between it, {exposure['dark']} and {NAME}: {listed}",
            "match them",
        )
    return min(stated)


def _radiance_of(folder, source, wavelength):
    r"""Radiance (W,) of the source and its relative standard uncertainty (W,).

    .. math:: u(L)/L = \frac{c_2}{\lambda T^2}\,u(T) \quad\text{(black body, Wien)}

    Where that exceeds 1 the radiance is not known: NaN.
    """
    if "temperature" in source:
        kelvin = source["temperature"]
        slope = SECOND_RADIATION / (wavelength * kelvin**2)
        radiance = mean_emittance(source, wavelength) * blackbody_radiance(wavelength, kelvin)
        uncertainty = slope * source["temperature_uncertainty"]
        return np.where(uncertainty < 1, radiance, np.nan), np.minimum(uncertainty, 1.0)
    path = folder / source["certificate"]
    table = columns.read_table(path, source["columns"])
    rising = np.argsort(table["wavelength"])
    points, value = table["wavelength"][rising], table["spectral_radiance"][rising]
    if points.size < 2 or not (np.diff(points) > 0).all() or not (value > 0).all():
        refuse(path, "needs two rows or more, each wavelength once, radiances > 0", "correct the table")
    points = vacuum(path, points, source["medium"])
    radiance = certified_source(wavelength, points, value)
    return radiance, np.full(wavelength.size, source["uncertainty"])
