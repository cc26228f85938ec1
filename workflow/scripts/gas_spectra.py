"""Rule gas_spectra: binned spectra of the gas along every line of sight and of the light on the sample."""

import numpy as np

from plasmapyro import io
from plasmapyro.design.stage import gas_spectra

io.log_to(snakemake.log[0])
keys, given = snakemake.params, snakemake.input
result = gas_spectra(
    {name: io.read(path, "sightline") for name, path in zip(keys.conditions, given.sightlines, strict=True)},
    {name: io.read(path, "flow") for name, path in zip(keys.conditions, given.flows, strict=True)},
    wavelength_range=[edge * 1e-9 for edge in keys.wavelength_nm],
    grid_points=keys.grid_points,
    table_nodes=keys.table_nodes,
    bin_width=keys.bin_width_nm * 1e-9,
    temperature_change=keys.temperature_change,
    thinning=keys.sightline_thinning,
    mirror_angle=np.radians(keys.angle_deg),
    directions=keys.directions,
    core_angle=np.radians(keys.core_angle_deg),
    ray_points=keys.ray_points,
)
io.write(result, snakemake.output[0], "gas_spectra", sources=given, config=dict(keys))
