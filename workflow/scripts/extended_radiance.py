"""Rule extended_radiance: light of the gas as a diagnosis proposes it; as it was if it proposes nothing."""

from plasmapyro import io, job
from plasmapyro.commands.changes import radiance_with
from plasmapyro.commands.terms import changes_of, read_terms
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
files, keys = snakemake.input, in_si(snakemake.params)
terms = read_terms(files.terms[0], "condition")
axes = {"wavelength_range": keys.pop("wavelength")}
inputs = [io.read(files.sightline, "sightline"), io.read(files.response, "response")] if terms else []
base = io.read(files.radiation, "radiation")
result = radiance_with(changes_of(terms), *inputs, **axes, **keys) if terms else base
job.write(snakemake, result, "radiation")
