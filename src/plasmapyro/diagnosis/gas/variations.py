"""How the light of the gas changes when something in the gas is not as simulated, by the radiation engine."""

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.interpolate import CubicSpline

from plasmapyro.constants import BOLTZMANN
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.partition import partition_function
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.atoms import ATOMS
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.levels import VIBRATION, vibrational
from plasmapyro.radiation.opacity import boltzmann_population, line_emission
from plasmapyro.radiation.path import Continuum, gas_path
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.radiation.slit import FWHM_PER_SIGMA, REACH

BIN = 0.03e-9  # [m] of the histogram of lines, a tenth of the standard deviation of a 0.75 nm slit
CONTINUUM_GRID = 4000  # points; the continua are smooth
NODE_RANGE = (1500.0, 13000.0)  # [K], colder gas does not shine here
NODES = 48


class GasEmission:
    r"""Slit-convolved emission of a mixture of N2 and O2 in equilibrium on temperature nodes, not absorbed.

    .. math:: j_\lambda(T) = \sum_l n_u(T) \frac{A h c \tilde\nu}{4\pi} g(\lambda - \lambda_l)
              + \kappa_c B_\lambda(T)

    Source: thin limit of the transfer equation (along the sight line of the default torch 4e-5 of a band
    signal is absorbed). ASSUME: Lorentz wings are neglected; only ratios of such spectra are used.

    Parameters
    ----------
    line_lists : list of LineList
    wavelength_slit : (K,) [m], equally spaced
    slit_fwhm : float [m]
    pressure : float [Pa]
    nitrogen : float [1]
        Mole fraction of N2 in the cold gas.

    Attributes
    ----------
    temperature : (N,) [K]
    plain : (N, C, K) [W m-3 sr-1 m-1]
        Components: the line lists, then all continua.
    """

    def __init__(self, line_lists, wavelength_slit, slit_fwhm, pressure, nitrogen):
        self.lists, self.temperature = line_lists, np.linspace(*NODE_RANGE, NODES)
        self.spreaders = [
            SlitHistogram(1 / lines.wavenumber, wavelength_slit, slit_fwhm) for lines in line_lists
        ]
        density = number_density(self.temperature, np.full(NODES, pressure), nitrogen).T
        self.density = dict(zip(SPECIES, density, strict=True))
        self.path = gas_path(np.arange(NODES, dtype=float), self.temperature, self.density)
        self.plain = np.zeros((NODES, len(line_lists) + 1, wavelength_slit.size))
        for row, lines in enumerate(line_lists):
            self._fill(self.plain, row, (self.path.emission(lines, node) for node in range(NODES)))
        smooth = Continuum(log_grid((wavelength_slit[0], wavelength_slit[-1]), CONTINUUM_GRID))
        axis = smooth.axis.wavelength
        for node, temperature in enumerate(self.temperature):
            light = smooth.absorption(self.path, node).sum(axis=0) * blackbody_radiance(axis, temperature)
            self.plain[node, -1] = np.interp(wavelength_slit, axis[::-1], light[::-1])

    def _fill(self, emission, row, strengths):
        for node, strength in enumerate(strengths):
            emission[node, row] = self.spreaders[row](strength)

    def varied(self, *, excitation=1.0, vibration=1.0):
        """As `plain` (N, C, K), with one property of the gas changed.

        Atoms are excited at `excitation` times the gas temperature; the vibrational levels of N2 B share the
        population of that state at `vibration` times it.
        """
        emission = self.plain.copy()
        for row, lines in enumerate(self.lists):
            if lines.component in ATOMS and excitation != 1:
                density = self.density[lines.species]
                pairs = zip(excitation * self.temperature, density, strict=True)
                self._fill(emission, row, (excited_lines(lines, *pair) for pair in pairs))
            if lines.component == VIBRATION and vibration != 1:
                plain = (self.path.emission(lines, node) for node in range(NODES))
                factors = (vibrational(lines, temperature, vibration) for temperature in self.temperature)
                self._fill(emission, row, (one * factor for one, factor in zip(plain, factors, strict=True)))
        return emission


def excited_lines(lines, temperature, density):
    """Emission of lines whose levels have a temperature of their own (L,)."""
    partition = partition_function(lines.species, np.array([temperature]))[0]
    population = boltzmann_population(
        lines.upper_energy, lines.upper_degeneracy, temperature, density, partition
    )
    return line_emission(lines, population)


class SlitHistogram:
    """Lines as a Gaussian slit shows them: weights on fine bins, then one convolution."""

    def __init__(self, wavelength, wavelength_slit, fwhm):
        self.slit = wavelength_slit
        sigma = fwhm / FWHM_PER_SIGMA
        first = wavelength_slit[0] - REACH * sigma
        count = int(np.ceil((wavelength_slit[-1] + REACH * sigma - first) / BIN)) + 2
        place = (wavelength - first) / BIN
        self.inside = (place >= 0) & (place < count - 1)
        self.low = place[self.inside].astype(int)
        self.share = place[self.inside] - self.low
        self.axis = first + BIN * np.arange(count)
        reach = int(np.ceil(REACH * sigma / BIN))
        kernel = np.exp(-((np.arange(-reach, reach + 1) * BIN / sigma) ** 2) / 2)
        # Convolved as in scipy.signal, whose import takes half a second.
        self.length = next_fast_len(count + kernel.size - 1, real=True)
        self.kernel = rfft(kernel / kernel.sum() / BIN, self.length)
        self.middle = slice((kernel.size - 1) // 2, (kernel.size - 1) // 2 + count)

    def __call__(self, strength):
        """Spectrum (K,) [W m-3 sr-1 m-1] of lines of some strength (L,) [W m-3 sr-1]."""
        strength = strength[self.inside]
        count = self.axis.size
        fine = np.bincount(self.low, strength * (1 - self.share), count)
        fine += np.bincount(self.low + 1, strength * self.share, count)
        smooth = irfft(rfft(fine, self.length) * self.kernel, self.length)[self.middle]
        return np.interp(self.slit, self.axis, smooth)


class Emission:
    """Emission of the gas as a smooth function of its temperature."""

    def __init__(self, temperature, emission):
        self.lowest, self.highest = temperature[0], temperature[-1]
        floor = 1e-30 * max(emission.max(), 1e-300)
        self.spline = CubicSpline(-1 / temperature, np.log(emission.sum(axis=1) + floor))

    def along(self, temperature, thickness):
        """Radiance (K,) [W m-2 sr-1 m-1] of layers (S,) of some temperature [K] and thickness [m]."""
        warm = temperature >= self.lowest
        values = np.exp(self.spline(-1 / np.minimum(temperature[warm], self.highest)))
        return thickness[warm] @ values


def warmer_wall(distance, temperature, wall_temperature, depth):
    r"""Temperatures (S,) along the path if the wall had another temperature.

    .. math:: T' = T_w + (T - T_0)\,\frac{T_e - T_w}{T_e - T_0} \quad (s < \delta)

    with the wall temperature :math:`T_0` of the simulation and :math:`T_e` at the edge of the boundary layer.
    ASSUME: the profile keeps its shape.
    """
    edge = np.interp(depth, distance, temperature)
    cold = temperature[0]
    near = wall_temperature + (temperature - cold) * (edge - wall_temperature) / (edge - cold)
    return np.where(distance < depth, near, temperature)


def particle_density(pressure, temperature):
    """Particles per volume of an ideal gas [m-3]."""
    return pressure / (BOLTZMANN * temperature)
