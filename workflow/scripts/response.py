"""Rule response: modelled spectral responses of the two bands, or those of an instrument file."""

from plasmapyro import io
from plasmapyro.instrument.stage import band_response
from plasmapyro.quantities import in_si
from plasmapyro.readers.instrument import read_instrument

io.log_to(snakemake.log[0])
keys = snakemake.params
result = read_instrument(snakemake.input[0]) if snakemake.input else band_response(**in_si(keys))
io.write(result, snakemake.output[0], "response", sources=snakemake.input, config=dict(keys))
