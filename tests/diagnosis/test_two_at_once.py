"""Errors that are large against the noise: the fit finds the bottom of the valley, and of two errors of one
pyrometer the choice of terms does not stop at the one that imitates both."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from small_laboratory import OFF, SLIT_FWHM, black_body, gas_components, temperature_of

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.base import fit_base
from plasmapyro.diagnosis.fit.build import base_model
from plasmapyro.diagnosis.fit.inference import Fitter
from plasmapyro.diagnosis.fit.setting import FreeNumber
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.diagnosis.select.selection import select
from plasmapyro.record.record import record_of

SHIFT, LOSS = 8e-9, -0.02  # [m] of the wide band's edges; [1] of the largest signal
BOTH = {"pyrometer": None, "spectrometer": None}
WHOLE = dataclasses.replace(CATALOGUE["edge1"], shapes=({"detector": 1.0},), shape_bounds={})  # as is hidden
NEAR_BOTTOM = 1.0  # of 13000 of chi-squared
SAME_BOTTOM = 0.1  # of chi-squared; fits end where a step gains 0.02


@pytest.fixture(scope="module")
def base(record, response, axis, laboratory):
    """Base fit of a test whose wide band is shifted and whose detectors grow with the signal."""
    test = record(noise=0.2)
    time, wavelength = test["time"].values[:, None], response["wavelength"].values
    plume = np.interp(wavelength, axis, gas_components(axis, 80e3).sum(axis=0))
    plasma = np.where(time < 0, 1.6, (time < OFF).astype(float))
    light = 0.85 * black_body(wavelength, temperature_of(time)) * (time >= 0) + plasma * plume
    own = response["responsivity_wide"].values
    moved = np.interp(wavelength - SHIFT, wavelength, own)

    def signal(curve, radiance):
        return np.trapezoid(curve * radiance, wavelength)

    # The calibration was made with the shifted band: its source is seen as it was.
    source = signal(moved, black_body(wavelength, 1400.0)) / signal(own, black_body(wavelength, 1400.0))
    test["signal_wide"].values *= signal(moved, light) / signal(own, light) / source
    for name in ("signal_wide", "signal_narrow"):
        test[name].values *= 1 - LOSS * test[name].values / test[name].values.max()
    library = gas_library("80kW", laboratory.radiation, laboratory.variations, fwhm=SLIT_FWHM)
    with np.errstate(all="ignore"):
        yield fit_base(base_model(record_of(test, BOTH), library, laboratory.calibration, response))


@pytest.mark.parametrize("error", [-80.0, 80.0])
def test_a_fit_comes_back_from_a_wrong_source_temperature(record, response, laboratory, error):
    """Surface and source of the calibration both `error` [K] off, at signals good to 6e-5, lie in a curved
    valley far from its bottom; steps cut to stay in it stop 8 of chi-squared above."""
    library = gas_library("80kW", laboratory.radiation, laboratory.variations, fwhm=SLIT_FWHM)
    with np.errstate(all="ignore"):
        base = fit_base(
            base_model(record_of(record(noise=0.02), BOTH), library, laboratory.calibration, response)
        )
        state, place = base.solution.state, base.model.index["lamp"]
        hot = np.where(state.knots > 500, error * (state.knots / 1773) ** 2, 0.0)
        values = state.values + error * (np.arange(state.values.size) == place)
        found = base.fitter.fit(dataclasses.replace(state, knots=state.knots + hot, values=values))
    assert found.converged
    assert found.objective == pytest.approx(base.solution.objective, abs=SAME_BOTTOM)


def test_both_are_named_where_the_first_alone_leads_to_others(base):
    with np.errstate(all="ignore"):
        found = select(base, CATALOGUE | {"edge1": WHOLE}, draws=300)
    assert found.status in ("named", "named+unknown")  # an edge within its tolerance looks alike
    amplitude = {one.id: one.amplitude for one in found.final.settings}
    # The catalogue's edge moves after the calibration, the hidden one stands in it too: at signals good to
    # 0.06 % the difference may ask for a third name, which then stands with reserve like the others.
    assert {"edge1", "nonlin_p"} <= set(amplitude)
    assert len(amplitude) == 2 or (len(amplitude) == 3 and found.status == "named+unknown")
    # The base model has edges that err as well, by 1 nm; a ratio tells one band's against the other's. 10 %:
    # an effect moves the band after its calibration, the hidden shift and the base model's are in it too.
    wide, narrow = (found.final.state.values[base.model.index[f"edge_{one}"]] for one in ("wide", "narrow"))
    assert amplitude["edge1"] + wide - narrow == pytest.approx(SHIFT * 1e9, rel=0.1)
    assert amplitude["nonlin_p"] == pytest.approx(LOSS, rel=0.2)  # two of its standard errors


@pytest.mark.parametrize(("steps", "rests"), [(3, False), (40, True)])
def test_a_fit_that_gains_next_to_nothing_any_more_is_at_rest(base, steps, rests):
    """Asked for more than rounding allows it takes all its steps; the last ten of forty gain nothing."""
    fitter, start = base.fitter, base.solution.state
    cold = dataclasses.replace(start, knots=start.knots * 0.99)
    assert fitter.fit(cold, (), steps=steps, tolerance=-np.inf).converged is rests


@pytest.mark.parametrize("share", [0.9, 1.05])
def test_a_fit_comes_back_from_a_temperature_far_off(base, share):
    """Ten per cent of it are a factor of five in light. Where damping went from 1e-3 over 4e-5 to none, and
    back to 1e-3 for each step that this spoiled, forty steps stopped 2900 of chi-squared above the bottom;
    without steps back into the valley 6."""
    state = base.solution.state
    found = base.fitter.fit(dataclasses.replace(state, knots=state.knots * share), steps=40)
    assert found.objective < base.solution.objective + NEAR_BOTTOM


@pytest.mark.parametrize(("late", "share"), [("spectrum_time", 1.0), ("time", 0.0)])
def test_the_end_of_the_plasma_tells_which_clock_is_off(record, diagnosis_of, late, share):
    """Screened as one direction, for both hardly differ; the fit begins with either."""
    test = record(frame=0.5, noise=0.5)
    moved = {"spectrum_time": 0.8, "time": -0.8}[late]
    test = test.assign_coords({late: test[late] + moved})
    found = diagnosis_of(test, draws=300).report
    (clock,) = [one for one in found["candidates"] if one["id"] == "clock"]
    assert found["verdict"]["named"] == ["clock"]
    assert abs(clock["amplitude"]) == pytest.approx(0.8, abs=0.05)
    assert clock["shape"].get("spectra", 0.0) == pytest.approx(share, abs=0.1)


@pytest.mark.parametrize(("number", "pull"), [(-0.2, -1.0), (0.3, 1.0)])
def test_a_number_that_would_leave_its_range_waits_at_its_end(number, pull):
    """The others then move as if it were known; cut by itself, it had left them a step made for another."""
    free = [FreeNumber(0, None, 0.0, 1.0, -0.2, 0.3, 1e-3)]
    matrix, state = np.array([[2.0, 1.0], [1.0, 2.0]]), SimpleNamespace(amplitudes=[number])
    step = Fitter._within(matrix, np.array([0.0, pull]), state, 2, free)
    assert step == pytest.approx([0.0, 0.0])
    inwards = Fitter._within(matrix, np.array([0.0, -0.1 * pull]), state, 2, free)
    assert inwards == pytest.approx(np.linalg.solve(matrix, [0.0, -0.1 * pull]))


@pytest.mark.parametrize(
    ("name", "number", "far", "share"),
    [(None, 0.0, 0.6, 0.5), (None, 0.0, -0.8, 0.25), (None, 0.1, 0.1, 1.0), ("lag", 0.0, 0.2, 0.5)],
)
def test_a_step_ends_at_the_first_bound_and_moves_shapes_by_a_tenth(base, name, number, far, share):
    free = [FreeNumber(0, name, 0.0, 1.0, -0.2, 0.3, 1e-3)]
    size = base.model.size + len(base.model.parameters)
    step, state = np.append(np.zeros(size), far), SimpleNamespace(amplitudes=[number])
    assert base.fitter._limit(step, state, size + 1, free) == pytest.approx(share)


class Scripted(Fitter):
    """A fit whose weights take back what its steps gain: objectives where it stands, one after the other."""

    def __init__(self, objectives):
        self.objectives = iter(objectives)

    def _at(self, state, settings):
        return SimpleNamespace(objective=next(self.objectives))

    def _tried(self, state, settings, here, damping, climb):
        return state + 1, here.objective - 1, 0.0, True

    def _solution(self, state, settings, here, converged):
        return state, here.objective, converged


def test_a_fit_that_weights_drive_away_ends_where_it_was_best():
    """Noise grows with the light that is predicted: one base fit stood at 18107 and ended at 2445266."""
    assert Scripted([10.0, 5.0, 7.0, 8.0, 9.0, 50.0, 80.0]).fit(0) == (1, 5.0, True)
