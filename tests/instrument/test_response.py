"""The modelled detector against absorption theory, published silicon data and the printed bands."""

import numpy as np
import pytest

from plasmapyro import contracts, tables
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.instrument.response import (
    layered_efficiency,
    long_pass,
    sandwich_response,
    silicon_absorption,
)
from plasmapyro.instrument.stage import band_response

FLOAT_RTOL = 1e-12
DETECTOR = {
    "silicon_table": "silicon_green_2008",
    "top_thickness": 200e-6,
    "bottom_thickness": 400e-6,
    "short_wavelength_edge": 0.75e-6,
    "edge_sigma": 5e-9,
    "long_wavelength_limit": 1.15e-6,
    "wavelength_step": 0.5e-9,
}


def ratio(response, temperature=1600.0):
    wavelength = response.wavelength.values
    wide, narrow = (
        blackbody_signal(temperature, wavelength, response[f"responsivity_{band}"].values)
        for band in ("wide", "narrow")
    )
    return wide / narrow


def test_thick_top_layer_takes_everything():
    top, bottom = layered_efficiency([1e6, 1e5], 1e-3, 1e-3)
    assert top == pytest.approx([1, 1], abs=1e-12)
    assert bottom == pytest.approx([0, 0], abs=1e-12)


def test_thin_layers_absorb_in_proportion_to_their_thickness():
    top, bottom = layered_efficiency(1.0, 1e-8, 3e-8)
    assert (float(top), float(bottom)) == pytest.approx((1e-8, 3e-8), rel=1e-7, abs=0)  # next order: alpha d


def test_photons_are_neither_lost_nor_counted_twice():
    alpha = np.geomspace(1, 1e6, 25)
    top, bottom = layered_efficiency(alpha, 2e-4, 4e-4)
    whole, _ = layered_efficiency(alpha, 6e-4, 1.0)
    np.testing.assert_allclose(top + bottom, whole, rtol=FLOAT_RTOL)


def test_bottom_layer_sees_what_the_top_layer_transmits():
    _, behind = layered_efficiency(5e3, 2e-4, 4e-4)
    alone, _ = layered_efficiency(5e3, 4e-4, 1.0)
    assert float(behind) == pytest.approx(float(alone) * np.exp(-1.0), rel=FLOAT_RTOL)


def test_long_pass_edge_has_the_stated_place_and_width():
    assert float(long_pass(0.75e-6, 0.75e-6, 5e-9)) == 0.5
    tenth, nine_tenths = long_pass(0.75e-6 + np.array([-1, 1]) * 1.2815515655 * 5e-9, 0.75e-6, 5e-9)
    assert (tenth, nine_tenths) == pytest.approx((0.1, 0.9), abs=1e-9)
    assert float(long_pass(0.8e-6, 0.75e-6, 5e-9)) == pytest.approx(1, abs=1e-12)


def test_current_per_watt_grows_with_wavelength_where_every_photon_counts():
    wavelength = np.array([0.80e-6, 0.85e-6, 0.90e-6])
    wide, _ = sandwich_response(
        wavelength, np.full(3, 3e4), top_thickness=1e-3, bottom_thickness=1e-3, edge=0.7e-6, edge_sigma=1e-9
    )
    np.testing.assert_allclose(wide, wavelength / wavelength[-1], rtol=FLOAT_RTOL)  # exp(-30) passes


def test_detector_with_a_dark_layer_is_refused():
    with pytest.raises(ValueError, match="the bottom layer receives no light"):
        sandwich_response(
            np.array([0.8e-6, 0.9e-6]),
            np.full(2, 1e7),
            top_thickness=1e-3,
            bottom_thickness=1e-3,
            edge=0.7e-6,
            edge_sigma=1e-9,
        )


@pytest.mark.parametrize("name", ["silicon_green_2008", "silicon_schinke_2015"])
def test_absorption_length_of_silicon_at_1064_nm_is_about_a_millimetre(name):
    table = tables.load(f"detector/{name}")
    length = 1 / silicon_absorption(1.064e-6, table["wavelength"], table["absorption_coefficient"])
    assert length == pytest.approx(1.0e-3, rel=0.1)  # 10 1/cm: Weakliem & Redfield, J. Appl. Phys. 50 (1979)


def test_absorption_meets_its_table_and_stops_at_its_ends():
    table = tables.load("detector/silicon_green_2008")
    nodes, values = table["wavelength"], table["absorption_coefficient"]
    np.testing.assert_allclose(silicon_absorption(nodes, nodes, values), values, rtol=FLOAT_RTOL)
    between = silicon_absorption((nodes[1:] + nodes[:-1]) / 2, nodes, values)
    assert (between < values[:-1]).all() and (between > values[1:]).all()
    with pytest.raises(ValueError, match="wavelength must lie in"):
        silicon_absorption(1.31e-6, nodes, values)


def test_response_honours_its_contract_and_says_that_it_is_modelled():
    response = band_response(**DETECTOR)
    contracts.check(contracts.label(response, "response"), "response")
    assert response.attrs["origin"] == "modelled"
    assert float(response.responsivity_wide.max()) == float(response.responsivity_narrow.max()) == 1


def test_bands_begin_where_the_paper_prints_them():
    response = band_response(**DETECTOR)
    for band, start in (("wide", 0.75e-6), ("narrow", 0.95e-6)):
        values = response[f"responsivity_{band}"].values
        foot = response.wavelength.values[np.argmax(values > 0.1)]
        assert foot == pytest.approx(start, abs=8e-9), band  # printed to 10 nm
    assert float(response.wavelength[-1]) == pytest.approx(1.15e-6, rel=FLOAT_RTOL, abs=0)


def test_thicker_top_layer_moves_the_narrow_band_to_longer_wavelengths():
    feet = []
    for thickness in (100e-6, 200e-6, 400e-6):
        response = band_response(**{**DETECTOR, "top_thickness": thickness})
        feet.append(float(response.wavelength[np.argmax(response.responsivity_narrow.values > 0.5)]))
    assert feet == sorted(feet) and feet[-1] - feet[0] > 30e-9


def test_sampling_is_fine_enough():
    coarse, fine = (band_response(**{**DETECTOR, "wavelength_step": step}) for step in (0.5e-9, 0.125e-9))
    assert ratio(coarse) == pytest.approx(ratio(fine), rel=2e-5)  # a hundredth of the 0.13 % fit residual


def test_the_two_silicon_tables_agree_in_what_matters():
    other = band_response(**{**DETECTOR, "silicon_table": "silicon_schinke_2015"})
    change = np.log(ratio(other) / ratio(band_response(**DETECTOR)))
    shape = change - np.log(ratio(other, 1000.0) / ratio(band_response(**DETECTOR), 1000.0))
    assert abs(shape) < 0.005  # a constant factor goes into the sensitivity ratio; 0.5 % is 8 K at 1600 K


def test_limit_below_the_edge_is_refused():
    with pytest.raises(ValueError, match="long_wavelength_limit must exceed"):
        band_response(**{**DETECTOR, "long_wavelength_limit": 0.7e-6})
