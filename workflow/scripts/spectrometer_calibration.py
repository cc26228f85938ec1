"""Rule spectrometer_calibration: radiance per count rate of each pixel."""

from plasmapyro import io
from plasmapyro.instrument.stage import spectrometer_calibration
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
keys = snakemake.params
result = spectrometer_calibration(
    io.read(snakemake.input[0], "spectrometer_counts"),
    **in_si(keys),
)
io.write(result, snakemake.output[0], "spectrometer_calibration", sources=snakemake.input, config=dict(keys))
