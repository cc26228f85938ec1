"""Rule figures_instrument: responses and calibrations (figures 3a, 3b, 4b)."""

from plasmapyro import io
from plasmapyro.plots import instrument

io.log_to(snakemake.log[0])
calibration = io.read(snakemake.input.calibration, "calibration")
spectrometer = io.read(snakemake.input.spectrometer, "spectrometer_calibration")
instrument.responses(io.read(snakemake.input.response, "response"), snakemake.output.responses)
instrument.calibration(calibration, snakemake.output.calibration)
instrument.spectrometer_factor(spectrometer, snakemake.output.spectrometer_factor)
