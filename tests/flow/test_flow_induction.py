"""Induction equation against elliptic integrals and the Bessel solution of a cylinder."""

from functools import partial

import numpy as np
import pytest
from scipy.special import ellipe, ellipk, jv
from skfem import MeshTri

from plasmapyro.constants import VACUUM_PERMEABILITY
from plasmapyro.flow.induction import Induction, ring_potential

ELLIPTIC_RTOL = 1e-10  # the textbook form cancels, the code's does not
RADIUS, COIL, SHIELD = 0.08, 0.109, 0.6
FREQUENCY, CONDUCTIVITY = 4e5, 2000.0
HALF_COIL, RINGS = 2.0, 801  # [m]; ends contribute (a/L)^2 / 2 = 1.5e-3 of the field


def test_ring_potential_is_the_one_of_the_elliptic_integrals():
    z, r = np.meshgrid(np.linspace(-0.3, 0.5, 17), np.linspace(0.02, 0.3, 23))
    q = (COIL + r) ** 2 + (z - 0.1) ** 2
    m = 4 * COIL * r / q
    expected = (
        VACUUM_PERMEABILITY / (np.pi * np.sqrt(m)) * np.sqrt(COIL / r) * ((1 - m / 2) * ellipk(m) - ellipe(m))
    )
    np.testing.assert_allclose(ring_potential(r, z, COIL, (0.1,)), expected, rtol=ELLIPTIC_RTOL)


def test_ring_potential_gives_the_axial_field_on_the_axis():
    z, r = np.linspace(-0.2, 0.2, 9), 1e-7
    field = VACUUM_PERMEABILITY * COIL**2 / (2 * (COIL**2 + z**2) ** 1.5)
    np.testing.assert_allclose(ring_potential(np.full(9, r), z, COIL, (0.0,)), field * r / 2, rtol=1e-9)


def test_ring_potentials_add():
    args = np.array([0.05]), np.array([0.2]), COIL
    both = ring_potential(*args, (0.1, 0.3))
    apart = ring_potential(*args, (0.1,)) + ring_potential(*args, (0.3,))
    np.testing.assert_allclose(both, apart, rtol=1e-14, atol=0)


def cylinder(cells):
    """Slab of an infinite plasma cylinder: z in [-5, 5] mm without end conditions, shield at r = 0.6 m."""
    r = np.concatenate([np.linspace(0, RADIUS, cells + 1), np.geomspace(RADIUS, SHIELD, 2 * cells + 1)[1:]])
    mesh = MeshTri.init_tensor(np.linspace(-0.005, 0.005, 3), r)
    inside = mesh.p[1, mesh.t].mean(axis=0) < RADIUS
    return mesh.with_subdomains({"flow": np.flatnonzero(inside)}).with_boundaries(
        {"axis": lambda x: x[1] < 1e-9, "far": lambda x: x[1] > SHIELD - 1e-9}
    )


def bessel(r):
    """E [V/m] per ampere in the cylinder, coil field B0 r/2 (infinite solenoid), E_p = 0 on the shield.

    Inside E = a J1(k r), outside E = -i w B0 r / 2 + c (1/r - r/b^2); E and (r E)'/r are continuous.
    """
    omega = 2 * np.pi * FREQUENCY
    drive = VACUUM_PERMEABILITY * RINGS / (2 * HALF_COIL)
    k = np.sqrt(-1j * omega * VACUUM_PERMEABILITY * CONDUCTIVITY)
    matrix = np.array(
        [[jv(1, k * RADIUS), -(1 / RADIUS - RADIUS / SHIELD**2)], [k * jv(0, k * RADIUS), 2 / SHIELD**2]]
    )
    a, _ = np.linalg.solve(matrix, [-1j * omega * drive * RADIUS / 2, -1j * omega * drive])
    return a * jv(1, k * r)


@pytest.fixture(scope="module")
def solved():
    mesh = cylinder(24)
    rings = partial(
        ring_potential, ring_radius=COIL, ring_positions=np.linspace(-HALF_COIL, HALF_COIL, RINGS)
    )
    induction = Induction(mesh, FREQUENCY, rings)
    r = induction.plasma.r
    return r, induction.solve(np.full(r.shape, CONDUCTIVITY)), induction


def test_field_in_a_cylinder_is_the_bessel_solution(solved):
    r, coupling, _ = solved
    expected = bessel(r)
    # 3e-3: finite solenoid 1.5e-3, P2 cells of 3.3 mm 2e-4.
    assert np.abs(coupling.electric_field - expected).max() < 3e-3 * np.abs(expected).max()


def test_field_of_a_uniform_drive_is_the_bessel_solution():
    # The same drive without end effects, A_c = B0 r / 2, and finer cells: only the discretisation is left.
    drive = VACUUM_PERMEABILITY * RINGS / (2 * HALF_COIL)
    mesh = cylinder(40)
    induction = Induction(mesh, FREQUENCY, lambda r, z: drive * r / 2)
    r = induction.plasma.r
    coupling = induction.solve(np.full(r.shape, CONDUCTIVITY))
    expected = bessel(r)
    assert np.abs(coupling.electric_field - expected).max() < 1e-4 * np.abs(expected).max()
    density = 0.5 * CONDUCTIVITY * np.abs(expected) ** 2
    assert coupling.power == pytest.approx((density * induction.plasma.weight).sum(), rel=1e-5)


def test_field_converges_at_third_order():
    drive = VACUUM_PERMEABILITY * RINGS / (2 * HALF_COIL)

    def error(cells):
        induction = Induction(cylinder(cells), FREQUENCY, lambda r, z: drive * r / 2)
        r = induction.plasma.r
        return np.abs(induction.solve(np.full(r.shape, CONDUCTIVITY)).electric_field - bessel(r)).max()

    order = np.log2(error(12) / error(24))
    assert 2.7 < order < 3.5


def test_joule_power_is_that_of_the_bessel_solution(solved):
    _, coupling, _ = solved
    r = np.linspace(0, RADIUS, 4001)
    density = 0.5 * CONDUCTIVITY * np.abs(bessel(r)) ** 2
    expected = 0.01 * 2 * np.pi * np.trapezoid(density * r, r)
    assert coupling.power == pytest.approx(expected, rel=6e-3)  # twice the field error


def test_the_plasma_is_pinched_and_feels_no_axial_force(solved):
    r, coupling, induction = solved
    # Magnetic pressure: the radial force integrates to (|B(0)|^2 - |B(R)|^2) / (4 mu0) per unit area.
    k = np.sqrt(-2j * np.pi * FREQUENCY * VACUUM_PERMEABILITY * CONDUCTIVITY)
    amplitude = bessel(np.array([RADIUS]))[0] / jv(1, k * RADIUS)
    field = np.abs(k * amplitude * np.array([1.0, jv(0, k * RADIUS)]) / (2 * np.pi * FREQUENCY)) ** 2
    # Integral over r of a slab of 10 mm by the quadrature of the mesh.
    total = (coupling.force_radial * induction.plasma.weight / (2 * np.pi * r)).sum() / 0.01
    assert total == pytest.approx((field[0] - field[1]) / (4 * VACUUM_PERMEABILITY), rel=1e-2)
    assert np.abs(coupling.force_axial).max() < 0.02 * np.abs(coupling.force_radial).max()


def test_field_at_nodes_matches_the_quadrature_points(solved):
    _, coupling, induction = solved
    r = np.array([0.0, RADIUS / 2, RADIUS])
    at_nodes = induction.field_at(np.zeros(3), r, coupling.scattered)
    np.testing.assert_allclose(at_nodes, bessel(r), atol=3e-3 * np.abs(bessel(r)).max())


def test_without_conductivity_nothing_is_heated(solved):
    r, _, induction = solved
    assert induction.solve(np.zeros(r.shape)).power == 0.0


def test_tangent_is_the_derivative_of_the_fields(solved):
    r, coupling, induction = solved
    shape = np.cos(30 * r) * CONDUCTIVITY
    step = 1e-4
    up, down = (induction.solve(CONDUCTIVITY + sign * step * shape) for sign in (1, -1))
    tangent = coupling.tangent(shape)
    # The axial force is 6e-4 of the radial one in a long cylinder.
    scales = [np.abs(field).max() for field in (coupling.joule_heating, *2 * (coupling.force_radial,))]
    names = ("joule_heating", "force_axial", "force_radial")
    for found, name, scale in zip(tangent, names, scales, strict=True):
        difference = (getattr(up, name) - getattr(down, name)) / (2 * step)
        # 1e-5: factors in single precision; the difference is good to 1e-6.
        np.testing.assert_allclose(found, difference, rtol=0, atol=1e-5 * scale)


def test_another_frequency_is_another_skin_depth(solved):
    r, _, induction = solved
    moved = induction.at_frequency(4 * FREQUENCY).solve(np.full(r.shape, CONDUCTIVITY))
    fresh = Induction(cylinder(24), 4 * FREQUENCY, induction._coil_potential)
    np.testing.assert_array_equal(
        moved.electric_field, fresh.solve(np.full(r.shape, CONDUCTIVITY)).electric_field
    )
