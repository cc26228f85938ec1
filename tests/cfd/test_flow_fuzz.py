"""Thousands of damaged flow fields, maps and stage files: each ends in finite values or in one clear message.

`PLASMAPYRO_FUZZ=10000 pytest tests/cfd/test_flow_fuzz.py` spreads that many over all kinds of files.
"""

import os
import shutil
import tempfile
from pathlib import Path

import cfd_samples as samples
import numpy as np
import pytest
import yaml
from accidents import bounded, damage, no_hang  # noqa: F401 (a fixture)
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plasmapyro import configuration, contracts, io
from plasmapyro.cfd.mapping import SCHEMA
from plasmapyro.cfd.stage import sightline
from plasmapyro.commands.radiance import _read_sightline
from plasmapyro.sightline import neqair

POINTS, CELLS = samples.triangles()
TECPLOT = {"coordinates": {"axial": "x0", "radial": "x1"}}
SU2 = {
    "format": "su2",
    "variables": {
        "temperature": {"name": "Temperature", "unit": "K"},
        "pressure": {"name": "Pressure", "unit": "Pa"},
    },
}
SCATTERED = {"format": "points"}
STORED = ["mixed_ascii.vtu", "mixed_appended_raw.vtu", "mixed_appended_base64.vtu", "mixed_binary_lzma.vtu"]
STORED += ["mixed_binary.vtk", "mixed_ascii.vtk", "structured.cgns", "unstructured.cgns"]
FIELDS = {  # name -> (changes of the map, bytes, bytes of the mesh)
    **{name: ({}, (samples.FILES / name).read_bytes(), None) for name in STORED},
    "fepoint.dat": (TECPLOT, samples.tecplot_fepoint(POINTS, CELLS).encode(), None),
    "block.dat": (TECPLOT, samples.tecplot_block().encode(), None),
    "centred.dat": (
        TECPLOT,
        samples.tecplot_blocks_of_one_zone("VARLOCATION=([3-4]=CELLCENTERED)").encode(),
        None,
    ),
    "ordered.dat": ({}, samples.tecplot_ordered().encode(), None),
    "restart.csv": (SU2, samples.su2_restart_text(POINTS).encode(), samples.su2_mesh(POINTS, CELLS).encode()),
    "restart.dat": (SU2, samples.su2_restart_binary(POINTS), samples.su2_mesh(POINTS, CELLS).encode()),
    "points.csv": (SCATTERED, samples.scattered(POINTS).encode(), None),
}
RUNS = len(FIELDS) + 3
SETTINGS = settings(
    max_examples=max(int(os.environ.get("PLASMAPYRO_FUZZ", "400")) // RUNS, 10),
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
LONGEST_MESSAGE = 4000


def ends_well(work, path):
    """What `work` returns, or None after one message that names the file or says what is wrong."""
    try:
        with bounded():
            return work()
    except ValueError as refusal:
        words = str(refusal)
        assert words and len(words) < LONGEST_MESSAGE and words.replace("\n", "").isprintable(), words
        assert not isinstance(refusal, contracts.ContractError) or str(path.parent) in words, words
        return None


@pytest.mark.parametrize("name", FIELDS)
def test_a_damaged_flow_field_ends_well(name):
    changes, content, mesh = FIELDS[name]

    @SETTINGS
    @given(st.data())
    def run(data):
        with tempfile.TemporaryDirectory() as folder:
            path, beside = Path(folder) / name, Path(folder) / "mesh.su2"
            victim = data.draw(st.sampled_from(["field", "mesh"] if mesh else ["field"]))
            path.write_bytes(data.draw(damage(content)) if victim == "field" else content)
            if mesh:
                beside.write_bytes(data.draw(damage(mesh)) if victim == "mesh" else mesh)
            mapping = samples.settings(**changes)
            damaged = path if victim == "field" else beside
            line = ends_well(
                lambda: sightline(path, mapping, points=30, mesh=beside if mesh else None), damaged
            )
            assert line is None or all(np.isfinite(line[key]).all() for key in ("temperature", "pressure"))

    run()


@SETTINGS
@given(st.data())
def test_a_damaged_map_ends_well(data):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "map.yaml"
        path.write_bytes(data.draw(damage(yaml.safe_dump(samples.settings()).encode())))
        shutil.copy(samples.FILES / "mixed_ascii.vtu", path.with_name("f.vtu"))

        def work():
            return sightline(path.with_name("f.vtu"), configuration.load(path, SCHEMA), points=30)

        ends_well(work, path)


LINE = sightline(samples.FILES / "mixed_ascii.vtu", samples.settings(), points=30)


@pytest.mark.parametrize("kind", ["ours", "plain", "LOS.dat"])
def test_a_damaged_sight_line_ends_well(kind, tmp_path):
    path = tmp_path / "line"
    if kind == "LOS.dat":
        path.write_text(neqair.compose(LINE))
    elif kind == "ours":
        io.write(LINE, path, "sightline")
    else:
        LINE.to_netcdf(path, engine="netcdf4")
    content = path.read_bytes()

    @SETTINGS
    @given(st.data())
    def run(data):
        path.write_bytes(data.draw(damage(content)))
        found = ends_well(lambda: _read_sightline(path), path)
        assert found is None or np.isfinite(found.temperature).all()

    run()
