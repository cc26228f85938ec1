"""Stages of the flow group: one cold start, and each condition from it by continuation."""

import logging
from dataclasses import replace

import numpy as np

from plasmapyro.checks import non_negative, positive
from plasmapyro.flow.balances import balances
from plasmapyro.flow.boundary import inlet_mach_number
from plasmapyro.flow.case import Air, Case, moved, problem_of
from plasmapyro.flow.condition import BESIDE_COLD_GAS, Condition
from plasmapyro.flow.continuation import (
    Extinguished,
    NotConverged,
    Schedule,
    Unbalanced,
    march,
    march_or_slower,
)
from plasmapyro.flow.dataset import Setup, mesh_of, setup_of, state_from, to_dataset
from plasmapyro.flow.evaluate import transfer
from plasmapyro.flow.follow import (
    LARGEST_COURANT,
    LEAST_RESTART_COURANT,
    LINEAR_TOLERANCE,
    PATIENCE,
    RESTART_COURANT,
    UNDER_WAY,
    follow,
)
from plasmapyro.flow.geometry import Torch
from plasmapyro.flow.guess import guessed, is_known
from plasmapyro.flow.initial import hot_torch
from plasmapyro.flow.levels import (
    CLOSE,
    COARSER,
    FAR,
    NEAR,
    Solution,
    coarse_way,
    estimated_error,
    known_levels,
    level_factors,
    state_variables,
)
from plasmapyro.flow.meshes import Meshes, mesh_variables, meshes_of
from plasmapyro.gas.species import AIR, argon_of, nitrogen_of
from plasmapyro.gas.stage import gas_table

log = logging.getLogger(__name__)

START_LIMITERS = (0.2, 0.1)  # viscosity limiter of the two parts of the start on linear elements
# Of the mole fraction of N2, from one gas to the next on the way from air to that of a cold start; in
# oxygen itself the march of linear elements diverges, in nitrogen it finds no flow on the start mesh. A step
# that fails is halved, so often.
GAS_STEP, GAS_HALVINGS = 0.1, 2
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
# The last part of a way; tolerances and number of steps are those asked for.
FINAL = Schedule(RESTART_COURANT, LARGEST_COURANT, 1, confirmed=True, linear_tolerance=LINEAR_TOLERANCE)
FIRST_COURANT = 10.0  # of quadratic elements, from linear ones
TRIES = 2  # known solutions from which a condition is tried
LOW_MACH = 0.7  # at the inlet; density follows the chamber pressure within some 20 % below
MASS_BAR, ENERGY_BAR = 5e-3, 2e-2  # worst imbalance of a solution that is handed on


def cold_start(
    gas,
    *,
    torch,
    wall_temperature,
    mesh_factor,
    start_mesh_factor,
    viscosity_limiter,
    velocity_tolerance,
    temperature_tolerance,
    largest_step_count,
    error_mesh_ratio=0.0,
    **reference,
):
    """Steady flow at a reference condition, from a hot first guess; no swirl, no radiation loss.

    Where a first guess is known (see `guess`), from that on the final mesh. Else linear elements on a mesh of
    their own first (cheap, forgiving), then Taylor-Hood elements, from the coarsest mesh of the error
    estimate to the final one. Another gas than air is reached on that coarsest mesh, from air, by steps of
    its composition.

    ValueError: an argument out of range. NotConverged: no steady state reached; nothing is returned.

    Parameters
    ----------
    gas : Dataset, contract 'gas'
    torch : mapping
        Fields of `geometry.Torch`: lengths [m], and the shape of the probe.
    wall_temperature : float [K]
        Of all walls but the probe's, and of the gas at the inlet.
    mesh_factor, start_mesh_factor : float [1]
        Multiply the cell sizes of the final mesh and of the start mesh.
    viscosity_limiter : float [1]
        Coefficient of the limiter that acts behind the torch exit, >= 0; see `physics`.
    velocity_tolerance : float [m s-1]
    temperature_tolerance : float [1]
        Largest change that Newton's method would still make to the state that is returned.
    largest_step_count : int
    error_mesh_ratio : float [1]
        As in `condition`: its meshes are made here, and handed on with their solutions.
    reference : fields of `condition.Condition` [SI]
        Joule power (the coil current follows from it), pressure, mass flow, frequency, probe temperature.

    Returns
    -------
    Dataset, contract 'flow'
    """
    setup = Setup(
        Torch(**{**torch, "coil_positions": tuple(float(z) for z in torch["coil_positions"])}),
        float(positive("wall_temperature", wall_temperature, "K")),
        float(positive("mesh_factor", mesh_factor, "1")),
    )
    walls = ("back_wall_temperature", *BESIDE_COLD_GAS)
    reference = Condition(**reference, **dict.fromkeys(walls, setup.wall_temperature))
    power = reference.numerical_power
    limiter = float(non_negative("viscosity_limiter", viscosity_limiter, "1"))
    air = Air(_mixed(gas, 0.0, reference), None, setup.wall_temperature)
    label = f"cold start {power / 1e3:g} kW"
    meshes = Meshes(setup.torch)
    factors = level_factors(setup.mesh_factor, _checked_ratio(error_mesh_ratio))
    start_factor = float(positive("start_mesh_factor", start_mesh_factor, "1"))
    meshes(start_factor)  # first: it may be one of the others but for round-off, which is another mesh
    final = replace(
        FINAL,
        first_courant=FIRST_COURANT,
        steps=largest_step_count,
        velocity_tolerance=velocity_tolerance,
        temperature_tolerance=temperature_tolerance,
    )
    case = Case(setup, meshes, Air(gas, None, setup.wall_temperature), 0.0, error_mesh_ratio, label)
    result, solutions = _from_known(case, reference, limiter, final)
    if result is None:
        source, state = _on_linear_elements(meshes, start_factor, setup, air, reference, label)
        # One change at a time: linear to quadratic elements, then from mesh to finer mesh.
        for level in reversed(range(len(factors))):
            problem = problem_of(meshes(factors[level]), setup, air, reference, 2, limiter)
            where = f"{label}, mesh factor {factors[level]:.3g}"
            result = march_or_slower(problem, transfer(state, source, problem), power, final, where)
            final = replace(final, first_courant=RESTART_COURANT)
            if air.gas is not gas:  # the finer meshes begin in it
                try:
                    problem, result = _in_gas(gas, problem, result.state, reference, final, where)
                    air = Air(gas, None, setup.wall_temperature)
                except NotConverged as fault:
                    if not level:
                        raise
                    log.info("%s; on the next finer mesh", fault)
            source, state = problem, result.state
            if air.gas is gas:
                solutions[level] = Solution(problem, state)
    problem = solutions[0].problem
    found = to_dataset(problem, setup, reference, result, _balanced(problem, result, label))
    levels = {**mesh_variables(meshes, factors), **state_variables(solutions)}
    return found.assign(levels).assign_attrs(_named(gas))


def _from_known(case, target, limiter, final):
    """Result on the final mesh and the solutions by level from first guesses there; (None, {}) without."""
    found, results = {}, []
    if not is_known(case.setup, case.air.gas, target):
        return None, {}
    factors = level_factors(case.setup.mesh_factor, case.mesh_ratio)
    problems = [problem_of(case.meshes(one), case.setup, case.air, target, 2, limiter) for one in factors]
    guesses = [guessed(one, case.setup, case.air.gas, target) for one in problems]
    if any(guess is None for guess in guesses):
        return None, {}
    try:
        for level, (problem, guess) in enumerate(zip(problems, guesses, strict=True)):
            schedule = replace(COARSER if level else final, **CLOSE)
            label = f"{case.on_level(level)}, from a known flow"
            results.append(march(problem, guess, target.numerical_power, schedule, label))
            found[level] = Solution(problem, results[-1].state)
        return results[0], found
    except NotConverged as fault:
        log.info("%s; from nothing", fault)
    return None, {}


def _mixed(gas, share, reference):
    """Gas table at `share` of the way from air to the composition of `gas`; that itself where it is there."""
    own, argon, air = nitrogen_of(gas), argon_of(gas), AIR["N2"]
    if share == 1 or (own == air and not argon):
        return gas
    axes = {"temperature": gas.temperature.values, "pressure": [reference.chamber_pressure]}
    return gas_table(nitrogen=round(air + share * (own - air), 6), argon=share * argon, **axes)


def _in_gas(gas, problem, state, reference, final, where):
    """Problem and Result in `gas` from a state in air; a step of composition that fails is halved."""
    count, done = max(int(np.ceil(abs(nitrogen_of(gas) - AIR["N2"]) / GAS_STEP)), 1), 0
    most, before = count * 2**GAS_HALVINGS, "air"
    while done < count:
        air = Air(_mixed(gas, (done + 1) / count, reference), None, problem.wall_temperature)
        trial, name = moved(problem, air, reference), air.gas.attrs["gas"]
        guess = np.where(trial.fixed, trial.values, state)
        schedule = final if done + 1 == count else UNDER_WAY
        try:
            result = march_or_slower(trial, guess, reference.numerical_power, schedule, f"{where}, {name}")
        except NotConverged as fault:
            done, count = 2 * done, 2 * count
            if count > most:
                raise type(fault)(f"{where}: the flow is lost between {before} and {name}: {fault}") from None
            log.info("%s; by smaller steps of the composition", fault)
            continue
        problem, state, done, before = trial, result.state, done + 1, name
    return problem, result


def _on_linear_elements(meshes, start_factor, setup, air, reference, label):
    """Problem on linear elements and its steady state."""
    coarse = problem_of(meshes(start_factor), setup, air, reference, 1)
    state = hot_torch(coarse)
    for limiter, schedule in zip(START_LIMITERS, (FORMATION, SETTLING), strict=True):
        limited, where = coarse.with_limiter(limiter), f"{label}, linear elements"
        state = march(limited, state, reference.numerical_power, schedule, where).state
    return coarse, state


def condition(
    gas,
    start,
    *,
    neighbours=(),
    emission=None,
    viscosity_limiter,
    power_step,
    error_mesh_ratio,
    velocity_tolerance,
    temperature_tolerance,
    largest_step_count,
    **target,
):
    """Steady flow at one condition, continued from the nearest known solution.

    All quantities move together from the known solution to the condition, in parts small enough that none
    changes the power by much more than `power_step`, nor another quantity by more than its step in
    `condition.STEP`; see `follow` for parts that fail. With meshes for an error estimate the way is gone on
    the coarsest of them, see `levels`. If the way from the nearest solution fails, the next nearest is tried;
    `start`, itself a cold start, is one of those known.

    ValueError as `cold_start`; a radiation factor without `emission`; a start in another gas. NotConverged:
    no way led to a steady state; the message says for each how far it led, and where the plasma went out if
    it did.

    Parameters
    ----------
    gas : Dataset, contract 'gas'
        The one `start` was computed with.
    start : Dataset, contract 'flow'
        Result of `cold_start`; torch, probe, wall temperature, meshes and their solutions are taken from it.
        Meshes that it lacks are made again.
    neighbours : sequence of Dataset, contract 'flow'
        Other known solutions; those of another torch, probe or mesh are interpolated, those of another gas
        left out.
    emission : Dataset, contract 'net_emission', optional
        Needed where `radiation_factor` is not zero.
    power_step : float [W]
    error_mesh_ratio : float [1]
        Ratio of the cell sizes of the meshes of the error estimate, > 1; 0 for no estimate.
    others : as in `cold_start`
    target : fields of `condition.Condition` [SI]
        Power, pressure, mass flow, frequency and temperature of the probe; swirl, loss by radiation, mixing
        and temperatures of other walls where there is any; tube and chamber wall are as cold as those of
        `start` without.

    Returns
    -------
    Dataset, contract 'flow'
    """
    setup = setup_of(start)
    target = Condition(**(dict.fromkeys(BESIDE_COLD_GAS, setup.wall_temperature) | target))
    limiter = float(non_negative("viscosity_limiter", viscosity_limiter, "1"))
    power_step = float(positive("power_step", power_step, "W"))
    mesh_ratio = _checked_ratio(error_mesh_ratio)
    final = replace(
        FINAL,
        steps=largest_step_count,
        velocity_tolerance=velocity_tolerance,
        temperature_tolerance=temperature_tolerance,
        least_courant=LEAST_RESTART_COURANT,
        patience=PATIENCE,
    )
    air = Air(gas, emission, setup.wall_temperature)
    meshes = meshes_of(start, setup.torch)
    mesh = mesh_of(start, setup, meshes)
    label = f"condition {target.describe()}"
    mach = inlet_mach_number(
        setup.torch, air.properties(target), target.mass_flow_rate, setup.wall_temperature
    )
    if mach > LOW_MACH:
        log.warning("%s: the gas enters at Mach %.2f; the equations hold for small ones", label, mach)
    if _named(start) != _named(gas):
        raise ValueError(
            f"the start was computed in {start.attrs.get('gas', 'air')}, the gas table is of "
            f"{gas.attrs.get('gas', 'air')}"
        )
    neighbours = [one for one in neighbours if _named(one) == _named(gas)]
    known = sorted((*neighbours, start), key=lambda one: Condition.of(one).parts_to(target, power_step))
    faults, case = [], Case(setup, meshes, air, power_step, mesh_ratio, label)
    if target not in map(Condition.of, known):
        result, solutions = _from_known(case, target, limiter, final)
        if result is not None:
            return _described(case, target, solutions.pop(0).problem, result, solutions)
    for one in known[:TRIES]:
        origin = Condition.of(one)
        problem = problem_of(mesh, setup, air, origin, 2, limiter)
        here = Solution(problem, _known_state(one, setup, problem, gas))
        try:
            return _described(case, target, *_reached(one, here, case, origin, target, final))
        except Unbalanced:
            raise  # another way ends in the same state
        except NotConverged as fault:
            log.info("%s", fault)
            faults.append(fault)
    kind = Extinguished if all(isinstance(fault, Extinguished) for fault in faults) else NotConverged
    tried = "\n".join(map(str, faults))
    if mach > LOW_MACH:
        tried += f"\nThe gas enters at Mach {mach:.2f}; the equations hold for small Mach numbers."
    raise kind(tried)


def _described(case, target, problem, result, coarser):
    """Dataset of a flow, with the estimated error and the solutions on coarser meshes where there are any."""
    balance, error = _balanced(problem, result, case.label), None
    if case.mesh_ratio:
        error = estimated_error(Solution(problem, result.state), coarser, case, target)
    found = to_dataset(problem, case.setup, target, result, balance, error)
    return found.assign(state_variables(coarser)).assign_attrs(_named(case.air.gas))


def _named(gas):
    """Attribute that names the gas of a table or flow."""
    return {"gas": gas.attrs.get("gas", "air")}


def _checked_ratio(error_mesh_ratio):
    if error_mesh_ratio and not error_mesh_ratio > 1:
        raise ValueError(f"error_mesh_ratio must be 0 or > 1; got {error_mesh_ratio:g}")
    return float(error_mesh_ratio)


def _known_state(dataset, setup, problem, gas):
    """State of `problem` from a flow dataset, interpolated if it stands on another mesh."""
    own = setup_of(dataset)
    if own == setup:
        return state_from(dataset, problem)
    air = Air(gas, None, own.wall_temperature)
    plain = replace(Condition.of(dataset), radiation_factor=0.0)
    source = problem_of(mesh_of(dataset, own), own, air, plain, 2)
    return transfer(state_from(dataset, source), source, problem)


def _reached(dataset, here, case, origin, target, final):
    """Problem at `target`, its Result, and the solutions on coarser meshes by level that led there.

    With meshes for an error estimate the way is gone on the coarsest of them, and only its end on the finer
    ones, that of `here` the last; without, or where the coarse mesh finds no way, on the mesh of `here`.
    """
    if case.mesh_ratio:
        try:
            known = known_levels(dataset, here, case, origin)
            coarser, guess = coarse_way(here, known, case, origin, target)
            problem = moved(here.problem, case.air, target)
            label = f"{case.label}, from the coarse mesh"
            schedule = replace(final, **(NEAR if 1 in coarser else FAR))
            return problem, march(problem, guess, target.numerical_power, schedule, label), coarser
        except NotConverged as fault:
            log.info("%s; the way is tried on the fine mesh", fault)
    problem, result = follow(
        here.problem, here.state, case.air, origin, target, case.power_step, final, case.label
    )
    return problem, result, {}


def _balanced(problem, result, label):
    """Balances of a result; Unbalanced where they do not close."""
    balance = balances(problem, result.state, result.coupling)
    if abs(balance.mass_imbalance) > MASS_BAR or abs(balance.energy_imbalance) > ENERGY_BAR:
        raise Unbalanced(
            f"{label}: converged, but mass is off by {balance.mass_imbalance:.2%} and energy by "
            f"{balance.energy_imbalance:.2%} (limits {MASS_BAR:.1%}, {ENERGY_BAR:.1%}); "
            "refine the mesh (flow.start.mesh_factor)"
        )
    log.info(
        "%s: %d steps, mass imbalance %.3f %%, energy imbalance %.3f %%",
        label, len(result.steps), 100 * balance.mass_imbalance, 100 * balance.energy_imbalance,
    )  # fmt: skip
    return balance
