"""Rule sightline: state of the gas from the probe surface to the instrument."""

import numpy as np

from plasmapyro import io
from plasmapyro.sightline.stage import line_of_sight

io.log_to(snakemake.log[0])
keys = snakemake.params
result = line_of_sight(
    io.read(snakemake.input[0], "flow"),
    angle=np.radians(keys.angle_deg),
    points=keys.points,
    window_distance=keys.window_distance_mm * 1e-3,
    instrument_distance=keys.instrument_distance_mm * 1e-3,
    laboratory_temperature=keys.laboratory_temperature_k,
    laboratory_pressure=keys.laboratory_pressure_pa,
)
io.write(result, snakemake.output[0], "sightline", sources=snakemake.input, config=dict(keys))
