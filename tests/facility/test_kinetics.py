"""Reactions rest in equilibrium, keep what they must, and recombine as fast as was measured."""

import numpy as np
import pytest

from plasmapyro.constants import AVOGADRO
from plasmapyro.facility.kinetics import MOLAR_MASS, RATES, production
from plasmapyro.gas import equilibrium
from plasmapyro.gas.species import CHARGE, NITROGEN_ATOMS, OXYGEN_ATOMS, SPECIES

TEMPERATURES = np.array([1000.0, 2500.0, 4000.0, 6000.0, 9000.0])
REST = 1e-9  # of the larger of both directions: round-off of exp(ln K)
FACTOR_THREE = 3.0  # the spread of measured three-body rates


def mass_fraction(x):
    mass = x * MOLAR_MASS
    return mass / mass.sum(axis=-1, keepdims=True)


@pytest.mark.parametrize("rates", RATES)
def test_equilibrium_is_where_the_reactions_rest(rates):
    y = mass_fraction(equilibrium.composition(TEMPERATURES, 5000.0))
    there = production(TEMPERATURES, 5000.0, y, rates)
    elsewhere = production(TEMPERATURES, 5000.0, np.roll(y, 1, axis=0), rates)
    assert np.all(np.abs(there).max(axis=1) <= REST * np.abs(elsewhere).max(axis=1))


@pytest.mark.parametrize("rates", RATES)
def test_reactions_keep_elements_and_charge(rates):
    y = mass_fraction(equilibrium.composition(TEMPERATURES[::-1], 5000.0))
    moles = production(TEMPERATURES, 5000.0, y, rates) / MOLAR_MASS
    for kept in (NITROGEN_ATOMS, OXYGEN_ATOMS, CHARGE):
        assert np.all(np.abs(moles @ kept) < 1e-12 * np.abs(moles).max(axis=1))


def recombination_constant(rates, atom, temperature):
    """Molecules per density of atoms squared and of N2, where a few atoms stand in cold N2 [m6 s-1]."""
    x = np.zeros(len(SPECIES))
    x[SPECIES.index("N2")], x[SPECIES.index(atom)] = 0.999, 0.001
    made = production(np.array([temperature]), 1e5, mass_fraction(x)[None], rates)[0]
    molecule = SPECIES.index(2 * atom if len(atom) > 1 else atom + "2")
    density = 1e5 / (1.380649e-23 * temperature)
    gained = made[molecule] / MOLAR_MASS[molecule] * AVOGADRO
    return gained / ((0.001 * density) ** 2 * 0.999 * density)


@pytest.mark.parametrize("rates, wrong", [("kossyi", 1.0), ("gupta", 1.0), ("park", 40.0)])
def test_oxygen_recombines_as_measured_at_300_kelvin_but_with_rates_of_dissociation(rates, wrong):
    # O + O + N2, 298 K: 3.0e-33 cm6/s (Campbell & Gray, Chem. Phys. Lett. 18 (1973) 607).
    measured = 3.0e-45
    found = recombination_constant(rates, "O", 300.0) / (measured * wrong)
    assert 1 / FACTOR_THREE < found < FACTOR_THREE


def test_unknown_rates_are_refused():
    with pytest.raises(ValueError, match="rates must be one of kossyi, gupta, park"):
        production(np.array([1000.0]), 5000.0, np.full((1, 11), 1 / 11), "dunn")
