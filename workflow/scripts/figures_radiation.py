"""Rule figures_radiation: radiance of gas and surface (figure 6)."""

from pathlib import Path

from plasmapyro import io
from plasmapyro.plots.radiation import spectral_radiance

io.log_to(snakemake.log[0])
spectral_radiance(
    {Path(path).stem: io.read(path, "radiation") for path in snakemake.input.radiation},
    io.read(snakemake.input.surface, "surface_radiance"),
    io.read(snakemake.input.response, "response"),
    snakemake.output.spectral_radiance,
)
