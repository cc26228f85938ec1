"""`plasmapyro sightline`: the state of the gas along a ray through a flow field of another program."""

import sys

from plasmapyro import configuration, io, progress
from plasmapyro.cfd.mapping import SCHEMA
from plasmapyro.cfd.stage import START_GAP, condition_of, sightline
from plasmapyro.commands.outputs import require_writable
from plasmapyro.quality.catalogue import OF_SIGHTLINE
from plasmapyro.quality.rule import Case, look
from plasmapyro.sightline import neqair

STATE = ("--numerical-power-kw", "--chamber-pressure-mbar", "--mass-flow-rate-g-s")


def run(options):
    """Run `plasmapyro sightline`: flow field in, sight line out."""
    outputs = [path for path in (options.out, options.line_of_sight_text, options.plot) if path]
    require_writable(outputs, [options.file, options.map, options.mesh])
    settings = configuration.load(options.map, SCHEMA)
    state = {name: getattr(options, name) for name in (one[2:].replace("-", "_") for one in STATE)}
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
