"""Rule cfd_sightline: state of the gas from the surface to the instrument, from a file of another program."""

import numpy as np

from plasmapyro import io, job
from plasmapyro.cfd.stage import condition_of, sightline, to_instrument

io.log_to(snakemake.log[0])
keys = snakemake.params
result = to_instrument(
    sightline(
        snakemake.input.file,
        keys.map,
        points=keys.points,
        mesh=snakemake.input.mesh or None,
        angle=np.radians(keys.angle_deg),
    ),
    window_distance=keys.window_distance_mm * 1e-3,
    instrument_distance=keys.instrument_distance_mm * 1e-3,
    laboratory_temperature=keys.laboratory_temperature_k,
    laboratory_pressure=keys.laboratory_pressure_pa,
)
result.attrs |= condition_of(result, keys.map, angle_deg=keys.angle_deg, **keys.state)
job.write(snakemake, result, "sightline")
