"""Effects taken as given: their form, what a fit and a correction make of them."""

import numpy as np
import pytest
import xarray as xr
import yaml

from plasmapyro import contracts
from plasmapyro.commands.correct import widen
from plasmapyro.commands.terms import (
    OF_TEST,
    absent,
    check_effects,
    read_terms,
    with_effects,
    with_instrument,
)
from plasmapyro.configuration import ConfigurationError
from plasmapyro.diagnosis import stage
from plasmapyro.diagnosis.command import LIMITS
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.effects.condition import OF_CONDITION
from plasmapyro.diagnosis.fit import base as fit_base
from plasmapyro.diagnosis.fit.given_gas import light_with, with_gas
from plasmapyro.diagnosis.fit.restore import without_given
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.fit.terms import Term, digest_of, terms_of, text_of, with_own
from plasmapyro.diagnosis.fit.whole import fit_test
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.diagnosis.select.selection import Selection
from plasmapyro.diagnosis.stage import diagnose

LOSS = 0.08  # of window E at the end, as in the tests of the diagnosis
WINDOW = {"id": "winE", "amplitude": LOSS, "uncertainty": 0.002}


def run(laboratory, test, entries):
    with np.errstate(all="ignore"):
        return diagnose(
            test,
            laboratory.radiation,
            laboratory.variations,
            laboratory.response,
            laboratory.calibration,
            draws=200,
            saturation_counts=65000.0,
            limits=LIMITS,
            given=terms_of(entries, {**OF_TEST, **OF_CONDITION}),
        )


@pytest.mark.parametrize(("left", "instrument"), [(None, "pyrometer"), ("left_pattern", "spectrometer")])
def test_a_pattern_beside_unknown_bands_is_asked_of_spectra_alone(
    laboratory, record, monkeypatch, left, instrument
):
    """Bands of a converter with unequal codes, and a loss in front of the spectrometer that is given; a joint
    fit seems to leave a pattern, one to the spectra, with what is given of them, decides."""
    fits = []

    def noted(*arguments, **settings):
        fits.append(settings["given"])
        return fit_test(*arguments, **settings)

    def remaining(model, solution):
        return left if len(model.instruments) == 1 else "left_pattern"

    monkeypatch.setattr(stage, "fit_test", noted)
    monkeypatch.setattr(stage, "left_over", remaining)
    test = record(window_loss=LOSS)
    for name in ("signal_wide", "signal_narrow"):
        test[name] = test[name] * (1 + 0.02 * np.sin(2 * np.pi * 6.0 * test[name] / test[name].max()))
    verdict = run(laboratory, test, [WINDOW]).report["verdict"]
    assert verdict["status"] == "unknown" and verdict["unknown"]["instrument"] == instrument
    assert [given[0].setting.id for given in fits] == ["winE", "winE"]


def test_spectra_too_few_to_be_in_a_model_are_not_fitted_alone(laboratory, record, monkeypatch):
    """Bands are unknown and something remains, as it may of a radiometer of many bands: alone, four spectra
    would be refused."""
    monkeypatch.setattr(stage, "left_over", lambda *_: "left_pattern")
    monkeypatch.setattr(Selection, "in_bands", True)
    report = run(laboratory, record().isel(spectrum_time=slice(0, 120, 30)), []).report
    assert report["dataset"]["instruments"] == ["pyrometer"]


def test_every_effect_survives_being_written_and_read():
    for effect in CATALOGUE.values():
        shape = {name: float(value) for name, value in effect.shapes[0].items()}
        numbers = {"amplitude": float(f"{0.1 * effect.sigma:.6g}")} | dict.fromkeys(shape, 0.01)
        term = Term(Setting(effect, 0.5 * effect.bounds[1], shape), numbers)
        assert terms_of(yaml.safe_load(text_of([term]))["effects"], CATALOGUE) == (term,)


def test_what_is_wrong_in_entries_is_said_at_once_with_the_nearest_name():
    entries = [
        {"id": "winF", "amplitude": 0.1},
        {"id": "winE", "amplitude": 2.0, "uncertanty": 0.1},
        {"id": "eps_ox", "amplitude": "a", "shape": {"time_constnt": 5}},
        {"id": "clock", "uncertainty": -1},
    ]
    with pytest.raises(ValueError, match="effects.0.id: unknown; did you mean 'winE'") as said:
        terms_of(entries, OF_TEST)
    for words in (
        "effects.1.uncertanty: unknown; did you mean 'uncertainty'",
        "effects.1.amplitude: must be a number from -0.2 to 0.8; got 2.0",
        "effects.2.shape.time_constnt: unknown; did you mean 'time_constant'",
        "effects.2.shape.time_constant: missing (3 to 400)",
        "effects.3.amplitude: missing (pyrometer early [s])",
        "effects.3.uncertainty: must be a number from 0 to inf s; got -1",
    ):
        assert words in str(said.value)
    with pytest.raises(ValueError, match="'winE' is given twice"):
        terms_of([WINDOW, WINDOW], OF_TEST)
    with pytest.raises(ValueError, match="P_eff"):
        terms_of([{"id": "T_exc", "amplitude": 0.1}], {"P_eff": CATALOGUE["P_eff"]})


def test_an_amplitude_of_zero_gives_the_same_report_as_no_entry(record, laboratory, diagnosed):
    with_zero = run(laboratory, record(), [{"id": "winE", "amplitude": 0}])
    plain = run(laboratory, record(), [])
    assert with_zero.report == plain.report
    assert with_zero.temperature.equals(plain.temperature)


def test_what_is_given_is_fitted_within_its_uncertainty_and_not_named_again(record, laboratory, monkeypatch):
    # Gains seem steadier once the loss is known, by 18 % here: both fits are to assume the same of them.
    monkeypatch.setattr(fit_base, "steadier", lambda *_: {"wander_course": 0.2})
    test = record(window_loss=LOSS)
    before = run(laboratory, test, [])
    found = yaml.safe_load(before.terms)
    (entry,) = found["test"]["effects"]
    assert entry["id"] == "winE" and entry["amplitude"] == pytest.approx(LOSS, abs=0.002)
    after = run(laboratory, test, found["test"]["effects"])
    assert after.report["verdict"]["status"] == "null"
    # The noise is now that of a fit with the term, which is some per cent less.
    assert after.report["base"]["chi2"] == pytest.approx(before.report["extended"]["chi2"], rel=0.02)
    both = [before.temperature["extended_temperature"], after.temperature["base_temperature"]]
    late = both[0]["time_bin"].values > 20
    assert np.nanmax(np.abs(both[0] - both[1]).values[late]) < 0.5  # K, of some 10
    # What is written after it holds the same effect, no less certain.
    (again,) = yaml.safe_load(after.terms)["test"]["effects"]
    assert again["amplitude"] == pytest.approx(LOSS, abs=0.002)
    # The data count once: fitted to them again, it is as uncertain as before.
    assert again["uncertainty"] == pytest.approx(entry["uncertainty"], rel=0.05)
    known = {name: value for name, value in entry.items() if name != "fitted_to"}
    other = run(laboratory, test, [known])  # the same numbers, known from elsewhere
    assert other.report["base"]["pulls"] != after.report["base"]["pulls"]
    assert yaml.safe_load(other.terms)["test"]["effects"] == [known]


def test_numbers_that_were_edited_are_no_longer_those_of_the_data(record):
    (term,), test = terms_of([WINDOW], OF_TEST), record()
    mark = term.mark(digest_of(test))
    for amplitude, data, own in ((LOSS, test, True), (LOSS, record(seed=2), False), (2 * LOSS, test, False)):
        marked = terms_of([WINDOW | {"amplitude": amplitude, "fitted_to": mark}], OF_TEST)
        assert [one.own for one in with_own(marked, data)] == [own]
    with pytest.raises(ValueError, match="fitted_to: must be the word"):
        terms_of([WINDOW | {"fitted_to": 7}], OF_TEST)


def test_a_power_that_is_given_moves_the_simulated_gas_and_is_not_found_again(record, laboratory):
    test = record(power=72e3)  # simulated at 80 kW
    before = run(laboratory, test, [])
    (entry,) = yaml.safe_load(before.terms)["condition"]["effects"]
    assert entry["id"] == "power" and entry["amplitude"] == pytest.approx(-0.1, abs=0.03)
    after = run(laboratory, test, [entry])
    assert yaml.safe_load(after.terms)["condition"]["effects"] == [entry]
    wrong, right = (one.report["simulation"] for one in (before, after))
    assert "power" in wrong["sentences"][0] and "agrees" in right["sentences"][0]
    assert right["power"] == pytest.approx(1.0, abs=2 * entry["uncertainty"])
    both = [one.temperature["base_temperature"] for one in (before, after)]
    late = both[0]["time_bin"].values > 20
    assert np.nanmax(np.abs(both[0] - both[1]).values[late]) < 0.5  # K, of some 10


@pytest.mark.parametrize("identity", ["T_exc", "ripple", "P_eff", "mixing", "contin", "lines Fe I"])
def test_a_library_with_given_gas_has_the_light_of_the_fit_with_that_effect(laboratory, identity):
    """And errs by as much more as another amplitude within its uncertainty changes it."""
    library = gas_library("80kW", laboratory.radiation, laboratory.variations, fwhm=0.75e-9)
    size, sigma = 0.05, 0.01
    shape = {"shape": {"own": 0.5}} if identity == "contin" else {}
    (term,) = terms_of([{"id": identity, "amplitude": size, "uncertainty": sigma, **shape}], OF_CONDITION)
    given, _ = with_gas(library, [term])
    assert given.base == pytest.approx(light_with(library, term.setting))
    assert np.max(np.abs(given.base / library.base - 1)) > 1e-3
    more = light_with(library, term.at({"amplitude": size + sigma})) - given.base
    assert np.linalg.norm(given.shape_modes[-1] - more) < 0.2 * np.linalg.norm(more)
    assert with_gas(library, [])[0].base == pytest.approx(library.base, abs=0)


def test_gas_of_a_given_power_varies_from_there(laboratory):
    """Powers count from the given one; gas hotter by as much as that is where it began."""
    library = gas_library("80kW", laboratory.radiation, laboratory.variations, fwhm=0.75e-9)
    (term,) = terms_of([{"id": "power", "amplitude": 0.1, "uncertainty": 0.011}], OF_CONDITION)
    given, (mean, sigma) = with_gas(library, [term])
    assert given.power == pytest.approx(88e3) and mean == 0.0 and sigma == pytest.approx(0.01)
    assert given.base * given.power_factor(-np.log(1.1)) == pytest.approx(library.base, rel=1e-9)
    colder = 1 / (1 + library.warmth_of(np.log(1.1))) - 1
    back = given.factor("core_temperature", colder) * library.factor(
        "core_temperature", library.warmth_of(np.log(1.1))
    )
    assert back == pytest.approx(np.ones(back.size), rel=1e-3)


def test_a_test_without_its_given_effects_is_the_one_that_never_had_them(record, laboratory):
    """The generator of these tests multiplies spectra by its own formula of a deposit."""
    clean, spoiled = record(noise=0.0), record(noise=0.0, window_loss=0.1)
    terms = terms_of([{"id": "winE", "amplitude": 0.1, "uncertainty": 0.01}], OF_TEST)
    inputs = laboratory.radiation, laboratory.variations, laboratory.response, laboratory.calibration
    with np.errstate(all="ignore"):
        made, moves = without_given(spoiled, *inputs, saturation_counts=65000.0, given=terms)
        free, more = made({"winE.amplitude": 0.1}), made({"winE.amplitude": 0.12})
    contracts.check(free, "test")
    assert np.array_equal(free.signal_wide, clean.signal_wide)  # another instrument
    ratio = (free.spectral_radiance / clean.spectral_radiance).values
    # The deposit is grey, so that neither bins nor the fit matter: an exposure counts as
    # two instants, which 4e-5 of the light of a heating surface tells apart.
    assert np.abs(ratio - 1).max() < 1e-4
    late = free.spectrum_time.values > 130
    # Of a gain that may wander from 3 s to 3 s and frames that may be 5 ms late the fit tells the deposit to
    # a quarter of what is stated.
    assert all(abs(move["winE.amplitude"] - 0.1) < 2.5e-3 for move in moves)
    assert (more.spectral_radiance / free.spectral_radiance).values[late] == pytest.approx(0.9 / 0.88)


def test_a_clock_that_is_given_moves_times_and_bends_no_signal(record, laboratory):
    """Signals over modelled ones that jump elsewhere were wrong by half beside each jump."""
    clean, early = record(noise=0.0), 0.5
    late = clean.assign_coords(time=clean.time - early)
    terms = terms_of([{"id": "clock", "amplitude": early}, WINDOW | {"uncertainty": 0}], OF_TEST)
    inputs = laboratory.radiation, laboratory.variations, laboratory.response, laboratory.calibration
    with np.errstate(all="ignore"):
        made, _ = without_given(late, *inputs, saturation_counts=65000.0, given=terms)
    free = made()
    contracts.check(free, "test")
    assert free.time.values == pytest.approx(clean.time.values, abs=1e-9)
    for name in ("signal_wide", "signal_narrow"):
        assert free[name].values == pytest.approx(clean[name].values, rel=1e-12)
    assert free.spectrum_time.equals(clean.spectrum_time)


def test_spectra_that_are_given_as_late_go_back_and_the_pyrometer_stays(record, laboratory):
    clean, late = record(noise=0.0), 0.5
    moved = clean.assign_coords(spectrum_time=clean.spectrum_time + late)
    inputs = laboratory.radiation, laboratory.variations, laboratory.response, laboratory.calibration
    terms = terms_of([{"id": "clock", "amplitude": late, "shape": {"spectra": 1.0}}], OF_TEST)
    with np.errstate(all="ignore"):
        made, _ = without_given(moved, *inputs, saturation_counts=65000.0, given=terms)
    assert made().spectrum_time.values == pytest.approx(clean.spectrum_time.values, abs=1e-9)
    assert made().time.equals(clean.time)


def test_an_uncertain_effect_makes_temperatures_uncertain_and_their_interval_as_much_wider():
    grid = {"time": ("time", [0.0, 1.0])}
    result = xr.Dataset(
        {
            "t": ("time", [1000.0, 1500.0]),
            "t_uncertainty": ("time", [3.0, 3.0]),
            "t_interval": (("bound", "time"), [[990.0, 1490.0], [1010.0, 1510.0]]),
        },
        grid,
    )
    widen(result, "t", xr.DataArray([4.0, np.nan], {"time": grid["time"]}, ["time"]))
    assert result.t_uncertainty.values == pytest.approx([5.0, 3.0])
    assert result.t_interval.values[:, 1] == pytest.approx([1490.0, 1510.0])
    half = 10.0 * 5 / 3
    assert result.t_interval.values[:, 0] == pytest.approx([1000 - half, 1000 + half], abs=0.3)


def test_a_file_of_terms_is_read_whole_or_refused(tmp_path):
    path = tmp_path / "terms.yaml"
    path.write_text("test:\n  effects:\n  - {id: winE, amplitude: 0.1}\ncondition: {effects: []}\n")
    assert [term.setting.id for term in read_terms(path)] == ["winE"]
    assert read_terms(path, "condition") == ()
    for text in (
        "effects: []\n",
        "test: {efects: []}\n",
        "test:\n  effects: [{id: power, amplitude: 0.1}]\n",
    ):
        path.write_text(text)
        with pytest.raises(ValueError, match=str(path)):
            read_terms(path)


def test_faults_of_both_parts_of_a_file_are_said_at_once(tmp_path):
    path = tmp_path / "terms.yaml"
    parts = {"test": "winE, amplitude: 5 %", "condition": "power, amplitude: -7"}
    path.write_text("".join(f"{part}:\n  effects: [{{id: {one}}}]\n" for part, one in parts.items()))
    with pytest.raises(ValueError, match=r"test.effects.0.amplitude: .*\n  condition.effects.0.amplitude: "):
        read_terms(path)


def test_files_of_tests_and_conditions_hold_the_effects_that_act_there():
    check_effects({"a": {}, "b": {"effects": [WINDOW]}}, "test", "config/tests")
    with pytest.raises(
        ConfigurationError, match=r"config/tests/b.yaml:\n  effects.0.id: .power. belongs to conditions"
    ):
        check_effects({"b": {"effects": [{"id": "power", "amplitude": 0.1}]}}, "test", "config/tests")
    with pytest.raises(ConfigurationError, match="belongs to tests .*; valid here: power, mixing"):
        check_effects({"c": {"effects": [WINDOW]}}, "condition", "config/conditions")


def test_effects_of_an_instrument_that_a_test_lacks_are_told():
    terms = terms_of([WINDOW, {"id": "eps_T", "amplitude": 0.1}, {"id": "phi", "amplitude": 0.01}], OF_TEST)
    ids = {one: [term.setting.id for term in absent(terms, [one])] for one in ("pyrometer", "radiometer")}
    assert ids == {"pyrometer": [WINDOW["id"]], "radiometer": [WINDOW["id"]]}
    assert [term.setting.id for term in absent(terms, ["spectrometer"])] == ["phi"]


def test_effects_of_an_instrument_join_those_of_each_test():
    window, clock = {"id": "winE", "amplitude": 0.05}, {"id": "clock", "amplitude": 0.2}
    own = {"id": "clock", "amplitude": 0.5}
    tests = with_instrument([window, clock], {"a": {"effects": [own]}, "b": {"data_folder": "x"}})
    assert tests["a"]["effects"] == [own, window]
    assert tests["b"] == {"data_folder": "x", "effects": [window, clock]}
    with pytest.raises(ConfigurationError, match=r"instrument.effects.0.id: .eps_ox. belongs to tests"):
        with_instrument([{"id": "eps_ox", "amplitude": 0.1}], {})


def test_effects_of_a_condition_act_on_its_power_and_its_levels():
    effects = [{"id": "power", "amplitude": 0.1}, {"id": "T_vib", "amplitude": -0.08}]
    conditions, levels = with_effects({"80kW": {"numerical_power_kw": 80, "effects": effects}, "one": {}})
    assert conditions["80kW"]["numerical_power_kw"] == 88.0
    assert levels == {"80kW": {"vibration": -0.08}}
    nothing = {"90kW": {"numerical_power_kw": 90, "effects": [{"id": "power", "amplitude": 0}]}}
    assert with_effects(nothing) == (nothing, {})


def test_mixing_of_a_condition_solves_its_flow_again():
    effects = [{"id": "power", "amplitude": -0.1}, {"id": "mixing", "amplitude": 0.06}]
    found, levels = with_effects({"80kW": {"numerical_power_kw": 80, "effects": effects}})
    assert found["80kW"]["mixing"] == 0.06 and found["80kW"]["numerical_power_kw"] == 72.0 and levels == {}
    with pytest.raises(ConfigurationError, match="effects of mine: 'mixing' solves the flow again"):
        with_effects({"mine": {"numerical_power_kw": 80, "cfd": {}, "effects": effects[1:]}})
    for amplitude in (-0.01, 0.2):  # beyond the wakes, whose mixing length is the greatest
        wrong = {"80kW": {"effects": [{"id": "mixing", "amplitude": amplitude}]}}
        with pytest.raises(ConfigurationError, match=r"effects.0.amplitude: .* 0 .* 0.16"):
            check_effects(wrong, "condition", "config/conditions")
