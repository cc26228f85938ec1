"""Bins and tables of the instruments against integrals on a fine grid and finite differences."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.estimate.bins import LINE_BINS, bin_mean
from plasmapyro.estimate.instrument import GreyTable, bin_pixels, pyrometer, spectrometer
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.radiation.planck import blackbody_derivatives

BIN_RTOL = 2e-4  # Planck's law in bins of 3 nm, 1 nm at the edge
TABLE_RTOL = 1e-8
SLOPE_RTOL = 1e-5  # derivative of a spline
GAINS = (3.15e-9, 1e-8)


@pytest.fixture(scope="module")
def both(response):
    calibration = xr.Dataset({"absolute_sensitivity": ("band", list(GAINS))}, {"band": ["wide", "narrow"]})
    return {
        "pyrometer": pyrometer(response, calibration),
        "spectrometer": spectrometer(np.linspace(750e-9, 1030e-9, 2068)),
    }


def test_a_surface_gives_the_band_integrals_of_the_calibration(both, response):
    temperature = np.array([800.0, 1200.0, 2000.0])
    seen, _, _ = GreyTable(both["pyrometer"])(temperature)
    for column, (band, gain) in enumerate(zip(("wide", "narrow"), GAINS, strict=True)):
        fine = blackbody_signal(
            temperature, response.wavelength.values, response[f"responsivity_{band}"].values
        )
        np.testing.assert_allclose(seen[:, column], gain * fine, rtol=BIN_RTOL)


def test_the_gas_lines_have_bins_of_their_own(both):
    edges = set(np.round(both["spectrometer"].edges * 1e9, 6))
    for low, high in LINE_BINS:
        assert {round(low * 1e9, 6), round(high * 1e9, 6)} <= edges
        assert not [edge for edge in edges if low * 1e9 + 1e-3 < edge < high * 1e9 - 1e-3]


@pytest.mark.parametrize("name", ["pyrometer", "spectrometer"])
def test_the_table_gives_the_same_as_the_bins(both, name):
    temperature = np.linspace(400, 2500, 50)
    direct = [
        both[name].detect(part) for part in blackbody_derivatives(both[name].wavelength, temperature[:, None])
    ]
    value, first, second = GreyTable(both[name])(temperature)
    np.testing.assert_allclose(value, direct[0], rtol=TABLE_RTOL)
    np.testing.assert_allclose(first, direct[1], rtol=SLOPE_RTOL)
    np.testing.assert_allclose(second, direct[2], rtol=1e-3)  # second derivative of a spline


def test_a_temperature_beyond_the_table_is_refused(both):
    with pytest.raises(ValueError, match="must lie in .200, 4000. K; got 100 to 900 K"):
        GreyTable(both["pyrometer"])([900.0, 100.0])


def test_bins_mean_their_pixels_and_say_when_one_is_lost():
    pixels, edges = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.5, 2.5, 4.5])
    spectra = np.array([[1.0, 3.0, 5.0, 7.0], [1.0, 3.0, 5.0, np.nan]])
    mean, count = bin_pixels(pixels, spectra, np.isfinite(spectra), edges)
    np.testing.assert_array_equal(mean, [[2.0, 6.0], [2.0, np.nan]])
    np.testing.assert_array_equal(count, [2, 2])


def test_a_bin_mean_keeps_the_integral_of_a_line():
    wavelength = np.linspace(700e-9, 1200e-9, 50001)
    line = np.exp(-(((wavelength - 777.4e-9) / 5e-11) ** 2))
    mean = bin_mean(wavelength, line, [770e-9, 776e-9, 790e-9])
    np.testing.assert_allclose(mean, [0.0, 5e-11 * np.sqrt(np.pi) / 14e-9], rtol=1e-6, atol=1e-12)


def test_bins_beyond_the_spectrum_are_refused():
    with pytest.raises(ValueError, match="600 to 700 nm, the spectrum only from 700 to 1200 nm"):
        bin_mean(np.linspace(700e-9, 1200e-9, 100), np.ones(100), [0.6e-6, 0.7e-6])
