"""The gas in front of the sample and how its spectrum changes, from spectra and profiles kept in files.

The spectra at several powers, by radiating system, are input files. How they change with excitation,
vibration, temperature or optical depth is computed here from upper levels and the profile along the sight
line, in the optically thin limit; what falls on the sample from all of the torch absorbs itself (`incident`).
"""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import scipy

from twin import incident, light, lines, nitrogen

SECOND = 1.438776877  # [cm K] h c / k
DALTON = 1.66053907e-27  # [kg]
BIN = 0.02e-9  # [m] of the stored spectra
FIRST, LAST = 716e-9, 1156e-9
RADIATOR = {"N I": "N", "O I": "O", "N2 1P": "N2", "N2+ Meinel": "N2+"}
ATOMS = {"N I": (lines.NITROGEN, 96000.0), "O I": (lines.OXYGEN, 97000.0)}
BANDS = {"N2+ Meinel": (lines.MEINEL, 10500.0)}
NITROGEN_UPPER = 61000.0  # [cm-1] typical level that N2 1P shines from, above the ground state
LEVELS = (59000.0, 105000.0)  # [cm-1] above the ground state: levels of N2 B with their rotation
LINE_REACH = 5  # bins on either side of a line
FAINT_LINE = 1e-4  # of the strongest: below, nothing counts as a line
FOLLOWS = {  # the fainter systems: what their emission follows, with a typical upper level [cm-1]
    "NO 11000 A": ("NO", 55000.0),
    "NO beta": ("NO", 46000.0),
    "NO infrared": ("NO", 4000.0),
    "e-neutral free-free": ("e-", 10000.0),
    "O- detachment": ("e-", 12000.0),
    "e-ion free-free": ("e-", 10000.0),
    "free-bound": ("e-", 5000.0),
    "Ar I": ("Ar", 106000.0),
}


@dataclass(frozen=True)
class Spectra:
    """Radiance by system on equal bins, at one or several numerical powers.

    power (P,) [W]; centres (B,) [m]; systems: C names; radiance (P, C, B) [W m-2 sr-1 m-1].
    """

    power: np.ndarray
    centres: np.ndarray
    systems: tuple
    radiance: np.ndarray

    def at(self, power):
        """Radiance by system (C, B) at a power [W]: logarithms interpolated between neighbours."""
        if not self.power[0] <= power <= self.power[-1]:
            low, high = self.power[[0, -1]] / 1e3
            raise ValueError(f"power must lie in [{low:g}, {high:g}] kW; got {power / 1e3:g} kW")
        above = int(np.clip(np.searchsorted(self.power, power), 1, self.power.size - 1))
        low, high = np.log(self.power[above - 1 : above + 1])
        share = (np.log(power) - low) / (high - low)
        return light.between(share, *self.radiance[above - 1 : above + 1])


def spectra(datasets, powers):
    """`Spectra` from datasets with `gas_radiance_component` (component, wavelength), in order of power."""
    edges, centres = light.bins(FIRST, LAST, BIN)
    systems = tuple(str(name) for name in datasets[0].component.values)
    radiance = [
        [light.bin_mean(one.wavelength.values, row, edges) for row in one.gas_radiance_component.values]
        for one in datasets
    ]
    return Spectra(np.asarray(powers, dtype=float), centres, systems, np.array(radiance))


@dataclass(frozen=True)
class Gas:
    """The spectrum by system (C, B) at one power, and the profile that it comes from."""

    centres: np.ndarray  # (B,) [m]
    systems: tuple
    radiance: np.ndarray  # (C, B)
    distance: np.ndarray  # (Z,) [m]
    temperature: np.ndarray  # (Z,) [K]
    table_temperature: np.ndarray  # (T,) [K], composition at the pressure of the test:
    table_density: dict  # species: (T,) [m-3]
    weakest: np.ndarray | None = None  # (B,) spectrum of the weakest plasma, for an afterglow
    view: incident.View | None = None  # what shines on the sample, on the temperatures of the table

    @property
    def total(self):
        return self.radiance.sum(axis=0)

    def excited(self, ratio):
        """Spectrum (B,) with atoms excited at `ratio` times the temperature of the particles."""

        def factor(system, energy):
            return self._excitation(system, energy, ratio) if system in ATOMS else 1.0

        return self._with_factors(factor)

    def hotter(self, change):
        """Spectrum (B,) at temperatures T (1 + change) in the hot gas, in equilibrium at this pressure."""

        def factor(system, energy):
            return self._heating(system, energy, change)

        return self._with_factors(factor, self._changed_bands(factor))

    def rippled(self, amplitude):
        """Spectrum (B,) averaged over a sinusoidal ripple of the temperature."""
        phases = np.sin(2 * np.pi * (np.arange(8) + 0.5) / 8)
        return np.mean([self.hotter(amplitude * phase) for phase in phases], axis=0)

    def vibrating(self, ratio):
        """Spectrum (B,) with the vibration of N2 B at `ratio` times the temperature, its number kept."""
        mean = self._mean_temperature()
        changed = self.radiance.copy()
        changed[self.systems.index("N2 1P")] *= nitrogen.change(
            self.centres, mean, nitrogen.vibrational(mean, ratio)
        )
        return changed.sum(axis=0)

    def self_absorbed(self, depth):
        """Spectrum (B,) when the strongest O I line has the optical depth `depth` at its centre."""
        kept = np.ones(self.centres.size)
        for centre, relative in lines.OXYGEN_DEPTH:
            near = np.abs(self.centres * 1e9 - centre) < (0.08 if centre < 800 else 0.3)
            kept[near] = escape(depth * relative)
        changed = self.radiance.copy()
        changed[self.systems.index("O I")] *= kept
        return changed.sum(axis=0)

    def reflected(self, diffuse):
        """Spectrum (B,) that a surface returns of the gas if it absorbs nothing.

        The mirrored ray of an axisymmetric, thin plasma carries the radiance of the sight line itself. A
        share `diffuse` of the light is scattered as by a matt surface, the mean over all directions.
        """
        if diffuse == 0:
            return self.total
        if self.view is None:
            raise ValueError("diffuse reflection needs the flow field; without one, diffuse must be 0")
        return (1 - diffuse) * self.total + diffuse * self.incident

    @cached_property
    def incident(self):
        """Spectrum (B,) of the light on the stagnation point, mean over the half space with the cosine."""
        return self.falling(escaping)

    def falling(self, left):
        """As `incident`, with `left` (depths, dampings) for the share of a line that leaves the gas.

        ASSUME: what absorbs a line emits it too, mixed evenly; what lies in one or two bins is one line.
        """
        bands, found = self._changed_bands(self._all_around), np.zeros(self.centres.size)
        for row, system in enumerate(self.systems):
            if system in ATOMS:
                found += self._falling_lines(system, self.radiance[row], left)
            elif system == "N2 1P":
                found += self.radiance[row] * bands
            else:
                found += self.radiance[row] * self._by_level(system, self._all_around)
        return found

    def _changed_bands(self, factor):
        """How the bands of N2 1P change (B,) by factor(system, energy)."""
        energy = np.linspace(LEVELS[0], LEVELS[1], 12)
        gain = [np.log(factor("N2 1P", one)) for one in energy]

        def of_level(vibration, rotation):
            return np.exp(np.interp(vibration + rotation, energy, gain))

        return nitrogen.change(self.centres, self._mean_temperature(), of_level)

    @cached_property
    def _along(self):
        """Length (T,) [m] of gas at the temperatures of the table along the sight line."""
        return incident.along(self.distance, self.temperature, self.table_temperature)

    def _emitted(self, system, energy):
        return incident.emission(
            system, self._species(system), energy, self.table_temperature, self.table_density
        )

    def _all_around(self, system, energy):
        return self.view.mean(self._brighter(system, energy))

    def _brighter(self, system, energy):
        """Thin light (A,) from each direction over that of the sight line."""
        each = self._emitted(system, energy)
        return self.view.path @ each / (self._along @ each)

    def _falling_lines(self, system, radiance, left):
        """Spectrum (B,) of an atom, mean over the half space."""
        size = self.centres[1] - self.centres[0]
        inner = radiance[1:-1]
        top = (inner > radiance[:-2]) & (inner >= radiance[2:]) & (inner > FAINT_LINE * radiance.max())
        peak = np.flatnonzero(top) + 1
        if not peak.size:
            return np.zeros_like(radiance)
        line = np.searchsorted((peak[1:] + peak[:-1]) / 2, np.arange(radiance.size))
        near = np.abs(np.arange(radiance.size) - peak[line]) <= LINE_REACH
        area = np.bincount(line[near], radiance[near], peak.size) * size
        place = self.centres[peak]
        multiplets, other = ATOMS[system]
        energy = np.full(peak.size, other)
        for first, last, upper in multiplets:
            energy[(place >= first * 1e-9) & (place <= last * 1e-9)] = upper
        at = self.table_temperature
        speed = np.sqrt(2 * light.K * at / (incident.MASS[RADIATOR[system]] * DALTON))
        shine = np.empty(peak.size)
        for one in np.unique(energy):
            mine = energy == one
            each = self._emitted(system, one)
            unit = self._along @ each
            # Kirchhoff: a line emits the black body's light times its absorption.
            width = np.sqrt(np.pi) * place[mine] * speed[:, None] / light.C
            absorbed = each[:, None] / (light.planck(place[mine], at[:, None]) * width)
            depth = (self.view.path @ absorbed) * area[mine] / unit
            bright = (self.view.path @ each)[:, None] / unit
            lorentz = incident.stark(RADIATOR[system], one, place[mine]) * self.table_density["e-"][:, None]
            broadened = self.view.path @ (each[:, None] * lorentz * np.sqrt(np.pi) / width)
            damping = broadened / np.maximum(bright * unit, 1e-300)  # some directions are empty
            shine[mine] = self.view.mean(bright * left(depth, damping))
        return radiance * shine[line]

    def _with_factors(self, factor, shaped=None):
        """Spectrum (B,) with each system times factor(system, energy); N2 1P times `shaped` (B,) if given."""
        changed = np.empty_like(self.radiance)
        for row, system in enumerate(self.systems):
            given = system == "N2 1P" and shaped is not None
            changed[row] = self.radiance[row] * (shaped if given else self._by_level(system, factor))
        return changed.sum(axis=0)

    def _by_level(self, system, factor):
        """Factor(system, energy) of the levels that a system shines from, by wavelength (B,) if they differ;
        1 for a system without any."""
        parts = ATOMS.get(system) or BANDS.get(system)
        if parts is None:
            return factor(system, FOLLOWS[system][1]) if system in FOLLOWS else 1.0
        intervals, other = parts
        scale = np.full(self.centres.size, factor(system, other))
        for first, last, energy in intervals:
            inside = (self.centres >= first * 1e-9) & (self.centres <= last * 1e-9)
            scale[inside] = factor(system, energy)
        return scale

    def _species(self, system):
        return RADIATOR.get(system) or FOLLOWS[system][0]

    def _mean_temperature(self):
        """Where the first positive system of nitrogen shines."""
        weight = self._along * self._emitted("N2 1P", NITROGEN_UPPER)
        return weight @ self.table_temperature / weight.sum()

    def _excitation(self, system, energy, ratio):
        weight = self._along * self._emitted(system, energy)
        more = np.exp(SECOND * energy / self.table_temperature * (1 - 1 / ratio))
        return weight @ more / weight.sum()

    def _heating(self, system, energy, change):
        warmed = np.where(self.temperature > 2000, self.temperature * (1 + change), self.temperature)
        emitted = self._emitted(system, energy)
        smooth = scipy.interpolate.CubicSpline(
            self.table_temperature, np.log(emitted + 1e-30 * emitted.max())
        )
        new, old = (np.trapezoid(np.exp(smooth(at)), self.distance) for at in (warmed, self.temperature))
        return new / old


def escape(depth, damping=0.0):
    r"""Share of a line that leaves a uniform slab.

    .. math:: \frac{1}{\sqrt\pi\,\tau} \int (1 - e^{-\tau H(a, x)}) dx

    with the optical depth that a line broadened by Doppler alone would have at its centre, and the Lorentzian
    half width over the Doppler one as `damping`; :math:`H(0, x) = e^{-x^2}`.
    """
    if depth == 0:
        return 1.0
    place = np.linspace(-5, 5, 401) if damping == 0 else np.sinh(np.linspace(-9, 9, 1201))
    shape = np.exp(-(place**2)) if damping == 0 else np.real(scipy.special.wofz(place + 1j * damping))
    return float(np.trapezoid(-np.expm1(-depth * shape), place) / (np.sqrt(np.pi) * depth))


@cache
def _escape_table():
    depth, damping = np.geomspace(1e-3, 1e4, 85), np.geomspace(1e-3, 10.0, 41)
    kept = [[escape(one, other) for other in damping] for one in depth]
    return scipy.interpolate.RegularGridInterpolator((np.log(depth), np.log(damping)), kept)


def escaping(depth, damping):
    """`escape` of arrays, from a table; what lies beyond it counts as its edge."""
    table = _escape_table()
    place = [
        np.clip(np.log(np.maximum(values, 1e-30)), grid[0], grid[-1])
        for values, grid in zip((depth, damping), table.grid, strict=True)
    ]
    return table(tuple(place))


def narrow(centres, where, area):
    """Spectrum (B,) of lines at `where` [nm] with the integrated radiance `area` [W m-2 sr-1]."""
    spectrum = np.zeros(centres.size)
    for place, strength in zip(where, area, strict=True):
        sigma = 0.03e-9
        near = np.abs(centres - place * 1e-9) < 6 * sigma
        shape = np.exp(-(((centres[near] - place * 1e-9) / sigma) ** 2) / 2)
        spectrum[near] += strength * shape / (shape.sum() * (centres[1] - centres[0]))
    return spectrum


def heads(centres, where, area, tail, *, red):
    """Spectrum (B,) of bands with a sharp head and an exponential tail [nm] on one side."""
    spectrum = np.zeros(centres.size)
    for place, strength in zip(where, area, strict=True):
        away = (centres * 1e9 - place) * (1 if red else -1)
        shape = np.where(away >= 0, np.exp(-np.maximum(away, 0) / tail), 0.0)
        spectrum += strength * shape / (tail * 1e-9)
    return spectrum


def oxygen_band(wavelength):
    """Relative absorption (B,) of the A band of O2 at 296 K, smoothed over 1 nm; 1 at its maximum."""
    origin, upper, lower = lines.OXYGEN_BAND
    level = np.arange(1, 40, 2)
    population = np.exp(-SECOND * lower * level * (level + 1) / 296.0)
    place = np.concatenate(
        [
            origin + upper * (level + 1) * (level + 2) - lower * level * (level + 1),
            origin + upper * (level - 1) * level - lower * level * (level + 1),
        ]
    )
    strength = np.concatenate([population * (level + 1), population * level])
    sigma = 1e-9 / np.sqrt(8 * np.log(2))
    distance = (np.asarray(wavelength) - 1e-2 / place[:, None]) / sigma
    fine = np.linspace(755e-9, 775e-9, 800)
    peak = (
        (strength[:, None] * np.exp(-(((fine - 1e-2 / place[:, None]) / sigma) ** 2) / 2)).sum(axis=0).max()
    )
    return (strength[:, None] * np.exp(-(distance**2) / 2)).sum(axis=0) / peak
