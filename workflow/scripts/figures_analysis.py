"""Rule figures_analysis: visibility, apparent temperature, error, error map, transient (figures 7, 8)."""

from plasmapyro import io
from plasmapyro.plots import analysis

io.log_to(snakemake.log[0])
visibility = io.read(snakemake.input.visibility, "visibility")
analysis.visibility_factors(visibility, snakemake.output.visibility_factors)
analysis.visibility_limits(visibility, snakemake.output.visibility_limits)
reading = io.read(snakemake.input.apparent_temperature, "apparent_temperature")
analysis.apparent_temperature(reading, snakemake.output.apparent_temperature)
analysis.relative_error(reading, snakemake.output.relative_error)
analysis.error_map(io.read(snakemake.input.error_map, "error_map"), snakemake.output.error_map)
analysis.transient(io.read(snakemake.input.transient, "transient"), snakemake.output.transient)
