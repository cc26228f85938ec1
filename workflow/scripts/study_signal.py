"""Rule study_signal: band signals of the gas along one line of sight of a study."""

import numpy as np

from plasmapyro import io
from plasmapyro.study.stage import signal

io.log_to(snakemake.log[0])
keys = snakemake.params
result = signal(
    io.read(snakemake.input.flow, "study_flow"),
    io.read(snakemake.input.response, "response"),
    angle=np.radians(keys.angle_deg),
    points=keys.points,
    window_distance=keys.window_distance_mm * 1e-3,
    instrument_distance=keys.instrument_distance_mm * 1e-3,
    laboratory_temperature=keys.laboratory_temperature_k,
    laboratory_pressure=keys.laboratory_pressure_pa,
    wavelength_range=[edge * 1e-9 for edge in keys.wavelength_nm],
    grid_points=keys.grid_points,
    slit_fwhm=keys.slit_fwhm_nm * 1e-9,
)
io.write(result, snakemake.output[0], "study_signal", sources=snakemake.input, config=dict(keys))
