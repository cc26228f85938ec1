"""Rule exposure_calibration: radiance per count rate of each pixel, from raw exposures."""

from plasmapyro import io
from plasmapyro.instrument.stage import calibrate_exposures

io.log_to(snakemake.log[0])
keys = snakemake.params
result = calibrate_exposures(
    io.read(snakemake.input[0], "spectrometer_exposures"),
    saturation_counts=keys.saturation_counts,
    least_net_counts=keys.least_net_counts,
    noise_block=keys.noise_block_pixels,
)
io.write(result, snakemake.output[0], "spectrometer_calibration", sources=snakemake.input, config=dict(keys))
