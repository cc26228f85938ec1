"""Rule reflected_radiance: light of the gas that arrives at the surface, for a mirror and a matt surface."""

from plasmapyro import io
from plasmapyro.radiation.stage import reflected_radiance

io.log_to(snakemake.log[0])
keys = snakemake.params
result = reflected_radiance(
    io.read(snakemake.input.view, "surface_view"),
    io.read(snakemake.input.response, "response"),
    wavelength_range=[edge * 1e-9 for edge in keys.wavelength_nm],
    grid_points=keys.grid_points,
    slit_fwhm=keys.slit_fwhm_nm * 1e-9,
)
io.write(result, snakemake.output[0], "reflected_radiance", sources=snakemake.input, config=dict(keys))
