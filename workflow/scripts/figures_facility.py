"""Rule figures_facility: computed flows and measured pairs in the plane of heat flux and Pitot pressure."""

from plasmapyro import io
from plasmapyro.plots import facility

io.log_to(snakemake.log[0])
facility.pairs(io.read(snakemake.input[0], "facility"), snakemake.output)
