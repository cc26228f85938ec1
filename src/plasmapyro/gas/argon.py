r"""Argon as a trace in a mixture of N2 and O2 in equilibrium.

Argon reacts with nothing: its mass share w is the same everywhere. A share :math:`f` of the particles, argon
takes that share of the pressure from the others, which are in equilibrium at the rest; what of it is ionised
follows from their electrons (Saha):

.. math:: \frac{n_{Ar^+} n_e}{n_{Ar}} = \frac{2 Q_{Ar^+}}{Q_{Ar}}
          \Big(\frac{2\pi m_e kT}{h^2}\Big)^{3/2} e^{-I/kT}, \qquad
          h = (1-w)\,h_{mix} + w\,\frac{5 k (T - T_0)}{2 m_{Ar}}

ASSUME: a trace. The electrons that it adds are left out, and the energy of its ionisation; transport
coefficients are those of the others. With 0.93 % of argon in air at 50 mbar that is 0.2 % of the electrons at
8000 K and 0.5 % from 12000 K on, and at most 0.3 % of the enthalpy, where air without argon is off by 1.0 to
1.2 %.
"""

import numpy as np

from plasmapyro.checks import within
from plasmapyro.constants import BOLTZMANN, ELECTRON_MASS, PLANCK, SECOND_RADIATION
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.partition import partition_function
from plasmapyro.gas.species import (
    AIR,
    ARGON,
    ELECTRON,
    MASS,
    MOST_ARGON,
    NITROGEN_ATOMS,
    OXYGEN_ATOMS,
    SPECIES,
    particle_mass,
)

IONISATION = 12710984.2
"""Ionisation energy of argon [m-1] (NIST Atomic Spectra Database)."""

REFERENCE_TEMPERATURE = 298.15
"""Where the enthalpy of cold gas is zero [K], as of the NASA-9 polynomials."""


def species_of(argon):
    """Names of the species of a gas with this mole fraction of argon."""
    return SPECIES + ARGON if argon else SPECIES


def densities(temperature, pressure, nitrogen=AIR["N2"], argon=0.0):
    """Number densities of a mixture of N2 and O2 with a trace of argon in equilibrium.

    Source: M. N. Saha, Phil. Mag. 40 (1920) 472. ASSUME: see the module.

    ValueError as `equilibrium.composition`, or argon outside its range.

    Parameters
    ----------
    temperature, pressure : array_like [K], [Pa]
        Broadcast against each other.
    nitrogen : float [1]
        Mole fraction of N2 in the N2 and O2 of the cold gas.
    argon : float [1]
        Mole fraction of argon in the whole cold gas, 0 to 0.02.

    Returns
    -------
    ndarray [m-3]
        Shape of the broadcast arguments + (11,), or + (13,) with argon; in the order of `species_of`.
    """
    argon = float(within("argon", argon, 0.0, MOST_ARGON, "1"))
    plain = number_density(temperature, pressure, nitrogen)
    if not argon:
        return plain
    temperature, pressure = np.broadcast_arrays(np.asarray(temperature, float), np.asarray(pressure, float))
    rest = number_density(temperature, pressure * (1 - particle_share(plain, argon)), nitrogen)
    atoms = _atoms(rest, argon)
    electrons = np.maximum(rest[..., ELECTRON], np.finfo(float).tiny)
    wave = (2 * np.pi * ELECTRON_MASS * BOLTZMANN * temperature / PLANCK**2) ** 1.5
    ratio = 2 * wave * partition_function("Ar+", temperature) / partition_function("Ar", temperature)
    ratio = ratio * np.exp(-SECOND_RADIATION * IONISATION / temperature) / electrons
    neutral = atoms / (1 + ratio)
    return np.concatenate([rest, neutral[..., None], (atoms - neutral)[..., None]], axis=-1)


def particle_share(density, argon):
    """Share f of argon among all particles [1], of number densities (..., 11) of the others."""
    atoms = _atoms(density, argon)
    return atoms / (atoms + density.sum(axis=-1))


def mass_share(argon, nitrogen):
    """Mass share w of argon [1] in a cold gas."""
    others = nitrogen * MASS[SPECIES.index("N2")] + (1 - nitrogen) * MASS[SPECIES.index("O2")]
    own = argon * particle_mass("Ar")
    return own / (own + (1 - argon) * others)


def _atoms(density, argon):
    """Density of argon, ionised or not, beside the others: x/(1-x) per molecule of the cold gas [m-3]."""
    return argon / (1 - argon) * (density @ (NITROGEN_ATOMS + OXYGEN_ATOMS)) / 2


def joined(table, temperature, argon, nitrogen):
    """Properties of the whole (`gas.stage.properties`) from those of the others at their own pressure.

    `table`: over temperature (T,) [K], density [kg m-3], enthalpy [J kg-1], heat capacity [J kg-1 K-1] and
    what argon leaves as it is; `argon`, `nitrogen` [1] as in `densities`.
    """
    share = mass_share(argon, nitrogen)
    capacity = 2.5 * BOLTZMANN / particle_mass("Ar")
    own = capacity * (temperature - REFERENCE_TEMPERATURE)
    return table | {
        "density": table["density"] / (1 - share),
        "enthalpy": (1 - share) * table["enthalpy"] + share * own,
        "heat_capacity": (1 - share) * table["heat_capacity"] + share * capacity,
    }
