"""`plasmapyro sightline`: the state of the gas along a ray through a flow field of another program."""

import argparse

from plasmapyro import configuration, io
from plasmapyro.cfd.mapping import SCHEMA
from plasmapyro.cfd.stage import START_GAP, sightline
from plasmapyro.commands.outputs import require_writable
from plasmapyro.sightline import neqair

MOST_POINTS = 5000

DESCRIPTION = """\
Take the state of the gas along a line of sight from the flow field in FILE, as far as the field
reaches, and write it as netCDF, which 'plasmapyro radiance' reads.

FILE is a flow field of another program: VTK (.vtu, .vtk), Tecplot text, SU2 restart with its mesh,
CGNS, a table of scattered points, a profile or a single state. MAP.yaml says what its names and
units mean and where the line of sight starts; docs/power-conditions.md has an example for each."""
EXAMPLE = """\
example:
  plasmapyro sightline torch.vtu --map torch.yaml --out sightline.nc

exit status: 0 done, 2 bad input or usage (one message, nothing written), 1 a fault of ours"""


def add(commands):
    """Add the subcommand to the parser's `commands`."""
    command = commands.add_parser(
        "sightline",
        help="line of sight through a flow field of another program",
        description=DESCRIPTION,
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run)
    command.add_argument("file", metavar="FILE", help="flow field")
    command.add_argument("--map", required=True, metavar="MAP.yaml", help="what the file means")
    command.add_argument("--out", required=True, metavar="FILE.nc", help="where the sight line goes")
    command.add_argument("--mesh", metavar="MESH.su2", help="mesh of an SU2 restart file")
    command.add_argument(
        "--points", type=_points, default=250, metavar="N", help="nodes along the path (default: 250)"
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


def run(options, progress):
    """Run `plasmapyro sightline`: flow field in, sight line out."""
    outputs = [path for path in (options.out, options.line_of_sight_text) if path]
    require_writable(outputs, [options.file, options.map, options.mesh])
    settings = configuration.load(options.map, SCHEMA)
    progress.step(f"reading {options.file}")
    result = sightline(options.file, settings, points=options.points, mesh=options.mesh)
    progress.step(f"the line of sight {result.attrs['path_status']}; writing {options.out}")
    sources = [path for path in (options.file, options.mesh, options.map) if path]
    io.write(result, options.out, "sightline", sources=sources, config={"cfd": settings})
    if options.line_of_sight_text:
        io.write_text(neqair.compose(result), options.line_of_sight_text)
    late = result.attrs["path_end"] != "profile" and result.attrs["entry_distance"] > START_GAP
    if result.attrs["path_end"] == "body" or late:
        progress.warn(f"the line of sight {result.attrs['path_status']}")
    progress.step("done")
