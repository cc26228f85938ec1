"""How finely values were written down, and what that makes of means, against rounding done here."""

import numpy as np
import pytest

from plasmapyro.quality.series import fall
from plasmapyro.record import flags
from plasmapyro.record.rounding import rounding

STEP = 0.25


@pytest.mark.parametrize("noise", [0.005, 0.02, 0.1, 0.5, 3.0])
@pytest.mark.parametrize("count", [5, 40, 400])
def test_error_of_a_mean_of_rounded_values(noise, count):
    """Levels that stand still: where noise is below a step all samples of a mean err alike, where it is
    larger each errs on its own."""
    random = np.random.default_rng(1)
    true = random.uniform(5, 50, 400)
    samples = true[:, None] + noise * random.standard_normal((400, count))
    written = STEP * np.round(samples / STEP)
    error = written.mean(axis=1) - samples.mean(axis=1)
    found = np.sqrt(np.mean(rounding(written.ravel()).variance(true, count)))
    # A rule of thumb, see there; 400 means know a standard deviation to 4 %.
    assert 0.8 * error.std() < found < 2.6 * error.std()


def test_digits_of_a_log_are_steps_that_grow_with_the_value():
    random = np.random.default_rng(2)
    true = np.exp(np.linspace(0, 6, 6000)) * (1 + 1e-4 * random.standard_normal(6000))
    written = np.array([float(f"{value:.3g}") for value in true])
    found = rounding(written).variance(np.array([1.5, 15.0, 150.0]), 1)
    # A step of 1 in the third digit, whose error is uniform.
    assert np.sqrt(12 * found) == pytest.approx([0.01, 0.1, 1.0], rel=0.1)


def test_values_that_were_not_rounded_err_by_nothing():
    random = np.random.default_rng(3)
    values = np.linspace(1, 2, 5000) + 1e-3 * random.standard_normal(5000)
    assert np.sqrt(rounding(values).variance(np.array([1.5]), 1))[0] < 1e-5
    ramp = rounding(np.linspace(1, 2, 300))  # without noise neighbours are as far apart as samples
    assert ramp.variance(np.array([1.5]), 1)[0] == 0.0
    assert rounding(np.full(100, 3.0)).variance(np.array([3.0]), 1)[0] == 0.0
    assert rounding(np.full(5, np.nan)).variance(np.array([3.0]), 1)[0] == 0.0


def test_a_unit_does_not_split_a_value_in_two():
    """Steps counted in amperes: the same code may come out a last bit apart."""
    codes = np.repeat(np.arange(1000.0, 1100.0), 20)
    wobbling = codes * 5.7e-13 * (1 + 1e-16 * np.arange(codes.size) % 3)
    assert np.sqrt(12 * rounding(wobbling).variance(wobbling[:1], 1))[0] == pytest.approx(5.7e-13)


@pytest.mark.parametrize("seed", range(3))
def test_light_that_fades_into_the_first_step_is_no_logger_that_hangs(seed):
    random = np.random.default_rng(seed)
    true = np.concatenate([np.full(400, 2000.0), 2000 * np.exp(-np.arange(300) / 25)])
    noise = random.standard_normal(700) * np.hypot(0.18, 1e-3 * true)
    written = np.round(true + noise)
    written[620] = -1.0
    assert not flags.stuck(written[:, None], True).any()


def test_a_coarse_converter_is_no_logger_that_hangs():
    """A faint gas of some thirty steps with noise of a third of one, before a surface of 2000 steps, as
    14 bits have them; then the same with a logger that does hang, and a spike."""
    random = np.random.default_rng(4)
    true = 30 + np.where(np.arange(1500) > 300, np.expm1(np.linspace(-1.5, 7.6, 1500).clip(0)), 0.0)
    written = np.round(true * (1 + 0.002 * random.standard_normal(1500)) + 0.3 * random.standard_normal(1500))
    assert not flags.stuck(written[:, None], True).any() and not flags.spiked(written[:, None]).any()
    written[1200:1230], written[100] = written[1200], 45.0
    assert flags.stuck(written[:, None], True).sum() == 29
    assert np.flatnonzero(flags.spiked(written[:, None])).tolist() == [100]


def test_faint_light_that_scatters_does_not_end():
    """Means of 1 s that scatter by 4 % before a surface shows, and by a thousandth when the plasma ends."""
    random = np.random.default_rng(5)
    time = np.arange(120.0)
    level = np.where(time < 20, 1.0, 30.0) * np.where(time < 90, 1.0, 0.9 * np.exp(-(time - 90) / 60))
    noise = np.where(time < 20, 0.04, 0.001)
    first, last, drop = fall(time, level * (1 + noise * random.standard_normal(120)), 1.0)
    assert first < 90 < last and drop == pytest.approx(0.1, abs=0.01)
