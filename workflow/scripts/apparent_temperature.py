"""Rule apparent_temperature: what the pyrometer reads through the gas."""

from plasmapyro import io
from plasmapyro.analysis.stage import apparent_temperature
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
result = apparent_temperature(
    io.read(snakemake.input.gas, "gas_signal"),
    io.read(snakemake.input.response, "response"),
    io.read(snakemake.input.curve, "ratio_curve"),
    object_temperature=steps(*snakemake.params.object_temperature_k),
)
io.write(
    result,
    snakemake.output[0],
    "apparent_temperature",
    sources=snakemake.input,
    config=dict(snakemake.params),
)
