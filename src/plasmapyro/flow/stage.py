"""Stages of the flow group: one cold start, and each condition from it by continuation."""

import logging

import numpy as np

from plasmapyro.checks import non_negative, positive
from plasmapyro.flow.balances import balances
from plasmapyro.flow.continuation import NotConverged, Schedule, march
from plasmapyro.flow.dataset import Setup, mesh_of, setup_of, state_from, to_dataset
from plasmapyro.flow.geometry import Torch, build_mesh
from plasmapyro.flow.initial import hot_torch, transfer
from plasmapyro.flow.problem import Problem
from plasmapyro.flow.properties import gas_properties

log = logging.getLogger(__name__)

START_LIMITERS = (0.2, 0.1)  # viscosity limiter of the two parts of the start on linear elements
# Formation of the torch vortex: above CFL 6 the frozen Joule heating overheats single spots.
FORMATION = Schedule(1.0, 6.0, 60, relaxation=0.5, converged_courant=np.inf)
SETTLING = Schedule(
    6.0,
    2000.0,
    200,
    growth=1.3,
    growth_limit=0.08,
    relaxation=0.5,
    velocity_tolerance=5.0,
    temperature_tolerance=0.1,
    converged_courant=30.0,
)
# Quadratic elements on the start mesh, only a first guess for the final mesh.
UPGRADE = Schedule(
    10.0, 3000.0, 60, velocity_tolerance=20.0, temperature_tolerance=0.1, converged_courant=100.0
)
# From one condition to a near one Newton's method converges from the first step. A small Courant number would
# follow the growth of the unsteady shear layer of the cold sheath instead, and lose the solution.
RESTART_COURANT = 200.0
# Part of the way to another condition: only the last part has to be steady.
UNDER_WAY = Schedule(
    RESTART_COURANT,
    3000.0,
    30,
    velocity_tolerance=20.0,
    temperature_tolerance=0.1,
    converged_courant=300.0,
)
PRESSURE_STEP, FLOW_STEP = 0.2, 0.2  # largest change of ln p and of ln(mass flow) per part
MASS_BAR, ENERGY_BAR = 5e-3, 2e-2  # worst imbalance of a solution that is handed on


def cold_start(
    gas,
    *,
    numerical_power,
    chamber_pressure,
    mass_flow_rate,
    coil_frequency,
    wall_temperature,
    torch_length,
    torch_radius,
    slot_inner_radius,
    chamber_length,
    chamber_radius,
    probe_distance,
    probe_radius,
    coil_radius,
    coil_positions,
    mesh_factor,
    start_mesh_factor,
    viscosity_limiter,
    velocity_tolerance,
    temperature_tolerance,
    largest_step_count,
):
    """Steady flow at a reference condition, from a hot first guess.

    Linear elements on a mesh of their own first (cheap, forgiving), then Taylor-Hood elements on the final
    mesh.

    Parameters
    ----------
    gas : Dataset, contract 'gas'
    numerical_power : float [W]
        Joule power; the coil current follows from it.
    chamber_pressure : float [Pa]
    mass_flow_rate : float [kg s-1]
    coil_frequency : float [Hz]
    wall_temperature : float [K]
        Of all walls and of the gas at the inlet.
    torch_length ... coil_positions : float [m], sequence for `coil_positions`
        See `geometry.Torch`.
    mesh_factor, start_mesh_factor : float [1]
        Multiply the cell sizes of the final mesh and of the start mesh.
    viscosity_limiter : float [1]
        Coefficient of the limiter that acts behind the torch exit, >= 0; see `physics`.
    velocity_tolerance : float [m s-1]
    temperature_tolerance : float [1]
        Largest change that Newton's method would still make to the state that is returned.
    largest_step_count : int

    Returns
    -------
    Dataset, contract 'flow'

    Raises
    ------
    ValueError
        An argument out of range.
    NotConverged
        No steady state reached; nothing is returned.
    """
    torch = Torch(
        torch_length,
        torch_radius,
        slot_inner_radius,
        chamber_length,
        chamber_radius,
        probe_distance,
        probe_radius,
        coil_radius,
        tuple(float(z) for z in coil_positions),
    )
    setup = Setup(
        torch,
        float(positive("coil_frequency", coil_frequency, "Hz")),
        float(positive("wall_temperature", wall_temperature, "K")),
        float(positive("mesh_factor", mesh_factor, "1")),
    )
    power = float(positive("numerical_power", numerical_power, "W"))
    limiter = float(non_negative("viscosity_limiter", viscosity_limiter, "1"))
    positive("mass_flow_rate", mass_flow_rate, "kg s-1")
    properties = gas_properties(gas, chamber_pressure, setup.wall_temperature)
    label = f"cold start {power / 1e3:g} kW"
    coarse_mesh = build_mesh(torch, positive("start_mesh_factor", start_mesh_factor, "1"))
    coarse = _problem(coarse_mesh, setup, properties, mass_flow_rate, 1)
    state = hot_torch(coarse)
    for start_limiter, schedule in zip(START_LIMITERS, (FORMATION, SETTLING), strict=True):
        limited = coarse.with_limiter(start_limiter)
        state = march(limited, state, power, schedule, f"{label}, linear elements").state
    # One change at a time: linear to quadratic on one mesh, then the finer mesh.
    source = coarse
    if setup.mesh_factor < start_mesh_factor:
        source = _problem(coarse_mesh, setup, properties, mass_flow_rate, 2, limiter)
        state = transfer(state, coarse, source)
        state = march(source, state, power, UPGRADE, f"{label}, start mesh").state
    fine = _problem(build_mesh(torch, setup.mesh_factor), setup, properties, mass_flow_rate, 2, limiter)
    state = transfer(state, source, fine)
    final = Schedule(
        10.0,
        3000.0,
        largest_step_count,
        velocity_tolerance=velocity_tolerance,
        temperature_tolerance=temperature_tolerance,
        confirmed=True,
    )
    return _finished(fine, setup, state, power, final, label)


def condition(
    gas,
    start,
    *,
    numerical_power,
    chamber_pressure,
    mass_flow_rate,
    viscosity_limiter,
    power_step,
    velocity_tolerance,
    temperature_tolerance,
    largest_step_count,
):
    """Steady flow at one condition, continued from the reference solution and from nothing else.

    Power, pressure and mass flow move together from the reference to the condition in equal ratios, small
    enough that no part changes the power by much more than `power_step`, nor the pressure or the mass flow by
    more than a fifth.

    Parameters
    ----------
    gas : Dataset, contract 'gas'
        The one `start` was computed with.
    start : Dataset, contract 'flow'
        Result of `cold_start`; torch, coil frequency, wall temperature and mesh are taken from it.
    power_step : float [W]
    others : as in `cold_start`

    Returns
    -------
    Dataset, contract 'flow'

    Raises
    ------
    ValueError, NotConverged
        As `cold_start`.
    """
    power = float(positive("numerical_power", numerical_power, "W"))
    target = np.array(
        [
            power,
            positive("chamber_pressure", chamber_pressure, "Pa"),
            positive("mass_flow_rate", mass_flow_rate, "kg s-1"),
        ],
        dtype=float,
    )
    limiter = float(non_negative("viscosity_limiter", viscosity_limiter, "1"))
    setup = setup_of(start)
    origin = np.array(
        [float(start[name]) for name in ("numerical_power", "chamber_pressure", "mass_flow_rate")]
    )
    path = _path(origin, target, float(positive("power_step", power_step, "W")))
    label = f"condition {power / 1e3:g} kW"
    properties = gas_properties(gas, path[0][1], setup.wall_temperature)
    problem = _problem(mesh_of(start, setup), setup, properties, path[0][2], 2, limiter)
    state = state_from(start, problem)
    for number, (part_power, pressure, flow) in enumerate(path[:-1], 1):
        problem = _moved(problem, gas, pressure, flow)
        state[problem.fixed] = problem.values[problem.fixed]
        state = march(problem, state, part_power, UNDER_WAY, f"{label}, part {number} of {len(path)}").state
    problem = _moved(problem, gas, *path[-1][1:])
    state[problem.fixed] = problem.values[problem.fixed]
    final = Schedule(
        RESTART_COURANT,
        3000.0,
        largest_step_count,
        velocity_tolerance=velocity_tolerance,
        temperature_tolerance=temperature_tolerance,
        confirmed=True,
    )
    return _finished(problem, setup, state, power, final, label)


def _problem(mesh, setup, properties, mass_flow_rate, order, limiter=0.0):
    return Problem(
        mesh,
        setup.torch,
        properties,
        frequency=setup.frequency,
        mass_flow_rate=float(mass_flow_rate),
        wall_temperature=setup.wall_temperature,
        order=order,
        limiter=limiter,
    )


def _moved(problem, gas, pressure, mass_flow_rate):
    """`problem` at another pressure and mass flow; itself if they are its own."""
    if pressure == problem.properties.pressure and mass_flow_rate == problem.mass_flow_rate:
        return problem
    properties = gas_properties(gas, pressure, problem.wall_temperature)
    return problem.with_gas(properties, float(mass_flow_rate))


def _path(origin, target, power_step):
    """Conditions (power, pressure, mass flow) from the first part to the target, the last one exactly it."""
    parts = max(
        abs(target[0] - origin[0]) / power_step,
        abs(np.log(target[1] / origin[1])) / PRESSURE_STEP,
        abs(np.log(target[2] / origin[2])) / FLOW_STEP,
    )
    count = max(int(np.ceil(parts - 1e-9)), 1)
    shares = np.arange(1, count) / count
    return [*(origin * (target / origin) ** share for share in shares), target]


def _finished(problem, setup, state, power, schedule, label):
    """March to the steady state, check the balances, make the dataset."""
    result = march(problem, state, power, schedule, label)
    balance = balances(problem, result.state, result.coupling)
    if abs(balance.mass_imbalance) > MASS_BAR or abs(balance.energy_imbalance) > ENERGY_BAR:
        raise NotConverged(
            f"{label}: converged, but mass is off by {balance.mass_imbalance:.2%} and energy by "
            f"{balance.energy_imbalance:.2%} (limits {MASS_BAR:.1%}, {ENERGY_BAR:.1%}); refine the mesh"
        )
    log.info(
        "%s: %d steps, mass imbalance %.3f %%, energy imbalance %.3f %%",
        label, len(result.steps), 100 * balance.mass_imbalance, 100 * balance.energy_imbalance,
    )  # fmt: skip
    return to_dataset(problem, setup, result, balance)
