"""Rule apparent_temperature: what the pyrometer reads through the gas."""

import numpy as np

from plasmapyro import io
from plasmapyro.analysis.stage import apparent_temperature

io.log_to(snakemake.log[0])
start, stop, step = snakemake.params.object_temperature_k
result = apparent_temperature(
    io.read(snakemake.input.gas, "gas_signal"),
    io.read(snakemake.input.response, "response"),
    io.read(snakemake.input.curve, "ratio_curve"),
    object_temperature=np.arange(start, stop + step / 2, step),
)
io.write(
    result,
    snakemake.output[0],
    "apparent_temperature",
    sources=snakemake.input,
    config=dict(snakemake.params),
)
