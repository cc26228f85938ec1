"""Rule transient: true and apparent temperature while a sample heats."""

from plasmapyro import io
from plasmapyro.analysis.stage import transient
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
result = transient(
    io.read(snakemake.input.gas, "gas_signal"),
    io.read(snakemake.input.response, "response"),
    io.read(snakemake.input.curve, "ratio_curve"),
    conditions=snakemake.params.conditions,
    time=steps(*snakemake.params.time_s),
    initial_temperature=snakemake.params.initial_temperature_k,
    gain=snakemake.params.gain_k,
    natural_frequency=snakemake.params.natural_frequency_per_s,
)
io.write(result, snakemake.output[0], "transient", sources=snakemake.input, config=dict(snakemake.params))
