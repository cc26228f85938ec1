"""Rule radiometer_calibration: sensitivities of the bands of an instrument, from a folder of raw files."""

from plasmapyro import io, job
from plasmapyro.instrument.bands import radiometer_calibration
from plasmapyro.quantities import in_si
from plasmapyro.readers.calibration import read_bands

io.log_to(snakemake.log[0])
keys = in_si(snakemake.params)
result = radiometer_calibration(*read_bands(keys.pop("folder")), **keys)
job.write(snakemake, result, "radiometer_calibration")
