"""Species and their lines: neutral and singly ionised atoms, and heads of molecular bands."""

import re
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from plasmapyro import tables
from plasmapyro.constants import SECOND_RADIATION

AIR = ("N", "O", "H", "Ar", "N2", "N2+")  # what air alone may show
HEAD_ERROR = 0.15e-9  # [m] of a computed band head


@dataclass(frozen=True, eq=False)
class Species:
    """An emitter and its lines, in the order of wavelength.

    Attributes
    ----------
    name, element : str
        As "Fe II" and "Fe"; "CN violet" and "CN".
    wavelength : ndarray (L,) [m]
        In standard air.
    probability : ndarray (L,) [s-1]
        Einstein coefficient times the statistical weight of the upper level.
    upper : ndarray (L,) [m-1]
        Energy of the upper level as wavenumber.
    error : float [m]
        Of a position.
    """

    name: str
    element: str
    wavelength: np.ndarray
    probability: np.ndarray
    upper: np.ndarray
    error: float = 2e-12

    def light(self, temperature, depth):
        r"""Light (L,) of its lines, in units of the strongest where nothing is absorbed.

        .. math:: I \propto \frac{g A}{\lambda} e^{-c_2 E_u/T} \frac{1 - e^{-\tau}}{\tau}, \quad
           \tau \propto g A \lambda^3 e^{-c_2 E_l/T}

        Parameters
        ----------
        temperature : float [K]
            Of excitation.
        depth : float [1]
            Optical depth of the line of most.
        """
        lower = self.upper - 1 / self.wavelength
        log_thin = np.log(self.probability / self.wavelength) - SECOND_RADIATION * self.upper / temperature
        log_tau = (
            3 * np.log(self.wavelength) + np.log(self.probability) - SECOND_RADIATION * lower / temperature
        )
        tau = np.maximum(depth * np.exp(log_tau - log_tau.max()), 1e-9)
        thin = np.exp(log_thin - log_thin.max())
        return thin * -np.expm1(-tau) / tau

    def between(self, low, high):
        """The species with its lines of that range [m] only, or None."""
        inside = (self.wavelength > low) & (self.wavelength < high)
        lines = (self.wavelength[inside], self.probability[inside], self.upper[inside])
        return Species(self.name, self.element, *lines, self.error) if inside.any() else None


@lru_cache(maxsize=1)
def catalogue():
    """All species of the tables `identification/atomic_lines` and `identification/band_heads`."""
    found = []
    for table, error in (("atomic_lines", Species.error), ("band_heads", HEAD_ERROR)):
        rows = tables.load(f"identification/{table}")
        for name in dict.fromkeys(rows["species"]):
            own = np.flatnonzero(rows["species"] == name)
            own = own[np.argsort(rows["wavelength_air"][own], kind="stable")]
            columns = (rows[key][own] for key in ("wavelength_air", "probability", "upper_energy"))
            found.append(Species(name, re.split(" ", name)[0], *columns, error))
    return tuple(found)
