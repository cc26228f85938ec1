import numpy as np
import pytest

from plasmapyro.radiation.bandsignal import band_signal, gridless_signal, require_cover, respond
from plasmapyro.radiation.slit import slit_wavelengths, through_slit

FWHM = 0.75e-9
FINE = np.linspace(800e-9, 830e-9, 15001)
RESPONSE_WAVELENGTH = np.array([805e-9, 812e-9, 820e-9])
RESPONSE = np.array([0.0, 1.0, 0.0])


def test_a_constant_stays_the_constant():
    view = slit_wavelengths(FINE, FWHM)
    assert through_slit(FINE, np.full_like(FINE, 3.0), view, FWHM) == pytest.approx(3.0, rel=1e-12, abs=0)


def test_a_line_takes_the_shape_of_the_slit():
    sigma_line, sigma_slit = 0.02e-9, FWHM / 2.354820045
    line = np.exp(-(((FINE - 815e-9) / sigma_line) ** 2) / 2) / (sigma_line * np.sqrt(2 * np.pi))
    view = slit_wavelengths(FINE, FWHM, samples_per_fwhm=20)
    seen = through_slit(FINE, line, view, FWHM)
    wide = np.hypot(sigma_line, sigma_slit)
    exact = np.exp(-(((view - 815e-9) / wide) ** 2) / 2) / (wide * np.sqrt(2 * np.pi))
    assert seen == pytest.approx(exact, abs=1e-5 * exact.max())  # REACH cuts 6e-7 of the slit
    above = view[seen > seen.max() / 2]
    assert above[-1] - above[0] == pytest.approx(FWHM, abs=2 * (view[1] - view[0]))


def test_components_are_seen_one_by_one():
    spectra = np.array([FINE, FINE**2])
    view = slit_wavelengths(FINE, FWHM)
    seen = through_slit(FINE, spectra, view, FWHM)
    assert seen.shape == (2, len(view))
    assert seen[0] == pytest.approx(view, rel=1e-9, abs=0)
    assert seen[1] == pytest.approx(view**2 + (FWHM / 2.354820045) ** 2, rel=1e-9, abs=0)


def test_a_view_beyond_the_spectrum_is_refused():
    with pytest.raises(ValueError, match="slit view must stay .* inside"):
        through_slit(FINE, FINE, np.array([800e-9, 810e-9]), FWHM)


def test_a_slit_narrower_than_the_grid_is_refused():
    with pytest.raises(ValueError, match="slit fwhm must be > 4.7.*e-12 m on this grid"):
        through_slit(FINE, FINE, np.array([815e-9]), 1e-12)


def test_a_slit_wider_than_the_spectrum_is_refused():
    with pytest.raises(ValueError, match="slit fwhm must be below"):
        slit_wavelengths(FINE, 10e-9)


def test_band_signal_of_a_flat_spectrum_is_the_area_of_the_response():
    flat = band_signal(FINE, respond(FINE, RESPONSE_WAVELENGTH, RESPONSE), np.full_like(FINE, 2.0))
    assert flat == pytest.approx(2.0 * 7.5e-9, rel=1e-6, abs=0)


def test_gridless_signal_adds_lines_and_an_exact_continuum():
    # Lines at half response on either side and outside the response; continuum linear in wavelength.
    lines = [(np.array([808.5e-9, 816e-9, 840e-9]), np.array([4.0, 6.0, 100.0]))]
    slope = (np.array([800e-9, 830e-9]), np.array([0.0, 3e9]))
    found = gridless_signal(lines, *slope, (800e-9, 830e-9), RESPONSE_WAVELENGTH, RESPONSE)
    mean = (805e-9 + 812e-9 + 820e-9) / 3 - 800e-9  # centroid of the triangle
    assert found == pytest.approx(4 * 0.5 + 6 * 0.5 + 7.5e-9 * mean / 30e-9 * 3e9, rel=1e-9, abs=0)


def test_lines_outside_the_range_do_not_count():
    lines = [(np.array([808.5e-9, 816e-9]), np.array([4.0, 6.0]))]
    none = (np.array([800e-9, 830e-9]), np.zeros(2))
    assert gridless_signal(lines, *none, (800e-9, 815e-9), RESPONSE_WAVELENGTH, RESPONSE) == pytest.approx(
        2.0
    )


def test_a_range_that_cuts_the_band_is_refused():
    require_cover((800e-9, 830e-9), RESPONSE_WAVELENGTH, RESPONSE, "wide")
    with pytest.raises(ValueError, match="cover the wide band"):
        require_cover((800e-9, 815e-9), RESPONSE_WAVELENGTH, RESPONSE, "wide")
