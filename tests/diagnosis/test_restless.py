"""What wanders more than assumed is believed; a drift, an event and data that say nothing change no prior."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.fit.persistent import GAS_WANDER, wandering_gas
from plasmapyro.diagnosis.fit.restless import MOST, wandering

SPREAD = 0.3  # [1]: 39 second differences, the largest left out, know a standard deviation to 15 %


def fitted(values, covariance):
    """A model whose gas may wander, and what a fit says of it."""
    own = wandering_gas(-20.0, 330.0)
    model = SimpleNamespace(own=own, wandering=list(range(len(own))), size=0)
    return model, SimpleNamespace(state=SimpleNamespace(values=values), covariance=covariance)


def found(history=None, seed=1, size=0.015, error=1e-4):
    """Standard deviation that a record tells, in which the gas has a history, or wanders by a size [1]."""
    own = wandering_gas(-20.0, 330.0)
    root = np.array([one.history[1] for one in own]).T
    values = size * np.random.default_rng(seed).standard_normal(len(own))
    if history is not None:
        values = np.linalg.solve(root, history(np.array(own[0].history[0])))
    inverse = np.linalg.inv(root)
    return wandering(*fitted(values, error**2 * inverse @ inverse.T))


@pytest.mark.parametrize("seed", range(4))
def test_a_gas_that_wanders_by_a_per_cent_and_a_half_is_believed(seed):
    assert found(seed=seed) == pytest.approx(0.015, rel=SPREAD)


def test_a_gas_is_not_believed_to_wander_without_end():
    assert found(size=0.1) == MOST


@pytest.mark.parametrize("seed", range(4))
def test_a_gas_as_quiet_as_assumed_stays_so(seed):
    assert found(seed=seed, size=0.8 * GAS_WANDER) is None


def test_a_drift_is_no_wandering():
    assert found(lambda time: 0.1 * time / 300) is None
    assert found(lambda time: -0.1 * np.expm1(-np.maximum(time, 0) / 100)) is None


def test_an_event_is_no_wandering():
    assert found(lambda time: 0.1 * (time > 150)) is None
    assert found(lambda time: 0.1 * np.exp(-(((time - 100) / 8) ** 2))) is None


def test_data_that_say_nothing_change_nothing():
    count = len(wandering_gas(-20.0, 330.0))
    assert wandering(*fitted(np.zeros(count), GAS_WANDER**2 * np.eye(count))) is None
