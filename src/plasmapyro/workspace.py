"""The folder of a run: one run at a time, files as they were written, one configuration to the end.

Snakemake's own lock is off (`profiles/default`), because after `kill -9` it would ask for `--unlock`. Here
the operating system holds the lock and drops it with the process that took it.
"""

import fcntl
import hashlib
import json
import math
import os
import shutil
import time
from pathlib import Path

from plasmapyro.seals import FOLDER, SEALS, digest

SETTINGS = "PLASMAPYRO_SETTINGS"  # digest of the configuration that the run began with
_held = []  # locks live as long as the process


class WorkspaceError(RuntimeError):
    """The folder of the run cannot be used now; the message says why and what to do."""


def begin(results, settings):
    """Take the results folder for this run; to be called once, before the workflow looks at any result.

    What is dated in the future, by a clock that was wrong, is dated now. `settings`, which JSON can hold: all
    configuration of the run; its jobs refuse to work if it changes before the run ends. Returned are the
    paths of results that no longer had the bytes they were written with (a truncated file, a flipped bit),
    removed so that the workflow computes them again; and whether another run holds the folder: then nothing
    was looked at, and a run must not start (see `require_free`). WorkspaceError if the folder or one of those
    in it cannot be made or written to.
    """
    folder = Path(results) / FOLDER
    os.environ[SEALS] = str(folder.resolve())
    os.environ[SETTINGS] = _settings_digest(settings)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = open(folder / "lock", "a")  # noqa: SIM115 (held until the process ends)
    except OSError as fault:
        raise _unwritable(results, fault.strerror) from None
    for place in (Path(results), *(path for path in Path(results).rglob("*") if path.is_dir())):
        if not os.access(place, os.W_OK | os.X_OK):  # a job would find out only after its work
            lock.close()
            raise _unwritable(place, "permission denied")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        lock.close()
        return [], True
    _held.append(lock)
    for part in list(Path(results).rglob(".*.part*")):
        shutil.rmtree(part) if part.is_dir() else part.unlink(missing_ok=True)
    _date_back(Path(results))
    return _remove_damaged(Path(results), folder), False


def _unwritable(place, reason):
    return WorkspaceError(
        f"{place}: cannot be written to ({reason}); give the folder write permission and space, or run from a"
        " folder of your own"
    )


def require_free(busy):
    """Refuse (WorkspaceError) to start beside another run."""
    if busy:
        raise WorkspaceError(
            "another run is at work in this folder; wait until it has ended, then call again: nothing is lost"
        )


def same_settings(settings):
    """Refuse (WorkspaceError) a job whose configuration is not the one its run began with."""
    if os.environ.get(SETTINGS, _settings_digest(settings)) != _settings_digest(settings):
        raise WorkspaceError(
            "the configuration was changed while the run was at work; call again: it goes on with the new one"
        )


def require_unchanged(paths, digests):
    """Refuse (WorkspaceError) to describe a run by files other than those, by SHA-256, that it began with."""
    changed = [str(path) for path, begun in zip(paths, digests, strict=True) if digest(path) != begun]
    if changed:
        raise WorkspaceError(
            f"{', '.join(changed)}: changed while the run was at work; the results are those of the files it"
            " began with. Call again: it goes on with the new ones"
        )


def _date_back(results):
    """Date results of a clock that ran ahead now: Snakemake refuses what is older than its input."""
    now = time.time_ns()
    for path in results.rglob("*"):
        if path.is_file() and path.stat().st_mtime_ns > now:
            os.utime(path, ns=(now, now))


def _remove_damaged(results, folder):
    damaged = []
    for note in sorted(folder.rglob("*.sha256")):
        path = results / note.relative_to(folder).with_name(note.name.removesuffix(".sha256"))
        if not path.exists():
            note.unlink()
        elif digest(path) != note.read_text(encoding="ascii", errors="replace"):
            path.unlink()
            note.unlink()
            damaged.append(path)
    return damaged


def _settings_digest(settings):
    return hashlib.sha256(json.dumps(settings, sort_keys=True, default=str).encode()).hexdigest()


def wake_once():
    """Let Snakemake's scheduler have one alarm clock.

    So that no more than 100 jobs start in a second it asks to be woken a second after each look at the jobs,
    also after a look that an alarm brought: one alarm a second more for each job that ended. In the main job
    the looks cost 0.1 of a processor in the end.
    """
    from snakemake.scheduling.job_scheduler import JobScheduler

    ask, due = JobScheduler._schedule_reevalutation, -math.inf

    def ask_once(scheduler, delay):
        nonlocal due
        if time.monotonic() >= due:
            due = time.monotonic() + delay
            ask(scheduler, delay)

    JobScheduler._schedule_reevalutation = ask_once


def digest_once():
    """Let Snakemake digest a file once while it stays as it is.

    It digests every input of a job once for each of its outputs: a job that draws sixteen figures from 260 MB
    of spectra reads 4 GB.
    """
    from snakemake.io import _IOFile

    digested, known = _IOFile.checksum, {}

    async def checksum(file, *given, **options):
        if getattr(file, "is_storage", False) or not os.path.isfile(file):
            return await digested(file, *given, **options)
        found = os.stat(file)
        state = found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns
        asked = (str(file), given, tuple(options.items()))
        if known.get(asked, (None,))[0] != state:
            known[asked] = state, await digested(file, *given, **options)
        return known[asked][1]

    _IOFile.checksum = checksum
