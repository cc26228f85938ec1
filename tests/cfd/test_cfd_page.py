"""The maps of docs/power-conditions.md run as they stand there."""

import re
import shlex
import shutil
from pathlib import Path

import cfd_samples as samples
import numpy as np
import pytest
import yaml
from test_cfd_formats import STATE_TABLE

from plasmapyro import cli, configuration, io
from plasmapyro.cfd import map_of
from plasmapyro.cfd.mapping import SCHEMA, check_conditions
from plasmapyro.cfd.stage import sightline

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "power-conditions.md").read_text("utf-8")
MAPS = re.findall(r"```yaml map (\w+) (\S+)\n(.*?)```", PAGE, re.DOTALL)
TWO = "s,T,Tv,Te,p,xN2,xN,xNp\n0,3000,5000,5200,5000,0.5,0.4,0.05\n0.1,4000,6000,6200,5000,0.5,0.4,0.05\n"


def test_the_page_has_its_maps():
    assert [name for name, _, _ in MAPS] == [
        "three_dimensional",
        "coolfluid",
        "species",
        "temperatures",
        "state",
    ]


@pytest.mark.parametrize(("name", "file", "text"), MAPS, ids=[name for name, _, _ in MAPS])
def test_a_map_of_the_page_runs(tmp_path, name, file, text):
    path = tmp_path / file
    if (samples.FILES / file).exists():
        shutil.copy(samples.FILES / file, path)
    else:
        path.write_text({"flow.plt": samples.tecplot_block(), "two.csv": TWO, "run.out": STATE_TABLE}[file])
    mapping = configuration.check(yaml.safe_load(text), SCHEMA, name)
    line = sightline(path, mapping, points=60)
    assert (line.temperature > 300).all() and (line.number_density.sum("species") > 0).all()
    if name == "coolfluid":
        assert line.pressure.values.min() > 9000
    if name == "temperatures":
        assert list(line.excitation_temperature.values) == [5200, 6200]


def test_the_condition_of_the_page_fits_its_schemas_and_runs():
    text = re.search(r"```yaml condition\n(.*?)```", PAGE, re.DOTALL)[1]
    condition = configuration.check(yaml.safe_load(text), ROOT / "config/schema_condition.yaml", "the page")
    assert check_conditions({"mine": condition}) == ["mine"]
    assert condition["cfd"]["file"] == "mine/flow.vtu"
    line = sightline(samples.FILES / "mixed_ascii.vtu", map_of(condition), points=60, angle=np.radians(35))
    assert line.attrs["exit_distance"] == pytest.approx(0.1 / np.sin(np.radians(35)), rel=1e-9)


def test_the_commands_of_the_page_run(tmp_path, monkeypatch, capsys):
    """Word for word; the spectrum over 3 nm of its range, since all of it takes a minute."""
    (block,) = (one for one in re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL) if "sightline" in one)
    commands = [shlex.split(line, comments=True) for line in block.splitlines()]
    assert [words[:2] for words in commands] == [["plasmapyro", "sightline"], ["plasmapyro", "radiance"]]
    monkeypatch.chdir(tmp_path)
    shutil.copy(samples.FILES / "mixed_ascii.vtu", "flow.vtu")
    Path("map.yaml").write_text(re.search(r"```yaml map species \S+\n(.*?)```", PAGE, re.DOTALL)[1])
    assert cli.main(commands[0][1:] + ["--line-of-sight-text", "LOS.dat"]) == 0
    narrow = ["--wavelength-nm", "776", "779", "--grid-points", "4000", "--slit-fwhm-nm", "0.3"]
    assert cli.main(commands[1][1:] + narrow) == 0
    assert {path.name for path in tmp_path.iterdir()} == {
        "flow.vtu", "map.yaml", "sightline.nc", "spectrum.nc", "LOS.dat",
    }  # fmt: skip
    assert (io.read("spectrum.nc", "spectrum").gas_radiance.values > 0).all()
    assert "Traceback" not in capsys.readouterr().err


def test_the_page_names_every_unit_and_format():
    schema = yaml.safe_load(SCHEMA.read_text())
    for word in (*schema["properties"]["format"]["enum"], *schema["properties"]["geometry"]["enum"]):
        assert f"`{word}`" in PAGE
