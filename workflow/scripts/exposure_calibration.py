"""Rule exposure_calibration: radiance per count rate of each pixel, from raw exposures."""

from plasmapyro import job
from plasmapyro.instrument.stage import calibrate_exposures

job.run(snakemake, calibrate_exposures, "spectrometer_calibration")
