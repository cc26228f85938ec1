"""Rule joint_estimate: surface temperature from everything the instruments of a test give."""

from plasmapyro import job
from plasmapyro.estimate.stage import estimate

job.run(snakemake, estimate, "joint_estimate")
