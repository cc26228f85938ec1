"""Rule error_map: relative error over surface temperature and emittance, and the curve of one level."""

import numpy as np

from plasmapyro import io
from plasmapyro.analysis.stage import error_map
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
result = error_map(
    io.read(snakemake.input.gas, "gas_signal"),
    io.read(snakemake.input.response, "response"),
    io.read(snakemake.input.curve, "ratio_curve"),
    object_temperature=steps(*snakemake.params.object_temperature_k),
    emittance=np.geomspace(*snakemake.params.emittance),
    error_level=snakemake.params.error_level,
)
io.write(result, snakemake.output[0], "error_map", sources=snakemake.input, config=dict(snakemake.params))
