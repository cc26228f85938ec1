"""Rule diagnosis: what the simulation gets wrong in a test, why, and what it costs."""

import json
from pathlib import Path

from plasmapyro import io
from plasmapyro.commands.terms import given_terms
from plasmapyro.diagnosis import command

io.log_to(snakemake.log[0])
paths, keys = snakemake.input, snakemake.params
inputs = command.load_inputs(paths.radiation, Path(paths.response).parent, paths.variations)
result = command.diagnose_test(
    paths.test,
    inputs,
    without=tuple(keys.without),
    draws=keys.draws,
    seed=keys.seed,
    saturation_counts=keys.saturation_counts,
    limits=keys.limits,
    given=given_terms(keys.effects, paths.get("terms")),
    others=list(paths.others),
    findings=json.loads(io.read_text(paths.findings)),
)
folder, truth = Path(snakemake.output.report).parent, command.truth_of(paths.test)
command.write_all(result, folder, sources=paths, page=command.page_writer(), truth=truth)
