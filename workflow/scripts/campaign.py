"""Rule campaign: what several tests say together, and the prior of the next one."""

from pathlib import Path

from plasmapyro import io
from plasmapyro.commands import campaign

io.log_to(snakemake.log[0])
campaign.write(campaign.plan_of(snakemake.input.plan), Path(snakemake.output.priors).parent)
