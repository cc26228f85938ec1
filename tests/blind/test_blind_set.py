"""A small blind test: gas of the radiation engine, hidden effects of the twin, diagnosis of the package.

The seed comes from the environment where there is one (a commit), so that no code can be fitted to it; the
gates are so wide that a sound diagnosis fails them less than once in a thousand seeds, at the rates of
docs/scoreboard.md. The full set is `make blind`.
"""

import json
import os

import numpy as np
import pytest
import xarray as xr
from blind import run
from invented import RESPONSE

from plasmapyro import io
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.stage import line_of_sight_radiance

command = pytest.importorskip("plasmapyro.diagnosis.command", reason="needs the diagnosis")

SEED = os.environ.get("BLIND_SEED", "a word that nothing was fitted to")
CASES = {"null": 8, "liar": 3, "single": 16, "double": 3, "outside": 6, "without": 3, "sabotage": 3}
PRESSURE = 5000.0  # [Pa]
DISTANCE = np.concatenate([np.linspace(0.0, 0.006, 7), np.linspace(0.012, 0.16, 14)])


def sight_line(power):
    """A jet whose core warms with the power, cold at both ends."""
    core = 5950.0 * (power / 80e3) ** 0.12
    shape = -np.expm1(-DISTANCE / 0.0025) * np.exp(-((DISTANCE / 0.125) ** 6))
    temperature = 350.0 + (core - 350.0) * shape
    density = number_density(temperature, np.full(temperature.size, PRESSURE))
    return xr.Dataset(
        {
            "temperature": ("path_distance", temperature),
            "pressure": ("path_distance", np.full(temperature.size, PRESSURE)),
            "number_density": (("species", "path_distance"), density.T),
        },
        {"path_distance": DISTANCE, "species": list(SPECIES)},
        {"origin": "modelled"},
    )


def surface_view(line):
    """The light that meets the surface: as the sight line, mirrored, and from straight above."""
    two = {"ray": 2}
    both = {
        name: xr.concat([line[name].rename(path_distance="node")] * 2, "ray").values
        for name in ("temperature", "pressure")
    }
    density = line.number_density.rename(path_distance="node").values
    return xr.Dataset(
        {
            "ray_angle": ("ray", [0.61, 0.0]),
            "ray_weight": ("ray", [0.0, 1.0]),
            "ray_distance": (("ray", "node"), np.stack([DISTANCE] * two["ray"])),
            "ray_temperature": (("ray", "node"), both["temperature"]),
            "ray_pressure": (("ray", "node"), both["pressure"]),
            "ray_number_density": (("ray", "species", "node"), np.stack([density] * two["ray"])),
        },
        {"species": list(SPECIES)},
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The files of a small main job: three powers, their variations, the response, the composition."""
    from plasmapyro.diagnosis.gas_stage import gas_variations

    folder = tmp_path_factory.mktemp("results")
    for power in (50e3, 80e3, 130e3):
        name, line = f"{power / 1e3:.0f}kW.nc", sight_line(power)
        radiation = line_of_sight_radiance(
            line, RESPONSE, wavelength_range=(700e-9, 1200e-9), grid_points=160_000, slit_fwhm=0.75e-9
        )
        io.write(line, folder / "sightline" / name, "sightline")
        io.write(radiation, folder / "radiation" / name, "radiation")
        if power == 80e3:
            view = surface_view(line)
            varied = gas_variations(line, view, radiation, pressure=PRESSURE, boundary_layer_depth=5e-3)
            io.write(varied, folder / "radiation_variations" / name, "gas_variations")
    io.write(RESPONSE, folder / "instrument/response.nc", "response")
    table = np.arange(300.0, 15000.0, 50.0)
    density = number_density(table, np.full(table.size, PRESSURE))
    fraction = density / density.sum(axis=1, keepdims=True)
    (folder / "gas").mkdir()
    xr.Dataset(
        {"mole_fraction": (("pressure", "temperature", "species"), fraction[None])},
        {"pressure": [PRESSURE], "temperature": table, "species": list(SPECIES)},
    ).to_netcdf(folder / "gas/air11.nc")
    return folder


@pytest.fixture(scope="module")
def board(results, tmp_path_factory):
    """The scores of the small set."""
    out = tmp_path_factory.mktemp("blind")
    counts = [word for kind, number in CASES.items() for word in (f"--{kind}", str(number))]
    run.main(["--seed", SEED, "--results", str(results), "--out", str(out), "--ladder", "20", "50", *counts])
    return json.loads((out / "scoreboard.json").read_text(encoding="utf-8"))


def test_no_case_fails(board):
    assert board["failed"] == {}
    assert sum(board["cases"].values()) + sum(board["skipped"].values()) == sum(CASES.values())


def test_nothing_is_seldom_called_something(board):
    assert board["false_alarms"]["hits"] <= 3
    assert board["false_alarms_wrong_noise"]["hits"] <= 2


def test_a_strong_effect_is_named(board):
    named = board["at_least_20"]
    assert named["detected"]["hits"] >= named["detected"]["trials"] - 2
    assert named["class"]["rate"] >= 0.6


def test_what_no_name_fits_is_called_unknown(board):
    assert board["outside"]["unknown"]["hits"] >= board["outside"]["unknown"]["trials"] - 3
    assert board["outside"]["confident_wrong"]["hits"] <= 2


def test_temperature_does_not_suffer(board):
    rms = board["temperature"]["rms"]
    assert rms["extended"] <= 1.2 * rms["base"] and rms["extended"] < rms["paper"]
