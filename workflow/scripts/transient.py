"""Rule transient: true and apparent temperature while a sample heats."""

from plasmapyro import job
from plasmapyro.analysis.stage import transient
from plasmapyro.quantities import steps

job.run(snakemake, transient, "transient", time=steps)
