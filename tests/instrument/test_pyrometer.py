"""Band signals and their inversion on cases whose answer is known without the code."""

import numpy as np
import pytest
from scipy.constants import sigma

from plasmapyro.instrument.pyrometer import band_signal, blackbody_signal, invert_ratio, signal_ratio

FLOAT_RTOL = 1e-12
# Fraction of the blackbody emission below lambda T [um K], to its printed digits:
# Incropera & DeWitt, Fundamentals of Heat and Mass Transfer, table 12.1.
PRINTED_FRACTION = {1600: 0.019718, 1800: 0.039341, 2000: 0.066728}
PRINTED_DIGITS = 1.5e-6  # two roundings of the sixth decimal


@pytest.mark.parametrize("edges", [(1600, 1800), (1800, 2000), (1600, 2000)])
def test_box_band_collects_the_printed_fraction_of_the_emission(edges):
    temperature = 2000.0
    wavelength = np.linspace(*(edge * 1e-6 / temperature for edge in edges), 4001)
    collected = blackbody_signal(temperature, wavelength, np.ones(4001)) * np.pi / (sigma * temperature**4)
    assert collected == pytest.approx(
        PRINTED_FRACTION[edges[1]] - PRINTED_FRACTION[edges[0]], abs=PRINTED_DIGITS
    )


def test_signal_is_linear_in_radiance_and_keeps_leading_axes():
    wavelength = np.linspace(0.8e-6, 1.0e-6, 51)
    response, radiance = np.linspace(0, 1, 51), np.random.default_rng(1).random((2, 3, 51))
    signal = band_signal(wavelength, response, radiance)
    assert signal.shape == (2, 3)
    doubled = band_signal(wavelength, response, 2 * radiance)
    np.testing.assert_allclose(doubled, 2 * signal, rtol=FLOAT_RTOL)
    np.testing.assert_allclose(band_signal(wavelength, 3 * response, radiance), 3 * signal, rtol=FLOAT_RTOL)


def test_triangle_response_of_unit_radiance_has_the_area_of_the_triangle():
    nodes, response = np.array([0.9e-6, 1.0e-6, 1.1e-6]), np.array([0.0, 1.0, 0.0])
    fine = np.linspace(0.8e-6, 1.2e-6, 40001)
    area = band_signal(fine, np.interp(fine, nodes, response), np.ones(fine.size))
    assert area == pytest.approx(0.1e-6, rel=FLOAT_RTOL, abs=0)  # the corners are nodes: exact


def test_ratio_of_noise_is_no_ratio():
    ratio = signal_ratio([2.0, 2.0, -2.0, 0.0, np.nan], [4.0, -4.0, -4.0, 4.0, 1.0])
    assert ratio[0] == 0.5 and np.isnan(ratio[1:]).all()


def test_inverse_is_exact_in_the_wien_limit_even_between_two_points():
    ends = np.array([900.0, 2100.0])
    temperature, status = invert_ratio(np.exp(-3000 / 1300.0), ends, np.exp(-3000 / ends))
    assert float(temperature) == pytest.approx(1300, rel=FLOAT_RTOL) and status == 0


def test_inverse_never_extrapolates_in_silence():
    temperature, status = invert_ratio([0.05, 0.1, 0.2, 0.4, 0.5, np.nan], [1000.0, 2000.0], [0.1, 0.4])
    assert status.tolist() == [-1, 0, 0, 0, 1, 0]
    assert np.isnan(temperature).tolist() == [True, False, False, False, True, True]
    assert temperature[[1, 3]] == pytest.approx([1000, 2000], rel=FLOAT_RTOL)


def test_ratio_that_does_not_rise_is_refused():
    with pytest.raises(ValueError, match="calibration_ratio must increase strictly; got 0.3 1 then 0.2 1"):
        invert_ratio(0.2, [1000.0, 1100.0, 1200.0], [0.1, 0.3, 0.2])
