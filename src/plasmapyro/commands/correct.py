"""`plasmapyro correct`: surface temperatures of one data set, without a workflow."""

import argparse
import sys
from pathlib import Path

import numpy as np

from plasmapyro import cli, io, progress
from plasmapyro.commands.instrument import calibration_of
from plasmapyro.commands.joint import by_joint_inference
from plasmapyro.commands.options import count, not_negative, option, plot_option, positive, seed, share
from plasmapyro.commands.outputs import require_writable
from plasmapyro.estimate.emissivity_stage import estimate_emissivity
from plasmapyro.experiment.stage import correct_pyrometer, correct_spectra
from plasmapyro.quality.catalogue import merged, of_test
from plasmapyro.quality.window import surface_in_window
from plasmapyro.readers.stage import read_with_files, sources
from plasmapyro.record import budget, status
from plasmapyro.record.calibrated import on_same_wavelengths
from plasmapyro.record.inputs import faults, has_plasma, instruments
from plasmapyro.record.recommended import of_correction

NANOMETRE = 1e-9
# files and contracts
PYROMETER, SPECTROMETER, RADIOMETER = "calibration", "spectrometer_calibration", "radiometer_calibration"

OF_BUDGET = ("corrected_temperature", "surface_temperature", "spectral_temperature")

DESCRIPTION = """\
Take the light of the plasma out of the signals of a test and give the temperature of the surface with its
standard uncertainty and, for each sample, whether to trust it.

What comes out is one temperature to take away, recommended_temperature, with the reason for it and what each
input adds to its uncertainty; every estimate that the data allow stands beside it (--estimator all).

--estimator reference is the paper's: what both instruments see in the reference window, when the plasma
shines and the sample is still dark, is subtracted until the plasma is switched off. The two-colour
temperature follows from the ratio of the corrected signals, the spectrometer's from fits of Planck's law to
the corrected spectra. Pyrometer and spectrometer may each be absent.

--estimator joint infers one temperature from all bands in absolute units (of a pyrometer, a radiometer, or
both, each on its own clock) and, if present, the spectra, and follows the gas through the test
(docs/temperature.md); it needs response.nc of the pyrometer. For spectra alone it is the same as

--estimator emissivity: temperature and an emissivity that is smooth over wavelength and time, together, from
the spectra, or the bands of a radiometer, alone. It is what spectra of a lamp or a furnace (condition: none)
get, and a radiometer.

TEST is a folder (test.yaml and raw files, or test.nc) or a netCDF file; see docs/your-own-data.md and
`plasmapyro check`."""
EXAMPLE = """\
examples:
  plasmapyro correct my_test --instrument results/instrument --out temperature.nc
  plasmapyro correct my_test --instrument lab --out t.nc --gas-variation 0.05 --reference-window 0 4

what comes out (netCDF):
  recommended_temperature, ..._interval            [K] to take away, with its 95 % interval, against `time`
  temperature_contribution                         [K] what each input adds to its uncertainty
  surface_temperature                              [K] joint estimate
  measured_temperature, corrected_temperature      [K] of the pyrometer, before and after, against `time`
  spectrometer_temperature, scaled_temperature     [K] of the spectra, against `spectrum_time`
  ..._uncertainty                                  [K] standard uncertainties (68 %)
  ..._status                                       valid, no_signal, gas_dominated, ...: see flag_meanings

and a page beside it: signals, temperature, spectra, what was refused and why"""


def add(command):
    """Add the arguments to the subcommand's parser."""
    command.add_argument("test", metavar="TEST", help="folder or netCDF file of a test")
    command.add_argument(
        "--instrument",
        metavar="FOLDER",
        help="holds calibration.nc (needed for pyrometer signals) and spectrometer_calibration.nc (needed for"
        " counts), as results/instrument or the --out of `plasmapyro calibrate`; or raw files with"
        " calibration.yaml (default: the folder `calibration` in the test's or beside it)",
    )
    command.add_argument(
        "--out", metavar="FILE.nc", help="where the temperatures go (default: TEST_temperature.nc, here)"
    )
    command.add_argument(
        "--html", metavar="FILE", help="where the page of the test goes (default: --out with .html)"
    )
    command.add_argument("--no-html", action="store_true", help="write no page")
    plot_option(command, "signals, temperature and spectra")
    command.add_argument(
        "--estimator",
        choices=sorted(ESTIMATORS),
        help="how the gas is taken out (default: all that the data allow; emissivity for spectra alone"
        " without a plasma)",
    )
    command.add_argument(
        "--reference-window",
        nargs=2,
        type=float,
        metavar=("BEGIN", "END"),
        help="[s] instead of the one the test states: plasma on, surface still dark",
    )
    command.add_argument(
        "--keep-window",
        action="store_true",
        help="go on although the surface already shows in the reference window (its light is then subtracted"
        " as if it were gas)",
    )
    known = command.add_argument_group("effects that are taken as given")
    known.add_argument(
        "--with",
        dest="given",
        metavar="FILE.yaml",
        help="what a diagnosis named (its terms.yaml): taken out of signals and spectra first, by the model"
        " of the diagnosis fitted to this test; its uncertainty joins that of the temperatures",
    )
    known.add_argument(
        "--radiance",
        metavar="FOLDER",
        help="spectra of all conditions, {condition}.nc, for --with (default: those shipped)",
    )
    known.add_argument(
        "--priors",
        metavar="FILE.yaml",
        help="what earlier tests say, priors.yaml of `plasmapyro campaign`: ratio and throughputs of the"
        " calibration, scale of the spectrometer and stated emittance become theirs, with their uncertainty",
    )
    number = command.add_argument_group("what is uncertain (standard, relative)")
    option(number, "--signal-uncertainty", share, 0.01, "of one pyrometer signal")
    option(number, "--gas-variation", share, 0.03, "of the gas radiance about that of the reference window")
    number.add_argument(
        "--draws", type=count, default=None, metavar="N", help="Monte Carlo draws (default: 400 and 100)"
    )
    option(number, "--seed", seed, 2, "of the Monte Carlo draws: the same seed, the same result")
    when = command.add_argument_group("when a temperature is given")
    option(when, "--detection-level", positive, 2.0, "uncertainties that a corrected signal must exceed")
    option(when, "--least-surface-share", share, 0.5, "of the surface in a signal, else gas_dominated")
    option(when, "--least-signal-to-noise", positive, 10.0, "of a spectrum at the pivot")
    fit = command.add_argument_group("fits to the spectra")
    fit.add_argument(
        "--reference-time",
        type=float,
        metavar="S",
        help="the exposure nearest to it is the reference spectrum (default: middle of the window)",
    )
    option(fit, "--normalisation-nm", positive, 1030.0, "pivot wavelength of the normalised fit, in vacuum")
    fit.add_argument(
        "--normalisation-half-width-nm",
        type=positive,
        metavar="X",
        help="pixels this near are averaged there (default: half the spectrometer's FWHM)",
    )
    fit.add_argument(
        "--temperature-range-k",
        nargs=2,
        type=positive,
        default=[600.0, 3500.0],
        metavar=("LOW", "HIGH"),
        help="where the fits look (default: 600 3500)",
    )
    spectral = command.add_argument_group("emissivity over wavelength (--estimator emissivity)")
    spectral.add_argument(
        "--emissivity-level",
        type=positive,
        metavar="X",
        help="standard uncertainty of its level, relative (default: what the test states, or 0.1)",
    )
    option(spectral, "--emissivity-shape", not_negative, 0.1, "of its course over wavelength, relative")
    option(spectral, "--emissivity-length-nm", positive, 200.0, "over which that course is smooth")
    option(spectral, "--emissivity-memory-s", positive, 100.0, "over which its change in time is smooth")
    option(spectral, "--stray-light", share, 0.003, "of the mean count rate, in every pixel, standard")
    option(spectral, "--bin-nm", positive, 20.0, "over which pixels are averaged")
    option(spectral, "--bin-uncertainty", share, 0.005, "of each of these means, relative, standard")
    option(fit, "--saturation-counts", positive, 65000.0, "raw counts from here on are saturated")
    option(fit, "--noise-block-pixels", count, 50, "pixels per estimate of the noise")


def run(options):
    """Run `plasmapyro correct`: test in, file out, and a summary."""
    out = options.out or f"{Path(options.test).resolve().stem}_temperature.nc"
    page = None if options.no_html else options.html or Path(out).with_suffix(".html")
    places = [path for path in (out, page, options.plot) if path]
    require_writable(places, [options.test, options.instrument])
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
        from plasmapyro.commands.terms import read_terms  # all of the diagnosis, which only --with needs

        given = read_terms(options.given)
    progress.say(f"reading {options.test}")
    reading = read_with_files(options.test)
    test = reading.test
    if options.reference_window:
        test.attrs["reference_window"] = list(options.reference_window)
    found = faults(test)
    if found:
        raise ValueError(f"{options.test}: " + "\n".join(found))
    calibrations = _calibrations(test, folder)
    if options.priors:
        from plasmapyro.campaign.applied import applied
        from plasmapyro.commands.priors import read_priors

        test, calibrations = applied(test, calibrations, read_priors(options.priors))
    found = of_test(options.test, reading, **calibrations)
    words = [finding.words for finding in found]
    if surface_in_window in [finding.rule for finding in found] and not options.keep_window:
        raise ValueError(
            "\n".join([*words, "choose another --reference-window, or go on with --keep-window"])
        )
    options.estimator = _estimator(test, options.estimator)  # the settings in the result name it
    names, contract = ESTIMATORS[options.estimator]
    if options.estimator == "all" and instruments(test) == ["radiometer"]:
        names = OF_BANDS
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
    result = with_recommended(parts, [finding.entry for finding in said], missing)
    result.attrs["findings"] = "\n".join(finding.words for finding in said)
    read = [*sources(options.test), *(folder / f"{name}.nc" for name in calibrations)]
    return test, io.labelled(result, contract, read, {"correct": _settings(options)}), said


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


def widen(result, name, change):
    """Add a change (t,) [K] of a temperature to its uncertainty and interval, as one more standard error."""
    known = result[f"{name}_uncertainty"]
    wider = np.hypot(known, change.fillna(0.0).values)
    if f"{name}_interval" in result:
        middle, ends = result[name], result[f"{name}_interval"]
        result[f"{name}_interval"] = (middle * (ends / middle) ** (wider / known)).transpose(*ends.dims)
    result[f"{name}_uncertainty"] = wider


def trial(test, folder):
    """Calibrations and the result of a quick correction, as keywords of `quality.catalogue.of_test`.

    Parameters
    ----------
    test : Dataset, contract 'test'
    folder : path of the calibration

    Returns
    -------
    dict
    """
    words = ["correct", "", "--instrument", str(folder), "--draws", "50"]
    calibrations = _calibrations(test, Path(folder))
    alone = instruments(test) == ["radiometer"]
    first = OF_BANDS[0] if alone else ESTIMATORS[_estimator(test, None)][0][0]
    result = BY_NAME[first](test, calibrations, cli.parser(["correct"]).parse_args(words))
    return {"results": [result], "response": _response(Path(folder)), **calibrations}


def _response(folder):
    """Responses of the bands, if the folder holds them: they tell levels from ratios."""
    path = folder / "response.nc"
    return io.read(path, "response") if path.exists() else None


def by_reference(test, calibrations, options):
    """Correction with a constant reference, as in the paper, of each instrument the test holds.

    Parameters
    ----------
    test : Dataset, contract 'test'
    calibrations : mapping of contract name -> Dataset, what the instrument folder holds
    options : Namespace of the command line

    Returns
    -------
    Dataset, contract 'correction'
    """
    parts = []
    if "pyrometer" in instruments(test):
        progress.say(f"correcting {test.sizes['time']} samples of the pyrometer")
        parts.append(
            correct_pyrometer(
                test,
                calibrations[PYROMETER],
                signal_uncertainty=options.signal_uncertainty,
                gas_variation=options.gas_variation,
                detection_level=options.detection_level,
                least_surface_share=options.least_surface_share,
                draws=options.draws or 400,
                seed=options.seed,
            )
        )
    if "spectrometer" in instruments(test):
        middle, half = np.mean(test.attrs.get("reference_window", 0)), test.attrs["spectrometer_fwhm"] / 2
        parts.append(
            correct_spectra(
                test,
                calibrations.get(SPECTROMETER),
                reference_time=middle if options.reference_time is None else options.reference_time,
                normalisation_wavelength=options.normalisation_nm * NANOMETRE,
                normalisation_half_width=(
                    options.normalisation_half_width_nm * NANOMETRE
                    if options.normalisation_half_width_nm
                    else half
                ),
                temperature_range=options.temperature_range_k,
                saturation_counts=options.saturation_counts,
                gas_variation=options.gas_variation,
                least_signal_to_noise=options.least_signal_to_noise,
                noise_block=options.noise_block_pixels,
                draws=options.draws or 100,
                seed=options.seed,
            )
        )
    return merged(parts)


def by_emissivity(test, calibrations, options):
    """Temperature and smooth emissivity from spectra alone.

    Returns
    -------
    Dataset, contract 'emissivity_estimate'
    """
    held = {"spectrometer": SPECTROMETER, "radiometer": RADIOMETER}
    name = next((one for one in held if one in instruments(test)), None)
    if name is None:
        raise ValueError("--estimator emissivity needs spectra or a radiometer; use --estimator reference")
    progress.say(f"inferring temperature and emissivity from all samples of the {name}")
    return estimate_emissivity(
        test,
        calibrations.get(held[name]),
        level=options.emissivity_level,
        shape=options.emissivity_shape,
        length=options.emissivity_length_nm * NANOMETRE,
        memory=options.emissivity_memory_s,
        stray_light=options.stray_light,
        bin_width=options.bin_nm * NANOMETRE,
        bin_uncertainty=options.bin_uncertainty,
        gas_variation=options.gas_variation,
        least_signal_to_noise=options.least_signal_to_noise,
        least_surface_share=options.least_surface_share,
        saturation_counts=options.saturation_counts,
        noise_block=options.noise_block_pixels,
    )


def _estimator(test, asked):
    """Name of the estimator: the one asked for, or the one that a test without a pyrometer needs."""
    present, plasma = instruments(test), has_plasma(test)
    alone = len(present) == 1 and "pyrometer" not in present  # spectra, or a radiometer
    if present == ["radiometer"] and asked == "reference":
        raise ValueError("--estimator reference takes no radiometer: use --estimator emissivity or joint")
    if asked in (None, "all"):
        if not plasma:
            return "emissivity" if alone or "radiometer" in present else "reference"
        return "reference" if present == ["spectrometer"] else "all"
    return "emissivity" if asked == "joint" and present == ["spectrometer"] else asked


# name -> function (test, calibrations, options)
BY_NAME = {"reference": by_reference, "joint": by_joint_inference, "emissivity": by_emissivity}
ESTIMATORS = {  # what may be asked for -> names, of which only the first must succeed, and the contract
    "all": (("reference", "joint"), "correction"),
    "reference": (("reference",), "correction"),
    "joint": (("joint",), "joint_estimate"),
    "emissivity": (("emissivity",), "emissivity_estimate"),
}
OF_BANDS = ("emissivity", "joint")  # all that a radiometer alone allows


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
        counted = ", ".join(
            f"{int((states == code).sum())} {word}"
            for code, word in status.MEANINGS.items()
            if (states == code).any()
        )
        lines.append(f"{name}: {counted}")
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
    places = [0, one.sizes["emissivity_wavelength"] // 2, -1]
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
            calibration = io.read(path, SPECTROMETER)
            # Radiances bring their own calibration; one of other pixels says nothing about them.
            if counted or on_same_wavelengths(calibration, test):
                found[SPECTROMETER] = calibration
    if "radiometer" in instruments(test):
        found[RADIOMETER] = io.read(folder / f"{RADIOMETER}.nc", RADIOMETER)
    return found


def _settings(options):
    skipped = {"run", "test", "instrument", "out", "html", "no_html", "plot"}
    return {name: value for name, value in vars(options).items() if name not in skipped}
