"""Rule spectrometer_correction: corrected spectra of a test and the temperatures fitted to them."""

from plasmapyro import io
from plasmapyro.experiment.stage import correct_spectra

io.log_to(snakemake.log[0])
keys = snakemake.params
result = correct_spectra(
    io.read(snakemake.input.test, "test"),
    io.read(snakemake.input.calibration, "spectrometer_calibration") if snakemake.input.calibration else None,
    reference_time=keys.reference_time_s,
    normalisation_wavelength=keys.normalisation_wavelength_nm * 1e-9,
    normalisation_half_width=keys.normalisation_half_width_nm * 1e-9,
    temperature_range=keys.temperature_range_k,
    saturation_counts=keys.saturation_counts,
    gas_variation=keys.gas_variation,
    least_signal_to_noise=keys.least_signal_to_noise,
    noise_block=keys.noise_block_pixels,
    draws=keys.draws,
    seed=keys.seed,
)
io.write(result, snakemake.output[0], "spectrometer_correction", sources=snakemake.input, config=dict(keys))
