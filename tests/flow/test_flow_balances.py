"""Balances of a made-up state whose flows are known by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.flow.balances import balances
from plasmapyro.flow.geometry import Torch, build_mesh
from plasmapyro.flow.physics import AXIAL, LOG_TEMPERATURE, RADIAL, REFERENCE_VELOCITY, ROW_SCALE
from plasmapyro.flow.problem import Problem
from plasmapyro.flow.properties import gas_properties

DENSITY, HEAT_CAPACITY, WALL = 2.0, 1000.0, 350.0  # `constant_gas` at 1 kPa
FED, OUT_SPEED, ENTRAINED_SPEED = 0.016, 7.0, 0.3  # [kg/s, m/s, m/s]
POWER = 5e4
EXACT = 1e-9  # plane boundaries, velocities within the quadratic elements; sums of 1e4 terms


@pytest.fixture(scope="module")
def case(constant_gas):
    """Problem, state and balances: feed at the inlet, uniform outflow, uniform inflow through the top.

    The temperature rises with r and z up to every wall, so that heat crosses the corners too.
    """
    torch = Torch(0.486, 0.080, 0.075, 0.500, 0.160, 0.385, 0.025, 0.109, (0.127, 0.377))
    problem = Problem(
        build_mesh(torch, 2.0),
        torch,
        gas_properties(constant_gas, 1e3, WALL),
        frequency=4e5,
        mass_flow_rate=FED,
        wall_temperature=WALL,
        order=2,
    )
    space, state = problem.space, np.zeros(problem.space.size)
    z, r = space.points(AXIAL)
    axial, radial = np.zeros_like(z), np.zeros_like(z)
    slot = space.boundary_dofs(AXIAL, ("inlet",))
    axial[slot] = problem.values[space.field(AXIAL)][slot]
    # The corner of top and outlet belongs to both: each takes the component normal to it.
    axial[np.abs(z - 0.986) < 1e-9] = OUT_SPEED / REFERENCE_VELOCITY
    radial[np.abs(r - 0.160) < 1e-9] = -ENTRAINED_SPEED / REFERENCE_VELOCITY
    state[space.field(AXIAL)], state[space.field(RADIAL)] = axial, radial
    state[space.field(LOG_TEMPERATURE)] = np.log(1000.0 + 2e4 * r + 3e3 * z)
    zero = np.zeros_like(space.cells.r)
    coupling = SimpleNamespace(joule_heating=zero, force_axial=zero, force_radial=zero, power=POWER)
    return problem, state, coupling, balances(problem, state, coupling)


def test_mass_flows_are_those_by_hand(case):
    flow = case[-1].mass_flow
    leaving = DENSITY * OUT_SPEED * np.pi * (0.160**2 - 0.025**2)
    entrained = DENSITY * ENTRAINED_SPEED * 2 * np.pi * 0.160 * 0.500
    assert flow["inlet"] == pytest.approx(-FED, rel=EXACT)
    assert flow["outlet"] == pytest.approx(leaving, rel=EXACT)
    assert flow["top"] == pytest.approx(-entrained, rel=EXACT)
    assert all(flow[wall] == 0.0 for wall in ("back_wall", "tube_wall", "chamber_wall", "probe"))
    # Only the outlet lets gas out: its flow is the gross outflow.
    expected = (leaving - entrained - FED) / leaving
    assert case[-1].mass_imbalance == pytest.approx(expected, rel=EXACT)


def test_enthalpy_counts_from_the_wall_temperature(case):
    # h = c_p (T - T_wall) with T = 1000 + 2e4 r + 3e3 z; top: r = 0.160 m, mean z = 0.736 m.
    mean = 1000.0 + 2e4 * 0.160 + 3e3 * 0.736 - WALL
    expected = case[-1].mass_flow["top"] * HEAT_CAPACITY * mean
    # 1e-4: ln T is quadratic on an element, T is not.
    assert case[-1].enthalpy_flow["top"] == pytest.approx(expected, rel=1e-4)


def test_heat_through_a_corner_counts_once(case):
    problem, state, coupling, found = case
    space = problem.space
    residual = problem.residual(state, problem.points(state, coupling, np.inf))
    rows = -residual[space.field(LOG_TEMPERATURE)] / ROW_SCALE[3 * LOG_TEMPERATURE]
    held = problem.fixed[space.field(LOG_TEMPERATURE)]  # a mask: every node once
    total = sum(found.heat_flow.values())
    assert total == pytest.approx(rows[held].sum(), rel=1e-10)
    walls = ("back_wall", "tube_wall", "chamber_wall", "probe", "inlet")
    twice = sum(rows[space.boundary_dofs(LOG_TEMPERATURE, (name,))].sum() for name in walls)
    assert abs(twice - total) > 1e-6 * abs(total)  # the corners of this state do carry heat


def test_energy_imbalance_is_the_sum_over_the_power(case):
    found = case[-1]
    leaving = sum(found.enthalpy_flow.values()) + sum(found.heat_flow.values())
    assert found.energy_imbalance == pytest.approx((leaving - POWER) / POWER, rel=1e-12)
