"""Continua of air: free-free of electrons at ions and at neutrals, free-bound, detachment of O-.

Kramers' cross sections throughout, with the free-free Gaunt factor of Menzel and Pekeris (1935): no table
of the package is used. Kirchhoff's law links emission and absorption.
"""

import numpy as np

from worlds.gas import (
    BOLTZMANN,
    C2,
    CHARGE,
    ELECTRON,
    IONISATION,
    LARGEST_N,
    LIGHT,
    PLANCK,
    RYDBERG,
    VACUUM,
    levels,
    partition,
)

# Momentum-transfer cross sections [1e-20 m2] at T [K]: pi times Omega(1,1) of Wright et al., AIAA J. 43
# (2005) 2558.
COLLISION = {
    "N": ([2000, 4000, 6000, 8000, 10000, 15000], [28.4, 12.8, 9.20, 7.95, 7.35, 6.69]),
    "O": ([2000, 4000, 6000, 8000, 10000, 15000], [2.67, 3.08, 3.30, 3.42, 3.55, 3.77]),
    "N2": ([2000, 4000, 6000, 8000, 10000, 15000], [9.14, 11.28, 12.35, 12.53, 12.28, 11.22]),
}
KRAMERS = 7.907e-22  # [m2] threshold cross section per n, Z = 1
AFFINITY = 11784.6  # of O [cm-1], 1.4611 eV
# [m2] plateau above threshold: Branscomb, Smith and Tisone, J. Chem. Phys. 43 (1965) 2906
DETACHMENT = 6.3e-22


def planck_wavenumber(wavenumber, temperature):
    """Black body per wavenumber [W m-2 sr-1 per cm-1]."""
    sigma = 100 * wavenumber
    return 100 * 2 * PLANCK * LIGHT**2 * sigma**3 / np.expm1(C2 * wavenumber / temperature)


def electron_ion(wavenumber, temperature, electrons, ions):
    """Free-free emission at singly charged ions [W m-3 sr-1 per cm-1]."""
    x = C2 * wavenumber / temperature
    gaunt = 1 + 0.1728 * (wavenumber / RYDBERG) ** (1 / 3) * (1 + 2 / x)
    # 6.8e-51 W m3 K^1/2 Hz-1 over 4 pi, in SI (Rybicki and Lightman 1979, eq. 5.14)
    per_hertz = 6.8416e-51 / (4 * np.pi) * electrons * ions / np.sqrt(temperature) * np.exp(-x) * gaunt
    return per_hertz * 100 * LIGHT


def electron_neutral(wavenumber, temperature, electrons, neutrals, species):
    r"""Free-free emission at neutrals [W m-3 sr-1 per cm-1].

    The larmor power of a classical collision, averaged over Maxwell's law above the photon's energy
    (Zel'dovich and Raizer 1966, ch. V; Cabannes and Chapelle 1971):

    .. math:: 4\pi j_\nu = \frac{8 e^2}{3 \cdot 4\pi\epsilon_0 c^3} n_e n_a Q \left(\frac{2}{m}\right)^{3/2}
        \frac{2}{\sqrt\pi} (kT)^{3/2} (x^2 + 2x + 2) e^{-x}, \quad x = h\nu/kT
    """
    x = C2 * wavenumber / temperature
    q = np.interp(temperature, *COLLISION[species]) * 1e-20
    power = 8 * CHARGE**2 / (3 * 4 * np.pi * VACUUM * LIGHT**3) * electrons * neutrals * q
    power *= (2 / ELECTRON) ** 1.5 * 2 / np.sqrt(np.pi) * (BOLTZMANN * temperature) ** 1.5
    return power * (x**2 + 2 * x + 2) * np.exp(-x) / (4 * np.pi) * 100 * LIGHT


def free_bound(wavenumber, temperature, density, atom):
    """Capture into the levels of N or O [W m-3 sr-1 per cm-1], each with Kramers' cross section at its
    effective n.

    Levels with n > `LARGEST_N` are a hydrogenic integral up to the ionisation limit.
    """
    weight, energy = levels(atom)
    depth = IONISATION[atom] - energy
    bound = depth > RYDBERG / (LARGEST_N + 0.5) ** 2
    q = partition(atom, np.array([temperature]))[0]
    total = np.zeros_like(wavenumber)
    for g, deep in zip(weight[bound], depth[bound], strict=True):
        above = wavenumber >= deep
        cross = KRAMERS * np.sqrt(RYDBERG / deep) * (deep / wavenumber) ** 3
        total += np.where(above, g * np.exp(-C2 * (IONISATION[atom] - deep) / temperature) * cross, 0.0)
    n = np.arange(LARGEST_N + 1, 40)
    core = {"N": 9, "O": 4}[atom]  # weight of the ion's ground term
    deep = RYDBERG / n[:, None] ** 2
    shells = 2 * n[:, None] ** 2 * core * np.exp(-C2 * (IONISATION[atom] - deep) / temperature)
    total += (shells * KRAMERS * n[:, None] * (deep / wavenumber) ** 3).sum(axis=0)
    absorption = density / q * total * -np.expm1(-C2 * wavenumber / temperature)
    return absorption * planck_wavenumber(wavenumber, temperature)


def detachment(wavenumber, temperature, electrons, oxygen):
    """Attachment of electrons to O, whose ion is in Saha equilibrium [W m-3 sr-1 per cm-1]."""
    thermal = (PLANCK**2 / (2 * np.pi * ELECTRON * BOLTZMANN * temperature)) ** 1.5
    q = partition("O", np.array([temperature]))[0]
    ions = electrons * oxygen * thermal * 6 / (2 * q) * np.exp(C2 * AFFINITY / temperature)
    # the cross section opens as k of an s wave
    opening = np.clip((wavenumber - AFFINITY) / 1500, 0, 1) ** 0.5
    absorption = ions * DETACHMENT * opening * -np.expm1(-C2 * wavenumber / temperature)
    return absorption * planck_wavenumber(wavenumber, temperature)


def families(wavenumber, temperature, n):
    """The four continua (4, s) at one temperature, `n` a dict of number densities."""
    ions = sum(value for name, value in n.items() if name.endswith("+"))
    return np.array(
        [
            electron_ion(wavenumber, temperature, n["e-"], ions),
            sum(electron_neutral(wavenumber, temperature, n["e-"], n[one], one) for one in COLLISION),
            free_bound(wavenumber, temperature, n["N"], "N")
            + free_bound(wavenumber, temperature, n["O"], "O"),
            detachment(wavenumber, temperature, n["e-"], n["O"]),
        ]
    )
