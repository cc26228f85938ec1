"""Rule pyrometer_correction: corrected signals and temperatures of the pyrometer of a test."""

from plasmapyro import job
from plasmapyro.experiment.stage import correct_pyrometer

job.run(snakemake, correct_pyrometer, "pyrometer_correction")
