"""Surface temperature of slabs, lumped bodies, two zones and ablators in a jet that heats and a room that
cools."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

STEFAN = 5.670374419e-8
KINDS = ("slab", "lumped", "two-zone", "ablating")


@dataclass(frozen=True)
class Sample:
    """Thermal properties in SI; what a kind does not use is ignored."""

    kind: str
    emittance: float
    flux: float  # cold-wall heat flux [W m-2]
    rise: float  # time constant of the flux [s]
    recovery: float  # [K] temperature at which convection stops heating
    depth: float  # thickness [m]
    conductivity: float
    capacity: float  # per volume
    contact: float  # to the holder [W m-2 K-1]
    recession: float  # [m s-1] at 2000 K, of an ablator
    start: float = 350.0

    def history(self, time, plasma_off):
        """Surface temperature (t,) [K]: implicit finite volumes, the flux zero before 0 and after
        `plasma_off` [s]."""
        cells = {"slab": 30, "ablating": 50, "two-zone": 2, "lumped": 1}[self.kind]
        # Thin cells in front: a surface that cools as the root of time is steep there.
        width = np.geomspace(1, 100 if cells > 2 else 1, cells)
        width *= self.depth / width.sum()
        between = self.conductivity / ((width[1:] + width[:-1]) / 2)
        if self.kind == "two-zone":
            between = np.array([self.contact * 3])
        marks = np.unique(np.concatenate([_steps(plasma_off), [time.max() + 1]]))
        temperature, surface = np.full(cells, self.start), [self.start]
        for begin, end in zip(marks[:-1], marks[1:], strict=True):
            temperature = self._step(temperature, width, between, (begin + end) / 2, end - begin, plasma_off)
            surface.append(temperature[0])
        return np.where(time < 0, self.start, np.interp(time, marks, surface))

    def _step(self, old, width, between, at, length, plasma_off):
        heat = self.flux * (1 - np.exp(-at / self.rise)) if at < plasma_off else 0.0
        new = old.copy()
        for _ in range(3):  # fourth power and ablation, by Newton's method
            front = new[0]
            loss = self.emittance * STEFAN * (front**4 - 300.0**4)
            slope = 4 * self.emittance * STEFAN * front**3 + heat / self.recovery
            gain = heat * (1 - front / self.recovery) - loss
            velocity = 0.0
            if self.kind == "ablating":
                velocity = self.recession * np.exp(-25000.0 * (1 / front - 1 / 2000.0)) * (at < plasma_off)
                gain -= velocity * 2e10  # heat of ablation per volume
                slope += velocity * 2e10 * 25000.0 / front**2
            stiff = self.capacity * width / length
            diagonal = stiff.copy()
            diagonal[:-1] += between
            diagonal[1:] += between
            diagonal[0] += slope
            diagonal[-1] += self.contact
            right = stiff * old
            right[0] += gain + slope * front
            right[-1] += self.contact * 320.0
            upper, lower = -between.copy(), -between.copy()
            if velocity:  # the surface moves into the body, cell by cell from behind
                carried = self.capacity * velocity
                diagonal[:-1] += carried
                upper = upper - carried
            bands = np.zeros((3, old.size))
            bands[0, 1:], bands[1], bands[2, :-1] = upper, diagonal, lower
            new = solve_banded((1, 1), bands, right)
        return new


def _steps(off):
    """Times of the integration [s]: fine after each switch."""
    early = np.concatenate([np.arange(0, 3, 0.02), np.arange(3, 20, 0.1), np.arange(20, 80, 0.5)])
    late = off + np.concatenate([np.geomspace(1e-3, 1, 40), np.arange(1.05, 60, 0.1)])
    return np.concatenate([early[early < off], np.arange(80, off, 2.0), [off], late])


def draw(random, kind=None):
    """A sample that ends between about 1000 and 2000 K."""
    kind = kind or str(random.choice(KINDS))
    emittance = float(random.uniform(0.78, 0.92) if random.random() < 0.6 else random.uniform(0.35, 0.78))
    final = random.uniform(1150, 1950)
    recovery = random.uniform(4500, 7000)
    contact = random.uniform(20, 80)
    body = {
        "slab": (random.uniform(3e-3, 12e-3), random.uniform(2, 40), random.uniform(2.0e6, 3.5e6)),
        "lumped": (random.uniform(2e-3, 5e-3), 50.0, random.uniform(2.0e6, 3.5e6)),
        "two-zone": (random.uniform(4e-3, 8e-3), 50.0, random.uniform(2.0e6, 3.5e6)),
        "ablating": (random.uniform(15e-3, 30e-3), random.uniform(0.3, 2.0), random.uniform(0.3e6, 1.2e6)),
    }[kind]
    flux = (emittance * STEFAN * final**4 + contact * (0.5 * final - 320) * (kind != "ablating")) / (
        1 - final / recovery
    )
    return Sample(
        kind,
        emittance,
        float(flux),
        float(random.uniform(0.3, 2.0)),
        recovery,
        *map(float, body),
        contact,
        float(random.uniform(5e-6, 5e-5)),
    )
