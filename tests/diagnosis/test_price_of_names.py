"""What a term must bring to be named: first, further, from afar, beside something unknown; by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.screen import Candidate, Screen, Structure
from plasmapyro.diagnosis.select import Selector, Step, Thresholds

EFFECT, THIRD, UNKNOWN = 14.0, 19.0, 4.0
NAMES = ("winE", "eps_slope", "P_eff")
COSINE = 0.6  # of window and slope: kin


def solution(objective, *names, power=0.0):
    settings = tuple(SimpleNamespace(id=name, shape={}) for name in names)
    return SimpleNamespace(
        objective=objective, settings=settings, state=SimpleNamespace(values=np.array([power]))
    )


def step(found, refits=None, gains=(400.0, 0.0, 0.0), unknown=-1.0, beside=(0.0, 0.0, 0.0)):
    information = np.array([[1.0, COSINE, 0.0], [COSINE, 1.0, 0.0], [0.0, 0.0, 1.0]])
    candidates = tuple(Candidate(name, {}, 1.0) for name in NAMES)
    walk = (Structure("walk_pyrometer", "wandering", slice(0, 0)),)
    seen = Screen(candidates, walk, np.zeros(3), information, np.ones(3), None)
    return Step(found, seen, np.array(gains), np.array([unknown]), np.array(beside), refits or {})


@pytest.fixture
def selector():
    model = SimpleNamespace(index={"power": 0}, parameters=[SimpleNamespace(sigma=0.08)])
    limits = Thresholds(EFFECT, UNKNOWN, THIRD, 10, 1, np.zeros(1), np.zeros(1))
    one = Selector(model, None, limits)
    one._pruned = lambda fit: fit
    one.evidence = lambda fit: -fit.objective / 2
    return one


def test_a_first_term_pays_the_threshold_of_the_nulls(selector):
    assert selector._needed([step(solution(1000.0))]) == pytest.approx([EFFECT] * 3)


@pytest.mark.parametrize(("pull", "price"), [(0.0, THIRD), (2.9, THIRD), (3.1, 6.634897), (-3.1, 6.634897)])
def test_a_fit_from_afar_pays_more_unless_the_power_left_its_prior(selector, pull, price):
    """6.63: 99 % of one degree of freedom, from a table."""
    far = {"P_eff": solution(900.0, "P_eff")}
    needed = selector._needed([step(solution(1000.0, power=0.08 * pull), far)])
    assert needed == pytest.approx([EFFECT, EFFECT, price], rel=1e-6)


def test_a_further_term_pays_for_inexact_formulas_and_kin_pays_more(selector):
    """400 of chi-squared are explained: 3 % from all, a tenth more from what lies within 66 degrees."""
    needed = selector._needed([step(solution(1000.0)), step(solution(600.0, "winE"))])
    assert needed == pytest.approx([THIRD + 12 + 40, THIRD + 12 + 40, THIRD + 12])


@pytest.mark.parametrize(
    ("gained", "left", "named"),
    [(230.0, 3.0, True), (230.0, 9.0, True), (230.0, 11.0, False), (170.0, 3.0, False)],
)
def test_nine_tenths_of_an_unknown_stand_for_it_if_no_more_is_left(selector, gained, left, named):
    """Log Bayes factor 100: a term gains 2 x (90 + 5) and leaves 10."""
    selector.look = lambda fit: step(fit, unknown=left)
    before, chosen = step(solution(1000.0), unknown=100.0), solution(1000.0 - gained, "winE")
    found = selector._beside_unknown(before, chosen, np.zeros(3), 100.0)
    assert (found is not None) == named
    assert found is None or found.solution is chosen


def test_a_further_term_that_nearly_pays_is_fitted(selector):
    """Of a price of 36 the tangents promise 22 and 17; the fit of the first brings 60."""
    fitted = []

    def extended(before, index):
        fitted.append(NAMES[index])
        names = [one.id for one in before.solution.settings]
        return solution(before.solution.objective - 60.0, *names, NAMES[index])

    selector.extended = extended
    selector.look = lambda fit: step(fit, gains=(0.0, 0.0, 0.0))
    seen = step(solution(600.0, "P_eff"), gains=(22.0, 17.0, 0.0))
    found, unknown = selector._walk([step(solution(1166.7)), seen], {})
    assert fitted == ["winE"] and unknown is None
    assert [one.id for one in found[-1].solution.settings] == ["P_eff", "winE"]


def test_a_first_term_that_nearly_pays_is_not_fitted(selector):
    """Thresholds of first terms are drawn for tangents: fits beyond them would be further tests."""
    selector.extended = None
    found, _ = selector._walk([step(solution(1000.0), gains=(EFFECT - 1, 0.0, 0.0))], {})
    assert len(found) == 1


@pytest.mark.parametrize(
    ("pull", "loss", "back", "named"),
    [(4.0, 15.0, 1.0, True), (4.0, 17.0, 1.0, False), (4.0, 15.0, 3.5, False), (2.9, 1.0, 0.0, False)],
)
def test_a_power_out_of_its_prior_is_a_finding(selector, pull, loss, back, named):
    """At 4 standard deviations, if a term of the gas brings the power back for less than 16."""
    selector.look = lambda fit: step(fit, unknown=-1.0)
    far = solution(1000.0 + loss, "P_eff", power=0.08 * back)
    steps = [step(solution(1000.0, power=0.08 * pull), {"P_eff": far})]
    found, unknown = selector._by_pull(steps, None)
    assert (found[-1].solution is far) == named and unknown is None


def test_which_term_moved_the_power_stays_open(selector):
    far = {name: solution(990.0, name) for name in ("P_eff", "ripple")}
    steps = [step(solution(1000.0, power=0.4), far), step(far["P_eff"])]
    assert selector._behind(steps, "P_eff") == ("ripple",)
    assert selector._behind(steps, "winE") == ()
    steps[0] = step(solution(1000.0, power=0.1), far)
    assert selector._behind(steps, "P_eff") == ()
