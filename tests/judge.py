"""Runs the command line in a process of its own, and says how it ended and what that cost."""

import os
import signal
import sys
from collections import namedtuple
from pathlib import Path

from plasmapyro import cli

Ending = namedtuple("Ending", "status message seconds megabytes")
PACKAGES = 200.0  # [MB] of a fresh process that has imported every reader's packages
SLOWEST, LARGEST = (
    10.0,
    1000.0 - PACKAGES,
)  # [s] of the processor, [MB] beyond the packages: what refusing may cost
PATIENCE = 60  # [s] before a hang is killed


def judge(arguments, folder):
    """Ending of `plasmapyro ARGUMENTS`; `status` is negative for a signal.

    `folder` takes the words of the command; `megabytes` are those beyond what this process holds already
    (Linux), since a worker that ran other tests before carries theirs into the child.
    """
    said = folder / "said.txt"
    held = resident()
    child = os.fork()
    if not child:
        status = 70
        try:
            signal.alarm(PATIENCE)
            with open(said, "w") as stream:
                for number in (1, 2):
                    os.dup2(stream.fileno(), number)
                sys.stdout = sys.stderr = stream
                try:
                    status = cli.main([str(word) for word in arguments])
                except SystemExit as end:
                    status = end.code
        finally:
            os._exit(status)
    _, status, used = os.wait4(child, 0)
    words = said.read_text(errors="replace")
    grown = used.ru_maxrss * 1024 / 1e6 - held
    return Ending(os.waitstatus_to_exitcode(status), words, used.ru_utime + used.ru_stime, grown)


def resident():
    """Memory of this process [MB], as Linux counts it."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def require_refused(ending, *words):
    """Status 2, one message with these words and no library's own, within the bounds."""
    assert ending.status == 2, ending
    assert all(word in ending.message for word in words), ending.message
    assert ending.message.startswith("plasmapyro: ") and "Traceback" not in ending.message, ending.message
    assert "Warning" not in ending.message, ending.message
    assert ending.seconds < SLOWEST and ending.megabytes < LARGEST, ending[2:]
