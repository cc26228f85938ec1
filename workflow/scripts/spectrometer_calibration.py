"""Rule spectrometer_calibration: radiance per count rate of each pixel."""

from plasmapyro import io
from plasmapyro.instrument.stage import spectrometer_calibration

io.log_to(snakemake.log[0])
keys = snakemake.params
result = spectrometer_calibration(
    io.read(snakemake.input[0], "spectrometer_counts"),
    source_temperature_uncertainty=keys.source_temperature_uncertainty_k,
    saturation_counts=keys.saturation_counts,
    least_net_counts=keys.least_net_counts,
    noise_block=keys.noise_block_pixels,
)
io.write(result, snakemake.output[0], "spectrometer_calibration", sources=snakemake.input, config=dict(keys))
