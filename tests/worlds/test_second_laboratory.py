"""Samples, instruments, faults and sizes of the second laboratory, with an invented gas."""

import copy
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from scipy import constants
from scipy.integrate import quad
from two_bands import RESPONSE
from worlds import case, engine, faults, laboratory, sample
from worlds.faults import EFFECTS
from worlds.measure import Measure, within_stated

from plasmapyro.record.emittance import tilt

RESPONSES = "responsivity_wide", "responsivity_narrow"


@pytest.fixture(scope="module")
def stage():
    bench = case.Bench(RESPONSE, {80e3: None}, [80e3], 35.0, [None], [5000.0], [laboratory.draw(5)])
    body = dict(kind="lumped", emittance=0.85, flux=4e5, rise=1.0, recovery=5000.0, depth=3e-3,
                conductivity=50.0, capacity=2.5e6, contact=40.0, recession=0.0)  # fmt: skip
    base = case.Base(1, 0, 0, "80kW", 8e4, 5e3, 35.0, body, 0.85, 1.3, 0.01, 0.001, 150.0, 180.0, 0.0, 0.0)
    made = case.Stage(bench, base)
    lab = laboratory.draw(5).__dict__ | {"has_pyrometer": True, "has_spectrometer": True, "exposure": 0.8}
    lab |= {"pixels": 500, "period": 1.0, "pyrometer_rate": 10.0, "fwhm": 1e-9}
    made.__dict__["lab"] = laboratory.Laboratory(**lab)
    lines = faults.peaks([777.5, 844.9, 868.3, 926.8, 1011.0], [3, 2, 3, 2, 2], 0.05e-9)
    smooth = np.exp(-(((engine.CENTRES - 1.0e-6) / 0.15e-6) ** 2))
    made.__dict__["components"] = np.array(
        [5e-3 * lines, 5e-3 * lines[::-1], 2e7 * smooth, 5e6 * smooth, 1e6 * smooth, 1e6 + 0 * smooth]
    )
    made.__dict__["strengths"] = lambda faint: ()
    tilt = (engine.CENTRES / 0.85e-6) ** 3
    made.__dict__["variant"] = lambda kind, a: made.components.sum(axis=0) * (1 + a * tilt * (1 + len(kind)))
    return made


@pytest.fixture(scope="module")
def measure(stage):
    return Measure(stage)


def test_a_lumped_body_ends_where_heat_and_radiation_balance():
    body = sample.Sample("lumped", 0.8, 3e5, 0.5, 5000.0, 2e-3, 50.0, 2.5e6, 0.0, 0.0)
    last = body.history(np.array([249.0]), 250.0)[0]
    gain = 3e5 * (1 - last / 5000.0)
    assert gain == pytest.approx(0.8 * 5.670374e-8 * (last**4 - 300.0**4), rel=1e-4)


def test_a_thick_body_warms_as_the_root_of_time():
    body = sample.Sample("ablating", 0.01, 1e5, 1e-3, 1e9, 0.1, 1.0, 1e6, 0.0, 0.0, start=300.0)
    rise = body.history(np.array([4.0, 9.0, 16.0]), 100.0) - 300.0
    expected = 2e5 * np.sqrt(np.array([4.0, 9.0, 16.0]) / (np.pi * 1.0 * 1e6))  # Carslaw and Jaeger, 2.9
    np.testing.assert_allclose(rise, expected, rtol=0.025)  # cells of tenths of a millimetre


def test_a_thick_body_cools_fast_at_first():
    random = np.random.default_rng(3)
    ablator, lump = (sample.draw(random, kind) for kind in ("ablating", "lumped"))
    drops = [body.history(np.array([149.9, 150.5]), 150.0) for body in (ablator, lump)]
    assert drops[0][0] - drops[0][1] > 4 * (drops[1][0] - drops[1][1]) > 0


@pytest.mark.parametrize("kind", sample.KINDS)
def test_samples_reach_temperatures_that_pyrometers_read(kind):
    last = [
        sample.draw(np.random.default_rng(s), kind).history(np.array([290.0]), 295.0)[0] for s in range(8)
    ]
    assert 800 < min(last) and max(last) < 2050


def test_an_exposure_is_the_mean_of_its_light(stage):
    time = stage.scene.time
    ramp = np.column_stack([time, 3 - 0.5 * time])
    inside = stage.record.middles + stage.lab.exposure / 2 <= time[-1]
    np.testing.assert_allclose(
        stage.record.mean(time, ramp)[inside, 0], stage.record.middles[inside], atol=1e-9
    )


def test_frames_that_are_late_see_what_is_there_then(stage):
    time, late = stage.scene.time, np.linspace(-0.02, 0.02, stage.record.middles.size)
    np.testing.assert_allclose(
        stage.record.mean(time, time[:, None], late)[:, 0], stage.record.middles + late, atol=1e-9
    )


def test_an_emittance_that_falls_over_wavelength_is_larger_in_the_wide_band(stage):
    """The files of the package have its law too: 1 + b (wavelength - 0.95 um)."""
    sloped = case.Stage(stage.bench, replace(stage.base, slope=-0.2, slope_error=0.01))
    sloped.__dict__ |= {name: stage.__dict__[name] for name in ("lab", "components")}
    surface = sloped.scene.surface["p"][60] / stage.scene.surface["p"][60]
    near = np.argmin(np.abs(laboratory.SMOOTH - 1.05e-6))
    assert surface[near] == pytest.approx(0.98, abs=2e-3)  # the windows glow a little
    law = xr.Dataset(
        {name: ("wavelength", row) for name, row in zip(RESPONSES, sloped.scene.bands, strict=True)},
        {"wavelength": laboratory.SMOOTH},
    )
    assert tilt(sloped.colour_ratio(), law) == pytest.approx(-0.2e6, rel=1e-3)
    stated = sloped.test([]).attrs["emittance_slope"]
    assert stated == pytest.approx(1.01 * sloped.colour_ratio()) and sloped.colour_ratio() > 1.02


def test_gains_of_bands_flicker_apart(stage):
    """Of a sample that stands still the ratio of the bands scatters by what it is told to, over seconds."""
    lab = replace(stage.lab, noise=0.0, jitter=0.0, wander=(0.0, 0.0, 0.0), bits=40, gain_flicker=2e-3)
    record = laboratory.Record(lab, stage.scene, 3, 0.0)
    test = record.dataset(stage.scene, stage.scene, {})
    ratio = np.log(test.signal_wide.values / test.signal_narrow.values)[(test.time > 130) & (test.time < 149)]
    means = ratio[: ratio.size // 10 * 10].reshape(-1, 10).mean(axis=1)
    assert 5e-4 < np.std(np.diff(means)) / np.sqrt(2) < 4e-3


def test_a_slit_keeps_the_light_of_a_line():
    line = faults.peaks([850.0], [1.0])
    wavelength = np.arange(840, 860, 0.01) * 1e-9
    seen = laboratory.through_slit(line, wavelength, 1e-9)
    assert np.trapezoid(seen, wavelength) == pytest.approx(1.0, rel=1e-3)
    above = wavelength[seen > seen.max() / 2]
    assert np.ptp(above) == pytest.approx(1.0e-9, rel=0.03)


def test_calibration_repeats_the_black_body(stage):
    points, counts = laboratory.calibrate(stage.lab, RESPONSE)
    bands = laboratory.true_bands(stage.lab, RESPONSE)
    light = 0.995 * laboratory.planck(laboratory.SMOOTH, 1773.0 + stage.lab.source_bias)
    expected = (bands @ light * 1e-9 * laboratory.gains(stage.lab))[:, None]
    found = np.array([[points.signal_wide.values[-1]], [points.signal_narrow.values[-1]]])
    np.testing.assert_allclose(found, expected, rtol=0.02)  # 0.2 % noise, and the set point is 1773 K
    assert 0.5 < counts.calibration_counts.values.max() / laboratory.FULL < 0.95


ONE = dict.fromkeys("off1 off2 nonlin_p phi edge1 edge2 resp_long winD winD_sl edge_p clock".split(), "p")
ONE |= dict.fromkeys("off_s nonlin_s wshift lsf stray second winE winE_sl edge_s".split(), "s")


@pytest.mark.parametrize("name", EFFECTS)
def test_effects_vanish_at_nothing_and_touch_only_what_they_say(stage, measure, name):
    entry = EFFECTS[name]
    shape = {key: sum(limits) / 2 for key, limits in entry.shape.items()}

    def change(amplitude):
        scene = stage.hidden([{"effect": name, "amplitude": amplitude, "shape": shape}])
        return [new - old for new, old in zip(measure.output(scene), measure.reference, strict=True)]

    still, moved = change(0.0), change(entry.unit)
    scale = [np.abs(part).max() for part in measure.reference]
    assert (
        all(np.abs(part).max() < 1e-9 * s for part, s in zip(still, scale, strict=True))
        or name == "arc_restart"
    )
    changed = {who for who, part, s in zip("ps", moved, scale, strict=True) if np.abs(part).max() > 1e-12 * s}
    assert changed
    assert changed <= set(entry.truth[0] if entry.truth else ONE.get(name, "ps"))


def test_there_are_at_least_twenty_faults_of_every_axis_and_each_has_its_reason():
    assert len(faults.OUTSIDE) >= 20 and len(faults.CATALOGUE) == 43
    assert {EFFECTS[name].truth[1] for name in faults.OUTSIDE} == {
        "time",
        "wavelength",
        "temperature",
        "signal",
    }
    rows = {row["effect"]: row for row in faults.table("effects")}
    assert all(len(rows[name]["reason"]) > 20 for name in faults.OUTSIDE)


def test_what_an_analysis_must_leave_free_is_no_signal(stage, measure):
    warmer = 5.0 * np.exp(-(((stage.scene.time - 80) / 30) ** 2))
    more = stage.scene.emittance * (
        laboratory.planck(laboratory.SMOOTH, (stage.scene.kelvin + warmer)[:, None])
        - laboratory.planck(laboratory.SMOOTH, stage.scene.kelvin[:, None])
    )
    scene = stage.scene.copy(surface={one: light + more for one, light in stage.scene.surface.items()})
    change = measure._difference(scene)
    rows, root = measure.nuisance(False)
    vector = measure.flat(change, False)
    share = np.linalg.solve(root.T, np.linalg.solve(root, rows @ vector))
    left = np.concatenate([vector - share @ rows, share])
    assert np.linalg.norm(left) < 0.1 * np.linalg.norm(vector)


def test_noise_that_the_laboratory_draws_is_no_signal(stage, monkeypatch):
    # Numbers of unit variance, one per pixel or knot: what is left of so many is no longer than their root.
    # One scan of the lamp and the dark, and gains that wander by 3 %, make them larger than all other noise.
    monkeypatch.setattr(laboratory, "LAMPS", 1)
    monkeypatch.setattr(laboratory, "DARKS", 1)
    restless = copy.copy(stage)
    restless.__dict__.pop("record", None)
    restless.__dict__["lab"] = lab = replace(stage.lab, wander=(0.03, 0.03, 0.03), pointing=1e-4)
    measure, random = Measure(restless), np.random.default_rng(4)
    (signals, rates), (first, _) = measure.reference, measure.times
    rows, root = measure.nuisance(False)
    lamp, dark = (measure._of_mean(one(lab)) for one in (laboratory.lamp_noise, laboratory.dark_noise))
    wide, knots = rates.shape[1], 8 * np.ptp(first) / np.array([laboratory.TOGETHER, laboratory.APART])
    together, apart = (
        signals * laboratory._wander(random, first, memory, 0.03)
        for memory in (laboratory.TOGETHER, laboratory.APART)
    )
    errors = {
        "lamp": (0 * signals, lamp * rates * random.normal(size=wide), wide),
        "dark": (0 * signals, dark * random.normal(size=wide) / lab.exposure + 0 * rates, wide),
        "together": (together, 0 * rates, knots[0]),
        "apart": (apart * [[0.5], [-0.5]], 0 * rates, knots[1]),
    }
    for name, (one, two, count) in errors.items():
        vector = measure.flat([10 * one, 10 * two], False)
        share = np.linalg.solve(root.T, np.linalg.solve(root, rows @ vector))
        assert np.linalg.norm(np.concatenate([vector - share @ rows, share])) < 10 * np.sqrt(1.3 * count), (
            name
        )


@pytest.mark.parametrize(("name", "amplitude"), [("wshift", 0.02), ("lsf", 0.102), ("contin", 0.2)])
def test_what_a_simulation_must_state_of_itself_is_free(stage, measure, name, amplitude):
    # A scale a kelvin off, a slit of 1.029 nm that is stated as 1.0 nm, a fifth more continuum.
    scene = stage.hidden([{"effect": name, "amplitude": amplitude}])
    changed, rows = measure.flat(measure._difference(scene), True), measure.nuisance(True)[0]
    assert np.linalg.norm(rows - changed, axis=1).min() < 0.03 * np.linalg.norm(changed)


def test_a_scale_that_is_off_costs_no_more_than_its_steps(measure):
    vector = np.full(400, 100.0)
    moved, wider, other = (
        np.linalg.norm(within_stated(vector, [{"effect": name, "amplitude": 0.2}], 1e-9))
        for name in ("wshift", "lsf", "contin")
    )
    assert (moved, other) == (pytest.approx(10.0), pytest.approx(2000.0))
    assert wider == pytest.approx((np.hypot(1, 2.3548 * 0.2) - 1) / 0.029, rel=1e-4)


def test_light_of_the_gas_is_seen_as_in_a_scene_of_its_own(stage, measure):
    (_, amplitude, _), light = stage.scene.gas[0], 0.1 * stage.components[2]
    whole = measure._difference(stage.scene.copy(gas=[*stage.scene.gas, ("ps", amplitude, light)]))
    for direct, one in zip(measure._glow(light), whole, strict=True):
        np.testing.assert_allclose(direct, one, rtol=1e-6, atol=1e-9 * np.abs(one).max())


def test_a_gas_of_another_shape_is_no_signal(stage, measure):
    (whom, amplitude, light), *_ = stage.scene.gas
    bent = light * (1 + 0.1 * np.sin(engine.CENTRES / 9e-9))
    change = measure._difference(stage.scene.copy(gas=[(whom, amplitude, bent)]))
    free, simulated = (np.linalg.norm(measure.flat(change, gas)) for gas in (False, True))
    assert free < 0.5 * simulated  # 13 standard deviations in all, of which the prior of 30 % takes most


def test_photons_scatter_as_their_number(stage):
    random = np.random.default_rng(1)
    rate = np.full((400, stage.lab.pixels), 2e4)
    counts = laboratory.expose(stage.lab, rate, 1.0, random)
    dark, bias = laboratory.detector_pattern(stage.lab)
    expected = (2e4 + dark) / stage.lab.electrons + stage.lab.read_noise**2
    assert np.mean(counts.var(axis=0) / expected) == pytest.approx(1.0, rel=0.02)
    np.testing.assert_allclose(counts.mean(axis=0) - bias - dark, 2e4, rtol=0.01)


@pytest.mark.parametrize(
    ("name", "shape"), [("eps_ox", {"tau_s": 40.0}), ("winE", {}), ("off_s", {}), ("grad", {"share": 0.5})]
)
def test_a_hidden_effect_has_the_size_it_was_asked_for(measure, name, shape):
    made = measure.sized(name, 15.0, 1, shape)
    assert measure.signature([made])[1] == pytest.approx(15.0, rel=0.05)


@pytest.mark.parametrize(("who", "share"), [("p", 1.0), ("s", 0.5)])
def test_unequal_temperatures_shine_as_their_mean_over_equal_areas(stage, who, share):
    """Against an adaptive integral of Planck's law, with the constants of CODATA, over a uniform law."""
    plain, sigma = stage.scene, 100.0
    patchy = stage.hidden([{"effect": "grad", "amplitude": sigma, "shape": {"share": 0.5}}])
    at = int(np.argmax(plain.kelvin * (plain.seen > 0.99)))
    kelvin, apart = float(plain.kelvin[at]), np.sqrt(3 * share) * sigma
    c2 = constants.h * constants.c / constants.k
    assert patchy.kelvin[at] == kelvin
    for place in (0, laboratory.SMOOTH.size // 2, -1):
        x = c2 / laboratory.SMOOTH[place]
        mean = quad(lambda t, x=x: 1 / np.expm1(x / t), kelvin - apart, kelvin + apart)[0] / (2 * apart)
        more = mean * np.expm1(x / kelvin) - 1
        body = np.broadcast_to(plain.emittance, patchy.surface[who].shape)[at, place]
        body = body * laboratory.planck(laboratory.SMOOTH, np.array([[kelvin]]))[0, place] * plain.seen[at]
        added = patchy.surface[who][at, place] - plain.surface[who][at, place]
        assert added / body == pytest.approx(more, rel=1e-4)  # seven points; digits of c2 in the laboratory


def test_alike_effects_are_close_and_others_far(measure):
    assert measure.angle("winE", "winE", {}) < 1e-3
    assert measure.angle("winE", "clock", {}) > 45


def test_recorded_tests_keep_the_contract_and_repeat(stage):
    from plasmapyro import contracts

    first, again = stage.test([]), stage.test([])
    assert contracts.check(contracts.label(first, "test"), "test") is not None
    np.testing.assert_array_equal(first.counts.values, again.counts.values)
    assert (
        1.2
        < float(
            first.signal_wide[first.time < -1].mean()
            / first.signal_wide[(first.time > 0.2) & (first.time < 0.8)].mean()
        )
        < 1.4
    )


def test_everything_drawn_follows_from_the_seed():
    assert laboratory.draw(3) == laboratory.draw(3) != laboratory.draw(4)
    labs = [laboratory.draw(seed) for seed in range(60)]
    assert min(lab.pyrometer_rate for lab in labs) < 4 and max(lab.pyrometer_rate for lab in labs) > 250
    assert any(not lab.has_spectrometer for lab in labs) and any(not lab.has_pyrometer for lab in labs)
    assert all(lab.fwhm >= 1.4 * (lab.last - lab.first) / lab.pixels for lab in labs)


def test_amplitudes_have_the_signs_of_the_catalogue(stage, measure):
    # The pyrometer's record shows later light with a positive clock; lines stand where the scale is too high.
    def change(name, amplitude):
        scene = stage.hidden([{"effect": name, "amplitude": amplitude}])
        return [new - old for new, old in zip(measure.output(scene), measure.reference, strict=True)]

    warming, cooling = (np.abs(measure.times[0] - at).argmin() for at in (10.0, 160.0))
    late = change("clock", 0.5)[0]
    assert np.all(late[:, warming] > 0) and np.all(late[:, cooling] < 0)
    assert np.all(change("winD", 0.1)[0][:, cooling] < 0) and np.all(change("phi", 0.1)[0][0] > 0)
    pixels = stage.lab.wavelength
    moved = stage.record.rates(stage.hidden([{"effect": "wshift", "amplitude": 0.3}]))[2]
    plain = stage.record.rates(stage.scene)[2]
    near = np.abs(pixels - 844.9e-9) < 3e-9
    centre = [np.average(pixels[near], weights=rate[near]) for rate in (plain, moved)]
    assert centre[1] < centre[0]
