from decimal import Decimal, localcontext

import numpy as np
import pytest

from plasmapyro.constants import BOLTZMANN, LIGHT_SPEED, PLANCK
from plasmapyro.radiation.planck import (
    blackbody_derivatives,
    blackbody_radiance,
    planck,
    planck_and_slope,
    radiance_and_inverse_slope,
)

FLOAT_RTOL = 1e-13  # ~500 eps: a dozen operations, the exponent up to 100
STEFAN_BOLTZMANN = 5.670374419e-8  # CODATA 2018, exact to the digits given
QUADRATURE_RTOL = 1e-6  # trapezoid over 4000 logarithmic steps


@pytest.mark.parametrize("wavelength", [5e-7, 1e-6, 2e-5])
@pytest.mark.parametrize("temperature", [300.0, 1500.0, 12000.0])
def test_radiance_agrees_with_fifty_digit_arithmetic(wavelength, temperature):
    with localcontext(prec=50):
        h, c, k = (Decimal(x) for x in (PLANCK, LIGHT_SPEED, BOLTZMANN))
        lam, t = Decimal(wavelength), Decimal(temperature)
        exact = 2 * h * c**2 / lam**5 / ((h * c / (lam * k * t)).exp() - 1)
    assert blackbody_radiance(wavelength, temperature) == pytest.approx(float(exact), rel=FLOAT_RTOL, abs=0)


def test_integral_over_wavelength_is_stefan_boltzmann():
    wavelength = np.exp(np.linspace(np.log(1e-7), np.log(1e-1), 4000))
    total = np.trapezoid(blackbody_radiance(wavelength, 1500.0), wavelength)
    assert np.pi * total == pytest.approx(STEFAN_BOLTZMANN * 1500.0**4, rel=QUADRATURE_RTOL * 10, abs=0)


def test_long_waves_follow_rayleigh_jeans():
    wavelength, temperature = 1.0, 1000.0
    expected = 2 * LIGHT_SPEED * BOLTZMANN * temperature / wavelength**4
    assert blackbody_radiance(wavelength, temperature) == pytest.approx(
        expected, rel=1e-5, abs=0
    )  # x/2 = 7e-6


def test_short_waves_follow_wien():
    wavelength, temperature = 200e-9, 1500.0  # h nu/kT = 48: the term left out is exp(-48)
    exponent = -PLANCK * LIGHT_SPEED / (wavelength * BOLTZMANN * temperature)
    expected = 2 * PLANCK * LIGHT_SPEED**2 / wavelength**5 * np.exp(exponent)
    assert blackbody_radiance(wavelength, temperature) == pytest.approx(expected, rel=FLOAT_RTOL, abs=0)


def test_the_peak_lies_where_wien_displaced_it():
    wavelength = np.linspace(1.90e-6, 1.96e-6, 60_001)
    peak = wavelength[np.argmax(blackbody_radiance(wavelength, 1500.0))]
    assert peak * 1500.0 == pytest.approx(2.897771955e-3, rel=2e-6, abs=0)  # CODATA 2018; steps of 5e-7


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_unphysical_arguments_are_refused(bad):
    with pytest.raises(ValueError, match="temperature must be > 0 K"):
        blackbody_radiance(1e-6, bad)
    with pytest.raises(ValueError, match="wavelength must be > 0 m"):
        blackbody_radiance(bad, 1000.0)


WAVELENGTH = np.array([0.75e-6, 1.1e-6, 20e-6])  # from Wien to near Rayleigh-Jeans
BODIES = np.array([900.0, 3000.0])


def test_the_unguarded_law_is_the_same_law():
    guarded = blackbody_radiance(WAVELENGTH, BODIES[:, None])
    np.testing.assert_allclose(planck(WAVELENGTH, BODIES), guarded, rtol=FLOAT_RTOL)
    np.testing.assert_allclose(planck_and_slope(WAVELENGTH, BODIES)[0], guarded, rtol=FLOAT_RTOL)


def test_both_derivatives_are_those_of_finite_differences():
    step = 1e-4 * BODIES[:, None]
    low, middle, high = (
        blackbody_derivatives(WAVELENGTH, BODIES[:, None] + sign * step) for sign in (-1, 0, 1)
    )
    # Third derivative: (x/6)^2 step^2 / T^2 = 1e-8 * 9 at x = 21; rounding 1e-16 / 1e-4.
    np.testing.assert_allclose(middle[1], (high[0] - low[0]) / (2 * step), rtol=1e-6)
    np.testing.assert_allclose(middle[2], (high[1] - low[1]) / (2 * step), rtol=1e-6)


def test_the_unguarded_derivatives_are_the_guarded_ones():
    first = blackbody_derivatives(WAVELENGTH, BODIES[:, None])[1]
    np.testing.assert_allclose(planck_and_slope(WAVELENGTH, BODIES)[1], first, rtol=FLOAT_RTOL)


def test_slope_over_inverse_temperature_is_that_of_finite_differences():
    beta, step = 1 / BODIES, 1e-6
    up, down = (
        np.log(radiance_and_inverse_slope(WAVELENGTH, beta * (1 + sign * step))[0]) for sign in (1, -1)
    )
    _, slope = radiance_and_inverse_slope(WAVELENGTH, beta)
    np.testing.assert_allclose((up - down) / (2 * step * beta[:, None]), slope, rtol=1e-7)
