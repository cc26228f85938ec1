"""Rule emission_table: what the particles of a mixture emit, on temperature nodes, for all its conditions."""

from plasmapyro import job
from plasmapyro.radiation.stored_table import stored_table

job.run(snakemake, stored_table, "emission_table", renamed={"wavelength": "wavelength_range"})
