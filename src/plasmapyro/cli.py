"""The command `plasmapyro`: one data set at a time, without a workflow."""

import argparse
import logging
import os
import sys
import traceback
import warnings
from importlib import import_module

from plasmapyro import __doc__ as PACKAGE
from plasmapyro.progress import show

DONE, FAULT_OF_OURS, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
COMMANDS = (
    "init",
    "check",
    "calibrate",
    "correct",
    "correct-reading",
    "diagnose",
    "trust",
    "sightline",
    "radiance",
)
# As in the jobs of the workflow: small matrices wait for threads longer than they take, and bytes may depend
# on their number.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def parser(names=COMMANDS):
    """The argument parser of the named subcommands; each sets `run`, a function of the options."""
    top = argparse.ArgumentParser(prog="plasmapyro", description=PACKAGE)
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name in names:
        import_module(f"plasmapyro.commands.{name.replace('-', '_')}").add(commands)
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
    if arguments is None and not sys.warnoptions:  # numpy's words say nothing to a user; tests see them
        warnings.simplefilter("ignore", RuntimeWarning)
    arguments = sys.argv[1:] if arguments is None else arguments
    os.environ.update(ONE_THREAD)  # before a command loads numpy
    options = parser(arguments[:1] if set(arguments[:1]) & set(COMMANDS) else COMMANDS).parse_args(arguments)
    # What the library logs, the commands say in their own words.
    logging.getLogger("plasmapyro").addHandler(logging.NullHandler())
    show(sys.stderr)
    try:
        status = options.run(options)
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
