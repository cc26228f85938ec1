"""A gas that is measured: the names of all else do not depend on what the simulation says of it, and the
simulation is told where it differs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy.linalg import cho_solve
from small_laboratory import OFF, error_modes, gas_components, temperature_of

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.effects.condition import OF_FLOW
from plasmapyro.diagnosis.effects.gas import lines_of
from plasmapyro.diagnosis.fit import first_gas
from plasmapyro.diagnosis.fit.base import fit_base
from plasmapyro.diagnosis.fit.build import base_model
from plasmapyro.diagnosis.fit.normal import own_patterns
from plasmapyro.diagnosis.fit.setting import Setting, numbers_of
from plasmapyro.diagnosis.fit.slit import SeenSlit
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.diagnosis.gas.templates import WARMTH_OF_POWER
from plasmapyro.diagnosis.report.findings import gas_is_likelier
from plasmapyro.diagnosis.report.foreign import line_pattern
from plasmapyro.diagnosis.report.simulation import power_sentences, slit_sentences
from plasmapyro.diagnosis.select.selection import select
from plasmapyro.diagnosis.simulation import compare as compare_module
from plasmapyro.diagnosis.simulation import errors as errors_module
from plasmapyro.diagnosis.simulation.compare import (
    SYSTEM,
    Comparison,
    admissible,
    anywhere,
    compare,
)
from plasmapyro.diagnosis.simulation.errors import raise_errors, spectroscopy
from plasmapyro.diagnosis.simulation.fitter import Fit, Fitter, settled
from plasmapyro.diagnosis.simulation.measured import NO_GAIN, measured_gas
from plasmapyro.diagnosis.simulation.simulated import Simulated
from plasmapyro.diagnosis.simulation.systems import _beyond
from plasmapyro.record.record import record_of

OF_GAS = {identity: effect for identity, effect in CATALOGUE.items() if effect.steady_gas}
NOT_OF_GAS = {identity: effect for identity, effect in CATALOGUE.items() if not effect.steady_gas}
BESIDE = {"mixing": OF_FLOW["mixing"]}
CLOSE = 0.08  # [1] of ln of the power: its prior, the errors that the simulation states allow no better
EMITTANCE = 0.85  # as stated
FAINT = 0.2  # of a tenth of the O I triplet: of the lines of a leak none is beyond chance alone
STRAY = 2.0  # [K] rms: what noise of 1 % in a thousand samples leaves


@pytest.fixture(scope="module")
def fitted(radiation, variations, response, calibration):
    """Base fit of a test, by what `radiation` simulates or by another gas."""

    def make(test, simulated=None, varied=variations):
        library = gas_library("80kW", simulated or radiation, varied, fwhm=0.75e-9)
        record = record_of(test, {"pyrometer": calibration, "spectrometer": None})
        with np.errstate(all="ignore"):
            return fit_base(base_model(record, library, calibration, response))

    return make


def foreign(radiation, factor):
    """Another simulation: the light of each component times a factor (3, K)."""
    found = {}
    for name, own in radiation.items():
        parts = own["gas_radiance_component_slit"] * factor
        found[name] = own.assign(
            gas_radiance_component_slit=parts, gas_radiance_slit=("wavelength_slit", parts.values.sum(axis=0))
        )
    return found


def compared(base, final=None):
    with np.errstate(all="ignore"):
        gas = measured_gas(base.model, final or base.solution)
        return compare(base.model, gas, OF_GAS, beside=BESIDE, draws=300)


def temperature_error(base, solution):
    time = np.linspace(20.0, OFF - 1, 50)
    return base.model.history.basis(time) @ solution.state.knots - temperature_of(time)


@pytest.mark.parametrize("power", [60e3, 105e3])
def test_a_gas_several_times_as_strong_is_measured_and_tells_its_power(fitted, record, power):
    """Lines change by factors of 0.1 to 7; a fit that starts from the simulated gas ends far away."""
    base = fitted(record(power=power))
    assert base.solution.converged and base.solution.chi2 / base.solution.count < 1.1
    assert np.sqrt(np.mean(temperature_error(base, base.solution) ** 2)) < STRAY
    found = compared(base)
    assert found.base.power == pytest.approx(np.log(power / 80e3), abs=CLOSE)
    (said,) = power_sentences(found)
    assert f"{'less' if power < 80e3 else 'more'} power than simulated" in said


@pytest.mark.parametrize(("away", "wrong"), [((0.0, 0.0), True), ((0.095, 0.05), False)])
def test_a_power_is_wrong_where_it_is_not_the_one_that_was_expected(fitted, record, away, wrong):
    base = fitted(record(power=88e3))
    with np.errstate(all="ignore"):
        gas = measured_gas(base.model, base.solution)
        found = compare(base.model, gas, OF_GAS, beside=BESIDE, away=away, draws=300)
    assert found.power_is_wrong is wrong
    assert found.power[0] + away[0] == pytest.approx(np.log(1.1), abs=0.02)


def test_a_slit_that_lines_show_is_not_another_power(fitted, record):
    base = fitted(record(power=88e3))
    gas = replace(measured_gas(base.model, base.solution), slit=SeenSlit(0.01, 0.0004, 0.1, 9))
    found = names_of(base, gas)
    assert found.power_is_wrong and "lsf" in found.rivals
    assert "lsf" not in found.rivals_of_power


@pytest.mark.parametrize(("power", "said"), [(72e3, True), (88e3, False)])
def test_mixing_stands_for_less_power_and_not_for_more(fitted, record, variations, axis, power, said):
    """Jets computed with mixing shine as colder ones; here gas of less power is that which is colder."""
    powers = 80e3 * (1 + variations["core_change"].values) ** (1 / WARMTH_OF_POWER)
    hotter = np.array([gas_components(axis, one).sum(axis=0) for one in powers])
    cores = variations.assign(core_radiance=(("core_change", "wavelength_slit"), hotter))
    found = compared(fitted(record(power=power), varied=cores))
    assert found.power_is_wrong and "P_eff" in found.rivals_of_power
    assert ("mixing" in found.rivals_of_power) is said
    assert ("mixing of the jet" in power_sentences(found)[0]) is said


@pytest.fixture(scope="module")
def rippled(fitted, record, radiation, variations):
    """Base fit of a gas that ripples by 0.2, and a simulation that does not."""
    factor = gas_library("80kW", radiation, variations, fwhm=0.75e-9).factor("ripple", 0.2)
    still = variations.copy(deep=True)
    for name in ("core_radiance", "varied_radiance", "added_radiance"):
        still[name].values /= factor
    return fitted(record(), foreign(radiation, 1 / factor), still)


def test_a_ripple_is_found_in_its_size_and_what_explains_as_much_beside_it(rippled):
    found = compared(rippled)
    (ripple,) = found.final.settings
    assert ripple.id == "ripple" and "P_eff" in found.rivals["ripple"]
    assert abs(ripple.amplitude - 0.2) < np.sqrt(found.final.covariance[2, 2]) < 0.03


def test_a_gas_of_which_no_cause_is_asked_is_compared_all_the_same(rippled):
    with np.errstate(all="ignore"):
        found = compare(rippled.model, measured_gas(rippled.model, rippled.solution), {}, draws=300)
    assert found.final.settings == () and found.systems
    assert found.threshold == pytest.approx(6.63, abs=0.01)  # one number in a hundred


def test_a_channel_that_may_be_anything_hides_no_cause_of_the_gas(rippled):
    """Air that absorbs in a channel, by an inexact formula, hid a ripple that all others show."""
    gas = measured_gas(rippled.model, rippled.solution)
    spectral = gas.instrument == gas.instrument[-1]
    one = (np.arange(spectral.sum()) == 30).astype(float)[:, None]
    gas.value[np.flatnonzero(spectral)[30]] += 1.0
    (ripple,) = names_of(rippled, gas.without(one, True)).final.settings
    assert ripple.id == "ripple" and ripple.amplitude == pytest.approx(0.2, abs=0.03)


@pytest.mark.parametrize("multiplies", [True, False])
def test_a_pattern_that_may_be_anything_hides_none_either(rippled, multiplies):
    """Cyanogen by an inexact formula left a pattern over all channels, and hid a ripple that gained 30."""
    gas = measured_gas(rippled.model, rippled.solution)
    spectral = gas.instrument == gas.instrument[-1]
    pattern = np.sin(np.arange(spectral.sum()) / 2.0)[:, None]
    light = gas.value if multiplies else gas.level[spectral].mean() / gas.level
    gas.value[spectral] += 0.2 * pattern[:, 0] * light[spectral]
    found, other = (names_of(rippled, gas.without(pattern, one)) for one in (multiplies, not multiplies))
    (ripple,) = found.final.settings
    assert ripple.id == "ripple" and ripple.amplitude == pytest.approx(0.2, abs=0.03)
    assert found.base.objective < other.base.objective - 100


def test_a_pyrometer_that_may_be_anything_hides_none_either(rippled):
    """Two bands that see beside the sample spoiled the gas of all channels: a continuum had no name."""
    gas = measured_gas(rippled.model, rippled.solution)
    gas.value[gas.instrument != gas.instrument[-1]] *= [1.5, 0.5]
    (ripple,) = names_of(rippled, gas.of_last()).final.settings
    assert ripple.id == "ripple" and ripple.amplitude == pytest.approx(0.2, abs=0.03)


def names_of(base, gas):
    with np.errstate(all="ignore"):
        return compare(base.model, gas, OF_GAS, draws=300)


def test_a_slit_that_lines_show_is_named_and_prices_nothing_else(rippled):
    """Bins of 2 nm do not show 0.1 nm; lines in pixels do, and say nothing of the formulas of the gas."""
    gas = measured_gas(rippled.model, rippled.solution)
    wider = replace(gas, slit=SeenSlit(extra=0.01, error=0.0004, stated=0.1, lines=9))
    found = names_of(rippled, wider)
    slit, ripple = found.final.settings
    assert (slit.id, ripple.id) == ("lsf", "ripple")
    assert slit.amplitude == pytest.approx(0.1, abs=0.005)
    assert slit_sentences(found) == [
        "9 lines of atoms are 1.05 ± 0.002 times as wide as the stated slit makes them."
    ]
    (alone,) = names_of(rippled, replace(wider, slit=SeenSlit(0.01, 0.005, 0.1, 9))).final.settings
    assert alone.id == "ripple"


@pytest.mark.parametrize("seen", [None, SeenSlit(extra=0.01, error=0.0004, stated=0.1, lines=9)])
def test_a_slit_that_lines_show_lets_no_strength_pass_for_another_cause(rippled, monkeypatch, seen):
    """Without effects a fit misses the slit, by 25 standard errors here: that speaks for a slit alone."""
    gas = replace(measured_gas(rippled.model, rippled.solution), slit=seen)
    unseen = 0.0 if seen is None else seen.misfit(()) ** 2
    plain = names_of(rippled, gas)
    assert plain.final.settings[-1].id == "ripple"
    light = plain.final.objective - (0.0 if seen is None else seen.misfit(plain.final.settings) ** 2)
    monkeypatch.setattr(compare_module, "spectroscopy", lambda *rest: light + unseen + 1.0)
    assert [one.id for one in names_of(rippled, gas).final.settings] == ([] if seen is None else ["lsf"])


def test_a_fit_that_leaves_a_rest_errs_by_its_birge_ratio(rippled, monkeypatch):
    plain = compared(rippled)
    monkeypatch.setattr(Fitter, "spread", lambda fitter, fit: 1.2)
    np.testing.assert_allclose(compared(rippled).final.covariance, 1.2 * plain.final.covariance)


def test_each_round_of_a_fit_goes_on_from_the_last(monkeypatch):
    """From the simulated gas it fell, with errors about a light several times as strong, into a minimum of a
    fiftieth of the light, and errors relative to that were five times too large."""
    starts = []

    def fit(self, settings, start=None):
        starts.append(start)
        return len(starts)

    monkeypatch.setattr(Fitter, "__init__", lambda *rest: None)
    monkeypatch.setattr(Fitter, "about", lambda self, fit: self)
    monkeypatch.setattr(Fitter, "fit", fit)
    settled(SimpleNamespace(measured=SimpleNamespace(simulated=None)))
    assert starts == [None, 1, 2]


def test_an_effect_is_fitted_from_the_simulated_power_too():
    """A base fit that has taken a ripple of 0.2 for 49 % more power leaves none of it to its tangent."""
    ripple, base = CATALOGUE["ripple"], SimpleNamespace(settings=())

    def fit(settings, start):
        far = start is None and settings[0].amplitude > 0.12
        return SimpleNamespace(objective=-847.0 if far else -830.0)

    assert Fitter.best(SimpleNamespace(fit=fit), base, ripple).objective == -847.0


@pytest.mark.parametrize("window", [0.0, 0.05])
def test_a_fit_ends_where_its_slopes_promise_nothing(fitted, record, window):
    """A pair of steps to and fro was taken for the bottom, 40 of chi-squared above it."""
    found = fitted(record(window_loss=window)).solution
    assert found.converged and found.score @ cho_solve(found.factor, found.score) < 0.1


def test_brightness_before_and_after_the_injection_is_guessed(fitted, record):
    base = fitted(record())
    values, _ = first_gas.guess(base.model)
    assert values[base.model.index["before_injection"]] == pytest.approx(np.log(1.6), abs=0.02)
    assert values[base.model.index["gas"]] == pytest.approx(0.0, abs=0.05)


def test_a_surface_that_shines_at_once_is_not_taken_for_the_gas():
    """An ablator outshines the gas a second after the injection, in one band the more. All was taken for the
    gas, and the fit stayed in a hole 1e5 times as deep as the noise."""
    time = np.array([-3.0, -1.0, 0.25, 0.75, 1.25, 1.75, 2.25, 2.75])
    light = np.array([[1.5, 1.2]] * 2 + [[1.0, 0.8]] + [[1.0 + 9 * k, 0.8 + 30 * k] for k in range(1, 6)])
    instrument = SimpleNamespace(moment=time[:, None], value=light, channels=2)
    parameters = [SimpleNamespace(first=0.0)] * 2
    model = SimpleNamespace(
        parameters=parameters,
        index={"gas": 0, "before_injection": 1},
        instruments=[instrument],
        gas_level=lambda _: (np.array([1.0, 0.8]), np.array([1.0, 0.8])),
    )
    values, errors = first_gas.guess(model)
    assert values == pytest.approx([0.0, np.log(1.5)])
    assert errors[0] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_free_jet_of_another_shape_moves_no_temperature(fitted, record):
    """Before the injection the light differs by waves of 6 % over wavelength, as at no other power."""
    test = record()
    waves = 1 + 0.06 * np.sin((test.wavelength - 890e-9) / 30e-9)
    free = test.spectrum_time < 0
    test["spectral_radiance"].values *= xr.where(free, waves, 1.0).transpose("spectrum_time", "wavelength")
    base = fitted(test)
    assert base.solution.chi2 / base.solution.count < 1.1
    assert np.sqrt(np.mean(temperature_error(base, base.solution) ** 2)) < STRAY


@pytest.mark.parametrize("power", [80e3, 88e3])
def test_what_a_matt_sample_scatters_is_found_in_its_size(fitted, record, variations, response, axis, power):
    """Lines of the torch, seen end on, are five times as strong over the molecules; each channel is free."""
    share, test, matt = 0.2, record(power=power), np.array([[50.0], [50.0], [10.0]])

    def scattered(wavelength):
        return (1 - EMITTANCE) * share * (matt * gas_components(wavelength, power)).sum(axis=0)

    lit = (test.spectrum_time > 0) & (test.spectrum_time < OFF)
    test["spectral_radiance"].values += np.outer(lit, scattered(test.wavelength.values))
    wavelength = response.wavelength.values
    more = np.interp(wavelength, axis, scattered(axis))
    for gain, band in ((0.3e-8, "wide"), (1e-8, "narrow")):
        signal = gain * np.trapezoid(response[f"responsivity_{band}"].values * more, wavelength)
        test[f"signal_{band}"].values += signal * ((test.time > 0) & (test.time < OFF)).values
    varied = variations.copy(deep=True)
    falling = (matt * gas_components(axis, 80e3)).sum(axis=0)
    varied["added_radiance"].loc["reflected_diffuse"] = falling
    base, start = fitted(test, varied=varied), (Setting(CATALOGUE["refl"], 0.01, {"contrast": 1.0}),)
    with np.errstate(all="ignore"):
        found = base.fitter.fit(replace(base.solution.state, amplitudes=numbers_of(start)), start)
    size = base.model.size + len(base.model.parameters)
    error = np.sqrt(found.covariance[size, size])
    # Lines against molecules alone: a jet of another power imitates most of it, and the error is large.
    off = abs(found.settings[0].amplitude - share)
    assert found.converged and off < 1.96 * error < share


def test_the_gas_before_the_injection_errs_in_proportion_to_what_it_is(fitted, record):
    """However its light is shared between brightness and channels: else a fit makes the one large, the
    others negative, and the jet before may have any shape."""
    base = fitted(record())
    model, state = base.model, base.solution.state
    bright, early = state.values.copy(), model.instruments[1].moment[:, 0] < 0
    bright[model.index["gas"]] += np.log(2.0)

    def seen(values, lines, before):
        error = np.stack([np.full(model.instruments[1].channels, one) for one in (lines, before)])
        return model.evaluate(1, state.knots, values, gas_error=error)

    level, light = model.gas_level(1)
    clear = light == level  # elsewhere errors count from the mean light
    for values, lines in ((state.values, 0.0), (bright, -0.5)):
        ratio = seen(values, lines, 0.1) / seen(values, lines, 0.0)
        np.testing.assert_allclose(ratio[early][:, clear], 1.1, rtol=1e-9)
        np.testing.assert_allclose(ratio[~early], 1.0, rtol=1e-12)
    rows = own_patterns(model.instruments, base.solution.plain, base.solution.gas_rows)
    row = [values for which, values in rows if which == 1][-1]
    now = state.error_of_gas(1)
    plain, moved = (
        model.evaluate(1, state.knots, state.values, gas_error=now + [[0.0], [x]]) for x in (0.0, 1e-3)
    )
    wanted = (moved - plain) / 1e-3
    np.testing.assert_allclose(row, wanted, rtol=1e-6, atol=1e-9 * wanted.max())


@pytest.mark.parametrize("hidden", [{}, {"window_loss": 0.05}], ids=["nothing", "window"])
def test_a_gas_that_the_simulation_does_not_know_changes_no_name(fitted, record, radiation, axis, hidden):
    """Bands 12 % off with a shape of 6 % over 15 nm, lines 7 % off: of two engines both may be right."""
    waves = np.exp(0.12 + 0.06 * np.sin(axis / 2.4e-9))
    other = foreign(radiation, np.array([1.07 + 0 * axis, 0.93 + 0 * axis, waves]))
    base = fitted(record(**hidden), other)
    with np.errstate(all="ignore"):
        found = select(base, NOT_OF_GAS, draws=500)
    names = [setting.id for setting in found.final.settings]
    assert names == (["winE"] if hidden else []) and found.unknown_class is None
    assert np.sqrt(np.mean(temperature_error(base, found.final) ** 2)) < STRAY
    assert compared(base, found.final).rivals == {}


@pytest.mark.parametrize(("continuum", "blur"), [(150.0, 0.31), (150.0, 0.0)])
def test_a_slit_is_seen_beside_a_continuum_that_outshines_the_gas(fitted, record, continuum, blur):
    """What a smooth light may be wrong by looks like no slit: a tenth of what it explains hid one."""
    base = fitted(record())
    simulated = Simulated(base.model, measured_gas(base.model, base.solution), {})
    more = Setting(CATALOGUE["contin"], continuum, {"own": 0.0}), Setting(CATALOGUE["lsf"], blur, {})
    change = simulated.light(0.0, 0.0, more) - simulated.light(0.0, 0.0)
    asked = {identity: CATALOGUE[identity] for identity in ("contin", "lsf", "T_exc")}
    gas = replace(simulated.measured, value=simulated.measured.value + change)
    with np.errstate(all="ignore"):
        found = compare(base.model, gas, asked, draws=300).final.settings
    assert [one.id for one in found] == ["contin", "lsf"][: 1 + bool(blur)]
    assert found[0].amplitude == pytest.approx(continuum, rel=0.2)
    if blur:
        assert found[1].amplitude == pytest.approx(blur, rel=0.2)


def test_times_scale_no_light(fitted, record):
    times = {one.id for one in fitted(record()).model.own if one.unit == "s"}
    assert times == {"clocks", "moments"} and times <= set(NO_GAIN)


def test_errors_of_lines_move_with_their_scale(fitted, record):
    """Atoms brighter by three standard deviations cost what they do in place; where the lines had been, a
    fainter one passed for one that had moved less."""
    base = fitted(record())
    simulated = Simulated(base.model, measured_gas(base.model, base.solution), {})
    fitter, plain = settled(simulated)
    costs = []
    for settings in ((), (Setting(CATALOGUE["wshift"], 0.7, {}),)):
        moved = simulated.through(settings)
        light = simulated.light(0.0, 0.0, settings)
        np.testing.assert_allclose(moved.seen, light, rtol=1e-9)
        brighter = 3.0 * moved.strength[[simulated.systems.index(name) for name in ("N I", "O I")]].sum(
            axis=0
        )
        there = fitter.about(replace(plain, power=0.0, brightness=0.0, settings=settings))
        costs += [np.sum(one.white(brighter)[0] ** 2) for one in (there, fitter)]
    assert costs[2] == pytest.approx(costs[0], rel=0.2) and costs[2] < 0.5 * costs[3]


@pytest.mark.parametrize(("shift", "names"), [(0.0, []), (0.3, ["wshift"])])
def test_lines_of_a_gas_of_another_pressure_stand_where_they_are(rippled, monkeypatch, shift, names):
    """A gas of other strengths than simulated: no cause of them has a name, a scale that is off has.

    Beside images of the second order, whose strengths are guesses, a scale 1.6 nm off was named that alone
    explained nothing.
    """
    asked_last, of_all = [], compare_module._names
    monkeypatch.setattr(compare_module, "_names", lambda *given: asked_last.append(given) or of_all(*given))
    simulated = Simulated(rippled.model, measured_gas(rippled.model, rippled.solution), {})
    gas, hidden = simulated.measured, [Setting(CATALOGUE["ripple"], 0.2, {})]
    plain = simulated.light(0.0, 0.0, hidden)
    moved = simulated.light(0.0, 0.0, [*hidden, Setting(CATALOGUE["wshift"], shift, {})])
    gas = replace(gas, value=gas.value + moved - plain)
    nothing = Fit(0.0, 0.0, (), 0.0, np.eye(2))
    asked = {identity: CATALOGUE[identity] for identity in ("wshift", "lsf", "ripple", "contin")}
    before = Comparison(nothing, nothing, (), (), {}, 10.0, 0.5, np.ones(3), power=(-0.3, 0.01))
    with np.errstate(all="ignore"):
        found = anywhere(rippled.model, gas, asked, before, "why", draws=300)
    assert before.power_is_wrong  # by what another pressure does:
    assert found.power == rippled.model.power and np.isfinite(found.power).all()  # nothing is learnt
    assert [one.id for one in found.final.settings] == list(found.rivals) == names
    assert found.silence == "why" and set(found.evidence) == {"wshift", "lsf"}
    second, scale = (
        SimpleNamespace(settings=(Setting(CATALOGUE[i], 0.3, {}),)) for i in ("second", "wshift")
    )
    assert asked_last[0][-1](second, scale) == bool(names)
    if names:
        assert found.final.settings[0].amplitude == pytest.approx(shift, rel=0.5)  # about another light
        assert found.gained > 30.0


def test_two_groups_of_lines_together_may_stand_for_an_effect(monkeypatch):
    """Two multiplets 13 and 20 % fainter than simulated were lines that absorb themselves: each alone
    explained half of it."""
    gains = {"a": 20.0, "b": 18.0, "c": 3.0, "ab": 39.0, "ac": 22.0, "bc": 20.0}

    def freed(simulated, settings, wrong, kept, *, groups):
        for one in sorted({"a", "b", "c"} - {*wrong, *kept}) if groups else ():
            free = (*wrong, one)
            yield SimpleNamespace(wrong=free), SimpleNamespace(objective=-gains["".join(sorted(free))])

    monkeypatch.setattr(errors_module, "_freed", freed)
    assert spectroscopy(None) == -39.0
    assert spectroscopy(None, ("a",)) == -20.0


@pytest.mark.parametrize(
    ("identity", "amplitude", "depth", "holds"),
    [
        (
            "selfabs",
            1.3,
            0.06,
            False,
        ),  # of a gas at 106 mbar whose O I 777 nm was 13 % fainter than simulated
        ("selfabs", 0.25, 0.06, True),
        ("selfabs", 1.3, 1.0, True),
        ("selfabs", 1.3, np.nan, True),  # the simulation says nothing of it
        ("contin", -20.0, 0.06, False),  # there is no continuum to take away
        ("contin", 20.0, 0.06, True),
        ("T_exc", 0.05, 0.06, True),
        ("T_exc", 0.12, 0.06, False),  # the end of its range
    ],
)
def test_a_cause_of_the_gas_is_one_that_this_gas_could_have(
    radiation, variations, identity, amplitude, depth, holds
):
    varied = variations.assign_attrs(optical_depth_simulated=depth)
    library = gas_library("80kW", radiation, varied, fwhm=0.75e-9)
    fit = Fit(0.0, 0.0, (Setting(CATALOGUE[identity], amplitude, {}),), 0.0, np.eye(3))
    assert admissible(fit, library) is holds


def test_bands_that_are_too_strong_are_listed_with_sign_and_size(fitted, record, radiation, axis):
    """The simulation has 0.4 of the bands: far beyond the tenth that it states, and lines as they are."""
    other = foreign(radiation, np.array([1.0 + 0 * axis, 1.0 + 0 * axis, 0.4 + 0 * axis]))
    found = compared(fitted(record(), other))
    bands = [one for one in found.systems if one.name.startswith("N2 1P") and one.beyond]
    assert bands
    assert [one.ratio for one in bands] == pytest.approx([1 / 0.4] * len(bands), rel=0.05)
    assert not any(one.beyond for one in found.systems if "N2 1P" not in one.name)


def test_a_continuum_several_times_as_bright_is_more_continuum(fitted, record, radiation, axis, response):
    """That its own system of any strength explains as much is the same cause by another name."""
    weak = 0.02 * radiation["80kW"]["gas_radiance_slit"].values.mean() * (0.9e-6 / axis) ** 1.5
    with_own = {
        name: xr.concat(
            [
                one[["gas_radiance_component_slit", "component_uncertainty"]],
                xr.Dataset(
                    {
                        "gas_radiance_component_slit": (("component", "wavelength_slit"), weak[None]),
                        "component_uncertainty": ("component", [0.3]),
                    },
                    {"component": ["e-neutral free-free"]},
                ),
            ],
            "component",
        )
        .assign(
            gas_radiance_slit=one["gas_radiance_slit"] + weak,
            **error_modes(axis, [0.05, 0.09, 0.1, 0.3]),
        )
        .assign_attrs(one.attrs)
        for name, one in radiation.items()
    }
    test = record()
    moment = {name: test[name].values for name in ("time", "spectrum_time")}
    share = {n: np.where(t < 0, 1.6, (t < OFF).astype(float)) for n, t in moment.items()}
    test["spectral_radiance"].values += np.outer(
        share["spectrum_time"], np.interp(test["wavelength"], axis, 8 * weak)
    )
    bright = np.interp(response.wavelength, axis, 8 * weak)
    for gain, band in ((0.3e-8, "wide"), (1e-8, "narrow")):
        more = np.trapezoid(response[f"responsivity_{band}"].values * bright, response.wavelength)
        test[f"signal_{band}"].values += gain * more * share["time"]
    found = compared(fitted(test, with_own))
    assert [setting.id for setting in found.final.settings] == ["contin"]
    assert found.evidence["contin"] > found.evidence[SYSTEM]


def test_a_gas_of_other_shape_keeps_its_ratios(fitted, record, radiation, axis):
    """Bands 2.5 times as strong as simulated, and wavy by 10 %, twice what the simulation states.

    Errors relative to the data would draw ratios down together (Peelle's puzzle).
    """
    waves = 0.4 * np.exp(0.1 * np.sin(axis / 2.4e-9))
    found = compared(fitted(record(), foreign(radiation, np.array([1.0 + 0 * axis, 1.0 + 0 * axis, waves]))))
    bands = [one.ratio for one in found.systems if one.name.startswith("N2 1P")]
    assert bands == pytest.approx([1 / 0.4] * 3, rel=0.1)  # of what is off, the waves


def test_systems_that_a_power_changes_unlike_keep_their_own_ratios(fitted, record, radiation, axis):
    """At another power lines change by factors, bands amid which they stand by others: each row tells of its
    own system, both as measured and as the power would have it; a fainter one is not known better."""
    names, relative = list(radiation["80kW"].component.values), {}
    for power in (65e3, 100e3):
        found = compared(fitted(record(power=power)))
        truth = gas_components(axis, power).sum(axis=1) / gas_components(axis, 80e3).sum(axis=1)
        rows = {
            one.name: truth[names.index(name)] for one in found.systems for name in names if name in one.name
        }
        assert len(rows) >= 4
        bright = [one for one in found.systems if one.name in rows and one.error < 0.05 * one.ratio]
        for one in bright:
            assert one.ratio == pytest.approx(rows[one.name], rel=0.1), one.name
            assert one.by_power == pytest.approx(rows[one.name], rel=0.25), one.name  # the power is 8 % off
        assert len(bright) >= 3
        relative[power] = [one.error / one.ratio for one in found.systems if one.name.startswith("N2 1P")]
    # The shape of bands errs in proportion to their light, noise does not.
    assert np.all(np.array(relative[65e3]) > relative[100e3])


def test_a_line_that_nobody_simulated_is_found_at_its_wavelength(fitted, record, radiation, axis):
    """The simulation lacks the line at 926.6 nm, one of four."""
    gone = np.where(np.abs(axis - 926.6e-9) < 2e-9, 0.0, 1.0)
    other = foreign(radiation, np.array([gone, 1.0 + 0 * axis, 1.0 + 0 * axis]))
    lines = [line for line in compared(fitted(record(), other)).lines if line.strength > 0]
    assert min(abs(line.wavelength - 926.6e-9) for line in lines) < 0.8e-9  # a pixel


@pytest.mark.parametrize(("atom", "strength", "names"), [("Ar I", 0.5, ["Ar"]), ("Kr I", 1.0, [])])
def test_an_atom_has_all_of_its_lines(fitted, record, atom, strength, names):
    """Krypton at 811.3 nm looks as argon at 811.5 does through such a slit; its other lines do not."""
    base = fitted(record())
    gas = measured_gas(base.model, base.solution)
    simulated = Simulated(base.model, gas, {})
    shines = simulated.light(0.0, 0.0, (Setting(lines_of(atom), strength, {}),))
    gas = replace(gas, value=gas.value + shines - simulated.light(0.0, 0.0, ()))
    found = compare(base.model, gas, {"Ar": CATALOGUE["Ar"], "Cu": CATALOGUE["Cu"]}, draws=300)
    assert list(found.rivals) == names
    assert any(line.strange for line in found.lines) == (not names)
    # Where light of that size is named of the thermometer, its formula may leave a line.
    named = replace(gas, named=0.5 * np.abs(shines - simulated.light(0.0, 0.0, ())))
    found = compare(base.model, named, {"Cu": CATALOGUE["Cu"]}, draws=300)
    assert found.lines and not any(line.strange for line in found.lines)


def test_the_lines_of_a_species_that_is_certain_are_lines_no_more(fitted, record):
    base = fitted(record())
    gas = measured_gas(base.model, base.solution)
    light = Simulated(base.model, gas, {}).light
    shines = light(0.0, 0.0, (Setting(lines_of("Kr I"), 3.0, {}),)) - light(0.0, 0.0, ())
    with_krypton = replace(gas, value=gas.value + shines)
    freed = with_krypton.without(line_pattern(base.model, "Kr I"), False)
    other = with_krypton.without(line_pattern(base.model, "Ne I"), False)
    sound, free, wrong = (compare(base.model, one, {"Cu": CATALOGUE["Cu"]}) for one in (gas, freed, other))
    assert wrong.lines and not free.lines
    assert free.base.power == pytest.approx(sound.base.power, abs=0.002)


@pytest.mark.parametrize(("share", "asked", "told"), [(0, "Cl I", 0), (1, "Cl I", 1), (1, "He I", 0)])
def test_lines_of_a_leak_are_told_together_where_none_is_alone(fitted, record, share, asked, told):
    """Chlorine has ten lines here."""
    base = fitted(record())
    gas = measured_gas(base.model, base.solution)
    light = Simulated(base.model, gas, {}).light
    shines = light(0.0, 0.0, (Setting(lines_of("Cl I"), FAINT, {}),)) - light(0.0, 0.0, ())
    gas = replace(gas, value=gas.value + share * shines)
    alone, found = (
        compare(base.model, gas, {"Cu": CATALOGUE["Cu"]}, draws=300, leaks=leaks)
        for leaks in ([], [lines_of(asked)])
    )
    assert (len(alone.lines), sum(line.strange for line in found.lines)) == (0, told)


@pytest.fixture
def with_argon(fitted, record):
    """(model, measured gas) of a gas as simulated, with three times as much argon as `Ar` counts."""
    base = fitted(record())
    gas = measured_gas(base.model, base.solution)
    simulated = Simulated(base.model, gas, {})
    shines = simulated.light(0.0, 0.0, (Setting(CATALOGUE["Ar"], 3.0, {}),))
    return base.model, replace(gas, value=gas.value + shines - simulated.light(0.0, 0.0, ()))


def test_lines_of_an_atom_do_not_pass_for_rough_bands(with_argon):
    """Without its lines the bands seem rough, which takes much of what argon gains."""
    argon = {"Ar": CATALOGUE["Ar"]}
    simulated = Simulated(*with_argon, argon)
    plain = raise_errors(simulated, argon)
    assert simulated.roughness < plain.roughness
    found = compare(*with_argon, argon, draws=300)
    fitter, without = settled(plain)
    gained = without.objective - fitter.best(without, argon["Ar"]).objective
    assert found.base.objective == pytest.approx(without.objective, rel=1e-9)
    assert found.gains["Ar"] > 1.5 * gained > 0
    assert found.p_value == pytest.approx(fitter.p_value(without), rel=1e-6)
    assert found.final.settings[0].amplitude == pytest.approx(3.0, abs=0.3)


def test_a_gas_in_which_nothing_is_named_is_as_rough_as_it_seems(with_argon, monkeypatch):
    """Errors that were made smaller for a name that is not given would list lines falsely."""
    argon, seen = {"Ar": CATALOGUE["Ar"]}, []
    monkeypatch.setattr(compare_module, "_may_be", lambda *_: False)
    monkeypatch.setattr(
        compare_module, "lines_of", lambda fitter, *_: seen.append(fitter.simulated.roughness) or []
    )
    found = compare(*with_argon, argon, draws=300)
    assert found.final.settings == () and found.rivals == {}
    assert seen == [raise_errors(Simulated(*with_argon, argon), argon).roughness]


@pytest.mark.parametrize(("power", "brightness"), [(0.0, 0.5), (0.1, -0.7), (-0.2, 0.5)])
def test_light_of_a_simulated_gas_is_that_of_the_model(fitted, record, power, brightness):
    """Light is kept, scaled, and seen without a surface; the model itself knows nothing of that."""
    effects = {**OF_GAS, **OF_FLOW, "He I": lines_of("He I")}
    base = fitted(record())
    with np.errstate(all="ignore"):
        simulated = Simulated(base.model, measured_gas(base.model, base.solution), effects)
    own = simulated.model
    values = simulated.centre.copy()
    values[own.index["power"]], values[own.index["gas"]] = power, brightness
    asked = [(Setting(one, 2 * one.sigma, dict(one.shapes[-1])),) for one in effects.values()]
    for settings in [(), *asked, (*asked[0], *asked[-1])]:
        kept = [simulated.light(power, one, settings) for one in (0.0, brightness, brightness)]
        whole = [own.evaluate(i, simulated.cold, values, settings)[0] for i in range(len(own.instruments))]
        np.testing.assert_array_equal(kept[1], kept[2])
        np.testing.assert_allclose(kept[1], np.concatenate(whole) * simulated.unit, rtol=1e-12)


def test_bands_of_another_rotational_structure_raise_their_error(fitted, record, radiation, axis):
    """Over two nanometres each bands differ by 30 %: the error of single channels is raised as far, and
    neither the power nor a cause is wrong."""
    random = np.random.default_rng(3)
    rough = 1 + 0.3 * random.uniform(-1, 1, axis.size // 12 + 1).repeat(12)[: axis.size]
    other = foreign(radiation, np.array([1.0 + 0 * axis, 1.0 + 0 * axis, rough]))
    base = fitted(record(), other)
    with np.errstate(all="ignore"):
        gas = measured_gas(base.model, base.solution)
    simulated = Simulated(base.model, gas, OF_GAS)
    with np.errstate(all="ignore"):
        fitter, fit = settled(simulated)
        raise_errors(simulated, OF_GAS)
        found = compare(base.model, gas, OF_GAS, draws=300)
    assert fitter.p_value(fit) < 1e-6 < 0.01 < found.p_value and found.final.settings == ()
    assert simulated.roughness >= 0.06 and simulated.scatter == 1.0
    assert not simulated.bands[:2].any() and simulated.bands[2:].any()  # the pyrometer sees many lines
    assert found.base.power == pytest.approx(0.0, abs=CLOSE)


@pytest.mark.parametrize(
    ("ratio", "error", "beyond"),
    [(0.3, 0.02, True), (0.5, 0.02, False), (2.0, 0.02, False), (3.0, 0.02, True), (3.0, 0.5, False)],
)
def test_a_strength_errs_by_factors(ratio, error, beyond):
    """Stated 31 %: three times that are factors of 2.5 and 0.39; down to zero would else be within them."""
    assert _beyond(ratio, error, 1.0, 0.31) == beyond


@pytest.mark.parametrize(
    ("ripple", "system", "likelier"), [(3.4, 0.0, False), (8.0, 0.0, True), (8.0, 7.0, False)]
)
def test_a_name_of_the_gas_must_be_likelier_than_none(ripple, system, likelier):
    """12.3 of chi-squared beyond a threshold of 12.0 is a log Bayes factor of 3.4: one in forty it is not."""
    nothing = Fit(0.0, 0.0, (), 0.0, np.zeros((2, 2)))
    named = replace(nothing, settings=(SimpleNamespace(id="ripple"),))
    found = Comparison(
        nothing, named, (), (), {}, 12.0, 0.9, np.ones(3), evidence={"ripple": ripple, SYSTEM: system}
    )
    assert gas_is_likelier(found, 43) is likelier
    assert gas_is_likelier(replace(found, final=nothing), 43)
