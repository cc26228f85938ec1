"""What a process of the workflow does with its garbage, and that it notes its cost."""

import os
import subprocess
import sys
import time
from pathlib import Path

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


def test_what_a_run_costs_is_summed_by_rule_with_the_extended_run_apart(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).resolve().parents[1] / "benchmarks")
    import run_cost

    seconds = {"flow_60kW": 8, "flow_80kW": 9, "flow_start_reference": 15, "extended_flow_80kW": 16}
    for job, one in seconds.items():
        (tmp_path / f"{job}.tsv").write_text(f"s\tmax_rss\tcpu_time\n20.00\t900.00\t{one:.2f}\n")
    found = run_cost.costs(tmp_path)
    assert found == {"flow": [8, 9], "flow_start": [15], "extended_flow": [16]}
    assert run_cost.table(found).splitlines()[2:] == [
        "| `flow` | 2 | 17 |",
        "| `extended_flow` | 1 | 16 |",
        "| `flow_start` | 1 | 15 |",
        "| **main job** | 3 | **32** |",
        "| **extended run** | 1 | **16** |",
    ]
