"""Rule surface_view: state of the gas along the rays that light the stagnation point."""

import numpy as np

from plasmapyro import io
from plasmapyro.sightline.stage import surface_view

io.log_to(snakemake.log[0])
keys = snakemake.params
result = surface_view(
    io.read(snakemake.input[0], "flow"),
    mirror_angle=np.radians(keys.angle_deg),
    directions_count=keys.directions,
    core_angle=np.radians(keys.core_angle_deg),
    points=keys.points,
)
io.write(result, snakemake.output[0], "surface_view", sources=snakemake.input, config=dict(keys))
