from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.constants import FIRST_RADIATION, SECOND_RADIATION
from plasmapyro.diagnosis.command import LIMITS
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE, of_one_spot, without
from plasmapyro.diagnosis.effects.condition import OF_CONDITION
from plasmapyro.diagnosis.effects.effect import BOTH, ORDER, PHASES, REGISTER, effect
from plasmapyro.diagnosis.effects.gas import LINES
from plasmapyro.diagnosis.effects.scene import Output
from plasmapyro.diagnosis.fit.observation import highest_of
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.report.kelvin import paper_temperature
from plasmapyro.experiment.correction import Reading
from plasmapyro.radiation.planck import planck
from plasmapyro.record.record import Record

BAND_RTOL = 2e-3  # of a formula for an infinitely narrow band, applied to a node of 6 nm
LEVEL_RTOL = 0.01  # errors of the faintest channels count from the mean light
IDS = (
    "refl eps_slope eps_T eps_ox winD winE winD_sl winE_sl off1 off2 off_s torchglow nonlin_p nonlin_s phi"
    " edge1 edge2 resp_long wshift lsf stray second P_eff T_exc T_vib ripple selfabs contin gas_drift bl"
    " afterglow particles NaK CaII CN Cu Ar h2o o2a grad edge_p edge_s clock scat"
).split()


@pytest.fixture(scope="module")
def state(model):
    knots = np.interp(model.history.knots, [0, 20, 120, 150], [350, 1200, 1500, 1150])
    return knots, np.array([p.centre for p in model.parameters])


def seen(model, state, which, identity, amplitude, **shape):
    entry = CATALOGUE[identity]
    return model.evaluate(which, *state, (Setting(entry, amplitude, shape or dict(entry.shapes[0])),))


def test_the_catalogue_covers_every_stage_instrument_and_phase():
    assert set(IDS) <= set(CATALOGUE)
    entries = CATALOGUE.values()
    assert set(REGISTER) == {*CATALOGUE, *OF_CONDITION, LINES}
    assert all(set(row["alike"].split()) <= set(CATALOGUE) for row in REGISTER.values())
    assert {entry.stage for entry in entries} == set(ORDER)
    assert {kind for entry in entries for kind in entry.instruments} == set(BOTH)
    assert {phase for entry in entries for phase in entry.phases} == set(PHASES)
    for entry in entries:
        assert entry.sigma > 0 and entry.bounds[0] <= 0 < entry.bounds[1]
        assert sum(formula is not None for formula in (entry.light, entry.output, entry.clock)) == 1


@pytest.mark.parametrize("identity", list(CATALOGUE))
def test_amplitude_zero_is_the_base_model_to_the_last_bit(model, state, identity):
    for which in range(2):
        plain = model.evaluate(which, *state)
        for shape in CATALOGUE[identity].shapes:
            assert np.array_equal(seen(model, state, which, identity, 0.0, **shape), plain)


@pytest.mark.parametrize("join", [1, 3, 40])
def test_what_pixels_do_is_counted_the_same_however_they_are_joined(join):
    """Against what happens in the pixels: a bright line alone in its bins, many dark pixels in one."""
    rate = 5.0 + 100 * np.exp(-((np.arange(240) - 100.0) ** 2) / 200)
    edges = np.unique([*range(0, 80, join), *range(80, 121), *range(121, 240, join), 240])
    pixels = np.diff(edges)

    def joined(pixel):
        return np.add.reduceat(pixel, edges[:-1]) / pixels

    factor = np.full(pixels.size, 2.0)
    seen = (joined(rate) * factor)[None]
    output = Output("spectrometer", np.zeros(1), 1.0, seen, factor, seen[0], highest_of(rate[None]), pixels)
    truth = {
        "off_s": rate + 0.1 * rate.mean(),
        "stray": 0.9 * rate + 0.1 * rate.mean(),
        "nonlin_s": rate * (1 - 0.1 * rate / rate.max()),
    }
    for identity, pixel in truth.items():
        found = CATALOGUE[identity].output(output, 0.1)[0]
        assert found == pytest.approx(joined(pixel) * factor, rel=2e-3)  # a joined bin varies


@pytest.mark.parametrize("identity", ["off1", "off2", "off_s"])
def test_what_counts_in_units_of_the_gas_counts_in_those_of_the_measured_one(model, state, identity):
    """The same share of a gas half as bright again as simulated is half as large again."""
    (which,) = [i for i, one in enumerate(model.instruments) if one.kind in CATALOGUE[identity].instruments]
    fault = (Setting(CATALOGUE[identity], 0.1, {}),)

    def shown(error, **of_level):
        plain = model.evaluate(which, *state, gas_error=error)
        return model.evaluate(which, *state, fault, gas_error=error, **of_level) - plain

    none = np.zeros(model.instruments[which].channels)
    np.testing.assert_allclose(shown(none + 0.5), 1.5 * shown(none), rtol=LEVEL_RTOL)
    np.testing.assert_allclose(shown(none + 0.5, level_error=none), shown(none), rtol=1e-6)


def test_one_hit_is_not_the_largest_count_of_a_test():
    rates = np.full((9, 5), 10.0) + np.arange(9)[:, None]
    rates[4, 2], rates[6] = 900.0, np.nan
    assert highest_of(rates) == pytest.approx(17.0)  # of 18 in the last bin, whose neighbour has 17


def test_mixing_cools_with_the_square_of_its_length(model, state):
    """Computed flows at 80 kW: 0.03 takes 11 % of the light, 0.06 39 %; ours is made for 60 to 110 kW."""
    mixing = OF_CONDITION["mixing"]
    plain, half, whole = (model.evaluate(1, *state, (Setting(mixing, a, {}),)) for a in (0.0, 0.03, 0.06))
    assert np.array_equal(plain, model.evaluate(1, *state))
    gas = model.instruments[1].moment.mean(axis=1) < 0  # before the injection there is nothing but gas
    ratio = np.log((half / plain)[gas].mean()) / np.log((whole / plain)[gas].mean())
    assert (whole < plain)[gas].all() and ratio == pytest.approx(0.25, abs=0.02)


@pytest.mark.parametrize("identity", list(CATALOGUE))
def test_a_term_touches_the_instruments_it_names_and_no_other(model, state, identity):
    entry = CATALOGUE[identity]
    for which, one in enumerate(model.instruments):
        changed = seen(model, state, which, identity, entry.sigma) != model.evaluate(which, *state)
        assert changed.any() == (one.kind in entry.instruments)


@pytest.mark.parametrize(
    "identity", ["winD", "winE", "off1", "off_s", "particles", "contin", "Cu", "refl", "afterglow"]
)
def test_what_adds_or_takes_light_in_proportion_is_linear(model, state, identity):
    for which in range(2):
        plain = model.evaluate(which, *state)
        one = seen(model, state, which, identity, 0.01) - plain
        two = seen(model, state, which, identity, 0.02) - plain
        assert np.allclose(two, 2 * one, rtol=1e-6, atol=1e-9 * np.abs(plain).max())


def test_an_error_of_the_ratio_shifts_the_inverse_temperature_by_a_constant():
    """Two narrow bands in the Wien limit: 1/T' - 1/T = -d / [c2 (1/l1 - 1/l2)]."""
    first, second, error, c2 = 0.85e-6, 1.0e-6, 0.02, 1.438776877e-2
    temperature = np.array([1310.0, 1350.0, 1390.0])
    points = np.linspace(1250.0, 1450.0, 201)  # over so few kelvin a parabola is good

    def ratio(kelvin):
        return np.exp(-c2 / kelvin * (1 / first - 1 / second))

    parabola = np.polynomial.polynomial.polyfit((points - 1350) / 100, ratio(points), 2)
    reading = Reading(parabola, np.array([1250.0, 1450.0]), np.array([1200.0, 1500.0]), 1.0, **LIMITS)
    signals = np.stack([ratio(temperature) * np.exp(error), np.ones(3)], axis=1)
    cooling = Record(0.0, 300.0, (1.0, 2.0), 0.85, 0.05, 1.0, 0.0, ())
    nothing = np.zeros(2), np.zeros(2)
    found, _ = paper_temperature(signals, np.array([400.0, 410.0, 420.0]), cooling, reading, nothing)
    expected = 1 / (1 / temperature - error / (c2 * (1 / first - 1 / second)))
    np.testing.assert_allclose(found, expected, rtol=5e-5)  # what the cubic leaves of a shift of 15 K


def test_the_term_of_the_ratio_multiplies_the_wide_band_only(model, state):
    change = seen(model, state, 0, "phi", 0.02) / model.evaluate(0, *state)
    assert np.allclose(change, [np.exp(0.02), 1.0], rtol=1e-12)


def test_a_window_loses_what_it_says_at_the_end_and_keeps_it(model, state):
    one = model.instruments[1]
    change = seen(model, state, 1, "winE", 0.1) / model.evaluate(1, *state)
    late = one.moment[:, 0] > model.off
    assert np.allclose(change[late], 0.9, rtol=1e-12)
    assert np.allclose(change[one.moment[:, 1] < 0], 1.0)


def test_a_clock_shift_is_the_slope_in_time(model, state):
    one = model.instruments[0]
    step = 0.02
    late = one.moment.mean(axis=1) > model.off + 5  # no gas, smooth cooling
    change = np.log(seen(model, state, 0, "clock", step) / model.evaluate(0, *state))[late, 0]
    level = np.log(model.evaluate(0, *state)[late, 0])
    slope = np.gradient(level, one.moment.mean(axis=1)[late])
    assert np.allclose(change[1:-1], step * slope[1:-1], rtol=0.1)


def test_the_gas_ends_on_the_clock_of_the_pyrometer(model, state):
    """Signals of a clock by which all happens 1 s too early: behind the last second no gas is left in them,
    and a bin of which it takes a part has the rest of the gas."""
    one = model.instruments[0]
    begin, finish = (one.time + sign * np.sqrt(3) * one.moment.std(axis=1) for sign in (-1, 1))
    late, cold = 1.0, np.full(model.size, 250.0)
    dark = seen(model, (cold, state[1]), 0, "clock", late) / model.evaluate(0, cold, state[1])
    inside = (one.time > 5) & (one.time < model.off)
    kept = np.clip((model.off - late - begin) / (finish - begin), 0, 1)[inside]
    assert (kept == 0).any() and (kept == 1).any()
    np.testing.assert_allclose(dark[inside], np.repeat(kept[:, None], 2, axis=1), atol=1e-9)


def test_spectra_that_are_late_leave_the_pyrometer_and_its_end_where_they_are(model, state):
    one = model.instruments[1]
    assert np.array_equal(seen(model, state, 0, "clock", 1.0, spectra=1.0), model.evaluate(0, *state))
    late = one.moment.mean(axis=1) > model.off + 5
    changed = seen(model, state, 1, "clock", 0.02, spectra=1.0)
    change = np.log(changed / model.evaluate(1, *state))[late, 0]
    slope = np.gradient(np.log(model.evaluate(1, *state)[late, 0]), one.moment.mean(axis=1)[late])
    assert np.allclose(change[1:-1], -0.02 * slope[1:-1], rtol=0.1)


@pytest.mark.parametrize(("sigma", "profile", "rtol"), [(60.0, 2.0, 1e-7), (150.0, 0.0, 2e-4)])
def test_a_gradient_over_the_spot_is_the_mean_over_a_disc(model, state, sigma, profile, rtol):
    """Against the black body summed over a disc with a temperature that rises evenly across it.

    What is left is of the sixth order: (x s)^6 5 / 720 less what the rule has of it, x = 10, s = 0.02, 0.09.
    """
    knots, values = np.full(model.size, 1600.0), state[1]
    late = model.instruments[1].moment.mean(axis=1) > model.off + 2
    across = np.linspace(-1, 1, 20001)
    chord = np.sqrt(1 - across**2)  # whose variance over the disc is a quarter
    wavelength = model.instruments[1].wavelength
    own = sigma * (10 / 14) ** profile
    mean = chord @ planck(wavelength, 1600.0 + 2 * own * across) / chord.sum()
    plain = model.evaluate(1, knots, values)
    setting = Setting(CATALOGUE["grad"], sigma, {"exponent": 1.0, "profile": profile})
    found = model.evaluate(1, knots, values, (setting,)) / plain
    assert np.allclose(found[late][0], mean / planck(wavelength, np.array([1600.0]))[0], rtol=rtol)


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0])
def test_a_cover_follows_the_sample_as_a_body_with_a_dead_time_and_a_time_constant(delay):
    """Temperature T of a sample that heats as 1 - exp(-t/s): the cover solves dT'/dt = (T(t - a) - T')/b."""
    slow, lag, time = 30.0, 6.0, np.array([10.0, 20.0, 60.0])
    scene = SimpleNamespace(
        time=time[:, None] + [0.0, 0.0],
        wavelength=np.array([0.95e-6]),
        injected=np.ones((3, 2)),
        glow=np.zeros((3, 2, 1)),
        history=lambda moment: 350.0 - 1000.0 * np.expm1(-moment / slow),
        but=lambda **changed: changed["glow"],
    )
    seen = CATALOGUE["edge_p"].light(scene, 1.0, ratio=0.8, lag=lag, delay=delay)
    later, own = time - delay * lag, max((1 - delay) * lag, 1e-9)
    rise = 1 - (slow * np.exp(-later / slow) - own * np.exp(-later / own)) / (slow - own)
    found = SECOND_RADIATION / (0.95e-6 * np.log1p(FIRST_RADIATION / (0.95e-6**5 * seen[:, 0, 0])))
    assert np.allclose(found, 350.0 + 0.8 * 1000.0 * rise, atol=10.0)  # [K], of the quadrature's four points


def test_a_catalogue_without_some_effects_refuses_those_it_does_not_know():
    assert set(CATALOGUE) - set(without(CATALOGUE, ["winE", "phi"])) == {"winE", "phi"}
    with pytest.raises(ValueError, match="'gremlins', to be left out, is no effect"):
        without(CATALOGUE, ["gremlins"])


def test_one_spot_does_not_tell_how_a_gradient_is_shaped(model, state):
    """What a bowl does to the spectrometer's spot, 10 of 14 mm across, a weaker slope does as well."""
    alone = of_one_spot(CATALOGUE)
    assert alone["grad"].shapes == ({"exponent": 0.0}, {"exponent": 1.0})
    assert set(alone["grad"].shape_bounds) == {"exponent"}
    assert all(alone[one] is CATALOGUE[one] for one in set(CATALOGUE) - {"grad"})
    bowl = seen(model, state, 1, "grad", 70.0, exponent=0.0, profile=2.0)
    slope = model.evaluate(1, *state, (Setting(alone["grad"], 50.0, {"exponent": 0.0}),))
    assert slope == pytest.approx(bowl, rel=1e-12)
    assert "grad" not in of_one_spot(without(CATALOGUE, {"grad"}))


def test_nobody_changes_the_catalogue_in_place():
    with pytest.raises(TypeError):
        CATALOGUE["winE"] = None


def test_a_declaration_of_an_effect_without_a_row_is_refused():
    with pytest.raises(KeyError, match="eps_slop"):
        effect("eps_slop")(None)


def test_the_dark_of_the_base_model_drifts_by_counts_of_all_pixels(model):
    knots = np.interp(model.history.knots, [0, 20, 120, 150], [350, 1200, 1500, 1150])
    values = np.array([parameter.centre for parameter in model.parameters])
    moved = values.copy()
    moved[model.index["dark_drift"]] = 3.0
    for which, one in enumerate(model.instruments):
        added = model.evaluate(which, knots, moved) - model.evaluate(which, knots, values)
        if one.kind == "pyrometer":
            assert not added.any()
            continue
        counts = added / one.factor
        assert counts == pytest.approx(np.broadcast_to(counts[:, :1], counts.shape), abs=1e-6)
        assert np.polyfit(one.time, counts[:, 0], 1)[0] * np.ptp(one.time) == pytest.approx(3.0, rel=0.05)
        assert 0 <= counts.min() < 0.1 and 2.9 < counts.max() <= 3.0001


def test_the_dark_of_the_base_model_wanders_between_its_ends(model):
    knots = np.interp(model.history.knots, [0, 20, 120, 150], [350, 1200, 1500, 1150])
    values = np.array([parameter.centre for parameter in model.parameters])
    which = next(place for place, one in enumerate(model.instruments) if one.kind == "spectrometer")
    one, moved = model.instruments[which], values.copy()
    moved[model.index["dark_walk_2"]] = 0.5
    counts = (model.evaluate(which, knots, moved) - model.evaluate(which, knots, values)) / one.factor
    expected = 0.5 * np.sin(2 * np.pi * model.progress(which))
    assert counts == pytest.approx(np.broadcast_to(expected[:, None], counts.shape), abs=1e-6)
    sigma = [one.sigma for one in model.parameters if one.id.startswith("dark_walk")]
    walks = np.cumsum(np.random.default_rng(2).standard_normal((4000, 500)), axis=1) / np.sqrt(500)
    share = np.arange(1, 501) / 500
    bridge = 0.5 * (walks - walks[:, -1:] * share)
    found = [2 * np.std((bridge * np.sin(mode * np.pi * share)).mean(axis=1)) for mode in (1, 2, 3, 4)]
    assert sigma == pytest.approx(found, rel=0.05)  # 4000 walks: 1.1 %
