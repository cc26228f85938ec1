"""What a parameter study costs, and how much of that is the workflow and not the physics.

    python benchmarks/study.py plan | touch | empty | run [sizes]

`plan`: dry runs of 9 to 90 000 conditions, nothing is computed. `touch`: the same
jobs through Snakemake's scheduler, which only dates empty files. `empty`: 900 conditions whose flows are said
not to exist, so that every job starts, writes and ends without physics. `run`: the minimal configuration for
good, in results/benchmark_study, where each size takes over what the smaller one computed. CPU seconds of
Snakemake itself and of its jobs apart, read from /proc (Linux). One job at a time. Adds its lines to
docs/study_cost.csv, which docs/large-studies.md quotes.
"""

import argparse
import csv
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import xarray as xr
import yaml

from plasmapyro import io
from plasmapyro.study import plan, stage

ROOT = Path(__file__).parents[1]
STORE, TABLE = ROOT / "results" / "benchmark_study", ROOT / "docs" / "study_cost.csv"
COLUMNS = ("kind", "conditions", "flows", "sight_lines", "jobs", "snakemake_cpu_s", "jobs_cpu_s", "wall_s")
NINE_FLOWS = ([80, 90, 100], [45, 50, 60], [16])
SIZES = {  # powers, pressures, mass flow rates; emittances, angles
    9: (*NINE_FLOWS, 1, 1),
    90: (*NINE_FLOWS, 10, 1),
    900: (*NINE_FLOWS, 10, 10),
    9_000: (list(range(50, 140, 10)), [30, 35, 40, 45, 50, 60, 70, 80, 90, 100], [16], 10, 10),
    90_000: (
        list(range(50, 140, 10)),
        [30, 35, 40, 45, 50, 60, 70, 80, 90, 100],
        [10, 11, 12, 13, 14, 15, 16, 17, 18, 19],
        10,
        10,
    ),
}


def study(size):
    """The key `study` of so many conditions."""
    *flow_axes, emittances, angles = SIZES[size]
    return {
        "axes": {
            **dict(zip(plan.FLOW_AXES, flow_axes, strict=True)),
            "emittance": [round(1 - number / 11, 3) for number in range(emittances)],
            "angle_deg": [35 + 4 * number for number in range(angles)],
        },
        "limit": 1_000_000,
        "object_temperature_k": [800, 2400, 100],
        "longest_chain": 3,
    }


def call(folder, size, *arguments):
    """Run Snakemake on a study; return CPU seconds of itself and of its jobs, and the wall time [s]."""
    (folder / "study.yaml").write_text(yaml.safe_dump({"study": study(size)}))
    command = [sys.executable, "-m", "snakemake", "--cores", "1", *arguments]
    command += ["--configfile", "config/minimal.yaml", "study.yaml"]
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    begun, last = time.monotonic(), None
    with open(folder / "snakemake.log", "w") as log:
        process = subprocess.Popen(command, cwd=folder, stdout=log, stderr=log, env=environment)
        while process.poll() is None:
            last = seconds_of(process.pid) or last
            time.sleep(0.1)
    if process.returncode:
        sys.exit((folder / "snakemake.log").read_text()[-3000:])
    return (*last, time.monotonic() - begun)


def seconds_of(pid):
    """CPU seconds of a process and of its children that have ended; None if it has ended itself."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return None
    ticks = [int(field) for field in fields[11:15]]
    return tuple(sum(pair) / os.sysconf("SC_CLK_TCK") for pair in (ticks[:2], ticks[2:]))


def clone(folder):
    """The workflow without results in an empty folder."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    shutil.copy(ROOT / "Snakefile", folder)
    for name in ("config", "workflow", "profiles"):
        shutil.copytree(ROOT / name, folder / name)
    return folder


def jobs_of(folder):
    """Number of jobs that the last call announced."""
    totals = [line for line in (folder / "snakemake.log").read_text().splitlines() if line[:5] == "total"]
    return int(totals[0].split()[1]) if totals else 0


def record(kind, size, folder, measured):
    """Add one line to the table, in place of an older one of its kind and size."""
    flows = int(np.prod([len(values) for values in SIZES[size][:3]]))
    line = [
        kind,
        size,
        flows,
        flows * SIZES[size][4],
        jobs_of(folder),
        *(f"{value:.1f}" for value in measured),
    ]
    lines = list(csv.reader(TABLE.open(encoding="utf-8")))[1:] if TABLE.exists() else []
    lines = [one for one in lines if one[:2] != [kind, str(size)]] + [line]
    with TABLE.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(lines)
    print(*line, flush=True)


def planned(sizes):
    """Dry runs: reading the study, building the graph of jobs, nothing else."""
    for size in sizes:
        folder = clone(STORE / "plan")
        record("plan", size, folder, call(folder, size, "--dry-run", "--quiet", "rules"))


def scheduled(sizes):
    """Every job goes through the scheduler, and only dates an empty file (Snakemake's --touch)."""
    for size in sizes:
        folder = clone(STORE / "touch")
        found = plan_of(size)
        names = [
            "study",
            "gas/air11",
            "flow/start/reference",
            "instrument/response",
            "instrument/ratio_curve",
        ]
        names += [f"study/flow/{name}" for name in found.flows]
        names += [f"study/signal/{name}" for name in found.sight_lines]
        for name in names:
            path = folder / f"results/{name}.nc"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        options = ("--touch", "--forceall", "--quiet", "rules")
        record("touch", size, folder, call(folder, size, "results/study.nc", *options))


def plan_of(size):
    """The jobs of a study of this size."""
    return plan.make(study(size), dict(zip(plan.FLOW_AXES, (90, 50, 16), strict=True)), 10)


def empty(size):
    """All jobs of a study, none of them with physics."""
    folder = clone(STORE / "empty")
    for name in ("gas/air11.nc", "flow/start/reference.nc"):
        (folder / "results" / name).parent.mkdir(parents=True)
        (folder / "results" / name).touch()
    for name, place in plan_of(size).flows.items():
        values = (place[axis] * factor for axis, factor in zip(plan.FLOW_AXES, (1e3, 100, 1e-3), strict=True))
        none = xr.Dataset(dict(zip(stage.FLOW_DIMS, values, strict=True)))
        none = none.assign(flow_status=np.int8(stage.UNSTEADY))
        io.write(none, folder / f"results/study/flow/{name}.nc", "study_flow")
    record("empty", size, folder, call(folder, size, "results/study.nc"))


def run(sizes):
    """The minimal configuration for good; each size goes on from the one before."""
    folder = STORE / "run" if (STORE / "run" / "results").exists() else clone(STORE / "run")
    for size in sizes:
        record("run", size, folder, call(folder, size, "results/study.nc"))


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=("plan", "touch", "empty", "run"))
    parser.add_argument("sizes", nargs="*", type=int, choices=list(SIZES))
    options = parser.parse_args()
    if options.part == "plan":
        planned(options.sizes or list(SIZES))
    elif options.part == "touch":
        scheduled(options.sizes or list(SIZES))
    elif options.part == "empty":
        for size in options.sizes or [900]:
            empty(size)
    else:
        run(options.sizes or [9, 90, 900])


if __name__ == "__main__":
    main()
