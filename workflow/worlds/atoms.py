"""Lines of N I and O I: multiplet strengths of the Gaia-ESO list and the Opacity Project, split by LS
coupling."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import wofz

from worlds.angular import six_j
from worlds.gas import BOLTZMANN, C2, DALTON, IONISATION, LIGHT, MASS, table

LETTERS = "SPDFGH"


@dataclass(frozen=True)
class Lines:
    """Lines of one atom; wavenumbers and energies in cm-1, A in s-1."""

    wavenumber: np.ndarray
    probability: np.ndarray  # A
    weight: np.ndarray  # of the upper level
    energy: np.ndarray  # of the upper level
    multiplet: np.ndarray  # number of the multiplet, whose lines share an error

    @property
    def decay(self):
        """Natural width [s-1]: decays of an upper level among these lines, at least 3e7."""
        return np.array([max(3e7, self.probability[self.energy == one].sum()) for one in self.energy])


def _term(name):
    """2S+1 and L of a term such as 4D*."""
    return (int(name[0]) - 1) / 2, LETTERS.index(name[1])


@cache
def lines(atom):
    r"""All lines of N or O between 650 and 1250 nm.

    .. math:: gf(J,J') = gf \frac{(2J+1)(2J'+1)}{2S+1} \left\{ {L\,J\,S \atop J'\,L'\,1} \right\}^2
        \frac{\sigma}{\sigma_0}, \quad g A = 0.66702\,\sigma^2 gf

    The gf of the Gaia-ESO line list where the table has it, else that of the Opacity Project with its
    line strength carried over from the theoretical wavelength.
    """
    levels = {}
    for row in table("levels"):
        levels.setdefault((row["species"], row["configuration"], row["term"]), []).append(
            (row["j"], row["energy_per_cm"])
        )
    found = []
    for number, row in enumerate(row for row in table("multiplets") if row["species"] == f"{atom} I"):
        lower = levels[row["species"], row["lower"], row["lower_term"]]
        upper = levels[row["species"], row["upper"], row["upper_term"]]
        (spin, low), (_, high) = _term(row["lower_term"]), _term(row["upper_term"])
        centre = _mean(upper) - _mean(lower)
        gf = row["gf_gaia_eso"] or row["gf"] * row["theory_nm"] * 1e-7 * centre
        for j, energy in upper:
            for i, below in lower:
                share = (2 * j + 1) * (2 * i + 1) / (2 * spin + 1) * six_j(low, i, spin, j, high, 1) ** 2
                wavenumber = energy - below
                if share > 0 and 8000 < wavenumber < 15385:
                    strength = gf * share * wavenumber / centre
                    found.append(
                        (
                            wavenumber,
                            0.66702 * wavenumber**2 * strength / (2 * j + 1),
                            2 * j + 1,
                            energy,
                            number,
                        )
                    )
    return Lines(*np.array(found).T)


def _mean(levels):
    weights = [2 * j + 1 for j, _ in levels]
    return np.average([energy for _, energy in levels], weights=weights)


def stark(atom, energy, temperature, electrons):
    """Half width [cm-1] by electrons [m-3]: Johnston's fit (thesis, Virginia Tech 2006) to Griem and more."""
    depth = np.maximum(IONISATION[atom] - energy, 1500.0)
    return 0.5 * 1.69e10 / depth**2.623 * (temperature / 1e4) ** 0.33 * electrons / 1e22


def doppler(species, temperature):
    """1/e half width over the line's wavenumber."""
    return np.sqrt(2 * BOLTZMANN * temperature / (MASS[species] * DALTON)) / LIGHT


NEAR, FAR = 400, 40  # grid points with the full profile, and the step of the wings beyond


def spread(grid, lines, strength, gauss, lorentz):
    """Sum of Voigt profiles (g,) [per cm-1] on a grid of ln(wavenumber), wings to its ends.

    `gauss` is one relative 1/e half width, `lorentz` a half width [cm-1] per line. Wings beyond `NEAR`
    points are Lorentzian and interpolated between every `FAR`-th point.
    """
    step, wavenumber = grid[1] - grid[0], np.exp(grid)
    total, rough = np.zeros(grid.size), wavenumber[::FAR]
    wings = np.zeros(rough.size)
    place = np.rint((np.log(lines.wavenumber) - grid[0]) / step).astype(int)
    for centre, at, amount, half in zip(lines.wavenumber, place, strength, lorentz, strict=True):
        begin, end = max(0, (at - NEAR) // FAR), min(rough.size - 1, (at + NEAR) // FAR + 1)
        wing = amount * half / np.pi / ((rough - centre) ** 2 + half**2)
        if end <= begin:
            wings += wing
            continue
        near = slice(begin * FAR, end * FAR + 1)
        width = gauss * centre
        profile = wofz(((wavenumber[near] - centre) + 1j * half) / width).real / (width * np.sqrt(np.pi))
        # What the interpolated wings will add here is taken off again.
        inside = np.interp(grid[near], grid[::FAR][begin : end + 1], wing[begin : end + 1])
        total[near] += amount * profile - inside
        wings += wing
    return total + np.interp(grid, grid[::FAR], wings)


def emission(grid, atom, electrons, temperature, factor, excitation=1.0):
    """Light per atom over the partition sum [W sr-1 per cm-1] on a grid of ln(wavenumber).

    `factor`: one number per multiplet, `excitation`: temperature of the excited levels over that of the gas;
    their populations follow Boltzmann's law from the ground state.
    """
    found = lines(atom)
    photon = 1.98644586e-23 * found.wavenumber / (4 * np.pi)
    population = found.weight * np.exp(-C2 * found.energy / (excitation * temperature))
    strength = photon * population * found.probability * factor[found.multiplet.astype(int)]
    lorentz = stark(atom, found.energy, temperature, electrons) + found.decay / (4 * np.pi * 100 * LIGHT)
    return spread(grid, found, strength, doppler(atom, temperature), lorentz)
