"""The spectra of a test folder, one file each or many in a table, from their section of test.yaml."""

import fnmatch
import re
from datetime import datetime
from decimal import Decimal
from pathlib import Path

import numpy as np

from plasmapyro.readers import andor, clock, columns, ocean, spectra_table, units
from plasmapyro.readers.parts import joined, rising
from plasmapyro.readers.text import Refusal, fault, quote, read_lines, refuse, refuse_all
from plasmapyro.refraction import HIGHEST, LOWEST, vacuum_wavelength

SATURATION = 65000.0  # [count] of the commands, where a test states none
MOST_SPECTRA = 20_000
MOST_SAMPLES = 50_000_000  # of all spectra together: 400 MB
SHIFT = 1e-12  # [m] spectra of one instrument agree in wavelength to their printed digits
SPECTRUM_SUFFIXES = {".txt", ".jaz", ".tsv", ".dat", ".csv", ".asc", ".prn"}
WHOLE = r"\d+"  # a number of a file name
MARGIN = 0.25  # [s] by which a cycle may be off, either way, before the light is asked, too
SETTINGS = ("integration_time", "averages", "dark_corrected", "linearised")


def spectrometer(folder, section):
    """Variables on `spectrum_time` and `wavelength`, attributes, and the files; None after faults."""
    before = len(section.faults)
    place = section.file("folder", None if "file" in section else "spectrometer")
    tables = section.files("file")
    quantity = section.text("quantity", needed=True, choices=("counts", "spectral_radiance"))
    medium = section.text("wavelengths", "air", choices=("air", "vacuum"))
    limit = section.number("saturation_counts", above=0)
    settings = {"quantity": quantity, "medium": medium, "saturation": limit}
    settings["format"] = section.text("format", "csv", choices=("csv", "andor"))
    if settings["format"] == "andor" and not tables and place:
        found = sorted(path.relative_to(folder) for path in (Path(folder) / place).glob("[!.]*.*"))
        tables = [str(path) for path in found if str(path) != section.values.get("background")]
    if tables:
        settings |= {
            "unit": section.text("unit", needed=True) if settings["format"] == "csv" else "count",
            "wavelength_unit": section.text("wavelength_unit", "nm"),
            "time_unit": section.text("time_unit", "s"),
            "stamps": section.text("time_format"),
            "marks": columns.marks(section),
            "zero": 0.0 if "time_format" in section else section.number("zero", 0.0),
            "background": section.file("background"),
            "time": _time_settings(section, ("order",)) if "time" in section else None,
        }
        if settings["stamps"]:
            settings["stamps"] = (settings["stamps"], section.text("zero", "", needed=True))
        _check_units(section, settings)
    else:
        settings |= {
            "unit": section.text(
                "unit", "count" if quantity == "counts" else None, needed=quantity != "counts"
            ),
            "wavelength_unit": "nm",
            "column": section.text("column"),
            "pattern": section.text("files"),
            "background": section.file("background"),
            "time": _time_settings(section),
        }
        _check_units(section, settings)
    section.close()
    if len(section.faults) > before:
        return None
    if tables:
        return _tables([Path(folder) / name for name in tables], folder, settings)
    return _many_files(Path(folder) / place, folder, settings)


def _check_units(section, settings):
    names = {"unit": settings["quantity"], "wavelength_unit": "wavelength", "time_unit": "spectrum_time"}
    for key, variable in names.items():
        unit = settings.get(key)
        if unit is not None and variable is not None and units.factor(unit, variable) is None:
            section.blame(
                key, f"{quote(unit)} is not a unit of {variable}", f"write one of {units.known(variable)}"
            )


def _time_settings(section, sources=("order", "date", "name")):
    """How the files of a folder, or the spectra of a table, get their times."""
    time = section.section("time") if "time" in section else None
    if time is None:
        section.used.add("time")
        section.blame(
            "time",
            "is missing",
            "state `from: order` with `first` and `period`, `from: date` with `zero`, or `from: name`",
        )
        return None
    source = time.text("from", choices=sources, needed=True)
    found = {"from": source}
    if source == "order":
        found |= {
            "first": time.number("first", needed=True),
            "period": time.number("period", above=0, needed=True),
        }
    elif source == "date":
        words = time.text("zero", needed=True)
        try:
            found["zero"] = datetime.fromisoformat(words) if words else None
        except ValueError:
            time.blame("zero", f"must be a date 'yyyy-mm-dd hh:mm:ss'; got {quote(words)}", "correct it")
        if found.get("zero") is not None and found["zero"].tzinfo is not None:
            time.blame("zero", "must not name a time zone: the files' own clock is meant", "remove it")
        found["marks"] = time.text("marks", "end", choices=("begin", "middle", "end"))
    elif source == "name":
        found |= _name_settings(time)
    time.close()
    return found


def _name_settings(time):
    """How the name of a file tells its time: where in it, as a number or a date, and what moment that is."""
    pattern, form, unit = (time.text(key, None) for key in ("name", "format", "unit"))
    if not pattern or pattern.count("*") != 1:
        time.blame("name", "must hold one * for the time", "write 'spec_*s.txt'; # is any other number")
    if form and not clock.reads_format(form):
        time.blame("format", f"{quote(form)} is no format that is read", f"write e.g. {quote(clock.EXAMPLE)}")
    if unit and units.factor(unit, "spectrum_time") is None:
        known = units.known("spectrum_time")
        time.blame("unit", f"{quote(unit)} is not a unit of time", f"write one of {known}")
        unit = None
    words = time.text("zero", None, needed=bool(form))
    zero = _of_word(words, form, unit) if words else 0.0
    if zero is None:
        time.blame("zero", f"{quote(words)} is not read as the times in the names are", "write it as these")
    marks = time.text("marks", None, choices=("begin", "middle", "end"), needed=True)
    return {"name": pattern, "format": form, "unit": unit or "s", "zero": zero, "marks": marks}


def _of_word(word, form, unit):
    """A time [s] as a file name states it, or None: of a format, else a number of units."""
    if form:
        return clock.seconds(word, form)
    number = re.fullmatch(r"[+-]?\d+(?:[.,]\d+)?", word)
    return float(number[0].replace(",", ".")) * units.factor(unit or "s", "spectrum_time") if number else None


def named_times(paths, settings):
    """Path -> time [s] that its name states."""
    whole = re.escape(settings["name"]).replace(r"\*", "(.+?)").replace(r"\#", r"\d+")
    found = {path: re.fullmatch(whole, path.name) for path in paths}
    moments = {p: m and _of_word(m[1], settings["format"], settings["unit"]) for p, m in found.items()}
    words = f"no time in the name as {quote(settings['name'])} and `format` or `unit` say"
    remedy = "correct `spectrometer.time`, or name the spectra that are meant as `files`"
    refuse_all(paths[0].parent, [fault(p, words, remedy) for p, moment in moments.items() if moment is None])
    return {path: moment - settings["zero"] for path, moment in moments.items()}


def _many_files(place, folder, settings):
    if not place.is_dir():
        refuse(place, "no such folder", "check `spectrometer.folder` in test.yaml")
    background = settings["background"]
    dark_path = Path(folder) / background if background else None
    # Hidden files are not of the instrument: a Mac leaves a ._NAME beside each NAME on a foreign disk.
    listed = [path for path in place.iterdir() if not path.name.startswith(".")]
    if settings["pattern"]:
        listed = [path for path in listed if fnmatch.fnmatchcase(path.name, settings["pattern"])]
    else:
        listed = [path for path in listed if path.suffix.lower() in SPECTRUM_SUFFIXES]
    try:
        paths = [path for path in listed if not (dark_path and path.resolve() == dark_path.resolve())]
        form = number_form([path.name for path in paths])
        paths.sort(key=lambda path: natural(path.name, form))
    except (OSError, RuntimeError) as reason:
        refuse(place, f"holds a link that leads nowhere ({reason})", "replace it by the file")
    if not paths or len(paths) > MOST_SPECTRA:
        refuse(
            place,
            f"holds {len(paths)} spectra ({settings['pattern'] or ', '.join(sorted(SPECTRUM_SUFFIXES))})",
            f"1 to {MOST_SPECTRA} can be read; `files: 'run_*.txt'` names those that are meant",
        )
    if settings["time"]["from"] == "name":
        settings["time"]["moments"] = moments = named_times(paths, settings["time"])
        paths.sort(key=moments.get)
    spectra, faults = _read_all(paths, settings)
    dark = None
    if dark_path is not None:
        try:
            dark = ocean.read_spectrum(dark_path)
        except Refusal as reason:
            faults += reason.messages
    refuse_all(place, faults)
    return _of_folder(paths, spectra, dark_path, dark, settings)


def number_form(names):
    """Pattern of the numbers in some file names: whole ones, or decimals with a sign where they are times.

    Decimals if they have as many digits as needed (0.5, 1.25, 2), which counters never do (1.9, 1.10); a
    minus behind a blank, '_' or '=' is a sign if some of the names that are alike else have none.
    """
    ends = [re.findall(r"\d\.(\d+)", name) for name in names]
    lengths = {tuple(map(len, row)) for row in ends}
    trimmed = not any(end.endswith("0") for row in ends for end in row)
    form = r"\d+(?:\.\d+)?" if len(lengths) > 1 and trimmed else WHOLE
    stems = {re.sub(r"\d+(?:\.\d+)?", "#", name) for name in names}
    unsigned = {re.sub(r"(?<=[ _=])-(?=#)", "", stem) for stem in stems}
    return rf"(?:(?<=[ _=])-)?{form}" if len(unsigned) < len(stems) else form


def natural(name, form=WHOLE):
    """Sorting key of a file name whose numbers count as numbers: spectrum_2 before spectrum_10."""
    pieces = re.split(f"({form})", name)
    return [Decimal(piece) if place % 2 else piece for place, piece in enumerate(pieces)], name


def _read_all(paths, settings):
    """Every spectrum, and every fault: also where a file differs from the first in what must be common."""
    spectra, faults, first = [], [], None
    for path in paths:
        try:
            spectrum = ocean.read_spectrum(path)
            values = ocean.column_of(path, spectrum, settings)
            if first is not None:
                require_alike(path, spectrum, paths[0], first)
        except Refusal as reason:
            faults += reason.messages
            continue
        first = first or spectrum
        if len(paths) * spectrum.wavelength.size > MOST_SAMPLES:
            refuse(
                path.parent,
                f"holds more than {MOST_SAMPLES} samples",
                "cut it to the test, or bin the pixels",
            )
        spectra.append((spectrum._replace(columns=spectrum.columns if first is spectrum else {}), values))
    return spectra, faults


def require_alike(path, spectrum, first_path, first, settings=SETTINGS, of="a spectrum"):
    """Refuse a spectrum, or a dark, of other wavelengths than the first, or of other settings.

    A dark may be averaged more often: its counts are a mean, as theirs are, with less noise.
    """
    if spectrum.wavelength.size != first.wavelength.size or not np.allclose(
        spectrum.wavelength, first.wavelength, rtol=0, atol=SHIFT
    ):
        refuse(
            path, f"other wavelengths than {first_path.name}", "put each instrument in a folder of its own"
        )
    for name in settings:
        mine, its = getattr(spectrum, name), getattr(first, name)
        enough = mine is None or (name == "averages" and mine >= (its or 1))
        if mine != its and not (of == "a dark" and enough):
            words = name.replace("_", " ")
            remedy = (
                "take a dark of the same settings, and name it as `background`"
                if of == "a dark"
                else "spectra of one test need common settings: split the folder, or name some as `files`"
            )
            refuse(path, f"{words} {mine}, but {its} in {first_path.name}", remedy)


def _of_folder(paths, spectra, dark_path, dark, settings):
    first = spectra[0][0]
    values = np.stack([row for _, row in spectra]) * units.factor(settings["unit"], settings["quantity"])
    result = {
        "wavelength": vacuum(paths[0], first.wavelength, settings["medium"]),
    }
    attrs = {}
    result["spectrum_time"], left = _spectrum_times(
        paths, [spectrum for spectrum, _ in spectra], settings["time"], attrs
    )
    if first.integration_time is not None:
        attrs["spectrometer_integration_time"] = first.integration_time
    if first.linearised is not None:
        attrs["counts_linearised"] = int(first.linearised)
    files = {
        "place": paths[0].parent,
        "names": [path.name for path in paths],
        "dates": [spectrum.date for spectrum, _ in spectra],
        "ordered": settings["time"]["from"] == "order",
        "counted": number_form([path.name for path in paths]) == WHOLE,
        "left_open": left,
        "background": dark_path,
    }
    if settings["quantity"] == "counts":
        values = _without_clipped(values, settings["saturation"], result, attrs)
        if dark is not None:
            require_alike(dark_path, dark, paths[0], first, of="a dark")
            result["background_counts"] = ocean.column_of(dark_path, dark, settings)
        elif "D" in first.columns and settings["column"] in (None, "S"):
            result["background_counts"] = first.columns["D"]
    result[settings["quantity"]] = values
    return result, attrs, files


def _without_clipped(values, saturation, result, attrs):
    """Counts with NaN where the converter was at its end; `result` and `attrs` say where and how often."""
    lost = ocean.clipped(values)
    if saturation is not None:
        lost |= values >= saturation
    attrs["clipped_samples"] = int(lost.sum())
    if lost.any():
        result["saturated"] = lost.astype("int8")
    return np.where(lost, np.nan, values)


def _spectrum_times(paths, spectra, settings, attrs):
    """Times (S,) [s] of spectra, and the seconds by which they may all be later: dates cut decimals off.

    Dates in whole seconds that fit a constant cycle are of that cycle, which `attrs` says.
    """
    if settings["from"] == "order":
        return settings["first"] + settings["period"] * np.arange(len(spectra)), 0.0
    exposure = (spectra[0].integration_time or 0.0) * (spectra[0].averages or 1)
    middle = {"begin": 0.5, "middle": 0.0, "end": -0.5}[settings["marks"]] * exposure
    if settings["from"] == "name":
        time = np.array([settings["moments"][path] for path in paths])
        return rising(paths[0].parent, time + middle), 0.0
    remedy = "state the times by `from: order` or `from: name`"
    faults = [
        fault(path, "its header holds no date", remedy)
        for path, spectrum in zip(paths, spectra, strict=True)
        if spectrum.date is None
    ]
    if len({spectrum.time_zone for spectrum in spectra}) > 1:
        faults.append(
            fault(paths[0].parent, "files of different time zones", "state the times by `from: order`")
        )
    refuse_all(paths[0].parent, faults)
    time = np.array([(spectrum.date - settings["zero"]).total_seconds() for spectrum in spectra])
    left = 0.0 if any(spectrum.date.microsecond for spectrum in spectra) else 1.0
    if left and (cycle := clock.cycle(time)):
        attrs["spectra_period"], first, margin = cycle
        left = 2 * margin if margin > MARGIN else 0.0
        time = first - left / 2 + attrs["spectra_period"] * np.arange(time.size)
    return rising(paths[0].parent, time + middle), left


def vacuum(path, wavelength, medium):
    """Wavelengths [m] in vacuum of those in a medium, air or vacuum."""
    if medium == "vacuum":
        return wavelength
    if wavelength[0] < LOWEST or wavelength[-1] > HIGHEST / 1.001:
        refuse(
            path,
            f"wavelengths {wavelength[0] * 1e9:g} to {wavelength[-1] * 1e9:g} nm: air is known from"
            f" {LOWEST * 1e9:g} to {HIGHEST * 1e9:g} nm",
            "check the unit (of a table: `wavelength_unit: um`, `Angstrom`), or state `wavelengths: vacuum`",
        )
    return vacuum_wavelength(wavelength)


def _tables(paths, folder, settings):
    """Tables with a row per spectrum: time in the first column, wavelengths in the header of the others."""
    parts, attrs, dates, exposures = [], {}, {}, {}
    background = Path(folder) / settings["background"] if settings["background"] else None

    def read(path):
        if settings["format"] == "csv":
            return spectra_table.read_matrix(path, *settings["marks"], settings["stamps"])
        series = andor.read_series(path)
        # a dark of another exposure holds the baseline, if little dark current
        if path != background and series.exposure:
            exposures[path] = series.exposure
        dates[path] = series.date
        return series.time, series.wavelength * 1e9, series.counts

    tables = {path: read(path) for path in paths}
    # each counts from its begin
    if len(paths) > 1 and dates and all(dates.values()) and not settings["time"]:
        paths = sorted(paths, key=dates.get)
        since = {path: (dates[path] - dates[paths[0]]).total_seconds() for path in paths}
        tables = {path: (tables[path][0] + since[path], *tables[path][1:]) for path in paths}
    if exposures:
        attrs["spectrometer_integration_time"] = min(exposures.values())
    limit, joined_exposures = settings["saturation"], len(set(exposures.values())) > 1
    if joined_exposures:  # scaled counts would hide what the commands call saturated, and a bent scale
        limit, attrs["exposures_joined"] = limit or SATURATION, 1
    if joined_exposures and not background:
        odd = next(path for path in paths if exposures[path] != exposures[paths[0]])
        refuse(
            odd, f"other exposure than {paths[0].name}", "state a dark as `background`, or use another test"
        )
    for path in paths:
        time, pixels, values = tables[path]
        if parts and not np.array_equal(pixels, parts[0]["pixels"]):
            refuse(path, f"other wavelengths than {paths[0].name}", "join only files of one instrument", 1)
        factor = 1.0 if settings["stamps"] else units.factor(settings["time_unit"], "spectrum_time")
        parts.append({"time": time * factor, "pixels": pixels, "values": values})
    pixels = parts[0]["pixels"]
    sizes = [part["time"].size for part in parts]
    if settings["time"]:
        moments = settings["time"]["first"] + settings["time"]["period"] * np.arange(sum(sizes))
        moments = np.split(moments, np.cumsum(sizes)[:-1])
        parts = [part | {"time": moment} for part, moment in zip(parts, moments, strict=True)]
    whole = joined(paths, parts, settings["zero"])
    order = np.argsort(pixels, kind="stable")
    unit = units.factor(settings["wavelength_unit"], "wavelength")
    wavelength = pixels[order] * unit
    if not (np.diff(wavelength) > 0).all():
        refuse(paths[0], "a wavelength stands twice in the header", "remove one of the columns", 1)
    values = whole["values"][:, order] * units.factor(settings["unit"], settings["quantity"])
    result = {"spectrum_time": whole["time"], "wavelength": vacuum(paths[0], wavelength, settings["medium"])}
    files = {"place": paths[0], "background": background}
    if settings["quantity"] == "counts":
        values = _without_clipped(values, limit, result, attrs)
        if background:
            plain = ocean.plain_spectrum(read_lines(background, columns.LARGEST)[0])
            if plain is not None:
                dark_pixels = plain.wavelength
                dark = ocean.column_of(background, plain, settings | {"column": None})
            else:
                _, dark_pixels, dark = read(background)
                dark_pixels = dark_pixels[order] if dark_pixels.shape == order.shape else dark_pixels
                dark_pixels = dark_pixels * unit
                dark = np.mean(dark, axis=0)[order] if dark_pixels.shape == wavelength.shape else dark
            if dark_pixels.shape != wavelength.shape or not np.allclose(
                dark_pixels, wavelength, rtol=0, atol=SHIFT
            ):
                what = f"other wavelengths than {paths[0].name}"
                refuse(background, what, "use a dark of the same instrument", 1)
            result["background_counts"] = dark
            if joined_exposures:  # all as the shortest would have them: light goes with the exposure
                share = [attrs["spectrometer_integration_time"] / exposures[path] for path in paths]
                share = np.repeat(share, sizes)[:, None]
                values = dark + (values - dark) * share
    result[settings["quantity"]] = values
    return result, attrs, files
