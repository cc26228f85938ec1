"""A temperature that leaves its course for a moment, told from what does not come back."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.fit.model import History
from plasmapyro.diagnosis.select.excursion import excursion, name

OFF, ERROR = 200.0, 1.0  # [s], [K]
KNOTS = np.concatenate([np.arange(0.0, OFF, 2.0), OFF + np.arange(0.0, 60.0, 4.0)])


def slab(time, start=0.0):
    """Surface (t,) [K] of a half space above 300 K, of a flux from `start` [s] on: as the root of time."""
    return 75.0 * np.sqrt(np.maximum(time - start, 0.0))


def found(kelvin):
    """What an excursion makes of knots (K,) [K] that a fit tells to `ERROR`."""
    model = SimpleNamespace(history=History(KNOTS, OFF), size=KNOTS.size, plasma=True)
    solution = SimpleNamespace(
        state=SimpleNamespace(knots=kelvin), covariance=ERROR**2 * np.eye(KNOTS.size + 3)
    )
    return model, excursion(model, solution)


def usual():
    cooled = np.where(KNOTS > OFF, 0.6 * slab(KNOTS, OFF), 0.0)
    random = np.random.default_rng(2)
    return 300.0 + slab(KNOTS) - cooled + random.normal(0, ERROR, KNOTS.size)


@pytest.mark.parametrize("size", [40.0, -40.0])
def test_what_crosses_the_view_is_found_with_its_size_and_time(size):
    model, change = found(usual() + size * np.exp(-(((KNOTS - 90) / 6) ** 2)))
    assert np.abs(change).max() == pytest.approx(40.0, rel=0.3)
    assert np.sign(size) * change[np.abs(KNOTS - 90).argmin()] > 20
    assert not change[np.abs(KNOTS - 90) > 30].any()
    assert f"{size:+.0f}"[0] in name(model, change) and " s after the injection" in name(model, change)


@pytest.mark.parametrize(
    "more",
    [
        0.0,
        0.5 * slab(KNOTS, 80.0) * (KNOTS < OFF),  # half as much flux again
        -30.0 * np.clip((KNOTS - 80) / 20, 0, 1) * (KNOTS < OFF),  # heat that melting takes
        20.0 * np.exp(-(((KNOTS - 90) / 6) ** 2)),  # it heats on all the while
    ],
    ids=["nothing", "step of flux", "melting", "heating on"],
)
def test_what_does_not_come_back_is_none(more):
    assert found(usual() + more)[1] is None


def test_a_furnace_has_no_course_to_leave():
    model = SimpleNamespace(history=History(KNOTS, OFF, cold=False), size=KNOTS.size, plasma=True)
    assert excursion(model, None) is None
