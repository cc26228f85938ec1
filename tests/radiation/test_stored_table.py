import os
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from plasmapyro import io
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.radiation.bandsignal import band_signal, respond
from plasmapyro.radiation.lines import LineList
from plasmapyro.radiation.path import path_radiance
from plasmapyro.radiation.stage import line_of_sight_radiance, radiating_path
from plasmapyro.radiation.stored_table import stored_table, table_of
from plasmapyro.radiation.systems import line_lists

BAND_RTOL = 1e-4  # the bar for band signals; reached: 3e-5
VIEW_RTOL = 1e-4  # of the brightest point behind the slit
EXACT = 1e-12
RANGE, POINTS = (755e-9, 800e-9), 18_000
KEYS = {"wavelength_range": RANGE, "grid_points": POINTS, "slit_fwhm": 0.75e-9}


@pytest.fixture(scope="module")
def response():
    wavelength = np.linspace(758e-9, 796e-9, 77)
    wide = np.sin(np.pi * (wavelength - 758e-9) / 38e-9) ** 2
    return xr.Dataset(
        {
            "responsivity_wide": ("wavelength", wide),
            "responsivity_narrow": ("wavelength", np.clip((wavelength - 776e-9) / 1e-8, 0, 1)),
        },
        {"wavelength": wavelength},
    )


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "table.nc"
    made = stored_table(wavelength_range=RANGE, grid_points=POINTS, pressure=5000.0, nitrogen=0.79)
    io.write(made, path, "emission_table")
    return io.read(path, "emission_table")


def test_a_file_keeps_every_line(table):
    made = table_of(table)
    for found, expected in zip(made.lines, line_lists(made.grid), strict=True):
        for one in fields(LineList):
            np.testing.assert_array_equal(getattr(found, one.name), getattr(expected, one.name))


def test_a_sight_line_sees_the_same_from_the_table(jet_sightline, response, table):
    direct = line_of_sight_radiance(jet_sightline, response, **KEYS)
    found = line_of_sight_radiance(jet_sightline, response, table=table, **KEYS)
    assert found.attrs.keys() == direct.attrs.keys()
    assert found.component.values.tolist() == direct.component.values.tolist()
    for name in ("band_signal", "band_signal_thin"):
        np.testing.assert_allclose(found[name], direct[name], rtol=BAND_RTOL)
    # Lines without a grid never meet the nodes, only the continua do.
    np.testing.assert_allclose(found.band_signal_gridless, direct.band_signal_gridless, rtol=1e-5)
    view = direct.gas_radiance_component_slit
    off = np.abs(found.gas_radiance_component_slit - view).max("wavelength_slit")
    assert (off < VIEW_RTOL * direct.gas_radiance_slit.max()).all()
    assert found.error_cause.values.tolist() == direct.error_cause.values.tolist()
    np.testing.assert_allclose(found.error_share, direct.error_share, rtol=1e-3, atol=1e-4)


def test_gas_of_a_level_temperature_has_no_table(jet_sightline, table):
    with pytest.raises(ValueError, match="equilibrium"):
        line_of_sight_radiance(jet_sightline, None, levels={"excitation": 0.1}, table=table, **KEYS)


def test_cold_gas_is_dark(jet_sightline, table):
    temperature = np.full(jet_sightline.sizes["path_distance"], 600.0)
    cold = jet_sightline.assign(
        temperature=("path_distance", temperature),
        number_density=(jet_sightline.number_density.dims, number_density(temperature, 5000.0).T),
    )
    found = line_of_sight_radiance(cold, None, table=table, **KEYS)
    assert not found.gas_radiance.any()
    assert found.sizes["error_mode"] == 0


def test_another_grid_and_a_coarse_one_are_refused(jet_sightline, table):
    with pytest.raises(ValueError, match="table must be on the grid of the spectrum, 9000 points; got 18000"):
        line_of_sight_radiance(jet_sightline, None, table=table, **KEYS | {"grid_points": 9000})
    few = {"wavelength_range": RANGE, "grid_points": 9000}
    coarse = stored_table(pressure=5000.0, nitrogen=0.79, **few)
    for one in (None, coarse):  # resolves the widest lines, not those of N2
        with pytest.raises(ValueError, match="grid points must be >= .* for N2 1P at"):
            line_of_sight_radiance(jet_sightline, None, table=one, slit_fwhm=0.75e-9, **few)


@pytest.mark.skipif("PLASMAPYRO_RESULTS" not in os.environ, reason="needs the results of a run")
@pytest.mark.parametrize("condition", ["50kW", "130kW"])  # the coldest and the hottest
def test_the_band_signals_of_a_run_are_those_of_the_engine(condition):
    results = Path(os.environ["PLASMAPYRO_RESULTS"])
    found = io.read(results / f"radiation/{condition}.nc", "radiation")
    response = io.read(results / "instrument/response.nc", "response")
    path = radiating_path(io.read(results / f"sightline/{condition}.nc", "sightline"))
    grid = table_of(io.read(results / "emission_table/air11_50mbar.nc", "emission_table")).grid
    direct = path_radiance(path, line_lists(grid, path.number_density), grid).radiance[:, ::-1].sum(axis=0)
    wavelength = found.wavelength.values
    for band in ("wide", "narrow"):
        weight = respond(wavelength, response.wavelength.values, response[f"responsivity_{band}"].values)
        signal = float(found.band_signal.sel(band=band))
        assert signal == pytest.approx(band_signal(wavelength, weight, direct), rel=BAND_RTOL, abs=0)
