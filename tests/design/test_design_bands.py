"""Filters, detectors and room air in bins."""

import numpy as np
import pytest

from plasmapyro import tables
from plasmapyro.design.bands import air_loss, efficiency, transmittance

EDGES = np.linspace(700e-9, 1200e-9, 251)
DETECTORS = tables.load("instrument/detectors")
SILICON = tables.load("detector/silicon_green_2008")
RTOL = 1e-9


@pytest.mark.parametrize("shape, area", [("box", 1.0), ("gaussian", np.sqrt(np.pi / np.log(2)) / 2)])
def test_the_area_of_a_filter_is_that_of_its_shape(shape, area):
    # Half a bin beside an edge counts half: the area does not depend on how bins and band meet.
    for centre in (950e-9, 950.7e-9):
        got = transmittance(EDGES, centre, 33.3e-9, shape) @ np.diff(EDGES)
        assert got == pytest.approx(33.3e-9 * area, rel=RTOL, abs=0)


def test_a_gaussian_passes_half_at_half_its_width():
    fine = np.linspace(960e-9, 960.002e-9, 2)
    assert transmittance(fine, 950e-9, 20e-9, "gaussian")[0] == pytest.approx(0.5, rel=1e-3)


def test_unknown_shapes_and_detectors_are_refused():
    with pytest.raises(ValueError, match="shape"):
        transmittance(EDGES, 950e-9, 20e-9, "triangle")
    with pytest.raises(ValueError, match="detector"):
        efficiency("germanium", np.array([1e-6]), DETECTORS, SILICON, 500e-6)


def test_silicon_goes_blind_and_indium_gallium_arsenide_takes_over():
    wavelength = np.array([700e-9, 1000e-9, 1200e-9])
    silicon = efficiency("silicon", wavelength, DETECTORS, SILICON, 500e-6)
    compound = efficiency("InGaAs", wavelength, DETECTORS, SILICON, 500e-6)
    assert silicon[0] == pytest.approx(0.9, rel=1e-6) and silicon[2] < 0.01
    assert compound[0] < 1e-12 and compound[2] == pytest.approx(0.8, rel=1e-6)


def test_a_thin_detector_absorbs_the_coefficient_times_its_thickness():
    row = int(np.argmin(np.abs(SILICON["wavelength"] - 900e-9)))
    got = efficiency("silicon", SILICON["wavelength"][[row]], DETECTORS, SILICON, 1e-9)[0]
    assert got == pytest.approx(0.9 * SILICON["absorption_coefficient"][row] * 1e-9, rel=1e-3, abs=0)


def test_an_air_band_removes_its_equivalent_width():
    bands = tables.load("instrument/air_bands")
    edges = np.linspace(700e-9, 1250e-9, 5501)
    loss = air_loss(edges, bands)
    wavenumbers = 1 / edges[:-1] - 1 / edges[1:]
    assert loss @ wavenumbers == pytest.approx(bands["equivalent_width"].sum(), rel=0.01)
