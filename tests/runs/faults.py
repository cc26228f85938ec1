"""Does a run survive what happens to runs?

Takes the minimal configuration in a clean copy of the project, disturbs it, and asks of each fault: does the
next plain `snakemake --cores 2` end with the bytes of an undisturbed run, or does one clear message say what
to do?

kill        kill -9 of the whole run at random moments spread over its jobs, then the same command again
damage      results truncated, or one bit flipped, three files at a time
edit        the configuration changed in the middle of a run, and changed back
twice       a second run started beside the first
clock       results dated a day ahead, or years back
permission  a results folder without write permission (root needs setpriv to give up its privilege)
full disk   the results folder on a file system that is too small (needs root to mount it)
read-only   the results folder on a file system that cannot be written (needs root to mount it)

With --folder the undisturbed run and what was survived are kept there, and the same command goes on.
"""

import argparse
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LEFT_OUT = (".git", ".venv", ".snakemake", "results", "__pycache__", ".pytest_cache", ".ruff_cache")
MOST_JOBS, LATEST_KILL = 4, 4.0  # a kill comes when up to so many jobs of a run began, up to so many s later
SMALL_DISK, LARGE_DISK = "2m", "400m"
UNPRIVILEGED = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"]


class Lost(AssertionError):
    """A fault was not survived."""


class Run:
    """A run in a process group of its own, whose words are read while it works."""

    def __init__(self, command, folder):
        self.process = subprocess.Popen(
            command,
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        self.lines, self.begun, self.at_work, self.ended = [], 0, {}, threading.Event()
        self.reader = threading.Thread(target=self._read)
        self.reader.start()

    def _read(self):
        rule = None
        for line in self.process.stdout:
            self.lines.append(line)
            if begun := re.match(r"(?:local)?rule (\w+):", line):
                rule = begun[1]
            elif job := re.match(r"    jobid: (\d+)", line):
                self.at_work[job[1]] = rule
                self.begun += 1
            elif job := re.match(r"Finished jobid: (\d+)", line):
                self.at_work.pop(job[1], None)
        self.ended.set()

    def wait(self):
        """Exit status and words."""
        status = self.process.wait()
        self.reader.join()
        return status, "".join(self.lines)

    def kill(self):
        """Kill -9 of everything; the rules that were at work."""
        at_work = set(self.at_work.values())
        os.killpg(self.process.pid, signal.SIGKILL)
        self.wait()
        return at_work


class Project:
    """A copy of the project with the results of an undisturbed run at hand."""

    def __init__(self, folder, kept, cores):
        self.folder, self.results, self.kept = folder, folder / "results", kept
        self.command = [sys.executable, "-m", "snakemake", "--cores", str(cores)]
        self.command += ["--configfile", "config/minimal.yaml"]
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*LEFT_OUT))

    def start(self, prefix=()):
        return Run([*prefix, *self.command], self.folder)

    def run(self, prefix=()):
        """Exit status and words of one run."""
        return self.start(prefix).wait()

    def clear(self):
        """Forget all results."""
        shutil.rmtree(self.results, ignore_errors=True)
        shutil.rmtree(self.folder / ".snakemake", ignore_errors=True)

    def restore(self, *without):
        """Take the results of the undisturbed run, but for some groups; times of files included."""
        ignored = [self.kept / group for group in without]
        shutil.copytree(
            self.kept,
            self.results,
            ignore=lambda folder, names: [name for name in names if Path(folder) / name in ignored],
            dirs_exist_ok=True,
        )

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
    survived, hit = 0, set()
    while survived < count:
        project.clear()
        while survived < count:
            run = project.start()
            jobs, delay = chance.randint(0, MOST_JOBS), chance.uniform(0.0, LATEST_KILL)
            while run.begun < jobs and not run.ended.wait(0.02):
                pass
            if run.ended.wait(delay):
                run.wait()
                break
            hit |= run.kill()
            survived += 1
        project.finish(undisturbed)
        print(f"  {survived} kills, the same bytes; at work were {len(hit)} rules", flush=True)
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
    """Change the emittance of a condition while a run is at work, then change it back.

    The run must end with the bytes of the configuration that it began with, or say that it was changed.
    """
    path = project.folder / "config/conditions/80kW.yaml"
    original = path.read_text(encoding="utf-8")
    for _ in range(count):
        shutil.rmtree(project.results / "analysis")
        shutil.rmtree(project.results / "experiment")
        run = project.start()
        while not run.begun and not run.ended.wait(0.02):
            pass  # changed before the first job, the new configuration would be the run's own
        time.sleep(chance.uniform(0.0, 2.0))
        path.write_text(original.replace("emittance: 0.85", "emittance: 0.5"), encoding="utf-8")
        status, words = run.wait()
        path.write_text(original, encoding="utf-8")
        if status and "call again" not in words.lower():
            raise Lost(f"no clear message:\n{words[-3000:]}")
        if not status:
            compare(digests(project.results), undisturbed)
        project.finish(undisturbed)
    return count


def twice(project, undisturbed, count, chance):
    """Start a second run beside the first."""
    for _ in range(count):
        shutil.rmtree(project.results / "analysis")
        first = project.start()
        time.sleep(chance.uniform(2.0, 4.0))
        status, words = project.run()
        first_status, _ = first.wait()
        if first_status or not status or "another run is at work" not in words:
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


def permission(project, undisturbed, count, _):
    """Meet a folder without write permission, each time another one, then give it."""
    prefix = [] if os.geteuid() else UNPRIVILEGED
    folders = [project.results, *sorted(path for path in project.results.iterdir() if path.is_dir())]
    for folder in folders[:count]:
        (project.results / "analysis/surface_radiance.nc").unlink()
        os.chmod(folder, 0o555)
        status, words = project.run(prefix)
        os.chmod(folder, 0o755)
        if not status or "write permission" not in words:
            raise Lost(f"no clear message for {folder.name}:\n{words[-3000:]}")
        project.finish(undisturbed)
    return min(count, len(folders))


def full_disk(project, undisturbed, count, chance):
    """Run into the end of a disk, at the first time a small one, then with less and less left; enlarge it."""
    for turn in range(max(1, count // 3)):
        with mounted(project, LARGE_DISK) as remount:
            if turn:
                project.restore("analysis", "experiment", "figures")
                room = sum(file.stat().st_blocks * 512 for file in project.results.rglob("*"))
                remount(f"size={room + chance.randint(100_000, 2_000_000)}")
            else:
                remount(f"size={SMALL_DISK}")
            status, words = project.run()
            if not status or not ("No space left" in words or "could not be written" in words):
                raise Lost(f"no clear message:\n{words[-3000:]}")
            remount(f"size={LARGE_DISK}")
            project.finish(undisturbed)
    return max(1, count // 3)


def read_only(project, undisturbed, _, __):
    """Meet a results folder that cannot be written, then make it writable."""
    with mounted(project, LARGE_DISK) as remount:
        project.restore("analysis")
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
        self.project.clear()
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
    "permission": permission,
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
    parser.add_argument("--cores", type=int, default=2, metavar="N", help="of each run (default: 2)")
    parser.add_argument(
        "--folder",
        type=Path,
        metavar="DIR",
        help="keep the work there, and go on with it (default: forget it)",
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="plasmapyro-") as scratch:
        folder = options.folder or Path(scratch)
        lost = disturb(folder, options)
    sys.exit(1 if lost else 0)


def disturb(folder, options):
    """Try all faults asked for that have not been survived yet; the number of kinds that were lost."""
    kept, record = folder / "undisturbed", folder / "survived.json"
    survived = json.loads(record.read_text()) if record.exists() else {}
    project = Project(folder / "project", kept, options.cores)
    if not record.exists():
        start = time.monotonic()
        status, words = project.run()
        if status:
            sys.exit(f"the undisturbed run failed:\n{words}")
        shutil.rmtree(kept, ignore_errors=True)
        shutil.copytree(project.results, kept)
        record.write_text("{}")
        print(f"undisturbed run: {time.monotonic() - start:.0f} s", flush=True)
    undisturbed = digests(kept)
    print(f"{len(undisturbed)} files to compare", flush=True)
    lost = 0
    for name in options.only:
        count = options.kills if name == "kill" else options.others
        if survived.get(name):
            print(f"{name}: {survived[name]} survived before", flush=True)
            continue
        if name in NEED_ROOT and os.geteuid():
            print(f"{name}: not tried, mounting a small file system needs root", flush=True)
            continue
        start = time.monotonic()
        try:
            if not project.results.exists():
                project.restore()
            survived[name] = FAULTS[name](project, undisturbed, count, random.Random(options.seed))
            record.write_text(json.dumps(survived))
            print(f"{name}: {survived[name]} survived, {time.monotonic() - start:.0f} s", flush=True)
        except Lost as fault:
            lost += 1
            print(f"{name}: LOST: {fault}", flush=True)
            project.clear()
    print(f"{sum(survived.values())} faults survived, {lost} kinds lost", flush=True)
    return lost


if __name__ == "__main__":
    main()
