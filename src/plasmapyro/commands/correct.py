"""`plasmapyro correct`: surface temperatures of one data set, without a workflow."""

import argparse
import logging
import sys
from pathlib import Path

import numpy as np

from plasmapyro import cli, io, progress
from plasmapyro.checks import counted
from plasmapyro.commands.instrument import calibration_of
from plasmapyro.commands.joint import by_joint_inference
from plasmapyro.commands.options import settings, told
from plasmapyro.commands.outputs import beside, require_of_test, require_writable
from plasmapyro.estimate.emissivity_stage import estimate_emissivity
from plasmapyro.experiment.stage import correct_pyrometer, correct_spectra, middle_exposure
from plasmapyro.page.words import without_folders
from plasmapyro.quality.beside import blanked, widen, with_level
from plasmapyro.quality.catalogue import agreed, merged, of_test, own_test
from plasmapyro.quality.pyrometer import dark_reference
from plasmapyro.quality.window import dark_in_window, frames_in_window, surface_in_window
from plasmapyro.readers.stage import read_with_files, sources
from plasmapyro.record import budget, status
from plasmapyro.record.calibrated import of_pixels, on_same_wavelengths
from plasmapyro.record.inputs import faults, has_plasma, instruments
from plasmapyro.record.recommended import of_correction

LOG = logging.getLogger(__name__)

NANOMETRE = 1e-9
# files and contracts
PYROMETER, SPECTROMETER, RADIOMETER = "calibration", "spectrometer_calibration", "radiometer_calibration"

# rules: what is subtracted is not the gas
NO_REFERENCE = surface_in_window, frames_in_window, dark_in_window, dark_reference
OF_BUDGET = ("corrected_temperature", "surface_temperature", "spectral_temperature")


def run(options):
    """Run `plasmapyro correct`: test in, file out, and a summary."""
    out = options.out or beside(options.test, "_temperature.nc")
    page = None if options.no_html else options.html or Path(out).with_suffix(".html")
    places = [path for path in (out, page, options.plot) if path]
    require_writable(places, [options.test, options.instrument])
    if not options.out:
        require_of_test(out, options.test)
    test, result, said = corrected(options)
    progress.say(f"writing {out}")
    io.write_labelled([(out, result)])
    if page:
        from plasmapyro.page.correction import write_page  # matplotlib, which only pictures need

        progress.say(f"writing {page}")
        io.write_text(write_page(test, result, [finding.entry for finding in said]), page)
    if options.plot:
        from plasmapyro.plots import one_test

        one_test.picture(test, result, [options.plot])
    sys.stdout.write("\n".join(summary(result)) + "\n")
    progress.say("done")


def corrected(options):
    """What options of the command ask for: test, result (Dataset, labelled) and findings; they are said."""
    with calibration_of(options.test, options.instrument) as folder:
        return _corrected(argparse.Namespace(**vars(options) | {"instrument": folder}))


def _corrected(options):
    folder = options.instrument
    given = ()
    if options.given:
        from plasmapyro.commands.terms import read_terms, warn_of_absent  # all of the diagnosis

        given = read_terms(options.given)
        if not given:
            progress.warn(f"{options.given} holds no effect of a test: nothing is taken out of this one")
    progress.say(f"reading {options.test}")
    reading = read_with_files(options.test)
    if options.reference_window:
        reading.test.attrs["reference_window"] = list(options.reference_window)
    found = faults(reading.test)
    if found:
        raise ValueError(f"{options.test}: " + "\n".join(found))
    test = own_test(reading)
    if given:
        warn_of_absent(given, instruments(test))
    calibrations = _calibrations(test, folder)
    if options.priors:
        from plasmapyro.campaign.applied import applied
        from plasmapyro.commands.priors import read_priors

        files = {f"{name}.nc": io.digest(folder / f"{name}.nc") for name in calibrations}
        test, calibrations = applied(test, calibrations, read_priors(options.priors, files))
    found = of_test(options.test, reading, **calibrations)
    words = [finding.words for finding in found]
    if {one.name for one in NO_REFERENCE} & {one.rule.name for one in found} and not options.keep_window:
        raise ValueError(
            "\n".join([*words, "choose another --reference-window, or go on with --keep-window"])
        )
    options.estimator = _estimator(test, options.estimator)  # the settings in the result name it
    names, contract = ESTIMATORS[options.estimator]
    if options.estimator == "all":
        names = ALONE.get("".join(instruments(test)), names)
    parts, missing = [], {}
    for name in names:
        try:
            part = BY_NAME[name](test, calibrations, options)
            if given:
                part = _with_given(test, given, BY_NAME[name], calibrations, options)
            parts.append(part)
        except ValueError as reason:  # what the data themselves say may be why
            if name == names[0]:
                raise ValueError("\n".join([str(reason), *words])) from None
            missing[name] = str(reason).splitlines()[0]
    said = of_test(options.test, reading, parts, response=_response(folder), **calibrations)
    for finding in said:
        progress.warn(finding.words)
    parts = agreed(parts, test, _response(folder), calibrations.get(PYROMETER))
    result = with_recommended(parts, [finding.entry for finding in said], missing)
    if result.attrs["recommended"] == "none":
        result = with_level(result, test.attrs, calibrations.get(PYROMETER), _response(folder))
        if "scaled_temperature" in result and any(finding.rule.misdates for finding in said):
            known = np.isfinite(result.scaled_temperature.values)
            result = blanked(result, "scaled_temperature", "spectrum_status", known)
    result.attrs["findings"] = "\n".join(without_folders([finding.words for finding in said]))
    read = [*sources(options.test), *(folder / f"{name}.nc" for name in calibrations)]
    asked = told(options, "test", "instrument", "html", "no_html", "plot")
    return test, io.labelled(result, contract, read, {"correct": asked}), said


def _with_given(test, given, estimator, calibrations, options):
    """The result of an estimator for a test without effects that are taken as given.

    What is uncertain of them joins the uncertainties of the temperatures.
    """
    from plasmapyro.diagnosis import command as diagnosis

    progress.say(f"fitting the model of the test with {len(given)} effects as given: some 10 s")
    inputs = diagnosis.load_inputs(options.radiance, options.instrument)
    made, moves = diagnosis.without_given(test, inputs, given, saturation_counts=options.saturation_counts)
    result = estimator(made(), calibrations, options)
    quick = argparse.Namespace(**vars(options) | {"draws": 2})
    for moved in map(made, moves):
        other = estimator(moved, calibrations, quick)
        for kind in (one for one in result if one.endswith("temperature")):
            change = other[kind] - result[kind]
            widen(result, kind, change)
            if kind in OF_BUDGET:
                result = _with_input(result, change)
    return result


def _with_input(result, change):
    """The result with a further input of its budget, an effect that is taken as given."""
    inputs = budget.inputs_of(result)
    words = f"effect taken as given ({sum(one.group == 'named effects' for one in inputs) + 1})"
    inputs.append(budget.Input(words, "named effects", change.fillna(0.0).values))
    return result.drop_dims("input_quantity").assign(budget.variables(inputs))


def with_recommended(parts, entries, missing):
    """Results of the estimators as one, with the temperature to take away in place of their own budgets."""
    series = of_correction(parts, entries, missing)
    parts = [part.drop_dims("input_quantity", errors="ignore") for part in parts]
    return merged([*parts, series])


def trial(test, folder):
    """Calibrations and the result of a quick correction, as keywords of `quality.catalogue.of_test`."""
    words = ["correct", "", "--instrument", str(folder), "--draws", "50"]
    calibrations = _calibrations(test, Path(folder))
    alone = instruments(test) == ["radiometer"]
    first = ALONE["radiometer"][0] if alone else ESTIMATORS[_estimator(test, None)][0][0]
    result = BY_NAME[first](test, calibrations, cli.parser(["correct"]).parse_args(words))
    return {"results": [result], "response": _response(Path(folder)), **calibrations}


def _response(folder):
    """Responses of the bands, if the folder holds them: they tell levels from ratios."""
    path = folder / "response.nc"
    return io.read(path, "response") if path.exists() else None


def by_reference(test, calibrations, options):
    """Correction with a constant reference, as in the paper, of each instrument a test holds.

    `calibrations`: contract -> Dataset, what the instrument folder holds; `options`: of the command line.
    """
    parts = []
    if "pyrometer" in instruments(test):
        progress.say(f"correcting {test.sizes['time']} samples of the pyrometer")
        parts.append(
            correct_pyrometer(
                test,
                calibrations[PYROMETER],
                _response(Path(options.instrument)),
                **settings(options, correct_pyrometer) | {"draws": options.draws or 400},
            )
        )
    middle = options.reference_time
    if "spectrometer" in instruments(test) and middle is None:
        middle = middle_exposure(test)
    if "spectrometer" in instruments(test) and middle is None and parts:
        LOG.warning("no exposure lies within the reference window: spectra are not corrected by subtraction")
    elif "spectrometer" in instruments(test):
        half = test.attrs["spectrometer_fwhm"] / 2
        if options.normalisation_half_width_nm:
            half = options.normalisation_half_width_nm * NANOMETRE
        own = {
            "reference_time": np.mean(test.attrs["reference_window"]) if middle is None else middle,
            "normalisation_wavelength": options.normalisation_nm and options.normalisation_nm * NANOMETRE,
            "normalisation_half_width": half,
            "draws": options.draws or 100,
        }
        calibration = calibrations.get(SPECTROMETER)
        parts.append(correct_spectra(test, calibration, **settings(options, correct_spectra) | own))
    return merged(parts)


def by_emissivity(test, calibrations, options):
    """Temperature and smooth emissivity (contract 'emissivity_estimate') from spectra alone."""
    held = {"spectrometer": SPECTROMETER, "radiometer": RADIOMETER}
    name = next((one for one in held if one in instruments(test)), None)
    if name is None:
        raise ValueError("--estimator emissivity needs spectra or a radiometer; use --estimator reference")
    progress.say(f"inferring temperature and emissivity from all samples of the {name}")
    own = {
        "level": options.emissivity_level,
        "shape": options.emissivity_shape,
        "length": options.emissivity_length_nm * NANOMETRE,
        "memory": options.emissivity_memory_s,
        "bin_width": options.bin_nm * NANOMETRE,
    }
    calibration = calibrations.get(held[name])
    return estimate_emissivity(test, calibration, **settings(options, estimate_emissivity) | own)


def _estimator(test, asked):
    """Name of the estimator: the one asked for, or the one that a test without a pyrometer needs."""
    present, plasma = instruments(test), has_plasma(test)
    alone = len(present) == 1 and "pyrometer" not in present  # spectra, or a radiometer
    if present == ["radiometer"] and asked == "reference":
        raise ValueError("--estimator reference takes no radiometer: use --estimator emissivity or joint")
    if asked in (None, "all"):
        if not plasma:
            return "emissivity" if alone or "radiometer" in present else "reference"
        return "all"
    return "emissivity" if asked == "joint" and present == ["spectrometer"] else asked


# name -> function (test, calibrations, options)
BY_NAME = {"reference": by_reference, "joint": by_joint_inference, "emissivity": by_emissivity}
ESTIMATORS = {  # what may be asked for -> names, of which only the first must succeed, and the contract
    "all": (("reference", "joint"), "correction"),
    "reference": (("reference",), "correction"),
    "joint": (("joint",), "joint_estimate"),
    "emissivity": (("emissivity",), "emissivity_estimate"),
}
ALONE = {  # all that one instrument allows; Planck fits of spectra hold every surface to be grey
    "radiometer": ("emissivity", "joint"),
    "spectrometer": ("reference", "emissivity"),
}


def summary(result):
    """Lines that say what came out: for each instrument, how many samples of which status, and when."""
    lines = [result.attrs["recommended_because"]]
    for name, axis, state in (
        ("recommended_temperature", "time", "recommended_status"),
        ("corrected_temperature", "time", "corrected_status"),
        ("spectrometer_temperature", "spectrum_time", "spectrum_status"),
        ("surface_temperature", "time", "estimate_status"),
        ("spectral_temperature", "spectrum_time", "spectral_status"),
    ):
        if name not in result:
            continue
        values, states, time = result[name].values, result[state].values, result[axis].values
        lines.append(f"{name}: {counted(states, status.MEANINGS)}")
        good = np.flatnonzero(np.isin(states, (status.VALID, status.EXTRAPOLATED)))
        if good.size:
            first, hottest = good[0], good[np.nanargmax(values[good])]
            lines.append(
                f"  first at {time[first]:g} s: {_with(result, name, first)}; highest at {time[hottest]:g} s:"
                f" {_with(result, name, hottest)}"
            )
            lines += _of_emissivity(result, hottest) if name == "spectral_temperature" else []
    return lines


def _of_emissivity(result, index):
    """The emissivity of a spectrum at the ends and the middle of its wavelengths, and what stays open."""
    one = result.isel(spectrum_time=index)
    last = one.sizes["emissivity_wavelength"] - 1
    places = sorted({0, last // 2, last})
    words = ", ".join(
        f"{value:.3f} ({low:.3f} to {high:.3f}) at {wavelength * 1e9:.0f} nm"
        for wavelength, value, low, high in zip(
            one.emissivity_wavelength.values[places],
            one.emissivity.values[places],
            *one.emissivity_interval.values[:, places],
            strict=True,
        )
    )
    return [f"  emissivity there: {words}", f"  {result.attrs['degenerate']}"]


def _with(result, name, index):
    return f"{result[name].values[index]:.1f} +- {result[name + '_uncertainty'].values[index]:.1f} K"


def _calibrations(test, folder):
    """Calibrations (contract name -> Dataset) that the test needs or can use."""
    found = {}
    if "pyrometer" in instruments(test):
        found[PYROMETER] = io.read(folder / f"{PYROMETER}.nc", PYROMETER)
        low, high = found[PYROMETER].instrument_range.values
        if not 0 < low < high < np.inf:
            raise ValueError(
                f"{folder / PYROMETER}.nc: instrument_range must be two rising temperatures [K]; got"
                f" {low:g}, {high:g}: calibrate again"
            )
    if "spectrometer" in instruments(test):
        path, counted = folder / f"{SPECTROMETER}.nc", "spectral_radiance" not in test.variables
        if counted or path.exists():
            calibration = of_pixels(io.read(path, SPECTROMETER), test)
            # Radiances bring their own calibration; one of other pixels says nothing about them.
            if counted or on_same_wavelengths(calibration, test):
                found[SPECTROMETER] = calibration
    if "radiometer" in instruments(test):
        found[RADIOMETER] = io.read(folder / f"{RADIOMETER}.nc", RADIOMETER)
    return found
