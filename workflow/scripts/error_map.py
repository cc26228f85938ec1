"""Rule error_map: relative error over surface temperature and emittance, and the curve of one level."""

import numpy as np

from plasmapyro import job
from plasmapyro.analysis.stage import error_map
from plasmapyro.quantities import steps

job.run(snakemake, error_map, "error_map", object_temperature=steps, emittance=np.geomspace)
