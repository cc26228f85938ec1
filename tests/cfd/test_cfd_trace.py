"""Rays through simplices: exact on linear fields, second order on smooth ones; bodies, holes, mirrors."""

import cfd_samples as samples
import meshio
import numpy as np
import pytest

from plasmapyro import io
from plasmapyro.cfd.assemble import _triangulated, build, read_zones
from plasmapyro.cfd.export import write_vtu
from plasmapyro.cfd.grid import CORNERS_OF, DIMENSION, SIMPLICES, Zone, simplices_of
from plasmapyro.cfd.mapping import parse
from plasmapyro.cfd.nodes import to_nodes
from plasmapyro.cfd.stage import sightline, surface_view, to_instrument
from plasmapyro.sightline import trace
from plasmapyro.sightline.stage import line_of_sight
from plasmapyro.sightline.stage import surface_view as direct_surface_view
from plasmapyro.sightline.trace import Field

FLOAT_RTOL = 1e-10  # of a linear field; the ends of cells are widened by 1e-12
WRITTEN = {
    "temperature": {"name": "temperature", "unit": "K"},
    "pressure": {"name": "pressure", "unit": "Pa"},
}
BEYOND = {
    "window_distance": 0.8,
    "instrument_distance": 1.0,
    "laboratory_temperature": 300.0,
    "laboratory_pressure": 101325.0,
}
REFERENCE = {  # corners of cells of unit size, and their volume
    "triangle": ([(0, 0), (1, 0), (0, 1)], 0.5),
    "quad": ([(0, 0), (1, 0), (1, 1), (0, 1)], 1.0),
    "tetra": ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], 1 / 6),
    "pyramid": ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)], 1 / 3),
    "wedge": ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)], 0.5),
    "hexahedron": (
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        1.0,
    ),
}


def volume(points, simplices):
    edges = points[simplices[:, 1:]] - points[simplices[:, :1]]
    return np.abs(np.linalg.det(edges)).sum() / {2: 2, 3: 6}[points.shape[1]]


@pytest.mark.parametrize("kind", REFERENCE)
def test_simplices_fill_their_cell(kind):
    corners, expected = REFERENCE[kind]
    points = np.array(corners, dtype=float)
    simplices, middles = simplices_of(kind, np.arange(len(points))[None], points)
    assert volume(points, simplices) == pytest.approx(expected, rel=1e-12)
    assert (middles == -1).all()
    # Each inner face is shared by two simplices: no overlap.
    inside = np.random.default_rng(0).dirichlet(np.ones(len(points)), 300) @ points
    columns = np.concatenate([points[simplices], np.ones((*simplices.shape, 1))], axis=2).transpose(0, 2, 1)
    weight = np.linalg.inv(columns) @ np.concatenate([inside, np.ones((300, 1))], axis=1).T
    assert ((weight > 1e-9).all(axis=1).sum(axis=0) <= 1).all()
    assert ((weight > -1e-9).all(axis=1).sum(axis=0) >= 1).all()


def test_every_cell_with_middle_nodes_has_corners():
    assert set(CORNERS_OF) | set(SIMPLICES) == set(DIMENSION)


@pytest.mark.parametrize("kind", ["triangle6", "tetra10"])
def test_curved_cells_are_cut_at_their_middle_nodes(kind):
    linear = "triangle" if kind == "triangle6" else "tetra"
    corners = np.array(REFERENCE[linear][0], dtype=float)
    pairs = [(0, 1), (1, 2), (2, 0)] + ([(0, 3), (1, 3), (2, 3)] if kind == "tetra10" else [])
    points = np.concatenate([corners, [(corners[a] + corners[b]) / 2 for a, b in pairs]])
    cell = np.arange(len(points))[None]
    whole, middles = simplices_of(kind, cell, points)
    assert len(whole) == 1 and (middles >= 0).all()
    points[4] += 1e-4
    cut, middles = simplices_of(kind, cell, points)
    assert len(cut) == len(SIMPLICES[kind]) and (middles == -1).all()
    assert volume(points, cut) == pytest.approx(REFERENCE[linear][1], rel=1e-3)


def plane(columns, rows, value):
    points, cells = samples.triangles(columns, rows)
    return Field(points, cells, np.full(cells.shape, -1), {"f": value(*points.T)})


RAYS = {
    "in a plane through the axis": ([0.29, 0.0, 0.0], [-1.0, 0.3, 0.0]),
    "across the axis": ([0.2, -0.09, 0.0], [-0.1, 1.0, 0.0]),
    "past the axis": ([0.2, -0.08, 0.03], [-0.2, 1.0, 0.1]),
    "along the axis": ([0.3, 0.0, 0.0], [-1.0, 0.0, 0.0]),
    "parallel to the axis": ([0.3, 0.02, 0.03], [-1.0, 0.0, 0.0]),
    "square to the axis": ([0.1, 0.0, 0.0], [0.0, 0.0, 1.0]),
}


@pytest.mark.parametrize("name", RAYS)
def test_a_linear_field_is_exact_along_any_ray(name):
    field = plane(13, 9, samples.temperature)
    origin, direction = (np.array(part) for part in RAYS[name])
    ray = trace.Ray(origin, direction / np.linalg.norm(direction), True)
    found = trace.crossings(field, ray, 1.0)
    parts = trace.stretches(found)
    assert len(parts) == 1
    distance = np.linspace(*parts[0], 301)
    x, r = ray.at(distance).T
    assert r.max() <= 0.1 * (1 + 1e-9) and -1e-9 <= x.min() and x.max() <= 0.3 * (1 + 1e-9)
    values = trace.values_along(field, ray, found, distance, ["f"])["f"]
    assert values == pytest.approx(samples.temperature(x, r), rel=FLOAT_RTOL, abs=0)
    # Both ends lie on the boundary, unless the ray starts inside.
    for end in distance[[0, -1]]:
        z, radius = ray.at(np.array([end]))[0]
        assert end == 0 or min(abs(z), abs(z - 0.3), abs(radius - 0.1)) < 1e-9


def block(path=samples.FILES / "half_block.vtu"):
    mapping = parse(samples.settings("three_dimensional"))
    return build(read_zones(path, mapping), mapping, path)


@pytest.mark.parametrize("kind", ["space", "axisymmetric"])
def test_the_crossings_of_a_ray_add_up_to_its_length_in_the_field(kind):
    """No cell is missed and none is counted twice, whatever the direction."""
    generator = np.random.default_rng(11)
    field = block() if kind == "space" else plane(13, 9, samples.temperature)
    for _ in range(60):
        origin = generator.uniform([0.01, 0.0, 0.0], [0.29, 0.06, 0.06])
        direction = generator.normal(size=3)
        ray = trace.Ray(origin, direction / np.linalg.norm(direction), kind == "axisymmetric")
        found = trace.crossings(field, ray, 2.0)
        parts = trace.stretches(found)
        assert len(parts) == 1 and parts[0, 0] == 0
        assert (found.leave - found.enter).sum() == pytest.approx(parts[0, 1], rel=1e-8)
        end = ray.at(parts[0, 1:])[0]
        walls = [abs(end[0]), abs(end[0] - 0.3), abs(end[1] - 0.1)]
        walls += [abs(end[1]), abs(end[2]), abs(end[2] - 0.1)] if kind == "space" else []
        assert min(walls) < 1e-9


def test_quadratic_cells_of_several_zones_and_their_mirror_image_are_exact():
    def parabola(x, y):
        return 1000 + 4000 * x**2 - 3000 * x * y + 90000 * y**2

    flow = samples.quadratic_flow(parabola, columns=6, rows=3)
    cells = np.concatenate([flow.face_node.values, flow.face_midnode.values], axis=1)
    left = flow.node_z.values[flow.face_node.values].mean(axis=1) < 0.15
    data = {"x": flow.node_z.values, "y": flow.node_r.values, "T": flow.temperature.values}
    data["p"] = np.full(len(data["x"]), 5000.0)
    # The second zone counts its nodes backwards.
    behind = {name: values[::-1] for name, values in data.items()}
    zones = [
        Zone("a", data, [("triangle6", cells[left])]),
        Zone("b", behind, [("triangle6", len(data["x"]) - 1 - cells[~left])]),
    ]
    mapping = parse(samples.settings("planar", mirror={"y": 0.0}))
    field = build(zones, mapping, "zones")
    ray = trace.Ray(np.array([0.01, -0.09, 0.0]), np.array([0.8, 0.6, 0.0]), False)
    found = trace.crossings(field, ray, 1.0)
    distance = np.linspace(*trace.stretches(found)[0], 200)
    x, y, _ = ray.at(distance).T
    assert y[0] < -0.08 and y[-1] > 0.09
    values = trace.values_along(field, ray, found, distance, ["temperature"])["temperature"]
    assert values == pytest.approx(parabola(x, np.abs(y)), rel=1e-9, abs=0)


def test_scattered_cells_with_any_long_edge_are_dropped():
    points = np.random.default_rng(4).uniform(size=(60, 3))
    _, every = _triangulated(points, None, "points")
    _, kept = _triangulated(points, 0.4, "points")

    def longest(cells):
        corner = points[cells]
        return np.linalg.norm(corner[:, :, None] - corner[:, None], axis=3).max(axis=(1, 2))

    assert 0 < len(kept) == (longest(every) <= 0.4).sum() < len(every)
    assert longest(kept).max() <= 0.4


def test_a_smooth_field_converges_with_the_second_power_of_the_cell():
    def smooth(x, r):
        return np.exp(-((r / 0.05) ** 2)) * np.sin(12 * x + 0.3)

    ray = trace.Ray(np.array([0.28, 0.0, 0.0]), np.array([-0.95, 0.3, 0.0]) / np.hypot(0.95, 0.3), True)
    errors = []
    for factor in (2, 4, 8):
        field = plane(6 * factor + 1, 4 * factor + 1, smooth)
        found = trace.crossings(field, ray, 0.25)
        distance = np.linspace(0, 0.25, 4001)
        values = trace.values_along(field, ray, found, distance, ["f"])["f"]
        errors.append(np.abs(values - smooth(*ray.at(distance).T)).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2, 2], abs=0.3)


def test_values_in_cells_of_a_smooth_field_converge_with_the_second_power_up_to_the_boundary():
    def smooth(x, r):
        return 2 + np.sin(9 * x) * np.cos(20 * r)

    errors = []
    for factor in (2, 4, 8):
        points, cells = samples.triangles(6 * factor + 1, 4 * factor + 1)
        values = smooth(*points[cells].mean(axis=1).T)[:, None]
        errors.append(np.abs(to_nodes(points, [cells], values)[:, 0] - smooth(*points.T)).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2, 2], abs=0.35)


def test_values_in_cells_stay_positive_at_a_wall():
    points, cells = samples.triangles(7, 9)
    centre = points[cells].mean(axis=1)
    steep = np.where(centre[:, 1] > 0.08, 350.0, 9000.0)[:, None]
    nodes = to_nodes(points, [cells], steep)
    assert nodes.min() >= 175 and nodes.max() <= 18000


def jet(z, r):
    return 350 + 5500 * (1 - np.exp(-(0.3 - z) / 0.02)) / (1 + (r / 0.06) ** 8)


def test_our_own_flow_read_back_gives_the_same_sight_line(tmp_path):
    flow = samples.quadratic_flow(jet)
    write_vtu(flow, tmp_path / "flow.vtu")
    mapping = samples.settings(variables=WRITTEN, ray={"origin": [0.3, 0.0]})
    inside = sightline(tmp_path / "flow.vtu", mapping, points=90, angle=np.radians(35))
    found = to_instrument(inside, **BEYOND)
    direct = line_of_sight(flow, angle=np.radians(35), points=90, **BEYOND)
    for name in ("path_distance", "temperature", "pressure", "axial_position", "radial_position"):
        # The exit is where a cell ends: 1e-12 of a cell further out than in the direct way.
        assert found[name].values == pytest.approx(direct[name].values, rel=1e-9, abs=1e-12)
    # Densities of rare species follow the temperature with a slope of up to 1e3.
    assert found.number_density.values == pytest.approx(direct.number_density.values, rel=1e-6, abs=0)
    assert found.attrs["exit_distance"] == pytest.approx(direct.attrs["exit_distance"], rel=1e-9)
    assert found.attrs["window_distance"] == direct.attrs["window_distance"]
    io.write(found, tmp_path / "line.nc", "sightline", sources=[tmp_path / "flow.vtu"])
    assert io.read(tmp_path / "line.nc", "sightline").sizes == direct.sizes


def test_the_rays_that_light_the_surface_are_those_of_the_direct_way(tmp_path):
    flow = samples.quadratic_flow(jet)
    write_vtu(flow, tmp_path / "flow.vtu")
    mapping = samples.settings(variables=WRITTEN, ray={"origin": [0.3, 0.0], "direction": [-1.0, 0.1]})
    rule = {"mirror_angle": 0.6, "directions_count": 4, "core_angle": 0.1, "points": 40}
    found = surface_view(tmp_path / "flow.vtu", mapping, **rule)
    direct = direct_surface_view(flow, **rule)
    for name in ("ray_angle", "ray_weight", "ray_distance", "ray_temperature", "ray_pressure"):
        assert found[name].values == pytest.approx(direct[name].values, rel=1e-9, abs=1e-12)
    assert found.ray_number_density.values == pytest.approx(direct.ray_number_density.values, rel=1e-6)
    io.write(found, tmp_path / "view.nc", "surface_view")


def test_only_the_stagnation_point_of_an_axisymmetric_field_is_lit():
    rule = {"mirror_angle": 0.6, "directions_count": 4, "core_angle": 0.1, "points": 40}
    mapping = samples.settings(ray={"origin": [0.29, 0.01]})
    with pytest.raises(ValueError, match="needs a stagnation point on the axis"):
        surface_view(samples.FILES / "mixed_ascii.vtu", mapping, **rule)


def test_the_same_flow_gives_the_same_bytes(tmp_path):
    flow = samples.quadratic_flow(jet)
    for name in ("a.vtu", "b.vtu"):
        write_vtu(flow, tmp_path / name)
    assert (tmp_path / "a.vtu").read_bytes() == (tmp_path / "b.vtu").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.vtu", "b.vtu"]
    mesh = meshio.vtu.read(str(tmp_path / "a.vtu"))
    stored = mesh.point_data
    # VTK's quadratic triangle: node 3 + k lies between the corners k and k + 1, counter-clockwise.
    (block,) = mesh.cells
    assert block.type == "triangle6" and (mesh.points[:, 2] == 0).all()
    corner, middle = mesh.points[block.data[:, :3], :2], mesh.points[block.data[:, 3:], :2]
    np.testing.assert_allclose(middle, (corner + np.roll(corner, -1, axis=1)) / 2, atol=1e-12)
    side, other = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    assert (side[:, 0] * other[:, 1] > side[:, 1] * other[:, 0]).all()
    np.testing.assert_array_equal(mesh.points[:, :2], np.stack([flow.node_z, flow.node_r], axis=1))
    velocity = np.stack([flow.axial_velocity, flow.radial_velocity, 0 * flow.node_z], axis=1)
    np.testing.assert_array_equal(stored["velocity"], velocity)
    np.testing.assert_array_equal(stored["joule_heating"], flow.joule_heating)


def with_hole(folder, low=0.12, high=0.18, top=0.05):
    """The field with a body in 0.12 m < x < 0.18 m, y < 0.05 m."""
    points, cells = samples.triangles(21, 9, shear=0.0)
    x, y = points[cells].mean(axis=1).T
    body = (x > low) & (x < high) & (y < top)
    (folder / "flow.dat").write_text(samples.tecplot_fepoint(points, cells[~body]))
    return folder / "flow.dat"


HOLE = {"coordinates": {"axial": "x0", "radial": "x1"}}


def test_a_body_in_the_way_stops_the_ray(tmp_path):
    mapping = samples.settings(**HOLE, ray={"origin": [0.28, 0.0], "direction": [-1.0, 0.1]})
    line = sightline(with_hole(tmp_path), mapping, points=60)
    assert line.attrs["path_end"] == "body"
    assert line.attrs["exit_distance"] == pytest.approx(0.10 * np.hypot(1, 0.1), rel=1e-9)
    assert line.path_distance.values[-1] == line.attrs["exit_distance"]
    gap = 1e3 * 0.06 * np.hypot(1, 0.1)
    assert (
        f"stops at a body 100.5 mm from its origin; the field goes on {gap:.4g} mm"
        in line.attrs["path_status"]
    )
    with pytest.raises(ValueError, match="the instrument does not see the surface.*stops at a body"):
        to_instrument(line, **BEYOND)


def test_a_chord_that_leaves_and_comes_back_may_be_bridged(tmp_path):
    ray = {"origin": [0.28, 0.0], "direction": [-1.0, 0.1], "gaps": "gas"}
    mapping = samples.settings(**HOLE, ray=ray)
    line = sightline(with_hole(tmp_path), mapping, points=60)
    assert line.attrs["path_end"] == "boundary"
    x, y, _ = samples.along(line, mapping)
    assert line.temperature.values == pytest.approx(samples.temperature(x, y), rel=FLOAT_RTOL, abs=0)
    assert not ((x > 0.12 + 1e-9) & (x < 0.18 - 1e-9)).any()
    for edge in (0.12, 0.18):
        assert np.abs(x - edge).min() < 1e-9
    assert x[-1] == pytest.approx(0, abs=1e-9)


def test_a_ray_past_the_body_sees_through(tmp_path):
    mapping = samples.settings(**HOLE, ray={"origin": [0.28, 0.03], "direction": [-1.0, 0.3]})
    assert sightline(with_hole(tmp_path), mapping, points=60).attrs["path_end"] == "boundary"


def test_a_ray_may_start_outside_and_begins_where_the_field_does():
    mapping = samples.settings("planar", ray={"origin": [-0.1, 0.05], "direction": [1.0, 0.0]})
    line = sightline(samples.FILES / "mixed_ascii.vtu", mapping, points=60)
    assert line.attrs["entry_distance"] == pytest.approx(0.1, rel=1e-9)
    assert line.path_distance.values[[0, -1]] == pytest.approx([0.1, 0.4], rel=1e-9)
    assert line.attrs["path_status"] == (
        "begins 100 mm from its origin, where the field does, and leaves the field 400 mm from its origin"
    )


def test_a_surface_just_before_the_first_cell_counts_as_its_beginning():
    mapping = samples.settings("planar", ray={"origin": [-0.0005, 0.05], "direction": [1.0, 0.0]})
    line = sightline(samples.FILES / "mixed_ascii.vtu", mapping, points=60)
    assert line.path_distance.values[0] == 0
    assert line.temperature.values[0] == pytest.approx(samples.temperature(0, 0.05), rel=1e-3)


def test_a_mirrored_half_model_is_whole():
    mapping = samples.settings(
        "three_dimensional",
        mirror={"z": 0.0},
        ray={"origin": [0.02, 0.01, -0.09], "direction": [1.0, 0.2, 0.5]},
    )
    line = sightline(samples.FILES / "half_block.vtu", mapping, points=60)
    x, y, z = samples.along(line, mapping)
    assert z[0] < 0 < z[-1]
    assert line.temperature.values == pytest.approx(
        samples.temperature(x, y, np.abs(z)), rel=FLOAT_RTOL, abs=0
    )
    assert x[-1] == pytest.approx(0.3, rel=1e-9)


def test_a_quarter_model_is_mirrored_twice():
    mapping = samples.settings(
        "three_dimensional",
        mirror={"y": 0.0, "z": 0.0},
        ray={"origin": [0.1, -0.1, -0.1], "direction": [0.1, 1.0, 1.0]},
    )
    line = sightline(samples.FILES / "half_block.vtu", mapping, points=60)
    x, y, z = samples.along(line, mapping)
    expected = samples.temperature(x, np.abs(y), np.abs(z))
    assert line.temperature.values == pytest.approx(expected, rel=FLOAT_RTOL, abs=0)
    assert y[[0, -1]] == pytest.approx([-0.1, 0.1], rel=1e-9)


def test_a_half_below_the_axis_and_a_whole_plane_are_halves(tmp_path):
    points, cells = samples.triangles()
    for name, sign in (("below", -1), ("above", 1)):
        text = samples.tecplot_fepoint(points * [1, sign], cells)
        # The field is linear in the radius: values of the mirrored half are those above.
        rows = text.splitlines()
        for k, (x, y) in enumerate(points):
            words = rows[3 + k].split()
            words[2], words[4] = f"{samples.pressure(x, y):.12e}", f"{samples.temperature(x, y):.12e}"
            rows[3 + k] = " ".join(words)
        (tmp_path / f"{name}.dat").write_text("\n".join(rows) + "\n")
    both = (tmp_path / "above.dat").read_text() + "\n".join(
        (tmp_path / "below.dat").read_text().splitlines()[2:]
    )
    (tmp_path / "both.dat").write_text(both + "\n")
    lines = [
        sightline(tmp_path / f"{name}.dat", samples.settings(**HOLE), points=60)
        for name in ("above", "below", "both")
    ]
    for line in lines[1:]:
        assert line.temperature.values == pytest.approx(lines[0].temperature.values, rel=1e-12, abs=0)


def test_scattered_points_around_a_body_need_the_largest_cell(tmp_path):
    points, _ = samples.triangles(31, 11, shear=0.0)
    x, y = points.T
    outside = ~((x > 0.121) & (x < 0.179) & (y < 0.049))
    (tmp_path / "points.csv").write_text(samples.scattered(points[outside]))
    ray = {"origin": [0.28, 0.0], "direction": [-1.0, 0.1]}
    line = sightline(tmp_path / "points.csv", samples.settings(ray=ray), points=60)
    assert line.attrs["path_end"] == "boundary"
    line = sightline(tmp_path / "points.csv", samples.settings(ray=ray, largest_cell=0.015), points=60)
    assert line.attrs["path_end"] == "body"
    assert line.attrs["exit_distance"] == pytest.approx(0.1 * np.hypot(1, 0.1), abs=0.011)
