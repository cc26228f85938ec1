"""Rule read_points: calibration points of the pyrometer from a folder of raw files."""

from plasmapyro import job
from plasmapyro.readers.calibration import read_points

job.run(snakemake, read_points, "calibration_points")
