"""The log score of held-out data, against the density of a linear Gaussian model written out."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import cho_factor
from scipy.stats import multivariate_normal

from plasmapyro.diagnosis.select.held_out import SURE, Gain, _held_out, calibration_score, standard_error

SIGMA = 0.3


@pytest.mark.parametrize("short", [0.0, 0.1])
@pytest.mark.parametrize("held", [slice(0, 7), slice(20, 21), slice(40, 45)])
def test_score_of_a_block_is_its_density_given_the_rest(held, short):
    """Rows 40 to 44 measure single parameters, as calibrations do; the fit may have ended `short` of the
    best."""
    random = np.random.default_rng(3)
    rows = np.concatenate([random.standard_normal((40, 5)), np.eye(5)])
    data = rows @ random.standard_normal(5) + SIGMA * random.standard_normal(45)
    matrix = rows.T @ rows / SIGMA**2 + np.eye(5)
    best = np.linalg.solve(matrix, rows.T @ data / SIGMA**2) + short * random.standard_normal(5)
    own, left = rows[held], data[held] - rows[held] @ best
    found = _held_out(
        SimpleNamespace(factor=cho_factor(matrix), score=rows.T @ data / SIGMA**2 - matrix @ best),
        own.T @ own / SIGMA**2,
        own.T @ left / SIGMA**2,
        left @ left / SIGMA**2,
    )
    others = np.ones(45, dtype=bool)
    others[held] = False
    covariance = np.linalg.inv(rows[others].T @ rows[others] / SIGMA**2 + np.eye(5))
    mean = covariance @ rows[others].T @ data[others] / SIGMA**2
    spread = SIGMA**2 * np.eye(left.size) + own @ covariance @ own.T
    density = multivariate_normal(own @ mean, spread).logpdf(data[held])
    # The score leaves out what no model changes: the density of the noise alone at zero.
    constant = -0.5 * left.size * np.log(2 * np.pi * SIGMA**2)
    assert found == pytest.approx(density - constant, rel=1e-6)


def test_standard_error_is_that_of_noise_and_no_less_where_blocks_agree():
    """Of two normal predictions d apart, drawn by the second; two alike blocks scatter by nothing."""
    random = np.random.default_rng(4)
    apart = np.full(4, 3.0)
    drawn = random.standard_normal((200_000, 4))
    ratio = 0.5 * ((drawn + apart) ** 2 - drawn**2)
    assert standard_error(apart**2 / 2) == pytest.approx(ratio.sum(axis=1).std(), rel=0.01)
    assert 10 < SURE * standard_error(np.array([5.0, 5.0]))
    assert 40 > SURE * standard_error(np.array([20.0, 20.0]))
    assert standard_error(np.array([40.0, -20.0])) > standard_error(np.array([30.0, 30.0]))


def test_a_gain_of_one_block_alone_is_told():
    def gain(*scores):
        blocks = tuple((float(i), i + 1.0, score) for i, score in enumerate(scores))
        return Gain(blocks, 0.0, sum(scores), 1.0, None)

    assert gain(0.1, -0.2, 53.0, 1.0).of_a_moment
    assert not gain(10.0, 12.0, 9.0).of_a_moment and not gain(20.0).of_a_moment


def test_a_dark_that_the_effects_spare_is_a_gain_of_the_calibration():
    """Forty channels whose dark the base fit moves by half of what the dark scans allow; the gas, which no
    calibration measured, moves as well and counts for nothing."""
    channels, sigma = 40, 2.0
    sigmas = SimpleNamespace(
        pattern=np.zeros(channels),
        dark=np.full(channels, sigma),
        gas_error=np.ones(channels),
        before_error=np.zeros(channels),
        channels=channels,
    )
    model = SimpleNamespace(size=0, parameters=(), index={}, precision=np.eye(0), instruments=[sigmas])

    def score(moved):
        state = SimpleNamespace(
            values=np.zeros(0),
            pattern=(np.zeros(channels),),
            dark=(np.full(channels, moved),),
            lines=(np.full(channels, 3.0),),
        )
        matrix = np.diag(np.concatenate([np.full(channels, 100.0 / sigma**2), np.full(channels, 100.0)]))
        solution = SimpleNamespace(
            factor=cho_factor(matrix), score=np.zeros(2 * channels), state=state, settings=()
        )
        return calibration_score(model, solution)

    # The data know each dark ten times as well as the scans: (0.5 sigma)^2 / 2 of each, and a per cent.
    assert score(0.0) - score(0.5 * sigma) == pytest.approx(channels * 0.125, rel=0.03)
