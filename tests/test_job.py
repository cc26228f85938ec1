"""A job hands a stage what its rule gives, and stores what comes back."""

import logging
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro import io, job
from plasmapyro.analysis.stage import surface_radiance
from plasmapyro.quantities import steps


class Files(dict):
    """Named inputs as Snakemake hands them over: they iterate over the files that are there."""

    def __iter__(self):
        return iter([path for path in self.values() if path])


@pytest.fixture
def rule(tmp_path, monkeypatch):
    monkeypatch.setattr(logging, "basicConfig", lambda **_: None)
    settings = {"object_temperature_k": [1000, 1500, 250], "emittance": 0.5, "wave_nm": [700, 900]}
    script = tmp_path / "script.py"
    script.touch()
    given = Files(script=str(script))
    return SimpleNamespace(
        log=[tmp_path / "log"], input=given, output=[tmp_path / "made.nc"], params=settings
    )


def test_units_lists_and_words_of_the_configuration_become_those_of_the_stage(rule):
    job.run(
        rule,
        surface_radiance,
        "surface_radiance",
        object_temperature=steps,
        wave=partial(np.linspace, num=11),
        renamed={"wave": "wavelength"},
    )
    made = io.read(rule.output[0], "surface_radiance")
    assert made.object_temperature.values.tolist() == [1000, 1250, 1500]
    assert made.wavelength.values == pytest.approx(np.linspace(700e-9, 900e-9, 11), rel=1e-12)
    assert '"emittance": 0.5' in made.attrs["configuration"]
    assert "script.py" in made.attrs["sources"]


def test_inputs_come_by_their_contracts_in_order_and_one_left_empty_is_none(rule, tmp_path):
    path = tmp_path / "surface.nc"
    whole = surface_radiance(object_temperature=[1000.0], emittance=0.5, wavelength=[7e-7, 8e-7])
    io.write(whole, path, "surface_radiance")
    named = {"test": [], "surface_radiance": str(path), "script": rule.input["script"]}
    rule.input, rule.params = Files(named), {}
    seen = []

    def stage(*given):
        seen.extend(given)
        return given[1]

    job.run(rule, stage, "surface_radiance")
    assert seen[0] is None and len(seen) == 2
    assert seen[1].surface_radiance.values.tolist() == whole.surface_radiance.values.tolist()
