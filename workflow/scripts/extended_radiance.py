"""Rule extended_radiance: light of the gas as a diagnosis proposes it; as it was if it proposes nothing."""

from plasmapyro import io
from plasmapyro.commands.terms import levels_of, read_terms
from plasmapyro.quantities import in_si
from plasmapyro.radiation.stage import line_of_sight_radiance

io.log_to(snakemake.log[0])
files, keys = snakemake.input, in_si(snakemake.params)
terms = read_terms(files.terms[0], "condition")
axes = {"wavelength_range": keys.pop("wavelength"), "levels": levels_of(terms)}
inputs = [io.read(files.sightline, "sightline"), io.read(files.response, "response")] if terms else []
base = io.read(files.radiation, "radiation")
result = line_of_sight_radiance(*inputs, **axes, **keys) if terms else base
io.write(result, snakemake.output[0], "radiation", sources=files, config=dict(snakemake.params))
