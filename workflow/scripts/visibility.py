"""Rule visibility: share of the surface in each band, against surface temperature."""

from plasmapyro import job
from plasmapyro.analysis.stage import visibility
from plasmapyro.quantities import steps

job.run(snakemake, visibility, "visibility", object_temperature=steps)
