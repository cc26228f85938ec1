"""`plasmapyro check`: everything that is wrong with a data folder, at once."""

import sys
from pathlib import Path

import numpy as np

from plasmapyro import progress
from plasmapyro.quality.catalogue import of_test, own_test
from plasmapyro.readers.calibration import check_calibration, describes
from plasmapyro.readers.calibration import instruments as instruments_calibrated
from plasmapyro.readers.description import LARGEST
from plasmapyro.readers.stage import read_with_files
from plasmapyro.readers.text import Refusal, read_lines
from plasmapyro.record.inputs import has_plasma, instruments


def run(options):
    """Run `plasmapyro check`; ValueError with one line per fault."""
    progress.say(f"reading {options.test}")
    if describes(options.test):
        from plasmapyro.commands.calibrate import calibration_findings, response_of  # loads what fits lamps

        response = response_of(options.response)
        _refuse(options.test, check_calibration(options.test) or calibration_findings(options.test, response))
        present = " and ".join(instruments_calibrated(options.test))
        sys.stdout.write(f"{options.test}: can be used to calibrate the {present}\n")
        return
    if options.response:
        raise ValueError("--response is of a calibration; that of a test is in the folder of --instrument")
    test, found, failed = checked(options.test, options.instrument)
    for finding in found:
        progress.warn(finding.words)
    if failed:
        raise failed
    lines = [
        f"{options.test}: can be processed",
        *contents(test),
        *_guesses(Path(options.test) / "test.yaml"),
    ]
    sys.stdout.write("\n".join(lines) + "\n")


def _guesses(description):
    """A line that says how many guesses of `init` nobody has looked at, if there are any."""
    lines, _ = read_lines(description, LARGEST) if description.is_file() else ([], True)
    count = sum("  # ?" in line for line in lines)
    return [f"  test.yaml: {count} guesses of `init` are still marked '# ?'"] * bool(count)


def checked(place, instrument=None):
    """A test, what contradicts itself in it, and the ValueError that its trial correction ended in, or None.

    ValueError with one line per fault if the test cannot be processed at all.
    """
    try:
        reading = read_with_files(place)
    except Refusal as refusal:
        _refuse(place, refusal.messages)
    tried, failed = {}, None
    if instrument:
        from plasmapyro.commands.correct import trial  # loads all estimators
        from plasmapyro.commands.instrument import calibration_of

        try:
            with calibration_of(place, instrument) as folder:
                tried = trial(own_test(reading), folder)
        except ValueError as reason:  # what the data themselves say may be why
            failed = reason
    return reading.test, of_test(place, reading, **tried), failed


def _refuse(place, messages):
    """Raise ValueError with all messages, if there are any."""
    if messages:
        count = f"{len(messages)} fault{'s' * (len(messages) > 1)} in {place}"
        raise ValueError("\n".join([count, *messages])) from None


def contents(test):
    """Lines that say what a test holds, for a person to compare with what was measured."""
    lines = [f"  origin: {test.attrs['origin']}"]
    if "pyrometer" in instruments(test):
        lines.append(f"  pyrometer: {_clock(test.time.values, 'samples')}")
        for name in ("signal_wide", "signal_narrow"):
            values = test[name].values
            lines.append(
                f"  {name}: {np.nanmin(values):.4g} to {np.nanmax(values):.4g} A,"
                f" {int(np.isnan(values).sum())} missing"
            )
    if "spectrometer" in instruments(test):
        name = "spectral_radiance" if "spectral_radiance" in test.variables else "counts"
        values, pixels = test[name].values, test.wavelength.values * 1e9
        moved = test.attrs.get("spectra_moved", 0.0)
        within = ", in the constant cycle that their dates fit" if "spectra_period" in test.attrs else ""
        within += f", moved by {moved:.2g} s within the second of their dates" if moved else ""
        lines += [
            f"  spectrometer: {_clock(test.spectrum_time.values, 'spectra')}{within}",
            f"  wavelengths: {pixels.size} pixels, {pixels[0]:.2f} to {pixels[-1]:.2f} nm in vacuum",
            f"  {name}: {np.nanmin(values):.4g} to {np.nanmax(values):.4g} {test[name].attrs['units']},"
            f" {int(np.isnan(values).sum())} samples missing or saturated",
        ]
    if "radiometer" in instruments(test):
        name = "radiometer_signal" if "radiometer_signal" in test.variables else "radiometer_reading"
        lines.append(f"  radiometer: {_clock(test.radiometer_time.values, 'samples')}")
        for band, values in zip(test.band.values, test[name].values.T, strict=True):
            missing = int(np.isnan(values).sum())
            unit = test[name].attrs["units"].replace("1", "")
            lines.append(
                f"  {band}: {np.nanmin(values):.4g} to {np.nanmax(values):.4g} {unit}".rstrip()
                + f", {missing} missing"
            )
    if "radiometer_setting" in test.variables:
        low, high = (float(end(test.radiometer_setting.values[:, 0])) for end in (np.nanmin, np.nanmax))
        lines.append(f"  setting at it: {low:g}" + (f" to {high:g}" if high > low else ", at all times"))
    if not has_plasma(test):
        return [*lines, "  no plasma: nothing is subtracted"]
    begin, end = test.attrs["reference_window"]
    lines.append(
        f"  injection at {test.attrs['injection_time']:g} s, plasma off at"
        f" {test.attrs['plasma_off_time']:g} s, reference window {begin:g} to {end:g} s"
    )
    return lines


def _clock(time, what):
    step = f", one per {np.median(np.diff(time)):.4g} s" if time.size > 1 else ""
    return f"{time.size} {what}, {time[0]:g} to {time[-1]:g} s{step}"
