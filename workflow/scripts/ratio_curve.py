"""Rule ratio_curve: modelled signal ratio of a black body, with the published sensitivity ratio."""

from plasmapyro import io
from plasmapyro.instrument.stage import ratio_curve
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
keys = snakemake.params
result = ratio_curve(
    io.read(snakemake.input.response, "response"),
    sensitivity_ratio=keys.sensitivity_ratio,
    calibration_temperature=steps(*keys.temperature_k),
    instrument_range=keys.instrument_range_k,
)
io.write(result, snakemake.output[0], "ratio_curve", sources=snakemake.input, config=dict(keys))
