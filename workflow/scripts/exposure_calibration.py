"""Rule exposure_calibration: radiance per count rate of each pixel, from raw exposures."""

from plasmapyro import io
from plasmapyro.instrument.stage import calibrate_exposures
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
keys = snakemake.params
result = calibrate_exposures(
    io.read(snakemake.input[0], "spectrometer_exposures"),
    **in_si(keys),
)
io.write(result, snakemake.output[0], "spectrometer_calibration", sources=snakemake.input, config=dict(keys))
