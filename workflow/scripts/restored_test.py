"""Rule restored_test: a test without the effects that are taken as given."""

from pathlib import Path

from plasmapyro import io, job
from plasmapyro.commands.terms import given_terms
from plasmapyro.diagnosis import command

io.log_to(snakemake.log[0])
paths, keys = snakemake.input, snakemake.params
made, _ = command.without_given(
    io.read(paths.test, "test"),
    command.load_inputs(paths.radiation, Path(paths.response).parent, paths.variations),
    given_terms(keys.effects, paths.get("terms")),
    saturation_counts=keys.saturation_counts,
)
job.write(snakemake, made(), "test")
