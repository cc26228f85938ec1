"""The search: reproducible, right where the answer is known, and what lies on a Pareto front."""

import numpy as np
import pytest

from plasmapyro.design import gains, search

RANGE, WIDTHS = (650e-9, 1250e-9), (10e-9, 200e-9)
SETTINGS = {"seed": 3, "population": 12, "generations": 80}


def valley(centre, fwhm):
    """Smallest, 0, for bands of 40 nm at 800 and 1000 nm."""
    goal = np.array([800e-9, 1000e-9])[: centre.shape[1]]
    return np.sum((centre - goal) ** 2 + (fwhm - 40e-9) ** 2, axis=1) * 1e14


@pytest.mark.parametrize("bands", [1, 2])
def test_the_search_finds_a_known_minimum(bands):
    centre, fwhm, value = search.optimise(valley, bands, RANGE, WIDTHS, **SETTINGS)
    np.testing.assert_allclose(centre * 1e9, [800, 1000][:bands], atol=1)
    np.testing.assert_allclose(fwhm * 1e9, 40, atol=1)
    assert value < 1e-3


def test_the_same_seed_gives_the_same_bits():
    first, second = (search.optimise(valley, 2, RANGE, WIDTHS, **SETTINGS) for _ in range(2))
    for one, other in zip(first, second, strict=True):
        assert np.array_equal(one, other)


def test_bands_lie_wholly_within_the_range():
    centre, fwhm, _ = search.optimise(lambda c, f: -np.sum(c, axis=1) - f[:, 0], 2, RANGE, WIDTHS, **SETTINGS)
    assert (centre + fwhm / 2 <= RANGE[1] * (1 + 1e-12)).all() and (
        centre - fwhm / 2 >= RANGE[0] * (1 - 1e-12)
    ).all()


def test_pairs_hold_every_two_different_centres_once_shorter_first():
    centre = np.array([3.0, 1.0, 2.0, 1.0])
    found = search.pairs(centre)
    assert (centre[found[:, 0]] < centre[found[:, 1]]).all() and len(found) == 5


def test_the_front_holds_what_nothing_beats():
    benefit = np.array([1.0, 2.0, 2.0, 3.0, 1.5, np.nan])
    cost = np.array([1.0, 2.0, 1.5, 4.0, 1.6, 0.0])
    assert search.pareto_front(benefit, cost).tolist() == [True, False, True, True, False, False]


def test_neighbours_of_an_exponential_law_are_exact_and_missing_beyond_the_ends():
    power = np.array([50e3, 60e3, 70e3])
    found = gains.neighbour_signals(power, np.exp(power / 3e4)[None], 10e3)
    np.testing.assert_allclose(found[0, :2], np.exp(power[1:] / 3e4), rtol=1e-12)
    assert np.isnan(found[0, 2])


def test_a_gain_that_falls_or_rises_by_half_exceeds_its_tolerance_by_the_rest():
    ratio = gains.change(np.array([[50.0, 100.0], [100.0, 150.0]]), np.full((2, 2), 100.0))
    assert gains.excess(ratio, 0.2) == pytest.approx([0.3, 0.3])


def test_no_gain_or_no_limit_counts_as_the_whole():
    assert gains.excess(
        gains.change(np.array([[50.0, np.nan]]), np.array([[-1.0, 9.0]])), 0.2
    ) == pytest.approx([1.0])
