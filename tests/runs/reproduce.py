"""Does the same input give the same bytes, and the numbers of the committed reference?

Runs the minimal configuration in two clean copies of the project at once, compares every netCDF file byte for
byte, and the claims with tests/reference/claims_minimal.csv. With --results it compares the claims of a
run that is already there with tests/reference/claims_full.csv instead.
"""

import argparse
import csv
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "tests" / "reference"
LEFT_OUT = (".git", ".venv", ".snakemake", "results", "__pycache__")
# Another machine rounds otherwise; the flow stops iterating when a step changes the temperature by less than
# 2e-3 (5e-3 in the minimal run), which leaves the lines of the gas uncertain by a few times that.
RELATIVE_TOLERANCE = 1e-2
STEPS = {
    "spectrometer_start": 2.0,
    "transient_turns": 0.2,
    "gas_over_surface": 1.0,
    "corrected_rises": 7.0,
    "gas_beyond": 1e-3,
}  # read off a grid: one step


def run_minimal(folders):
    """Run the minimal configuration in copies of the project at `folders`, side by side, a core each."""
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--configfile", "config/minimal.yaml"]
    running = []
    for folder in folders:
        shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*LEFT_OUT))
        with (folder / "run.log").open("w", encoding="utf-8") as output:
            running.append(subprocess.Popen(command, cwd=folder, stdout=output, stderr=subprocess.STDOUT))
    failed = [folder for folder, job in zip(folders, running, strict=True) if job.wait()]
    if failed:
        sys.exit(f"the minimal run failed in {failed[0]}:\n{(failed[0] / 'run.log').read_text('utf-8')}")


def differing_files(first, second):
    """Names of netCDF files that are not in both folders with the same bytes."""
    names = {path.relative_to(root) for root in (first, second) for path in root.rglob("*.nc")}

    def content(root, name):
        return (root / name).read_bytes() if (root / name).is_file() else None

    return sorted(str(name) for name in names if content(first, name) != content(second, name)), len(names)


def moved_claims(found, reference):
    """One line for each claim whose value is not that of the reference within the tolerance."""
    with xr.open_dataset(found) as table:
        values = dict(zip(table.claim.values.astype(str), table.value.values, strict=True))
    with reference.open(encoding="utf-8") as lines:
        expected = {
            row["claim"]: (float(row["value"]), float(row["tolerance"])) for row in csv.DictReader(lines)
        }
    for claim in sorted(values.keys() | expected.keys()):
        if claim not in values or claim not in expected:
            yield f"{claim}: only in {'the results' if claim in values else 'the reference'}"
            continue
        new, (old, tolerance) = values[claim], expected[claim]
        if not np.isclose(new, old, rtol=0, atol=tolerance, equal_nan=True):
            yield f"{claim}: {new:.6g}, reference {old:.6g} within {tolerance:.2g}"


def tolerance_of(claim, value):
    """Absolute tolerance of a claim: a share of its value, or one step of the grid it is read off."""
    step = max((size for name, size in STEPS.items() if claim.startswith(name)), default=0.0)
    return step if np.isnan(value) else max(RELATIVE_TOLERANCE * abs(value), step)


def write_reference(found, reference):
    """Store the claims of a run as the reference, to be committed with the reason why they moved."""
    with xr.open_dataset(found) as table, reference.open("w", encoding="utf-8", newline="") as lines:
        writer = csv.writer(lines, lineterminator="\n")
        writer.writerow(["claim", "value", "tolerance"])
        writer.writerows(
            (claim, f"{value:.9g}", f"{tolerance_of(claim, value):.3g}")
            for claim, value in zip(table.claim.values, table.value.values, strict=True)
        )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--results",
        type=Path,
        metavar="DIR",
        help="compare the claims of this finished full run, run nothing",
    )
    parser.add_argument("--update", action="store_true", help="replace the reference by what was found")
    arguments = parser.parse_args()
    if arguments.results:
        found, reference = arguments.results / "claims.nc", REFERENCE / "claims_full.csv"
        moved = finish(found, reference, arguments.update)
        sys.exit(1 if moved else 0)
    with tempfile.TemporaryDirectory(prefix="plasmapyro-") as scratch:
        folders = [Path(scratch) / name for name in ("first", "second")]
        start = time.monotonic()
        run_minimal(folders)
        print(f"two minimal runs in clean folders: {time.monotonic() - start:.0f} s", flush=True)
        different, count = differing_files(*(folder / "results" for folder in folders))
        print(f"{count} netCDF files compared byte for byte, {len(different)} differ", *different, sep="\n  ")
        found, reference = folders[0] / "results" / "claims.nc", REFERENCE / "claims_minimal.csv"
        moved = finish(found, reference, arguments.update)
    sys.exit(1 if different or moved or not count else 0)


def finish(found, reference, update):
    """Compare with the reference or replace it; print the outcome; return the claims that moved."""
    if update:
        write_reference(found, reference)
        print(f"wrote {reference.relative_to(ROOT)}")
        return []
    moved = list(moved_claims(found, reference))
    print(f"claims against {reference.relative_to(ROOT)}: {len(moved)} moved", *moved, sep="\n  ")
    return moved


if __name__ == "__main__":
    main()
