"""What docs/large-studies.md shows is what there is: its file, its variables, its example."""

import re

import numpy as np
import xarray as xr
import yaml
from small_study import ROOT

from plasmapyro import contracts, io
from plasmapyro.study import stage

PAGE = (ROOT / "docs/large-studies.md").read_text(encoding="utf-8")


def block(language):
    (found,) = re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)
    return found


def test_the_file_on_the_page_is_the_one_shipped():
    assert yaml.safe_load(block("yaml")) == yaml.safe_load((ROOT / "config/study.yaml").read_text())


def test_every_variable_of_a_study_stands_on_the_page():
    rest = {"band", "emittance"}  # coordinates whose names say what they are
    missing = [name for name in contracts.DATASETS["study"] if f"`{name}`" not in PAGE and name not in rest]
    assert missing == []
    assert all(f"{code} {meaning[:3]}" in PAGE for code, meaning in ((0, "computed"), (1, "the"), (3, "not")))


def test_the_example_reads_a_study(tmp_path, monkeypatch, capsys):
    axes = [np.array(values) for values in ([90e3], [5e3], [0.016], [0.9], [np.radians(35)])]
    study = stage._empty(dict(zip(stage.DIMS, axes, strict=True)), np.array([1000.0, 1100.0]), 0.01)
    study["error_limit"] = xr.full_like(study.error_limit, 1234.0)
    study["study_status"] = xr.zeros_like(study.study_status)
    io.write(study, tmp_path / "results/study.nc", "study")
    monkeypatch.chdir(tmp_path)
    exec(compile(block("python"), "example", "exec"), {})
    assert "1234" in capsys.readouterr().out
