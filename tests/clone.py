"""A clean copy of the workflow, as after a clone, and calls of Snakemake in it."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def copy_of_the_project(folder):
    """What a clone holds of the workflow, in `folder`, which is made if it is not there."""
    folder.mkdir(exist_ok=True)
    shutil.copy(ROOT / "Snakefile", folder)
    for name in ("config", "workflow", "profiles"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def snakemake(folder, *arguments):
    """Call Snakemake on one core, unless a profile says otherwise; return the ended process."""
    command = [sys.executable, "-m", "snakemake", *arguments]
    command += [] if "--profile" in arguments else ["--cores", "1"]
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)


def planned(run):
    """Rule -> number of jobs that a dry run announces."""
    assert run.returncode == 0, run.stdout + run.stderr
    table = run.stdout.split("Job stats:")[1].split("total")[0]
    return {name: int(count) for name, count in re.findall(r"^(\w+)\s+(\d+)$", table, re.MULTILINE)}
