"""Rule cfd_surface_view: rays that light the stagnation point, in a flow field of another program."""

import numpy as np

from plasmapyro import io, job
from plasmapyro.cfd.stage import surface_view

io.log_to(snakemake.log[0])
keys = snakemake.params
result = surface_view(
    snakemake.input.file,
    keys.map,
    mesh=snakemake.input.mesh or None,
    mirror_angle=np.radians(keys.angle_deg),
    directions_count=keys.directions,
    core_angle=np.radians(keys.core_angle_deg),
    points=keys.points,
)
job.write(snakemake, result, "surface_view")
