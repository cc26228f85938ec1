"""Rule response: modelled spectral responses of the two bands."""

from plasmapyro import io
from plasmapyro.instrument.stage import band_response
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
keys = snakemake.params
result = band_response(
    **in_si(keys),
)
io.write(result, snakemake.output[0], "response", config=dict(keys))
