"""Files in, files out: what `plasmapyro diagnose` and the workflow call."""

import importlib
import importlib.util
import json
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

import jsonschema
import numpy as np
import xarray as xr

from plasmapyro import conditions, contracts, io, progress, shipped
from plasmapyro.diagnosis import stage
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit import no_plasma, restore
from plasmapyro.diagnosis.fit.radiometer import refused
from plasmapyro.diagnosis.fit.slit import with_lines
from plasmapyro.diagnosis.fit.terms import AMPLITUDE
from plasmapyro.diagnosis.gas import other_pressure
from plasmapyro.diagnosis.gas.library import remarks
from plasmapyro.diagnosis.gas.stage import gas_variations
from plasmapyro.quantities import behind
from plasmapyro.record.inputs import faults, has_plasma, instruments
from plasmapyro.record.recommended import CONTRADICTIONS
from plasmapyro.tables import weakest

SCHEMA = Path(__file__).with_name("diagnosis.schema.json")
INSTRUMENT = ("response", "calibration", "spectrometer_calibration", "radiometer_calibration")
VARIATIONS, SIGHTLINES, VIEWS = "radiation_variations", "sightline", "surface_view"  # beside the radiance
KEPT = ["gas_radiance_slit", "gas_radiance_component_slit", "component_uncertainty"]
KEPT += ["error_share", "error_system", "error_cause"]
SATURATION_COUNTS = 65000.0  # [count] as `experiment.spectrometer.saturation_counts` of the configuration
LIMITS = {  # as `experiment.pyrometer` of the configuration
    "signal_uncertainty": 0.01,
    "gas_variation": 0.03,
    "detection_level": 2.0,
    "least_surface_share": 0.5,
}
CUT = {"unexplained_step", "plasma_off_time"}  # rules that ask to cut the record where they see something
NAMES = ("diagnosis.json", "residual_map.nc", "temperature.nc", "index.html", "terms.yaml")
FINDINGS = {"named": 3, "one-of": 3, "named+unknown": 3, "unknown": 4}  # exit status with --fail-on-finding


@dataclass(frozen=True)
class Inputs:
    """Everything but the test, read once: spectra of all conditions, their variations, instrument."""

    radiation: dict
    variations: dict
    response: xr.Dataset
    calibration: xr.Dataset | None
    spectrometer_calibration: xr.Dataset | None
    origin: str
    digests: dict
    radiometer_calibration: xr.Dataset | None = None
    folder: Path | None = None  # of the spectra


def load_inputs(radiance, instrument, variations=None):
    """Read the stage files that a diagnosis compares with: those of `gas_of` and of `with_instrument`."""
    return with_instrument(gas_of(radiance, variations), instrument)


def gas_of(radiance=None, variations=None):
    """Spectra that a diagnosis compares with; these `Inputs` lack an instrument.

    `radiance`, `variations`: folders of `{condition}.nc`, contracts 'radiation' and 'gas_variations', or
    lists of such files; those that come with the package, and the folder beside `radiance`, if left out.
    ContractError: a file that is missing or breaches its contract.
    """
    if radiance is None:
        varied, digests = shipped.by_condition(), {"radiation/shipped": shipped.stored()[1]}
        spectra = {name: with_lines(one, KEPT) for name, one in varied.items()}
        return Inputs(spectra, varied, None, None, None, origin="", digests=digests)
    files = _files(radiance)
    if not files:
        raise contracts.ContractError(f"{radiance}: holds no spectra ({{condition}}.nc)")
    spectra = {}
    for path in files:
        spectra[path.stem] = with_lines(io.read(path, "radiation"), KEPT)
    beside = files[0].parents[1] / VARIATIONS
    varied = {
        path.stem: io.read(path, "gas_variations")
        for path in _files(beside if variations is None else variations)
        if path.stem in spectra
    }
    digests = {f"radiation/{path.name}": io.digest(path) for path in files}
    folder = files[0].resolve().parent
    return Inputs(spectra, varied, None, None, None, origin="", digests=digests, folder=folder)


def of_its_pressure(test, inputs, others=()):
    """The inputs with the gas simulated at the pressure of a test, where the spectra are of another one and
    the sight lines of their flows (`sightline`, `surface_view`) lie beside them; else as they are. That of
    the conditions of `others` is varied as well."""
    condition = str(test.attrs.get("condition", ""))
    own = inputs.radiation.get(condition)
    if own is None or inputs.folder is None or not conditions.of_another_pressure(test, own):
        return inputs
    if not (inputs.folder.parent / SIGHTLINES / f"{condition}.nc").exists():
        return inputs
    if _changed(own):
        return inputs  # by `effects` of its condition: how they go with the pressure nobody says
    pressure = float(f"{conditions.pressure_of(test):.3g}")  # one for all tests of a campaign
    around = (condition, *sorted({str(one.attrs.get("condition", "")) for one in others} - {condition}))
    try:
        spectra, varied, digests = _simulated_at(pressure, around, inputs.folder)
    except ValueError as fault:  # another gas than N2 and O2, a pressure in other units
        progress.warn(f"the gas is not simulated at the pressure of the test: {fault}")
        return replace(inputs, folder=None)  # said once
    apart = {name: one for name, one in inputs.variations.items() if name not in spectra}
    return replace(
        inputs,
        radiation=inputs.radiation | spectra,
        variations=apart | varied,
        digests=inputs.digests | digests,
    )


def with_variations(test, inputs):
    """The inputs with varied spectra of the gas of a test, where a folder holds none of its condition but the
    sight line and the light on the surface; else as they are."""
    condition = str(test.attrs.get("condition", ""))
    own = inputs.radiation.get(condition)
    if own is None or inputs.folder is None or condition in inputs.variations:
        return inputs
    beside = [inputs.folder.parent / kind / f"{condition}.nc" for kind in (SIGHTLINES, VIEWS)]
    pressure = conditions.number(own, "chamber_pressure")
    if not all(path.exists() for path in beside) or _changed(own) or np.isnan(pressure):
        return inputs
    try:
        spectra, digests = _varied(condition, pressure, inputs.folder)
    except ValueError as fault:  # another gas than N2 and O2
        progress.warn(f"the gas is not varied: {fault}")
        return replace(inputs, folder=None)  # said once
    return replace(
        inputs, variations=inputs.variations | {condition: spectra}, digests=inputs.digests | digests
    )


def _changed(radiation):
    """Whether `effects` of its condition changed a spectrum."""
    return "changes" in json.loads(radiation.attrs.get("configuration", "{}"))


@lru_cache(maxsize=4)
def _varied(condition, pressure, folder):
    """`gas_variations` of a condition from the stage files beside its spectrum, and the digests of these."""
    progress.say(f"varying the gas of {condition}: some 20 s")
    paths = {kind: folder.parent / kind / f"{condition}.nc" for kind in (SIGHTLINES, VIEWS)}
    line, view = (io.read(path, kind) for kind, path in paths.items())
    radiation = io.read(folder / f"{condition}.nc", "radiation")
    depth = {"boundary_layer_depth": other_pressure.BOUNDARY_LAYER}
    with np.errstate(all="ignore"):
        found = gas_variations(line, view, radiation, pressure=pressure, **depth)
    return found, {f"{kind}/{condition}.nc": io.digest(path) for kind, path in paths.items()}


@lru_cache(maxsize=4)
def _simulated_at(pressure, around, folder):
    """What `other_pressure.simulated_at` makes of the spectra in a folder and the stage files beside it, and
    the digests of these."""
    progress.say(f"simulating the gas at {1e-2 * pressure:.3g} mbar, the pressure of the test: some 30 s")
    places = {"sightline": SIGHTLINES, "surface_view": VIEWS, "radiation": folder}
    paths = {kind: {path.stem: path for path in _files(folder.parent / at)} for kind, at in places.items()}
    lines, views, spectra = (
        {name: io.read(path, kind) for name, path in found.items()} for kind, found in paths.items()
    )
    wavelength = spectra[around[0]]["wavelength"].values
    around = [name for name in around if name in conditions.ladder(around[0], spectra)]
    with np.errstate(all="ignore"):
        found, varied = other_pressure.simulated_at(
            pressure, around, lines, views, spectra, wavelength=wavelength
        )
    digests = {
        f"{kind}/{name}.nc": io.digest(path)
        for kind, used in (("sightline", found), ("surface_view", varied))
        for name, path in paths[kind].items()
        if name in used
    }
    return {name: one[KEPT].assign_attrs(one.attrs) for name, one in found.items()}, varied, digests


def _files(place):
    """The files of a folder, or those of a list."""
    return (
        sorted(Path(place).glob("[!.]*.nc"))
        if isinstance(place, str | Path)
        else [Path(one) for one in place]
    )


def with_instrument(inputs, folder):
    """The inputs with the instrument of another folder.

    It holds `response.nc` and `calibration.nc`, `radiometer_calibration.nc`, `spectrometer_calibration.nc`,
    as far as the test holds such instruments. ContractError as for `gas_of`.
    """
    found = {name: Path(folder) / f"{name}.nc" for name in INSTRUMENT}
    there = {name for name, path in found.items() if path.exists()}
    needed = {"response"} if "calibration" in there or not there else set()  # of the pyrometer alone
    read = {name: io.read(path, name) if name in there | needed else None for name, path in found.items()}
    kept = {name: digest for name, digest in inputs.digests.items() if name.startswith("radiation/")}
    own = {found[name].name: io.digest(found[name]) for name in found if name in there}
    parts = [one for one in (*inputs.radiation.values(), *read.values()) if one is not None]
    origin = weakest([one.attrs.get("origin", "modelled") for one in parts])
    return replace(inputs, **read, origin=origin, digests=kept | own)


def diagnose_test(
    test,
    inputs,
    *,
    without=(),
    effects=CATALOGUE,
    draws=2000,
    seed=1,
    digest=None,
    others=(),
    saturation_counts=SATURATION_COUNTS,
    limits=LIMITS,
    findings=(),
    given=(),
    known=None,
    room=None,
    contradicted=((), ""),
):
    """Diagnose a test, from a netCDF file or a dataset, as `stage.diagnose`, whose words these are.

    `without`: ids of effects that are not looked for; `others`: tests at other conditions, as `test`, with
    the same instruments; `findings`, as in the schema: what contradicts itself in the data, said first;
    `known`: prior of what tests share, as `plasmapyro campaign` finds it. ValueError: a test that cannot be
    processed, with every fault; a condition without a spectrum.
    """
    if not isinstance(test, xr.Dataset):
        digest, test = io.digest(test), io.read(test, "test")
    condition = _usable(test, inputs)
    test = without_unseen(test, inputs)
    others = [one if isinstance(one, xr.Dataset) else io.read(one, "test") for one in others]
    inputs = with_variations(test, of_its_pressure(test, inputs, others))
    if any(one.drop_attrs(deep=False).equals(test.drop_attrs(deep=False)) for one in others):
        raise ValueError("a test foretells nothing of itself: the others (--also) hold it once more")
    pairs = [(one, inputs.variations.get(_usable(one, inputs))) for one in others]
    provenance = {
        "version": version("plasmapyro"),
        "files": inputs.digests,
        "test": digest or "",
        "origin": weakest([inputs.origin, str(test.attrs.get("origin", "measured"))]),
    }
    varied = inputs.variations.get(condition)
    with np.errstate(all="ignore"), _said(findings):
        result = stage.diagnose(
            test,
            inputs.radiation,
            varied,
            inputs.response,
            inputs.calibration,
            inputs.spectrometer_calibration,
            saturation_counts=saturation_counts,
            limits=limits,
            effects=effects,
            exclude=without,
            draws=draws,
            seed=seed,
            provenance=provenance,
            others=pairs,
            given=given,
            against=[entry["saw"] for entry in findings if entry["rule"] in CONTRADICTIONS],
            known=known,
            radiometer_calibration=inputs.radiometer_calibration,
            room=room,
            contradicted=contradicted,
            cut=any(entry["rule"] in CUT for entry in findings),
        )
    result.report["posterior"]["with_priors"] = known is not None
    result.report["findings"] = list(findings)
    result.report["given"] = [_entry(term) for term in given]
    result.report["assumptions"].extend([*remarks_on(test, inputs), *map(_sentence, given)])
    return result


@contextmanager
def _said(findings):
    """Says what a fit that breaks down means: data that no surface behind this gas gives."""
    try:
        yield
    except np.linalg.LinAlgError as fault:
        why = "; ".join(entry["saw"] for entry in findings) or "`check` and `correct` show them"
        raise ValueError(f"the model of the diagnosis cannot follow these data: {why}") from fault


def without_unseen(test, inputs):
    """The test without a radiometer that no diagnosis behind its plasma can take, where another instrument is
    left, and a warning that says why."""
    calibration = inputs.radiometer_calibration
    if calibration is None or not has_plasma(test) or instruments(test) != ["spectrometer", "radiometer"]:
        return test
    wavelength = inputs.radiation[str(test.attrs["condition"])]["wavelength_slit"].values
    why = refused(calibration, test["band"].values, wavelength)
    if not why:
        return test
    progress.warn(f"the radiometer is left out: {why}")
    return test.drop_dims(["radiometer_time", "band"])


def without_given(test, inputs, given, *, saturation_counts=SATURATION_COUNTS):
    """A test without effects that are taken as given, see `fit.restore.without_given`."""
    varied = inputs.variations.get(_usable(test, inputs))
    instrument = inputs.response, inputs.calibration, inputs.spectrometer_calibration
    settings = {"saturation_counts": saturation_counts, "given": tuple(given)}
    settings["radiometer_calibration"] = inputs.radiometer_calibration
    with np.errstate(all="ignore"):
        return restore.without_given(test, inputs.radiation, varied, *instrument, **settings)


def _entry(term):
    """What is taken as given, as a row of the report."""
    effect = {key: getattr(term.setting.effect, key) for key in ("id", "name", "unit")}
    sigma = float(term.uncertainty.get(AMPLITUDE, 0.0))
    return effect | {"amplitude": float(term.setting.amplitude), "standard_error": sigma}


def _sentence(term):
    """What is taken as given, in words."""
    effect, sigma = term.setting.effect, term.uncertainty.get(AMPLITUDE, 0.0)
    size = f"{term.setting.amplitude:.3g} ± {sigma:.1g}{behind(effect.unit)}"
    return f"taken as given: {effect.name}, {effect.amplitude} {size}"


def remarks_on(test, inputs):
    """What the simulations at hand leave out in the diagnosis of a test (list of sentences).

    `test`: Dataset, contract 'test'; `inputs`: Inputs that hold its condition.
    """
    condition = str(test.attrs["condition"])
    if not has_plasma(test):
        return ["a lamp or a furnace: no gas is simulated, none is looked for; the emissivity may bend"]
    found = remarks(condition, inputs.radiation, inputs.variations.get(condition))
    found += other_pressure.remarks(inputs.radiation[condition])
    return [*found, shipped.REMARK] if "radiation/shipped" in inputs.digests else found


def _usable(test, inputs):
    """Condition of a test; ValueError if it cannot be processed or compared."""
    found = faults(test)
    if found:
        raise ValueError("the test cannot be processed:\n  " + "\n  ".join(found))
    condition = str(test.attrs.get("condition", ""))
    if not has_plasma(test):
        return condition
    if condition not in inputs.radiation:
        raise ValueError(
            f"no simulated gas of condition {condition!r}: known are"
            f" {', '.join(inputs.radiation)}{_whose(inputs)}; name one of them as `condition`, or give"
            " your own simulation by `--radiance FOLDER`"
        )
    return condition


def _whose(inputs):
    """Whose simulations are known: those of the package, or those of a folder."""
    return ", which come with plasmapyro" if "radiation/shipped" in inputs.digests else ""


def page_writer():
    """The function that makes the page, or None where the package has none."""
    if importlib.util.find_spec("plasmapyro.page") is None:
        return None
    return importlib.import_module("plasmapyro.page.stage").write_page


def check(report):
    """Return a report that honours the published schema; raise ValueError else."""
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    fault = jsonschema.exceptions.best_match(jsonschema.Draft202012Validator(schema).iter_errors(report))
    if fault is not None:
        place = "/".join(str(part) for part in fault.absolute_path)
        raise ValueError(f"the report breaches its schema at {place}: {fault.message}")
    return report


def truth_of(test):
    """What was hidden in a synthetic test (Dataset), if the file truth.nc lies beside it; else None.

    For the page alone, which shows it beside what was found without it.
    """
    path = Path(test).with_name("truth.nc")
    return io.read(path, "truth") if path.exists() else None


def write_all(result, folder, *, sources=(), page=None, truth=None):
    """Write the files of a diagnosis into a folder, all or none of them.

    `sources`: paths of the inputs, whose digests go into the netCDF files; `page` (report, residual_map,
    temperature, truth) -> str makes `index.html`; `truth`, of a synthetic test, is for it.
    """
    report = check(result.report)

    def write(made):
        io.write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", made / "diagnosis.json")
        io.write_text(result.terms, made / "terms.yaml")
        io.write(result.residual_map, made / "residual_map.nc", "residual_map", sources=sources)
        io.write(result.temperature, made / "temperature.nc", "diagnosis_temperature", sources=sources)
        if page is not None:
            io.write_text(page(report, result.residual_map, result.temperature, truth), made / "index.html")

    io.store_folder(folder, write)


def exit_status(report, fail_on_finding):
    """0, or if it is asked for 3 if a cause is named, be it a lamp in view, 4 if something else is wrong."""
    lamp = any(entry["rule"] == no_plasma.LAMP for entry in report["findings"])
    against = any(entry["severity"] == "contradiction" for entry in report["findings"])
    beside = 3 if lamp else 4 * against
    return FINDINGS.get(report["verdict"]["status"], beside) if fail_on_finding else 0
