"""`plasmapyro sightline`, and conditions that bring their own flow field, as a user meets them."""

import shutil
from pathlib import Path

import cfd_samples as samples
import numpy as np
import pytest
import yaml
from clone import copy_of_the_project, planned, snakemake

from plasmapyro import cli, io
from plasmapyro.sightline import neqair

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def folder(tmp_path):
    shutil.copy(samples.FILES / "mixed_ascii.vtu", tmp_path / "flow.vtu")
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(samples.settings()))
    return tmp_path


def run(folder, *words):
    return cli.main(["sightline", *(str(folder / word) if "." in word else word for word in words)])


def test_a_flow_field_becomes_a_sight_line(folder):
    arguments = ("flow.vtu", "--map", "map.yaml", "--points", "60")
    assert run(folder, *arguments, "--out", "a.nc", "--line-of-sight-text", "LOS.dat") == 0
    line = io.read(folder / "a.nc", "sightline")
    x, y, _ = samples.along(line, samples.settings())
    assert line.temperature.values == pytest.approx(samples.temperature(x, y), rel=1e-10, abs=0)
    assert line.attrs["origin"] == "modelled" and "leaves the field" in line.attrs["path_status"]
    assert [row.split()[1].rpartition("/")[2] for row in line.attrs["sources"].splitlines()] == [
        "flow.vtu",
        "map.yaml",
    ]
    text = neqair.parse((folder / "LOS.dat").read_text())
    assert float(text.temperature[-1]) == pytest.approx(float(line.temperature[-1]), rel=1e-8)
    assert run(folder, *arguments, "--out", "b.nc") == 0
    assert (folder / "a.nc").read_bytes() == (folder / "b.nc").read_bytes()


@pytest.mark.parametrize(("unit", "length"), [("m", None), ("mm", "0.303"), ("in", "7.69")])
def test_a_length_unit_that_makes_an_implausible_path_is_doubted(folder, capsys, unit, length):
    (folder / "map.yaml").write_text(yaml.safe_dump(samples.settings(length_unit=unit)))
    assert run(folder, "flow.vtu", "--map", "map.yaml", "--points", "30", "--out", "a.nc") == 0
    said = capsys.readouterr()
    assert said.out.startswith(f"line of sight: {length or 302.8}"[:19]) and "hottest 2660 K" in said.out
    words = f"flow.vtu: the line of sight is {length} mm long, laboratory plasmas have 10 mm to 10 m"
    assert (words in said.err) == ("length_unit" in said.err) == (length is not None)


def test_the_spectrum_of_a_flow_field_in_two_commands(folder, capsys):
    line = ("flow.vtu", "--map", "map.yaml", "--points", "20", "--out", "a.nc", "--plot", "a.png")
    assert run(folder, *line) == 0
    assert "mole fractions: N2 0.76, O2 0.16" in capsys.readouterr().out  # `samples.settings`
    narrow = ["--wavelength-nm", "776", "779", "--grid-points", "4000", "--slit-fwhm-nm", "0.3"]
    assert (
        cli.main(
            [
                "radiance",
                str(folder / "a.nc"),
                "--out",
                str(folder / "s.nc"),
                *narrow,
                "--plot",
                str(folder / "s.png"),
            ]
        )
        == 0
    )
    found = io.read(folder / "s.nc", "spectrum")
    assert (found.gas_radiance.values > 0).all()
    whole = np.trapezoid(found.gas_radiance.values, found.wavelength.values)
    assert f"nm, {whole:.4g} W m-2 sr-1, highest" in capsys.readouterr().out
    for picture in ("a.png", "s.png"):
        assert (folder / picture).read_bytes().startswith(b"\x89PNG")


def test_an_su2_restart_needs_its_mesh(tmp_path):
    points, cells = samples.triangles()
    (tmp_path / "mesh.su2").write_text(samples.su2_mesh(points, cells))
    (tmp_path / "restart.csv").write_text(samples.su2_restart_text(points))
    names = {"temperature": ("Temperature", "K"), "pressure": ("Pressure", "Pa")}
    variables = {key: {"name": name, "unit": unit} for key, (name, unit) in names.items()}
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(samples.settings(variables=variables)))
    arguments = ("restart.csv", "--map", "map.yaml", "--out", "a.nc")
    assert run(tmp_path, *arguments, "--mesh", "mesh.su2") == 0
    assert (tmp_path / "a.nc").exists()


def test_a_body_in_the_way_is_said(tmp_path, capsys):
    points, cells = samples.triangles(21, 9, shear=0.0)
    x, y = points[cells].mean(axis=1).T
    kept = cells[~((x > 0.12) & (x < 0.18) & (y < 0.05))]
    (tmp_path / "flow.dat").write_text(samples.tecplot_fepoint(points, kept))
    mapping = samples.settings(
        coordinates={"axial": "x0", "radial": "x1"}, ray={"origin": [0.28, 0.0], "direction": [-1.0, 0.1]}
    )
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(mapping))
    assert run(tmp_path, "flow.dat", "--map", "map.yaml", "--out", "a.nc") == 0
    assert "plasmapyro: warning: the line of sight stops at a body 100.5 mm" in capsys.readouterr().err
    assert io.read(tmp_path / "a.nc", "sightline").attrs["path_end"] == "body"


def test_a_field_that_begins_away_from_the_surface_is_said(folder, capsys):
    mapping = samples.settings("planar", ray={"origin": [-0.1, 0.05], "direction": [1.0, 0.0]})
    (folder / "map.yaml").write_text(yaml.safe_dump(mapping))
    assert run(folder, "flow.vtu", "--map", "map.yaml", "--out", "a.nc") == 0
    words = "plasmapyro: warning: the line of sight begins 100 mm from its origin, where the field does"
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda folder: (folder / "flow.vtu").unlink(), "flow.vtu: no such file"),
        (lambda folder: (folder / "flow.vtu").write_text("<VTKFile"), "cannot be read as VTK"),
        (lambda folder: (folder / "map.yaml").write_text("geometry: [\n"), "not readable as YAML"),
        (lambda folder: (folder / "map.yaml").write_text("geometri: planar\n"), "did you mean 'geometry'?"),
        (lambda folder: (folder / "a.nc").mkdir(), "a.nc: is a folder"),
    ],
)
def test_bad_input_ends_with_one_message_and_nothing_written(folder, capsys, change, words):
    change(folder)
    assert run(folder, "flow.vtu", "--map", "map.yaml", "--out", "a.nc") == 2
    message = capsys.readouterr().err
    assert words in message and "Traceback" not in message
    assert not (folder / "a.nc").is_file() and not list(folder.glob("*.part"))


def own_condition(mapping, file="mine/flow.vtu"):
    return yaml.safe_dump(
        {
            "numerical_power_kw": 95,
            "chamber_pressure_mbar": 50,
            "mass_flow_rate_g_s": 16,
            "emittance": 0.85,
            "cfd": {"file": file, **mapping},
        }
    )


@pytest.fixture
def project(tmp_path):
    """A copy of the workflow with a tenth condition that brings its own flow field."""
    folder = copy_of_the_project(tmp_path / "clone")
    (folder / "mine").mkdir()
    shutil.copy(samples.FILES / "mixed_ascii.vtu", folder / "mine/flow.vtu")
    mapping = samples.settings(ray={"origin": [0.29, 0.0]})
    (folder / "config/conditions/mine.yaml").write_text(own_condition(mapping))
    return folder


def test_a_condition_with_its_own_flow_field_is_not_computed_but_shown(project):
    jobs = planned(snakemake(project, "--dry-run"))
    assert jobs["flow"] == jobs["sightline"] == 9
    assert jobs["cfd_sightline"] == 1
    assert jobs["radiance"] == 10
    assert jobs["figures_flow"] == jobs["flow_vtu"] == 1


def test_its_light_on_the_surface_is_a_target_too(project):
    jobs = planned(snakemake(project, "--dry-run", "results/reflection/mine.nc"))
    assert jobs["cfd_surface_view"] == jobs["reflected_radiance"] == 1
    assert "flow" not in jobs and "surface_view" not in jobs


def test_its_sight_line_reaches_the_instrument(project):
    result = snakemake(project, "results/sightline/mine.nc")
    assert result.returncode == 0, result.stdout + result.stderr
    line = io.read(project / "results/sightline/mine.nc", "sightline")
    exit_distance = 0.1 / np.sin(np.radians(35))  # sightline.angle_deg of the configuration
    assert line.attrs["exit_distance"] == pytest.approx(exit_distance, rel=1e-9)
    assert line.attrs["window_distance"] == 0.8
    assert line.path_distance.values[-1] == 1.0
    inside = line.path_distance.values <= line.attrs["exit_distance"]
    x, r = 0.29 - line.path_distance.values * np.cos(np.radians(35)), line.radial_position.values
    assert line.temperature.values[inside] == pytest.approx(samples.temperature(x, r)[inside], rel=1e-10)
    chamber = ~inside & (line.path_distance.values <= 0.8)
    assert set(line.temperature.values[chamber]) == {line.temperature.values[inside][-1]}
    assert line.temperature.values[-1] == 300 and line.pressure.values[-1] == 101325
    assert "mine/flow.vtu" in line.attrs["sources"]
    again = snakemake(project, "--dry-run", "results/sightline/mine.nc")
    assert "Nothing to be done" in again.stdout + again.stderr


def test_without_computed_conditions_no_flow_is_computed(project):
    for path in (project / "config/conditions").glob("*kW.yaml"):
        text = own_condition(samples.settings(ray={"origin": [0.29, 0.0]}))
        path.write_text(text.replace("95", path.stem.removesuffix("kW")))
    jobs = planned(snakemake(project, "--dry-run"))
    assert jobs["cfd_sightline"] == jobs["radiance"] == 10
    assert not {"flow", "flow_start", "sightline", "figures_flow", "flow_vtu"} & set(jobs)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("length_unit:", "lenght_unit:", "unknown key 'lenght_unit'; did you mean 'length_unit'?"),
        ("unit: Pa", "unit: psi", "unknown unit 'psi' of a pressure; known: Pa"),
        ("mine/flow.vtu", "mine/other.vtu", "mine/other.vtu"),
    ],
)
def test_a_wrong_map_stops_before_the_first_job(project, old, new, message):
    path = project / "config/conditions/mine.yaml"
    path.write_text(path.read_text().replace(old, new))
    result = snakemake(project)
    assert result.returncode != 0
    assert message in result.stdout + result.stderr
    assert not list(project.glob("results/**/*.nc"))


def test_the_field_that_is_drawn_must_be_computed(project):
    path = project / "config/config.yaml"
    path.write_text(path.read_text().replace("field_condition: 90kW", "field_condition: mine"))
    result = snakemake(project, "--dry-run")
    assert result.returncode != 0
    assert "figures.field_condition: 'mine' brings its own flow field (cfd)" in result.stdout + result.stderr
