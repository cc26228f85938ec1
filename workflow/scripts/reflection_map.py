"""Rule reflection_map: error maps of samples that reflect the gas, before and after correction."""

import numpy as np

from plasmapyro import io
from plasmapyro.analysis.stage import reflection_map
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
keys = snakemake.params
spectra = io.read(snakemake.input.spectra, "gas_spectra")
result = reflection_map(
    io.read(snakemake.input.gas, "gas_signal").sel(condition=spectra.condition.values),
    spectra,
    io.read(snakemake.input.response, "response"),
    io.read(snakemake.input.curve, "ratio_curve"),
    object_temperature=steps(*keys.object_temperature_k),
    emittance=np.linspace(*keys.emittance),
    error_level=keys.error_level,
    gas_variation=keys.gas_variation,
    tolerance_k=keys.tolerance_k,
)
io.write(result, snakemake.output[0], "reflection", sources=snakemake.input, config=dict(keys))
