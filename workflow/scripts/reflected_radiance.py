"""Rule reflected_radiance: light of the gas that arrives at the surface, for a mirror and a matt surface."""

from plasmapyro import io
from plasmapyro.quantities import in_si
from plasmapyro.radiation.stage import reflected_radiance

io.log_to(snakemake.log[0])
keys = snakemake.params
settings = in_si(keys)
result = reflected_radiance(
    io.read(snakemake.input.view, "surface_view"),
    io.read(snakemake.input.response, "response"),
    wavelength_range=settings.pop("wavelength"),
    **settings,
)
io.write(result, snakemake.output[0], "reflected_radiance", sources=snakemake.input, config=dict(keys))
