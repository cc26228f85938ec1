"""Rule net_emission: power that optically thin air radiates, a lower bound of the loss."""

from plasmapyro import io
from plasmapyro.radiation.net_emission import net_emission

io.log_to(snakemake.log[0])
result = net_emission(io.read(snakemake.input[0], "gas"))
io.write(result, snakemake.output[0], "net_emission", sources=snakemake.input)
