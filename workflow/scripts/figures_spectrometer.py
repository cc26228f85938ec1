"""Rule figures_spectrometer: spectra of a test (figures 10a, 10b)."""

from plasmapyro import io
from plasmapyro.plots import experiment

io.log_to(snakemake.log[0])
spectra = io.read(snakemake.input.spectrometer, "spectrometer_correction")
numerical_power = [power * 1e3 for power in snakemake.params.numerical_power_kw]
radiances = {
    name: io.read(path, "radiation")
    for name, path in zip(snakemake.params.conditions, snakemake.input.radiation, strict=True)
}
experiment.reference_spectrum(spectra, radiances, numerical_power, snakemake.output.reference_spectrum)
experiment.normalised_spectra(spectra, snakemake.params.spectrum_times_s, snakemake.output.normalised_spectra)
