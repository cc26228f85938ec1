"""The eleven species of air plasma, and those of carbon beside them: names, elements, charges, masses."""

import numpy as np

from plasmapyro.constants import ATOMIC_MASS, ELECTRON_MASS

SPECIES = ("N2", "O2", "NO", "N", "O", "N2+", "O2+", "NO+", "N+", "O+", "e-")
NEUTRALS = SPECIES[:5]
IONS = SPECIES[5:10]
ELECTRON = SPECIES.index("e-")
HEAVY = slice(0, ELECTRON)

NITROGEN_ATOMS = np.array([2, 0, 1, 1, 0, 2, 0, 1, 1, 0, 0], dtype=float)
OXYGEN_ATOMS = np.array([0, 2, 1, 0, 1, 0, 2, 1, 0, 1, 0], dtype=float)
CHARGE = np.array([0, 0, 0, 0, 0, 1, 1, 1, 1, 1, -1], dtype=float)
"""Charge in units of the elementary charge."""

AIR = {"N2": 0.79, "O2": 0.21}
"""Mole fractions of cold air, the elements of every mixture here.

ASSUME: argon (0.9 %), CO2 and water vapour are left out, as in the eleven-species air of the paper.
"""

# IUPAC conventional atomic weights 2009, those of Cantera's elements.
ATOMIC_WEIGHT_NITROGEN = 14.007
ATOMIC_WEIGHT_OXYGEN = 15.999

MASS = (
    ATOMIC_MASS * (ATOMIC_WEIGHT_NITROGEN * NITROGEN_ATOMS + ATOMIC_WEIGHT_OXYGEN * OXYGEN_ATOMS)
    - CHARGE * ELECTRON_MASS
)
"""Mass of one particle [kg]."""

CARBON = ("CN", "C2", "C", "C+")
"""Species that radiate where an ablating wall gives off carbon; never in the equilibrium of air."""

CARBON_NEUTRALS = CARBON[:3]
CARBON_IONS = CARBON[3:]

ATOMIC_WEIGHT_CARBON = 12.011

_CARBON_MASS = {
    "CN": ATOMIC_MASS * (ATOMIC_WEIGHT_CARBON + ATOMIC_WEIGHT_NITROGEN),
    "C2": ATOMIC_MASS * 2 * ATOMIC_WEIGHT_CARBON,
    "C": ATOMIC_MASS * ATOMIC_WEIGHT_CARBON,
    "C+": ATOMIC_MASS * ATOMIC_WEIGHT_CARBON - ELECTRON_MASS,
}


def particle_mass(name):
    """Mass of one particle [kg] of a species of air or of carbon.

    Parameters
    ----------
    name : str
        In `SPECIES` or `CARBON`.

    Returns
    -------
    float [kg]
    """
    return float(_CARBON_MASS[name] if name in CARBON else MASS[SPECIES.index(name)])
