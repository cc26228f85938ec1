"""The eleven species of a plasma of N2 and O2; carbon, argon, silicon beside them; names of cold gases."""

import re

import numpy as np

from plasmapyro.checks import within
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
"""Mole fractions of cold air.

ASSUME: CO2 and water vapour are left out, and argon (0.93 %) where no condition asks for it, as in the
eleven-species air of the paper.
"""
MOST_ARGON = 0.02
"""Mole fraction of argon up to which it is a trace (`gas.argon`)."""


def gas_name(nitrogen, argon=0.0):
    """What files call a cold gas: 'air', 'N2', 'O2', or such as 'N2:0.9 O2:0.1'; 'air Ar:0.0093' with argon.

    `nitrogen`: mole fraction of N2 in the N2 and O2; `argon`: in the whole, up to `MOST_ARGON`.
    """
    nitrogen = float(within("nitrogen", nitrogen, 0.0, 1.0, "1"))
    argon = float(within("argon", argon, 0.0, MOST_ARGON, "1"))
    if nitrogen in (0.0, 1.0):
        name = "N2" if nitrogen else "O2"
    else:
        name = "air" if nitrogen == AIR["N2"] else f"N2:{nitrogen!r} O2:{oxygen_beside(nitrogen)!r}"
    return f"{name} Ar:{argon!r}" if argon else name


def argon_of(dataset):
    """Mole fraction of argon [1] in the cold gas that a dataset names in its attribute `gas`."""
    return float(dataset.attrs.get("gas", "air").partition(" Ar:")[2] or 0.0)


def nitrogen_of(dataset):
    """Mole fraction of N2 [1] in the N2 and O2 that a dataset names in its attribute `gas`; air if in none.

    ValueError: another gas.
    """
    name = dataset.attrs.get("gas", "air").partition(" Ar:")[0]
    known = {"air": AIR["N2"], "N2": 1.0, "O2": 0.0}
    mixture = re.fullmatch(r"N2:([0-9.e-]+) O2:[0-9.e-]+", name)
    if name not in known and not mixture:
        raise ValueError(f"gas must be a mixture of N2 and O2; got {name!r}")
    return float(mixture[1]) if mixture else known[name]


def oxygen_beside(nitrogen):
    """Mole fraction of O2 [1] beside that of N2, free of the round-off of 1 - 0.79."""
    return round(1.0 - nitrogen, 12)


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

ARGON = ("Ar", "Ar+")
"""Species of the trace that a condition may ask for (`gas.argon`)."""

SILICON = ("Si",)
"""Species that radiates where a wall of SiC or silica gives it off."""

TRACES = CARBON + ARGON + SILICON
"""Species that a path may hold beside the eleven."""

TRACE_NEUTRALS = ("CN", "C2", "C", "Ar", "Si")
TRACE_IONS = ("C+", "Ar+")

ATOMIC_WEIGHT_CARBON = 12.011
ATOMIC_WEIGHT_ARGON = 39.948
ATOMIC_WEIGHT_SILICON = 28.085

_TRACE_MASS = {
    "CN": ATOMIC_MASS * (ATOMIC_WEIGHT_CARBON + ATOMIC_WEIGHT_NITROGEN),
    "C2": ATOMIC_MASS * 2 * ATOMIC_WEIGHT_CARBON,
    "C": ATOMIC_MASS * ATOMIC_WEIGHT_CARBON,
    "C+": ATOMIC_MASS * ATOMIC_WEIGHT_CARBON - ELECTRON_MASS,
    "Ar": ATOMIC_MASS * ATOMIC_WEIGHT_ARGON,
    "Ar+": ATOMIC_MASS * ATOMIC_WEIGHT_ARGON - ELECTRON_MASS,
    "Si": ATOMIC_MASS * ATOMIC_WEIGHT_SILICON,
}


def particle_mass(name):
    """Mass [kg] of one particle of a species of air or of a trace."""
    return float(_TRACE_MASS[name] if name in TRACES else MASS[SPECIES.index(name)])
