"""Causes that look nearly as a temperature and an emittance do: told by a little of much information."""

import numpy as np
import pytest
from small_laboratory import OFF, temperature_of

from plasmapyro.diagnosis import command
from plasmapyro.diagnosis.fit.model import BULGE, History, knots
from plasmapyro.diagnosis.select.screen import gain
from plasmapyro.diagnosis.stage import diagnose

FAST = 0.02  # [s] from sample to sample


def plateau(diagnosis):
    """Errors [K] of the base and the extended temperature of a steady surface, and half its interval."""
    found = diagnosis.temperature
    time = found["time_bin"].values
    steady = (time > 60) & (time < OFF - 1)
    base, last = (
        np.mean((found[name].values - temperature_of(time))[steady])
        for name in ("base_temperature", "extended_temperature")
    )
    ends = [found[f"extended_temperature_{end}"].values[steady] for end in ("low", "high")]
    return base, last, float(np.mean(ends[1] - ends[0])) / 2


def test_a_slope_of_the_emittance_is_found_though_little_of_it_is_left(diagnosed):
    """A slope of 0.5/um is a hotter surface of less emittance, but for some 1e-7 of its information."""
    found = diagnosed(slope=0.5, period=FAST)
    assert found.report["verdict"]["named"] == ["eps_slope"]
    (one,) = [one for one in found.report["candidates"] if one["id"] == "eps_slope"]
    assert one["amplitude"] == pytest.approx(0.5, abs=3 * one["standard_error"])
    base, last, half = plateau(found)
    assert abs(base) > 40 > 4 * abs(last) and abs(last) < half


def test_spectra_alone_let_the_emissivity_bend(record, laboratory):
    """No second instrument says that the surface is grey: taken as such it misses its own interval."""
    with np.errstate(all="ignore"):
        found = diagnose(
            record(slope=0.3).drop_dims("time"),
            laboratory.radiation,
            laboratory.variations,
            None,
            draws=400,
            saturation_counts=65000.0,
            limits=command.LIMITS,
        )
    base, last, half = plateau(found)
    assert abs(base) < half and abs(last) < half


def test_what_little_is_left_of_much_counts():
    assert gain(np.array([10.0, 10.0]), np.array([1.0, 1.0]), np.array([3e-7, 1e-12])).tolist() == [100, 0]


def test_grains_are_told_from_a_colder_surface_where_the_plasma_ends(diagnosed):
    """A loss of 15 % that falls as 1/wavelength is that of a surface 33 K colder, by Wien's law; only that no
    surface grows hotter as its heating ends speaks for it."""
    found = diagnosed(grains=0.15, period=FAST)
    assert found.report["verdict"]["named"][:1] == ["scat"]
    base, last, half = plateau(found)
    assert base < -20 and abs(last) < 6 and abs(last) < half


def test_a_surface_that_nothing_heats_cools_ever_more_slowly():
    times = knots(np.arange(-10.0, 61.0), 0.0, 40.0, 60.0)
    history = History(times, 40.0)
    since = np.maximum(times - 40.0, 0.0)
    for cooling in (200 * np.sqrt(since), 1500 - 1 / (1 / 1500 + 1e-5 * since), 30 * since):
        assert np.max(history.bulges() @ (1500 - cooling)) < 1e-9
    jump = np.where(times > 40.0, 20.0, 0.0)
    assert np.max(history.bulges() @ jump) == pytest.approx(
        20.0 / BULGE * np.diff(times[times >= 40])[1] / (times[times >= 40][2] - 40.0), rel=1e-9
    )
    assert history.bulges().shape[0] == np.sum(times >= 40) - 2
    assert History(times, 40.0, cold=False).bulges().shape == (0, times.size)
