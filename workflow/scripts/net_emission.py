"""Rule net_emission: power that hot gas radiates, less what it takes up again."""

from plasmapyro import job
from plasmapyro.radiation.net_emission import net_emission

job.run(snakemake, net_emission, "net_emission")
