"""Rule campaign: what several tests say together, and the prior of the next one."""

from pathlib import Path

from plasmapyro import configuration, io
from plasmapyro.commands import campaign

io.log_to(snakemake.log[0])
plan = configuration.load(snakemake.input.plan, campaign.SCHEMA)
campaign.write(plan, Path(snakemake.output.priors).parent)
