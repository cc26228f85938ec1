"""Rule figures_radiation: radiance of gas and surface (figure 5)."""

from plasmapyro import io
from plasmapyro.plots.radiation import spectral_radiance

io.log_to(snakemake.log[0])
numerical_power = [power * 1e3 for power in snakemake.params.numerical_power_kw]
radiances = {
    name: io.read(path, "radiation")
    for name, path in zip(snakemake.params.conditions, snakemake.input.radiation, strict=True)
}
spectral_radiance(
    radiances,
    numerical_power,
    io.read(snakemake.input.surface, "surface_radiance"),
    io.read(snakemake.input.response, "response"),
    snakemake.output.spectral_radiance,
)
