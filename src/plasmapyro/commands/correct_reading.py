"""`plasmapyro correct-reading`: surface temperatures where only the displayed temperature was logged."""

import re
import sys
from pathlib import Path

import numpy as np

from plasmapyro import io, progress, shipped
from plasmapyro.analysis.reading import STATUS, correct_reading
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.commands.options import settings, told
from plasmapyro.commands.outputs import require_writable
from plasmapyro.contracts.variables import VARIABLES
from plasmapyro.instrument.stage import band_response, ratio_curve
from plasmapyro.quality.series import longest_run
from plasmapyro.readers import columns, guess_table, parts, units
from plasmapyro.readers.description import Section
from plasmapyro.readers.text import quote, read_lines, refuse

STANDS = 10  # readings in a row at one end of the record
CURVE = {  # of the modelled pyrometer, as in config/config.yaml
    "sensitivity_ratio": 0.315,
    "calibration_temperature": np.arange(300.0, 10001.0, 10.0),
    "instrument_range": (973.0, 2073.0),
}
TEMPERATURE = re.compile(r"ts|t_?(app|disp).*|.*temp.*|reading|anzeige|messwert", re.IGNORECASE)
LOOKS_LIKE_ONE = re.compile(r"t(?![a-z]).*", re.IGNORECASE)  # T1, T_2C
SLOPE = re.compile(r".*slope.*|.*steigung.*|pente", re.IGNORECASE)
HEADER = "write a header such as 'time [s], Ts [K]'"
BELOW = next(code for code, words in STATUS.items() if words == "below_what_the_gas_allows")


def run(options):
    """Run `plasmapyro correct-reading`: a table and the results of a workflow in, one netCDF out."""
    require_writable([options.out], [options.reading, options.results])
    gas, sources = gas_of(options.results, options.condition)
    time, reading = read_readings(options.reading, options.slope)
    lowest, highest = gas[2].instrument_range.values
    beyond = int(((reading < lowest) | (reading > highest)).sum())
    if beyond:
        progress.warn(
            f"{beyond} of {reading.size} readings lie outside the {lowest:g} to {highest:g} K that the"
            " instrument can display: is their unit right?"
        )
    _ask_for_ends(time, np.where(reading > options.floor_k + options.quantum_k / 2, reading, np.nan))
    made = settings(options, correct_reading) | {"time": time, "reading": reading}
    result = correct_reading(*gas, **made)
    config = {"correct-reading": told(options, "reading", "results")}
    io.write(result, options.out, "corrected_reading", sources=[options.reading, *sources], config=config)
    sys.stdout.write("\n".join(summary(result)) + "\n")


def _ask_for_ends(time, reading):
    """Warn of readings that stand at the least or greatest of a record, as at an end of a display."""
    held = int(np.isfinite(reading).sum())
    for end in sorted({np.nanmin(reading), np.nanmax(reading)}) if held else ():
        first, count = longest_run(reading == end)
        if STANDS <= count < held:
            progress.warn(
                f"{count} readings in a row show {end:g} K, from {time[first]:g} s on, and none shows"
                f" {'less' if end == np.nanmin(reading) else 'more'}: if the display ends there, name its"
                " least temperature with --floor-k, and leave out what stands at its greatest"
            )


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


def read_readings(path, slope=1.0):
    """Time [s] and displayed temperature [K] of a text table whose header names them, in any usual form.

    The time may be that of day, or a date; it counts from the first reading then. Refused are a header
    without both columns and the unit of the temperature, a cell that is no number, a time that does not rise,
    and a column of another `slope` setting of the instrument [1].
    """
    table = guess_table.look_at_table(path)
    places = guess_table.assign(table) if table else {}
    taken = [places["time"]] if "time" in places else places.get("stamps", [])
    free = [place for place in range(len(table.labels)) if place not in taken] if taken else []
    named = [place for place in free if TEMPERATURE.fullmatch(table.labels[place])]
    kelvin = [place for place in free if units.factor(table.units[place] or "", "temperature")]
    found = [place for place in named if place in kelvin] or (kelvin if len(kelvin) == 1 else named)
    looks = [place for place in free if LOOKS_LIKE_ONE.fullmatch(table.labels[place])]
    if not found and len(kelvin) > 1:
        words = " and ".join(quote(table.labels[place]) for place in kelvin)
        refuse(path, f"columns {words} are temperatures", "call that of both colours 'reading'")
    found = found or looks[:1]
    if not found:
        first = quote(next(iter(read_lines(path, columns.LARGEST)[0]), ""))
        refuse(path, f"holds no columns of numbers named time and temperature; it begins {first}", HEADER)
    label, unit = table.labels[found[0]], table.units[found[0]]
    if found[0] not in kelvin:
        what = f"is in {quote(unit)}" if unit else "has no unit"
        refuse(path, f"column {quote(label)} {what}", "write K or °C behind its name")
    names = [table.labels[place] for place in taken]
    if "stamps" in places:
        form, zero, _ = guess_table.stamp_format(table, taken)
        said = {"name": names if len(names) > 1 else names[0], "format": form}
    elif units.factor(table.units[taken[0]] or "", "time"):
        said = {"name": names[0]}
    else:
        refuse(path, f"column {quote(names[0])} has no unit", "write [s], [ms] or [min] behind its name")
    settings = [table.labels[place] for place in free if SLOPE.fullmatch(table.labels[place])]
    said = {"time": said, "temperature": {"name": label}}
    if settings:
        said["sensitivity_ratio"] = {"name": settings[0]}  # that is what the slope corrects
    known = {name: columns.Column(name, Section(one, path, name, [])) for name, one in said.items()}
    if "stamps" in places:
        known["time"].zero = zero
    values = columns.read_table(path, known, table.delimiter)
    parts.rising(path, values["time"])
    told = np.unique(values.get("sensitivity_ratio", slope))
    if np.any(~np.isclose(told, slope)):
        words = " and ".join(f"{one:g}" for one in told[~np.isnan(told)])
        remedy = "correct the rows of each setting alone, with --slope (readings: slope)"
        refuse(path, f"column {quote(settings[0])} says {words}, the slope setting is {slope:g}", remedy)
    low, high = VARIABLES["apparent_temperature"].low, VARIABLES["apparent_temperature"].high
    odd = np.flatnonzero((values["temperature"] < low) | (values["temperature"] > high))
    if odd.size:
        found, moment = values["temperature"][odd[0]], values["time"][odd[0]]
        refuse(
            path,
            f"column {quote(label)} holds {found:g} K at {moment:g} s, which no surface has"
            f" ({low:g} to {high:g} K)",
            "see whether columns, unit and decimal sign are right; leave cells without a reading empty",
        )
    return values["time"], values["temperature"]


def summary(result):
    """Lines that say what came out."""
    status = result.corrected_reading_status.values
    held = {words.replace("_", " "): int((status == code).sum()) for code, words in STATUS.items()}
    lines = [f"{count} {words}" for words, count in held.items() if count]
    error = (result.apparent_temperature - result.surface_temperature).values
    if np.isfinite(error).any():
        lines.append(
            f"the gas moves these readings by {np.nanmin(error):+.1f} to {np.nanmax(error):+.1f} K; "
            f"least reading behind it {result.attrs['least_reading']:.0f} K"
            f" (surface of {result.attrs['turning_temperature']:.0f} K)"
        )
        half = (result.surface_temperature_high - result.surface_temperature_low).values / 2
        lines.append(
            f"95 % intervals of the surface +-{np.nanmin(half):.1f} to {np.nanmax(half):.1f} K; what an"
            " ablating surface itself adds to the light (CN, C2) is not among it"
        )
    if np.isfinite(moment := result.attrs["heated_through"]):
        lines.append(
            f"at {moment:.2f} s the surface is heated through the least reading, which tells the gas; before"
            " it the cold surface is given (if it was never so cold: --at-least-k)"
        )
    if below := int((status == BELOW).sum()):
        lines.append(
            f"{below} readings are below {result.attrs['least_reading']:.0f} K, which no surface shows"
            " through this gas: another condition, or Celsius called kelvin?"
        )
    return lines
