"""Rule figures_study: limit of the error over power, pressure and flow, and over emittance and angle."""

from plasmapyro import io
from plasmapyro.plots import study

io.log_to(snakemake.log[0])
dataset = io.read(snakemake.input[0], "study")
study.limit_over_conditions(dataset, snakemake.output.limit)
study.limit_over_emittance(dataset, snakemake.output.emittance)
