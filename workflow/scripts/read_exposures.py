"""Rule read_exposures: raw exposures of a source before the spectrometer from a folder of raw files."""

from plasmapyro import job
from plasmapyro.readers.calibration import read_exposures

job.run(snakemake, read_exposures, "spectrometer_exposures")
