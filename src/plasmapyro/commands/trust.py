"""`plasmapyro trust`: from when on a pyrometer can be believed."""

import sys
from pathlib import Path

from plasmapyro import configuration, io, progress
from plasmapyro.commands.outputs import require_writable
from plasmapyro.design.settings import design_tables, settings_from
from plasmapyro.design.trust import as_markdown, trust


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
