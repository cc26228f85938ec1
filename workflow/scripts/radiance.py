"""Rule radiance: spectral radiance of the gas along the line of sight, by component."""

from plasmapyro import io, progress
from plasmapyro.radiation.stage import line_of_sight_radiance

io.log_to(snakemake.log[0])
keys = snakemake.params
result = line_of_sight_radiance(
    io.read(snakemake.input.sightline, "sightline"),
    io.read(snakemake.input.response, "response"),
    wavelength_range=[edge * 1e-9 for edge in keys.wavelength_nm],
    grid_points=keys.grid_points,
    slit_fwhm=keys.slit_fwhm_nm * 1e-9,
    progress=progress.counter("layers"),
)
io.write(result, snakemake.output[0], "radiation", sources=snakemake.input, config=dict(keys))
