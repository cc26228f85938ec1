"""The algebra of the chain against dense matrices, and its prior against simulation."""

import dataclasses

import numpy as np
import pytest

from plasmapyro.estimate.banded import Factor, inner, lower_band, solve_bordered
from plasmapyro.estimate.dynamics import FLICKER, GAS, RATE, TEMPERATURE, ChainPrior, Dynamics, transition

EXACT = 1e-9  # round-off of matrices with condition numbers up to 1e6
DYNAMICS = Dynamics(
    quiet=0.5, bending=20.0, memory=5.0, kick=30.0, gas=1e-4, gas_start=1e-3, flicker=0.02, flicker_time=0.4
)


def dense(diagonal, below):
    count, size, _ = diagonal.shape
    whole = np.zeros((count * size, count * size))
    for k in range(count):
        whole[k * size : (k + 1) * size, k * size : (k + 1) * size] = diagonal[k]
        if k + 1 < count:
            whole[(k + 1) * size : (k + 2) * size, k * size : (k + 1) * size] = below[k]
            whole[k * size : (k + 1) * size, (k + 1) * size : (k + 2) * size] = below[k].T
    return whole


@pytest.fixture(scope="module")
def blocks():
    random = np.random.default_rng(1)
    diagonal = random.standard_normal((6, 4, 4))
    diagonal = diagonal @ np.swapaxes(diagonal, 1, 2) + 12 * np.eye(4)
    return diagonal, random.standard_normal((5, 4, 4))


def test_band_storage_holds_the_lower_triangle(blocks):
    whole, band = dense(*blocks), lower_band(*blocks)
    for offset in range(8):
        np.testing.assert_array_equal(band[offset, : 24 - offset], np.diag(whole, -offset))


def test_factor_solves_and_inverts_like_the_dense_matrix(blocks):
    whole, factor = dense(*blocks), Factor(*blocks)
    right = np.arange(24.0)
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(whole, right), rtol=EXACT)
    assert factor.log_determinant() == pytest.approx(np.linalg.slogdet(whole)[1], rel=EXACT)


def test_border_gives_the_marginal_covariance_of_the_whole(blocks):
    random = np.random.default_rng(2)
    border, corner = random.standard_normal((24, 3)), 20 * np.eye(3)
    whole = np.block([[dense(*blocks), border], [border.T, corner]])
    right = random.standard_normal(27)
    states, values, effect, covariance = solve_bordered(
        Factor(*blocks), border, corner, right[:24], right[24:]
    )
    np.testing.assert_allclose(np.append(states, values), np.linalg.solve(whole, right), rtol=EXACT)
    inverse = np.linalg.inv(whole)
    np.testing.assert_allclose(covariance, inverse[24:, 24:], rtol=EXACT)
    own = np.linalg.inv(dense(*blocks)) + effect @ covariance @ effect.T
    np.testing.assert_allclose(own, inverse[:24, :24], rtol=1e-8, atol=1e-12)


def test_a_product_of_tall_matrices_in_pieces_is_the_product():
    """Of fewer rows than a piece, of whole pieces, and of some more."""
    generator = np.random.default_rng(1)
    for rows in (5, 128, 1000):
        left, right = generator.normal(size=(rows, 3)), generator.normal(size=(rows, 2))
        np.testing.assert_allclose(inner(left, right), left.T @ right, rtol=1e-12, atol=1e-12)


def walk(dynamics, time, count, seed):
    """Random paths (count, n, 4) of the chain, from its first state 0."""
    matrix, covariance = transition(dynamics, time, (0.0,), 0.0)
    random = np.random.default_rng(seed)
    state = np.zeros((count, 4))
    path = [state]
    for one, spread in zip(matrix, covariance, strict=True):
        kicks = random.multivariate_normal(np.zeros(4), spread, size=count)
        state = state @ one.T + kicks
        path.append(state)
    return np.stack(path, axis=1)


def test_the_process_does_not_depend_on_how_finely_it_is_sampled():
    """Variance after 10 s, long after the last switch: closed forms of the three processes."""
    time = np.linspace(100.0, 110.0, 41)
    last = walk(DYNAMICS, time, 4000, 3)[:, -1]
    expected = {
        TEMPERATURE: DYNAMICS.quiet * 10.0**3 / 3,
        RATE: DYNAMICS.quiet * 10.0,
        GAS: DYNAMICS.gas * 10.0,
        FLICKER: DYNAMICS.flicker**2,
    }
    for place, variance in expected.items():
        assert last[:, place].var() == pytest.approx(variance, rel=0.12)  # 5 sigma of 4000 draws


def test_two_steps_are_one_step_of_twice_the_length():
    fine = transition(DYNAMICS, np.array([50.0, 50.7, 51.4]), (), 0.0)
    coarse = transition(DYNAMICS, np.array([50.0, 51.4]), (), 0.0)
    matrix, covariance = fine[0], fine[1]
    np.testing.assert_allclose(matrix[1] @ matrix[0], coarse[0][0], rtol=1e-12)
    chained = matrix[1] @ covariance[0] @ matrix[1].T + covariance[1]
    np.testing.assert_allclose(chained, coarse[1][0], rtol=1e-12, atol=1e-15)


def test_a_switch_kicks_the_rate_and_forgets_the_gas_before():
    time = np.arange(-10, 3) / 10
    matrix, covariance = transition(DYNAMICS, time, (0.0,), 0.0)
    kicked = covariance[:, GAS, GAS] == DYNAMICS.gas_start**2
    assert covariance[kicked, RATE, RATE] > DYNAMICS.kick**2
    assert kicked.sum() == 1 and time[1:][kicked] == pytest.approx(0.0, abs=1e-12)
    assert (matrix[:, GAS, GAS] == 0).tolist() == kicked.tolist()
    assert covariance[kicked, GAS, GAS] == pytest.approx(DYNAMICS.gas_start**2, rel=1e-12)


def test_prior_value_gradient_and_blocks_belong_together():
    time = np.array([-0.3, -0.1, 0.0, 0.1, 0.4, 1.0])
    moved = transition(DYNAMICS, time, (0.0,), 0.0)
    prior = ChainPrior(*moved, np.array([350.0, 0.0, 0.5, 0.0]), np.diag([100.0, 0.1, 1.0, 0.01]))
    random = np.random.default_rng(4)
    path = np.array([350.0, 0.0, 0.5, 0.0]) + random.standard_normal((6, 4)) * [1, 1, 0.01, 0.01]
    value, gradient = prior.value_and_gradient(path)
    whole = dense(*prior.blocks())
    step = random.standard_normal((6, 4)) * [1, 1, 0.01, 0.01]
    then, _ = prior.value_and_gradient(path + step)
    quadratic = gradient.ravel() @ step.ravel() + 0.5 * step.ravel() @ whole @ step.ravel()
    assert then - value == pytest.approx(quadratic, rel=1e-6)
    assert prior.log_determinant == pytest.approx(-np.linalg.slogdet(whole)[1], rel=1e-6)


def chained(quiet, steps):
    """Prior of a chain whose temperature is nearly straight, and what a thermometer says late in it."""
    time = np.linspace(0.02, 0.02 * steps, steps)
    dynamics = dataclasses.replace(DYNAMICS, quiet=quiet, bending=0.0, kick=0.0)
    moved = transition(dynamics, time, (), 0.0)
    prior = ChainPrior(*moved, np.zeros(4), np.diag([2500.0, 100.0, 1.0, 1e-4]))
    information = np.zeros((steps, 4, 4))
    information[-3:, TEMPERATURE, TEMPERATURE] = 100.0
    information[:, GAS, GAS] = 1e4
    return prior, information


def test_covariances_of_the_states_are_blocks_of_the_dense_inverse():
    prior, information = chained(50.0, 12)
    diagonal, below = prior.blocks()
    inverse = np.linalg.inv(dense(diagonal + information, below))
    expected = [inverse[4 * k : 4 * k + 4, 4 * k : 4 * k + 4] for k in range(12)]
    np.testing.assert_allclose(prior.spread(information), expected, rtol=1e-6, atol=1e-9)


def test_a_stiff_chain_keeps_the_uncertainty_of_what_no_sample_shows():
    """3000 steps whose inverse covariance spans 1e17: the temperature is a straight line, seen at its end."""
    prior, information = chained(1e-6, 3000)
    spread = prior.spread(information)
    assert (np.linalg.eigvalsh(spread) > 0).all()
    # A line of two numbers, 0 +- 50 K and 0 +- 10 K/s at first, and three thermometers of 0.1 K at its end.
    row = np.array([np.ones(3), 0.02 * np.arange(2997, 3000)])
    left = np.linalg.inv(np.diag([1 / 2500.0, 1 / 100.0]) + 100.0 * row @ row.T)
    assert spread[0, TEMPERATURE, TEMPERATURE] == pytest.approx(left[0, 0], rel=1e-3)
