"""Mass and energy leaving through each part of the boundary."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.flow.geometry import BOUNDARIES, WALLS
from plasmapyro.flow.physics import AXIAL, LOG_TEMPERATURE, RADIAL, REFERENCE_VELOCITY, ROW_SCALE

PERMEABLE = ("inlet", "top", "outlet")


@dataclass(frozen=True)
class Balances:
    """Outward flows per boundary name; imbalances as fractions.

    `mass_imbalance`: net outflow over gross outflow. `energy_imbalance`: (enthalpy + heat flows + radiated
    power - Joule power) over Joule power.
    """

    mass_flow: dict
    enthalpy_flow: dict
    heat_flow: dict
    radiated_power: float
    mass_imbalance: float
    energy_imbalance: float


def balances(problem, state, coupling):
    """Balances of a state.

    Mass and enthalpy flows are quadratures of rho u . n and rho u . n h, h zero at the wall temperature.
    Heat into the walls and the inlet is the reaction of the energy equation at the fixed temperatures, which
    is what the discrete solution conducts; it is more accurate than the gradient of T at the wall. On an
    adiabatic wall, the last to be asked, it is what the steady state leaves open. Nothing
    is closed by construction: density and enthalpy are nonlinear in the unknowns, and the steady state is
    reached within a tolerance.
    """
    mass_flow, enthalpy_flow, heat_flow = ({name: 0.0 for name in BOUNDARIES} for _ in range(3))
    gross = 0.0
    for name in PERMEABLE:
        flux, enthalpy, leaving = _flows(problem, state, name)
        mass_flow[name], enthalpy_flow[name] = flux, enthalpy
        gross += leaving
    reaction = _reaction(problem, state, coupling)
    taken = np.zeros(len(reaction), bool)
    for name in sorted((*WALLS, "inlet"), key=lambda name: name in problem.adiabatic_walls):
        if not len(problem.mesh.boundaries[name]):
            continue
        dofs = problem.space.boundary_dofs(LOG_TEMPERATURE, (name,))
        # A corner shared by two boundaries counts once, for the first.
        dofs = dofs[~taken[dofs]]
        taken[dofs] = True
        heat_flow[name] = float(-reaction[dofs].sum())
    radiated = problem.radiated_power(state)
    leaving = sum(enthalpy_flow.values()) + sum(heat_flow.values()) + radiated
    return Balances(
        mass_flow,
        enthalpy_flow,
        heat_flow,
        radiated,
        mass_imbalance=sum(mass_flow.values()) / gross,
        energy_imbalance=leaving / coupling.power - 1,
    )


def _flows(problem, state, name):
    """Net mass flow [kg s-1], enthalpy flow [W] and gross mass outflow [kg s-1] through one boundary."""
    patch = problem.space.facets((name,))
    inputs = problem.space.inputs(patch, state)
    temperature = np.exp(inputs[3 * LOG_TEMPERATURE])
    outward = REFERENCE_VELOCITY * (
        inputs[3 * AXIAL] * patch.normal[0] + inputs[3 * RADIAL] * patch.normal[1]
    )
    flux = problem.properties.density(temperature)[0] * outward * patch.weight
    enthalpy = problem.properties.enthalpy(temperature)[0]
    return float(flux.sum()), float((flux * enthalpy).sum()), float(np.maximum(flux, 0).sum())


def _reaction(problem, state, coupling):
    """Steady residual of the energy equation at the ln T dofs [W]: heat from the wall into the gas."""
    points = problem.points(state, coupling, np.inf)
    rows = problem.residual(state, points)[problem.space.field(LOG_TEMPERATURE)]
    return rows / ROW_SCALE[3 * LOG_TEMPERATURE]
