"""Figures of a set of conditions: also of one's own, of two pressures, one of them without a power."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.plots import analysis, flow, instrument, radiation

NAMES, COUNT = ["90kW", "wet", "mine"], 3
OF_CONDITIONS = {
    "numerical_power": ("condition", [90e3, 90e3, np.nan]),
    "chamber_pressure": ("condition", [5e3, 2e3, 5e3]),
}
TEMPERATURE = np.linspace(500.0, 2500.0, 30)
RANGE = ("bound", [973.0, 2073.0])


def per_condition(*shape):
    return np.linspace(0.1, 0.9, COUNT * int(np.prod(shape))).reshape(COUNT, *shape)


@pytest.fixture
def visibility():
    dims = ("condition", "band", "object_temperature")
    return xr.Dataset(
        {
            "visibility_factor": (dims, per_condition(2, 30)),
            "visibility_limit": (
                ("visibility_level", "condition", "band"),
                900 + per_condition(2)[None] * 500,
            ),
            **OF_CONDITIONS,
        },
        {
            "condition": NAMES,
            "band": ["wide", "narrow"],
            "object_temperature": TEMPERATURE,
            "visibility_level": [0.9],
        },
    )


@pytest.fixture
def reading():
    dims = ("condition", "object_temperature")
    return xr.Dataset(
        {
            "apparent_temperature": (dims, 2000 * per_condition(30)),
            "relative_error": (dims, per_condition(30)),
            "instrument_range": RANGE,
            **OF_CONDITIONS,
        },
        {"condition": NAMES, "object_temperature": TEMPERATURE},
    )


def texts(path):
    """Words of a figure, legends among them."""
    return path.read_text(encoding="utf-8")


def test_every_figure_of_a_set_draws_conditions_of_ones_own(tmp_path, visibility, reading):
    time = np.linspace(-1, 50, 30)
    errors = xr.Dataset(
        {"error_limit": (("condition", "emittance"), 900 + 900 * per_condition(5)), **OF_CONDITIONS},
        {"condition": NAMES, "emittance": np.geomspace(0.02, 1, 5)},
        {"error_level": 0.01},
    )
    history = xr.Dataset(
        {
            "apparent_temperature": (("condition", "time"), 1000 + 900 * per_condition(30)),
            "object_temperature_history": ("time", 350 + 20 * np.maximum(time, 0)),
            "instrument_range": RANGE,
            **OF_CONDITIONS,
        },
        {"condition": NAMES, "time": time},
    )
    drawn = {
        analysis.visibility_factors: visibility,
        analysis.visibility_limits: visibility,
        analysis.apparent_temperature: reading,
        analysis.relative_error: reading,
        analysis.error_map: errors,
        analysis.transient: history,
    }
    for draw, dataset in drawn.items():
        path = tmp_path / f"{draw.__name__}.svg"
        draw(dataset, [path])
        if draw is not analysis.visibility_limits:
            assert all(label in texts(path) for label in ("90 kW, 50 mbar", "90 kW, 20 mbar", "mine"))
    assert "20 mbar" in texts(tmp_path / "visibility_limits.svg")  # which no power leaves out


@pytest.mark.parametrize("count, panels, curves", [(1, 1, 1), (3, 3, 3), (5, 3, 5), (25, 3, 5)])
def test_figures_show_instruments_of_any_bands(tmp_path, count, panels, curves):
    names = [f"b{place + 1}" for place in range(count)]
    axis = np.linspace(650e-9, 1150e-9, 800)
    rows = np.abs(axis - np.linspace(680e-9, 1120e-9, count)[:, None]) < 8e-9
    response = xr.Dataset(
        {"responsivity": (("band", "wavelength"), rows.astype(float))},
        {"wavelength": axis, "band": names},
        {"instrument": "many colours"},
    )
    instrument.responses(response, [tmp_path / "responses.svg"])
    shown = texts(tmp_path / "responses.svg")
    assert "many colours" in shown and ("b1" in shown) == (count < 8)
    dims = ("condition", "band", "object_temperature")
    seen = xr.Dataset(
        {
            "visibility_factor": (dims, per_condition(count, 30)),
            "visibility_limit": (("visibility_level", "condition", "band"), 900 + per_condition(count)[None]),
            **OF_CONDITIONS,
        },
        {"condition": NAMES, "band": names, "object_temperature": TEMPERATURE, "visibility_level": [0.9]},
    )
    analysis.visibility_factors(seen, [tmp_path / "factors.svg"])
    factors = texts(tmp_path / "factors.svg")
    assert sum(f"({name})" in factors for name in names) == panels
    assert f"band {count} ({names[-1]})" in factors
    analysis.visibility_limits(seen, [tmp_path / "limits.svg"])
    assert texts(tmp_path / "limits.svg").count("=0.90") >= curves


def test_the_error_map_of_a_ladder_shows_what_a_hot_back_wall_would_do(tmp_path):
    ladder = {
        "numerical_power": ("condition", [80e3, 90e3, 100e3]),
        "chamber_pressure": ("condition", 3 * [5e3]),
    }
    errors = xr.Dataset(
        {"error_limit": (("condition", "emittance"), 1000 + 90 * per_condition(5)), **ladder},
        {"condition": ["80kW", "90kW", "100kW"], "emittance": np.geomspace(0.02, 1, 5)},
        {"error_level": 0.01},
    )
    wall = tmp_path / "wall.svg"
    analysis.error_map(errors, [wall])
    assert "90 kW with" in texts(wall) and "adiabatic back wall" in texts(wall)
    # Of two pressures nobody could say which curve the wall would move.
    mixed = errors.assign(chamber_pressure=("condition", [5e3, 5e3, 2e3]))
    analysis.error_map(mixed, [wall])
    assert "back wall" not in texts(wall)


def test_sight_lines_and_spectra_say_what_they_are(tmp_path):
    stated = [
        {"numerical_power": 90e3, "chamber_pressure": 5e3},
        {"numerical_power": 90e3, "chamber_pressure": 2e3},
        {},
    ]
    path, axis = np.linspace(0, 1, 9), np.linspace(700e-9, 1200e-9, 9)
    lines = {
        name: xr.Dataset(
            {"temperature": ("path_distance", 350 + 0 * path), "pressure": ("path_distance", 5e3 + path)},
            {"path_distance": path},
            {**attributes, "window_distance": 0.8},
        )
        for name, attributes in zip(NAMES, stated, strict=True)
    }
    flow.line_of_sight(lines, [tmp_path / "line.svg"])
    spectra = {
        name: xr.Dataset(
            {"gas_radiance_slit": ("wavelength_slit", 1e6 + axis)}, {"wavelength_slit": axis}, attributes
        )
        for name, attributes in zip(NAMES, stated, strict=True)
    }
    surface = xr.Dataset(
        {"surface_radiance": (("object_temperature", "wavelength"), np.full((1, 9), 1e7))},
        {"object_temperature": [1000.0], "wavelength": axis},
        {"emittance": 0.85},
    )
    bands = xr.Dataset(
        {f"responsivity_{band}": ("wavelength", np.ones(9)) for band in ("wide", "narrow")},
        {"wavelength": axis},
    )
    radiation.spectral_radiance(spectra, surface, bands, [tmp_path / "spectra.svg"])
    for name in ("line", "spectra"):
        assert all(
            label in texts(tmp_path / f"{name}.svg") for label in ("90 kW, 50 mbar", "90 kW, 20 mbar", "mine")
        )
