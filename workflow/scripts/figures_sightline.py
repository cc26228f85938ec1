"""Rule figures_sightline: what the line of sight crosses (figure 4b)."""

from plasmapyro import io
from plasmapyro.plots import flow

io.log_to(snakemake.log[0])
numerical_power = [power * 1e3 for power in snakemake.params.numerical_power_kw]
sightlines = {
    name: io.read(path, "sightline")
    for name, path in zip(snakemake.params.conditions, snakemake.input.sightlines, strict=True)
}
flow.line_of_sight(sightlines, numerical_power, snakemake.output.line_of_sight)
