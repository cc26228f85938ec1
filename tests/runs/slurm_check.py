"""Does a run through a real Slurm give the bytes of a local run?

Starts Slurm on this machine (tests/runs/one_machine.sh; Debian: apt-get install slurm-wlm munge; as
root), runs the workflow in a clean copy of the project through profiles/slurm, and compares every netCDF file
with the results of the local run in results/. For a part of the job, name its results as for Snakemake.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from reproduce import LEFT_OUT, ROOT, differing_files

SLURM = ROOT / "tests" / "runs" / "one_machine.sh"


def run_through_slurm(folder, configfile, targets, taken):
    """Copy the project to `folder` and run it through the scheduler; return the seconds it took."""
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*LEFT_OUT))
    for source in taken:
        shutil.copytree(source, folder / "results" / source.name)
    now = time.time()
    for path in (folder / "results").rglob("*"):
        os.utime(path, (now, now))  # of one age, or what they depend on might look newer
    command = [sys.executable, "-m", "snakemake", *targets, "--profile", "profiles/slurm"]
    command += ["--configfile", configfile] if configfile else []
    start = time.monotonic()
    outcome = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if outcome.returncode:
        sys.exit(f"the run through Slurm failed:\n{outcome.stdout[-6000:]}")
    return time.monotonic() - start


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("targets", nargs="*", help="results to compute and compare (default: the whole job)")
    parser.add_argument(
        "--take",
        nargs="+",
        default=[],
        metavar="NAME",
        help="folders of the local results not to compute again",
    )
    parser.add_argument("--configfile", help="as for Snakemake (default: the main job)")
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="of the local run")
    options = parser.parse_args()
    if not (options.results / "claims.nc").exists():
        sys.exit(f"{options.results} holds no finished run to compare with; run it first")
    with tempfile.TemporaryDirectory(prefix="plasmapyro-") as scratch:
        subprocess.run([SLURM, "start", f"{scratch}/slurm"], check=True)
        taken = [options.results / name for name in options.take]
        try:
            seconds = run_through_slurm(Path(scratch) / "project", options.configfile, options.targets, taken)
        finally:
            subprocess.run([SLURM, "stop", f"{scratch}/slurm"], check=True)
        found = Path(scratch) / "project" / "results"
        # The local folder may hold more: results of other calls. What was taken over is not compared.
        made = {str(path.relative_to(found)) for path in found.rglob("*.nc")}
        made -= {name for name in made if name.split("/")[0] in options.take}
        different = sorted(made.intersection(differing_files(found, options.results)[0]))
    print(
        f"through Slurm in {seconds:.0f} s: {len(made)} netCDF files,"
        f" {len(different)} differ from the local run"
    )
    print(*different, sep="\n", end="\n" if different else "")
    sys.exit(1 if different or not made else 0)


if __name__ == "__main__":
    main()
