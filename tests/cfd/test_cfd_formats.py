"""Every format that is read, from files of other programs or after the published layout."""

import cfd_samples as samples
import meshio
import numpy as np
import pytest

from plasmapyro.cfd.stage import sightline

LINEAR_RTOL = 1e-10  # of a linear field on simplices; text files print eleven digits or more
SINGLE_RTOL = 5e-7  # 2^-22: rounding of coordinates and values in single precision
CELL_RTOL = 1e-8  # from values in cells: the least squares are regularised by 1e-10


def check(path, mapping, mesh=None, rtol=LINEAR_RTOL):
    line = sightline(path, mapping, points=60, mesh=mesh)
    x, y, z = samples.along(line, mapping)
    assert line.temperature.values == pytest.approx(samples.temperature(x, y, z), rel=rtol, abs=0)
    assert line.pressure.values == pytest.approx(samples.pressure(x, y, z), rel=rtol, abs=0)
    return line


@pytest.mark.parametrize("geometry", ["planar", "axisymmetric"])
@pytest.mark.parametrize(
    "name",
    [
        "mixed_ascii.vtu",
        "mixed_appended_raw.vtu",
        "mixed_appended_base64.vtu",
        "mixed_binary_lzma.vtu",
        "mixed_ascii.vtk",
        "mixed_binary.vtk",
    ],
)
def test_vtk_files_of_all_kinds(name, geometry):
    line = check(samples.FILES / name, samples.settings(geometry))
    assert line.attrs["path_end"] == "boundary"
    # From one end of the rectangle to its other edge along (1, 0.3).
    assert line.attrs["exit_distance"] == pytest.approx(0.29 * np.hypot(1, 0.3), rel=1e-9)


def test_vtk_values_in_cells():
    check(samples.FILES / "cells.vtu", samples.settings(), rtol=CELL_RTOL)


def test_vtk_volume_of_hexahedra_wedges_tetrahedra_and_pyramids():
    check(samples.FILES / "half_block.vtu", samples.settings("three_dimensional"))


@pytest.mark.parametrize("kind", ["STRUCTURED_GRID", "RECTILINEAR_GRID"])
def test_legacy_vtk_of_grids_without_cells_of_their_own(tmp_path, kind):
    (tmp_path / "flow.vtk").write_text(samples.vtk_grid(kind))
    check(tmp_path / "flow.vtk", samples.settings())


@pytest.mark.parametrize("origin", [[0.29, 0.0], [0.3, 0.0]])
def test_single_precision_as_most_programs_write_it(tmp_path, origin):
    points, cells = samples.triangles()
    state = {"T": samples.temperature(*points.T), "p": samples.pressure(*points.T)}
    mesh = meshio.Mesh(
        np.pad(points, ((0, 0), (0, 1))).astype("f4"),
        [("triangle", cells)],
        point_data={name: values.astype("f4") for name, values in state.items()},
    )
    meshio.vtu.write(str(tmp_path / "flow.vtu"), mesh)
    # The last edge of the rectangle lies at 0.3 m to 4e-8 only.
    line = check(
        tmp_path / "flow.vtu",
        samples.settings(ray={"origin": origin, "direction": [-1.0, 0.0]}),
        rtol=SINGLE_RTOL,
    )
    assert line.attrs["path_end"] == "boundary" and line.path_distance.values[0] == 0
    assert line.attrs["exit_distance"] == pytest.approx(origin[0], rel=SINGLE_RTOL)


def cgns_settings(geometry):
    state = {
        "temperature": {"name": "Temperature", "unit": "K"},
        "pressure": {"name": "Pressure", "unit": "Pa"},
    }
    return samples.settings(geometry, variables=state)


@pytest.mark.parametrize(
    ("name", "geometry", "rtol"),
    [
        ("structured.cgns", "axisymmetric", LINEAR_RTOL),
        ("unstructured.cgns", "axisymmetric", CELL_RTOL),
        ("block.cgns", "three_dimensional", LINEAR_RTOL),
    ],
)
def test_cgns(name, geometry, rtol):
    check(samples.FILES / name, cgns_settings(geometry), rtol=rtol)


TECPLOT = {"coordinates": {"axial": "x0", "radial": "x1"}}


def test_tecplot_fepoint(tmp_path):
    (tmp_path / "flow.dat").write_text(samples.tecplot_fepoint(*samples.triangles()))
    check(tmp_path / "flow.dat", samples.settings(**TECPLOT))


def test_tecplot_degenerate_quadrilaterals_are_triangles(tmp_path):
    points, cells = samples.triangles()
    four = np.concatenate([cells, cells[:, 2:]], axis=1)
    (tmp_path / "flow.plt").write_text(samples.tecplot_fepoint(points, four, "QUADRILATERAL"))
    check(tmp_path / "flow.plt", samples.settings(**TECPLOT))


@pytest.mark.parametrize(
    ("location", "rtol"),
    [
        ("", LINEAR_RTOL),
        ("VARLOCATION=(NODAL, NODAL, CELLCENTERED, CELLCENTERED)", CELL_RTOL),
        ("VARLOCATION=([3,4]=CELLCENTERED)", CELL_RTOL),
        ("varlocation=(3=cellcentered, 4=cellcentered)", CELL_RTOL),
        ("VARLOCATION=([3-4]=CELLCENTERED)", CELL_RTOL),
    ],
)
def test_every_way_to_say_which_variables_stand_in_cells(tmp_path, location, rtol):
    (tmp_path / "flow.dat").write_text(samples.tecplot_blocks_of_one_zone(location))
    check(tmp_path / "flow.dat", samples.settings(**TECPLOT), rtol=rtol)


def test_tecplot_with_the_words_of_its_newer_versions_and_line_ends_of_windows(tmp_path):
    text = samples.tecplot_fepoint(*samples.triangles())
    newer = "Nodes=35, Elements=48, ZONETYPE=FETriangle\nDATAPACKING=POINT\nDT=(SINGLE SINGLE SINGLE SINGLE)"
    text = text.replace("N=35, E=48, F=FEPOINT, ET=TRIANGLE", newer)
    assert newer in text
    (tmp_path / "flow.dat").write_bytes(text.replace("\n", "\r\n").encode())
    check(tmp_path / "flow.dat", samples.settings(**TECPLOT))


def test_tecplot_blocks_with_values_in_cells_comments_and_two_zones(tmp_path):
    (tmp_path / "flow.plt").write_text(samples.tecplot_block())
    line = check(tmp_path / "flow.plt", samples.settings(**TECPLOT), rtol=CELL_RTOL)
    assert line.attrs["path_end"] == "boundary"


@pytest.mark.parametrize("zone", ["P0 ZONE1 Triag", 2])
def test_a_zone_is_chosen_by_name_or_number(tmp_path, zone):
    (tmp_path / "flow.plt").write_text(samples.tecplot_block())
    line = check(tmp_path / "flow.plt", samples.settings(**TECPLOT, zones=[zone]), rtol=CELL_RTOL)
    assert 0.1 < line.attrs["exit_distance"] < 0.2


def test_tecplot_ordered_zone_with_fortran_exponents(tmp_path):
    (tmp_path / "flow.dat").write_text(samples.tecplot_ordered())
    check(tmp_path / "flow.dat", samples.settings(), rtol=1e-9)


def test_tecplot_ordered_volume_with_values_in_cells(tmp_path):
    x, y, z = (np.linspace(0, end, count) for end, count in ((0.3, 5), (0.1, 4), (0.1, 3)))
    grid = [part.transpose(2, 1, 0).ravel() for part in np.meshgrid(x, y, z, indexing="ij")]
    centre = np.meshgrid(*[(part[1:] + part[:-1]) / 2 for part in (x, y, z)], indexing="ij")
    centre = [part.transpose(2, 1, 0).ravel() for part in centre]
    blocks = [*grid, samples.temperature(*centre), samples.pressure(*centre)]
    text = 'VARIABLES = "x" "y"\n"z" "T" "p"\nZONE T="box" I=5 J=4 K=3\n'
    text += "DATAPACKING=BLOCK, VARLOCATION=([4,5]=CELLCENTERED)\n" + "\n".join(map(samples.lines_of, blocks))
    (tmp_path / "flow.dat").write_text(text + "\n")
    check(tmp_path / "flow.dat", samples.settings("three_dimensional"), rtol=CELL_RTOL)


SU2 = {
    "variables": {
        "temperature": {"name": "Temperature", "unit": "K"},
        "pressure": {"name": "Pressure", "unit": "Pa"},
    }
}


@pytest.mark.parametrize("maker", ["in order", "shuffled", "binary"])
def test_su2_restart_with_its_mesh(tmp_path, maker):
    points, cells = samples.triangles()
    (tmp_path / "mesh.su2").write_text(samples.su2_mesh(points, cells))
    restart = tmp_path / "restart.dat"
    if maker == "binary":
        restart.write_bytes(samples.su2_restart_binary(points))
    else:
        order = np.random.default_rng(1).permutation(len(points)) if maker == "shuffled" else None
        restart.write_text(samples.su2_restart_text(points, order))
    check(restart, samples.settings(**SU2), mesh=tmp_path / "mesh.su2")


def test_su2_quadrilaterals_and_the_older_restart_text(tmp_path):
    points, cells = samples.quads()
    (tmp_path / "mesh.su2").write_text(samples.su2_mesh(points, cells, code=9))
    old = samples.su2_restart_text(points).replace(", ", "\t") + "EXT_ITER= 250\nAOA= 0\n"
    (tmp_path / "restart.dat").write_text(old)
    check(tmp_path / "restart.dat", samples.settings(**SU2), mesh=tmp_path / "mesh.su2")


def test_scattered_points(tmp_path):
    points, _ = samples.triangles()
    (tmp_path / "points.csv").write_text(samples.scattered(points))
    check(tmp_path / "points.csv", samples.settings())


def test_scattered_points_in_space(tmp_path):
    points = np.random.default_rng(2).uniform(size=(200, 3)) * [0.3, 0.1, 0.1]
    rows = [f"{x};{y};{z};{samples.pressure(x, y, z)};{samples.temperature(x, y, z)}" for x, y, z in points]
    (tmp_path / "points.csv").write_text("x;y;z;p;T\n" + "\n".join(rows) + "\n")
    mapping = samples.settings("three_dimensional")
    mapping["ray"] = {"origin": [0.1, 0.05, 0.05], "direction": [1.0, 0.1, 0.1]}
    check(tmp_path / "points.csv", mapping)


def test_a_profile_along_the_path(tmp_path):
    (tmp_path / "edge.csv").write_text("s,T,p\n0,350,5000\n2,4000,5001\n10,6000,5002\n")
    mapping = samples.settings("profile", length_unit="mm", coordinates={"distance": "s"}, ray=None)
    line = sightline(tmp_path / "edge.csv", mapping, points=60)
    assert list(line.path_distance.values) == [0, 0.002, 0.01]
    assert list(line.temperature.values) == [350, 4000, 6000]


STATE_TITLES = (
    "comment  pressure [kPa]  temperature [K]  Mach number  Total Temp [K] total enth. [kJ/kg]  Warnings:"
)
STATE_TABLE = f"""\
{STATE_TITLES}
----- Data appended at: 03:45:27 on 19/08/2024 -----
{STATE_TITLES}
Case=1     1.0000000000e+01    5.5000000000e+03    3.284e-02    5.5100000000e+03    1.2300000000e+04     None|
Case=2     5.0000000000e+00    6.1000000000e+03    4.142e-02    6.1200000000e+03    2.0000000000e+04     None|
"""


def state_settings(temperature, pressure, **state):
    rule = {"path_length": 80, "boundary_layer": 4, "wall_temperature_k": 400, **state}
    variables = {"temperature": temperature, "pressure": pressure}
    return samples.settings("state", length_unit="mm", variables=variables, state=rule, ray=None)


def test_one_state_of_a_table_of_states(tmp_path):
    (tmp_path / "run.out").write_text(STATE_TABLE)
    mapping = state_settings(
        {"name": "temperature [K]", "unit": "K"}, {"name": "pressure [kPa]", "unit": "kPa"}, row=2
    )
    line = sightline(tmp_path / "run.out", mapping, points=60)
    assert line.path_distance.values[-1] == pytest.approx(0.08, rel=1e-12)
    assert line.temperature.values[[0, 20, 40, 41]] == pytest.approx([400, 3250, 6100, 6100], rel=1e-12)
    assert line.path_distance.values[20] == pytest.approx(0.002, rel=1e-12)
    assert (line.pressure.values == 5000).all()


def test_one_state_of_lines_with_keys(tmp_path):
    (tmp_path / "run.srun").write_text("has_converged_out: yes\nT_out: 5770.5 K\nP_t_out: 6.18 kPa\n")
    mapping = state_settings({"name": "T_out", "unit": "K"}, {"value": 50, "unit": "mbar"})
    line = sightline(tmp_path / "run.srun", mapping, points=60)
    assert line.temperature.values[-1] == 5770.5
    assert line.pressure.values[-1] == 5000


def test_units_and_gauge_pressure(tmp_path):
    points, cells = samples.triangles()
    text = samples.tecplot_fepoint(points * 1e3, cells)
    (tmp_path / "flow.dat").write_text(text)
    variables = {
        "temperature": {"name": "T", "unit": "kK"},
        "pressure": {"name": "p", "unit": "mbar", "add": 50},
    }
    mapping = samples.settings(**TECPLOT, length_unit="mm", variables=variables)
    mapping["ray"] = {"origin": [290.0, 0.0], "direction": [-1.0, 0.3]}
    # The file was written with x in mm: its numbers are those of the field at 1000 x, which is linear too.
    scaled = text.splitlines()
    rows = [line.split() for line in scaled[3 : 3 + len(points)]]
    x, y = points.T
    for row, t, p in zip(rows, samples.temperature(x, y), samples.pressure(x, y), strict=True):
        row[4], row[2] = f"{t / 1e3:.12e}", f"{p / 100 - 50:.12e}"
    scaled[3 : 3 + len(points)] = [" ".join(row) for row in rows]
    (tmp_path / "flow.dat").write_text("\n".join(scaled) + "\n")
    line = sightline(tmp_path / "flow.dat", mapping, points=60)
    t = line.path_distance.values / np.hypot(1, 0.3)
    assert line.temperature.values == pytest.approx(samples.temperature(0.29 - t, 0.3 * t), rel=1e-9, abs=0)
    assert line.pressure.values == pytest.approx(samples.pressure(0.29 - t, 0.3 * t), rel=1e-9, abs=0)
