"""Along which axis lies what no effect describes, and whether a name fits only because it is alike."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.inference import Fitter
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.fit.weights import Noise
from plasmapyro.diagnosis.select import selection
from plasmapyro.diagnosis.select.bent import bent
from plasmapyro.diagnosis.select.screen import screen
from plasmapyro.diagnosis.select.search import Step
from plasmapyro.diagnosis.select.selection import _along_time
from plasmapyro.diagnosis.select.structures import seen_by
from plasmapyro.diagnosis.select.unknowns import Unknowns

NOISE = 0.003  # [1]
PATH = [0, 20, 120, 150], [350, 1200, 1500, 1150]  # [s], [K]


def blister(model, which, time, temperature, value):
    """A part of the spot grows hotter within 20 s, until the plasma ends: more light in the narrow band."""
    grown = np.clip((time - 0.4 * model.off) / 20, 0, 1) * (time < model.off)
    return 1 + 0.02 * grown[:, None] * np.array([0.5, 1.0]) if which == 0 else 1.0


def darkening(model, which, time, temperature, value):
    """A fibre darkens in the heat, and recovers: less light at short waves."""
    wavelength = model.instruments[1].wavelength
    return 1 - 0.03 * (temperature[:, None] / 1500) ** 4 * (wavelength / 0.95e-6) ** -2 if which else 1.0


def warming(model, which, time, temperature, value):
    """A filter warms, and an edge of the narrow band with it: what that costs depends on the surface."""
    share = (1 - np.exp(-np.maximum(time, 0) / 60)) * (temperature / 1500) ** 2
    return 1 + 0.03 * share[:, None] * np.array([0.0, 1.0]) if which == 0 else 1.0


def ranges(model, which, time, temperature, value):
    """An amplifier changes its range where the signal has 60 % of its largest value."""
    return np.where(value > 0.6 * value.max(axis=0), 1.01, 1.0) if which == 0 else 1.0


def fitted(model, fault, settings=(), **ends):
    """A fit to data with a fault."""
    knots = np.interp(model.history.knots, *PATH)
    values = np.array([parameter.centre for parameter in model.parameters])
    measured = []
    for which, instrument in enumerate(model.instruments):
        value = model.evaluate(which, knots, values, ())
        temperature = model.history.basis(instrument.time) @ knots
        measured.append(value * fault(model, which, instrument.time, temperature, value))
    noise = [Noise((NOISE * one) ** 2, np.zeros(len(one))) for one in measured]
    fitter = Fitter(model, noise, measured)
    return fitter.fit(fitter.start(knots, settings), settings, **ends)


@pytest.mark.parametrize(
    ("fault", "identity", "instrument", "along"),
    [
        (blister, "one_walk_narrow", "pyrometer", "time"),
        (darkening, None, "spectrometer", "temperature"),
        (warming, None, "pyrometer", "time and temperature"),
        (ranges, None, "pyrometer", "signal"),
    ],
)
def test_a_fault_lies_along_the_axis_that_it_changes_along(model, fault, identity, instrument, along):
    """What changes slowly once and ends with the plasma is one course, not a wave of both bands."""
    solution = fitted(model, fault)
    seen = screen(model, solution, {})
    step = Step(solution, seen, None, Unknowns(seen)(seen.score), None)
    assert seen_by(step.structure) == {"instrument": instrument, "axis": along}
    assert identity in (None, step.structure)


def hum(model, which, time, temperature, value):
    """The mains, sampled near a multiple of its period: a zero that swings within a few bins."""
    swing = 0.002 * np.median(value, axis=0) * np.sin(2 * np.pi * 0.41 * time)[:, None]
    return 1 + swing / value if which == 0 else 1.0


@pytest.mark.parametrize(("fault", "along"), [(hum, "time"), (ranges, "signal")])
def test_where_a_signal_explains_most_time_has_a_step_at_every_sample(model, fault, along):
    step = SimpleNamespace(solution=fitted(model, fault))
    found = _along_time(SimpleNamespace(model=model), step, "one_signal_pyrometer")
    assert seen_by(found) == {"instrument": "pyrometer", "axis": along}


@pytest.mark.parametrize(("in_time", "chosen"), [(44524.0, "signal_wide"), (47000.0, "walk_ratio")])
def test_a_walk_that_follows_a_signal_as_well_is_not_its_cause(model, monkeypatch, in_time, chosen):
    """Log Bayes factors of a converter with unequal steps (measured), and of what asks for time clearly."""
    structures = [SimpleNamespace(id=one) for one in ("walk_ratio", "signal_wide", "smooth")]
    seen = SimpleNamespace(structures=structures, score=None)
    monkeypatch.setattr(selection, "screen", lambda *_, **__: seen)
    monkeypatch.setattr(selection, "Unknowns", lambda _: lambda _: np.array([in_time, 41827.0, 0.0]))
    found = _along_time(SimpleNamespace(model=model), SimpleNamespace(solution=None), "signal_wide")
    assert found == chosen


def fouling(model, which, time, temperature, value):
    return 1 - 0.03 * np.clip(time / model.off, 0, 1)[:, None] if which else 1.0


@pytest.mark.parametrize(("fault", "expected"), [(fouling, False), (darkening, True)])
def test_a_name_that_fits_only_as_a_near_relation_is_bent(model, fault, expected):
    """What darkens with the heat is called a deposit: it grows while the surface heats."""
    named = fitted(model, fault, (Setting(CATALOGUE["winE"], 0.02, {}),))
    assert bent(model, named, {"winE": 100.0}) is expected
    assert not bent(model, named, {"winE": 1e5})  # formulas err by so much


def dark(course, size):
    """A dark of the spectrometer, the same in all channels, that takes a course over the exposure."""

    def added(model, which, time, temperature, value):
        more = size * np.median(value) * course(time / model.off)
        return 1 + more[:, None] / value if which else 1.0

    return added


@pytest.mark.parametrize(
    ("course", "size", "expected"),
    [
        (lambda share: 1 + 0.02 * share, 0.01, False),  # bends gain 20
        (lambda share: 2 ** (1.2 * np.clip(share, 0, 1.2)) - 1, 0.01, True),  # of a cabinet that warms by 8 K
        (lambda share: share > 0.3, 0.002, True),  # a lamp of the laboratory is switched on
    ],
    ids=["always", "warming", "switched on"],
)
def test_a_name_of_an_instrument_is_held_against_what_changes_in_time(model, course, size, expected):
    """What bends gain of a dark that is told by a few dim spectra a formula may err by."""
    named = fitted(model, dark(course, size), (Setting(CATALOGUE["off_s"], size, {}),), steps=2)
    assert bent(model, named, {"off_s": 1e5}) is expected


@pytest.mark.parametrize(("share", "expected"), [(-1.0, False), (0.08, True), (0.3, True)])
def test_a_clock_that_lost_samples_while_the_sample_heats_is_not_that_of_another_start(
    model, share, expected
):
    """The pyrometer is early from a share of the exposure on: where a surface heats, shares a tenth apart
    are as unlike as a clock that was early all along."""
    early = (Setting(CATALOGUE["clock"], 0.4, {"spectra": 0.0}),)

    def lost(model, which, time, temperature, value):
        knots = np.interp(model.history.knots, *PATH)
        moved = model.evaluate(which, knots, np.array([one.centre for one in model.parameters]), early)
        return np.where((time > share * model.off)[:, None], moved / value, 1.0)

    assert bent(model, fitted(model, lost, early), {"clock": 1e5}) is expected
