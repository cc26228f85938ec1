"""Potentials and vibration against potentials whose levels are known in closed form."""

import numpy as np
import pytest

from plasmapyro.radiation.diatomic_curves import (
    kinetic_factor,
    potential_curve,
    turning_points,
    vibrational_states,
)

REDUCED_MASS = 1.1626e-26  # [kg], that of N2
RADIUS = np.arange(0.85e-10, 2.8e-10, 0.013e-10)
FORMULA_RTOL = 1e-9  # quadrature and DVR converge faster than any power; rounding of eigh is 1e-12
ROUND_TRIP = 100.0  # [m-1], 1 cm-1: RKR is first order of WKB, good to some tenths of a cm-1

DEPTH, STEEPNESS, BOTTOM = 4.0e6, 2.7e10, 1.2e-10  # Morse: 40000 cm-1, 1/m, m


def morse_constants():
    factor = kinetic_factor(REDUCED_MASS)
    return np.array([2 * STEEPNESS * np.sqrt(factor * DEPTH), -factor * STEEPNESS**2])


def morse(radius):
    return DEPTH * (1 - np.exp(-STEEPNESS * (radius - BOTTOM))) ** 2


def test_kinetic_factor_is_that_of_a_rotor_of_one_metre():
    rotor = 6.62607015e-34 / (8 * np.pi**2 * 299792458.0 * REDUCED_MASS)
    assert kinetic_factor(REDUCED_MASS) == pytest.approx(rotor, rel=FORMULA_RTOL, abs=0)


def test_turning_points_of_a_morse_oscillator_stand_as_far_apart_as_its_formula_says():
    vibration = morse_constants()
    action = np.array([0.5, 3.5, 12.5])
    root = np.sqrt(np.polynomial.Polynomial([0.0, *vibration])(action) / DEPTH)
    inner, outer = turning_points(vibration, [kinetic_factor(REDUCED_MASS) / BOTTOM**2], REDUCED_MASS, action)
    expected = np.log((1 + root) / (1 - root)) / STEEPNESS
    np.testing.assert_allclose(outer - inner, expected, rtol=FORMULA_RTOL)


def test_a_rigid_rotor_constant_puts_the_turning_points_around_its_own_distance():
    """With B constant, g = B f / k, so that the product of the turning points is k / B."""
    rotation = kinetic_factor(REDUCED_MASS) / BOTTOM**2
    inner, outer = turning_points(morse_constants(), [rotation], REDUCED_MASS, np.array([0.5, 9.5]))
    np.testing.assert_allclose(inner * outer, BOTTOM**2, rtol=FORMULA_RTOL)


def test_dvr_gives_the_levels_of_a_morse_oscillator():
    energy, wave, bound = vibrational_states(RADIUS, morse(RADIUS), REDUCED_MASS, [0], 12)
    expected = np.polynomial.Polynomial([0.0, *morse_constants()])(np.arange(12) + 0.5)
    np.testing.assert_allclose(energy[0], expected, rtol=1e-7)  # the wave leaks through the inner end
    np.testing.assert_allclose(wave[0].T @ wave[0], np.eye(12), atol=1e-12)
    assert bound.all()


def test_dvr_gives_the_rotating_levels_of_a_kratzer_oscillator():
    """U = D (1 - a/r)^2 is the one well solved exactly for every v and N (A. Kratzer, 1920)."""
    factor = kinetic_factor(REDUCED_MASS)
    radius = np.arange(0.5e-10, 4e-10, 0.013e-10)
    squared = DEPTH * BOTTOM**2 / factor
    rotation_number, level = np.arange(91)[:, None], np.arange(5)
    order = level + 0.5 + np.sqrt((rotation_number + 0.5) ** 2 + squared)
    expected = DEPTH - factor / BOTTOM**2 * squared**2 / order**2
    energy, _, bound = vibrational_states(
        radius, DEPTH * (1 - BOTTOM / radius) ** 2, REDUCED_MASS, rotation_number[:, 0], 5
    )
    np.testing.assert_allclose(energy, expected, rtol=1e-7)
    assert bound.all()


def test_levels_of_the_inverted_curve_are_the_constants_it_came_from():
    vibration = morse_constants()
    # Pekeris: rotation-vibration coupling of a Morse oscillator, to first order.
    be = kinetic_factor(REDUCED_MASS) / BOTTOM**2
    coupling = 6 * np.sqrt(-vibration[1] * be**3) / vibration[0] - 6 * be**2 / vibration[0]
    potential = potential_curve(RADIUS, vibration, [be, -coupling], REDUCED_MASS, 15, DEPTH)
    energy, _, _ = vibrational_states(RADIUS, potential, REDUCED_MASS, [0, 1], 7)
    level = np.arange(7) + 0.5
    expected = np.polynomial.Polynomial([0.0, *vibration])(level)
    np.testing.assert_allclose(energy[0], expected, rtol=0, atol=ROUND_TRIP)
    np.testing.assert_allclose((energy[1] - energy[0]) / 2, be - coupling * level, rtol=1e-3)


def test_curve_joins_wall_and_tail_without_step_or_kink_and_ends_at_the_limit():
    vibration, rotation = morse_constants(), [kinetic_factor(REDUCED_MASS) / BOTTOM**2]
    inner, outer = turning_points(vibration, rotation, REDUCED_MASS, np.array([10.5]))
    for edge in (inner[0], outer[0]):
        around = edge + np.array([-2e-14, -1e-14, 1e-14, 2e-14])
        value = potential_curve(around, vibration, rotation, REDUCED_MASS, 10, DEPTH)
        left, right = (value[1] - value[0]) / 1e-14, (value[3] - value[2]) / 1e-14
        assert right == pytest.approx(left, rel=0.02)
        assert value[2] - value[1] == pytest.approx(2e-14 * (left + right) / 2, rel=0.02)
    far = potential_curve([5e-9], vibration, rotation, REDUCED_MASS, 10, DEPTH)
    assert far == pytest.approx(DEPTH, rel=1e-3)


def test_rotation_lifts_levels_over_the_barrier_one_by_one():
    _, _, bound = vibrational_states(RADIUS, morse(RADIUS), REDUCED_MASS, [60, 120, 150, 180], 30)
    count = bound.sum(axis=1)
    assert (np.diff(count) < 0).all()
    # A level held by the barrier may lie above the dissociation limit, but never above the barrier.
    radius = np.arange(0.85e-10, 4e-10, 0.013e-10)
    energy, _, bound = vibrational_states(radius, morse(radius), REDUCED_MASS, [120], 30)
    effective = morse(radius) + kinetic_factor(REDUCED_MASS) / radius**2 * 120 * 121
    top = int(np.argmax(np.where(radius > 2e-10, effective, 0.0)))
    assert top < radius.size - 20
    assert DEPTH < energy[bound].max() < effective[top] <= energy[~bound].min()


def test_bad_curves_are_refused():
    vibration, rotation = morse_constants(), [kinetic_factor(REDUCED_MASS) / BOTTOM**2]
    with pytest.raises(ValueError, match="well_depth must exceed the highest turning point"):
        potential_curve(RADIUS, vibration, rotation, REDUCED_MASS, 10, 1e5)
    with pytest.raises(ValueError, match="reduced_mass must be > 0 kg"):
        kinetic_factor(0.0)
    with pytest.raises(ValueError, match="turning points must increase strictly"):
        potential_curve(RADIUS, vibration, [rotation[0], -rotation[0] / 12], REDUCED_MASS, 14, DEPTH)
