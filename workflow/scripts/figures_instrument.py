"""Rule figures_instrument: responses of the bands (figure 3a)."""

from plasmapyro import io
from plasmapyro.plots import instrument

io.log_to(snakemake.log[0])
instrument.responses(io.read(snakemake.input.response, "response"), snakemake.output.responses)
