"""The whole gas of a realistic slab against the sum over all its lines, in windows."""

import numpy as np
import pytest
from scipy.special import wofz

from plasmapyro.gas.species import MASS, SPECIES
from plasmapyro.radiation.broadening import doppler_sigma
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.opacity import prepare, spread
from plasmapyro.radiation.path import gas_path
from plasmapyro.radiation.systems import line_lists

RMS = 1e-3  # of the window's peak, the bar
INTEGRAL_RTOL = 2e-3  # the bar
SAMPLES = 40  # grid points of a window
NEAR = 60.0  # Doppler sigmas; beyond, a Voigt profile is a Lorentz profile times 1 + 3/60^2
# Vacuum wavelength and half width [nm].
WINDOWS = {
    "O I 777": (777.5, 0.3),
    "O I 845": (844.8, 0.3),
    "N I 868": (868.3, 0.3),
    "N I 1011": (1011.5, 0.4),
    "between lines 800": (800.0, 0.3),
    "between lines 990": (990.0, 0.4),
    "far from lines 1150": (1150.0, 0.4),
    "head of N2 2-0": (775.5, 0.15),
    "edge of N2 2-0": (776.2, 0.3),
    "head of N2 1-0": (891.5, 0.15),
    "head of N2 0-0": (1051.3, 0.3),
    "head of N2 3-2": (854.4, 0.15),
    "head of N2+ 2-0": (785.5, 0.3),
    "short end": (701.0, 0.3),
    "long end": (1199.0, 0.3),
}


@pytest.fixture(scope="module")
def grid():
    return log_grid((700e-9, 1200e-9), 160_000)


@pytest.fixture(scope="module")
def spreaders(grid):
    return [prepare(lines, grid) for lines in line_lists(grid)]


def direct_sum(lines, wavenumber, strength, hwhm, sigma):
    """Voigt profiles by the Faddeeva function where they are near, else their Lorentz wings."""
    reach = NEAR * sigma * wavenumber.max()
    near = (lines.wavenumber > wavenumber[0] - reach) & (lines.wavenumber < wavenumber[-1] + reach)
    gauss = sigma * lines.wavenumber[near]
    z = (wavenumber[:, None] - lines.wavenumber[near] + 1j * hwhm[near]) / (np.sqrt(2) * gauss)
    total = (wofz(z).real / (np.sqrt(2 * np.pi) * gauss)) @ strength[near]
    for first in range(0, len(lines), 50_000):
        part = np.flatnonzero(~near[first : first + 50_000]) + first
        offset = wavenumber[:, None] - lines.wavenumber[part]
        total += (1 / (offset**2 + hwhm[part] ** 2)) @ (strength[part] * hwhm[part] / np.pi)
    return total


@pytest.mark.parametrize("temperature", [6000.0, 8500.0])
def test_every_window_agrees_with_the_direct_sum(grid, spreaders, equilibrium_densities, temperature):
    density = {name: np.full(2, n) for name, n in equilibrium_densities(temperature).items()}
    path = gas_path([0.0, 1.0], np.full(2, temperature), density)
    found = {}
    for spreader in spreaders:
        lines = spreader.lines
        sigma = doppler_sigma(temperature, MASS[SPECIES.index(lines.species)])
        state = (path.emission(lines, 0), path.hwhm(lines, 0), sigma)
        spectrum = spread(spreader, *state) / grid.wavenumber
        for name, (centre, half_width) in WINDOWS.items():
            window = np.flatnonzero(np.abs(grid.wavelength * 1e9 - centre) < half_width)
            window = window[:: max(1, len(window) // SAMPLES)]
            exact = direct_sum(lines, grid.wavenumber[window], *state)
            kind = "atoms" if lines.species in ("N", "O") else "molecules"
            for key in ((name, "gas"), (name, kind)):
                parts = found.setdefault(key, np.zeros((2, len(window))))
                parts += [spectrum[window], exact]
    for key, (spectrum, exact) in found.items():
        error = spectrum - exact
        assert np.sqrt(np.mean(error**2)) < RMS * exact.max(), key
        assert abs(error.sum()) < INTEGRAL_RTOL * exact.sum(), key
