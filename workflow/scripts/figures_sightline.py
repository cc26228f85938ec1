"""Rule figures_sightline: what the line of sight crosses (figure 5b)."""

from pathlib import Path

from plasmapyro import io
from plasmapyro.plots import flow

io.log_to(snakemake.log[0])
sightlines = {Path(path).stem: io.read(path, "sightline") for path in snakemake.input.sightlines}
flow.line_of_sight(sightlines, snakemake.output.line_of_sight)
