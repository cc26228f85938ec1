"""Where the rate of a surface changes at once, bins end; where it does not, they stay."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.diagnosis.fit import steep
from plasmapyro.diagnosis.fit.corners import around
from plasmapyro.diagnosis.fit.model import History, knots
from plasmapyro.record.binning import time_edges

OFF, END = 120.0, 140.0
EDGES = time_edges(-5.0, END, 0.0, OFF)
HISTORY = History(knots(EDGES, 0.0, OFF, END), OFF)
TIME = np.arange(8.0, END, 0.04)
HEATS = 350 + 1350 * -np.expm1(-TIME / 35.0)
HEATS[TIME > OFF] -= 60 * np.sqrt(TIME[TIME > OFF] - OFF)


def seen(kelvin, seed=3):
    """With 0.2 % of noise in the light, 0.3 K, and what lasts for seconds, 0.2 K."""
    random = np.random.default_rng(seed)
    slow = np.convolve(random.standard_normal(TIME.size + 99), np.full(100, 0.2 / 10), "valid")
    return kelvin + 0.3 * random.standard_normal(TIME.size) + slow


def melting(since, until):
    """Heating that stands still between two moments, and goes on from there."""
    own = np.interp(np.where(TIME > until, TIME - (until - since), np.minimum(TIME, since)), TIME, HEATS)
    return np.where(TIME > OFF, own[TIME <= OFF][-1] - 60 * np.sqrt(np.maximum(TIME - OFF, 0)), own)


@pytest.mark.parametrize("seed", range(5))
def test_a_smooth_course_has_no_corner(seed):
    assert np.array_equal(around(EDGES, TIME, seen(HEATS, seed), HISTORY), EDGES)


@pytest.mark.parametrize("moments", [(45.0, 70.0), (60.0, 100.0)])
def test_bins_end_where_a_surface_begins_and_ceases_to_melt(moments):
    edges = around(EDGES, TIME, seen(melting(*moments)), HISTORY)
    for moment in moments:
        near = np.argsort(np.abs(edges - moment))[:2]
        assert np.abs(edges[near[0]] - moment) < 0.5 and np.ptp(edges[near]) < 2.0
    assert edges.size < EDGES.size + 40


def test_a_gain_that_steps_is_no_corner():
    """A surface is continuous: 12 K at once are no change of its rate."""
    assert np.array_equal(around(EDGES, TIME, seen(HEATS + 12.0 * (TIME > 65.0)), HISTORY), EDGES)


def test_the_temperature_may_bend_at_a_corner(monkeypatch):
    """In the model that is fitted: its knots lie close there, with the bend that is seen."""
    path = seen(melting(60.0, 100.0))
    monkeypatch.setattr(steep, "seen_by_most", lambda *_, **__: ((TIME, path), 700.0))
    monkeypatch.setattr(steep, "time_bins", lambda _: (EDGES, ()))
    found = steep.steep(SimpleNamespace(history=HISTORY, record=None, off=OFF))
    own = History(
        found_knots := knots(found.edges, 0.0, OFF, END), OFF, bend=np.interp(found_knots, *found[1:])
    )
    truth = np.interp(own.knots[own.before], TIME, melting(60.0, 100.0))
    late = own.knots[own.before] > 45
    rows = own.roughness()[: own.before.sum() - 2][:, own.before]
    plain = History(own.knots, OFF).roughness()[: own.before.sum() - 2][:, own.before]
    assert np.abs(plain @ truth)[late[1:-1]].max() > 5 > 2.0 > np.abs(rows @ truth)[late[1:-1]].max()
