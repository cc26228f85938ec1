"""The maps of docs/power-conditions.md run as they stand there."""

import re
import shutil
from pathlib import Path

import cfd_samples as samples
import pytest
import yaml
from test_cfd_formats import STATE_TABLE

from plasmapyro import configuration
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


def test_the_condition_of_the_page_fits_its_schemas():
    text = re.search(r"```yaml condition\n(.*?)```", PAGE, re.DOTALL)[1]
    condition = configuration.check(yaml.safe_load(text), ROOT / "config/schema_condition.yaml", "the page")
    assert check_conditions({"mine": condition}) == ["mine"]


def test_the_page_names_every_unit_and_format():
    schema = yaml.safe_load(SCHEMA.read_text())
    for word in (*schema["properties"]["format"]["enum"], *schema["properties"]["geometry"]["enum"]):
        assert f"`{word}`" in PAGE
