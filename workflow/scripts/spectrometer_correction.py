"""Rule spectrometer_correction: corrected spectra of a test and the temperatures fitted to them."""

from plasmapyro import job
from plasmapyro.experiment.stage import correct_spectra

job.run(snakemake, correct_spectra, "spectrometer_correction")
