"""Stage: the diagnosis of one test in the order of its steps: record, fit, select, report."""

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE, without
from plasmapyro.diagnosis.fit.base import fit_base
from plasmapyro.diagnosis.fit.build import base_model, of_given
from plasmapyro.diagnosis.fit.restore import restored
from plasmapyro.diagnosis.gas.library import NEED_VARIATIONS, gas_library
from plasmapyro.diagnosis.report.clock import on_clock
from plasmapyro.diagnosis.report.extended import terms_text
from plasmapyro.diagnosis.report.findings import Findings
from plasmapyro.diagnosis.report.report import report_of
from plasmapyro.diagnosis.report.residual_map import residual_map
from plasmapyro.diagnosis.report.temperature import temperatures
from plasmapyro.diagnosis.select.held_out import cross_condition, gain
from plasmapyro.diagnosis.select.selection import select
from plasmapyro.diagnosis.simulation.compare import compare
from plasmapyro.diagnosis.simulation.measured import measured_gas
from plasmapyro.diagnosis.simulation.predicted import predicted
from plasmapyro.experiment.correction import Reading
from plasmapyro.record.record import record_of

UNSEEN = 1e-4  # [1], rms of signals and spectra: a hundredth of what moves the ratio by 30 K


@dataclass(frozen=True)
class Diagnosis:
    """What a diagnosis hands over: `report` (by the schema), `residual_map` and `temperature` datasets,
    and the `terms` that it proposes to take as given."""

    report: dict
    residual_map: xr.Dataset
    temperature: xr.Dataset
    terms: str = ""  # YAML


def diagnose(
    test,
    radiation,
    variations,
    response,
    calibration=None,
    spectrometer_calibration=None,
    *,
    saturation_counts,
    limits,
    effects=CATALOGUE,
    exclude=(),
    draws=2000,
    seed=1,
    provenance=None,
    thresholds=None,
    others=(),
    given=(),
):
    """Diagnose one test against the simulation of its condition.

    Parameters
    ----------
    test : Dataset, contract 'test', without faults (`experiment.inputs.faults`)
    radiation : mapping condition -> Dataset, contract 'radiation'
    variations : Dataset, contract 'gas_variations', of the condition of the test, or None
        Without it the effects that need it are not looked for.
    response : Dataset, contract 'response'
    calibration, spectrometer_calibration : Datasets or None
    saturation_counts : float [count]
        Raw counts of the spectrometer from here on are saturated.
    limits : mapping with the fields of `experiment.correction.Reading` that no file holds
        Of the paper's correction: `signal_uncertainty`, `gas_variation`, `detection_level`,
        `least_surface_share`.
    effects : mapping id -> Effect
    exclude : ids of effects that are not looked for
    draws, seed : int
        Simulated nulls behind the thresholds.
    provenance : dict, optional
        Goes into the report.
    thresholds : Thresholds, optional
        Of an alike data set, instead of new ones.
    others : sequence of (test, variations)
        Tests with the same instruments, at other conditions, on which what is named is tried.
    given : sequence of Term
        Effects that are taken as given in the base model; they are not looked for.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ValueError
        Unknown condition or effect.
    """
    known = {term.setting.id for term in given} & set(effects)
    looked_for = without(effects, {*exclude, *known})
    if variations is None:
        looked_for = without(looked_for, set(NEED_VARIATIONS) & set(looked_for))
    instrument = response, calibration, spectrometer_calibration

    def fitted(test, variations, given=()):
        return fit_test(
            test, radiation, variations, *instrument, saturation_counts=saturation_counts, given=given
        )

    slope = float(test.attrs.get("emittance_slope", 1.0))
    reading = None if calibration is None else Reading.of(calibration, slope, **limits)
    base = fitted(test, variations, tuple(given))
    questions = [
        {i: one for i, one in looked_for.items() if one.steady_gas is steady} for steady in (False, True)
    ]
    selection = select(base, questions[0], thresholds=thresholds, draws=draws, seed=seed)
    comparison = compare(base.model, measured_gas(base.model, selection.final), questions[1], seed=seed)
    final, named = selection.final, bool(selection.final.settings)
    gained = gain(base.model, base.solution, final) if named else None
    crossed = sum(_crossed(base, final, fitted(*other)) for other in others) if named and others else None
    findings = Findings(base, selection, comparison, effects, gained, crossed, reading, provenance or {})
    temperature = temperatures(findings)
    found = Diagnosis(
        report_of(findings, temperature), residual_map(findings), temperature, terms_text(findings)
    )
    return on_clock(found, base.model.record.injection)


def fit_test(
    test,
    radiation,
    variations,
    response,
    calibration=None,
    spectrometer_calibration=None,
    *,
    saturation_counts,
    given=(),
):
    """Base fit of a test; parameters as of `diagnose`."""
    calibrations = {"spectrometer": spectrometer_calibration}
    if calibration is not None:
        calibrations["pyrometer"] = calibration
    record = record_of(test, calibrations, saturation_counts=saturation_counts)
    if not record.instruments:
        raise ValueError("the test holds pyrometer signals only: calibration.nc of the pyrometer is needed")
    fwhm = float(test.attrs.get("spectrometer_fwhm", 0.75e-9))
    library = gas_library(str(test.attrs["condition"]), radiation, variations, fwhm=fwhm)
    return fit_base(base_model(record, library, calibration, response, spectrometer_calibration, given))


def without_given(test, *inputs, **settings):
    """A test without the effects that are taken as given, and how uncertain that is.

    Parameters
    ----------
    test, *inputs, **settings : as of `fit_test`, which is called once

    Returns
    -------
    made : function (parameters moved {name: value}, none by default) -> Dataset, contract 'test'
    moves : list of such parameters
        One standard error each, independent of the others, the one that changes the data most first; those
        that change them by less than `UNSEEN` are left out.

    Notes
    -----
    Source: principal components of the change of the data, for the covariance of the numbers after the fit.
    """
    base = fit_test(test, *inputs, **settings)
    model, solution = base.model, base.solution
    names = [one.id for one in of_given(model.given)]
    places = [model.index[name] for name in names]
    fitted, own = solution.state.values[places], model.size + np.array(places, dtype=int)

    def made(moved=None):
        return restored(test, model.record, base, moved)

    def moves(columns):
        return [dict(zip(names, fitted + column, strict=True)) for column in columns.T]

    if not names:
        return made, []
    root = np.linalg.cholesky(solution.covariance[np.ix_(own, own)])
    plain = made()
    seen = [name for name in ("signal_wide", "signal_narrow", "spectral_radiance") if name in plain]
    change = np.array(
        [
            np.concatenate([np.ravel(moved[name] / plain[name]) for name in seen]) - 1
            for moved in map(made, moves(root))
        ]
    )
    power, axes = np.linalg.eigh(np.nan_to_num(change) @ np.nan_to_num(change).T / change.shape[1])
    kept = np.flatnonzero(power > UNSEEN**2)[::-1]
    return made, moves(root @ axes[:, kept])


def foretold(tests, calibration, spectrometer_calibration, *, limits, saturation_counts):
    """What simulations foretell of the gas of tests.

    Parameters
    ----------
    tests : mapping name -> (Dataset of the contract 'test', then Datasets of the contract 'radiation')
    calibration, spectrometer_calibration : Datasets
    limits, saturation_counts : as of `diagnose`

    Returns
    -------
    dict name -> list of `simulation.predicted.Prediction`, one for each simulation
    """
    found = {}
    for name, (test, *simulated) in tests.items():
        reading = Reading.of(calibration, float(test.attrs.get("emittance_slope", 1.0)), **limits)
        found[name] = [
            predicted(
                test,
                radiation,
                reading,
                calibration,
                spectrometer_calibration,
                saturation_counts=saturation_counts,
            )
            for radiation in simulated
        ]
    return found


def _crossed(base, final, other):
    """Log score of another test with the effects of this one."""
    start = replace(other.solution.state, amplitudes=final.state.amplitudes)
    extended = other.fitter.fit(start, final.settings)
    sizes = [one.model.size + len(one.model.parameters) for one in (base, other)]
    return cross_condition(final, other.solution, extended, *sizes)
