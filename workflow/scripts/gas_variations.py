"""Rule gas_variations: spectra of the gas with one property varied at a time."""

from plasmapyro import io
from plasmapyro.diagnosis.gas.stage import gas_variations

io.log_to(snakemake.log[0])
result = gas_variations(
    io.read(snakemake.input.sightline, "sightline"),
    io.read(snakemake.input.view, "surface_view"),
    io.read(snakemake.input.radiation, "radiation"),
    pressure=snakemake.params.pressure_pa,
    boundary_layer_depth=snakemake.params.boundary_layer_depth_mm * 1e-3,
)
io.write(
    result,
    snakemake.output[0],
    "gas_variations",
    sources=snakemake.input,
    config=dict(snakemake.params),
)
