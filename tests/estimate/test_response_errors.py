"""What errors of a response do to the signals of a calibrated pyrometer, against responses that do err."""

import numpy as np
import pytest
import twin_scoreboard as board

from plasmapyro.estimate.instrument import (
    COLD,
    MIDDLE,
    GreyTable,
    InverseTable,
    from_straight,
    pyrometer,
    straight,
)
from plasmapyro.estimate.response import SHIFT, InverseErrors, of_course, of_linearity, of_place
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.instrument.scale import SCALE_ERROR, scale_modes

KELVIN = np.array([910.0, 1310.0, 1780.0, 2130.0])  # between the nodes of the tables
POINTS = np.array([1600.0, 1900.0])


@pytest.fixture(scope="module")
def calibration(response, radiations):
    return board.make(
        board.Draw(0.8, 0.8, 1500.0, 80.0, 0.1, 0.01, 1.3, (0.0, 0.0), 3), response, radiations
    )[2]


def signals(response, kelvin, change=1.0, shift=0.0):
    """Signals (t, 2) by another integral than that of the tables."""
    axis = response.wavelength.values + shift
    bands = (response.responsivity_wide.values, response.responsivity_narrow.values)
    return np.stack([blackbody_signal(kelvin, axis, change * band) for band in bands], axis=1)


def test_a_moved_band_changes_the_signal_that_the_calibration_has_not_absorbed(response, calibration):
    moved = response.assign_coords(wavelength=response.wavelength + SHIFT)
    pair = [pyrometer(one, calibration) for one in (response, moved)]
    found = of_place(pair, pair, np.stack([POINTS] * 2, axis=1))(KELVIN)[0]
    by_hand = [
        np.log(signals(response, kelvin, shift=SHIFT) / signals(response, kelvin))
        for kelvin in (KELVIN, POINTS)
    ]
    expected = (by_hand[0] - by_hand[1].mean(axis=0)) / SHIFT
    np.testing.assert_allclose(found[:, [0, 1], [0, 1]], expected, rtol=0.03, atol=2e3)
    assert not found[:, 0, 1].any() and not found[:, 1, 0].any()


def test_a_response_that_errs_over_wavelength_does_too(response, calibration):
    seen = pyrometer(response, calibration)
    errors = of_course(seen, seen, np.stack([POINTS] * 2, axis=1))
    value, slope = errors(KELVIN)
    modes = scale_modes(seen.wavelength)
    number = modes.shape[1]
    assert value.shape == (KELVIN.size, 2, 2 * number)
    for mode in (number - 1, number - 3):  # a level that bends, and one that waves
        course = 1 + np.interp(response.wavelength.values, seen.wavelength, modes[:, mode])
        by_hand = [
            np.log(signals(response, kelvin, course) / signals(response, kelvin))
            for kelvin in (KELVIN, POINTS)
        ]
        expected = by_hand[0] - by_hand[1].mean(axis=0)
        own = np.stack([value[:, 0, mode], value[:, 1, number + mode]], axis=1)
        np.testing.assert_allclose(own, expected, rtol=0.03, atol=0.02 * SCALE_ERROR)  # of second order
    step = 1.0
    ends = [errors(KELVIN + sign * step)[0] for sign in (1, -1)]
    np.testing.assert_allclose((ends[0] - ends[1]) / (2 * step), slope, atol=0.05 * np.abs(slope).max())


def test_other_sources_are_as_far_apart_at_every_temperature(response, calibration):
    """Wien: the light of T by another level is that of x moved by a constant."""
    table = InverseTable(GreyTable(pyrometer(response, calibration)))
    x = straight(np.linspace(900.0, 1900.0, 41))
    value, slope, bend = table(x)
    rise = slope / value
    assert np.ptp(rise, axis=0) / rise.mean(axis=0) == pytest.approx(0.0, abs=0.1)  # over T: 1.4
    step = 0.5
    ends = [table(x + sign * step)[:2] for sign in (1, -1)]
    np.testing.assert_allclose((ends[0][0] - ends[1][0]) / (2 * step), slope, rtol=1e-4)
    np.testing.assert_allclose(
        (ends[0][1] - ends[1][1]) / (2 * step), bend, rtol=1e-2, atol=1e-6 * bend.max()
    )


def test_the_axis_of_the_path_comes_back_and_is_straight_where_nothing_shines():
    kelvin = np.array([250.0, 350.0, COLD - 1e-6, COLD + 1e-6, 900.0, MIDDLE, 3500.0])
    back, slope = from_straight(straight(kelvin))
    np.testing.assert_allclose(back, kelvin, rtol=1e-12)
    np.testing.assert_allclose(slope, (np.maximum(kelvin, COLD) / MIDDLE) ** 2, rtol=1e-6)
    assert straight(MIDDLE) == pytest.approx(MIDDLE)


def test_errors_over_the_inverse_temperature_have_its_slope(response, calibration):
    seen = pyrometer(response, calibration)
    plain = of_course(seen, seen, np.stack([POINTS] * 2, axis=1))
    value, slope = InverseErrors(plain)(straight(KELVIN))
    expected, by_kelvin = plain(KELVIN)
    np.testing.assert_allclose(value, expected, rtol=1e-9)
    np.testing.assert_allclose(slope, by_kelvin * ((KELVIN / MIDDLE) ** 2)[:, None, None], rtol=1e-9)


def test_a_power_of_the_signal_grows_with_its_logarithm(response, calibration):
    seen = pyrometer(response, calibration)
    found = of_linearity(seen, seen, np.stack([POINTS] * 2, axis=1))(KELVIN)[0]
    expected = np.log(signals(response, KELVIN)) - np.log(signals(response, POINTS)).mean(axis=0)
    np.testing.assert_allclose(found[:, [0, 1], [0, 1]], expected, atol=0.003)
