"""How far a run has come, on a terminal; nothing in logs, files and pipes but what the user must know.

A stage says `step(...)`, a command `say(...)` and `warn(...)`; whoever owns the terminal (the command line, a
script of the workflow) calls `show`. Built on `logging`, so that nothing happens where nobody shows it.
"""

import logging
import shutil
import time

PERIOD = 0.1  # [s] between two drawings of the line
LOG = logging.getLogger(__name__)
ALL = logging.getLogger("plasmapyro")


def step(stage, done, total=None, note=""):
    """Tell how far a stage has come; the next step is written over it.

    `total` if it is known; `note`: a number worth watching, such as a residual.
    """
    if LOG.isEnabledFor(logging.DEBUG):
        count = f"{done} of {total}" if total else str(done)
        LOG.debug("%s: %s%s", stage, count, f", {note}" if note else "")


def say(message):
    """Tell what a command does now; the line stays, with the time since the command began."""
    LOG.info(message)


def warn(message):
    """Say something the user must know, on a terminal or not."""
    LOG.warning(message)


def show(stream):
    """Draw steps and what the stages log as one line, written over, on a terminal only; and warnings."""
    LOG.propagate = False
    for handler in [handler for handler in LOG.handlers if isinstance(handler, _Line)]:
        LOG.removeHandler(handler)
        ALL.removeHandler(handler)
    LOG.setLevel(logging.DEBUG if stream.isatty() else logging.WARNING)
    line = _Line(stream)
    LOG.addHandler(line)
    ALL.addHandler(line)  # what a stage warns of the user must know as well
    if stream.isatty():
        ALL.setLevel(logging.INFO)  # the solver of the flow logs every step
    else:
        line.setLevel(logging.WARNING)


class _Line(logging.Handler):
    def __init__(self, stream):
        super().__init__()
        self.stream, self.start, self.drawn = stream, time.monotonic(), -PERIOD

    def emit(self, record):
        if self.stream.closed:  # of a caller that goes on without it
            return
        now = time.monotonic()
        clear = "\r\033[K" if self.stream.isatty() else ""
        warning = record.levelno >= logging.WARNING
        if warning or record.name == LOG.name and record.levelno >= logging.INFO:
            head = "plasmapyro: warning:" if warning else f"[{now - self.start:5.1f} s]"
            self.stream.write(f"{clear}{head} {record.getMessage()}\n")
        elif now - self.drawn >= PERIOD:
            self.drawn = now
            width = shutil.get_terminal_size().columns - 1
            self.stream.write(f"{clear}{record.getMessage()[:width]}")
        self.stream.flush()

    def close(self):
        """At the end of the process the line disappears."""
        if self.drawn > 0 and not self.stream.closed:
            self.stream.write("\r\033[K")
            self.stream.flush()
        super().close()
