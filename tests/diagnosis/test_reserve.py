"""When names are given with reserve, and what a bound means for tests beside a fit."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from plasmapyro.diagnosis import stage
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE, without
from plasmapyro.diagnosis.fit.inference import Fitter
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.fit.weights import Noise
from plasmapyro.diagnosis.select import selection
from plasmapyro.diagnosis.select.held_out import Gain
from plasmapyro.diagnosis.select.reserve import reserve
from plasmapyro.diagnosis.select.screen import Candidate, Screen, screen
from plasmapyro.diagnosis.select.search import Step
from plasmapyro.diagnosis.select.selection import Selection
from plasmapyro.diagnosis.select.structures import Structure, seen_by
from plasmapyro.diagnosis.select.unknowns import Unknowns

THIRD = 18.0  # chi-squared that one more term must gain
STRENGTH = 20.0  # standard deviations of what is hidden
EARLY = 0.1  # [1], of a gain: a step that is not small is not linear
NOT_LINEAR = 1.5  # [1], of a gain: what a refit may differ by from its linear estimate


def of_any_size(name):
    return replace(CATALOGUE[name], bounds=(-100.0, 100.0))


def round_of(names, objective, left=0.0, amplitudes=None, covariance=None):
    settings = tuple(Setting(of_any_size(name), 1.0, {}) for name in names)
    solution = SimpleNamespace(
        settings=settings,
        objective=objective,
        state=SimpleNamespace(amplitudes=np.ones(len(names)) if amplitudes is None else amplitudes),
        covariance=np.eye(len(names) + 3) if covariance is None else covariance,
    )
    return SimpleNamespace(solution=solution, gains=np.array([left, 0.5 * left]))


def rounds(*explained, left=0.0):
    """Rounds of orthogonal names that explain so much chi-squared each, and what the best other would add."""
    objective = 1e4 - np.concatenate([[0.0], np.cumsum(explained)])
    last = len(explained)
    return [
        round_of(("winE", "phi", "off1")[:count], value, left if count == last else 0.0)
        for count, value in enumerate(objective)
    ]


@pytest.mark.parametrize(
    ("degrees", "expected"), [(10.0, ""), (20.0, "one"), (28.0, "one"), (33.0, ""), (60.0, "")]
)
def test_one_cause_near_a_name_is_no_pair_and_two_as_strong_ones_are(degrees, expected):
    """A cause in the plane of two orthogonal names leaves each the square of its cosine."""
    along, across = (STRENGTH * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])) ** 2
    assert reserve(rounds(along, across), THIRD) == expected


def test_a_third_name_is_held_against_both_before():
    assert reserve(rounds(100.0, 90.0, 70.0), THIRD) == ""
    assert reserve(rounds(100.0, 90.0, 50.0), THIRD) == "one"


def test_a_rest_must_be_beyond_noise_and_beyond_what_formulas_err_by():
    assert reserve(rounds(200.0, left=THIRD - 1), THIRD) == ""
    assert reserve(rounds(200.0, left=21.0), THIRD) == "rest"
    assert reserve(rounds(2500.0, left=240.0), THIRD) == ""
    assert reserve(rounds(2500.0, left=260.0), THIRD) == "rest"


@pytest.mark.parametrize(
    ("degrees", "second", "expected"), [(10, -0.9, "cancel"), (10, 0.9, ""), (60, -0.9, "")]
)
def test_two_nearly_parallel_names_that_cancel_are_no_pair(degrees, second, expected):
    """Both are as long as 20 standard deviations; what is seen is their small difference."""
    columns = STRENGTH * np.array([[1.0, 0.0], [np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]])
    covariance = np.eye(5)
    covariance[3:, 3:] = np.linalg.inv(columns @ columns.T)
    last = round_of(("winE", "phi"), 9.0e3, 0.0, np.array([1.0, second]), covariance)
    steps = [round_of((), 1e4), round_of(("winE",), 9.5e3), last]
    assert reserve(steps, THIRD) == expected


@pytest.mark.parametrize(
    ("name", "amplitude", "shape", "expected"),
    [
        ("winE_sl", 0.05, {"exponent": 2.0}, ""),
        ("winE_sl", 0.05, {"exponent": 0.7}, "shape"),
        ("winE_sl", 0.05, {"exponent": 4.19}, "shape"),
        ("winE_sl", -0.05, {"exponent": 2.0}, "sign"),
        ("winE_sl", -0.02, {"exponent": 2.0}, ""),  # two standard deviations
        ("h2o", -0.05, {}, ""),  # more of it in the calibration
        ("eps_T", 0.59, {}, ""),
        ("eps_T", 0.6, {}, "end"),  # six tenths of the emittance: no more is looked for
        ("grad", 50.0, {"exponent": 1.0, "profile": 1.0}, ""),  # kinds of their own, tried as such
        ("edge_p", 0.05, {"ratio": 0.8, "lag": 5.0, "delay": 1.0}, ""),
        ("edge_p", 0.05, {"ratio": 0.8, "lag": 30.0, "delay": 1.0}, "shape"),
    ],
)
def test_a_name_with_numbers_that_its_cause_cannot_have_is_doubted(name, amplitude, shape, expected):
    settings = (Setting(CATALOGUE[name], amplitude, shape),)
    last = round_of(("winE",), 9e3, 0.0, np.array([amplitude, *shape.values()]), np.diag([1e-4] * 5))
    last.solution.settings = settings
    assert reserve([round_of((), 1e4), last], THIRD) == expected


def test_two_names_of_one_set_are_no_pair():
    steps = rounds(100.0, 90.0)
    assert reserve(steps, THIRD, (("winE", "phi"), ("phi", "winE", "off1"))) == "alike"
    assert reserve(steps, THIRD, (("winE", "off1"), ("phi", "off2"))) == ""


def test_a_free_shape_does_not_hide_that_names_cancel():
    """A third column, of the shape, in which the second name may lean: its amplitude alone is badly known."""
    columns = STRENGTH * np.array([[1.0, 0.0, 0.0], [0.985, 0.17, 0.02], [0.1, 0.017, 0.0021]])
    covariance = np.eye(6)
    covariance[3:, 3:] = np.linalg.inv(columns @ columns.T + 1e-9 * np.eye(3))
    last = round_of(("winE", "winD_sl"), 9.0e3, 0.0, np.array([1.0, 0.9, 2.0]), covariance)
    blue = Setting(of_any_size("winD_sl"), 0.9, {"exponent": 2.0})
    last.solution.settings = (Setting(of_any_size("winE"), 1.0, {}), blue)
    steps = [round_of((), 1e4), round_of(("winE",), 9.5e3), last]
    assert reserve(steps, THIRD) == ""
    last.solution.state.amplitudes[0] = -0.9
    assert reserve(steps, THIRD) == "cancel"


def test_without_a_name_there_is_nothing_to_reserve():
    assert reserve([round_of((), 1e4, left=500.0)], THIRD) == ""


def with_a_deposit(model):
    """Fitter of data without noise that hide a deposit on the window, and the knots of their temperature."""
    knots = np.interp(model.history.knots, [0, 20, 120, 150], [350, 1200, 1500, 1150])
    values = np.array([parameter.centre for parameter in model.parameters])
    hidden = (Setting(CATALOGUE["winE"], 0.03, {}),)
    measured = [model.evaluate(which, knots, values, hidden) for which in range(2)]
    noise = [Noise((0.003 * one) ** 2, np.zeros(len(one))) for one in measured]
    fitter = Fitter(model, noise, measured)
    return fitter, knots


def test_knots_shift_as_a_fit_that_leaves_a_term_out(model):
    """A deposit left out and fitted: the knots differ by the shift per unit of its column."""
    fitter, knots = with_a_deposit(model)
    without_it, with_it = (
        fitter.fit(fitter.start(knots, settings), settings)
        for settings in ((), (Setting(CATALOGUE["winE"], 0.03, {}),))
    )
    found = screen(model, without_it, {"winE": CATALOGUE["winE"]}, structures=False)
    expected = found.shift[:, 0] * CATALOGUE["winE"].linear_of(with_it.state.amplitudes[0])
    shift = without_it.state.knots - with_it.state.knots
    assert np.abs(shift - expected).max() < 0.15 * np.abs(shift).max()


def test_a_number_that_a_bound_holds_is_no_free_direction(model):
    """A grey loss fitted by one that must fall with wavelength: its exponent ends at its bound. No other
    term can gain more beside it than the objective holds."""
    fitter, knots = with_a_deposit(model)
    start = fitter.start(knots, (Setting(CATALOGUE["winE_sl"], 0.03, {"exponent": 0.75}),))
    solution = fitter.fit(start, (Setting(CATALOGUE["winE_sl"], 0.03, {"exponent": 0.75}),))
    assert solution.settings[0].shape["exponent"] == pytest.approx(0.7, abs=1e-6)
    found = screen(model, solution, without(CATALOGUE, ["winE_sl"]), structures=False)
    assert found.gains().max() < NOT_LINEAR * solution.objective


def test_a_fit_that_stopped_early_lets_nobody_explain_what_it_left(model):
    """Two steps towards perfect data of the base model: the gains are those beside the converged fit."""
    fitter, knots = with_a_deposit(model)
    early, late = (fitter.fit(fitter.start(knots + 1.0), steps=steps) for steps in (1, 20))
    assert early.objective > late.objective + 1.0
    gains = [screen(model, one, CATALOGUE, structures=False).gains() for one in (early, late)]
    strong = gains[1] > 0.1 * gains[1].max()
    assert gains[0][strong] == pytest.approx(gains[1][strong], rel=EARLY)


@pytest.mark.parametrize(
    ("name", "limit", "status", "left", "expected"),
    [
        ("winD", 9.0, "named+unknown", None, "walk_wide"),  # what the loss would be taken for, were it large
        ("eps_T", -9.0, "named+unknown", None, "gas_pattern"),  # what the data themselves speak for
        ("winD", -9.0, "named+unknown", None, "walk_wide"),  # of the instrument that the name is of
        ("winE", 9.0, "named+unknown", None, "gas_pattern"),
        ("winD", 9.0, "named+unknown", "left_step", "left_step"),
        ("winD", 9.0, "named", None, None),
    ],
)
def test_names_with_reserve_say_where_another_cause_would_be(name, limit, status, left, expected):
    """A cause outside the catalogue that was taken for one of it had neither instrument nor axis; a lag of
    the spectrometer that was taken for the edge of its spot had the instrument that was right."""
    rows = np.zeros((6, 4))
    rows[:2, 0], rows[0, 1], rows[1, 2], rows[5, 3] = 10.0, 40.0, 40.0, 40.0
    data = 0.2 * rows[:, 0] + np.array([0, 0, 0, 0, 0, 4.0])
    structures = (Structure("walk_wide", "", slice(0, 2)), Structure("gas_pattern", "", slice(2, 3)))
    candidates = (Candidate(CATALOGUE[name], {}),)
    screen = Screen(candidates, structures, rows.T @ data, rows.T @ rows, np.ones(4), None)
    fit = SimpleNamespace(settings=(Setting(CATALOGUE[name], 0.2, {}),))
    step = Step(fit, screen, screen.gains(), Unknowns(screen)(screen.score), None)
    limits = SimpleNamespace(unknown=limit)
    found = Selection((step,), fit, ((name,),), {}, status, left, limits, CATALOGUE)
    assert found.suspect == expected


@pytest.mark.parametrize(
    ("unknown", "gained", "hides"),
    [
        (None, 0.0, False),
        ("surface_pattern", 147.0, False),  # a slit that is wider, beside what it leaves of lines of calcium
        ("surface_pattern", 15.0, True),
        ("walk_pyrometer", 15.0, False),  # no pyrometer changes a spectrum
        ("left_pattern", 147.0, True),  # nobody knows how much it explains
    ],
)
def test_a_cause_of_the_gas_is_hidden_by_no_unknown_that_explains_less(unknown, gained, hides):
    structures = (Structure("surface_pattern", "", slice(0, 1)), Structure("walk_pyrometer", "", slice(1, 2)))
    step = SimpleNamespace(screen=SimpleNamespace(structures=structures), unknown=np.array([5.3, 4.1]))
    found = Selection((step,), None, (), {}, "unknown" if unknown else "null", unknown, None, {})
    assert found.hides(gained) is hides


@pytest.mark.parametrize(
    ("most", "evidence", "outweighs"),
    [
        (14.8, 35.3, True),  # a deposit that blocks left out foretell as well by a gain that wanders
        (14.8, 16.0, False),
        (88.7, 90.0, False),
        (-2.1, 8.0, False),  # nothing is there beyond chance
    ],
)
def test_a_name_that_explains_more_than_any_structure_stands_without_blocks_left_out(
    most, evidence, outweighs
):
    step, limits = SimpleNamespace(unknown=np.array([most, -2.0])), SimpleNamespace(unknown=5.0)
    found = Selection((step,), None, (), {}, "named", None, limits, {}, "", evidence)
    assert found.outweighs_unknown is outweighs


@pytest.mark.parametrize(
    ("evidence", "total", "in_samples", "expected"),
    [
        (35.3, -0.4, None, "named+unknown"),  # silent, and still the best that there is
        (16.0, -0.4, None, "unknown"),
        (16.0, 0.4, None, "named+unknown"),
        (16.0, 2.0, None, "named+unknown"),
        (16.0, 9.0, None, "named"),
        (16.0, 9.0, "left_step_pyrometer", "named+unknown"),
    ],
)
def test_a_diagnosis_asks_the_blocks_left_out_the_structures_and_the_samples(
    monkeypatch, evidence, total, in_samples, expected
):
    selected = a_deposit(evidence)
    scores = Gain(((0.0, 1.0, 0.5 * total), (1.0, 2.0, 0.5 * total)), 0.0, total, 1.0, None)
    found = selection_of(monkeypatch, select=selected, gain=scores, left_in_bands=in_samples)
    assert found.status == expected
    assert bool(found.final.settings) is (expected != "unknown")


@pytest.mark.parametrize(
    ("in_samples", "alone", "expected"),
    [
        ("left_wave_pyrometer", None, "left_wave_pyrometer"),
        ("left_wave_pyrometer", "left_moment", "left_moment"),
        (None, None, "left_moment"),
    ],
)
def test_where_bands_leave_something_spectra_are_asked_alone(monkeypatch, in_samples, alone, expected):
    """A hum of the bands bends the temperature that they share with sound spectra."""
    nothing = SimpleNamespace(settings=(), converged=True)
    selected = replace(a_deposit(16.0), status="null", final=nothing, sets=())
    said = {"left_over": "left_moment", "_left_alone": alone, "left_in_bands": in_samples}
    assert selection_of(monkeypatch, select=selected, **said).unknown_class == expected


@pytest.mark.parametrize(
    ("total", "cut", "expected"),
    [(2.0, False, "named+unknown"), (2.0, True, "unknown"), (9.0, True, "named")],
)
@pytest.mark.parametrize("strained", [False, True])
def test_no_name_stands_with_reserve_where_the_record_is_to_be_cut(
    monkeypatch, total, cut, expected, strained
):
    """A sample that leaves the view is what comes to pass at that moment, and no cause throughout."""
    scores = Gain(((0.0, 1.0, 0.5 * total), (1.0, 2.0, 0.5 * total)), 0.0, total, 1.0, None)
    found = selection_of(monkeypatch, cut, strained, select=a_deposit(16.0), gain=scores, left_in_bands=None)
    assert found.status == ("unknown" if strained and cut else expected)


@pytest.mark.parametrize(
    ("structure", "status", "suspect"),
    [(66.7, "unknown", "walk_clock"), (62.7, "named+unknown", "walk_clock"), (58.0, "named", None)],
)
def test_a_name_that_something_unknown_beats_is_doubted_and_seen_there(
    monkeypatch, structure, status, suspect
):
    """Samples that were lost, as an edge of the other spot with three free shapes: numbers of a test."""
    structures = [SimpleNamespace(id=one) for one in ("walk_clock", "walk_spectrometer")]
    edge = SimpleNamespace(settings=(Setting(CATALOGUE["edge_s"], 0.004, {}),))
    screen = SimpleNamespace(structures=structures)
    first, last = (
        Step(one, screen, np.array([108.2]), np.array([structure, 45.0]), None)
        for one in (SimpleNamespace(settings=()), edge)
    )
    limits = SimpleNamespace(unknown=4.0, third=THIRD)
    search = SimpleNamespace(
        look=lambda _: first, evidence=lambda one: 57.6 * bool(one.settings), thresholds=limits, effects={}
    )
    said = {"Search": search, "walk": ([first, last], None), "by_pair": ([first, last], None)}
    said |= {"by_other_window": ([first, last], None), "_likelier": True, "alike": ("edge_s",)}
    for name, value in (said | {"_alone": {}, "reserve": "", "bent": False}).items():
        monkeypatch.setattr(selection, name, lambda *_, value=value: value)
    base = SimpleNamespace(model=None, fitter=None, solution=None)
    found = selection.select(base, {}, thresholds=limits)
    assert (found.status, found.suspect) == (status, suspect)


@pytest.mark.parametrize(
    ("faulty", "left", "expected"),
    [
        (None, None, "walk_clock"),  # where an edge of the pyrometer's spot acts
        ({"spectrometer"}, None, "walk_spectrometer"),
        (set(), None, "walk_spectrometer"),  # the likeliest of all: the fault is in how they go together
        ({"spectrometer"}, "walk_clock", "walk_spectrometer"),  # left beside a wrong name
        ({"pyrometer"}, "walk_clock", "walk_clock"),
        ({"pyrometer", "spectrometer"}, "walk_spectrometer", "walk_spectrometer"),
        ({"pyrometer"}, "left_frames", "left_frames"),  # a test of its own
    ],
)
def test_names_with_reserve_are_placed_by_what_each_instrument_shows_alone(faulty, left, expected):
    structures = tuple(Structure(one, "", slice(0, 1)) for one in ("walk_clock", "walk_spectrometer"))
    screen = SimpleNamespace(structures=structures)
    step = Step(SimpleNamespace(settings=()), screen, np.zeros(1), np.array([40.0, 60.0]), np.zeros(1))
    fit = SimpleNamespace(settings=(Setting(CATALOGUE["edge_p"], 0.05, {}),))
    limits = SimpleNamespace(unknown=5.0, third=THIRD)
    found = Selection((step,), fit, (("edge_p",),), {}, "named+unknown", left, limits, {}, "unconfirmed")
    assert replace(found, faulty=None if faulty is None else frozenset(faulty)).suspect == expected


def a_deposit(evidence):
    """What is selected where a deposit has some log evidence over nothing; no structure is beyond chance."""
    seen = SimpleNamespace(structures=(Structure("walk_spectrometer", "", slice(0, 1)),))
    fit = SimpleNamespace(settings=(Setting(CATALOGUE["winE"], 0.05, {}),), converged=True)
    step = Step(SimpleNamespace(settings=()), seen, np.zeros(1), np.array([14.8]), np.zeros(1))
    limits = SimpleNamespace(unknown=5.0, third=THIRD)
    return Selection((step,), fit, (("winE",),), {}, "named", None, limits, {}, "", evidence)


def selection_of(monkeypatch, cut=False, strained=False, **said):
    """What a diagnosis ends with, all that is computed replaced by what it may say; a test without a plasma
    has no gas to compare."""
    fit = said["select"].final
    spectrometer = SimpleNamespace(kind="spectrometer")
    model = SimpleNamespace(record=None, instruments=(spectrometer,))
    base = SimpleNamespace(model=model, fitter=None, solution=fit)
    alike = SimpleNamespace(lines=(), final=SimpleNamespace(settings=()), gained=0.0)
    found = []

    def finished(_, selection, *rest):
        found.append(selection)
        raise StopIteration

    usual = {
        "fit_test": base,
        "left_over": None,
        "in_turn": None,
        "excursion": None,
        "nothing_to_compare": alike,
        "gas_is_likelier": True,
        "digest_of": "",
    }
    for name, value in (usual | said).items():
        monkeypatch.setattr(stage, name, lambda *_, value=value, **__: value)
    monkeypatch.setattr(stage, "told", lambda _, one: one.doubted("strained") if strained else one)
    monkeypatch.setattr(stage, "Findings", finished)
    test = xr.Dataset(attrs={"condition": "none"})
    with pytest.raises(StopIteration):
        stage.diagnose(test, {}, None, None, saturation_counts=1.0, limits={}, cut=cut)
    return found[0]


def test_a_pattern_that_comes_and_goes_lies_along_time_too():
    axes = {
        one: seen_by(one)["axis"] for one in ("left_pattern", "left_moment", "surface_pattern", "pattern")
    }
    assert list(axes.values()) == ["time and wavelength", "time", "wavelength and temperature", "wavelength"]


@pytest.mark.parametrize(
    ("unknown", "left", "expected"),
    [
        ("walk_clock", "left_moment", "left_moment"),
        (None, "left_moment", "left_moment"),
        (None, "left_step_pyrometer", "left_step_pyrometer"),
        ("walk_wide", "left_step_pyrometer", "walk_wide"),
        ("one_pattern", "left_step_pyrometer", "one_pattern"),
        ("one_pattern", "left_pattern", "one_pattern"),
        ("one_walk_gas", "left_frames", "one_walk_gas"),
        ("walk_clock", None, "walk_clock"),
        (None, None, None),
    ],
)
def test_what_frames_leave_comes_before_what_the_pyrometer_is_unlike(unknown, left, expected):
    fit = SimpleNamespace(settings=())
    found = Selection((), fit, (), {}, "unknown" if unknown else "null", unknown, None, {}).with_rest(left)
    assert found.unknown_class == expected
    assert found.status == ("unknown" if expected else "null")
