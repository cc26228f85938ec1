"""Broken files and maps: one clear message each, that says what to do."""

import re

import cfd_samples as samples
import numpy as np
import pytest

from plasmapyro import configuration
from plasmapyro.cfd.mapping import SCHEMA, check_conditions, parse
from plasmapyro.cfd.stage import sightline

TECPLOT = {"coordinates": {"axial": "x0", "radial": "x1"}}


def refusal(path, mapping, mesh=None):
    with pytest.raises(ValueError) as caught:
        sightline(path, mapping, points=60, mesh=mesh)
    return str(caught.value)


def truncated(path, share, folder):
    content = path.read_bytes()
    (folder / path.name).write_bytes(content[: int(len(content) * share)])
    return folder / path.name


@pytest.mark.parametrize("share", [0.05, 0.5, 0.9])
@pytest.mark.parametrize(
    "name",
    [
        "mixed_ascii.vtu",
        "mixed_appended_raw.vtu",
        "mixed_appended_base64.vtu",
        "mixed_binary_lzma.vtu",
        "mixed_binary.vtk",
        "mixed_ascii.vtk",
        "structured.cgns",
        "unstructured.cgns",
    ],
)
def test_a_file_that_is_cut_off(tmp_path, name, share):
    message = refusal(truncated(samples.FILES / name, share, tmp_path), samples.settings())
    assert name in message and "\n" not in message
    assert "cut off" in message or "has no variable" in message


@pytest.mark.parametrize("share", [0.3, 0.7, 0.97])
def test_tecplot_text_that_is_cut_off(tmp_path, share):
    text = samples.tecplot_fepoint(*samples.triangles())
    (tmp_path / "flow.dat").write_text(text[: int(share * len(text))])
    message = refusal(tmp_path / "flow.dat", samples.settings(**TECPLOT))
    assert "needs 319 numbers (35 nodes, 48 cells, 5 variables)" in message
    assert "cut off" in message and ", line " in message


def test_tecplot_node_count_that_is_wrong(tmp_path):
    text = samples.tecplot_fepoint(*samples.triangles()).replace("N=35", "N=36")
    (tmp_path / "flow.dat").write_text(text)
    assert "the counts in its header are wrong" in refusal(tmp_path / "flow.dat", samples.settings(**TECPLOT))


def test_tecplot_cell_that_names_no_node(tmp_path):
    text = samples.tecplot_fepoint(*samples.triangles())
    lines = text.splitlines()
    lines[-1] = "1 2 99"
    (tmp_path / "flow.dat").write_text("\n".join(lines) + "\n")
    message = refusal(tmp_path / "flow.dat", samples.settings(**TECPLOT))
    assert "cell 48 of zone 'P0 ZONE0 Triag' names node 99 of 35" in message


def test_tecplot_word_among_the_numbers(tmp_path):
    text = samples.tecplot_fepoint(*samples.triangles())
    lines = text.splitlines()
    lines[5] = lines[5].replace(" 1.0 ", " ***** ")
    (tmp_path / "flow.dat").write_text("\n".join(lines) + "\n")
    assert "line 6: '*****' is not a number" in refusal(tmp_path / "flow.dat", samples.settings(**TECPLOT))


def test_tecplot_binary(tmp_path):
    (tmp_path / "flow.plt").write_bytes(b"#!TDV112\x01\x00\x00\x00\x00\x00\x00\x00" * 5)
    assert "binary" in refusal(tmp_path / "flow.plt", samples.settings(**TECPLOT))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("ET=TRIANGLE", "ET=POLYGON", "is of kind POLYGON"),
        ("F=FEPOINT", "F=FEPOINT, CONNECTIVITYSHAREZONE=1", "shares data (CONNECTIVITYSHAREZONE)"),
        ("N=35, ", "", "has no N= with a number"),
        ("ZONE ", "# ZONE ", "numbers stand before the first ZONE"),
        ("VARIABLES ", "# VARIABLES ", "a ZONE without VARIABLES before it"),
    ],
)
def test_tecplot_headers_that_are_not_read(tmp_path, old, new, words):
    text = samples.tecplot_fepoint(*samples.triangles())
    assert old in text
    (tmp_path / "flow.dat").write_text(text.replace(old, new, 1))
    assert words in refusal(tmp_path / "flow.dat", samples.settings(**TECPLOT))


def su2(tmp_path, mesh=None, restart=None):
    points, cells = samples.triangles()
    (tmp_path / "mesh.su2").write_text(mesh or samples.su2_mesh(points, cells))
    content = restart or samples.su2_restart_text(points)
    path = tmp_path / "restart.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    variables = {
        "temperature": {"name": "Temperature", "unit": "K"},
        "pressure": {"name": "Pressure", "unit": "Pa"},
    }
    return refusal(path, samples.settings(variables=variables), tmp_path / "mesh.su2")


def test_su2_restart_of_another_mesh(tmp_path):
    points, cells = samples.triangles()
    message = su2(tmp_path, restart=samples.su2_restart_text(samples.triangles(6, 5)[0]))
    assert "holds 30 points, the mesh" in message and "has 35" in message


def test_su2_files_that_are_cut_off(tmp_path):
    points, cells = samples.triangles()
    mesh, text = samples.su2_mesh(points, cells), samples.su2_restart_text(points)
    binary = samples.su2_restart_binary(points)
    assert "has no line NPOIN= with a number; it may be cut off" in su2(tmp_path, mesh=mesh[:500])
    assert "the file is cut off" in su2(tmp_path, mesh=mesh[: len(mesh) // 2])
    assert "cut off" in su2(tmp_path, restart=text[: len(text) - 60])
    assert "holds 17 points" in su2(tmp_path, restart=text[: text.index("\n17,") + 1])
    assert "its header asks for" in su2(tmp_path, restart=binary[: len(binary) // 2])


def test_su2_cell_that_names_no_point(tmp_path):
    points, cells = samples.triangles()
    cells = cells.copy()
    cells[3, 1] = 70
    assert "a cell names point 70 of 35" in su2(tmp_path, mesh=samples.su2_mesh(points, cells))


@pytest.mark.parametrize(
    "name",
    ["mixed_ascii.vtu", "mixed_appended_raw.vtu", "mixed_binary.vtk", "unstructured.cgns", "block.dat"],
)
def test_any_damage_gives_a_sight_line_or_one_message(tmp_path, name):
    content = samples.tecplot_block().encode() if name == "block.dat" else (samples.FILES / name).read_bytes()
    mapping = samples.settings(**(TECPLOT if name == "block.dat" else {}))
    generator = np.random.default_rng(7)
    for _ in range(12):
        damaged = bytearray(content)
        for place in generator.integers(0, len(content), 5):
            damaged[place] = generator.integers(0, 256)
        (tmp_path / name).write_bytes(damaged[: generator.integers(len(content) // 2, 2 * len(content))])
        try:
            line = sightline(tmp_path / name, mapping, points=30)
        except ValueError as message:
            assert str(message)
        else:
            assert np.isfinite(line.temperature).all()


QUADS = samples.quads()[1]


@pytest.mark.parametrize(
    ("types", "words"),
    [
        ([7] * 12 + [9] * 12, "holds cells of kind polygon, which are not read"),
        ([9] * 12 + [8] * 12, "holds cells of kind pixel, which are not read"),
        ([10] * 24, "holds volumes (tetra), not a plane; set `geometry: three_dimensional`"),
    ],
)
def test_cells_that_would_leave_a_hole_are_refused(tmp_path, types, words):
    (tmp_path / "flow.vtu").write_text(samples.vtu_text(QUADS, types))
    message = refusal(tmp_path / "flow.vtu", samples.settings())
    assert words in message and "\n" not in message


def test_the_grid_of_the_refusals_is_good(tmp_path):
    (tmp_path / "flow.vtu").write_text(samples.vtu_text(QUADS, [9] * 24))
    line = sightline(tmp_path / "flow.vtu", samples.settings(), points=60)
    x, y, _ = samples.along(line, samples.settings())
    assert line.temperature.values == pytest.approx(samples.temperature(x, y), rel=1e-10, abs=0)


def test_a_cell_of_a_vtk_file_that_names_no_node(tmp_path):
    cells = QUADS.copy()
    cells[3, 2] = 99
    (tmp_path / "flow.vtu").write_text(samples.vtu_text(cells, [9] * 24))
    assert "quad 4 of zone 'flow' names node 100 of 35" in refusal(tmp_path / "flow.vtu", samples.settings())


def test_fewer_values_than_nodes_in_a_vtk_file(tmp_path):
    text = samples.vtu_text(QUADS, [9] * 24).replace('NumberOfPoints="35"', 'NumberOfPoints="36"')
    (tmp_path / "flow.vtu").write_text(text)
    assert "cannot be read as VTK" in refusal(tmp_path / "flow.vtu", samples.settings())


def test_a_node_without_coordinates(tmp_path):
    text = samples.scattered(samples.triangles()[0]).replace("0.3,0.0,", "nan,0.0,")
    assert "nan" in text
    (tmp_path / "flow.csv").write_text(text)
    assert "of zone 'table' has no finite coordinates" in refusal(tmp_path / "flow.csv", samples.settings())


@pytest.mark.parametrize("ending", ["pvtu", "vtm", "szplt", "foam"])
def test_kinds_of_files_that_are_not_read_say_what_to_do(tmp_path, ending):
    (tmp_path / f"flow.{ending}").write_text("x")
    message = refusal(tmp_path / f"flow.{ending}", samples.settings())
    assert f"is of a kind that is not read (.{ending}); save it as one .vtu file" in message


def test_su2_needs_its_mesh(tmp_path):
    points, _ = samples.triangles()
    (tmp_path / "restart.csv").write_text(samples.su2_restart_text(points))
    message = refusal(tmp_path / "restart.csv", samples.settings(format="su2"))
    assert "name the SU2 mesh" in message


def test_a_missing_variable_is_named_with_what_there_is():
    mapping = samples.settings(
        variables={"temperature": {"name": "Temp", "unit": "K"}, "pressure": {"name": "p", "unit": "Pa"}}
    )
    message = refusal(samples.FILES / "mixed_ascii.vtu", mapping)
    assert "has no variable 'Temp' (temperature)" in message
    assert "'T', 'p', 'U_x', 'U_y', 'U_z'" in message


@pytest.mark.parametrize("bad", ["nan", "inf"])
def test_a_value_that_is_no_number_on_the_line_of_sight(tmp_path, bad):
    points, cells = samples.triangles()
    lines = samples.tecplot_fepoint(points, cells).splitlines()
    for k in range(3, 3 + len(points)):
        if points[k - 3, 0] < 0.1:
            lines[k] = lines[k].rpartition(" ")[0] + f" {bad}"
    (tmp_path / "flow.dat").write_text("\n".join(lines) + "\n")
    message = refusal(tmp_path / "flow.dat", samples.settings(**TECPLOT))
    assert "temperature is not a number (NaN or infinite) in the file near (" in message


def test_not_a_number_away_from_the_line_of_sight_does_no_harm(tmp_path):
    points, cells = samples.triangles()
    lines = samples.tecplot_fepoint(points, cells).splitlines()
    lines[3 + 6] = lines[3 + 6].rpartition(" ")[0] + " nan"  # the corner x = 0.3 m, y = 0
    (tmp_path / "flow.dat").write_text("\n".join(lines) + "\n")
    mapping = samples.settings(**TECPLOT, ray={"origin": [0.1, 0.0], "direction": [-1.0, 0.3]})
    line = sightline(tmp_path / "flow.dat", mapping, points=60)
    x, y, _ = samples.along(line, mapping)
    assert line.temperature.values == pytest.approx(samples.temperature(x, y), rel=1e-9, abs=0)


def test_a_ray_outside_the_field():
    mapping = samples.settings(ray={"origin": [2.0, 0.0], "direction": [1.0, 0.1]})
    message = refusal(samples.FILES / "mixed_ascii.vtu", mapping)
    assert "misses the flow field, which reaches from (0.0, 0.0) to (0.3, 0.1) m" in message


@pytest.mark.parametrize(
    ("name", "changes", "words"),
    [
        ("mixed_ascii.vtu", {"geometry": "three_dimensional"}, "holds no cells of a three_dimensional field"),
        ("half_block.vtu", {}, "holds volumes (hexahedron), not a plane"),
        ("mixed_ascii.vtu", {"zones": ["inlet"]}, "has no zone 'inlet'; zones are 1: 'mixed_ascii'"),
        ("mixed_ascii.vtu", {"format": "cgns"}, "cannot be read as CGNS in HDF5"),
        ("README.md", {}, "is of a kind that its name does not tell (.md)"),
        ("nothing.vtu", {}, "no such file"),
    ],
)
def test_files_and_maps_that_do_not_belong_together(name, changes, words):
    mapping = {**samples.settings(), **changes}
    if mapping["geometry"] == "three_dimensional":
        mapping["ray"] = samples.settings("three_dimensional")["ray"]
    assert words in refusal(samples.FILES / name, mapping)


def test_tables_that_are_cut_off_or_hold_words(tmp_path):
    points, _ = samples.triangles()
    text = samples.scattered(points)
    (tmp_path / "a.csv").write_text(text[: text.rindex(",")] + "\n")
    assert "3 cells, the header has 4" in refusal(tmp_path / "a.csv", samples.settings())
    (tmp_path / "b.csv").write_text(re.sub(r",[^,\n]*\n$", ",hot\n", text))
    assert "'hot' in column 'T' is not a number" in refusal(tmp_path / "b.csv", samples.settings())
    (tmp_path / "c.csv").write_text("x,y,p,T\n")
    assert "holds a header and no row" in refusal(tmp_path / "c.csv", samples.settings())
    (tmp_path / "d.csv").write_text("x,y,p,T\n0,0,1,1\n1,0,1,1\n2,0,1,1\n3,0,1,1\n")
    assert "cannot be joined to triangles" in refusal(tmp_path / "d.csv", samples.settings())


def test_a_wrong_unit_shows_in_the_range():
    """A field in kK read as K is colder than any gas."""
    variables = {"temperature": {"name": "N2", "unit": "K"}, "pressure": {"name": "p", "unit": "Pa"}}
    message = refusal(samples.FILES / "mixed_ascii.vtu", samples.settings(variables=variables))
    assert "temperature must lie in [100, 30000] K; got 0.6 K" in message


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"geometri": "planar"}, "unknown key 'geometri'; did you mean 'geometry'?"),
        ({"length_unit": "feet"}, "length_unit: 'feet' is not one of"),
        ({"species": "LTE"}, "species: 'LTE' does not match '^equilibrium$'"),
        ({"mirror": {"radial": 0}}, "'radial' is not one of ['x', 'y', 'z']"),
        (
            {"species": {"quantity": "mole_fraction", "unit": "1", "names": {"He": "xHe"}}},
            "species.names: 'He' is not one of",
        ),
    ],
)
def test_the_schema_of_a_map(change, words):
    with pytest.raises(configuration.ConfigurationError) as caught:
        configuration.check({**samples.settings(), **change}, SCHEMA, "map.yaml")
    assert words in str(caught.value)


def test_every_sample_map_fits_the_schema():
    for geometry in ("axisymmetric", "planar", "three_dimensional"):
        configuration.check(samples.settings(geometry), SCHEMA, geometry)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            {"variables": {**samples.STATE, "temperature": {"name": "T", "unit": "F"}}},
            "variables.temperature: unknown unit 'F' of a temperature; known: K, kK, degC, C",
        ),
        ({"variables": {**samples.STATE, "density": {"unit": "kg m-3"}}}, "give name or value, one of them"),
        ({"coordinates": {"z": "w"}}, "coordinates.z: a axisymmetric field has axial, radial"),
        ({"mirror": {"y": 0}}, "mirror is for planar and three_dimensional fields"),
        ({"ray": {}}, "ray.origin is missing"),
        ({"ray": {"origin": [0, 0], "direction": [0, 0]}}, "must hold 2 coordinates, not all 0"),
        ({"ray": {"origin": [0, 0], "direction": [1, 0], "angle_deg": 3}}, "not both"),
        ({"geometry": "planar", "ray": {"origin": [0, 0, 0]}}, "ray.origin must hold 2 coordinates; got 3"),
        ({"geometry": "three_dimensional", "ray": {"origin": [0, 0, 0]}}, "ray.direction is missing"),
        ({"geometry": "profile", "ray": {}}, "coordinates.distance is missing"),
        ({"geometry": "profile"}, "ray: a profile is its own path"),
        ({"geometry": "state", "ray": {}}, "state and geometry: state belong together"),
        ({"excitation": "electron_temperature"}, "excitation: variables.electron_temperature is missing"),
        (
            {
                "variables": {
                    **samples.STATE,
                    "vibrational_temperature": {"name": "Tv", "unit": "K"},
                    "electron_temperature": {"name": "Te", "unit": "K"},
                }
            },
            "excitation is missing",
        ),
    ],
)
def test_maps_that_contradict_themselves(change, words):
    with pytest.raises(ValueError, match="the map does not fit together") as caught:
        parse({**samples.settings(), **change})
    assert words in str(caught.value)


def test_a_condition_is_named_when_its_map_is_wrong():
    good = {"file": "flow.vtu", **samples.settings()}
    assert check_conditions({"a": {}, "b": {"cfd": good}}) == ["b"]
    with pytest.raises(configuration.ConfigurationError, match="(?s)cfd of condition b.*unknown key 'foo'"):
        check_conditions({"b": {"cfd": {**good, "foo": 1}}})
    with pytest.raises(configuration.ConfigurationError, match="cfd of condition b: the map does not fit"):
        check_conditions({"b": {"cfd": {**good, "coordinates": {"z": "w"}}}})
