"""Rule response: modelled spectral responses of the two bands, or those of an instrument file."""

from plasmapyro import io, job
from plasmapyro.instrument.stage import band_response
from plasmapyro.quantities import in_si
from plasmapyro.readers.instrument import read_instrument

io.log_to(snakemake.log[0])
keys = snakemake.params
files = snakemake.input.bands
result = read_instrument(files[0]) if files else band_response(**in_si(keys))
job.write(snakemake, result, "response")
