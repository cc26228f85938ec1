"""Rule surface_radiance: radiance of the grey surface for the figure of spectra."""

import numpy as np

from plasmapyro import io
from plasmapyro.analysis.stage import surface_radiance

io.log_to(snakemake.log[0])
result = surface_radiance(
    object_temperature=snakemake.params.object_temperature_k,
    emittance=snakemake.params.emittance,
    wavelength=np.linspace(*snakemake.params.wavelength_nm, 501) * 1e-9,
)
io.write(result, snakemake.output[0], "surface_radiance", config=dict(snakemake.params))
