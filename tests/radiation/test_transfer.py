import numpy as np
import pytest

from plasmapyro.radiation.transfer import cross_layer, escape_fraction, layer_thickness

FLOAT_RTOL = 1e-13


def test_layers_fill_the_path_and_lie_around_their_points():
    thickness = layer_thickness([0.0, 1.0, 3.0, 3.5])
    assert thickness == pytest.approx([0.5, 1.5, 1.25, 0.25])
    assert thickness.sum() == pytest.approx(3.5)


@pytest.mark.parametrize("path", [[0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, np.nan, 1.0]])
def test_paths_that_do_not_increase_are_refused(path):
    with pytest.raises(ValueError, match="path_distance must"):
        layer_thickness(path)


def test_a_single_point_is_no_path():
    with pytest.raises(ValueError, match="at least 2 points; got 1"):
        layer_thickness([0.0])


def test_escape_is_certain_from_thin_gas_and_rare_from_thick_gas():
    assert escape_fraction(np.array([0.0, 1e-12, 1e3])) == pytest.approx([1.0, 1.0, 1e-3], rel=1e-11, abs=0)
    assert escape_fraction(1.0) == pytest.approx(1 - np.exp(-1.0), rel=FLOAT_RTOL, abs=0)


def test_a_slab_cut_in_two_radiates_like_the_whole():
    start = np.array([[2.0, 0.0, 5.0]])
    emission, absorption = np.array([[3.0, 1.0, 0.2]]), np.array([0.5, 0.0, 30.0])
    whole, depth = cross_layer(start, emission, absorption, 0.7)
    half, first = cross_layer(start, emission, absorption, 0.2)
    cut, second = cross_layer(half, emission, absorption, 0.5)
    assert cut == pytest.approx(whole, rel=FLOAT_RTOL, abs=0)
    assert first + second == pytest.approx(depth, rel=FLOAT_RTOL, abs=0)


def test_two_slabs_obey_the_formal_solution():
    (j1, k1, s1), (j2, k2, s2) = (2.0, 0.8, 0.5), (0.3, 1.7, 1.1)
    first, _ = cross_layer(np.zeros((1, 1)), np.array([[j1]]), np.array([k1]), s1)
    both, _ = cross_layer(first, np.array([[j2]]), np.array([k2]), s2)
    exact = j1 / k1 * (1 - np.exp(-k1 * s1)) * np.exp(-k2 * s2) + j2 / k2 * (1 - np.exp(-k2 * s2))
    assert both[0, 0] == pytest.approx(exact, rel=FLOAT_RTOL, abs=0)


def test_a_thick_slab_forgets_what_lies_behind_and_shows_its_source_function():
    behind, _ = cross_layer(np.full((1, 1), 1e6), np.array([[4.0]]), np.array([2.0]), 100.0)
    assert behind[0, 0] == pytest.approx(2.0, rel=FLOAT_RTOL, abs=0)


def test_components_add_up_to_the_total():
    start, emission = np.array([[1.0], [2.0]]), np.array([[0.5], [0.7]])
    parts, _ = cross_layer(start, emission, np.array([0.9]), 1.3)
    total, _ = cross_layer(start.sum(axis=0)[None], emission.sum(axis=0)[None], np.array([0.9]), 1.3)
    assert parts.sum(axis=0) == pytest.approx(total[0], rel=FLOAT_RTOL, abs=0)


def test_inverted_gas_amplifies():
    behind, _ = cross_layer(np.ones((1, 1)), np.zeros((1, 1)), np.array([-0.5]), 1.0)
    assert behind[0, 0] == pytest.approx(np.exp(0.5), rel=FLOAT_RTOL, abs=0)
