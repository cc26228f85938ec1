"""Half widths of intervals of a normal plus a bounded error, against limits and against drawn numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.report.interval import estimated_beside_bounded, half_width
from plasmapyro.diagnosis.report.temperature import COLOUR, doubtful, other_clock, other_colour


def test_each_error_alone_has_its_own_interval():
    normal, rectangular, none = half_width([2.0, 0.0, 0.0], [0.0, 3.0, 0.0])
    assert normal == pytest.approx(2.0 * 1.959963984540054, rel=1e-6)  # a table of the normal law
    assert rectangular == pytest.approx(0.95 * 3.0, rel=1e-6)
    assert none == 0.0


@pytest.mark.parametrize(("sigma", "bound"), [(1.0, 1.0), (0.3, 2.0), (5.0, 2.0)])
def test_the_interval_holds_as_many_drawn_numbers_as_it_says(sigma, bound):
    random = np.random.default_rng(5)
    count = 400_000
    drawn = random.normal(0, sigma, count) + random.uniform(-bound, bound, count)
    for level in (0.5, 0.95, 0.999):
        inside = np.mean(np.abs(drawn) < half_width(sigma, bound, level))
        # five standard deviations of the share of so many numbers
        assert inside == pytest.approx(level, abs=5 * np.sqrt(level * (1 - level) / count))


def test_many_moments_at_once_are_the_same_as_one_by_one():
    sigma, bound = np.array([1.0, 0.2]), np.array([0.5, 4.0])
    alone = [float(half_width(s, a)) for s, a in zip(sigma, bound, strict=True)]
    assert half_width(sigma, bound) == pytest.approx(alone, rel=1e-12)


@pytest.mark.parametrize("known", [0.5, 2.0, 20.0])
def test_an_estimate_beside_a_bounded_bias_is_within_its_interval_as_often_as_said(known):
    """One reading of T with a bias u, and one of u alone, good to `known`; u is uniform, its prior normal."""
    random = np.random.default_rng(6)
    count, bound, noise, prior_t = 200_000, 3.0, 0.4, 50.0
    u, t = random.uniform(-bound, bound, count), random.normal(0, prior_t, count)
    readings = np.array([t + u + noise * random.normal(size=count), u + known * random.normal(size=count)])
    slopes = np.array([[1.0, 1.0], [0.0, 1.0]])
    weight = slopes.T @ np.diag([noise**-2.0, known**-2.0])
    prior = bound / np.sqrt(3)
    posterior = np.linalg.inv(weight @ slopes + np.diag([prior_t**-2, prior**-2]))
    found = (posterior @ weight @ readings)[0]
    half = estimated_beside_bounded(posterior[0, 0], posterior[0, 1], prior)
    # five standard deviations of the share of so many numbers
    assert np.mean(np.abs(found - t) < half) == pytest.approx(0.95, abs=5 * np.sqrt(0.95 * 0.05 / count))


@pytest.mark.parametrize(("late", "kelvin"), [((0.4,), 4.0), ((-0.4, 0.0), -4.0), ((), 0.0)])
def test_the_other_clock_shows_the_temperature_of_another_instant(late, kelvin):
    """A surface that heats by 10 K/s, in bins of unlike width."""
    times = np.array([0.0, 0.5, 1.5, 4.0])
    settings = [SimpleNamespace(late=lambda kind, one=one: one * (kind == "pyrometer")) for one in late]
    solution = SimpleNamespace(settings=settings, state=SimpleNamespace(knots=300.0 + 10.0 * times))
    assert other_clock(solution, np.eye(4), times) == pytest.approx(np.full(4, kelvin), abs=1e-9)


def test_one_bin_has_no_other_clock():
    """A lamp seen in one exposure."""
    solution = SimpleNamespace(settings=(), state=SimpleNamespace(knots=np.array([1500.0])))
    assert other_clock(solution, np.eye(1), np.zeros(1)) == [0.0]


@pytest.mark.parametrize(
    ("applied", "status", "kept"),
    [
        (False, "named", 1.0),
        (True, "named", 0.0),
        (True, "named+unknown", 0.6),
        (False, "named+unknown", 1.0),
    ],
)
def test_a_name_with_reserve_widens_the_interval_by_the_chance_that_it_is_wrong(applied, status, kept):
    """Of two names 0.5 and 0.14 likely, one of which moves the temperature, 0.36 is the chance of neither."""
    settings = [SimpleNamespace(id="clock"), SimpleNamespace(id="winE")]
    findings = SimpleNamespace(
        applied=applied,
        status=status,
        final=SimpleNamespace(settings=settings),
        probability=({"clock": 0.5, "winE": 0.14, "unknown": 0.3, "none": 0.06}, 0.5),
    )
    np.testing.assert_allclose(doubtful(findings, np.array([10.0, -5.0])), kept * np.array([10.0, -5.0]))


def bands_alone(slope, gas, weight=True):
    """A model of bands alone and its fit: slopes (n, C) of the surface, light (n, C) of the gas."""
    one = SimpleNamespace(weight=weight or None, channels=gas.shape[1], time=np.arange(len(gas)) + 0.5)
    jacobian = np.stack([0.4 * slope, 0.6 * slope, np.full_like(slope, 9.0)], axis=2)  # two knots, a value
    return SimpleNamespace(instruments=[one], size=2), SimpleNamespace(gas=(gas,), jacobian=(jacobian,))


@pytest.mark.parametrize("bands", [2, 3])
def test_a_gas_of_another_colour_costs_what_least_squares_say(bands):
    """Against the covariance of temperature and brightness from independent errors of each band."""
    slope = np.array([[0.02, 0.5, 0.9], [1e-4, 6e-3, 2e-3], [0.3, 0.1, 0.7]])[:, :bands]
    gas = np.array([[3.0, 2.0, 1.0], [3.0, 2.0, 1.5], [0.0, 0.0, 0.0]])[:, :bands]
    cost = other_colour(*bands_alone(slope, gas), np.arange(3) + 0.5)
    for place in range(2):
        design = np.stack([slope[place], gas[place]], axis=1)
        inverse = np.diag(2 / (COLOUR * gas[place]) ** 2)
        covariance = np.linalg.inv(design.T @ inverse @ design)
        assert cost[place] == pytest.approx(np.sqrt(covariance[0, 0]), rel=1e-9)
    assert cost[2] == 0.0  # after the end of the plasma


def test_one_band_or_a_spectrum_beside_it_costs_nothing():
    slope, gas = np.ones((2, 1)), np.ones((2, 1))
    assert not other_colour(*bands_alone(slope, gas), np.arange(2) + 0.5).any()
    slope, gas = np.array([[0.1, 0.5]]), np.ones((1, 2))
    model, fit = bands_alone(slope, gas)
    assert other_colour(model, fit, np.array([0.5])).all()
    assert not other_colour(*bands_alone(slope, gas, weight=False), np.array([0.5])).any()
    model.instruments *= 2
    assert not other_colour(model, fit, np.array([0.5])).any()
