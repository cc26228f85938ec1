"""The engine's spectral axis: uniform in the logarithm of the wavenumber."""

from dataclasses import dataclass

import numpy as np

from plasmapyro.checks import increasing, positive

FEWEST_POINTS = 16


@dataclass(frozen=True)
class Grid:
    """Log-wavenumber axis: `wavenumber` (G,) [m-1] ascending, `step` [1] of its logarithm."""

    wavenumber: np.ndarray
    step: float

    @property
    def wavelength(self):
        """Vacuum wavelength (G,) [m]; descending, since the wavenumber ascends."""
        return 1 / self.wavenumber

    def __len__(self):
        return len(self.wavenumber)


def log_grid(wavelength_range, points):
    r"""Grid uniform in :math:`\ln\tilde\nu` from one vacuum wavelength [m] to another, of G >= 16 points.

    .. math:: \tilde\nu_i = \lambda_{max}^{-1} e^{i \Delta}, \qquad
              \Delta = \frac{\ln(\lambda_{max}/\lambda_{min})}{G - 1}

    A thermal (Gaussian) profile then has one width for all lines of a species. Source: van den Bekerom and
    Pannier, J. Quant. Spectrosc. Radiat. Transfer 261 (2021) 107476. ValueError if the range does not
    increase or `points` is too small.
    """
    wavelength_range = positive("wavelength_range", wavelength_range, "m")
    shortest, longest = increasing("wavelength_range", wavelength_range, "m")
    if int(points) != points or points < FEWEST_POINTS:
        raise ValueError(f"grid points must be a whole number >= {FEWEST_POINTS}; got {points}")
    logarithm = np.linspace(-np.log(longest), -np.log(shortest), int(points))
    return Grid(np.exp(logarithm), (logarithm[-1] - logarithm[0]) / (int(points) - 1))


def points_for(wavelength_range, step):
    """Number of grid points that makes the logarithmic step at most `step` over a wavelength range [m]."""
    shortest, longest = wavelength_range
    return int(np.ceil(np.log(longest / shortest) / step)) + 1
