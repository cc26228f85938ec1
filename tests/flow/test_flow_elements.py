"""Assembly and equations against solutions known in closed form."""

import numpy as np
import pytest

from plasmapyro.flow.conduction import Conduction
from plasmapyro.flow.elements import Space
from plasmapyro.flow.geometry import Torch
from plasmapyro.flow.gradient import derivatives, gradient
from plasmapyro.flow.linear import Factorised
from plasmapyro.flow.physics import ROW_SCALE, Points, densities, property_lines
from plasmapyro.flow.properties import gas_properties

LENGTH, RADIUS = 0.3, 0.1
FLOAT_RTOL = 1e-11  # sums of 1e4 terms


def by_complex_step(function, inputs):
    """Derivatives (E, Q, outputs, inputs): f(x + i d) = f(x) + i d f'(x), d = 1e-30 leaves no truncation."""
    stepped = ([one + 1e-30j * (k == index) for k, one in enumerate(inputs)] for index in range(len(inputs)))
    return np.stack([np.stack(np.imag(function(one)), axis=-1) / 1e-30 for one in stepped], axis=-1)


def points(space, **changes):
    """Steady data without sources on all cells."""
    zero = np.zeros_like(space.cells.r)
    names = [name for name in Points.__dataclass_fields__ if name != "equal_order"]
    return Points(
        **{**dict.fromkeys(names, zero), "radius": space.cells.r, "element_size": zero + 0.01, **changes},
        equal_order=0.0,
    )


def test_mixing_is_prandtls_stress_and_carries_heat(air):
    length, shear, slope = 0.004, 3e3, -2e5  # [m], [s-1], [K m-1]
    gas = gas_properties(air, 5e3, 350.0)
    zero = np.zeros((1, 1))
    names = [name for name in Points.__dataclass_fields__ if name != "equal_order"]
    data = {**dict.fromkeys(names, zero), "radius": zero + 0.05, "element_size": zero + 0.01}
    inputs = [zero] * 12
    inputs[2], inputs[6], inputs[8] = zero + shear / 100, zero + np.log(6000.0), zero + slope / 6000.0
    lines = property_lines(gas, zero + 6000.0)
    still, mixed = (
        np.stack(densities(inputs, lines, Points(**data | {"mixing_length": zero + one}, equal_order=0.0)))
        for one in (0.0, length)
    )
    eddy = gas.density(6000.0)[0] * length**2 * shear
    added = ((mixed - still)[:, 0, 0] / ROW_SCALE)[[2, 8]]
    # 1e-6: the least shear that keeps the root smooth, 1 s-2
    assert added == pytest.approx([eddy * shear, eddy * gas.heat_capacity(6000.0)[0] / 0.7 * slope], rel=1e-6)


def test_clearance_is_the_distance_from_the_nearest_wall(torch_lengths):
    torch = Torch(**torch_lengths)
    z = np.array([0.01, 0.2, 0.486, 0.486 + 0.03, torch.nose - 0.02])
    r = np.array([0.0, 0.07, 0.0, 0.08, 0.0])
    assert torch.wall_clearance(z, r) == pytest.approx([0.01, 0.01, 0.08, 0.03, 0.02], rel=1e-9)


def test_weights_sum_to_the_volume_of_the_pipe(pipe):
    space = Space(pipe(4), (2,))
    assert space.cells.weight.sum() == pytest.approx(np.pi * RADIUS**2 * LENGTH, rel=FLOAT_RTOL)
    wall = space.facets(("tube_wall",))
    assert wall.weight.sum() == pytest.approx(2 * np.pi * RADIUS * LENGTH, rel=FLOAT_RTOL)
    np.testing.assert_allclose(wall.normal[1], 1.0)


def test_jacobian_of_a_linear_form_is_its_residual_per_unit(pipe):
    # (v, u_z) + (dv/dr, u): an unsymmetric form, so that a swap of test and trial function shows.
    space = Space(pipe(3), (2, 1))
    cells = space.cells
    state = np.sin(np.arange(space.size))
    inputs = space.inputs(cells, state)
    form = np.zeros((*cells.r.shape, 6, 6))
    form[..., 0, 1] = 1.0
    form[..., 2, 3] = 2.0
    rows = np.zeros_like(inputs)
    rows[0], rows[2] = inputs[1], 2 * inputs[3]
    matrix = space.matrix(space.gathered(cells, space.element_matrices(cells, form)))
    np.testing.assert_allclose(matrix @ state, space.residual(cells, rows), atol=1e-15, rtol=1e-10)


def test_conduction_with_a_source_gives_the_parabola(pipe):
    # -(1/r) d/dr (r kappa dT/dr) = q,  T = q (R^2 - r^2) / (4 kappa): inside the P2 space, so exact.
    space = Space(pipe(3), (2,))
    cells, kappa, source = space.cells, 3.0, 600.0
    form = np.zeros((*cells.r.shape, 3, 3))
    form[..., 1, 1] = form[..., 2, 2] = kappa
    load = np.zeros((3, *cells.r.shape))
    load[0] = source
    free = np.setdiff1d(np.arange(space.size), space.boundary_dofs(0, ("tube_wall",)))
    matrix = space.matrix(space.gathered(cells, space.element_matrices(cells, form)))[free][:, free]
    solution = np.zeros(space.size)
    solution[free] = Factorised(free).solve(matrix.tocsr(), space.residual(cells, load)[free])
    r = space.points(0)[1]
    np.testing.assert_allclose(solution, source * (RADIUS**2 - r**2) / (4 * kappa), atol=1e-12)


def test_poiseuille_flow_has_no_residual(pipe, constant_gas):
    # u = U (1 - r^2/R^2), dp/dz = -4 mu U / R^2: inside the Taylor-Hood space, so exact at inner dofs.
    space = Space(pipe(4), (2, 2, 2, 1))
    properties = gas_properties(constant_gas, 1e3, 350.0)
    top_speed, viscosity = 0.7, 0.5
    z, r = space.points(0)
    state = np.zeros(space.size)
    state[space.field(0)] = top_speed * (1 - (r / RADIUS) ** 2) / 100
    state[space.field(2)] = np.log(5000.0)
    gradient = -4 * viscosity * top_speed / RADIUS**2
    state[space.field(3)] = gradient * (space.points(3)[0] - LENGTH) / 100
    inputs = space.inputs(space.cells, state)
    lines = property_lines(properties, np.exp(inputs[6]))
    residual = space.residual(space.cells, np.stack(densities(inputs, lines, points(space))))
    for field, rows in ((0, ("tube_wall", "inlet", "outlet")), (1, ("axis", "tube_wall", "inlet", "outlet"))):
        inner = np.setdiff1d(np.arange(len(z)), space.boundary_dofs(field, rows))
        assert np.abs(residual[space.field(field)][inner]).max() < 1e-12
    assert np.abs(residual[space.field(2)]).max() < 1e-12
    assert np.abs(residual[space.field(3)]).max() < 1e-12
    # The wall holds the gas back with 2 pi R L mu |du/dr|.
    wall = residual[space.field(0)][space.boundary_dofs(0, ("tube_wall",))].sum() / ROW_SCALE[0]
    inlet_and_outlet = np.pi * RADIUS**2 * gradient * LENGTH
    whole = residual[space.field(0)].sum() / ROW_SCALE[0]
    assert whole == pytest.approx(inlet_and_outlet - np.pi * RADIUS**2 * gradient * LENGTH, abs=1e-10)
    assert wall < 0


def test_densities_of_a_linear_velocity_field(pipe, constant_gas):
    # u_z = a z, u_r = b r, T uniform: strain rates a, b, b, divergence a + 2 b, by hand.
    space = Space(pipe(2), (2, 2, 2, 1))
    a, b, temperature, gauge = 10.0, 3.0, 2000.0, 40.0
    density, viscosity, heating, force_z, force_r = 2.0, 0.5, 5e3, 70.0, -90.0
    z, r = space.points(0)
    state = np.zeros(space.size)
    state[space.field(0)], state[space.field(1)] = a * z / 100, b * r / 100
    state[space.field(2)], state[space.field(3)] = np.log(temperature), gauge / 100
    zero = np.zeros_like(space.cells.r)
    data = points(
        space,
        element_size=zero + 1e-9,  # no stabilisation left
        joule_heating=zero + heating,
        force_axial=zero + force_z,
        force_radial=zero + force_r,
    )
    inputs = space.inputs(space.cells, state)
    lines = property_lines(gas_properties(constant_gas, 1e3, 350.0), np.exp(inputs[6]))
    rows = np.stack(densities(inputs, lines, data)) / ROW_SCALE[:, None, None]
    divergence, radius = a + 2 * b, space.cells.r
    stress_zz = 2 * viscosity * (a - divergence / 3)
    stress_rr = 2 * viscosity * (b - divergence / 3)
    expected = {
        0: density * a * a * space.cells.z - force_z,
        1: stress_zz - gauge,
        2: 0.0,
        3: density * b * b * radius - force_r + (stress_rr - gauge) / radius,
        4: 0.0,
        5: stress_rr - gauge,
        6: -heating + density * 1000.0 * (temperature - 350.0) * divergence,
        7: 0.0,
        8: 0.0,
        9: density * divergence,
    }
    for row, value in expected.items():
        np.testing.assert_allclose(rows[row], value + zero, rtol=1e-6, atol=1e-5, err_msg=str(row))


def test_the_limiter_adds_nothing_below_its_threshold_and_the_whole_excess_far_above(pipe, constant_gas):
    # Added viscosity from the shear stress tau_zr = (mu + added) du_z/dr of the flow u_z = u0 + s r.
    space = Space(pipe(2), (2, 2, 2, 1))
    density, viscosity, size, shear = 2.0, 0.5, 1e-9, 1e-3
    lines = property_lines(gas_properties(constant_gas, 1e3, 350.0), np.full_like(space.cells.r, 2000.0))
    zero = np.zeros_like(space.cells.r)

    def added(excess):
        """Added viscosity over mu, and added conductivity over mu c_p, at C rho |u| h / mu - 1 = excess."""
        speed = 100.0
        limiter = (1 + excess) * viscosity / (density * speed * size)
        inputs = [zero] * 12
        inputs[0], inputs[2], inputs[6] = zero + speed / 100, zero + shear / 100, zero + np.log(2000.0)
        inputs[8] = zero + 1.0
        data = points(space, element_size=zero + size, viscosity_limiter=zero + limiter)
        rows = np.stack(densities(inputs, lines, data)) / ROW_SCALE[:, None, None]
        momentum = rows[2] / shear / viscosity - 1
        heat = rows[8] / 2000.0 / viscosity / 1000.0
        np.testing.assert_allclose(heat, momentum, rtol=1e-6, atol=1e-12)
        return float(momentum.mean())

    # SMALL_SPEED adds 5e-7 to the speed of 100 m/s; 1e-12: round-off of the conductivity.
    for below in (-1.0, -0.9, -0.5, -0.1, -1e-3):
        assert added(below) == pytest.approx(0.0, abs=1e-12)
    for above in (300.0, 3000.0):
        assert added(above) == pytest.approx(above, rel=2e-3)  # 0.3 / 300 left at the first
    # No kink: twice the excess adds four times as much just above the threshold.
    assert added(2e-3) / added(1e-3) == pytest.approx(4.0, rel=1e-2)


def test_heating_expands_the_gas(pipe, air):
    # R_c = div u + (rho'/rho) D T with u = 0: heated gas must flow out, D T = (T - T_old) / dt.
    space = Space(pipe(2), (2, 2, 2, 1))
    state = np.zeros(space.size)
    state[space.field(2)] = np.log(6000.0)
    zero = np.zeros_like(space.cells.r)
    data = points(space, inverse_step=zero + 1e3, old_temperature=zero + 5990.0)
    properties = gas_properties(air, 5e3, 350.0)
    inputs = space.inputs(space.cells, state)
    mass = densities(inputs, property_lines(properties, np.exp(inputs[6])), data)[9] / ROW_SCALE[9]
    table = air.density.sel(pressure=5e3)
    slope = float(table.sel(temperature=6050.0) - table.sel(temperature=5950.0)) / 100
    np.testing.assert_allclose(mass, slope * 10.0 * 1e3 + zero, rtol=0.01)  # slope over 100 K


def conducted(space, properties, heating, temperature):
    """Heat [W] at the nodes of a gas at rest, and what conduction leaves of it."""
    state = np.zeros(space.size)
    state[space.field(2)] = np.log(temperature)
    data = points(space, joule_heating=np.full_like(space.cells.r, heating))
    inputs = space.inputs(space.cells, state)
    rows = densities(inputs, property_lines(properties, np.exp(inputs[6])), data)
    heated = space.residual(space.cells, np.stack(rows))[space.field(2)]
    left = heated + Conduction(space).residual(state, properties)[space.field(2)]
    return heated, left


@pytest.fixture(scope="module")
def heated_pipe(pipe_mesh, air):
    """Space, gas, heating [W m-3] and exact temperature [K] at the nodes of a pipe heated uniformly.

    With walls at T_w, int_{T_w}^{T} kappa dT = q (R^2 - r^2) / 4 for any kappa(T); 5 MW/m3 make 9000 K of
    it, through both dissociation peaks, on four cells.
    """
    space, heating, wall = Space(pipe_mesh(4), (2, 2, 2, 1)), 5e6, 1000.0
    properties = gas_properties(air, 5e3, 350.0)
    grid = np.linspace(wall, 12000.0, 40001)
    conductivity = properties.thermal_conductivity(grid)[0]
    potential = np.concatenate([[0.0], np.cumsum((conductivity[1:] + conductivity[:-1]) / 2 * np.diff(grid))])
    temperature = np.interp(heating * (RADIUS**2 - space.points(2)[1] ** 2) / 4, potential, grid)
    assert temperature.max() > 10000.0
    return space, properties, heating, temperature


def test_conduction_is_exact_at_the_nodes_however_the_conductivity_varies(heated_pipe):
    space, properties, heating, temperature = heated_pipe
    heated, left = conducted(space, properties, heating, temperature)
    inside = np.setdiff1d(np.arange(len(left)), space.boundary_dofs(2, ("tube_wall",)))
    # 1e-5: trapezoids of 0.3 K in the exact temperature.
    assert np.abs(left[inside]).max() < 1e-5 * np.abs(heated).max()


def test_an_adiabatic_end_is_the_natural_condition(pipe_mesh, air):
    """Rod heated evenly, insulated at z = 0 and round about, cold at z = L: S(T) = q (L^2 - z^2) / 2.

    Carslaw and Jaeger, Conduction of Heat in Solids, 3.14, for any kappa(T) in the heat-flux potential S.
    """
    space, heating, wall = Space(pipe_mesh(4), (2, 2, 2, 1)), 3e5, 1000.0
    properties = gas_properties(air, 5e3, 350.0)
    z = space.points(2)[0]
    rise = heating * (LENGTH**2 - z**2) / 2
    temperature = properties.temperature_of(properties.heat_flux_potential(np.array(wall))[0] + rise)
    assert temperature.max() > 8000.0
    heated, left = conducted(space, properties, heating, temperature)
    cold = np.abs(z - LENGTH) < 1e-9
    assert np.abs(left[~cold]).max() < 1e-8 * np.abs(heated).max()  # walls that are not held among them
    # The cold end takes what is deposited.
    assert left[cold].sum() == pytest.approx(heated.sum(), rel=1e-8)


def test_the_slope_of_conduction_is_its_derivative(heated_pipe):
    space, properties, _, temperature = heated_pipe
    state, change = np.zeros(space.size), np.zeros(space.size)
    state[space.field(2)] = np.log(temperature)
    change[space.field(2)] = np.cos(np.arange(len(temperature)))
    conduction, own = Conduction(space), Conduction(space).columns
    matrices = np.zeros((len(space.cells.dofs), *2 * (space.cells.dofs.shape[1],)))
    matrices[:, own, own] = conduction.element_matrices(state, properties, slice(None))
    exact = space.matrix(space.gathered(space.cells, matrices)) @ change
    step = 1e-6
    up, down = (conduction.residual(state + sign * step * change, properties) for sign in (1, -1))
    np.testing.assert_allclose((up - down) / (2 * step), exact, rtol=1e-5, atol=1e-7 * np.abs(exact).max())


def test_slopes_are_those_of_a_complex_step_and_of_finite_differences(pipe, air):
    space = Space(pipe(2), (2, 2, 2, 1))
    properties = gas_properties(air, 5e3, 350.0)
    wave = np.cos(np.arange(space.cells.r.size)).reshape(space.cells.r.shape)
    data = points(
        space,
        inverse_step=300.0 + 0 * wave,
        old_axial=20 * wave,
        old_radial=5 + wave,
        old_temperature=6000 + 100 * wave,
        joule_heating=1e7 + 1e6 * wave,
        force_axial=30 * wave,
        force_radial=-400 + wave,
        viscosity_limiter=0.5 + 0.1 * wave,
    )
    random = np.random.default_rng(7)
    scale = np.array([1, 30, 30, 1, 30, 30, 0.1, 5, 5, 1, 50, 50.0])
    base = np.array([1, 0, 0, 0.3, 0, 0, np.log(6500.0), 0, 0, 0, 0, 0])
    inputs = [b + s * random.uniform(-1, 1, wave.shape) for b, s in zip(base, scale, strict=True)]

    def evaluate(values):
        return np.stack(densities(values, property_lines(properties, np.exp(np.real(values[6]))), data), -1)

    lines = property_lines(properties, np.exp(inputs[6]))
    exact = by_complex_step(lambda x: densities(x, lines, data), inputs)
    found = derivatives(lambda x: densities(x, lines, data), inputs)
    np.testing.assert_allclose(found, exact, rtol=1e-10, atol=1e-12 * np.abs(exact).max())
    for index in range(12):
        step = 1e-6 * scale[index]
        up, down = list(inputs), list(inputs)
        up[index], down[index] = inputs[index] + step, inputs[index] - step
        difference = (evaluate(up) - evaluate(down)) / (2 * step)
        size = np.abs(difference).max(axis=(0, 1)) + 1e-12
        # 1e-5: second derivative of the Hermite tables times the step, and cancellation.
        assert (np.abs(exact[..., index] - difference) / size).max() < 1e-5


@pytest.mark.parametrize("orders", [(2, 2, 2, 1), (1, 1, 1, 1)])
def test_matrices_of_cells_are_those_of_any_patch(pipe, air, orders):
    # The same sums in the axes z and r, which every patch is summed in, on a part of skewed triangles.
    even = pipe(6)
    z, r = even.p
    mesh = type(even)(np.stack([z + 0.4 * r, r + 0.1 * z + 0.3 * z * r]), even.t)
    space, part = Space(mesh, orders), slice(5, 40)
    rng, size = np.random.default_rng(11), space.cells.r.shape
    data = points(
        space,
        inverse_step=np.full(size, 300.0),
        joule_heating=rng.uniform(0, 1e7, size),
        force_radial=rng.uniform(-400, 0, size),
        viscosity_limiter=np.full(size, 0.5),
    )
    state = rng.uniform(-1, 1, space.size)
    state[space.field(2)] = np.log(rng.uniform(5000, 7000, len(state[space.field(2)])))
    inputs = list(space.inputs(space.cells, state))
    lines = property_lines(gas_properties(air, 5e3, 350.0), np.exp(inputs[6]))
    slopes = by_complex_step(lambda x: densities(x, lines, data), inputs)
    expected = space.element_matrices(space.cells, slopes)[part]
    some = [values[part].T for values in inputs]
    fewer = {name: tuple(values[part].T for values in line) for name, line in lines.items()}
    found = space.cell_matrices(
        part, lambda seeds: gradient(lambda x: densities(x, fewer, data.part(part)), some, seeds)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


def test_singular_matrix_is_refused(pipe):
    space = Space(pipe(2), (1,))
    with pytest.raises(ArithmeticError, match="matrix of 9 unknowns|factorisation"):
        Factorised(space.nodes()).solve(space.matrix(np.zeros(len(space.indices))), np.ones(space.size))
