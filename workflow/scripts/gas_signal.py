"""Rule gas_signal: band signals of the gas of all conditions, side by side."""

from plasmapyro import io
from plasmapyro.analysis.stage import gather

io.log_to(snakemake.log[0])
result = gather(
    {
        name: io.read(path, "radiation")
        for name, path in zip(snakemake.params.conditions, snakemake.input.radiation, strict=True)
    },
    emittance=snakemake.params.emittance,
)
io.write(
    result,
    snakemake.output[0],
    "gas_signal",
    sources=snakemake.input.radiation,
    config=dict(snakemake.params),
)
