"""Rule net_emission: power that hot gas radiates, less what it takes up again."""

from plasmapyro import io
from plasmapyro.quantities import in_si
from plasmapyro.radiation.net_emission import net_emission

io.log_to(snakemake.log[0])
result = net_emission(io.read(snakemake.input[0], "gas"), **in_si(snakemake.params))
io.write(result, snakemake.output[0], "net_emission", sources=snakemake.input, config=dict(snakemake.params))
