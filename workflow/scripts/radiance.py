"""Rule radiance: spectral radiance of the gas along the line of sight, by component."""

from plasmapyro import io
from plasmapyro.commands.changes import radiance_with
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
keys = {name: value for name, value in snakemake.params.items() if value != {}}
settings, table = in_si(keys), snakemake.input.emission_table
result = radiance_with(
    settings.pop("changes", {}),
    io.read(snakemake.input.sightline, "sightline"),
    io.read(snakemake.input.response, "response"),
    wavelength_range=settings.pop("wavelength"),
    table=io.read(table, "emission_table") if table else None,
    **settings,
)
io.write(result, snakemake.output[0], "radiation", sources=snakemake.input, config=keys)
