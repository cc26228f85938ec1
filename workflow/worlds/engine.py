"""Light of the gas along a path: one world draws its strengths once, within the scatter of published
accuracies."""

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import uniform_filter1d

from worlds import atoms, continuum, molecules
from worlds.gas import C2, composition, partition

POINTS, SHORT, LONG = 100_000, 655.0, 1245.0  # grid of ln(wavenumber); wavelengths [nm]
GRID = np.linspace(np.log(1e7 / LONG), np.log(1e7 / SHORT), POINTS)
EDGES = np.arange(660.0, 1240.0 + 1e-6, 0.02) * 1e-9  # of the bins that leave this module [m]
CENTRES = (EDGES[1:] + EDGES[:-1]) / 2
NODES = np.arange(2600.0, 13500.0, 700.0)  # [K] of the tables
LAYERS = 45
COLDEST = 2800.0  # [K] below which air gives no light between 0.66 and 1.24 um
COMPONENTS = ("N I", "O I", "N2 1P", "N2+ Meinel", "NO 11000 A", "continuum")
# Standard deviations of ln: accuracy classes and the spread of published sets.
SCATTER = {"multiplet": 0.08, "N2 1P": 0.06, "N2+ Meinel": 0.20, "NO 11000 A": 0.30, "continuum": 0.20}
PROGRESSION = 0.04  # of each upper v on its own


@dataclass
class World:
    """Strengths of one world; tables of light are kept per pressure and excitation."""

    seed: int
    scattered: bool = True
    _tables: dict = field(default_factory=dict)

    def __post_init__(self):
        random = np.random.default_rng([self.seed, 11])
        size = 1.0 if self.scattered else 0.0

        def factor(sigma, count=1):
            return np.exp(size * np.clip(random.normal(0, sigma, count), -2.5 * sigma, 2.5 * sigma))

        self.factors = {f"{atom} I": factor(SCATTER["multiplet"], 200) for atom in "NO"}
        for system in molecules.SYSTEMS:
            self.factors[system] = factor(SCATTER[system]) * factor(PROGRESSION, 20)
        self.factors["continuum"] = factor(SCATTER["continuum"], 4)

    def table(self, pressure, excitation=1.0, vibration=1.0):
        """ln of light per emitter over partition sum (5, nodes, POINTS) [W sr-1 per cm-1]."""
        key = (pressure, excitation, vibration)
        if key not in self._tables:
            if len(self._tables) > 2:  # 70 MB each
                self._tables.clear()
            n = composition(NODES, pressure)
            rows = [
                self._row(index, {k: v[index] for k, v in n.items()}, excitation, vibration)
                for index in range(NODES.size)
            ]
            self._tables[key] = np.log(_floored(np.array(rows))).astype(np.float32).transpose(1, 0, 2)
        return self._tables[key]

    def _row(self, index, n, excitation, vibration):
        temperature = NODES[index]
        row = [
            atoms.emission(GRID, atom, n["e-"], temperature, self.factors[f"{atom} I"], excitation)
            for atom in "NO"
        ]
        for system, (molecule, *_) in molecules.SYSTEMS.items():
            power = molecules.strengths(system, temperature, self.factors[system], vibration)
            row.append(
                _gaussian(molecules.lines(system).wavenumber, power, atoms.doppler(molecule, temperature))
            )
        return row

    def emission(self, temperature, n, pressure, excitation=1.0, vibration=1.0):
        """Emission coefficients (C, POINTS) [W m-3 sr-1 per cm-1] at one temperature."""
        table = self.table(pressure, excitation, vibration)
        upper = int(np.clip(np.searchsorted(NODES, temperature), 1, NODES.size - 1))
        share = (1 / temperature - 1 / NODES[upper - 1]) / (1 / NODES[upper] - 1 / NODES[upper - 1])
        light = np.exp((1 - share) * table[:, upper - 1] + share * table[:, upper]).astype(float)
        emitters = ["N", "O", *(one[0] for one in molecules.SYSTEMS.values())]
        per_sum = [n[one] / partition(one, np.array([temperature]))[0] for one in emitters]
        rough = np.exp(GRID[::100])
        smooth = self.factors["continuum"] @ continuum.families(rough, temperature, n)
        return np.concatenate(
            [light * np.array(per_sum)[:, None], np.interp(GRID, GRID[::100], smooth)[None]]
        )

    def shares(self, temperature, pressure):
        """What each strength contributes to the light of its component at a temperature [K].

        Rows of (component, standard deviation, share (bins,)): multiplets by their lines with wings of
        0.05 nm, progressions by theirs in 0.5 nm, continua.
        """
        n = {name: value[0] for name, value in composition(np.array([temperature]), pressure).items()}
        for place, atom in enumerate("NO"):
            found = atoms.lines(atom)
            light = (
                found.wavenumber * found.weight * found.probability * np.exp(-C2 * found.energy / temperature)
            )
            number, row = np.unique(found.multiplet, return_inverse=True)
            wings = np.zeros((number.size, CENTRES.size))
            for one, at, amount in zip(row, 1e-2 / found.wavenumber, light, strict=True):
                wings[one] += amount / ((CENTRES - at) ** 2 + 0.05e-9**2)
            yield from ((place, SCATTER["multiplet"], part) for part in wings / wings.sum(axis=0))
        for place, system in enumerate(molecules.SYSTEMS, start=2):
            found = molecules.lines(system)
            power = molecules.strengths(system, temperature, np.ones(20))
            bins = np.clip(np.searchsorted(EDGES, 1e-2 / found.wavenumber) - 1, 0, CENTRES.size - 1)
            upper = found.upper.astype(int)
            light = np.bincount(upper * CENTRES.size + bins, power, (upper.max() + 1) * CENTRES.size)
            light = uniform_filter1d(light.reshape(-1, CENTRES.size), 25, axis=1)
            share = light / np.maximum(light.sum(axis=0), 1e-12 * light.max())
            yield from ((place, PROGRESSION, part) for part in share)
        light = continuum.families(1e-2 / CENTRES, temperature, n)
        yield from ((len(COMPONENTS) - 1, SCATTER["continuum"], part) for part in light / light.sum(axis=0))

    def radiance(self, distance, temperature, pressure, excitation=1.0, vibration=1.0, depth=0.0):
        """Radiance (C, bins) [W m-2 sr-1 m-1] at the far end of a path that begins at the surface.

        `depth` is an optical depth by which the strongest line absorbs itself besides, others as their
        strength.
        """
        keep = np.flatnonzero(temperature > COLDEST)
        if not keep.size:
            return np.zeros((len(COMPONENTS), CENTRES.size))
        weight = np.gradient(distance)
        step = max(1, keep.size // LAYERS)
        total, tau = np.zeros((len(COMPONENTS), POINTS)), np.zeros(POINTS)
        wavenumber = np.exp(GRID)
        for group in np.array_split(keep, int(np.ceil(keep.size / step)))[::-1]:  # from the observer inwards
            length = weight[group].sum()
            kelvin = float(min(np.average(temperature[group], weights=weight[group]), NODES[-1]))
            n = {name: value[0] for name, value in composition(np.array([kelvin]), pressure).items()}
            light = self.emission(kelvin, n, pressure, excitation, vibration) * length
            own = light.sum(axis=0) / continuum.planck_wavenumber(wavenumber, kelvin)
            escape = np.exp(-tau) * -np.expm1(-np.maximum(own, 1e-12)) / np.maximum(own, 1e-12)
            total += light * escape
            tau += own
        if depth:
            shape = depth * tau / tau.max()
            total *= -np.expm1(-np.maximum(shape, 1e-12)) / np.maximum(shape, 1e-12)
        return _bins(total)


def _floored(rows):
    """Without what is below the noise of the transform, which would be extrapolated."""
    return np.maximum(rows, 1e-11 * rows.max(axis=2, keepdims=True))


def _gaussian(wavenumber, power, width):
    """Lines on the grid: each shared between two points, then one Gaussian in ln(wavenumber) for all [per
    cm-1]."""
    step = GRID[1] - GRID[0]
    place = (np.log(wavenumber) - GRID[0]) / step
    left = np.floor(place).astype(int)
    inside = (left >= 0) & (left < POINTS - 1)
    left, right, power = left[inside], (place - left)[inside], power[inside]
    comb = np.bincount(left, power * (1 - right), POINTS) + np.bincount(left + 1, power * right, POINTS)
    size = 2 * POINTS
    frequency = np.fft.rfftfreq(size, step)
    light = np.fft.irfft(np.fft.rfft(comb, size) * np.exp(-((np.pi * width * frequency) ** 2)), size)[:POINTS]
    return np.maximum(light, 0) / (step * np.exp(GRID))


def _bins(light):
    """Means over `EDGES` [per m] of light per wavenumber [per cm-1]."""
    wavenumber = np.exp(GRID)
    area = np.diff(wavenumber) * (light[:, 1:] + light[:, :-1]) / 2
    sums = np.concatenate([np.zeros((len(light), 1)), np.cumsum(area, axis=1)], axis=1)
    at = [np.interp(0.01 / EDGES, wavenumber, row) for row in sums]
    return -np.diff(np.array(at), axis=1) / np.diff(EDGES)
