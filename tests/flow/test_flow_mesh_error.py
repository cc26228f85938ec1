"""The error estimate from three meshes, and values between the nodes, on functions that are known."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.flow.elements import Space
from plasmapyro.flow.evaluate import carried, place_in, temperature_at, transfer, values_at
from plasmapyro.flow.levels import Solution
from plasmapyro.flow.mesh_error import SAFETY, SAFETY_OF_TWO, mesh_error
from plasmapyro.flow.physics import LOG_TEMPERATURE
from plasmapyro.flow.properties import gas_properties


@pytest.fixture(scope="module")
def solution(air):
    """Function (mesh, temperature(z, r), order) -> Solution with that temperature at its nodes."""
    properties = gas_properties(air, 5e3, 350.0)

    def make(mesh, temperature, order=2):
        space = Space(mesh, (order, order, order, 1))
        state = np.zeros(space.size)
        state[space.field(LOG_TEMPERATURE)] = np.log(temperature(*space.points(LOG_TEMPERATURE)))
        return Solution(SimpleNamespace(mesh=mesh, space=space, properties=properties), state)

    return make


def level(temperature):
    return lambda z, r: temperature + 0 * z


@pytest.mark.parametrize("order", [1, 2])
def test_a_polynomial_of_the_element_is_reproduced_anywhere(pipe, order):
    mesh = pipe(5)
    space = Space(mesh, (order,))
    rng = np.random.default_rng(4)
    points = np.stack([rng.uniform(0, 0.3, 200), rng.uniform(0, 0.1, 200)])

    def polynomial(z, r):
        return 7.0 + z - 2 * r + (order - 1) * (5 * z * r - 3 * z * z + r * r)

    found = values_at(space, 0, polynomial(*space.points(0)), place_in(mesh, points))
    np.testing.assert_allclose(found, polynomial(*points), rtol=1e-12)


def test_a_point_just_outside_is_continued_and_one_far_away_is_not(pipe):
    mesh = pipe(3)
    space = Space(mesh, (2,))
    place = place_in(mesh, np.array([[0.1, 0.1], [0.1001, 0.3]]))
    near, far = values_at(space, 0, space.points(0)[1] ** 2, place)
    assert near == pytest.approx(0.1001**2, rel=1e-9)
    assert far == pytest.approx(0.1**2, rel=1e-9)


def test_a_large_triangle_among_small_ones_is_found(pipe):
    # A corner of a large triangle whose centre is farther away than those of many small ones.
    fine, coarse = pipe(20), pipe(2)
    mesh = coarse.translated((0.3, 0.0)) + fine
    points = np.array([[0.301, 0.35, 0.599], [0.0505, 0.0995, 0.001]])
    place = place_in(mesh, points)
    corners = mesh.p[:, mesh.t[:, place.triangle]]
    np.testing.assert_allclose((corners * place.area).sum(axis=1), points, atol=1e-12)
    assert place.area.min() > -1e-9


def test_fields_are_carried_to_other_meshes_and_orders(pipe, solution):
    source = solution(pipe(3), lambda z, r: np.exp(6 + z * r), order=2)
    source.state[source.problem.space.field(3)] = 5.0 - source.problem.space.points(3)[0]
    for other in (solution(pipe(5), level(300.0)), solution(pipe(3), level(300.0), order=1)):
        space = other.problem.space
        found = carried(source.state, source.problem, other.problem)
        z, r = space.points(LOG_TEMPERATURE)
        np.testing.assert_allclose(found[space.field(LOG_TEMPERATURE)], 6 + z * r, rtol=1e-12)
        np.testing.assert_allclose(found[space.field(3)], 5.0 - space.points(3)[0], rtol=1e-12)
        assert not found[: space.offsets[LOG_TEMPERATURE]].any()


def test_the_temperature_on_a_cold_wall_follows_from_a_uniform_heat_flux(pipe, solution, air):
    # kappa dT/dr uniform across one cell from 350 to 4000 K: temperatures in between are those of the
    # potential, which a parabola in T or ln T misses by hundreds of kelvin.
    properties = gas_properties(air, 5e3, 350.0)
    grid = np.linspace(350.0, 4000.0, 4001)
    conductivity = properties.thermal_conductivity(grid)[0]
    potential = np.concatenate([[0.0], np.cumsum((conductivity[1:] + conductivity[:-1]) / 2 * np.diff(grid))])

    def exact(r):
        return np.interp(potential[-1] * (1 - r / 0.1), potential, grid)

    case = solution(pipe(1), lambda z, r: exact(r))
    r = np.linspace(0.0, 0.1, 17)
    found = temperature_at(case.problem, case.state, np.stack([np.full_like(r, 0.11), r]))
    np.testing.assert_allclose(found, exact(r), rtol=1e-4)  # trapezoids of 1 K


def test_a_finer_mesh_gets_the_temperatures_of_the_heat_flux(pipe, solution, air):
    # The same wall, carried to cells eight times as small: what lies between the old nodes decides.
    properties = gas_properties(air, 5e3, 350.0)
    whole = properties.heat_flux_potential(4000.0)[0] - properties.heat_flux_potential(350.0)[0]

    def exact(z, r):
        return properties.temperature_of(properties.heat_flux_potential(350.0)[0] + whole * (1 - r / 0.1))

    here, there = solution(pipe(1), exact), solution(pipe(8), exact)
    target = there.problem
    target.fixed = np.zeros(target.space.size, bool)
    target.values = np.zeros(target.space.size)
    found = transfer(here.state, here.problem, target)
    heat = target.space.field(LOG_TEMPERATURE)
    np.testing.assert_allclose(np.exp(found[heat]), np.exp(there.state[heat]), rtol=1e-6)
    plain = carried(here.state, here.problem, target)[heat]
    assert np.abs(np.exp(plain) - np.exp(there.state[heat])).max() > 300.0  # [K], what ln T would give
    target.fixed[heat], target.values[heat] = True, np.log(500.0)
    np.testing.assert_allclose(transfer(here.state, here.problem, target)[heat], np.log(500.0))


@pytest.mark.parametrize("power", [1.5, 2.0])
def test_order_and_error_of_a_known_sequence(pipe, solution, power):
    # Fields T + c h^p on three meshes: the estimate must be the safety factor times the error c h^p.
    ratio, scale = 1.5, 40.0
    known, *coarser = (
        solution(pipe(n), level(3000.0 + scale * ratio ** (power * k))) for k, n in enumerate((9, 6, 4))
    )
    error, order = mesh_error(known, coarser, ratio)
    assert order == pytest.approx(power, rel=1e-3)
    np.testing.assert_allclose(error, SAFETY * scale, rtol=1e-3)


def test_a_wild_order_is_not_believed(pipe, solution):
    ratio = 1.5
    known, *coarser = (
        solution(pipe(n), level(t)) for n, t in zip((6, 5, 4), (3000.0, 3001.0, 3100.0), strict=True)
    )
    error, order = mesh_error(known, coarser, ratio)
    assert order > 10
    assert error.max() == pytest.approx(SAFETY * 100.0 / (ratio**6 - 1), rel=1e-3)


def test_two_meshes_give_a_cautious_error(pipe, solution):
    ratio = 1.5
    known, middle = (solution(pipe(n), level(t)) for n, t in ((6, 3000.0), (4, 3010.0)))
    error, order = mesh_error(known, [middle], ratio)
    assert np.isnan(order)
    np.testing.assert_allclose(error, SAFETY_OF_TWO * 10.0 / (ratio**2 - 1), rtol=1e-3)
