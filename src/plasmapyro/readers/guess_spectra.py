"""What a first description says of the spectrometer: its section from files and tables of spectra."""

import re
from datetime import timedelta

import numpy as np

from plasmapyro.readers import clock, columns, ocean, spectra_table, units
from plasmapyro.readers.cells import DELIMITERS, split
from plasmapyro.readers.description import in_yaml
from plasmapyro.readers.guess_table import MOST_ROWS, Table, file_line, stamp_format
from plasmapyro.readers.spectrometer import SPECTRUM_SUFFIXES, named_times, natural, number_form
from plasmapyro.readers.text import Refusal, read_lines

IN_NAME = (  # where the name of a file may hold its time; other numbers are counters and settings
    re.compile(r"(?<!\d)(\d{8}|\d{4}-\d\d-\d\d)[T_ ]?\d\d[-.h]?\d\d[-.m]?\d\ds?(?!\d)"),
    re.compile(r"(?<![\d-])\d\d[-.h]\d\d[-.m]\d\ds?(?![\d-])"),
    re.compile(r"(?<![\d.,])(?:(?<=[_= t])-)?\d+(?:[.,]\d+)?(?= ?(?P<unit>ms|s|min|us)(?![A-Za-z\d]))"),
    re.compile(r"(?<=t=)-?\d+(?:[.,]\d+)?(?=[_.](?!\d))(?P<unit>)"),
)


def spectrometer_section(folder, kinds, read, questions):
    """Lines of the section 'spectrometer'; empty if there are no spectra."""
    single = [path for path, _ in kinds.get("spectrum", [])]
    dark = [path for path in single if ocean.DARK.search(path.stem)]
    light = [path for path in single if path not in dark]
    if light:
        places = {path.parent for path in light}
        place = max(places, key=lambda one: sum(path.parent == one for path in light))
        light = [path for path in light if path.parent == place]
        if len(places) > 1:
            questions.append(
                f"spectrometer.folder: spectra lie in {len(places)} folders; {place.name} is taken"
            )
        found = [f"  folder: {in_yaml(place.relative_to(folder).as_posix())}"]
        series, light, others = _series(place, light, dark)
        if others:
            found.append(f"  files: {in_yaml(series)}")
            questions.append(f"spectrometer.files: only {series} are taken, not {', '.join(others[:5])}")
        spectrum = ocean.read_spectrum(light[0])
        found += _quantity(
            light[0], next(iter(spectrum.columns.values())) if len(spectrum.columns) == 1 else None, questions
        )
        if dark:
            found.append(f"  background: {in_yaml(dark[0].relative_to(folder).as_posix())}")
        elif "D" not in spectrum.columns and "quantity: counts" in found[1]:
            questions.append(
                "spectrometer.background: which file is the dark spectrum? add `background: NAME`"
            )
        dates = [ocean.read_spectrum(path).date for path in (light[0], light[-1])]
        if None not in dates and dates[1] > dates[0]:
            zero = dates[0] - timedelta(seconds=spectrum.integration_time or 0.0)
            found.append(
                f'  time: {{from: date, zero: "{zero:%Y-%m-%d %H:%M:%S}"}}  # ? the moment that shall be 0'
            )
            questions.append(
                "spectrometer.time.zero: which clock time is the injection? the first spectrum is taken"
            )
        elif timing := _in_names(light, questions):
            found.append(timing)
        else:
            time = read.get("time", np.array([0.0, float(len(light))]))
            period = float(time[-1] - max(time[0], 0.0)) / len(light)
            found.append(f"  time: {{from: order, first: {period / 2:.4g}, period: {period:.4g}}}  # ? s")
            questions.append("spectrometer.time: when was the first spectrum, and how far apart are they?")
        return found
    if "andor" in kinds:
        dark = [path for path, _ in kinds["andor"] if ocean.DARK.search(path.stem)]
        light = [path for path, _ in kinds["andor"] if path not in dark] or dark
        found = [file_line(folder, light), "  format: andor", "  quantity: counts"]
        questions.append("spectrometer.zero: when, after the begin of the series, is 0? 0 s is taken")
        return found + [f"  background: {in_yaml(path.relative_to(folder).as_posix())}" for path in dark[:1]]
    # A table of spectra may have a dark in a file of its own.
    return _matrix_lines(folder, kinds["matrix"], dark, questions) if "matrix" in kinds else []


def _in_names(paths, questions):
    """Line of `time` where the names of files hold it, a date or a number of units; '' where they do not."""
    paths = sorted(paths, key=lambda path: natural(path.name, number_form([one.name for one in paths])))
    for pattern in IN_NAME if len(paths) > 1 else ():
        found = [pattern.search(path.name) for path in paths]
        if None in found:
            continue
        first, name = found[0], paths[0].name
        around = (
            re.sub(r"\d+", "#", name[part]) for part in (slice(first.start()), slice(first.end(), None))
        )
        settings = {
            "name": "*".join(around),
            "format": None,
            "unit": (first.groupdict().get("unit") or "s"),
            "zero": 0.0,
        }
        words, zero = f"unit: {settings['unit']}", ""
        if "unit" not in first.groupdict():
            stamps = [one[0] for one in found]
            settings["format"], begin, more = stamp_format(Table("", ".", [""], [None], [stamps]), [0])
            if any("no known format" in one for one in more):
                continue
            words, zero = f"format: {in_yaml(settings['format'])}", f", zero: {in_yaml(begin)}"
        try:
            moments = list(named_times(paths, settings).values())
        except Refusal:
            continue
        if (np.diff(moments) > 0).all():
            questions.append(
                "spectrometer.time: the names hold times: which of them is 0, and do they mark begin, middle"
                " or end of an exposure? the end is taken"
            )
            return (
                f"  time: {{from: name, name: {in_yaml(settings['name'])}, {words}{zero}, marks: end}}  # ?"
            )
    return ""


def _series(place, light, dark):
    """Pattern of the names of the largest series in a folder, its files, and the names of the others."""
    groups = {}
    for path in light:
        groups.setdefault(re.sub(r"\d+", "*", path.name), []).append(path)
    pattern, series = max(groups.items(), key=lambda item: len(item[1]))
    held = [path for path in place.glob("[!.]*") if path.suffix.lower() in SPECTRUM_SUFFIXES]
    others = [path.name for path in held if path not in series and path not in dark[:1]]
    odd = series[0].suffix.lower() not in SPECTRUM_SUFFIXES
    if not (others or odd):
        return pattern, light, []
    return pattern, series, sorted(others) or ["files of other kinds"]


def _matrix_lines(folder, listed, dark, questions):
    """Lines of the section 'spectrometer' for tables of spectra; `dark`: files of single spectra."""
    dark = [path for path, _ in listed if ocean.DARK.search(path.stem)] + dark
    tables = [path for path, _ in listed if path not in dark]
    if not tables:
        questions.append(f"{dark[0].name} looks like a dark, and no table like its spectra")
        return []
    unit, mark = dict(listed)[tables[0]]
    lines = spectra_table.series_lines(read_lines(tables[0], columns.LARGEST)[0])
    lines = [line for line in lines if line.strip()]
    rows = [split(line, DELIMITERS[mark]) for line in lines]
    upright = spectra_table.upright_row(rows)
    begins = [row[0] for row in rows[-MOST_ROWS:]] if upright is None else rows[upright][1:]
    stamps = [word for word in begins if clock.looks_like_stamp(word)]
    timing = []
    if stamps:
        form, zero, more = stamp_format(Table(mark, ".", ["time"], [None], [stamps]), [0])
        questions += [
            words.replace("pyrometer.columns.time.format", "spectrometer.time_format") for words in more
        ]
        timing = [
            f"  time_format: {in_yaml(form)}",
            f"  zero: {in_yaml(zero)}  # ? the moment that shall be 0",
        ]
    times, _, values = spectra_table.read_matrix(tables[0], mark, stamps=(form, zero) if stamps else None)
    if not stamps and times.size > 1 and (np.diff(times) == 1).all() and times[0] in (0, 1):
        questions.append(
            "spectrometer.time: the spectra are numbered: when was the first, how far apart are they?"
        )
        timing = ["  time: {from: order, first: 0.5, period: 1.0}  # ? s"]
    found = [
        file_line(folder, tables),
        f"  delimiter: {in_yaml(mark)}",
        *_quantity(tables[0], values, questions, table=True),
        *timing,
    ]
    if unit != "nm":
        found.append(f"  wavelength_unit: {unit}")
    if dark:
        found.append(f"  background: {in_yaml(dark[0].relative_to(folder).as_posix())}")
    return found


def _quantity(path, values, questions, table=False):
    """Whether spectra are counts, by their size: a converter gives up to some 2^16."""
    if values is None or 20 < np.nanmax(values) < 70_000:
        return ["  quantity: counts", *(["  unit: count"] if table else [])]
    lines = read_lines(path, columns.LARGEST)[0][: ocean.HEADER_LINES]
    words = [word for line in lines for word in re.findall(r"[\[(]([^\[\]]{5,40})[\])]", line[:2000])]
    if stated := [word for word in words if units.factor(word, "spectral_radiance")]:
        return ["  quantity: spectral_radiance", f"  unit: {in_yaml(stated[0])}"]
    questions.append("spectrometer.unit: the spectra look like radiances; in which unit?")
    return ["  quantity: spectral_radiance", "  unit: W/m2/sr/nm  # ?"]
