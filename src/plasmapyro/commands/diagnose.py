"""`plasmapyro diagnose`: what the simulation of a test gets wrong."""

import sys
from pathlib import Path

import numpy as np

from plasmapyro import io, progress
from plasmapyro.commands.correct import trial
from plasmapyro.commands.instrument import calibration_of
from plasmapyro.commands.outputs import beside, require_folder, require_of_test
from plasmapyro.commands.priors import read_priors
from plasmapyro.commands.terms import read_terms, warn_of_absent
from plasmapyro.diagnosis import command as diagnosis
from plasmapyro.diagnosis.fit.no_plasma import OtherLight
from plasmapyro.estimate.lamps import shapes_of
from plasmapyro.page.words import without_folders
from plasmapyro.quality.agreement import throughput_in_doubt
from plasmapyro.quality.catalogue import of_test, own_test
from plasmapyro.quality.rule import Case
from plasmapyro.readers.stage import read_with_files, sources
from plasmapyro.record import status
from plasmapyro.record.inputs import has_plasma, instruments

LAMP_STEP = 3e-9  # [m] of the light of a lamp


def run(options):
    """Run `plasmapyro diagnose`: test in, five files out."""
    out = Path(options.out or beside(options.test, "_diagnosis"))
    read = [options.test, *options.also, options.radiance, options.instrument, options.variations]
    read += [options.given, options.priors]
    require_folder(out, diagnosis.NAMES, read)
    if not options.out:
        require_of_test(out / "temperature.nc", options.test)
    result, read = diagnosed(options)
    progress.say(f"writing {out}")
    diagnosis.write_all(
        result, out, sources=read, page=diagnosis.page_writer(), truth=diagnosis.truth_of(read[0])
    )
    said = result.report["verdict"]["sentences"][0], result.temperature.attrs["recommended_because"]
    sys.stdout.write("\n".join([*said, *_following(result.report)]) + "\n")
    progress.say("done")
    return diagnosis.exit_status(result.report, options.fail_on_finding)


def _following(report):
    """Table of the three best measurements that may follow."""
    rows, known = report["next"], {row["id"]: row["name"] for row in report["candidates"]}
    yield f"Measure next, where T is now known to {rows[0]['kelvin_before']:.2g} K:"
    for row in rows[:3]:
        groups = ([known.get(one, one) for one in group] for group in row["resolves"])
        decides = "".join(f"; tells apart {', '.join(one[:-1])} and {one[-1]}" for one in groups)
        yield f"  {row['kelvin_after']:5.2g} K  {row['measurement']}{decides}"


def diagnosed(options):
    """What options of the command ask for: the diagnosis, and the files of tests that it read."""
    with calibration_of(options.test, options.instrument) as folder:
        return _diagnosed(options, folder)


def _diagnosed(options, folder):
    given = ()
    if options.given:
        given = *read_terms(options.given), *read_terms(options.given, "condition")
    read_priors(options.priors)  # a fault of the file is said first
    progress.say(f"reading {options.test}")
    test, reading = _read(options.test)
    data = own_test(reading)
    if {"pyrometer", "radiometer"} <= set(instruments(data)):
        progress.warn("the diagnosis takes the pyrometer; the radiometer is left aside")
    warn_of_absent(given, instruments(data))
    others = [_read(one) for one in options.also]
    tried = _tried(data, folder)
    findings = of_test(options.test, reading, **tried)
    for finding in findings:
        progress.warn(finding.words)
    inputs = diagnosis.load_inputs(options.radiance, folder, options.variations)
    inputs = diagnosis.with_variations(
        data, diagnosis.of_its_pressure(data, inputs, [one.test for _, one in others])
    )
    known = read_priors(options.priors, inputs.digests)
    if "pyrometer" in instruments(data) and inputs.calibration is None:
        progress.warn("the pyrometer is left aside: its calibration.nc is not there")
    progress.say("fitting the base model, screening the catalogue, measuring the gain: some 10 s")
    digest = io.digest(test) if test.is_file() else None
    result = diagnosis.diagnose_test(
        data,
        inputs,
        without=tuple(options.without),
        digest=digest,
        others=[own_test(one) for _, one in others],
        findings=without_folders([finding.entry for finding in findings]),
        saturation_counts=options.saturation_counts,
        given=given,
        known=known,
        **_unlike_a_surface(data, tried),
    )
    if (doubt := throughput_in_doubt(Case(Path(options.test), estimate=result.temperature))) is not None:
        progress.warn(doubt.words)
        result.report["findings"].append(without_folders(doubt.entry))
    for remark in diagnosis.remarks_on(data, inputs):
        progress.warn(remark)
    return result, [file for path in (test, *(path for path, _ in others)) for file in sources(path)]


def _unlike_a_surface(test, tried):
    """What the correction of a test without a plasma saw that no hot surface gives: a lamp, odd spectra."""
    found = next((one for one in tried.get("results", ()) if "spectral_status" in one), None)
    if has_plasma(test) or found is None:
        return {}
    odd = found["spectral_status"].values == status.CONTRADICTED
    known = {"contradicted": (found["spectrum_time"].values[odd], found.attrs["contradictions"])}
    if "lamp" in found.attrs:
        about, axis = found.attrs, test["wavelength"].values
        axis = np.linspace(axis.min(), axis.max(), int(np.ptp(axis) / LAMP_STEP) + 2)
        light = shapes_of(about["lamp"], axis, float(test.attrs["spectrometer_fwhm"]))
        known["room"] = OtherLight(about["lamp"], axis, about["lamp_radiance"] * light)
    return known


def _read(word):
    """Path and `Reading` of a test."""
    path = Path(word)
    test = path / "test.nc" if path.is_dir() and not (path / "test.yaml").exists() else path
    return test, read_with_files(test)


def _tried(test, folder):
    """What the rules compare with a test: a trial correction, as far as it can be made."""
    try:
        return trial(test, folder)
    except ValueError:  # contracts.ContractError too: a diagnosis needs less
        return {}
