"""Rule surface_view: state of the gas along the rays that light the stagnation point."""

from plasmapyro import job
from plasmapyro.sightline.stage import surface_view

job.run(
    snakemake,
    surface_view,
    "surface_view",
    renamed={"angle": "mirror_angle", "directions": "directions_count"},
)
