"""The rules, in the order in which they are said."""

import logging
from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro.quality import (
    agreement,
    beside,
    clocks,
    instrument,
    late,
    pyrometer,
    sightline,
    spectra,
    window,
)
from plasmapyro.quality.rule import DOUBT, Case, look, rules_of
from plasmapyro.record import status

LOG = logging.getLogger(__name__)
OF_TEST = rules_of(agreement, window, pyrometer, spectra, clocks)
OF_CALIBRATION = rules_of(instrument)
OF_SIGHTLINE = rules_of(sightline)


def agreed(parts, test, response=None, calibration=None):
    """Results of the estimators, without a value and `contradicted` where their instruments contradict.

    Around spectra where the two differ by more than `instruments_disagree` allows, where an offset of their
    clocks moves a temperature by more than `clocks_apart` does (which clock is right nobody knows), and where
    the level of an instrument is no light of its temperature (`beside.of_surface`). Of spectra alone the
    Planck fits, where `spectra_not_grey` finds the surface not to be grey; elsewhere their intervals hold the
    difference, as those of a pyrometer's subtraction do where `throughput_in_doubt` is said.
    `parts`: as `results` of `of_test`.
    """
    both = next((one for one in parts if set(late.ALONE) <= set(one)), None)
    known = {} if test is None else test.attrs
    own = [beside.of_surface(one, known, calibration, response) for one in parts]
    if both is None:
        return _doubted(_grey(own, parts))
    case = Case(Path(), test, response=response, result=both)
    moments, _, _ = agreement.disagreeing(both, agreement.instruments_disagree.limit)
    limit = agreement.clocks_apart.limit
    offset = late.clocks(case, limit)
    return [_without(part, moments, offset, limit) for part in own]


def _doubted(parts):
    """Results of a pyrometer alone: where its level and ratio are in doubt, the subtraction holds both."""
    estimate = next((one for one in parts if "surface_temperature" in one), None)
    if estimate is None or not agreement.throughput_in_doubt(Case(Path(), estimate=estimate)):
        return parts
    return [
        beside.with_joint(one, estimate) if late.ALONE[0] in one and estimate.time.equals(one.time) else one
        for one in parts
    ]


def _grey(parts, before):
    """Results of spectra alone, without the Planck fits that temperature and emissivity contradict.

    Where the level jumps (of the results `before` any was blanked) the latter, which hold it, have no value.
    """
    fits = next((one for one in parts if set(agreement.FITS) <= set(one)), None)
    estimate = next((one for one in parts if "spectral_temperature" in one), None)
    if fits is None or estimate is None:
        return parts
    whole = next(one for one in before if set(agreement.FITS) <= set(one))
    if agreement.level_jumps(whole, agreement.emittance_jumps.limit)[1].size:
        told = np.isfinite(estimate.spectral_temperature.values)
        blank = beside.blanked(estimate, "spectral_temperature", "spectral_status", told)
        return [blank if one is estimate else one for one in parts]
    far, _, _ = agreement.unlike_grey(fits, estimate, agreement.spectra_not_grey.limit)
    other = fits.spectrum_status.values == status.CONTRADICTED  # not the light of a surface as stated
    new = {id(fits): beside.with_estimate(fits, estimate)}
    new[id(estimate)] = beside.blanked(estimate, "spectral_temperature", "spectral_status", other)
    parts = [new.get(id(one), one) for one in parts]
    return [_without(one, fits.spectrum_time.values[far], None, None) for one in parts]


def _without(part, moments, offset, limit):
    """A result without values around spectra at some moments, and where an offset moves them too far."""
    for name in (one for one in late.TEMPERATURES if one in part):
        state, (axis,) = part[late.TEMPERATURES[name]], part[name].dims
        bad = np.isin(part[axis].values, moments)
        for moment in moments if axis == "time" else ():
            bad |= np.abs(part[axis].values - moment) <= agreement.NEAR
        bad &= np.isin(state.values, status.WITH_VALUE)
        bad |= offset is not None and offset.beyond(part, name, limit)
        part = beside.blanked(part, name, state.name, bad)
    return part


def of_test(place, reading, results=(), rules=OF_TEST, **calibrations):
    """What contradicts itself in a test, its results and its calibrations: the one way to all who say it.

    `place`: of the test, for the messages; `reading`: `readers.stage.Reading`; `results`: of the contracts
    'correction' or its two parts, 'joint_estimate', 'emissivity_estimate'; `calibrations` by the names of
    `Case`, None where there is none. The worst finding stands first.
    """
    estimates = [one for one in results if {"surface_temperature", "spectral_temperature"} & set(one)]
    parts = [one for one in results if not any(one is other for other in estimates)]
    case = Case(
        Path(place),
        reading.test,
        reading.files.get("spectrometer", {}),
        result=merged(parts) if parts else None,
        estimate=next(iter(estimates), None),
        **calibrations,
    )
    others = clocks.of_other_tests(case)
    return look(case.without(others) if others else case, rules)


def own_test(reading, place=None):
    """The test of a `readers.stage.Reading` without other tests that stand in the same log.

    With its `place` they are said, where nobody asks `of_test`.
    """
    for finding in of_test(place, reading, rules=(clocks.another_test,)) if place else ():
        LOG.warning(finding.words)
    case = Case(Path(), reading.test, reading.files.get("spectrometer", {}))
    return case.without(clocks.of_other_tests(case)).test


def merged(parts):
    """The corrections of single instruments (Datasets) as one, contract 'correction'."""
    attributes = {name: value for part in parts for name, value in part.attrs.items()}
    whole = xr.merge(
        list(_on_one_clock(parts)), combine_attrs="override", join="exact", compat="no_conflicts"
    )
    return whole.assign_attrs(attributes)


def _on_one_clock(parts):
    """Times counted from the injection and back may differ in their last bit: those of the first part."""
    first = {}
    for part in parts:
        for axis in {"time", "spectrum_time"} & set(part.coords):
            own, known = part[axis].values, first.setdefault(axis, part[axis].values)
            if own.shape == known.shape and np.allclose(own, known, rtol=1e-12, atol=1e-9):
                part = part.assign_coords({axis: known})
        yield part


def table(rules):
    """A Markdown table of rules."""
    rows = [
        f"| `{r.name}`{'*' * (r.severity == DOUBT)} | {r.looks_at} | {r.limit:g} {r.unit} | {r.reason} |"
        for r in rules
    ]
    return "\n".join(["| rule | looks at | limit | because |", "|---|---|---|---|", *rows]).replace(
        " 1 |", " |"
    )
