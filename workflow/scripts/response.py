"""Rule response: modelled spectral responses of the two bands, or those of an instrument file."""

from plasmapyro import io
from plasmapyro.instrument.stage import band_response
from plasmapyro.quantities import in_si
from plasmapyro.readers.instrument import read_instrument

io.log_to(snakemake.log[0])
keys = snakemake.params
files = snakemake.input.bands
result = read_instrument(files[0]) if files else band_response(**in_si(keys))
io.write(result, snakemake.output[0], "response", sources=snakemake.input, config=dict(keys))
