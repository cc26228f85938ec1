"""The way between two conditions, on a problem that only remembers what was asked of it."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.flow import continuation, follow, stage
from plasmapyro.flow.condition import Condition
from plasmapyro.flow.continuation import Extinguished, NotConverged, Schedule
from plasmapyro.flow.follow import HELD_LIMITER, LEAST_PART
from plasmapyro.flow.properties import gas_properties

HERE = Condition(90e3, 5e3, 0.016, 4e5, 350.0)
THERE = replace(HERE, numerical_power=60e3)
FINAL = Schedule(200.0, 1e5, 50)


class Torch:
    """A problem whose state is the power it was solved at."""

    fixed, values = np.zeros(1, bool), np.zeros(1)

    def __init__(self, limiter=0.02):
        self.limiter = limiter

    def with_limiter(self, limiter):
        return Torch(limiter)


@pytest.fixture
def marched(monkeypatch):
    """Function (refuses) -> list of (power, limiter, final) that `follow` marched to; refuses(...) raises."""

    def install(refuses):
        calls = []

        def march(problem, guess, power, schedule, label):
            calls.append((power, problem.limiter, schedule is FINAL))
            refuses(guess[0], power, problem.limiter)
            return SimpleNamespace(state=np.array([power]))

        monkeypatch.setattr(follow, "march", march)
        monkeypatch.setattr(follow, "moved", lambda problem, air, condition: problem)
        return calls

    return install


def go(target=THERE):
    return follow.follow(Torch(), np.array([90e3]), None, HERE, target, 1e4, FINAL, "x")


def test_equal_parts_lead_to_the_target(marched):
    calls = marched(lambda *call: None)
    problem, result = go()
    assert [power for power, _, _ in calls] == pytest.approx([90e3 * (2 / 3) ** (k / 3) for k in (1, 2, 3)])
    assert [last for _, _, last in calls] == [False, False, True]
    assert result.state[0] == 60e3 and problem.limiter == 0.02


def test_a_part_that_fails_is_gone_with_more_viscosity_which_is_taken_back(marched):
    def refuses(start, power, limiter):
        if start - power > 1e3 and limiter < 0.1:
            raise NotConverged("unsteady")

    calls = marched(refuses)
    problem, _ = go()
    assert problem.limiter == 0.02 and calls[-1] == (60e3, 0.02, True)
    held = [power for power, limiter, _ in calls if limiter == HELD_LIMITER]
    assert held[0] == 90e3 and held[-1] == 60e3  # taken up where the failed part began
    assert [limiter for _, limiter, _ in calls[-4:]] == sorted(
        [limiter for _, limiter, _ in calls[-4:]], reverse=True
    )


def test_a_part_that_fails_all_the_same_is_halved(marched):
    def refuses(start, power, limiter):
        if start - power > 6e3 or limiter > 0.02:
            raise NotConverged("unsteady")

    calls = marched(refuses)
    assert go()[1].state[0] == 60e3
    assert sum(limiter > 0.02 for _, limiter, _ in calls) == 1  # more viscosity is tried once


@pytest.mark.parametrize(
    ("kind", "words"), [(NotConverged, "no steady flow was found"), (Extinguished, "the plasma goes out")]
)
def test_a_lost_flow_names_the_conditions_between_which_it_was_lost(marched, kind, words):
    def refuses(start, power, limiter):
        if power < 80e3:
            raise kind("because")

    calls = marched(refuses)
    with pytest.raises(kind, match=rf"x: {words} between 8\d\.\d+ kW, .* and 7\d\.\d+ kW, .*90 kW.*because"):
        go()
    lost = min(power for power, _, _ in calls if power >= 80e3)
    least = max(power for power, _, _ in calls if power < 80e3)
    assert lost / least < 1.5 ** (2 * LEAST_PART / 3 + 1e-9)  # halved down to the least part


def test_a_first_guess_carries_the_new_feed():
    # Fields of two dofs each: axial and radial velocity, ln T, pressure; the first axial one is the inlet's.
    problem = SimpleNamespace(
        space=SimpleNamespace(field=lambda index: slice(2 * index, 2 * index + 2)),
        fixed=np.arange(8) == 0,
        values=np.full(8, 7.0),
    )
    state = np.arange(1.0, 9.0)
    same = follow._fed(problem, state, HERE, THERE)
    np.testing.assert_array_equal(same, [7, 2, 3, 4, 5, 6, 7, 8])
    other = replace(HERE, mass_flow_rate=3 * HERE.mass_flow_rate, chamber_pressure=2 * HERE.chamber_pressure)
    # Three times the gas at twice the density flows 1.5 times as fast.
    np.testing.assert_allclose(follow._fed(problem, state, HERE, other), [7, 3, 4.5, 6, 5, 6, 7, 8])
    np.testing.assert_array_equal(state, np.arange(1.0, 9.0))


@pytest.fixture
def falls(monkeypatch):
    """Function (fate) -> list of (power, schedule); no step of Newton's goes below 75 kW from above."""

    def install(fate=None):
        calls = []

        def march(problem, guess, power, schedule, label):
            calls.append((power, schedule))
            if schedule is follow.FALLING:
                if fate:
                    raise fate("all cold")
                return SimpleNamespace(state=np.array([power]))
            if power < 75e3 < guess[0]:
                raise NotConverged("no such step")
            return SimpleNamespace(state=np.array([power]))

        monkeypatch.setattr(follow, "march", march)
        monkeypatch.setattr(follow, "moved", lambda problem, air, condition: problem)
        return calls

    return install


def test_beyond_the_end_of_a_branch_small_steps_find_another(falls, caplog):
    calls = falls()
    assert go()[1].state[0] == 60e3
    fallen = [power for power, schedule in calls if schedule is follow.FALLING]
    assert len(fallen) == 1 and 60e3 < fallen[0] < 75e3
    # Newton's steps take over at the same condition before the way goes on to its end.
    at = calls.index((fallen[0], follow.FALLING))
    assert calls[at + 1] == (fallen[0], follow.FALLEN) and calls[-1] == (60e3, FINAL)
    assert "jumps to another steady state" in caplog.text


def test_a_plasma_that_goes_out_beyond_the_branch_is_said_to(falls):
    falls(Extinguished)
    with pytest.raises(
        Extinguished, match=r"goes out between 7\d.* and 7\d.*no such step; .*beyond, all cold"
    ):
        go()


def test_there_is_one_fall_on_a_way(falls, monkeypatch):
    falls()
    tried = []

    def back_again(problem, state, power, where):
        tried.append(power)
        return np.array([90e3])

    monkeypatch.setattr(follow, "_fallen", back_again)
    with pytest.raises(NotConverged, match="no steady flow.*no such step"):
        go(replace(HERE, numerical_power=40e3))
    assert len(tried) == 1


def steps(*residuals, courant=1e4):
    return [continuation.Step(residual, 1.0, 0.1, courant, 0.1, 0.1) for residual in residuals]


def test_steps_are_halved_in_a_cycle_and_whole_again_outside():
    share = continuation._share
    assert share(1.0, steps(3.4e-4, 5.0e-4, 3.4e-4)) == 0.5
    assert share(0.25, steps(3.4e-4, 5.0e-4, 3.4e-4)) == 0.25
    assert share(0.5, steps(3.4e-4, 5.0e-4, 1.0e-4)) == 1.0
    assert share(1.0, steps(3.4e-4, 5.0e-4, 3.4e-4, courant=200.0)) == 1.0
    assert share(1.0, steps(3.4e-4, 5.0e-4)) == 1.0


@pytest.fixture(scope="module")
def gas_at_50_mbar(air):
    return gas_properties(air, 5e3, 350.0)


def test_a_newton_step_for_conduction_lands_on_its_solution(gas_at_50_mbar):
    # Steady conduction is linear in S, and d(ln T) = (S - S_0)/(kappa T_0) is Newton's step towards S.
    now, wanted = np.array([400.0, 1200.0, 6900.0]), np.array([9000.0, 4000.0, 8300.0])
    before, conductivity = gas_at_50_mbar.heat_flux_potential(now)
    change = (gas_at_50_mbar.heat_flux_potential(wanted)[0] - before) / (conductivity * now)
    reached = now * np.exp(continuation._conducted(gas_at_50_mbar, np.log(now), change))
    np.testing.assert_allclose(reached, wanted, rtol=1e-8)  # of the inversion of S
    assert change.max() > 20  # with which exp(ln T + change) would have left any table


def test_a_small_step_is_the_same_in_any_variable(gas_at_50_mbar):
    now = np.log([350.0, 3000.0, 7000.0, 11000.0])
    for change in (1e-4, -1e-4):
        found = continuation._conducted(gas_at_50_mbar, now, np.full(4, change))
        np.testing.assert_allclose(
            found, change, rtol=2e-3
        )  # second order: change times d ln(kappa T)/d ln T


def test_what_is_held_stays_to_the_last_digit(gas_at_50_mbar):
    now = np.log([350.0, 5000.0])
    np.testing.assert_array_equal(continuation._conducted(gas_at_50_mbar, now, np.zeros(2)), 0.0)


def test_gas_that_cools_stops_before_the_end_of_the_table(gas_at_50_mbar):
    # Newton's step asks for less heat than there is (S < 0): most of it goes, not all.
    now = np.log([1500.0, 3000.0, 7000.0])
    potential, conductivity = gas_at_50_mbar.heat_flux_potential(np.exp(now))
    change = -1.5 * potential / (conductivity * np.exp(now))
    reached = np.exp(now + continuation._conducted(gas_at_50_mbar, now, change))
    left = gas_at_50_mbar.heat_flux_potential(reached)[0] / potential
    assert np.all((left > 0.1) & (left < 0.5))


def test_no_step_leaves_the_table(gas_at_50_mbar):
    now = np.log([350.0, 3000.0, 14000.0])
    for change in (-50.0, 50.0):
        reached = np.exp(now + continuation._conducted(gas_at_50_mbar, now, np.full(3, change)))
        assert np.all((reached > 200.0 - 1e-9) & (reached < 15000.0 + 1e-9))
        assert np.all(np.sign(np.log(reached) - now) == np.sign(change))


@pytest.mark.parametrize(
    ("temperature", "words"),
    [
        ((400.0, 9000.0), ""),
        ((400.0, 14200.0), ""),
        ((400.0, 14500.0), "hottest gas, 14500 K, .* 15000 K: is the mesh too coarse"),
        ((200.1, 9000.0), "coldest gas.* 200 K"),
    ],
)
def test_a_temperature_held_at_an_end_of_the_table_is_said(temperature, words):
    problem = SimpleNamespace(
        properties=SimpleNamespace(low=200.0, high=15000.0),
        space=SimpleNamespace(field=lambda index: slice(1, 3)),
    )
    state = np.array([0.0, *np.log(temperature)])
    assert re.search(words, continuation._at_an_end(problem, state))
    assert bool(words) == bool(continuation._at_an_end(problem, state))


def test_a_march_that_fails_is_gone_once_more_in_smaller_steps(monkeypatch):
    tried = []

    def march(problem, state, power, schedule, label):
        tried.append(schedule.first_courant)
        if schedule.first_courant > 5:
            raise NotConverged(f"lost at {schedule.first_courant:g}")
        return "found"

    monkeypatch.setattr(continuation, "march", march)
    assert continuation.march_or_slower(None, None, 9e4, Schedule(10.0, 100.0, 9), "start") == "found"
    with pytest.raises(NotConverged, match="lost at 30"):
        continuation.march_or_slower(None, None, 9e4, Schedule(200.0, 1e5, 9), "start")
    assert tried == [10.0, 2.0, 200.0, 30.0]


@pytest.mark.parametrize(
    ("longest", "sixths"),
    [((1.0, 1.0), [2, 4, 6]), ((0.3, 1.0), range(1, 7)), ((0.4, 0.2), [2, 4, 5, 6]), ((0.05, 1), None)],
)
def test_a_step_of_composition_that_fails_is_halved(monkeypatch, longest, sixths):
    """From air to nitrogen by thirds of the way, or less; the longest step in the first half and beyond."""
    gone = [0.0]

    def march(trial, guess, power, schedule, label):
        if trial.share - gone[-1] > longest[gone[-1] > 0.5]:
            raise NotConverged("no acceptable step")
        gone.append(trial.share)
        return SimpleNamespace(state=guess)

    monkeypatch.setattr(stage, "march_or_slower", march)
    monkeypatch.setattr(stage, "_mixed", lambda gas, share, reference: named(gas, share))
    monkeypatch.setattr(stage, "moved", lambda problem, air, reference: at(air.gas.share))

    def named(gas, share):
        return SimpleNamespace(attrs={"gas": f"{share:.3f}"}, share=share)

    def at(share):
        values = np.array([share, 9.0])
        return SimpleNamespace(
            share=share, fixed=np.array([True, False]), values=values, wall_temperature=350.0
        )

    gas = SimpleNamespace(attrs={"gas": "N2"})
    problem, state = SimpleNamespace(wall_temperature=350.0), np.array([0.0, 5.0])
    reference, final = SimpleNamespace(numerical_power=9e4), Schedule(200.0, 1e5, 9)
    if sixths is None:
        with pytest.raises(NotConverged, match="mesh 2: the flow is lost between air and 0.083: no acc"):
            stage._in_gas(gas, problem, state, reference, final, "mesh 2")
        return
    found, result = stage._in_gas(gas, problem, state, reference, final, "mesh 2")
    assert gone[1:] == pytest.approx([one / 6 for one in sixths])
    assert found.share == 1 and list(result.state) == [1.0, 5.0]
