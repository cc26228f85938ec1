"""Rule read_exposures: raw exposures of a source before the spectrometer from a folder of raw files."""

from plasmapyro import io
from plasmapyro.readers.calibration import read_exposures

io.log_to(snakemake.log[0])
result = read_exposures(snakemake.params.folder)
io.write(result, snakemake.output[0], "spectrometer_exposures", sources=snakemake.input)
