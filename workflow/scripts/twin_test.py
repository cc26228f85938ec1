"""Rule twin_test: a synthetic test, and its sealed truth that no other rule reads."""

import sys
from pathlib import Path

import xarray as xr

from plasmapyro import workspace

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from twin import campaign, story

gas = [
    (weight, xr.load_dataset(path))
    for weight, path in zip(snakemake.params.weights, snakemake.input.gas, strict=True)
]
profile = [xr.load_dataset(path) for path in snakemake.input.profile]
test, truth = campaign.record(
    story.scene(snakemake.params.condition, snakemake.params.effects, gas, profile),
    xr.load_dataset(snakemake.input.response),
    gas,
    snakemake.params.seed,
)
told = {name: value for name, value in snakemake.params.items() if value != []}
origin = {"sources": snakemake.input, "configuration": told}
campaign.write(test, snakemake.output.test, **origin)
campaign.write(truth, snakemake.output.truth, **origin)
workspace.seal(snakemake.output.test)
workspace.seal(snakemake.output.truth)
