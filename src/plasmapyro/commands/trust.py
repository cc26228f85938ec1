"""`plasmapyro trust`: from when on a pyrometer can be believed."""

import sys
from pathlib import Path

from plasmapyro import configuration, io, progress
from plasmapyro.commands.outputs import require_writable
from plasmapyro.design.settings import design_tables, settings_from
from plasmapyro.design.trust import as_markdown, trust

DESCRIPTION = """\
Say from which surface temperature on, and how long after injection, a pyrometer reads within
given errors behind the gas, with and without correction, and which second measurement helps most.

Needs results/design of the workflow: snakemake --cores 2 results/design/band_design.nc"""
EXAMPLE = """\
example:
  plasmapyro trust 90kW --emittance 0.8 0.9 --heating 350 1500 0.2 --instrument 'Optris CT 1M (1.0 um)'"""


def add(command):
    """Add the arguments to the subcommand's parser."""
    command.add_argument("condition", metavar="CONDITION", help="name of a power condition, such as 90kW")
    command.add_argument(
        "--emittance", nargs=2, type=float, metavar=("LOW", "HIGH"), help="range expected of the sample"
    )
    command.add_argument(
        "--heating",
        nargs=3,
        type=float,
        metavar=("START", "RISE", "FREQUENCY"),
        help="start [K], rise to the steady temperature [K], natural frequency [1/s]",
    )
    command.add_argument(
        "--instrument",
        action="append",
        default=[],
        metavar="NAME",
        help="a further design or pyrometer, by name",
    )
    command.add_argument(
        "--results", default="results", metavar="FOLDER", help="of the workflow (default: results)"
    )
    command.add_argument("--config", default="config/config.yaml", metavar="FILE", help="of the workflow")
    command.add_argument(
        "--schema", default="config/schema.yaml", metavar="FILE", help="of the configuration"
    )
    command.add_argument("--out", metavar="FILE.md", help="write the page there instead of showing it")


def _spectra(folder, condition):
    """Spectra of the conditions of the paper, or of one's own if the condition is not among them."""
    spectra, own = io.read(folder / "gas_spectra.nc", "gas_spectra"), folder / "gas_spectra_own.nc"
    return spectra if condition in spectra.condition or not own.exists() else io.read(own, "gas_spectra")


def run(options):
    """Run `plasmapyro trust`: the results of the design in, one page out."""
    if options.out:
        require_writable([options.out], [options.config])
    config = configuration.load(options.config, options.schema)
    keys, sightline = config["design"], config["sightline"]
    asked = {
        "emittance_range": options.emittance,
        "initial_temperature_k": options.heating and options.heating[0],
        "gain_k": options.heating and options.heating[1],
        "natural_frequency_per_s": options.heating and options.heating[2],
    }
    keys["trust"] |= {name: value for name, value in asked.items() if value is not None}
    configuration.check(config, options.schema, options.config)
    progress.say(f"reading {options.results}")
    folder = Path(options.results)
    result = trust(
        _spectra(folder / "design", options.condition),
        io.read(folder / "design/band_design.nc", "band_design"),
        io.read(folder / "instrument/response.nc", "response"),
        design_tables(config["instrument"]["response"]["silicon_table"]),
        settings=settings_from(keys, sightline["instrument_distance_mm"] - sightline["window_distance_mm"]),
        instruments=options.instrument,
    )
    page = as_markdown(result, options.condition)
    if options.out:
        io.write_text(page, options.out)
    else:
        sys.stdout.write(page)
    progress.say("done")
