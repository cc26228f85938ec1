import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.stage import line_of_sight_radiance
from plasmapyro.radiation.systems import component_uncertainty, line_lists

RANGE = (755e-9, 800e-9)
POINTS = 18_000
GRIDLESS_RTOL = 1e-3  # the bar; reached: 1e-5
LINES = ["N I", "O I", "N II", "O II", "N2 1P", "N2+ Meinel", "NO 11000 A", "NO beta", "NO infrared"]
COMPONENTS = [*LINES, "e-ion free-free", "e-neutral free-free", "free-bound", "O- detachment"]


@pytest.fixture(scope="module")
def response():
    wavelength = np.linspace(758e-9, 796e-9, 77)
    return xr.Dataset(
        {
            "responsivity_wide": ("wavelength", np.sin(np.pi * (wavelength - 758e-9) / 38e-9) ** 2),
            "responsivity_narrow": ("wavelength", np.clip((wavelength - 776e-9) / 1e-8, 0, 1)),
        },
        coords={"wavelength": wavelength},
    )


@pytest.fixture(scope="module")
def radiation(jet_sightline, response):
    return line_of_sight_radiance(
        jet_sightline, response, wavelength_range=RANGE, grid_points=POINTS, slit_fwhm=0.75e-9
    )


def test_the_file_honours_its_contract(radiation):
    contracts.check(contracts.label(radiation, "radiation"), "radiation")
    assert radiation.component.values.tolist() == COMPONENTS
    assert radiation.band.values.tolist() == ["wide", "narrow"]
    assert np.all(np.diff(radiation.wavelength) > 0)
    assert radiation.attrs["origin"] == "modelled"


def test_every_component_carries_its_uncertainty(radiation):
    stated = dict(zip(COMPONENTS, radiation.component_uncertainty.values, strict=True))
    assert stated["N2+ Meinel"] == stated["NO 11000 A"] == 0.3  # one source each
    assert stated["N2 1P"] == 0.1  # C. O. Laux, C. H. Kruger (1992)
    assert 0.03 < stated["O I"] < stated["N I"] < 0.18  # classes B+ to C+ of NIST
    assert all(0 < value <= 1 for value in stated.values())
    assert component_uncertainty(["boundary"], []) == 0


def test_pure_nitrogen_shines_by_its_atoms_molecules_and_ions_alone(jet_sightline, response):
    temperature, pressure = jet_sightline.temperature.values, jet_sightline.pressure.values
    path = jet_sightline.assign(
        number_density=(jet_sightline.number_density.dims, number_density(temperature, pressure, 1.0).T)
    )
    found = line_of_sight_radiance(
        path, response, wavelength_range=RANGE, grid_points=POINTS, slit_fwhm=0.75e-9
    )
    light = found.gas_radiance_component.integrate("wavelength").to_series()
    dark = ["O I", "O II", "NO 11000 A", "NO beta", "NO infrared", "O- detachment"]
    assert not light[dark].any()
    assert (light.drop([*dark, "N II"]) > 0).all()  # no line of N II lies in the range
    # No other system beside the band at 759 nm of N2 1P may be left out: it and N I carry the lines.
    assert light["N2 1P"] + light["N I"] + light["N2+ Meinel"] > 0.5 * light.sum()


def test_components_add_up_to_the_gas(radiation):
    total = radiation.gas_radiance_component.sum("component")
    np.testing.assert_allclose(total, radiation.gas_radiance, rtol=1e-12)
    seen = radiation.gas_radiance_component_slit.sum("component")
    np.testing.assert_allclose(seen, radiation.gas_radiance_slit, rtol=1e-12)
    assert float(radiation.gas_radiance.min()) > 0


def test_the_oxygen_triplet_towers_where_it_should(radiation):
    peak = radiation.gas_radiance_slit.idxmax("wavelength_slit")
    assert float(peak) == pytest.approx(777.45e-9, abs=0.3e-9)
    assert 0.001 < float(radiation.optical_depth.max()) < 0.1  # 0.002-0.015 in weaker jets at this pressure


def test_optical_depth_stands_on_the_wavelengths_of_the_radiance(radiation):
    # O I 777.194 nm in air, the strongest of the triplet; the range mirrored would put it at 776.9 nm.
    for name in ("optical_depth", "gas_radiance"):
        peak = float(radiation[name].idxmax("wavelength"))
        assert peak == pytest.approx(777.408e-9, abs=0.02e-9), name  # Stark shift and grid: a few pm


def test_first_positive_falls_off_behind_its_band_heads(radiation):
    # 2-0 head at 775.3 nm in air: the band degrades to the violet.
    molecule = radiation.gas_radiance_component_slit.sel(component="N2 1P")
    below = molecule.sel(wavelength_slit=slice(768e-9, 773e-9)).mean()
    above = molecule.sel(wavelength_slit=slice(779e-9, 784e-9)).mean()
    assert float(below) > 1.5 * float(above)


def test_three_ways_to_the_thin_band_signal_agree(radiation):
    thin, gridless = radiation.band_signal_thin.values, radiation.band_signal_gridless.values
    np.testing.assert_allclose(thin, gridless, rtol=GRIDLESS_RTOL)


def test_absorption_lowers_the_signal_a_little(radiation):
    assert np.all(radiation.band_signal < radiation.band_signal_thin)
    np.testing.assert_allclose(radiation.band_signal, radiation.band_signal_thin, rtol=0.02)


def test_band_signal_is_the_weighted_integral(radiation, response):
    weight = np.interp(radiation.wavelength, response.wavelength, response.responsivity_wide, left=0, right=0)
    signal = np.trapezoid(weight * radiation.gas_radiance, radiation.wavelength)
    assert float(radiation.band_signal.sel(band="wide")) == pytest.approx(signal, rel=1e-9, abs=0)


def test_a_finer_grid_moves_the_signal_by_less_than_one_in_ten_thousand(radiation, jet_sightline, response):
    finer = line_of_sight_radiance(
        jet_sightline, response, wavelength_range=RANGE, grid_points=2 * POINTS, slit_fwhm=0.75e-9
    )
    np.testing.assert_allclose(finer.band_signal, radiation.band_signal, rtol=1e-4)


def test_a_range_that_misses_a_band_is_refused(jet_sightline, response):
    with pytest.raises(ValueError, match="wavelength_range must cover the wide band"):
        line_of_sight_radiance(
            jet_sightline, response, wavelength_range=(770e-9, 800e-9), grid_points=POINTS, slit_fwhm=0.75e-9
        )


def test_molecular_lines_reach_beyond_both_ends_of_the_grid():
    grid = log_grid(RANGE, POINTS)
    for lines in line_lists(grid):
        assert lines.wavenumber.min() < grid.wavenumber[0], lines.component
        assert lines.wavenumber.max() > grid.wavenumber[-1], lines.component


def test_systems_without_a_line_in_the_window_are_left_out():
    names = [lines.component for lines in line_lists(log_grid((770e-9, 785e-9), 4000))]
    assert "O II" not in names and "O I" in names


def test_a_range_without_line_data_is_refused(jet_sightline, response):
    with pytest.raises(ValueError, match=r"wavelength_range must lie in \[6.5e-07, 2.5e-06\] m; got 2.6e-06"):
        line_of_sight_radiance(
            jet_sightline, response, wavelength_range=(755e-9, 2.6e-6), grid_points=POINTS, slit_fwhm=0.75e-9
        )
