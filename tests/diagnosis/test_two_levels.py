"""Values of two kinds, and noise that is of one."""

import numpy as np
import pytest

from plasmapyro.diagnosis.select.two_levels import two_kinds

SIGMA = 1e-3


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("apart", [4.5, -4.5])
def test_values_of_two_kinds_are_told(seed, apart):
    """A seventh of 250 values lies four and a half widths from the others."""
    random = np.random.default_rng(seed)
    value = random.standard_normal(250) + apart * (random.random(250) < 0.14)
    assert two_kinds(SIGMA * value, np.full(250, (0.1 * SIGMA) ** 2))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "law",
    [
        lambda random, n: random.standard_normal(n),
        lambda random, n: random.standard_t(3, n),
        lambda random, n: random.gamma(2, size=n),  # one hump that leans
        lambda random, n: (
            random.standard_normal(n) * (1 + 4 * (np.arange(n) < n // 4))
        ),  # noisier for a while
    ],
)
def test_one_kind_is_none_of_two_whatever_its_tails(seed, law):
    value = SIGMA * law(np.random.default_rng(seed), 250)
    assert not two_kinds(value, np.full(250, (0.1 * SIGMA) ** 2))


def test_two_outliers_are_no_kind():
    value = SIGMA * np.random.default_rng(1).standard_normal(250)
    value[[40, 90]] += 30 * SIGMA
    assert not two_kinds(value, np.full(250, (0.1 * SIGMA) ** 2))
