"""What a wall does to the atoms and ions that meet it."""

import numpy as np

from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas.species import ELECTRON, MASS, SPECIES

RECOMBINE = (("N", "N2"), ("O", "O2"))
NEUTRALISE = (("N2+", "N2"), ("O2+", "O2"), ("NO+", "NO"), ("N+", "N"), ("O+", "O"))


def wall_flux(number_density, wall_temperature, recombination):
    r"""Particles that leave a catalytic wall.

    .. math:: F_a = -\frac{2\gamma}{2-\gamma}\,n_a\sqrt{\frac{kT_w}{2\pi m_a}}, \qquad F_{a_2} = -F_a/2

    Ions meet an electron with certainty (:math:`\gamma = 1`) and leave as neutrals.

    Parameters
    ----------
    number_density : ndarray [m-3]
        Shape (..., 11), at the wall.
    wall_temperature : float [K]
    recombination : float [1]
        gamma of N to N2 and O to O2, 0 to 1. ASSUME: the same for both, and no NO is formed.

    Returns
    -------
    ndarray [m-2 s-1]
        Shape (..., 11), positive away from the wall.

    Notes
    -----
    Source: R. Goulard, Jet Propulsion 28 (1958) 737; the factor 2/(2 - gamma) of the flux onto an absorbing
    wall: C. D. Scott, in Thermal Design of Aeroassisted Orbital Transfer Vehicles (AIAA, 1985) 522.
    """
    speed = np.sqrt(BOLTZMANN * wall_temperature / (2 * np.pi * MASS))
    flux = np.zeros(number_density.shape)
    for pairs, probability in ((RECOMBINE, recombination), (NEUTRALISE, 1.0)):
        for lost, made in pairs:
            i, k = SPECIES.index(lost), SPECIES.index(made)
            rate = 2 * probability / (2 - probability) * number_density[..., i] * speed[i]
            flux[..., i] -= rate
            flux[..., k] += rate * MASS[i] / MASS[k] if pairs is RECOMBINE else rate
            if pairs is NEUTRALISE:
                flux[..., ELECTRON] -= rate
    return flux
