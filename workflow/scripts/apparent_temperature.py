"""Rule apparent_temperature: what the pyrometer reads through the gas."""

from plasmapyro import job
from plasmapyro.analysis.stage import apparent_temperature
from plasmapyro.quantities import steps

job.run(snakemake, apparent_temperature, "apparent_temperature", object_temperature=steps)
