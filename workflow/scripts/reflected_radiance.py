"""Rule reflected_radiance: light of the gas that arrives at the surface, for a mirror and a matt surface."""

from plasmapyro import job
from plasmapyro.radiation.stage import reflected_radiance

job.run(snakemake, reflected_radiance, "reflected_radiance", renamed={"wavelength": "wavelength_range"})
