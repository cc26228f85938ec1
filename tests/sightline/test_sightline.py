import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas.species import CHARGE, NITROGEN_ATOMS, OXYGEN_ATOMS, SPECIES
from plasmapyro.radiation.atoms import atomic_lines
from plasmapyro.radiation.path import gas_path
from plasmapyro.sightline.stage import chord, equilibrium_sightline, line_of_sight, on_line, surface_view

FLOAT_RTOL = 1e-12  # thousands of eps
NOSE, RADIUS, ANGLE = 0.871, 0.16, np.radians(35)
LEAVES = RADIUS / np.sin(ANGLE)  # the 278.9 mm of the paper
RULE = {
    "window_distance": 0.8,
    "instrument_distance": 1.0,
    "laboratory_temperature": 300.0,
    "laboratory_pressure": 101325.0,
}


def quadratic_mesh(columns, rows, length=NOSE, radius=RADIUS):
    """Right triangles on a rectangle, slightly sheared, with the nodes of P2 elements."""
    z, r = np.meshgrid(
        np.linspace(0, length, 2 * columns + 1), np.linspace(0, radius, 2 * rows + 1), indexing="ij"
    )
    number = np.arange(z.size).reshape(z.shape)
    corner, middle = [], []
    for i in range(0, 2 * columns, 2):
        for k in range(0, 2 * rows, 2):
            lower = [(i, k), (i + 2, k), (i, k + 2)]
            upper = [(i + 2, k + 2), (i, k + 2), (i + 2, k)]
            for triangle in (lower, upper):
                corner.append([number[node] for node in triangle])
                pairs = zip(triangle, triangle[1:] + triangle[:1], strict=True)
                middle.append([number[(a[0] + b[0]) // 2, (a[1] + b[1]) // 2] for a, b in pairs])
    return z.ravel(), r.ravel(), np.array(corner), np.array(middle)


def flow(temperature, pressure=lambda z, r: 5000 + 0 * z, columns=40, rows=12):
    z, r, corner, middle = quadratic_mesh(columns, rows)
    return xr.Dataset(
        {
            "node_z": ("node", z),
            "node_r": ("node", r),
            "face_node": (("face", "corner"), corner),
            "face_midnode": (("face", "corner"), middle),
            "temperature": ("node", temperature(z, r)),
            "pressure": ("node", pressure(z, r)),
        },
        attrs={"stagnation_point_z": NOSE},
    )


def parabola(z, r):
    """Every monomial up to degree two, none with the weight of another."""
    return 900 + 400 * z + 5000 * r + 700 * z**2 - 3000 * z * r - 9000 * r**2


def position(distance, nose=NOSE, angle=ANGLE):
    return nose - distance * np.cos(angle), distance * np.sin(angle)


def jet(z, r):
    return 350 + 5500 * (1 - np.exp(-(NOSE - z) / 0.004)) / (1 + (r / 0.06) ** 8)


def test_quadratic_fields_are_sampled_exactly():
    path = chord(flow(parabola, lambda z, r: parabola(z, r) + 4000), angle=ANGLE, points=57)
    z, r = position(path.path_distance.values)
    assert path.temperature.values == pytest.approx(parabola(z, r), rel=FLOAT_RTOL)
    assert path.pressure.values == pytest.approx(parabola(z, r) + 4000, rel=FLOAT_RTOL)
    assert path.axial_position.values == pytest.approx(z, rel=FLOAT_RTOL)
    assert path.radial_position.values == pytest.approx(r, abs=1e-15)


def test_the_gas_of_the_flow_fills_the_chamber_and_air_the_laboratory():
    field = flow(jet).assign_attrs(gas="N2")
    path = line_of_sight(field, angle=ANGLE, points=60, **RULE)
    oxygen = path.number_density.sel(species=["O2", "NO", "O", "O2+", "NO+", "O+"]).sum("species")
    inside = path.path_distance <= RULE["window_distance"]
    assert not oxygen.where(inside, 0).any()
    assert (oxygen.where(~inside, 1) > 0).all()
    particles = path.pressure / (BOLTZMANN * path.temperature)
    assert path.number_density.sum("species").values == pytest.approx(particles.values, rel=FLOAT_RTOL)


def test_argon_of_the_flow_is_on_the_path_and_shines():
    field = flow(jet).assign_attrs(gas="air Ar:0.0093")
    line = line_of_sight(field, angle=ANGLE, points=60, **RULE)
    hottest = int(np.argmax(line.temperature.values))
    hot = line.isel(path_distance=hottest)
    argon = float(hot.number_density.sel(species="Ar"))
    atoms = hot.number_density.sel(species=list(SPECIES)).values @ (NITROGEN_ATOMS + OXYGEN_ATOMS)
    assert argon / (argon + atoms / 2) == pytest.approx(0.0093, rel=0.02)  # but for the ions
    density = {str(name): line.number_density.sel(species=name).values for name in line.species.values}
    path = gas_path(line.path_distance.values, line.temperature.values, density)
    lines = atomic_lines("Ar I")
    strongest = int(np.argmin(abs(1 / lines.wavenumber - 811.7542e-9)))
    light = path.emission(lines, hottest)[strongest]
    # By hand: g = 7, E = 105462.76 cm-1, A = 3.31e7 s-1, partition function 1.
    upper = argon * 7 * np.exp(-1.438777 * 105462.76 / float(hot.temperature))
    assert light == pytest.approx(upper * 3.31e7 * 1.986446e-25 / 811.7542e-9 / (4 * np.pi), rel=1e-3)


def test_cubic_fields_converge_with_the_third_power_of_the_cell():
    def cubic(z, r):
        return 2000 + 3e5 * r**3 - 900 * z**3

    errors = []
    for columns in (10, 20, 40):
        path = chord(flow(cubic, columns=columns, rows=columns // 5), angle=ANGLE, points=200)
        z, r = position(path.path_distance.values)
        errors.append(np.abs(path.temperature.values - cubic(z, r)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(3, abs=0.5)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(3, abs=0.5)


def exit_distance(columns, rows, angle=ANGLE, hole=None):
    """Where a path ends in a uniform field without the cells whose middles (z, r) are in a hole."""
    field = flow(lambda z, r: 4000 + 0 * z, columns=columns, rows=rows)
    if hole is not None:
        corner = field.face_node.values
        inside = hole(field.node_z.values[corner].mean(axis=1), field.node_r.values[corner].mean(axis=1))
        field = field.isel(face=~inside)
    return chord(field, angle=angle, points=20).attrs["exit_distance"]


def test_path_leaves_at_the_outer_radius():
    assert exit_distance(30, 7) == pytest.approx(LEAVES, rel=FLOAT_RTOL)
    assert LEAVES == pytest.approx(0.2789, abs=1e-4)  # printed: 278 mm


def test_path_ends_at_the_first_of_several_boundaries():
    found = exit_distance(60, 16, hole=lambda z, r: (z > 0.66) & (z < 0.76) & (r > 0.1) & (r < 0.13))
    assert found == pytest.approx(0.1 / np.sin(ANGLE), rel=FLOAT_RTOL)


def test_path_close_to_a_corner_does_not_end_on_the_edges_extended():
    """The path passes the corner of a hole at 0.16 of the length of both edges that meet there."""
    cell_z, cell_r = NOSE / 60, RADIUS / 16
    beside = (NOSE - 10 * cell_r / np.tan(ANGLE)) / cell_z - 50
    assert 0.1 < beside < 0.18

    def hole(z, r):
        return (z / cell_z > 45) & (z / cell_z < 50) & (r / cell_r > 7) & (r / cell_r < 10)

    assert exit_distance(60, 16, hole=hole) == pytest.approx(LEAVES, rel=FLOAT_RTOL, abs=0)


def test_path_along_the_axis_ends_at_the_back_wall():
    assert exit_distance(30, 7, 0.0) == pytest.approx(NOSE, rel=FLOAT_RTOL)
    assert exit_distance(30, 7, np.radians(5)) == pytest.approx(NOSE / np.cos(np.radians(5)))


def test_line_of_sight_honours_the_contract_and_the_rule_beyond_the_field():
    path = line_of_sight(flow(jet), angle=ANGLE, points=240, **RULE)
    contracts.check(contracts.label(path, "sightline"), "sightline")
    distance = path.path_distance.values
    assert distance[0] == 0 and distance[-1] == pytest.approx(1.0, rel=FLOAT_RTOL)
    assert (np.diff(distance) > 0).all()
    outside = (distance >= LEAVES * (1 - FLOAT_RTOL)) & (distance <= 0.8)
    assert outside.sum() >= 3
    for name in ("temperature", "pressure"):
        values = path[name].values
        assert values[outside] == pytest.approx(values[outside][0], rel=FLOAT_RTOL)
    laboratory = distance > 0.8
    assert laboratory.sum() >= 2 and distance[laboratory][0] - 0.8 <= 1e-6 * (1 + 1e-9)
    assert path.temperature.values[laboratory] == pytest.approx(300.0)
    assert path.pressure.values[laboratory] == pytest.approx(101325.0)
    assert path.attrs["exit_distance"] == pytest.approx(LEAVES, rel=FLOAT_RTOL)
    assert path.attrs["angle"] == pytest.approx(35.0, rel=FLOAT_RTOL)


def test_the_error_of_the_field_is_carried_along():
    field = flow(jet)
    z, r = field.node_z.values, field.node_r.values
    path = line_of_sight(
        field.assign(temperature_error=("node", 5 + 100 * r + 20 * z)), angle=ANGLE, points=60, **RULE
    )
    contracts.check(contracts.label(path, "sightline"), "sightline")
    inside = path.path_distance.values <= path.attrs["exit_distance"]
    expected = 5 + 100 * path.radial_position.values + 20 * path.axial_position.values
    assert path.temperature_error.values[inside] == pytest.approx(expected[inside], rel=FLOAT_RTOL)
    assert (path.temperature_error.values[~inside] == 0).all()
    assert "temperature_error" not in line_of_sight(field, angle=ANGLE, points=60, **RULE)


def test_gas_from_the_exit_to_the_window_is_in_the_state_of_the_exit():
    def pressure(z, r):
        return 4000 + 900 * z + 3000 * r

    path = line_of_sight(flow(parabola, pressure), angle=ANGLE, points=60, **RULE)
    chamber = path.sel(path_distance=slice(LEAVES * (1 + 1e-9), 0.8))
    assert chamber.sizes["path_distance"] >= 3
    there = position(LEAVES)
    np.testing.assert_allclose(chamber.pressure, pressure(*there), rtol=FLOAT_RTOL)
    np.testing.assert_allclose(chamber.temperature, parabola(*there), rtol=FLOAT_RTOL)


def test_gas_is_neutral_and_ideal_everywhere():
    path = line_of_sight(flow(jet), angle=ANGLE, points=120, **RULE)
    density = path.number_density.values
    pressure = density.sum(axis=0) * BOLTZMANN * path.temperature.values
    assert pressure == pytest.approx(path.pressure.values, rel=FLOAT_RTOL)
    assert np.abs(CHARGE @ density) == pytest.approx(0 * pressure, abs=FLOAT_RTOL * density.max())
    positive = density[5:10].sum(axis=0)
    assert positive == pytest.approx(density[10], rel=1e-9, abs=0)  # down to 300 K


def test_nodes_are_dense_on_the_wall_and_in_gradients():
    distance = chord(flow(jet), angle=ANGLE, points=240).path_distance.values
    assert np.diff(distance)[0] < 2e-5
    assert np.diff(distance).max() < 5e-3
    shear_layer = (distance > 0.10) & (distance < 0.13)  # r = 0.06 m is met at 105 mm
    quiet = (distance > 0.02) & (distance < 0.05)
    assert shear_layer.sum() > 1.2 * quiet.sum()


def test_integrals_along_the_path_converge():
    """exp(-E/kT) with E = 10 eV is what the strongest lines see."""

    def emission(points):
        path = chord(flow(jet), angle=ANGLE, points=points)
        rate = path.number_density.sel(species="O") * np.exp(-116045 / path.temperature)
        return float(np.trapezoid(rate.values, path.path_distance.values))

    fine = emission(3000)
    coarse, middle = abs(emission(60) / fine - 1), abs(emission(240) / fine - 1)
    assert middle < 1e-3
    assert middle < coarse / 4  # second order gives 16


def test_uniform_field_needs_no_gradient():
    path = chord(flow(lambda z, r: 4000 + 0 * z), angle=ANGLE, points=20)
    assert path.sizes["path_distance"] == 20
    assert path.temperature.values == pytest.approx(4000, rel=FLOAT_RTOL)


def test_same_field_gives_the_same_bytes():
    first, second = (line_of_sight(flow(jet), angle=ANGLE, points=50, **RULE) for _ in range(2))
    for name in first.variables:
        assert first[name].values.tobytes() == second[name].values.tobytes()


def test_a_line_outside_the_field_is_refused():
    with pytest.raises(ValueError, match="the line from z = 2 m, r = 0.2 m misses the flow field"):
        on_line(flow(parabola), np.array([2.0, 3.0]), np.array([0.2, 0.2]), ["temperature"])


@pytest.mark.parametrize(
    "z, r",
    [([0.0, NOSE], [0.0, RADIUS]), ([0.3, 0.3, 0.3], [0.0, 0.01, RADIUS]), ([0.5], [0.07]), ([0.2], [0.0])],
    ids=["corners", "across", "point", "point of the axis"],
)
def test_a_quadratic_field_is_exact_on_any_line(z, r):
    found = on_line(flow(parabola), np.array(z), np.array(r), ["temperature"])["temperature"]
    assert found == pytest.approx(parabola(np.array(z), np.array(r)), rel=FLOAT_RTOL)


def test_a_path_that_ends_at_a_wall_is_refused_as_a_line_of_sight():
    with pytest.raises(
        ValueError, match="angle must let the path leave the field at its outer radius; at 5 deg"
    ):
        line_of_sight(flow(jet), angle=np.radians(5), points=50, **RULE)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"window_distance": 0.2}, "distances must satisfy exit < window < instrument"),
        ({"instrument_distance": 0.8}, "distances must satisfy exit < window < instrument"),
        ({"laboratory_pressure": 0.0}, "laboratory_pressure must be > 0 Pa"),
        ({"laboratory_temperature": np.nan}, "laboratory_temperature must be > 0 K"),
        ({"points": 1}, "points must be >= 2; got 1"),
        ({"angle": 3.0}, "angle must lie in"),
    ],
)
def test_bad_arguments_are_refused(change, message):
    arguments = {"angle": ANGLE, "points": 50, **RULE, **change}
    with pytest.raises(ValueError, match=message):
        line_of_sight(flow(jet), **arguments)


def test_a_field_without_a_nose_is_refused():
    field = flow(jet)
    del field.attrs["stagnation_point_z"]
    with pytest.raises(ValueError, match="flow lacks the attribute stagnation_point_z"):
        chord(field, angle=ANGLE, points=50)


def test_the_mirrored_ray_is_the_line_of_sight_on_the_other_side():
    view = surface_view(flow(jet), mirror_angle=ANGLE, directions_count=4, core_angle=0.08, points=50)
    contracts.check(contracts.label(view, "surface_view"), "surface_view")
    direct = chord(flow(jet), angle=ANGLE, points=50)
    mirrored = view.isel(ray=0)
    assert float(mirrored.ray_weight) == 0
    np.testing.assert_array_equal(mirrored.ray_temperature, direct.temperature)
    np.testing.assert_array_equal(mirrored.ray_distance, direct.path_distance)
    np.testing.assert_array_equal(mirrored.ray_number_density, direct.number_density)


def test_the_view_covers_the_hemisphere():
    view = surface_view(flow(jet), mirror_angle=ANGLE, directions_count=4, core_angle=0.08, points=50)
    assert float(view.ray_weight.sum()) == pytest.approx(1, rel=FLOAT_RTOL)
    angle = view.ray_angle.values[1:]
    assert (np.diff(angle) > 0).all() and angle[0] < 0.01 and angle[-1] > 1.2
    # On a cylinder around the nose a ray ends at the back wall or at the outer radius.
    end = np.minimum(NOSE / np.cos(angle), RADIUS / np.sin(angle))
    assert view.ray_distance.values[1:, -1] == pytest.approx(end, rel=1e-9)


def test_a_sight_line_can_be_made_from_arrays():
    distance, temperature = [0.0, 0.1, 0.3], [300.0, 7000.0, 900.0]
    path = equilibrium_sightline(distance, temperature, 5000.0)
    contracts.check(contracts.label(path, "sightline"), "sightline")
    density = path.number_density.sum("species").values
    assert density == pytest.approx(5000 / (BOLTZMANN * np.array(temperature)), rel=1e-9)
    with pytest.raises(ValueError, match="path_distance must increase strictly"):
        equilibrium_sightline(distance[::-1], temperature, 5000.0)
    with pytest.raises(ValueError, match="pressure must be > 0 Pa"):
        equilibrium_sightline(distance, temperature, [5000.0, -1.0, 5000.0])


@pytest.mark.parametrize("name", ["face_node", "face_midnode"])
@pytest.mark.parametrize("wrong, shown", [(-1, "-1"), (9**9, "387420489")])
def test_an_index_of_no_node_is_refused(name, wrong, shown):
    field = flow(jet)
    field[name].values[7, 2] = wrong
    rule = rf"{name} must lie in \[0, 2024\] \(indices of nodes\); got {shown} at face 7, corner 2"
    with pytest.raises(ValueError, match=rule):
        chord(field, angle=ANGLE, points=50)


def test_indices_that_are_no_integers_are_refused():
    field = flow(jet)
    field["face_node"] = field.face_node.astype(float)
    with pytest.raises(ValueError, match="face_node must hold integers; got float64, 0 first"):
        chord(field, angle=ANGLE, points=50)
