"""Rule read_points: calibration points of the pyrometer from a folder of raw files."""

from plasmapyro import io
from plasmapyro.readers.calibration import read_points

io.log_to(snakemake.log[0])
result = read_points(snakemake.params.folder)
io.write(result, snakemake.output[0], "calibration_points", sources=snakemake.input)
