"""What a job of the workflow costs in time, processor time and memory, as the system counts them.

A third of a second of a short job went into the search for garbage among the modules: while they were
loaded, and when the process ended. They are left out of it (`gc.freeze`).
"""

import atexit
import gc
import sys
import time
from pathlib import Path

LOGS, COSTS = "logs", "benchmarks"
MEGABYTE = 1 << 20 if sys.platform == "darwin" else 1 << 10  # unit of `ru_maxrss`


def note_at_end(log):
    """Note the cost of this process, when it ends, in the folder `benchmarks` beside that of its log."""
    parts = Path(log).parts
    if LOGS in parts:
        place = parts.index(LOGS)
        end_of_imports()
        atexit.register(gc.freeze)
        atexit.register(_note, Path(*parts[:place], COSTS, *parts[place + 1 :]).with_suffix(".tsv"))


def end_of_imports():
    """Collect garbage from here on, in a process that began without, but not among the modules."""
    if not gc.isenabled():
        gc.freeze()
        gc.enable()


def _note(path):
    """A table of one row: wall time and processor time [s], largest memory [MB]; children are counted in."""
    try:
        import resource

        import psutil
    except ImportError:  # Windows, or no Snakemake: nothing of a workflow
        return
    clock = getattr(time, "CLOCK_BOOTTIME", None)
    # Linux tells the date of its start in whole seconds; a process began at a time after that start.
    now = time.time() if clock is None else psutil.boot_time() + time.clock_gettime(clock)
    both = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    row = {
        "s": now - psutil.Process().create_time(),
        "max_rss": max(one.ru_maxrss for one in both) / MEGABYTE,
        "cpu_time": sum(one.ru_utime + one.ru_stime for one in both),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\t".join(row) + "\n" + "\t".join(f"{value:.2f}" for value in row.values()) + "\n")
