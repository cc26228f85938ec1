"""The command `plasmapyro`: one data set at a time, without a workflow."""

import argparse
import atexit
import gc
import logging
import os
import sys
import traceback
import warnings
from functools import partial
from importlib import import_module

import plasmapyro
from plasmapyro import cost
from plasmapyro.commands import options
from plasmapyro.progress import show

DONE, FAULT_OF_OURS, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
EXIT_STATUS = """

exit status: 0 done, 2 bad input or usage (one message, nothing written), 1 a fault of ours"""
COMMANDS = {  # the words of each command, which need not be loaded for the help of all
    "init": "describe a folder of raw files for the first time",
    "check": "say everything that is wrong with a data folder",
    "calibrate": "calibrate pyrometer and spectrometer from raw files",
    "correct": "corrected surface temperatures of one test",
    "correct-reading": "surface temperatures from logged readings, through the gas of a computed condition",
    "live": "temperature and alarms while a test is running",
    "diagnose": "what a simulation gets wrong",
    "campaign": "what several tests say together, and the prior of the next one",
    "identify": "atoms, ions and molecules whose lines a spectrum shows",
    "trust": "from which temperature, and how long after injection, a pyrometer can be trusted",
    "heat-flux": "heat flux on a probe in the facility's jet at a Pitot pressure",
    "sightline": "line of sight through a flow field of another program",
    "radiance": "spectral radiance of the gas along a sight line",
    "serve": "a page on this machine for the folder of a test",
    "completion": "what bash or zsh needs to complete commands and options",
}
EXTRAS = {  # what a light installation leaves out: package -> extra
    **dict.fromkeys(("netgen", "pymetis", "skfem"), "flow"),
    **dict.fromkeys(("cantera", "meshio"), "cfd"),
}
# As in the jobs of the workflow: small matrices wait for threads longer than they take, and bytes may depend
# on their number.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class _Version(argparse.Action):
    """Looked up when it is asked for: the list of installed packages takes longer than the help."""

    def __call__(self, *_):
        sys.stdout.write(f"plasmapyro {plasmapyro.__version__}\n")
        sys.exit(DONE)


def _run(name, given):
    """Run a command; it is loaded for that, not for its help."""
    command = import_module(f"plasmapyro.commands.{name.replace('-', '_')}")
    cost.end_of_imports()
    return command.run(given)


def parser(names=COMMANDS):
    """The argument parser with the options of the named subcommands; each of them sets `run`."""
    top = argparse.ArgumentParser(prog="plasmapyro", description=plasmapyro.__doc__)
    top.add_argument(
        "--version", action=_Version, nargs=0, default=argparse.SUPPRESS, help="show the version and exit"
    )
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name, words in COMMANDS.items():
        if name not in names:
            commands.add_parser(name, help=words)
            continue
        description, epilog = options.words(name)
        command = commands.add_parser(
            name,
            help=words,
            description=description,
            epilog=epilog + ("" if "exit status" in epilog else EXIT_STATUS),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        command.set_defaults(run=partial(_run, name))
        options.add(command, name)
    return top


def main(arguments=None):
    """Run the command line on words, those of the process by default; the exit status.

    0 done, 2 bad input or usage, 1 a fault of ours; what a command says otherwise.
    """
    if arguments is None:
        gc.disable()
        atexit.register(gc.freeze)
        if not sys.warnoptions:  # numpy's words say nothing to a user; tests see them
            warnings.simplefilter("ignore", RuntimeWarning)
    arguments = sys.argv[1:] if arguments is None else arguments
    os.environ.update(ONE_THREAD)  # before a command loads numpy
    given = parser(arguments[:1]).parse_args(arguments)
    # What the library logs, the commands say in their own words.
    logging.getLogger("plasmapyro").addHandler(logging.NullHandler())
    show(sys.stderr)
    try:
        status = given.run(given)
    except (ValueError, OSError) as fault:
        sys.stderr.write(f"plasmapyro: {fault}\n")
        return BAD_INPUT
    except KeyboardInterrupt:
        sys.stderr.write("plasmapyro: stopped; nothing was written\n")
        return INTERRUPTED
    except Exception as fault:
        missing = fault.name if isinstance(fault, ModuleNotFoundError) else None
        if missing in EXTRAS:
            remedy = f'pip install "plasmapyro[{EXTRAS[missing]}]"'
            sys.stderr.write(f"plasmapyro: this needs {missing}, which is not installed: {remedy}\n")
            return BAD_INPUT
        traceback.print_exc()
        sys.stderr.write("plasmapyro: this is a fault of the program, not of your input; please report it\n")
        return FAULT_OF_OURS
    return status or DONE
