"""Rule visibility: share of the surface in each band, against surface temperature."""

from plasmapyro import io
from plasmapyro.analysis.stage import visibility
from plasmapyro.quantities import steps

io.log_to(snakemake.log[0])
result = visibility(
    io.read(snakemake.input.gas, "gas_signal"),
    io.read(snakemake.input.response, "response"),
    object_temperature=steps(*snakemake.params.object_temperature_k),
    visibility_level=snakemake.params.visibility_level,
)
io.write(result, snakemake.output[0], "visibility", sources=snakemake.input, config=dict(snakemake.params))
