"""Levels with a temperature of their own: against sums over levels, and the two-temperature engine."""

import numpy as np
import pytest

from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.levels import departures
from plasmapyro.radiation.path import gas_path
from plasmapyro.radiation.systems import line_lists

TEMPERATURE = np.array([1000.0, 5000.0, 7000.0])
PRESSURE = 5000.0  # Pa


@pytest.fixture(scope="module")
def lists():
    return {lines.component: lines for lines in line_lists(log_grid((770e-9, 780e-9), 20_000))}


def path(**changes):
    density = dict(zip(SPECIES, number_density(TEMPERATURE, np.full(3, PRESSURE)).T, strict=True))
    distance = np.arange(3) * 1e-3
    return gas_path(distance, TEMPERATURE, density, departures=departures(TEMPERATURE, **changes))


def test_no_change_is_equilibrium():
    assert departures(TEMPERATURE) == {} and path().equilibrium


def test_excited_atoms_shine_as_their_temperature_says(lists):
    """Ratios of two lines follow exp(-hc dE/kT') alone; a path of one species as hot shines the same."""
    lines, ratio = lists["O I"], 1.05
    plain, changed = path().emission(lines, 1), path(excitation=ratio - 1).emission(lines, 1)
    energy = lines.upper_energy
    slope = -SECOND_RADIATION * (1 / (ratio * TEMPERATURE[1]) - 1 / TEMPERATURE[1])
    expected = slope * (energy - energy[0])
    bright = plain > 0
    found = np.log(changed[bright] / plain[bright])
    assert found - found[0] == pytest.approx((expected - expected[bright][0])[bright], abs=1e-9)
    assert np.array_equal(path(excitation=0.05).emission(lines, 0), path().emission(lines, 0))  # cold
    other = lists["N2 1P"]
    assert np.array_equal(path(excitation=0.05).emission(other, 1), path().emission(other, 1))


def test_vibration_moves_light_between_bands_and_keeps_the_state(lists):
    """Kirchhoff's law at two temperatures: with rotation as it is, the engine's own two-temperature gas
    changes N2 1P by the same factors but for one number, the population of the state."""
    lines, ratio = lists["N2 1P"], 0.9
    changed = path(vibration=ratio - 1).emission(lines, 2) / path().emission(lines, 2)
    density = dict(zip(SPECIES, number_density(TEMPERATURE, np.full(3, PRESSURE)).T, strict=True))
    two = gas_path(np.arange(3) * 1e-3, TEMPERATURE, density, excitation_temperature=TEMPERATURE * ratio)
    engine = two.emission(lines, 2) / path().emission(lines, 2)
    assert np.std(np.log(changed / engine)) < 1e-3  # `LEVEL_STEP` of energies that go back to one origin
    assert changed.min() < 1 < changed.max()
