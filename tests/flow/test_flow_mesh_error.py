"""The error estimate from three meshes, on functions whose interpolation error is known."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.flow.elements import Space
from plasmapyro.flow.mesh_error import SAFETY, SAFETY_OF_TWO, mesh_error, nodal_values
from plasmapyro.flow.physics import LOG_TEMPERATURE


def problem(mesh, order=2):
    return SimpleNamespace(mesh=mesh, space=Space(mesh, (order, order, order, 1)))


def state(case, temperature):
    found = np.zeros(case.space.size)
    found[case.space.field(LOG_TEMPERATURE)] = np.log(temperature(*case.space.points(LOG_TEMPERATURE)))
    return found


@pytest.mark.parametrize("order", [1, 2])
def test_a_polynomial_of_the_element_is_reproduced_anywhere(pipe, order):
    case = problem(pipe(5), order)
    rng = np.random.default_rng(4)
    points = np.stack([rng.uniform(0, 0.3, 200), rng.uniform(0, 0.1, 200)])

    def polynomial(z, r):
        return 7.0 + z - 2 * r + (order - 1) * (5 * z * r - 3 * z * z + r * r)

    values = np.zeros(case.space.size)
    values[case.space.field(LOG_TEMPERATURE)] = polynomial(*case.space.points(LOG_TEMPERATURE))
    found = nodal_values(case, values, LOG_TEMPERATURE, points)
    np.testing.assert_allclose(found, polynomial(*points), rtol=1e-12)


def test_a_point_just_outside_is_continued(pipe):
    case = problem(pipe(3))
    values = np.zeros(case.space.size)
    values[case.space.field(LOG_TEMPERATURE)] = case.space.points(LOG_TEMPERATURE)[1] ** 2
    found = nodal_values(case, values, LOG_TEMPERATURE, np.array([[0.1], [0.1001]]))
    assert found == pytest.approx(0.1001**2, rel=1e-9)


@pytest.mark.parametrize("power", [1.5, 2.0])
def test_order_and_error_of_a_known_sequence(pipe, power):
    # Fields T + c h^p on three meshes: the estimate must be the safety factor times the error c h^p.
    ratio, scale = 1.5, 40.0
    cases = [problem(pipe(n)) for n in (9, 6, 4)]
    states = [
        state(case, lambda z, r, k=k: 3000.0 + scale * ratio ** (power * k) + 0 * z)
        for k, case in enumerate(cases)
    ]
    error, order = mesh_error(cases[0], states[0], list(zip(cases[1:], states[1:], strict=True)), ratio)
    assert order == pytest.approx(power, rel=1e-9)
    np.testing.assert_allclose(error, SAFETY * scale, rtol=1e-9)


def test_a_wild_order_is_not_believed(pipe):
    ratio = 1.5
    cases = [problem(pipe(n)) for n in (6, 5, 4)]
    levels = (3000.0, 3001.0, 3100.0)
    states = [state(case, lambda z, r, t=level: t + 0 * z) for case, level in zip(cases, levels, strict=True)]
    error, order = mesh_error(cases[0], states[0], list(zip(cases[1:], states[1:], strict=True)), ratio)
    assert order > 10
    assert error.max() == pytest.approx(SAFETY * 100.0 / (ratio**6 - 1), rel=1e-9)


def test_two_meshes_give_a_cautious_error(pipe):
    ratio = 1.5
    cases = [problem(pipe(n)) for n in (6, 4)]
    states = [
        state(case, lambda z, r, t=level: t + 0 * z)
        for case, level in zip(cases, (3000.0, 3010.0), strict=True)
    ]
    error, order = mesh_error(cases[0], states[0], [(cases[1], states[1])], ratio)
    assert np.isnan(order)
    np.testing.assert_allclose(error, SAFETY_OF_TWO * 10.0 / (ratio**2 - 1), rtol=1e-9)
