"""Rule figures_spectrometer: spectra of a test (figures 11a, 11b)."""

from pathlib import Path

from plasmapyro import io
from plasmapyro.plots import experiment

io.log_to(snakemake.log[0])
spectra = io.read(snakemake.input.spectrometer, "spectrometer_correction")
radiances = {Path(path).stem: io.read(path, "radiation") for path in snakemake.input.radiation}
experiment.reference_spectrum(spectra, radiances, snakemake.output.reference_spectrum)
experiment.normalised_spectra(spectra, snakemake.params.spectrum_times_s, snakemake.output.normalised_spectra)
