"""Rule figures_analysis: what the line of sight crosses, its light, and what it does (figures 5b to 8)."""

from pathlib import Path

from plasmapyro import io
from plasmapyro.plots import analysis, flow, radiation

io.log_to(snakemake.log[0])
given, drawn = snakemake.input, snakemake.output
lines = {Path(path).stem: io.read(path, "sightline") for path in given.sightlines}
flow.line_of_sight(lines, drawn.line_of_sight)
radiation.spectral_radiance(
    {Path(path).stem: io.read(path, "radiation") for path in given.radiation},
    io.read(given.surface, "surface_radiance"),
    io.read(given.response, "response"),
    drawn.spectral_radiance,
)
visibility = io.read(given.visibility, "visibility")
analysis.visibility_factors(visibility, drawn.visibility_factors)
analysis.visibility_limits(visibility, drawn.visibility_limits)
reading = io.read(given.apparent_temperature, "apparent_temperature")
analysis.apparent_temperature(reading, drawn.apparent_temperature)
analysis.relative_error(reading, drawn.relative_error)
analysis.error_map(io.read(given.error_map, "error_map"), drawn.error_map)
analysis.transient(io.read(given.transient, "transient"), drawn.transient)
