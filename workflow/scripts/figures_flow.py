"""Rule figures_flow: temperature field and what the line of sight crosses (figures 4a, 4b)."""

from plasmapyro import io
from plasmapyro.plots import flow

io.log_to(snakemake.log[0])
field_sightline = io.read(snakemake.input.field_sightline, "sightline")
flow.temperature_field(
    io.read(snakemake.input.flow, "flow"), field_sightline, snakemake.output.temperature_field
)
numerical_power = [power * 1e3 for power in snakemake.params.numerical_power_kw]
sightlines = {
    name: io.read(path, "sightline")
    for name, path in zip(snakemake.params.conditions, snakemake.input.sightlines, strict=True)
}
flow.line_of_sight(sightlines, numerical_power, snakemake.output.line_of_sight)
