"""The mesh: area, boundaries, resolution at the probe nose, refusals."""

from dataclasses import replace

import numpy as np
import pytest

from plasmapyro.flow.geometry import BOUNDARIES, BOX_MARGIN, BOX_RADIUS, Torch, build_mesh, flow_mesh

TORCH = Torch(
    length=0.486,
    radius=0.080,
    slot_inner_radius=0.075,
    chamber_length=0.5,
    chamber_radius=0.160,
    probe_distance=0.385,
    probe_radius=0.025,
    coil_radius=0.109,
    coil_positions=(0.127, 0.177, 0.227, 0.277, 0.327, 0.377),
)
CHORD_RTOL = 2e-3  # straight edges on the hemisphere


@pytest.fixture(scope="module")
def meshes():
    mesh = build_mesh(TORCH, 2.0)
    return mesh, flow_mesh(mesh, TORCH)


def area(mesh):
    a, b, c = (mesh.p[:, mesh.t[k]] for k in range(3))
    return 0.5 * np.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).sum()


def test_areas_are_those_of_the_drawing(meshes):
    mesh, flow = meshes
    probe = np.pi * 0.025**2 / 4 + 0.09 * 0.025
    assert area(flow) == pytest.approx(0.486 * 0.08 + 0.5 * 0.16 - probe, rel=1e-4)
    assert area(mesh) == pytest.approx((0.986 + 2 * BOX_MARGIN) * BOX_RADIUS, rel=1e-4)


def test_boundaries_have_the_lengths_of_the_drawing(meshes):
    _, flow = meshes
    expected = {
        "inlet": 0.005,
        "top": 0.5,
        "outlet": 0.135,
        "back_wall": 0.075,
        "tube_wall": 0.486,
        "chamber_wall": 0.08,
        "probe": np.pi * 0.025 / 2 + 0.09,
        "axis": 0.871,
    }
    assert set(expected) == {*BOUNDARIES, "axis"}
    for name, length in expected.items():
        ends = flow.p[:, flow.facets[:, flow.boundaries[name]]]
        assert np.hypot(*(ends[:, 0] - ends[:, 1])).sum() == pytest.approx(length, rel=CHORD_RTOL), name


def test_nose_cells_resolve_the_first_two_millimetres():
    flow = flow_mesh(build_mesh(TORCH, 1.0), TORCH)
    ends = flow.p[:, flow.facets]
    middle = ends.mean(axis=1)
    near = np.hypot(middle[0] - TORCH.nose, middle[1]) < 2e-3
    assert near.sum() > 100
    assert np.hypot(*(ends[:, 0] - ends[:, 1]))[near].mean() < 0.3e-3


def test_the_same_mesh_comes_out_twice(meshes):
    again = build_mesh(TORCH, 2.0)
    assert again.p.tobytes() == meshes[0].p.tobytes()
    assert again.t.tobytes() == meshes[0].t.tobytes()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"radius": -0.08}, "radius must be > 0 m; got -0.08 m"),
        ({"slot_inner_radius": 0.09}, "slot_inner_radius < radius"),
        ({"coil_radius": 0.05}, "radius < chamber_radius and coil_radius"),
        ({"probe_distance": 0.49}, "the probe nose must end inside the chamber"),
        ({"coil_positions": (0.2, 0.1)}, "coil_positions must increase strictly"),
    ],
)
def test_an_impossible_torch_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(TORCH, **change)


SHAPES = {  # cross-section of the probe in the meridian plane [m2], and its front in z [m]
    "hemisphere": np.pi * 0.025**2 / 4 + 0.09 * 0.025,
    "flat": 0.115 * 0.025,
    "blunt": 0.115 * 0.025 - (1 - np.pi / 4) * 0.011**2,
    "none": 0.0,
}


@pytest.mark.parametrize("shape", SHAPES)
def test_each_probe_takes_its_area_out_of_the_flow(shape):
    torch = replace(TORCH, probe_shape=shape, shoulder_radius=0.011)
    flow = flow_mesh(build_mesh(torch, 3.0), torch)
    whole = 0.486 * 0.08 + 0.5 * 0.16
    assert whole - area(flow) == pytest.approx(SHAPES[shape], rel=2e-3, abs=1e-9)
    assert bool(len(flow.boundaries["probe"])) == (shape != "none")


@pytest.mark.parametrize(
    ("shape", "point", "distance"),
    [
        ("hemisphere", (0.861, 0.0), 0.010),
        ("hemisphere", (0.896 - 0.030 / np.sqrt(2), 0.030 / np.sqrt(2)), 0.005),
        ("flat", (0.861, 0.012), 0.010),
        ("flat", (0.868, 0.029), 0.005),
        ("blunt", (0.861, 0.012), 0.010),
        ("blunt", (0.882 - 0.016 / np.sqrt(2), 0.014 + 0.016 / np.sqrt(2)), 0.005),
        ("blunt", (0.95, 0.031), 0.006),
    ],
)
def test_clearance_is_the_distance_to_the_probe(shape, point, distance):
    torch = replace(TORCH, probe_shape=shape, shoulder_radius=0.011)
    assert float(torch.probe_clearance(*map(np.array, point))) == pytest.approx(distance, rel=1e-12)


def test_cells_are_small_where_the_line_of_sight_starts():
    flow = flow_mesh(build_mesh(TORCH, 2.0), TORCH)
    ends = flow.p[:, flow.facets[:, flow.boundaries["probe"]]]
    length = np.hypot(*(ends[:, 0] - ends[:, 1]))
    from_nose = np.hypot(ends[0].mean(axis=0) - TORCH.nose, ends[1].mean(axis=0))
    assert length[from_nose < 3.5e-3].max() < 0.25e-3
    assert length[from_nose < 25e-3].max() < 0.5e-3
