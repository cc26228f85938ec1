"""Rule study_flow: steady flow at one condition of a study, or the word that there is none."""

import numpy as np

from plasmapyro import io
from plasmapyro.study.stage import flow

io.log_to(snakemake.log[0])
keys = snakemake.params
result = flow(
    io.read(snakemake.input.gas, "gas"),
    io.read(snakemake.input.start, "flow"),
    known=[io.read(path, "study_flow") for path in snakemake.input.known],
    neighbours=[io.read(path, "flow") for path in snakemake.input.neighbours],
    emission=next((io.read(path, "net_emission") for path in snakemake.input.emission), None),
    numerical_power=keys.condition["numerical_power_kw"] * 1e3,
    chamber_pressure=keys.condition["chamber_pressure_mbar"] * 100.0,
    mass_flow_rate=keys.condition["mass_flow_rate_g_s"] * 1e-3,
    coil_frequency=keys.coil_frequency_khz * 1e3,
    probe_temperature=keys.probe_temperature_k,
    swirl_angle=np.radians(keys.swirl_angle_deg),
    radiation_factor=keys.radiation_factor,
    power_step=keys.power_step_kw * 1e3,
    viscosity_limiter=keys.viscosity_limiter,
    velocity_tolerance=keys.velocity_tolerance_m_s,
    temperature_tolerance=keys.temperature_tolerance,
    largest_step_count=keys.largest_step_count,
)
io.write(result, snakemake.output[0], "study_flow", sources=snakemake.input, config=dict(keys))
