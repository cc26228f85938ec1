"""The command `plasmapyro`: one data set at a time, without a workflow."""

import argparse
import logging
import sys
import time
import traceback

import numpy as np

from plasmapyro import __doc__ as PACKAGE
from plasmapyro.commands import calibrate, check, correct, diagnose, radiance, sightline, trust
from plasmapyro.progress import show

DONE, FAULT_OF_OURS, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
BAR_LENGTH, BAR_PERIOD = 30, 0.1  # characters; [s]


class Progress:
    """Steps of a run with the time they end at, on a terminal only."""

    def __init__(self, stream):
        self.stream, self.start = stream, time.monotonic()

    def step(self, message):
        if self.stream.isatty():
            self.stream.write(f"[{time.monotonic() - self.start:5.1f} s] {message}\n")

    def warn(self, message):
        """Say something the user must know, on a terminal or not."""
        self.stream.write(f"plasmapyro: warning: {message}\n")

    def bar(self, message):
        """A function (done, total) that draws a progress bar on a terminal, at most ten times a second."""
        drawn = -np.inf

        def report(done, total):
            nonlocal drawn
            now = time.monotonic()
            if not self.stream.isatty() or (done < total and now - drawn < BAR_PERIOD):
                return
            drawn = now
            filled = BAR_LENGTH * done // max(total, 1)
            self.stream.write(
                f"\r[{now - self.start:5.1f} s] {message} [{'#' * filled:<{BAR_LENGTH}}] {done} of {total}"
                + "\n" * (done >= total)
            )
            self.stream.flush()

        return report


def parser():
    """The argument parser of all subcommands; each sets `run`, a function (options, progress)."""
    top = argparse.ArgumentParser(prog="plasmapyro", description=PACKAGE)
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in (check, calibrate, correct, diagnose, trust, sightline, radiance):
        command.add(commands)
    return top


def main(arguments=None):
    """Run the command line.

    Parameters
    ----------
    arguments : list of str, optional
        Those of the process by default.

    Returns
    -------
    int
        Exit status: 0 done, 2 bad input or usage, 1 a fault of ours; what a command says otherwise.
    """
    options = parser().parse_args(arguments)
    # What the library logs, the commands say in their own words.
    logging.getLogger("plasmapyro").addHandler(logging.NullHandler())
    show(sys.stderr)
    try:
        status = options.run(options, Progress(sys.stderr))
    except (ValueError, OSError) as fault:
        sys.stderr.write(f"plasmapyro: {fault}\n")
        return BAD_INPUT
    except KeyboardInterrupt:
        sys.stderr.write("plasmapyro: stopped; nothing was written\n")
        return INTERRUPTED
    except Exception:
        traceback.print_exc()
        sys.stderr.write("plasmapyro: this is a fault of the program, not of your input; please report it\n")
        return FAULT_OF_OURS
    return status or DONE
