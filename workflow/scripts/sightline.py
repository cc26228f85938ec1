"""Rule sightline: state of the gas from the probe surface to the instrument."""

from plasmapyro import job
from plasmapyro.sightline.stage import line_of_sight

job.run(snakemake, line_of_sight, "sightline")
