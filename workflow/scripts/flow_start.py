"""Rule flow_start: steady flow at the reference condition, from a hot first guess."""

from plasmapyro import io
from plasmapyro.flow.stage import cold_start

io.log_to(snakemake.log[0])
keys = snakemake.params
lengths = {name[: -len("_mm")]: keys.torch[name] * 1e-3 for name in keys.lengths}
result = cold_start(
    io.read(snakemake.input[0], "gas"),
    torch={
        **{name.removeprefix("torch_"): value for name, value in lengths.items()},
        "coil_positions": [position * 1e-3 for position in keys.torch["coil_positions_mm"]],
        "probe_shape": keys.torch["probe_shape"],
    },
    wall_temperature=keys.torch["wall_temperature_k"],
    coil_frequency=keys.torch["coil_frequency_khz"] * 1e3,
    probe_temperature=keys.probe_temperature_k,
    numerical_power=keys.numerical_power_kw * 1e3,
    chamber_pressure=keys.chamber_pressure_mbar * 100.0,
    mass_flow_rate=keys.mass_flow_rate_g_s * 1e-3,
    mesh_factor=keys.mesh_factor,
    start_mesh_factor=keys.start_mesh_factor,
    viscosity_limiter=keys.viscosity_limiter,
    velocity_tolerance=keys.velocity_tolerance_m_s,
    temperature_tolerance=keys.temperature_tolerance,
    largest_step_count=keys.largest_step_count,
    error_mesh_ratio=keys.error_mesh_ratio,
)
io.write(result, snakemake.output[0], "flow", sources=snakemake.input, config=dict(keys))
