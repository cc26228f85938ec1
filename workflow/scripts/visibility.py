"""Rule visibility: share of the surface in each band, against surface temperature."""

import numpy as np

from plasmapyro import io
from plasmapyro.analysis.stage import visibility

io.log_to(snakemake.log[0])
start, stop, step = snakemake.params.object_temperature_k
result = visibility(
    io.read(snakemake.input.gas, "gas_signal"),
    io.read(snakemake.input.response, "response"),
    object_temperature=np.arange(start, stop + step / 2, step),
    visibility_level=snakemake.params.visibility_level,
)
io.write(result, snakemake.output[0], "visibility", sources=snakemake.input, config=dict(snakemake.params))
