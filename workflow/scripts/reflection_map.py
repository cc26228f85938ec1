"""Rule reflection_map: error maps of samples that reflect the gas, before and after correction."""

import numpy as np

from plasmapyro import job
from plasmapyro.analysis.stage import reflection_map
from plasmapyro.quantities import steps

job.run(snakemake, reflection_map, "reflection", object_temperature=steps, emittance=np.linspace)
