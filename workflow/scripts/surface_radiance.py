"""Rule surface_radiance: radiance of the grey surface for the figure of spectra."""

from functools import partial

import numpy as np

from plasmapyro import job
from plasmapyro.analysis.stage import surface_radiance

job.run(snakemake, surface_radiance, "surface_radiance", wavelength=partial(np.linspace, num=501))
