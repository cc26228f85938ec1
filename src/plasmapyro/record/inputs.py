"""What is wrong with a test folder, all of it at once, before any of it is used."""

import numpy as np

from plasmapyro.tables import ORIGINS, rows

REGISTER = rows("record/inputs.csv")
UNITS = {row["name"]: row["unit"] for row in REGISTER if row["of"] == "samples"}
PLAUSIBLE = {  # magnitudes of samples that are not 0: no instrument gives others, a wrong unit may
    row["name"]: (float(row["lowest"]), float(row["highest"]))
    for row in REGISTER
    if row["of"] == "samples" and row["lowest"]
}
AXES = ("time", "spectrum_time", "wavelength", "radiometer_time")
NUMBERS = {  # attribute -> (lowest, highest, unit)
    row["name"]: (float(row["lowest"]), float(row["highest"]), row["unit"])
    for row in REGISTER
    if row["of"] == "attribute"
}
ALWAYS = ("injection_time", "plasma_off_time", "emittance", "emittance_uncertainty")
OF_PLASMA = ("injection_time", "plasma_off_time")
OF_INSTRUMENT = {
    "pyrometer": ("window_transmittance_pyrometer", "pyrometer_integration_time"),
    "spectrometer": (
        "window_transmittance_spectrometer",
        "spectrometer_integration_time",
        "spectrometer_fwhm",
    ),
    "radiometer": ("window_transmittance_radiometer", "radiometer_integration_time"),
}
HOUR = 3600.0  # [s]
LEAST_REFERENCE_SAMPLES = 3  # fewer give no scatter to judge the mean by


def instruments(test):
    """Names of the instruments of which a test holds any data."""
    held = set(test.variables)
    found = {
        "pyrometer": held & {"signal_wide", "signal_narrow"},
        "spectrometer": held & {"spectral_radiance", "counts"},
        "radiometer": held & {"radiometer_signal", "radiometer_reading"},
    }
    return [name for name, variables in found.items() if variables]


def has_plasma(test):
    """Whether a test, or one of some attributes, has a plasma, and so an injection, an end and a reference.

    A lamp or a furnace has none: `condition` is 'none', and nothing is said of a window.
    """
    attributes = getattr(test, "attrs", test)
    return attributes.get("condition") != "none" or "reference_window" in attributes


SHORTER = "take it again with a shorter exposure"
REMEDIES = {
    "background_counts": "; counts need a dark spectrum of the same exposure: name its file as"
    " `spectrometer.background`, or record one",
    "spectrometer_integration_time": "; the headers of the spectra do not tell it: state it [s]",
}


def faults(test):
    """Every breach of the rules for a test, as sentences; none if it can be processed."""
    present = instruments(test)
    found = [] if present else ["no signals of a pyrometer, spectra or radiometer: one of them is needed"]
    found += _faults_of_variables(test, present)
    found += attribute_faults(test, present)
    if not found and has_plasma(test):
        found += _faults_of_window(test, present)
    return found


def require(test, *needed):
    """Return `test` if it is sound and holds the instruments named; else ValueError with every fault."""
    found = faults(test)
    found += [f"the test holds no data of the {name}" for name in needed if name not in instruments(test)]
    if found:
        raise ValueError("the test cannot be processed:\n  " + "\n  ".join(found))
    return test


def _faults_of_variables(test, present):
    needed = []
    if "pyrometer" in present:
        needed += ["time", "signal_wide", "signal_narrow"]
    if "spectrometer" in present:
        needed += ["spectrum_time", "wavelength"]
        if "spectral_radiance" not in test.variables:
            needed += ["counts", "background_counts"]
    if "radiometer" in present:
        needed += ["radiometer_time", "band"]
        needed += ["radiometer_setting"] if "radiometer_reading" in test.variables else []
    for name in needed:
        if name not in test.variables:
            yield f"{name}: missing{REMEDIES.get(name, '')}"
    for name, unit in UNITS.items():
        if name not in test.variables:
            continue
        values, given = np.asarray(test[name].values), test[name].attrs.get("units")
        if given != unit:
            yield f"{name}: units {given!r}, expected {unit!r}"
        if values.dtype.kind not in "fiu":
            yield f"{name}: must be numbers, is {values.dtype}"
        elif np.isinf(values).any():
            yield f"{name}: infinite samples; a missing sample is NaN"
        elif name in AXES and (np.isnan(values).any() or not (np.diff(values) > 0).all()):
            yield f"{name}: must increase strictly, without NaN"
        elif np.isnan(values).all():
            at_end = name == "counts" and "saturated" in test.variables
            yield f"{name}: holds no sample" + f", all are saturated: {SHORTER}" * at_end
        elif name in PLAUSIBLE:
            low, high = PLAUSIBLE[name]
            size = np.abs(values[np.isfinite(values) & (values != 0)])
            wrong = size[(size < low) | (size > high)]
            if wrong.size:
                yield (
                    f"{name}: {wrong.size} samples are beyond {low:g} to {high:g} {unit}, the first is"
                    f" {wrong[0]:g} {unit}: a wrong unit, or a damaged file"
                )


def attribute_faults(test, present):
    """Every breach of the rules for the attributes of a test with the instruments `present`."""
    plasma = has_plasma(test)
    always = [name for name in ALWAYS if plasma or name not in OF_PLASMA]
    needed = [*always, *(name for instrument in present for name in OF_INSTRUMENT[instrument])]
    for name in [*needed, *(name for name in NUMBERS if name in test.attrs and name not in needed)]:
        low, high, unit = NUMBERS[name]
        value = test.attrs.get(name)
        if value is None:
            yield f"attribute {name}: missing{REMEDIES.get(name, '')}"
        elif not _is_number(value):
            yield f"attribute {name}: must be one number; got {value!r}"
        elif not low <= value <= high or (low == 0 and value == 0 and "uncertainty" not in name):
            shown, remedy = (
                (f"{value:g} {unit}", f"in {unit}") if unit != "1" else (f"{value:g}", "as a fraction")
            )
            yield f"attribute {name}: {shown} is not in ({low:g}, {high:g}]; state it {remedy}"
    if test.attrs.get("origin") not in ORIGINS:
        yield f"attribute origin: {test.attrs.get('origin')!r}, must be one of {', '.join(ORIGINS)}"
    window = np.asarray(test.attrs.get("reference_window", []))
    if not plasma:
        return
    if window.shape != (2,) or window.dtype.kind not in "fiu" or not window[0] < window[1]:
        yield "attribute reference_window: must be two rising times [s, s]"


def _is_number(value):
    return np.ndim(value) == 0 and np.asarray(value).dtype.kind in "fiu" and np.isfinite(value)


def _faults_of_window(test, present):
    begin, end = test.attrs["injection_time"], test.attrs["plasma_off_time"]
    window = test.attrs["reference_window"]
    if not begin < end:
        yield f"plasma_off_time {end:g} s must come after injection_time {begin:g} s"
    elif not begin <= window[0] < window[1] <= end:
        yield (
            f"reference_window {window[0]:g} to {window[1]:g} s must lie between injection ({begin:g} s)"
            f" and the end of the plasma ({end:g} s)"
        )
    if "pyrometer" in present:
        inside = (test.time.values >= window[0]) & (test.time.values <= window[1])
        for name in ("signal_wide", "signal_narrow"):
            count = int(np.isfinite(test[name].values[inside]).sum())
            if count < LEAST_REFERENCE_SAMPLES:
                first, last = test.time.values[[0, -1]]
                hint = _why_no_sample(test.time.values, window)
                yield (
                    f"{name}: {count} samples in the reference window {window[0]:g} to {window[1]:g} s,"
                    f" {LEAST_REFERENCE_SAMPLES} needed; the record runs from {first:g} to {last:g} s{hint}"
                )


def _why_no_sample(time, window):
    """What may be wrong with times (t,) [s] of which hardly one is in a window that tests have."""
    first, last = time[[0, -1]]
    step = np.median(np.diff(time)) if time.size > 1 else 0.0
    if step * LEAST_REFERENCE_SAMPLES > window[1] - window[0]:
        return f", one per {step:g} s; is the `unit` of the time right?"
    if any(first + hour <= window[0] and last + hour >= window[1] for hour in (-HOUR, HOUR)):
        return "; is `zero` missing, or a clock an hour off (summer time)?"
    return "; is `zero` missing?" if first > window[1] or last < window[0] else ""
