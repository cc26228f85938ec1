"""Rule twin_test: a synthetic test, and its sealed truth, which only the page of a diagnosis shows."""

import sys
from functools import partial
from pathlib import Path

from plasmapyro import io
from plasmapyro.quantities import in_si
from plasmapyro.versions import told

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from twin import campaign, story

FACTS = ("electric_power", "pyrometer_period", "spectrometer_period")
io.log_to(snakemake.log[0])
given, keys = snakemake.input, snakemake.params
gas = [(weight, io.read(path, "radiation")) for weight, path in zip(keys.weights, given.gas, strict=True)]
gas = story.true_gas(keys.effects, gas, [io.read(path, "radiation") for path in given.beside])
kinds = ("sightline", "gas", "flow")
profile = [io.read(path, kind) for path, kind in zip(given.profile, kinds, strict=False)]
test, truth = campaign.record(
    story.scene(keys.condition, keys.effects, gas, profile, **{name: in_si(keys)[name] for name in FACTS}),
    io.read(given.response, "response"),
    gas,
    keys.seed,
)
settings = {name: value for name, value in keys.items() if value != []}
origin = {"sources": given, "configuration": settings, "versions": told()}
io.store(snakemake.output.test, partial(campaign.write, test, **origin))
io.store(snakemake.output.truth, partial(campaign.write, truth, **origin))
