"""Does a run survive what happens to runs?

Takes the minimal configuration in a clean copy of the project, disturbs it, and asks of each fault: does the
next plain `snakemake --cores 2` end with the bytes of an undisturbed run, or does one clear message say what
to do?

kill       kill -9 of the whole run at random moments, then the same command again, until it is done
damage     results truncated, or one bit flipped, one file after the other
edit       the configuration changed in the middle of a run, and changed back
twice      a second run started beside the first
clock      results dated a day ahead, or years back
full disk  the results folder on a file system that is too small (needs root to mount it)
read-only  the results folder on a file system that cannot be written (needs root to mount it)
"""

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LEFT_OUT = (".git", ".venv", ".snakemake", "results", "__pycache__", ".pytest_cache", ".ruff_cache")
COMMAND = [sys.executable, "-m", "snakemake", "--cores", "2", "--configfile", "config/minimal.yaml"]
LATEST_KILL = 9.0  # [s] after the start of a run; three seconds of it are the start of Snakemake
SMALL_DISK, LARGE_DISK = "2m", "400m"


class Lost(AssertionError):
    """A fault was not survived."""


class Project:
    """A copy of the project with the results of an undisturbed run at hand."""

    def __init__(self, folder):
        self.folder, self.results = Path(folder), Path(folder) / "results"
        shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*LEFT_OUT))

    def start(self):
        return subprocess.Popen(
            COMMAND,
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def run(self):
        """Exit status and words of one run."""
        run = self.start()
        words = run.communicate()[0]
        return run.returncode, words

    def finish(self, undisturbed):
        """Run once more; the results must be those of the undisturbed run."""
        status, words = self.run()
        if status:
            raise Lost(f"the next run failed:\n{words[-3000:]}")
        compare(digests(self.results), undisturbed)


def digests(results):
    """Name -> content of every result but logs, times and notes."""
    aside = {"logs", "benchmarks", ".seals"}
    return {
        str(path.relative_to(results)): path.read_bytes()
        for path in sorted(results.rglob("*"))
        if path.is_file() and path.relative_to(results).parts[0] not in aside
    }


def compare(found, expected):
    """Refuse missing, additional and different files."""
    different = sorted(
        name for name in found.keys() | expected.keys() if found.get(name) != expected.get(name)
    )
    if different:
        raise Lost(f"{len(different)} files differ: {', '.join(different[:5])}")


def kill(project, undisturbed, count, chance):
    """Kill -9 of the process group, `count` times; the run starts anew whenever it got to its end."""
    survived = 0
    while survived < count:
        shutil.rmtree(project.results, ignore_errors=True)
        shutil.rmtree(project.folder / ".snakemake", ignore_errors=True)
        while survived < count:
            run = project.start()
            try:
                run.communicate(timeout=chance.uniform(0.5, LATEST_KILL))
                break
            except subprocess.TimeoutExpired:
                os.killpg(run.pid, signal.SIGKILL)
                run.communicate()
                survived += 1
        project.finish(undisturbed)
        print(f"  {survived} kills, the same bytes", flush=True)
    return survived


def damage(project, undisturbed, count, chance):
    """Truncate or flip a bit of `count` netCDF results, three at a time."""
    names = [name for name in undisturbed if name.endswith(".nc")]
    survived = 0
    for _ in range(0, count, 3):
        for name in chance.sample(names, 3):
            path = project.results / name
            content = bytearray(path.read_bytes())
            place = chance.randrange(len(content))
            if chance.random() < 0.5:
                path.write_bytes(content[:place])
            else:
                content[place] ^= 1 << chance.randrange(8)
                path.write_bytes(content)
            survived += 1
        project.finish(undisturbed)
    return survived


def edit(project, undisturbed, count, chance):
    """Change the emittance of a condition while a run is at work, then change it back."""
    path = project.folder / "config/conditions/90kW.yaml"
    original = path.read_text(encoding="utf-8")
    for _ in range(count):
        shutil.rmtree(project.results / "analysis")
        shutil.rmtree(project.results / "experiment")
        run = project.start()
        time.sleep(chance.uniform(3.0, 6.0))
        path.write_text(original.replace("emittance: 0.85", "emittance: 0.5"), encoding="utf-8")
        words = run.communicate()[0]
        if run.returncode and "call again" not in words:
            raise Lost(f"no clear message:\n{words[-3000:]}")
        path.write_text(original, encoding="utf-8")
        project.finish(undisturbed)
    return count


def twice(project, undisturbed, count, chance):
    """Start a second run beside the first."""
    for _ in range(count):
        shutil.rmtree(project.results / "analysis")
        first = project.start()
        time.sleep(chance.uniform(2.0, 4.0))
        status, words = project.run()
        first.communicate()
        if first.returncode or not status or "another run is at work" not in words:
            raise Lost(f"the second run was not refused:\n{words[-3000:]}")
        project.finish(undisturbed)
    return count


def clock(project, undisturbed, count, chance):
    """Date results a day ahead or years back, as after a clock that was wrong."""
    names = [name for name in undisturbed if name.startswith(("analysis", "sightline", "instrument"))]
    for turn in range(count):
        stamp = time.time() + 86400 if turn % 2 else 1e9
        os.utime(project.results / chance.choice(names), (stamp, stamp))
        project.finish(undisturbed)
    for name in undisturbed:
        os.utime(project.results / name)
    return count


def full_disk(project, undisturbed, _, __):
    """Run into the end of a small disk, then enlarge it."""
    with mounted(project, SMALL_DISK) as remount:
        status, words = project.run()
        if not status or not ("No space left" in words or "could not be written" in words):
            raise Lost(f"no clear message:\n{words[-3000:]}")
        remount(f"size={LARGE_DISK}")
        project.finish(undisturbed)
    return 1


def read_only(project, undisturbed, _, __):
    """Meet a results folder that cannot be written, then make it writable."""
    with mounted(project, LARGE_DISK) as remount:
        remount("ro")
        status, words = project.run()
        if not status or "cannot be written to" not in words:
            raise Lost(f"no clear message:\n{words[-3000:]}")
        remount("rw")
        project.finish(undisturbed)
    return 1


class mounted:  # noqa: N801 (used like a function)
    """The results folder as a small file system in memory, empty at first."""

    def __init__(self, project, size):
        self.project, self.size = project, size

    def __enter__(self):
        results = self.project.results
        shutil.rmtree(results, ignore_errors=True)
        shutil.rmtree(self.project.folder / ".snakemake", ignore_errors=True)
        results.mkdir()
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={self.size}", "tmpfs", results], check=True)
        return lambda options: subprocess.run(["mount", "-o", f"remount,{options}", results], check=True)

    def __exit__(self, *_):
        subprocess.run(["umount", "--lazy", self.project.results], check=True)


FAULTS = {
    "damage": damage,
    "edit": edit,
    "twice": twice,
    "clock": clock,
    "kill": kill,
    "full disk": full_disk,
    "read-only": read_only,
}
NEED_ROOT = {"full disk", "read-only"}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=50, metavar="N", help="number of kills (default: 50)")
    parser.add_argument(
        "--others", type=int, default=6, metavar="N", help="number of each other fault (default: 6)"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the random moments and places (default: 1)")
    parser.add_argument("--only", nargs="+", choices=FAULTS, default=list(FAULTS), help="kinds of faults")
    options = parser.parse_args()
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="plasmapyro-") as scratch:
        project = Project(Path(scratch) / "project")
        start = time.monotonic()
        status, words = project.run()
        if status:
            sys.exit(f"the undisturbed run failed:\n{words}")
        undisturbed = digests(project.results)
        print(f"undisturbed run: {time.monotonic() - start:.0f} s, {len(undisturbed)} files", flush=True)
        lost = 0
        for name in options.only:
            if name in NEED_ROOT and os.geteuid():
                print(f"{name}: not tried, mounting a small file system needs root")
                continue
            start = time.monotonic()
            try:
                count = options.kills if name == "kill" else options.others
                survived = FAULTS[name](project, undisturbed, count, chance)
                print(f"{name}: {survived} survived, {time.monotonic() - start:.0f} s", flush=True)
            except Lost as fault:
                lost += 1
                print(f"{name}: LOST: {fault}", flush=True)
    sys.exit(1 if lost else 0)


if __name__ == "__main__":
    main()
