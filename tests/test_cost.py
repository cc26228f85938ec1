"""What a process of the workflow does with its garbage, and that it notes its cost."""

import os
import subprocess
import sys
import time

import pytest

JOB = """
import gc
from plasmapyro import io
loading = gc.isenabled()
io.log_to({log!r})
print(loading, gc.isenabled(), gc.get_freeze_count() > 10_000)
"""


def seen(log, **more):
    words = subprocess.run(
        [sys.executable, "-c", JOB.format(log=str(log))],
        env={name: value for name, value in os.environ.items() if name != "PLASMAPYRO_JOB"} | more,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    return [word == "True" for word in words]


def test_a_job_collects_garbage_but_not_among_its_modules(tmp_path):
    (tmp_path / "logs").mkdir()
    assert seen(tmp_path / "logs/rule.log", PLASMAPYRO_JOB="1") == [False, True, True]
    head, row = (tmp_path / "benchmarks/rule.tsv").read_text().splitlines()
    assert head.split() == ["s", "max_rss", "cpu_time"] and float(row.split()[2]) > 0


def test_the_package_leaves_the_collector_of_others_alone(tmp_path):
    assert seen(tmp_path / "other.log") == [True, True, False]


@pytest.mark.skipif(not hasattr(time, "CLOCK_BOOTTIME"), reason="the date of the start is exact elsewhere")
def test_the_time_of_a_job_does_not_depend_on_when_the_machine_was_started(tmp_path):
    (tmp_path / "logs").mkdir()
    start = time.monotonic()
    seen(tmp_path / "logs/rule.log", PLASMAPYRO_JOB="1")
    largest = time.monotonic() - start
    stated = float((tmp_path / "benchmarks/rule.tsv").read_text().splitlines()[1].split()[0])
    cpu_clock_step = 0.02  # of the start of a process: 100 in a second
    assert 0 < stated < largest + cpu_clock_step
