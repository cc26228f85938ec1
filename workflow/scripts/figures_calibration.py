"""Rule figures_calibration: calibrations of the pyrometer and the spectrometer (figures 3b, 4b)."""

from plasmapyro import io
from plasmapyro.plots import instrument

io.log_to(snakemake.log[0])
spectrometer = io.read(snakemake.input.spectrometer, "spectrometer_calibration")
instrument.calibration(io.read(snakemake.input.calibration, "calibration"), snakemake.output.calibration)
instrument.spectrometer_factor(spectrometer, snakemake.output.spectrometer_factor)
