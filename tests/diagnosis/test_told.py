"""Names with reserve are dropped where their own fit speaks against them; others stay."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.inference import Solution, State
from plasmapyro.diagnosis.fit.parameter import Parameter
from plasmapyro.diagnosis.fit.setting import Setting, free_numbers, numbers_of
from plasmapyro.diagnosis.select.search import Search
from plasmapyro.diagnosis.select.told import TOLD, told

PARAMETERS = tuple(
    SimpleNamespace(id=name, centre=0.0, sigma=0.01, history=(name == "gas_wander"))
    for name in ("clocks", "gas", "wander_pyrometer", "wander_pyrometer", "gas_wander", "emittance")
)


def fit_of(objective, **sizes):
    """A fit with effects {id: amplitude over its standard error}; all amplitudes are 0.01."""
    settings = tuple(
        Setting(CATALOGUE[name], 0.01, dict(CATALOGUE[name].shapes[0] if CATALOGUE[name].shapes else {}))
        for name in sizes
    )
    free = free_numbers(settings)
    own = [0.01 / sizes[settings[one.place].id] if one.name is None else 5.0 for one in free]
    state = SimpleNamespace(amplitudes=numbers_of(settings), values=np.zeros(len(PARAMETERS)))
    variance = np.square([1.0, *np.ones(len(PARAMETERS)), *own])  # a knot and the values come first
    return SimpleNamespace(
        settings=settings, state=state, covariance=np.diag(variance), objective=float(objective)
    )


@dataclass
class Fitted:
    """A search whose fits are known beforehand, by the ids that they hold."""

    fits: dict
    model: object = field(default_factory=lambda: SimpleNamespace(size=1, parameters=PARAMETERS))

    def fit(self, solution, settings):
        return self.fits[frozenset(one.id for one in settings)]

    def look(self, solution):
        screen = SimpleNamespace(candidates=[SimpleNamespace(id=name) for name in ("winE", "clock")])
        return SimpleNamespace(
            solution=solution,
            screen=screen,
            gains=np.array([3.0, 1.0]),
            gained=lambda other: solution.objective - other.objective,
        )

    def extended(self, step, index):
        return self.fits[frozenset([step.screen.candidates[index].id])]

    def evidence(self, solution):
        return -0.5 * solution.objective


@dataclass(frozen=True)
class Selected:
    steps: tuple
    final: object
    sets: tuple
    status: str = "named+unknown"
    reserve: str = ""
    evidence: float = 45.0

    def doubted(self, reason):
        return replace(self, status="named+unknown") if self.status in ("named", "one-of") else self

    def unnamed(self):
        return replace(self, steps=self.steps[:1], final=self.steps[0].solution, sets=(), status="unknown")


@pytest.fixture(autouse=True)
def none_alike(monkeypatch):
    monkeypatch.setattr("plasmapyro.diagnosis.select.told.alike", lambda step, name: (name,))


def selected(search, **sizes):
    base, last = fit_of(100.0), fit_of(10.0, **sizes)
    return Selected((search.look(base), search.look(last)), last, tuple((name,) for name in sizes))


def names(selection):
    return [one.id for one in selection.final.settings]


def test_a_deposit_that_may_as_well_be_none_is_no_name():
    search = Fitted({})
    assert names(told(search, selected(search, winE_sl=TOLD - 0.5))) == []
    assert told(search, selected(search, winE_sl=TOLD - 0.5)).status == "unknown"


def test_what_is_told_from_nought_and_what_is_certain_stays():
    search = Fitted({})
    for one in (selected(search, winE_sl=TOLD + 0.5), replace(selected(search, scat=0.5), status="named")):
        assert told(search, one) is one


@pytest.mark.parametrize("better", ["winE_sl", "scat"])
def test_of_two_the_one_goes_without_which_the_fit_is_best_and_the_other_is_asked_again(better):
    alone = {"winE_sl": fit_of(30.0, winE_sl=9.0), "scat": fit_of(30.0, scat=9.0)}
    alone[better].objective = 12.0
    search = Fitted({frozenset([name]): fit for name, fit in alone.items()})
    found = told(search, selected(search, winE_sl=1.0, scat=0.5))
    assert names(found) == [better] and found.sets == ((better,),)
    assert [names(SimpleNamespace(final=step.solution)) for step in found.steps][-1] == [better]
    assert found.status == "named+unknown" and found.reserve == "weak" and found.evidence == 0.5 * (100 - 12)


def test_what_a_number_that_is_off_alone_makes_doubtful_may_be_small():
    one = replace(selected(Fitted({}), scat=0.7), status="named")
    one.final.state.values[0] = 0.01 * 4.0
    assert names(told(Fitted({}), one)) == ["scat"] and told(Fitted({}), one).status == "named+unknown"


def test_the_rest_of_dropped_names_is_asked_for_numbers_that_are_far_off():
    left = fit_of(12.0, winE=9.0)
    left.state.values[0] = 0.01 * 6.0
    search = Fitted({frozenset(["winE"]): left})
    assert names(told(search, selected(search, winE=9.0, scat=0.5))) == []


def test_a_name_that_is_told_is_not_dropped_for_one_that_is_not():
    search = Fitted({frozenset(["Cu"]): fit_of(40.0, Cu=8.0)})
    assert names(told(search, selected(search, Cu=8.0, edge_p=1.0))) == ["Cu"]


@pytest.mark.parametrize(
    ("which", "sigmas", "status", "found"),
    [
        (0, 2.9, "named", "named"),
        (0, -3.1, "named", "named+unknown"),
        (0, 4.9, "named+unknown", "named+unknown"),
        (0, 5.1, "named+unknown", "unknown"),
        (0, 5.1, "named", "unknown"),
        (1, 20.0, "named", "named"),  # the light of the gas is measured
        (2, 20.0, "named", "named"),  # a knot of gains that wander
        (4, 20.0, "named", "named"),  # the one knot of a gas in a short test
    ],
)
def test_names_beside_which_something_known_is_far_off_are_doubtful_or_none(which, sigmas, status, found):
    search = Fitted({frozenset(["clock"]): fit_of(60.0, clock=8.0)})  # explains less than the names do
    one = replace(selected(search, winE=12.0), status=status)
    one.final.state.values[which] = 0.01 * sigmas
    assert told(search, one).status == found


@pytest.mark.parametrize(
    ("objective", "moved", "found"), [(12.0, 0.0, ["clock"]), (12.0, 9.0, []), (30.0, 0.0, [])]
)
def test_the_effect_that_a_number_far_off_is_takes_the_place_of_names_that_explain_no_more(
    objective, moved, found
):
    clock = fit_of(objective, clock=8.0)
    clock.state.values[0] = 0.01 * moved
    search = Fitted({frozenset(["clock"]): clock})
    one = selected(search, edge_s=12.0)
    one.final.state.values[0] = 0.01 * 7.0
    assert names(told(search, one)) == found
    assert told(search, one).reserve == ("own" if found else "")


@pytest.mark.parametrize(("before", "found"), [(0.0, "unknown"), (7.0, "named+unknown")])
def test_an_emittance_that_was_stated_too_surely_costs_no_name(before, found):
    one = selected(Fitted({}), winE=12.0)
    one.steps[0].solution.state.values[-1] = 0.01 * before
    one.final.state.values[-1] = 0.01 * 7.5
    assert told(Fitted({}), one).status == found


@pytest.mark.parametrize(("sigmas", "begun"), [(17.0, 1), (-17.0, 1), (2.9, 0)])
def test_a_clock_that_the_base_model_has_moved_far_begins_a_fit_as_the_effect(sigmas, begun):
    tried = []
    fitter = SimpleNamespace(fit=lambda state, settings: tried.append((state, settings)))
    parameters = (Parameter("gas", "gas", 0.1), Parameter("clocks", "clock", 0.02))
    model = SimpleNamespace(index={"gas": 0, "clocks": 1}, parameters=parameters)
    values = np.array([0.3, 0.02 * sigmas])
    state = State(np.zeros(1), values.copy(), (), (), (), (), np.zeros(0))
    solution = Solution(state, (), *[None] * 14)
    step = SimpleNamespace(solution=solution, settings=())
    newest = Setting(CATALOGUE["clock"], 0.01, {"spectra": 1.0})
    assert len(list(Search(model, fitter, {})._own_clock(step, newest))) == len(tried) == begun
    for moved, (setting,) in tried:
        assert np.array_equal(moved.values, [0.3, 0.0])
        assert setting.amplitude == pytest.approx(0.02 * sigmas) and setting.shape == {}
    assert np.array_equal(state.values, values)
