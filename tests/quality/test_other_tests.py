"""A log that paused and holds an earlier or a later test too: parted, and said once."""

import runpy
from pathlib import Path
from types import SimpleNamespace

import laboratory
import numpy as np
import pytest
import xarray as xr

from plasmapyro import io
from plasmapyro.quality.catalogue import of_test, own_test
from plasmapyro.readers.stage import Reading
from plasmapyro.record import flags
from plasmapyro.record.phases import unlit

APART = 240.0  # [s] from one injection to the next
AXES = ("time", "spectrum_time")


def log(end, stated):
    """Two shots in one log, the first of which ends at `end` [s]; `stated`: 0 the first, 1 the second."""
    shot = laboratory.made()
    first = shot.isel({axis: shot[axis].values < end for axis in AXES})
    first, second = (
        one.assign_coords({axis: one[axis].values + (number - stated) * APART for axis in AXES})
        for number, one in enumerate((first, shot))
    )
    parts = [
        xr.concat([one[[name for name in one if axis in one[name].dims]] for one in (first, second)], axis)
        for axis in AXES
    ]
    return xr.merge([*parts, shot[["background_counts"]]]).assign_attrs(shot.attrs, condition="90kW")


@pytest.mark.parametrize("stated", [0, 1], ids=["the first", "the second"])
@pytest.mark.parametrize("end", [60.0, 50.4, 47.0], ids=["cooling", "ends with the plasma", "before it"])
def test_another_shot_of_a_log_that_paused_is_parted_and_said_once(end, stated):
    reading = Reading(log(end, stated), {})
    found = [one for one in of_test("log", reading) if one.rule.name != "record_ends_early"]
    assert [one.rule.name for one in found] == ["another_test"]
    assert "a folder and a test.yaml of its own" in found[0].words
    kept = own_test(reading)
    shot = laboratory.made()
    for axis in AXES:
        expected = shot[axis].values if stated else shot[axis].values[shot[axis].values < end]
        assert kept[axis].values == pytest.approx(expected)


def test_the_workflow_reads_the_test_that_is_meant_and_says_it(tmp_path, caplog):
    script = Path(__file__).resolve().parents[2] / "workflow/scripts/read_test.py"
    (tmp_path / "shots").mkdir()
    io.write(log(60.0, 0), tmp_path / "shots/test.nc", "test")
    job = SimpleNamespace(log=[tmp_path / "read.log"], output=[tmp_path / "test.nc"], input=[])
    job.params = Parameters(folder=str(tmp_path / "shots"))
    runpy.run_path(str(script), {"snakemake": job})
    assert "[another_test]" in caplog.text
    assert io.read(job.output[0], "test").time.max() < APART / 2


class Parameters(dict):
    """Of a rule, by name and as a mapping."""

    __getattr__ = dict.__getitem__


def test_a_pause_of_a_surface_that_goes_on_cooling_and_a_dark_before_the_plasma_part_nothing():
    test = laboratory.made().assign_attrs(condition="90kW")
    for low, high in ((53.0, 57.0), (-3.5, -1.5)):
        paused = test.isel({axis: (test[axis].values < low) | (test[axis].values > high) for axis in AXES})
        assert own_test(Reading(paused, {})).equals(paused)
    late = test.assign_attrs(reference_window=[0.0, 0.9])  # before the first spectrum
    assert own_test(Reading(late, {})).equals(late)
    dark = xr.where(test.time < -1.5, 0.0, test[["signal_wide", "signal_narrow"]])
    dark = test.assign(dark).isel(time=(test.time.values < -3.0) | (test.time.values > -1.5))
    assert own_test(Reading(dark, {})).sizes == dark.sizes


def test_only_what_stands_before_the_pause_is_of_the_earlier_test():
    time = np.concatenate([np.arange(-30.0, -20.0), np.arange(-4.0, 6.0)])
    light = np.where(time < -19.0, np.where(time < -25.0, 9.0, 2.0), 1.0)[:, None]
    assert (unlit(time, light, (0.0, 5.0)) == (time < -10)).all()
    assert list(np.flatnonzero(flags.pauses(time))) == [9]
