"""Rule twin_calibration: synthetic calibration of both instruments."""

import sys
from pathlib import Path

import xarray as xr

from plasmapyro import workspace

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from twin import campaign

response = xr.load_dataset(snakemake.input.response)
origin = {"sources": snakemake.input, "configuration": dict(snakemake.params)}
points = campaign.calibration_points(response, snakemake.params.seed)
campaign.write(points, snakemake.output.points, **origin)
campaign.write(campaign.spectrometer_counts(snakemake.params.seed), snakemake.output.counts, **origin)
workspace.seal(snakemake.output.points)
workspace.seal(snakemake.output.counts)
