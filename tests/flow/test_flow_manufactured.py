"""Manufactured solutions: the order at which each discrete equation converges.

A smooth flow is prescribed; the forces and the heating that sustain it follow from the differential
equations, differentiated numerically from the prescribed fields and not from the code's weak forms.
"""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.flow.conduction import Conduction
from plasmapyro.flow.elements import Space
from plasmapyro.flow.gradient import derivatives
from plasmapyro.flow.linear import Factorised
from plasmapyro.flow.physics import Points, densities, property_lines
from plasmapyro.flow.properties import gas_properties
from plasmapyro.flow.swirl import Swirl

LENGTH, RADIUS = 0.3, 0.1
STEP = 1e-3  # [m] of sixth-order differences: truncation below 1e-9 of the fields
FINE, COARSE = 20, 10
AXIAL, RADIAL, HEAT, GAUGE = range(4)
# Taylor-Hood elements carry third order in u and T. The upwind terms leave out the second derivatives of the
# residual, which costs one order: 2 is expected for all fields, and approached from below.
LEAST_ORDER = {AXIAL: 1.8, RADIAL: 1.8, HEAT: 1.7, GAUGE: 1.7}


def density(temperature):
    return 700.0 / temperature


def viscosity(temperature):
    return 0.05 * (temperature / 2000.0) ** 0.7


def conductivity(temperature):
    return 60.0 * (temperature / 2000.0) ** 0.5


def heat_capacity(temperature):
    return 1000.0 + 0.1 * temperature


@pytest.fixture(scope="module")
def gas():
    """A table of the properties above; pressure does not matter."""
    temperature = np.linspace(200.0, 15000.0, 593)
    rows = {
        "density": density(temperature),
        "enthalpy": 1000.0 * temperature + 0.05 * temperature**2,
        "viscosity": viscosity(temperature),
        "thermal_conductivity": conductivity(temperature),
        "electrical_conductivity": np.full_like(temperature, 700.0),
    }
    table = xr.Dataset(
        {name: (("pressure", "temperature"), np.stack([row, row])) for name, row in rows.items()},
        coords={"pressure": [1e3, 4e3], "temperature": temperature},
    )
    return gas_properties(table, 1e3, 350.0)


def along(function, axis):
    """Derivative of a function of (z, r) along an axis, sixth order."""

    def derivative(z, r):
        total = 0.0
        for distance, weight in ((1, 45), (2, -9), (3, 1)):
            up = (z + distance * STEP, r) if axis == 0 else (z, r + distance * STEP)
            down = (z - distance * STEP, r) if axis == 0 else (z, r - distance * STEP)
            total = total + weight * (function(*up) - function(*down))
        return total / (60 * STEP)

    return derivative


def heat(z, r):
    return 2000.0 + 500.0 * np.cos(2 * np.pi * z / LENGTH) * np.cos(np.pi * r / RADIUS)


def stream(z, r):
    """Stream function over r^2: rho u_z = 2 g + r dg/dr, rho u_r = -r dg/dz, so that mass is conserved."""
    return 6.0 + 3.0 * np.sin(2 * np.pi * z / LENGTH) * np.cos(np.pi * r / RADIUS)


def axial(z, r):
    return (2 * stream(z, r) + r * along(stream, 1)(z, r)) / density(heat(z, r))


def radial(z, r):
    return -r * along(stream, 0)(z, r) / density(heat(z, r))


def gauge(z, r):
    return 300.0 * np.sin(np.pi * z / LENGTH) * (1 - (r / RADIUS) ** 2)


def stress(first, second):
    """A component of the stress tensor as a function of (z, r)."""

    def component(z, r):
        gradient = {
            "zz": along(axial, 0)(z, r),
            "zr": along(axial, 1)(z, r),
            "rz": along(radial, 0)(z, r),
            "rr": along(radial, 1)(z, r),
            "tt": radial(z, r) / r,
        }
        both = gradient[first + second] + gradient[second + first]
        bulk = gradient["zz"] + gradient["rr"] + gradient["tt"]
        return viscosity(heat(z, r)) * (both - 2 / 3 * bulk * (first == second))

    return component


def times_radius(function):
    return lambda z, r: r * function(z, r)


def convected(function, z, r):
    return axial(z, r) * along(function, 0)(z, r) + radial(z, r) * along(function, 1)(z, r)


def sources(z, r):
    """Force along z and r [N m-3] and heating [W m-3] that sustain the prescribed flow."""
    inertia = density(heat(z, r))
    divergence_z = along(stress("z", "z"), 0)(z, r) + along(times_radius(stress("z", "r")), 1)(z, r) / r
    divergence_r = along(stress("r", "z"), 0)(z, r) + along(times_radius(stress("r", "r")), 1)(z, r) / r
    divergence_r = divergence_r - stress("t", "t")(z, r) / r
    force_z = inertia * convected(axial, z, r) + along(gauge, 0)(z, r) - divergence_z
    force_r = inertia * convected(radial, z, r) + along(gauge, 1)(z, r) - divergence_r

    def flux(axis):
        return lambda z, r: conductivity(heat(z, r)) * along(heat, axis)(z, r)

    conducted = along(flux(0), 0)(z, r) + along(times_radius(flux(1)), 1)(z, r) / r
    heating = inertia * heat_capacity(heat(z, r)) * convected(heat, z, r) - conducted
    return force_z, force_r, heating


def cell_size(space):
    area = (space.cells.weight / (2 * np.pi * space.cells.r)).sum(axis=1)
    return np.repeat((np.sqrt(4 * area / np.sqrt(3)) / 2)[:, None], space.cells.z.shape[1], axis=1)


def errors_of_the_flow(mesh, gas):
    """Root mean square errors of u_z, u_r [m/s], ln T and p [Pa] after Newton's method."""
    space = Space(mesh, (2, 2, 2, 1))
    cells = space.cells
    force_z, force_r, heating = sources(cells.z, cells.r)
    zero = np.zeros_like(cells.r)
    names = [name for name in Points.__dataclass_fields__ if name != "equal_order"]
    data = Points(
        **{
            **dict.fromkeys(names, zero),
            "radius": cells.r,
            "element_size": cell_size(space),
            "force_axial": force_z,
            "force_radial": force_r,
            "joule_heating": heating,
        },
        equal_order=0.0,
    )
    exact = [lambda z, r: axial(z, r) / 100, lambda z, r: radial(z, r) / 100]
    exact += [lambda z, r: np.log(heat(z, r)), lambda z, r: gauge(z, r) / 100]
    state = np.concatenate([function(*space.points(field)) for field, function in enumerate(exact)])
    around = ("tube_wall", "inlet", "outlet")
    fixed = [space.boundary_dofs(AXIAL, around)]
    fixed += [space.offsets[RADIAL] + space.boundary_dofs(RADIAL, (*around, "axis"))]
    fixed += [space.offsets[HEAT] + space.boundary_dofs(HEAT, around), [space.offsets[GAUGE]]]
    free = np.setdiff1d(np.arange(space.size), np.concatenate(fixed))
    solver, conduction = Factorised(space.nodes()[free]), Conduction(space)
    for _ in range(12):
        inputs = space.inputs(cells, state)
        lines = property_lines(gas, np.exp(inputs[6]))
        residual = space.residual(cells, np.stack(densities(inputs, lines, data)))
        residual += conduction.residual(state, gas)
        slopes = derivatives(lambda x, lines=lines: densities(x, lines, data), list(inputs))
        matrices = space.element_matrices(cells, slopes)
        own = conduction.columns
        matrices[:, own, own] += conduction.element_matrices(state, gas, slice(None))
        matrix = space.matrix(space.gathered(cells, matrices))
        update = solver.solve(matrix[free][:, free].tocsr(), -residual[free])
        state[free] += update
        if np.abs(update).max() < 1e-9:
            break
    assert np.abs(update).max() < 1e-9
    found = space.inputs(cells, state)[::3]
    scale = (100.0, 100.0, 1.0, 100.0)
    wrong = [
        unit * (values - function(cells.z, cells.r))
        for unit, values, function in zip(scale, found, exact, strict=True)
    ]
    # Enclosed by prescribed velocities the pressure is known up to a constant.
    wrong[GAUGE] -= (cells.weight * wrong[GAUGE]).sum() / cells.weight.sum()
    return [np.sqrt((cells.weight * values**2).sum() / cells.weight.sum()) for values in wrong]


@pytest.fixture(scope="module")
def flow_errors(pipe_mesh, gas):
    return [errors_of_the_flow(pipe_mesh(n), gas) for n in (COARSE, FINE)]


@pytest.mark.parametrize("field", LEAST_ORDER)
def test_momentum_energy_and_mass_converge(flow_errors, field):
    coarse, fine = (errors[field] for errors in flow_errors)
    assert np.log(coarse / fine) / np.log(FINE / COARSE) > LEAST_ORDER[field]


def test_the_prescribed_flow_is_met(flow_errors):
    # Of some 35 m/s, 10 m/s, 1 and 300 Pa.
    for error, bar in zip(flow_errors[-1], (0.05, 0.03, 1e-3, 3.0), strict=True):
        assert error < bar


def turning(z, r):
    return 200.0 * r * (1 + 0.5 * np.sin(2 * np.pi * z / LENGTH)) * np.cos(np.pi * r / RADIUS)


def torque(z, r):
    """Azimuthal force that sustains `turning` in the prescribed flow [N m-3]."""

    def shear_r(z, r):
        return viscosity(heat(z, r)) * (along(turning, 1)(z, r) - turning(z, r) / r)

    def shear_z(z, r):
        return viscosity(heat(z, r)) * along(turning, 0)(z, r)

    inertia = density(heat(z, r)) * (convected(turning, z, r) + radial(z, r) * turning(z, r) / r)
    outward = along(lambda z, r: r * r * shear_r(z, r), 1)(z, r) / r**2
    return inertia - outward - along(shear_z, 0)(z, r)


def error_of_the_swirl(mesh):
    swirl = Swirl(with_inlets(mesh), 2, ())
    cells, points = swirl._space.cells, swirl._space.points(0)
    place = cells.z, cells.r
    temperature = heat(*place)
    _, found = swirl.solve(
        axial(*place),
        radial(*place),
        density(temperature),
        viscosity(temperature),
        cell_size(swirl._space),
        turning(*points),
        source=torque(*place),
    )
    return np.sqrt((cells.weight * (found - turning(*place)) ** 2).sum() / cells.weight.sum())


def with_inlets(mesh):
    """The same mesh with every end a place of prescribed swirl."""
    ends = np.concatenate([mesh.boundaries["inlet"], mesh.boundaries["outlet"]])
    return mesh.with_boundaries({**mesh.boundaries, "inlet": ends})


def test_swirl_converges(pipe_mesh):
    coarse, fine = (error_of_the_swirl(pipe_mesh(n)) for n in (COARSE, FINE))
    assert fine < 0.02  # of 10 m/s
    assert np.log(coarse / fine) / np.log(FINE / COARSE) > 1.8


def test_a_rigid_rotation_turns_on(pipe_mesh):
    # No strain: w = omega r in gas that moves along the axis only.
    mesh = pipe_mesh(4)
    rim = np.concatenate([mesh.boundaries[name] for name in ("tube_wall", "inlet", "outlet")])
    swirl = Swirl(mesh.with_boundaries({"inlet": rim, "axis": mesh.boundaries["axis"]}), 2, ())
    shape = swirl._space.cells.r.shape
    values = 30.0 * swirl._space.points(0)[1]
    found, _ = swirl.solve(
        np.full(shape, 7.0),
        np.zeros(shape),
        np.full(shape, 2.0),
        np.full(shape, 0.5),
        np.full(shape, 0.01),
        values,
    )
    np.testing.assert_allclose(found, values, atol=1e-12)
