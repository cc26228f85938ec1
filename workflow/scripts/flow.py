"""Rule flow: steady flow at one power condition, continued from the reference."""

from plasmapyro import io
from plasmapyro.flow.stage import condition

io.log_to(snakemake.log[0])
keys = snakemake.params
result = condition(
    io.read(snakemake.input.gas, "gas"),
    io.read(snakemake.input.start, "flow"),
    numerical_power=keys.numerical_power_kw * 1e3,
    chamber_pressure=keys.chamber_pressure_mbar * 100.0,
    mass_flow_rate=keys.mass_flow_rate_g_s * 1e-3,
    power_step=keys.power_step_kw * 1e3,
    viscosity_limiter=keys.viscosity_limiter,
    velocity_tolerance=keys.velocity_tolerance_m_s,
    temperature_tolerance=keys.temperature_tolerance,
    largest_step_count=keys.largest_step_count,
)
io.write(result, snakemake.output[0], "flow", sources=snakemake.input, config=dict(keys))
