"""Rule sightline: state of the gas from the probe surface to the instrument."""

from plasmapyro import io
from plasmapyro.quantities import in_si
from plasmapyro.sightline.stage import line_of_sight

io.log_to(snakemake.log[0])
keys = snakemake.params
result = line_of_sight(
    io.read(snakemake.input[0], "flow"),
    **in_si(keys),
)
io.write(result, snakemake.output[0], "sightline", sources=snakemake.input, config=dict(keys))
