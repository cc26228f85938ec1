"""What a fit leaves behind: patterns of any shape, and paths that no spline over time follows."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.fit.inference import Weigher
from plasmapyro.diagnosis.fit.model import History
from plasmapyro.diagnosis.fit.noise import Noise
from plasmapyro.diagnosis.select import leftover

SAMPLES, CHANNELS = 100, 150


@pytest.fixture
def left():
    """`left_over` of residuals (n, C) that are white already."""

    def of(z, channels=CHANNELS):
        instrument = SimpleNamespace(channels=channels, value=z, time=np.arange(len(z)) - 10.0)
        weigher = Weigher(Noise(np.ones(z.shape), np.zeros(len(z)), np.zeros(len(z))), np.zeros(z.shape))
        model, solution = (
            SimpleNamespace(instruments=[instrument], off=70.0),
            SimpleNamespace(residual=[z], prediction=[np.ones(z.shape)], weighers=[weigher]),
        )
        return leftover.left_over(model, solution)

    return of


@pytest.mark.parametrize("seed", range(5))
def test_noise_leaves_nothing(left, seed):
    assert left(np.random.default_rng(seed).standard_normal((SAMPLES, CHANNELS))) is None


def test_lines_that_shine_for_some_seconds_are_a_moment(left):
    z = np.random.default_rng(3).standard_normal((SAMPLES, CHANNELS))
    z[60:64, [40, 41, 90]] += 9.0  # four samples, three channels
    assert left(z) == leftover.MOMENT


def test_a_pattern_that_comes_and_goes_is_one(left):
    random = np.random.default_rng(4)
    z = random.standard_normal((SAMPLES, CHANNELS))
    z += 8 * np.outer(np.sin(np.arange(SAMPLES) / 9), random.standard_normal(CHANNELS)) / np.sqrt(SAMPLES)
    assert left(z) == leftover.PATTERN


@pytest.mark.parametrize("shaken", [0.0, 0.02])
def test_frames_that_are_too_bright_stand_out_of_any_common_noise(shaken):
    """A tenth of the frames are 11 % brighter; alone, 2 % of noise that channels share stands out nowhere.

    The noise is stated as large as both together would make it."""
    random = np.random.default_rng(6)
    value, sigma = np.full((SAMPLES, CHANNELS), 100.0), 1.0
    noise = Noise(np.full(value.shape, sigma**2), np.zeros(SAMPLES), np.full(SAMPLES, 0.04**2))
    weigher = Weigher(noise, 0 * value, value)
    usual = value * shaken * random.standard_normal((SAMPLES, 1)) + sigma * random.standard_normal(
        value.shape
    )
    phase = (np.arange(SAMPLES) >= 10).astype(int)
    assert not leftover.standing_out(usual, value, weigher, phase).any()
    brighter = np.zeros(SAMPLES, dtype=bool)
    brighter[[3, 11, 20, 34, 41, 57, 58, 66, 83, 91]] = True
    found = leftover.standing_out(usual + 11.0 * (1 + shaken) * brighter[:, None], value, weigher, phase)
    assert not found[~brighter].any() and found.sum() >= (10 if not shaken else leftover.FEWEST)


def test_two_bands_have_no_patterns(left):
    assert left(np.random.default_rng(3).standard_normal((SAMPLES, 2)) * 5, channels=2) is None


@pytest.mark.parametrize("power", [0.5, 1.0])
def test_a_path_follows_what_a_flux_does_to_thick_and_thin_samples(power):
    """Sixty kelvin in the first quarter of a second, as an ablator; and as steadily as a bare sheet."""
    off = 100.0
    knots = np.concatenate(
        [np.arange(0.0, 100.0, 8), [off], off + np.array([0.25, 0.75, 1.25, 1.75, 2.25, 3.5, 5, 8, 12])]
    )
    history, time = History(knots, off), off + np.linspace(0, 3, 400)

    def path(time):
        return 1700 - 120 * np.maximum(time - off, 0) ** power

    # A spline over the time itself errs by 6 K where the root begins; a kelvin is 0.6 % of the light.
    assert np.abs(history.basis(time) @ path(knots) - path(time)).max() < 1.0
