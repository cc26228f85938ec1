"""Finer bins where a surface heats or cools faster than the usual bins follow.

These suit a temperature that runs as the root of the time since it was put into the plasma, or since the end:
a slope of (T - T0)/2t. Where the light shows a slope q times as steep, a bin becomes q pieces, down to single
samples, and the temperature may bend as it is seen to; so it may where it has a corner.
"""

from typing import NamedTuple

import numpy as np

from plasmapyro.diagnosis.fit.base import LEAST_SEEN, seen_by_most
from plasmapyro.diagnosis.fit.corners import around
from plasmapyro.diagnosis.fit.model import INITIAL_TEMPERATURE
from plasmapyro.diagnosis.fit.observation import time_bins

FASTER = 1.5  # times the slope of a root that a bin follows: its light then changes fourfold at most
LEAST_STEP = 10.0  # [K] from bin to bin: less needs no finer ones
LEAST_CHANGE = 100.0  # [K] of T - T0: a steady surface has none
ROUNDS = 5  # of dividing: a step within a bin shows its slope once it is divided


class Steep(NamedTuple):
    """Edges (n+1,) [s] of the bins, and how far the temperature may bend (k,) [K s-2] at times (k,) [s]."""

    edges: np.ndarray
    time: np.ndarray
    bend: np.ndarray


def steep(model):
    """The `Steep` of the surface before a `Model`; None where its bins follow it."""
    (time, kelvin), limit = seen_by_most(model, samples=True)
    if not model.history.cold or time.size < LEAST_SEEN:
        return None
    usual = time_bins(model.record)[0]
    edges = around(usual, time, kelvin, model.history)
    for _ in range(ROUNDS):
        middle, mean = _in_bins(edges, time, kelvin)
        parts = _parts(edges, middle, mean, model.off, limit, np.median(np.diff(time)))
        if not (parts > 1).any():
            break
        pieces = zip(edges[:-1], edges[1:], parts, strict=True)
        edges = np.concatenate([*(np.linspace(a, b, n, endpoint=False) for a, b, n in pieces), edges[-1:]])
    if np.array_equal(edges, usual):
        return None
    middle, mean = _in_bins(edges, time, kelvin)
    slope = np.diff(mean) / np.diff(middle)
    bend = np.zeros(middle.size)
    bend[1:-1] = np.abs(np.diff(slope)) / ((middle[2:] - middle[:-2]) / 2)
    place = np.searchsorted(edges, middle, side="right") - 1
    divided = ~np.isin(edges[:-1], usual) | ~np.isin(edges[1:], usual)
    bend = np.where(divided[place], bend, 0.0)
    # Between two bins as well; and what is not seen may begin at once with the slope that is seen first.
    bend = np.maximum.reduce([bend, np.append(bend[1:], 0.0), np.append(0.0, bend[:-1])])
    begins = abs(slope[0]) / (edges[place[0] + 1] - edges[place[0]]) if divided[place[0]] else 0.0
    return Steep(edges, np.append(0.0, middle), np.append(max(begins, bend[0]), bend))


def _in_bins(edges, time, kelvin):
    """Mean times (m,) and temperatures (m,) of the samples of each bin that holds some."""
    _, place, count = np.unique(
        np.searchsorted(edges, time, side="right"), return_inverse=True, return_counts=True
    )
    return tuple(np.bincount(place, one) / count for one in (time, kelvin))


def _parts(edges, time, kelvin, off, limit, step):
    """Pieces (n,) that each bin is to become; `limit` [K]: colder surfaces are not seen; `step` [s] between
    samples."""
    parts = np.ones(edges.size - 1, dtype=int)
    middle, length = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    for chosen, start in ((time < off, 0.0), (time > off, off)):
        if chosen.sum() < 2:
            continue
        own, value = time[chosen], kelvin[chosen]
        slope = np.abs(np.diff(value) / np.diff(own))
        slope = np.maximum(np.append(slope[0], slope), np.append(slope, slope[-1]))
        first = INITIAL_TEMPERATURE if start == 0 else value[0]
        usual = np.maximum(np.abs(value - first), LEAST_CHANGE) / (2 * (own - start))
        # Before it is seen it heats as when it is seen first, from the temperature at which it began.
        begins = own[0] - (limit - INITIAL_TEMPERATURE) / slope[0] if start == 0 else off
        inside = (middle > begins) & (middle > start) & (middle < (off if start == 0 else np.inf))
        here, times = (np.interp(middle, own, one) for one in (slope, slope / usual))
        wanted = np.minimum.reduce([times / FASTER, here * length / LEAST_STEP, length / step + 1e-6])
        parts[inside] = np.maximum(np.round(np.minimum(wanted, 1e6)), 1).astype(int)[inside]
    return parts
