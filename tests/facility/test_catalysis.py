"""What meets a catalytic wall and what leaves it."""

import numpy as np
import pytest

from plasmapyro.constants import BOLTZMANN
from plasmapyro.facility.catalysis import wall_flux
from plasmapyro.gas.species import CHARGE, MASS, NITROGEN_ATOMS, OXYGEN_ATOMS, SPECIES

WALL = 350.0
DENSITY = np.linspace(1e20, 2e20, len(SPECIES))
KINETIC = DENSITY * np.sqrt(BOLTZMANN * WALL / (2 * np.pi * MASS))  # that meets a wall from a gas at rest
N, N2, NO = (SPECIES.index(name) for name in ("N", "N2", "NO"))


@pytest.mark.parametrize("gamma, share", [(1.0, 2.0), (0.1, 0.2 / 1.9), (0.01, 0.02 / 1.99), (0.0, 0.0)])
def test_atoms_are_lost_at_goulards_rate_with_scotts_factor(gamma, share):
    flux = wall_flux(DENSITY, WALL, gamma)
    ions = 2.0 * KINETIC[SPECIES.index("N+")]
    assert -flux[N] + ions == pytest.approx(share * KINETIC[N])


def test_two_atoms_make_a_molecule_and_ions_their_neutral():
    flux = wall_flux(DENSITY, WALL, 0.5)
    lost = 1.0 / 1.5 * KINETIC[N]
    assert flux[N2] == pytest.approx(lost / 2 + 2 * KINETIC[SPECIES.index("N2+")])
    assert flux[NO] == pytest.approx(2 * KINETIC[SPECIES.index("NO+")])


def test_the_wall_keeps_nothing():
    flux = wall_flux(DENSITY, WALL, 0.3)
    scale = np.abs(flux).max()
    for kept in (NITROGEN_ATOMS, OXYGEN_ATOMS, CHARGE):
        assert abs(flux @ kept) < 1e-6 * scale  # masses of two atoms and of a molecule: the same
