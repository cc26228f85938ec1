"""Rule twin_calibration: synthetic calibration of both instruments."""

import sys
from functools import partial
from pathlib import Path

from plasmapyro import io
from plasmapyro.versions import told

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from twin import campaign

io.log_to(snakemake.log[0])
given, made, keys = snakemake.input, snakemake.output, snakemake.params
origin = {"sources": given, "configuration": dict(keys), "versions": told()}
points = campaign.calibration_points(io.read(given.response, "response"), keys.seed)
io.store(made.points, partial(campaign.write, points, **origin))
io.store(made.counts, partial(campaign.write, campaign.spectrometer_counts(keys.seed), **origin))
