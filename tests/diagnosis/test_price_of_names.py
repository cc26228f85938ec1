"""What a term must bring to be named: first, further, beside something unknown; by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.setting import Setting, numbers_of
from plasmapyro.diagnosis.select.alternatives import by_other_window
from plasmapyro.diagnosis.select.prices import needed, outdone
from plasmapyro.diagnosis.select.rounds import beside_unknown, walk
from plasmapyro.diagnosis.select.screen import Candidate, Screen
from plasmapyro.diagnosis.select.search import Search, Step
from plasmapyro.diagnosis.select.structures import Structure
from plasmapyro.diagnosis.select.thresholds import Thresholds

EFFECT, THIRD, UNKNOWN = 14.0, 19.0, 4.0
NAMES = ("winE", "eps_slope", "P_eff")
COSINE = 0.6  # of window and slope: kin


def solution(objective, *names, amplitude=0.01):
    settings = tuple(Setting(CATALOGUE[name], amplitude) for name in names)
    state = SimpleNamespace(amplitudes=numbers_of(settings))
    return SimpleNamespace(objective=objective, settings=settings, state=state)


def step(found, refits=None, gains=(400.0, 0.0, 0.0), unknown=-1.0, beside=(0.0, 0.0, 0.0)):
    information = np.array([[1.0, COSINE, 0.0], [COSINE, 1.0, 0.0], [0.0, 0.0, 1.0]])
    candidates = tuple(Candidate(CATALOGUE[name], {}) for name in NAMES)
    walks = (Structure("walk_pyrometer", "wandering", slice(0, 0)),)
    seen = Screen(candidates, walks, np.zeros(3), information, np.ones(3), None)
    return Step(found, seen, np.array(gains), np.array([unknown]), np.array(beside), refits or {})


@pytest.fixture
def search():
    limits = Thresholds(EFFECT, UNKNOWN, THIRD, 10, 1, np.zeros(1), np.zeros(1))
    one = Search(None, None, CATALOGUE, limits)
    one.pruned = lambda fit: fit
    one.evidence = lambda fit: -fit.objective / 2
    return one


def test_a_first_term_pays_the_threshold_of_the_nulls(search):
    assert needed(search, [step(solution(1000.0))]) == pytest.approx([EFFECT] * 3)


def test_a_further_term_pays_for_inexact_formulas_and_kin_pays_more(search):
    """400 of chi-squared are explained: 3 % from all, a tenth more from what lies within 66 degrees."""
    wanted = needed(search, [step(solution(1000.0)), step(solution(600.0, "winE"))])
    assert wanted == pytest.approx([THIRD + 12 + 40, THIRD + 12 + 40, THIRD + 12])


@pytest.mark.parametrize(
    ("gained", "name", "named"),
    [
        (230.0, "winE", True),
        (102.0, "winE", True),
        (98.0, "winE", False),
        (68.0, "CN", True),
        (65.0, "CN", False),
    ],
)
def test_what_explains_half_of_an_unknown_is_named_beside_what_it_leaves(search, gained, name, named):
    """Log Bayes factor 100, of which 11 are left: half of it is a chi-squared of 100. Of a molecule a third
    does: how bright its bands are to each other its excitation says, which nobody knows."""
    search.look = lambda fit: step(fit, gains=(0.0, 0.0, 0.0), unknown=11.0)
    before, chosen = step(solution(1000.0), unknown=100.0), solution(1000.0 - gained, name)
    found = beside_unknown(search, before, chosen, np.zeros(3))
    assert (found is not None) == named
    if named:
        assert found.solution is chosen
        assert walk(search, [before, found], {})[1] == "walk_pyrometer"


@pytest.mark.parametrize(
    ("evidence", "names", "retracted"),
    [
        (89.0, ["winE"], True),
        (91.0, ["winE"], False),
        (89.0, ["winE", "edge_p"], True),
        (34.0, ["CN"], False),
        (32.0, ["h2o", "winE"], True),
        (0.0, [], False),
    ],
)
def test_names_that_something_unknown_clearly_outdoes_are_none(evidence, names, retracted):
    """Log Bayes factor 100 of it: nine tenths, a third of lines and bands."""
    assert outdone(solution(0.0, *names).settings, evidence, 100.0) == retracted


@pytest.mark.parametrize(("amplitude", "taken"), [(0.01, ["P_eff", "winE"]), (0.8, ["P_eff"])])
def test_a_further_term_that_nearly_pays_is_fitted(search, amplitude, taken):
    """Of a price of 36 the tangents promise 22 and 17; the fit of the first brings 60. At the end of what a
    window may lose it is no measure of one."""
    fitted = []

    def extended(before, index):
        fitted.append(NAMES[index])
        names = [one.id for one in before.solution.settings]
        return solution(before.solution.objective - 60.0, *names, NAMES[index], amplitude=amplitude)

    search.extended = extended
    search.look = lambda fit: step(fit, gains=(0.0, 0.0, 0.0))
    seen = step(solution(600.0, "P_eff"), gains=(22.0, 17.0, 0.0))
    found, unknown = walk(search, [step(solution(1166.7)), seen], {})
    assert fitted == ["winE"] and unknown is None
    assert [one.id for one in found[-1].solution.settings] == taken


def test_a_first_term_that_nearly_pays_is_not_fitted(search):
    """Thresholds of first terms are drawn for tangents: fits beyond them would be further tests."""
    search.extended = None
    found, _ = walk(search, [step(solution(1000.0), gains=(EFFECT - 1, 0.0, 0.0))], {})
    assert len(found) == 1


@pytest.mark.parametrize(
    ("short", "long", "lag"), [(127.0, 426.0, 12.0), (60.0, 426.0, 12.0), (127.0, 120.0, 3.0)]
)
def test_a_first_term_is_fitted_from_all_of_its_shapes(search, short, long, lag):
    """Log Bayes factor 207 of a clock that wanders; a cover that lags by 3 s, as the best tangent has it,
    explains 127 of chi-squared, one that lags by 12 s has a tangent of nothing and ends at 426."""
    lags = tuple(Candidate(CATALOGUE["edge_s"], {"ratio": 0.86, "lag": lag}) for lag in (3.0, 12.0))
    before = step(solution(1000.0), gains=(102.0, 6.0), unknown=207.0, beside=(0.0, 0.0))
    before = replace(before, screen=replace(before.screen, candidates=lags, information=np.eye(2)))

    def fitted(_, index):
        found = solution(1000.0 - (short, long)[index])
        found.settings, found.converged = (Setting(CATALOGUE["edge_s"], 0.03, lags[index].shape),), True
        found.state.amplitudes = numbers_of(found.settings)
        return found

    search._from = fitted
    quiet = {"gains": np.zeros(2), "unknown": np.array([-1.0])}
    search.look = lambda fit: replace(before, solution=fit, **quiet)
    found, unknown = walk(search, [before], {})
    assert [one.shape["lag"] for one in found[-1].settings] == ([lag] if long == 426.0 else [])
    assert unknown == (None if long == 426.0 else "walk_pyrometer")
    assert search.from_all_shapes(before, fitted(before, 0)).settings[0].shape["lag"] == lag


@pytest.mark.parametrize(("worth", "turned"), [(2.0, True), (4.0, False)])
def test_a_window_that_grows_clearer_is_tried_as_the_other_that_takes_a_deposit(search, worth, turned):
    """Beside a change of the emittance the two are each other's opposite; deposits are e^3 times likelier."""
    first = step(solution(1000.0))
    clearer = step(solution(600.0, "winD", amplitude=-0.05), gains=(0.0, 0.0, 0.0))
    other = solution(600.0 + 2 * worth, "winE", amplitude=0.05)
    search.fit = lambda start, settings: other if settings[0].amplitude == 0.05 else None
    search.look = lambda fit: step(fit, gains=(0.0, 0.0, 0.0))
    found, unknown = by_other_window(search, [first, clearer], None)
    assert [one.id for one in found[-1].solution.settings] == (["winE"] if turned else ["winD"])
    assert unknown is None and found[0] is first


def test_a_window_of_an_instrument_that_the_test_lacks_is_no_other_one(search):
    """A pyrometer alone whose window grew clearer had ended in a KeyError: its report has no window E."""
    clearer = step(solution(600.0, "winD", amplitude=-0.05), gains=(0.0, 0.0, 0.0))
    asked = tuple(one for one in clearer.screen.candidates if "pyrometer" in one.effect.instruments)
    clearer = replace(clearer, screen=replace(clearer.screen, candidates=asked))
    assert by_other_window(search, [clearer], None)[0][-1] is clearer


@pytest.mark.parametrize(("map_gains", "said"), [(1.0, "pattern"), (4.0, "smooth")])
def test_a_map_of_two_axes_must_say_more_than_a_pattern_of_one(map_gains, said):
    """A step between two halves of a sensor is both, and nothing that changes."""
    classes = tuple(Structure(one, one, slice(0, 0)) for one in ("pattern", "walk_pyrometer", "smooth"))
    found = step(solution(0.0))
    found = replace(
        found,
        screen=replace(found.screen, structures=classes),
        unknown=np.array([80.0, 70.0, 80.0 + map_gains]),
    )
    assert found.structure == said
