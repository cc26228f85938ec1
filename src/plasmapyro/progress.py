"""How far a long stage has come: one line on a terminal, nothing in logs, files and pipes.

A stage says `step(...)`; whoever owns the terminal (the command line, a script of the workflow) calls `show`.
Built on `logging`, so that nothing happens where nobody shows it.
"""

import logging
import shutil
import time

PERIOD = 0.1  # [s] between two drawings of the line
LOG = logging.getLogger(__name__)
ALL = logging.getLogger("plasmapyro")


def step(stage, done, total=None, note=""):
    """Tell how far a stage has come.

    Parameters
    ----------
    stage : str
    done : int
    total : int, optional
        If it is known.
    note : str
        A number worth watching, such as a residual.
    """
    if LOG.isEnabledFor(logging.DEBUG):
        count = f"{done} of {total}" if total else str(done)
        LOG.debug("%s: %s%s", stage, count, f", {note}" if note else "")


def counter(stage):
    """A function (done, total) that says `step` of a stage."""
    return lambda done, total: step(stage, done, total)


def show(stream):
    """Draw the steps, and what the stages log, as one line that is written over; on a terminal only.

    Parameters
    ----------
    stream : text stream
    """
    LOG.propagate = False
    for handler in [handler for handler in LOG.handlers if isinstance(handler, _Line)]:
        LOG.removeHandler(handler)
        ALL.removeHandler(handler)
    LOG.setLevel(logging.NOTSET if not stream.isatty() else logging.DEBUG)
    if stream.isatty():
        line = _Line(stream)
        LOG.addHandler(line)
        ALL.addHandler(line)  # the solver of the flow logs every step
        ALL.setLevel(logging.INFO)


class _Line(logging.Handler):
    def __init__(self, stream):
        super().__init__()
        self.stream, self.drawn = stream, -PERIOD

    def emit(self, record):
        now = time.monotonic()
        if now - self.drawn < PERIOD:
            return
        self.drawn = now
        width = shutil.get_terminal_size().columns - 1
        self.stream.write(f"\r\033[K{record.getMessage()[:width]}")
        self.stream.flush()

    def close(self):
        """At the end of the process the line disappears."""
        if self.drawn > 0 and not self.stream.closed:
            self.stream.write("\r\033[K")
            self.stream.flush()
        super().close()
