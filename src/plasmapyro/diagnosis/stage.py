"""Stage: the diagnosis of one test in the order of its steps: record, fit, select, report."""

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from plasmapyro import conditions
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE, NEED_VARIATIONS, of_one_spot, without
from plasmapyro.diagnosis.effects.condition import OF_FLOW
from plasmapyro.diagnosis.effects.gas import leaks
from plasmapyro.diagnosis.fit.no_plasma import askable
from plasmapyro.diagnosis.fit.setting import numbers_of
from plasmapyro.diagnosis.fit.slit import SLIT, seen_slit
from plasmapyro.diagnosis.fit.terms import digest_of
from plasmapyro.diagnosis.fit.whole import fit_test
from plasmapyro.diagnosis.report.clock import on_clock
from plasmapyro.diagnosis.report.extended import terms_text
from plasmapyro.diagnosis.report.findings import Findings, gas_is_likelier
from plasmapyro.diagnosis.report.foreign import atom, certain, line_pattern, lines_lacking
from plasmapyro.diagnosis.report.report import report_of
from plasmapyro.diagnosis.report.residual_map import residual_map
from plasmapyro.diagnosis.report.temperature import temperatures
from plasmapyro.diagnosis.select.excursion import EXCURSION, excursion
from plasmapyro.diagnosis.select.held_out import cross_condition, gain
from plasmapyro.diagnosis.select.left_in_bands import left_in_bands
from plasmapyro.diagnosis.select.leftover import left_over
from plasmapyro.diagnosis.select.pixels import in_turn
from plasmapyro.diagnosis.select.search import Search
from plasmapyro.diagnosis.select.selection import select, shows
from plasmapyro.diagnosis.select.told import told
from plasmapyro.diagnosis.simulation.compare import anywhere, compare, nothing_to_compare
from plasmapyro.diagnosis.simulation.measured import measured_gas
from plasmapyro.diagnosis.simulation.simulated import expected_power
from plasmapyro.experiment.correction import Reading
from plasmapyro.record.inputs import has_plasma, instruments

STRANGE_LINE = "line_gas_pattern"  # structure that a line which nobody simulates is
OF_TWO_BANDS = {"edge1", "edge2", "resp_long", "phi", "off1", "off2"}  # effects of the wide and narrow band
OF_MANY_BANDS = {"crosstalk"}  # and of a radiometer with
MANY = 3  # bands or more
MBAR = 100.0  # [Pa]


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
    against=(),
    known=None,
    radiometer_calibration=None,
    room=None,
    contradicted=((), ""),
    cut=False,
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
    against : sequence of str
        What says that instruments contradict each other: without a confirmed cause no temperature is
        recommended.
    known : Normal, optional
        What other tests say about the instruments, the emittance and the power: the prior of this one.
    radiometer_calibration : Dataset or None
        Bands that take the place of the pyrometer's in a test without these; `response` may be None then.
    room : OtherLight that was found beside the surface of a test without a plasma, or None
        The base model holds it.
    contradicted : times [s] on the clock of the test, and a sentence
        Of spectra that are no light of a hot surface: no temperature unless a confirmed cause says why.
    cut : bool
        Whether the record is to be cut, where something else begins: no name stands with reserve then.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ValueError
        Unknown condition or effect.
    """
    plasma = has_plasma(test)
    if not plasma:
        effects = askable(effects)
    taken = {term.setting.id for term in given} & set(effects)
    looked_for = without(effects, {*exclude, *taken})
    if "radiometer" not in instruments(test) or test.sizes["band"] < MANY:
        effects, looked_for = (without(one, OF_MANY_BANDS & set(one)) for one in (effects, looked_for))
    if "pyrometer" not in instruments(test):
        looked_for = without(looked_for, OF_TWO_BANDS & set(looked_for))
    if len(instruments(test)) == 1:
        looked_for = of_one_spot(looked_for)
    if variations is None and plasma:
        looked_for = without(looked_for, set(NEED_VARIATIONS) & set(looked_for))

    def fitted(test, variations, bands=True, frames=True, **more):
        of_bands = (calibration, radiometer_calibration) if bands else (None, None)
        of_frames = spectrometer_calibration if frames else None
        more |= {"saturation_counts": saturation_counts, "radiometer_calibration": of_bands[1]}
        return fit_test(test, radiation, variations, response, of_bands[0], of_frames, **more)

    slope = float(test.attrs.get("emittance_slope", 1.0))
    reading = (
        None
        if calibration is None or not plasma or "pyrometer" not in instruments(test)
        else Reading.of(calibration, slope, **limits)
    )
    of_test = {"given": tuple(given), "known": known, "room": room}
    base = fitted(test, variations, **of_test)
    questions = [
        {i: one for i, one in looked_for.items() if one.steady_gas is steady} for steady in (False, True)
    ]
    selection = select(base, questions[0], thresholds=thresholds, draws=draws, seed=seed)
    restless = base.solution.converged and not selection.final.converged
    if restless:
        selection = selection.unnamed()  # a fit that comes to no rest names nothing, nor a gas beside it
    gained = _gained(base, selection)
    if gained is not None and gained.silent and not selection.outweighs_unknown:
        selection, gained = selection.unnamed(), None
    elif gained is not None and not gained.improves:
        selection = selection.doubted("unconfirmed")
    elif gained is not None and gained.of_a_moment:
        selection = selection.doubted("moment")
    left, in_samples = (asked(base.model, selection.final) for asked in (left_over, left_in_bands))
    several = any(one.kind == "spectrometer" for one in base.model.instruments)
    if left and several and (selection.in_bands or in_samples):
        # A joint temperature that follows wrong bands leaves a pattern in a sound spectrometer.
        left = _left_alone(fitted(test, variations, bands=False, **of_test), selection.final.settings)
    left = in_turn(base.model.record) or left or in_samples
    selection = selection.with_rest(left)
    if excursion(base.model, selection.final) is not None:
        selection = selection.beside(EXCURSION)
    doubted = selection.final
    selection = told(Search(base.model, base.fitter, questions[0], selection.thresholds), selection)
    if selection.final is not doubted:
        gained = _gained(base, selection)
        silent = gained is not None and gained.silent and not selection.outweighs_unknown
        if silent or not selection.final.converged:
            selection, gained = selection.unnamed(), None
    if cut and selection.status == "named+unknown":
        selection, gained = selection.unnamed(), None
    sources = instruments(test)
    if selection.status == "named+unknown" and plasma and sorted(sources) == ["pyrometer", "spectrometer"]:
        selection = replace(selection, faulty=_shown_alone(fitted, test, variations, of_test, questions[0]))
    comparison, elsewhere, foreign = nothing_to_compare(base.model), "", []
    if plasma:
        own = radiation[str(test.attrs["condition"])]
        slit = None if SLIT in taken else seen_slit(base.model.record, own)
        measured = replace(measured_gas(base.model, selection.final), slit=slit)
        if selection.in_bands:
            measured = measured.of_last()
        beside = {"mixing"} - {term.setting.id for term in given} if base.model.library.core else ()
        beside = {one: OF_FLOW[one] for one in beside}
        away = expected_power(own)
        asked = {"beside": beside, "away": away, "leaks": leaks(), "seed": seed}
        comparison = compare(base.model, measured, questions[1], **asked)
        foreign = lines_lacking(base.model, comparison)
        sure = {atom(one) for one in foreign if certain(one)} & set(questions[1])
        freed = [one for one in foreign if certain(one) and atom(one) not in sure]
        for one in freed:  # their light is no cause of the simulated gas
            measured = measured.without(line_pattern(base.model, one["species"]), False)
        if freed or sure:
            found = compare(base.model, measured, questions[1], sure=sure, **asked)
            comparison = replace(found, lines=comparison.lines) if freed else found
        elsewhere = other_gas(test, radiation, comparison)
        if elsewhere:
            comparison = anywhere(base.model, measured, questions[1], comparison, elsewhere, seed=seed)
    strange = any(line.strange for line in comparison.lines) and not elsewhere
    if comparison.final.settings and not strange and selection.hides(comparison.gained):
        apart = None if elsewhere else selection.channels()
        if apart is None:
            comparison = comparison.without_names(elsewhere)
        else:  # a cause of the gas that gains as much where that is not
            comparison = compare(base.model, measured.without(*apart), questions[1], **asked)
    if restless or not gas_is_likelier(comparison, len(effects)):
        comparison = comparison.without_names(elsewhere)
    if strange:
        selection = selection.beside(STRANGE_LINE)
        if selection.hides(comparison.gained):
            comparison = comparison.without_names(elsewhere)
    of_gas = {setting.id for setting in comparison.final.settings}
    foreign = [one for one in foreign if atom(one) not in of_gas]
    final, named = selection.final, bool(selection.final.settings)
    crossed = sum(_crossed(base, final, fitted(*other)) for other in others) if named and others else None
    rest = gained, crossed, reading, provenance or {}, digest_of(test), tuple(foreign)
    findings = Findings(base, selection, comparison, effects, *rest)
    temperature = temperatures(findings, against, contradicted)
    found = Diagnosis(
        report_of(findings, temperature), residual_map(findings), temperature, terms_text(findings)
    )
    return on_clock(found, base.model.record.injection)


def _left_alone(base, named):
    """What a fit to the spectrometer alone leaves (id, or None), with what is named of it."""
    own = tuple(one for one in named if "spectrometer" in one.effect.instruments)
    if not own:
        return left_over(base.model, base.solution)
    start = replace(base.solution.state, amplitudes=numbers_of(own))
    return left_over(base.model, base.fitter.fit(start, own))


def _shown_alone(fitted, test, variations, of_test, effects):
    """Instruments whose data alone, at a temperature of their own, show that something is wrong."""
    frames = [name for name in test.variables if {"spectrum_time", "wavelength"} & {*test[name].dims}]
    alone = {
        "pyrometer": fitted(test.drop_vars(frames), variations, frames=False, **of_test),
        "spectrometer": fitted(test, variations, bands=False, **of_test),
    }
    return frozenset(
        name
        for name, base in alone.items()
        if shows(base, {i: one for i, one in effects.items() if name in one.instruments})
    )


def _gained(base, selection):
    """Gain of what was selected on held-out data, None where nothing is named."""
    named = selection.final.settings
    return gain(base.model, base.solution, selection.final) if named else None


def other_gas(test, radiation, comparison):
    """Why the simulation is not one of the gas of a test, in a sentence, or "".

    Densities go with the pressure, and lines that absorb themselves, and what electrons excite, do not even
    go with the density: nothing says how the simulated spectrum would change.
    """
    own = radiation[str(test.attrs["condition"])]
    simulated = conditions.number(own, "chamber_pressure")
    if conditions.of_another_pressure(test, own):
        return (
            f"The test ran at {conditions.pressure_of(test) / MBAR:.3g} mbar, the simulation at"
            f" {simulated / MBAR:.3g} mbar: no cause in the gas is looked for in what they differ by. A"
            " condition of that pressure simulates it."
        )
    if "chamber_pressure" not in test and comparison.unlike:
        at = f" for {simulated / MBAR:.3g} mbar" if np.isfinite(simulated) else ""
        return (
            f"At its best power the gas is {np.exp(comparison.final.brightness):.2g} times as bright as"
            f" simulated{at}, and the test records no pressure: no cause in the gas is looked for before."
        )
    return ""


def _crossed(base, final, other):
    """Log score of another test with the effects of this one."""
    start = replace(other.solution.state, amplitudes=final.state.amplitudes)
    extended = other.fitter.fit(start, final.settings)
    sizes = [one.model.size + len(one.model.parameters) for one in (base, other)]
    return cross_condition(final, other.solution, extended, *sizes)
