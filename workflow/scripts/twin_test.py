"""Rule twin_test: a synthetic test, and its sealed truth that no other rule reads."""

import sys
from pathlib import Path

import xarray as xr

from plasmapyro import workspace

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from twin import campaign

gas = [
    (weight, xr.load_dataset(path))
    for weight, path in zip(snakemake.params.weights, snakemake.input.gas, strict=True)
]
test, truth = campaign.record(
    campaign.Scene(condition=snakemake.params.condition),
    xr.load_dataset(snakemake.input.response),
    gas,
    snakemake.params.seed,
)
origin = {"sources": snakemake.input, "configuration": dict(snakemake.params)}
campaign.write(test, snakemake.output.test, **origin)
campaign.write(truth, snakemake.output.truth, **origin)
workspace.seal(snakemake.output.test)
workspace.seal(snakemake.output.truth)
