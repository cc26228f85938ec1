"""`plasmapyro correct-reading`: surface temperatures where only the displayed temperature was logged."""

import sys
from pathlib import Path

import numpy as np

from plasmapyro import io, shipped
from plasmapyro.analysis.reading import STATUS, correct_reading
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.commands.options import settings
from plasmapyro.commands.outputs import require_writable
from plasmapyro.instrument.stage import band_response, ratio_curve
from plasmapyro.readers import columns, text, units

CURVE = {  # of the modelled pyrometer, as in config/config.yaml
    "sensitivity_ratio": 0.315,
    "calibration_temperature": np.arange(300.0, 10001.0, 10.0),
    "instrument_range": (973.0, 2073.0),
}
LARGEST = 96_000_000  # [byte]
MARKS = (";", "\t", ",", " ")  # between cells
HEADER = {"time": ("time", "t"), "temperature": ("ts", "temperature", "t_app", "reading")}


def run(options):
    """Run `plasmapyro correct-reading`: a table and the results of a workflow in, one netCDF out."""
    require_writable([options.out], [options.reading, options.results])
    gas, sources = gas_of(options.results, options.condition)
    time, reading = read_readings(options.reading)
    made = settings(options, correct_reading) | {"time": time, "reading": reading}
    result = correct_reading(*gas, **made)
    skipped = {"run", "reading", "results", "out"}
    given = {name: value for name, value in vars(options).items() if name not in skipped}
    io.write(
        result,
        options.out,
        "corrected_reading",
        sources=[options.reading, *sources],
        config={"correct-reading": given},
    )
    sys.stdout.write("\n".join(summary(result)) + "\n")


def gas_of(results, condition):
    """Gas signals, responses and ratio curve of a run (path) or of the package, and their files.

    The gas signals are those among which `condition` is: of the paper's conditions, or of one's own.
    """
    if results is None:
        response = band_response(**RESPONSE)
        return (shipped.stored()[0], response, ratio_curve(response, **CURVE)), []
    places = {
        "gas_signal": "analysis/gas_signal.nc",
        "response": "instrument/response.nc",
        "ratio_curve": "instrument/ratio_curve.nc",
    }
    paths = {contract: Path(results) / place for contract, place in places.items()}
    own = Path(results) / "analysis/gas_signal_own.nc"
    if own.exists() and condition in io.read(own, "gas_signal").condition:
        paths["gas_signal"] = own
    return tuple(io.read(path, contract) for contract, path in paths.items()), [*paths.values()]


def read_readings(path):
    """Time [s] and displayed temperature [K] of a text table with a header that states the units.

    Cells stand between semicolons, tabs, commas or blanks; a decimal comma is read but between commas.

    Parameters
    ----------
    path : path

    Returns
    -------
    tuple of (t,) ndarray

    Raises
    ------
    ValueError
        No header with both columns and their units, a cell that is no number, a time that does not rise.
    """
    lines, _ = text.read_lines(path, LARGEST)
    head = lines[0].lower().replace("[", " [").split("]")
    cells = [cell.strip(" ,;\t").split(" [") for cell in head if " [" in cell]
    found = {}
    for place, (name, unit) in enumerate((cell[0].strip(), cell[-1].strip()) for cell in cells):
        for kind, words in HEADER.items():
            if name in words:
                found[kind] = place, unit.upper() if unit in ("k", "c") else unit
    if set(found) != set(HEADER):
        text.refuse(
            path, f"the first line {text.quote(lines[0])} names no time and temperature",
            "write a header such as 'time [s], Ts [K]'", 1,
        )  # fmt: skip
    factor, shift = units.factor(found["time"][1], "time"), units.offset(found["temperature"][1])
    if factor is None or units.factor(found["temperature"][1], "temperature") is None:
        text.refuse(path, f"unknown unit in {text.quote(lines[0])}", "write [s] and [K] or [C]", 1)
    listed = [(number, line) for number, line in enumerate(lines[1:], start=2) if line.strip()]
    if not listed:
        text.refuse(path, "holds no reading", "export it with its samples")
    mark = next((one for one in MARKS if _numbers(listed[0][1], one, len(cells))), " ")
    words = [columns.without_empty_end(columns.split(line, mark)) for _, line in listed]
    decimal, faults = columns.decimal_sign(path, mark, dict(enumerate(words)), [listed[0][0]])
    text.refuse_all(path, faults)
    rows = []
    for (number, line), row in zip(listed, words, strict=True):
        values = [text.number(word, decimal) for word in row]
        if len(values) != len(cells) or None in values:
            text.refuse(path, f"{text.quote(line)} is no row of numbers", "correct or remove it", number)
        rows.append(values)
    table = np.array(rows)
    time = table[:, found["time"][0]] * factor
    if np.any(np.isnan(time)) or np.any(np.diff(time) <= 0):
        text.refuse(path, "the time does not rise from row to row", "sort it and remove doubles")
    return time, table[:, found["temperature"][0]] + shift


def _numbers(line, mark, count):
    """Whether a line holds as many numbers between marks."""
    words = columns.without_empty_end(columns.split(line, mark))
    decimals = "." if mark == "," else ".,"
    return len(words) == count and all(
        any(text.number(word, decimal) is not None for decimal in decimals) for word in words
    )


def summary(result):
    """Lines that say what came out."""
    status = result.corrected_reading_status.values
    lines = [f"{int((status == code).sum())} {words.replace('_', ' ')}" for code, words in STATUS.items()]
    lines = [line for line in lines if not line.startswith("0 ")]
    error = (result.apparent_temperature - result.surface_temperature).values
    if np.isfinite(error).any():
        lines.append(
            f"the gas moves these readings by {np.nanmin(error):+.1f} to {np.nanmax(error):+.1f} K; "
            f"least reading behind it {result.attrs['least_reading']:.0f} K"
            f" (surface of {result.attrs['turning_temperature']:.0f} K)"
        )
    return lines
