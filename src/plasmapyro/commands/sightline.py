"""`plasmapyro sightline`: the state of the gas along a ray through a flow field of another program."""

import argparse
import sys

from plasmapyro import configuration, io, progress
from plasmapyro.cfd.mapping import SCHEMA
from plasmapyro.cfd.stage import START_GAP, condition_of, sightline
from plasmapyro.commands.options import plot_option
from plasmapyro.commands.outputs import require_writable
from plasmapyro.quality.catalogue import OF_SIGHTLINE
from plasmapyro.quality.rule import Case, look
from plasmapyro.sightline import neqair

MOST_POINTS = 5000
STATE = {
    "--numerical-power-kw": "power coupled to the plasma [kW]",
    "--chamber-pressure-mbar": "pressure of the chamber [mbar]",
    "--mass-flow-rate-g-s": "mass flow rate of the gas [g/s]",
}

DESCRIPTION = """\
Take the state of the gas along a line of sight from the flow field in FILE, as far as the field
reaches, and write it as netCDF, which 'plasmapyro radiance' reads.

FILE is a flow field of another program: VTK (.vtu, .vtk), Tecplot text, SU2 restart with its mesh,
CGNS, a table of scattered points, a profile or a single state. MAP.yaml says what its names and
units mean and where the line of sight starts; docs/power-conditions.md has an example for each."""
EXAMPLE = """\
example:
  plasmapyro sightline torch.vtu --map torch.yaml --out sightline.nc"""


def add(command):
    """Add the arguments to the subcommand's parser."""
    command.add_argument("file", metavar="FILE", help="flow field")
    command.add_argument("--map", required=True, metavar="MAP.yaml", help="what the file means")
    command.add_argument("--out", required=True, metavar="FILE.nc", help="where the sight line goes")
    plot_option(command, "temperature and pressure along it")
    command.add_argument("--mesh", metavar="MESH.su2", help="mesh of an SU2 restart file")
    command.add_argument(
        "--points", type=_points, default=250, metavar="N", help="nodes along the path (default: 250)"
    )
    for option, quantity in STATE.items():
        command.add_argument(
            option, type=float, metavar="VALUE", help=f"{quantity}, for the ladder of powers"
        )
    command.add_argument(
        "--line-of-sight-text",
        metavar="FILE",
        help="write the sight line also as NEQAIR 15 reads it (LOS.dat)",
    )


def _points(word):
    number = int(word)
    if not 20 <= number <= MOST_POINTS:
        raise argparse.ArgumentTypeError(f"must lie in [20, {MOST_POINTS}]; got {number}")
    return number


def run(options):
    """Run `plasmapyro sightline`: flow field in, sight line out."""
    outputs = [path for path in (options.out, options.line_of_sight_text, options.plot) if path]
    require_writable(outputs, [options.file, options.map, options.mesh])
    settings = configuration.load(options.map, SCHEMA)
    state = {option[2:].replace("-", "_"): getattr(options, option[2:].replace("-", "_")) for option in STATE}
    if len({value is None for value in state.values()}) > 1:
        raise ValueError(
            f"give {', '.join(STATE)} together: simulations that share all but the power form a ladder"
        )
    progress.say(f"reading {options.file}")
    result = sightline(options.file, settings, points=options.points, mesh=options.mesh)
    result.attrs |= condition_of(result, settings, **state)
    for finding in look(Case(options.file, sightline=result), OF_SIGHTLINE):
        progress.warn(finding.words)
    progress.say(f"the line of sight {result.attrs['path_status']}; writing {options.out}")
    sources = [path for path in (options.file, options.mesh, options.map) if path]
    io.write(result, options.out, "sightline", sources=sources, config={"cfd": settings})
    if options.line_of_sight_text:
        io.write_text(neqair.compose(result), options.line_of_sight_text)
    if options.plot:
        from plasmapyro.plots import radiation as plots  # matplotlib, which only pictures need

        plots.line_of_sight(result, [options.plot])
    late = result.attrs["path_end"] != "profile" and result.attrs["entry_distance"] > START_GAP
    if result.attrs["path_end"] == "body" or late:
        progress.warn(f"the line of sight {result.attrs['path_status']}")
    sys.stdout.write(summary(result))
    progress.say("done")


def summary(line):
    """What came out, in two lines: how long, how hot and where; pressure and composition there."""
    distance, temperature = line["path_distance"].values, line["temperature"].values
    hottest = int(temperature.argmax())
    density = line["number_density"].isel(path_distance=hottest)
    most = (density / density.sum()).sortby(-density).isel(species=slice(3))
    parts = ", ".join(f"{str(one.species.values)} {float(one):.2g}" for one in most)
    return (
        f"line of sight: {1e3 * (distance[-1] - distance[0]):.4g} mm in {distance.size} points, hottest"
        f" {temperature[hottest]:.0f} K at {1e3 * distance[hottest]:.4g} mm\n"
        f"  there {float(line['pressure'][hottest]) / 100:.4g} mbar; mole fractions: {parts}\n"
    )
