"""Rule flow_start: steady flow at the reference condition, from a hot first guess."""

from plasmapyro import io
from plasmapyro.flow.stage import cold_start

TORCH = ("torch_length", "torch_radius", "slot_inner_radius", "coil_radius")
CHAMBER = ("chamber_length", "chamber_radius", "probe_distance", "probe_radius")

io.log_to(snakemake.log[0])
keys = snakemake.params
result = cold_start(
    io.read(snakemake.input[0], "gas"),
    numerical_power=keys.numerical_power_kw * 1e3,
    chamber_pressure=keys.chamber_pressure_mbar * 100.0,
    mass_flow_rate=keys.mass_flow_rate_g_s * 1e-3,
    coil_frequency=keys.coil_frequency_khz * 1e3,
    wall_temperature=keys.wall_temperature_k,
    coil_positions=[position * 1e-3 for position in keys.coil_positions_mm],
    **{name: keys.get(f"{name}_mm") * 1e-3 for name in TORCH + CHAMBER},
    mesh_factor=keys.mesh_factor,
    start_mesh_factor=keys.start_mesh_factor,
    viscosity_limiter=keys.viscosity_limiter,
    velocity_tolerance=keys.velocity_tolerance_m_s,
    temperature_tolerance=keys.temperature_tolerance,
    largest_step_count=keys.largest_step_count,
)
io.write(result, snakemake.output[0], "flow", sources=snakemake.input, config=dict(keys))
