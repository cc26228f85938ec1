"""Rule spectrometer_calibration: radiance per count rate of each pixel."""

from plasmapyro import job
from plasmapyro.instrument.stage import spectrometer_calibration

job.run(snakemake, spectrometer_calibration, "spectrometer_calibration")
