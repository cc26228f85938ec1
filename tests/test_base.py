"""Guards, tables, contracts and files refuse what is wrong, and say all of it."""

import hashlib
import json

import numpy as np
import pytest
import xarray as xr
from scipy.constants import physical_constants

from plasmapyro import checks, constants, contracts, io, tables


def sightline():
    return xr.Dataset(
        {
            "temperature": ("path_distance", [350.0, 6000.0]),
            "pressure": ("path_distance", [5000.0, 5000.0]),
            "number_density": (("species", "path_distance"), np.ones((2, 2))),
        },
        {"path_distance": [0.0, 0.1], "species": ["N2", "O2"]},
    )


def surface():
    return xr.Dataset(
        {"surface_radiance": (("object_temperature", "wavelength"), [[1.0, 2.0]])},
        {"object_temperature": [1000.0], "wavelength": [8e-7, 9e-7]},
    )


def test_round_trip_is_identical(tmp_path):
    io.write(sightline(), tmp_path / "a.nc", "sightline")
    first = io.read(tmp_path / "a.nc", "sightline")
    io.write(first.copy(), tmp_path / "b.nc", "sightline")
    xr.testing.assert_identical(first, io.read(tmp_path / "b.nc", "sightline"))


def test_same_content_gives_the_same_bytes(tmp_path):
    for name in ("a.nc", "b.nc"):
        io.write(sightline(), tmp_path / name, "sightline", config={"b": 1, "a": 2})
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_the_configuration_is_kept_with_the_file(tmp_path):
    config = {"grid_points": 4000, "angle": 35.0, "nested": {"bands": ["wide", "narrow"]}}
    io.write(sightline(), tmp_path / "a.nc", "sightline", config=config)
    assert json.loads(io.read(tmp_path / "a.nc", "sightline").attrs["configuration"]) == config
    io.write(sightline(), tmp_path / "b.nc", "sightline")
    assert json.loads(io.read(tmp_path / "b.nc", "sightline").attrs["configuration"]) == {}


def test_all_breaches_are_listed_together():
    bad = contracts.label(sightline(), "sightline").drop_vars("pressure")
    bad["temperature"] = bad.temperature * np.nan
    bad["path_distance"] = bad.path_distance.assign_attrs(units="mm")
    bad["number_density"] = bad.number_density.transpose()
    with pytest.raises(contracts.ContractError) as refusal:
        contracts.check(bad, "sightline")
    for fault in ("pressure: missing", "units 'mm'", "number_density: dims", "temperature: "):
        assert fault in str(refusal.value)


def test_impossible_value_is_refused_before_anything_is_written(tmp_path):
    bad = sightline()
    bad["temperature"] = -bad.temperature
    with pytest.raises(contracts.ContractError, match="temperature: -350 K outside"):
        io.write(bad, tmp_path / "a.nc", "sightline")
    assert not list(tmp_path.iterdir())


def test_files_written_together_are_all_there_or_none(tmp_path):
    good = tmp_path / "b.nc", io.labelled(surface(), "surface_radiance")
    sound = io.labelled(sightline(), "sightline")
    (tmp_path / "a.nc").mkdir()
    with pytest.raises(io.StorageError):
        io.write_labelled([good, (tmp_path / "a.nc", sound)])
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]
    (tmp_path / "a.nc").rmdir()
    io.write_labelled([good, (tmp_path / "a.nc", sound)])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "b.nc"]


def test_a_source_weakens_the_origin_for_good(tmp_path):
    twin = sightline().assign_attrs(origin="synthetic")
    io.write(twin, tmp_path / "twin.nc", "sightline")
    io.write(sightline(), tmp_path / "made.nc", "sightline", sources=[tmp_path / "twin.nc"])
    assert io.read(tmp_path / "made.nc", "sightline").attrs["origin"] == "synthetic"


def test_a_truncated_file_is_named(tmp_path):
    io.write(sightline(), tmp_path / "a.nc", "sightline")
    (tmp_path / "a.nc").write_bytes((tmp_path / "a.nc").read_bytes()[:2000])
    with pytest.raises(contracts.ContractError, match=r"a\.nc: not a readable netCDF file"):
        io.read(tmp_path / "a.nc", "sightline")


def test_every_variable_is_in_some_dataset_and_back():
    used = {name.rstrip("?") for names in contracts.DATASETS.values() for name in names}
    assert used == set(contracts.VARIABLES)


def test_a_name_stands_once_in_the_register_and_its_range_is_one():
    rows = tables.rows("contracts/variables.csv")
    assert len(rows) == len(contracts.VARIABLES)
    assert all(row["unit"] and row["meaning"] and row["may be missing"] in ("", "yes") for row in rows)
    assert all(rule.low < rule.high for rule in contracts.VARIABLES.values())


def test_a_name_stands_once_in_a_contract():
    for contract in contracts.DATASETS:
        rows = [row for row in tables.rows("contracts/datasets.csv") if row["contract"] == contract]
        names = [name.rstrip("?") for row in rows for name in row["variables"].split()]
        assert len(names) == len(set(names)), contract


@pytest.mark.parametrize("bad", [0.0, -5.0, np.nan, np.inf])
def test_guards_name_the_culprit(bad):
    with pytest.raises(ValueError, match=r"pressure must be > 0 Pa; got .* Pa at index \(1,\)"):
        checks.positive("pressure", [300.0, bad], "Pa")


def test_unsorted_axis_is_shown_where_it_breaks():
    with pytest.raises(ValueError, match="got 2 m then 1 m at index 2"):
        checks.increasing("path_distance", [0.0, 2.0, 1.0], "m")


def all_tables():
    folder = tables.files("plasmapyro") / "data"
    return sorted(str(path.relative_to(folder).with_suffix("")) for path in folder.rglob("*.csv"))


@pytest.mark.parametrize("name", all_tables())
def test_every_table_has_a_valid_certificate(name):
    table = tables.load(name)
    assert table.origin in tables.ORIGINS
    assert len({len(column) for column in table.columns.values()}) == 1


def test_a_changed_table_is_refused(tmp_path, monkeypatch):
    (tmp_path / "data").mkdir()
    content = "width [nm]\n1.5\n"
    (tmp_path / "data" / "t.csv").write_text(content)
    keys = "\n".join(f"{key}: x" for key in sorted(tables.CERTIFICATE_KEYS - {"sha256", "origin"}))
    digest = hashlib.sha256(content.encode()).hexdigest()
    (tmp_path / "data" / "t.yml").write_text(f"{keys}\norigin: measured\nsha256: {digest}\n")
    monkeypatch.setattr(tables, "files", lambda _: tmp_path)
    assert tables.load("t")["width"][0] == pytest.approx(1.5e-9, rel=1e-15, abs=0)
    (tmp_path / "data" / "t.csv").write_text("width [nm]\n1.6\n")
    with pytest.raises(ValueError, match="was changed"):
        tables.load("t")
    with pytest.raises(ValueError, match="no certificate"):
        (tmp_path / "data" / "u.csv").write_text(content)
        tables.load("u")


@pytest.mark.parametrize(
    ("name", "of_scipy"),
    {
        "AVOGADRO": "Avogadro constant",
        "MOLAR_GAS": "molar gas constant",
        "RYDBERG": "Rydberg constant",
        "ATOMIC_MASS": "atomic mass constant",
        "LIGHT_SPEED": "speed of light in vacuum",
        "ELEMENTARY_CHARGE": "elementary charge",
        "ELECTRON_VOLT": "electron volt",
        "VACUUM_PERMITTIVITY": "vacuum electric permittivity",
        "PLANCK": "Planck constant",
        "BOLTZMANN": "Boltzmann constant",
        "ELECTRON_MASS": "electron mass",
        "VACUUM_PERMEABILITY": "vacuum mag. permeability",
        "BOHR_RADIUS": "Bohr radius",
    }.items(),
)
def test_constants_are_those_of_codata(name, of_scipy):
    assert getattr(constants, name) == physical_constants[of_scipy][0]
