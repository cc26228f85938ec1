r"""Our torch beside the published one at 90 kW, 100 mbar, one thing switched at a time.

    python benchmarks/flow_torch.py

Needs results/gas/air11.nc. Keeps its solutions in results/benchmark_flow, takes up where it stopped and
writes docs/flow_torch.csv, the table of docs/flow.md.

Published: test case Plasmatron/Torch of the ICP plug-in of COOLFluiD, state torch_90kW-in.CFmesh (90 kW,
100 mbar, 16 g/s, 370 kHz, the torch alone, no gauge pressure at its exit), cells next to the axis. How it was
computed stands beside it: `AUSMIncomp.CFcase` sets the slopes in the cells to nought
(`LinearLS2D.gradientFactor = 0.`), so it is of first order, and its flux between two cells L and R
(`RhieChowFlux.ci`) carries beside the mean of both

.. math:: -\tfrac12 |\rho u_n| (u_R - u_L), \quad -\tfrac12 |\rho u_n| (h_R - h_L), \quad
          -\frac{p_R - p_L}{2\beta} \text{ of mass, with its enthalpy, but not its momentum},

beta = 100 m/s (`ConvTerm.uInf`). To first order in the width of the cells these are a viscosity, a
conductivity and a diffusion of mass; momentum, carried by a flow that mass does not keep, gains u div(rho u)
beside. `Coarse` adds these terms to our equations, with the widths of the published cells: no number is free.
"""

import logging
from contextlib import contextmanager
from dataclasses import dataclass, fields

import flow as bench  # first: it sets one thread
import numpy as np
from flow_validation import CELL_RADIUS, FREE_JET, MESH, experiment, of_dataset
from published_gas import COLUMNS

from plasmapyro.flow import problem
from plasmapyro.flow.continuation import NotConverged
from plasmapyro.flow.physics import (
    PROPERTY_NAMES,
    REFERENCE_PRESSURE,
    REFERENCE_VELOCITY,
    ROW_SCALE,
    SMALL_SPEED,
    Points,
    densities,
)
from plasmapyro.flow.properties import gas_properties

CASE = {"numerical_power": 90e3, "chamber_pressure": 1e4, "coil_frequency": 3.7e5}
PUBLISHED = {
    "hottest_k": 10113, "exit_k": 9683, "exit_m_s": 190, "backflow_m_s": -138,
    "core_g_s": 1.17, "core_kw": 43.5,
}  # fmt: skip
EXIT = 0.4851  # [m]: last cells of the published torch
CORE = 0.038  # [m]: radius within which mass and heat leave through the exit, `core_*`
BETA = 100.0  # [m s-1]
GROWTH, FIRST, HALF = 1.09, 1.78273e-3, 30  # of the published cells along the torch, from either end on
# r [m] of the sides of the published cells; eight more between the last two
SIDES = 1e-3 * np.array(
    [0, 7.5, 14.320, 20.520, 26.159, 31.286, 35.947, 40.186, 44.040, 47.545, 50.731, 53.629, 56.263, 58.659,
     60.837, 62.818, 64.619, 66.256, 67.746, 69.099, 70.331, 71.450, 72.468, 73.393, 74.235, 75.0, 80.0]
)  # fmt: skip
SLOT_CELL = 0.6e-3  # [m]
# p [Pa], u_z, u_r [m s-1], T [K] of five published cells next to the axis and of the five beside them; the
# first is the 29th from the back wall.
AXIS_CELLS = (
    (29.76227, -44.40487, -3.446582, 10025.31), (32.51663, -11.41617, -3.884602, 10065.14),
    (34.19633, 27.19416, -3.797006, 10095.94), (34.45750, 56.55765, -3.403286, 10108.47),
    (33.37358, 83.14544, -3.232245, 10113.27),
)  # fmt: skip
CELLS_BESIDE = (
    (28.93460, -32.06350, -13.90660, 9999.06), (31.71272, -1.50096, -14.66344, 10050.64),
    (33.43398, 30.17271, -14.24192, 10085.38), (33.71602, 56.72511, -13.35593, 10101.11),
    (32.67952, 80.85162, -12.73630, 10105.15),
)  # fmt: skip
FIRST_CELL = 28
PLANE = {"chamber_length": 0.02, "chamber_radius": 0.085, "probe_distance": 0.005, "probe_radius": 0.005}
HOT_BOTH = {"upwind": 1.0, "leak": 1.0, "back_wall": 7e3, "after": "both, at 7000 K"}
# `after`: the experiment from which it continues; `upwind`, `leak`: shares of the published terms;
# `published`: properties of the gas that are those of the published code (`published_gas.py`).
EXPERIMENTS = {
    "back wall at 350 K": {},
    "at 2500 K": {"back_wall": 2500.0},
    "at 5000 K": {"back_wall": 5000.0, "after": "at 2500 K"},
    "at 6000 K": {"back_wall": 6000.0, "after": "at 5000 K"},
    "at 7200 K": {"back_wall": 7200.0, "after": "at 6000 K"},
    "viscosity -20 %": {"gas": {"viscosity": 0.8}},
    "conductivity +20 %": {"gas": {"thermal_conductivity": 1.2}},
    "exit without a chamber": {"torch": PLANE},
    "upwinding, a half": {"upwind": 0.5},
    "upwinding of the published cells": {"upwind": 1.0, "after": "upwinding, a half"},
    "leak, a third": {"leak": 0.3},
    "leak of the published cells": {"leak": 1.0, "after": "leak, a third"},
    "both, leak a third": {"upwind": 1.0, "leak": 0.3, "after": "upwinding of the published cells"},
    "both": {"upwind": 1.0, "leak": 1.0, "after": "both, leak a third"},
    "both, back wall at 2500 K": {"upwind": 1.0, "leak": 1.0, "back_wall": 2500.0, "after": "both"},
    "both, at 5000 K": {"upwind": 1.0, "leak": 1.0, "back_wall": 5e3, "after": "both, back wall at 2500 K"},
    "both, at 6000 K": {"upwind": 1.0, "leak": 1.0, "back_wall": 6e3, "after": "both, at 5000 K"},
    "both, at 7000 K": {"upwind": 1.0, "leak": 1.0, "back_wall": 7e3, "after": "both, at 6000 K"},
    "both, at 7000 K, published thermal conductivity": {**HOT_BOTH, "published": ["thermal_conductivity"]},
    "both, at 7000 K, published transport": {**HOT_BOTH, "published": list(COLUMNS)},
    "published transport": {"published": list(COLUMNS)},
}


def sides_along(length):
    """z [m] of the sides of the published cells (61,)."""
    half = np.concatenate([[0.0], FIRST * np.cumsum(GROWTH ** np.arange(HALF))])
    half *= length / 2 / half[-1]
    return np.concatenate([half, length - half[-2::-1]])


def width(sides, places):
    """Width [m] of the published cells, at places between their middles."""
    return np.interp(places, (sides[1:] + sides[:-1]) / 2, np.diff(sides))


@dataclass(frozen=True)
class CoarsePoints(Points):
    """`Points` with the widths of the published cells [m], times the share that acts."""

    upwind_z: np.ndarray
    upwind_r: np.ndarray
    leak_z: np.ndarray
    leak_r: np.ndarray


class Coarse(problem.Problem):
    """A Problem with the published terms."""

    upwind, leak = 0.0, 0.0

    def points(self, state, coupling, courant):
        plain, cells = super().points(state, coupling, courant), self.space.cells
        inside = cells.z < self.torch.length
        along = inside * width(sides_along(self.torch.length), cells.z)
        across = inside * np.where(cells.r > SIDES[-2], SLOT_CELL, width(SIDES, cells.r))
        own = {one.name: getattr(plain, one.name) for one in fields(plain)}
        widths = {"z": along, "r": across}
        return CoarsePoints(
            **own,
            **{f"upwind_{axis}": self.upwind * size for axis, size in widths.items()},
            **{f"leak_{axis}": self.leak * size for axis, size in widths.items()},
        )


def coarse_densities(inputs, lines, points):
    """`physics.densities` with the terms of the module."""
    rows = densities(inputs, lines, points)
    uz, uz_z, uz_r, ur, ur_z, ur_r = (REFERENCE_VELOCITY * field for field in inputs[:6])
    temperature = np.exp(inputs[6])
    t_z, t_r = temperature * inputs[7], temperature * inputs[8]
    at = {name: lines[name][0] + lines[name][1] * (temperature - lines[name][2]) for name in PROPERTY_NAMES}
    density, capacity, enthalpy = at["density"], at["heat_capacity"], at["enthalpy"]
    along = density * np.sqrt(uz * uz + SMALL_SPEED**2) * points.upwind_z / 2
    across = density * np.sqrt(ur * ur + SMALL_SPEED**2) * points.upwind_r / 2
    leak_z, leak_r = (
        size / (2 * BETA) * REFERENCE_PRESSURE * slope
        for size, slope in ((points.leak_z, inputs[10]), (points.leak_r, inputs[11]))
    )
    expansion = at["density_slope"] / density * (uz * t_z + ur * t_r)
    kept = density * (uz_z + ur_r + ur / points.radius + expansion) * (points.leak_z > 0)
    added = {
        0: uz * kept,
        1: along * uz_z,
        2: across * uz_r,
        3: ur * kept,
        4: along * ur_z,
        5: across * ur_r,
        7: along * capacity * t_z + leak_z * enthalpy,
        8: across * capacity * t_r + leak_r * enthalpy,
        10: leak_z,
        11: leak_r,
    }
    return [row + ROW_SCALE[place] * added.get(place, 0.0) for place, row in enumerate(rows)]


@contextmanager
def kind_of(change):
    """Class of the problem of an experiment, its equations in force."""
    shares = {name: change[name] for name in ("upwind", "leak") if name in change}
    if not shares:
        yield problem.Problem
        return
    plain, problem.densities = problem.densities, coarse_densities
    try:
        yield type("CoarseOfShares", (Coarse,), shares)
    finally:
        problem.densities = plain


def leak_speed(gas):
    """beta [m s-1] at which each published cell keeps its mass: what its velocities bring over what leaks."""
    properties = gas_properties(gas, CASE["chamber_pressure"], bench.WALL)
    sides = sides_along(bench.TORCH["length"])[FIRST_CELL:][: len(AXIS_CELLS) + 1]
    (pressure, axial, radial, temperature), beside = np.array(AXIS_CELLS).T, np.array(CELLS_BESIDE).T
    density, density_beside = (properties.density(t)[0] for t in (temperature, beside[3]))
    flow = (density[1:] * axial[1:] + density[:-1] * axial[:-1]) / 2
    outward = ((density * radial + density_beside * beside[2]) / 2)[1:-1] * np.diff(sides)[1:-1]
    leak_out = (beside[0] - pressure)[1:-1] * np.diff(sides)[1:-1]
    brought = np.diff(flow) * SIDES[1] / 2 + outward
    return (np.diff(pressure, 2) * SIDES[1] / 2 + leak_out) / 2 / brought


def measures(found, properties):
    """Numbers of the table, next to the axis as the published ones."""
    z = np.linspace(1e-3, EXIT, 400)
    r = np.linspace(1e-5, CORE, 400)
    hot = found.temperature(EXIT, r)
    flux = 2 * np.pi * r * properties.density(hot)[0] * found.velocity(EXIT, r)
    temperature, speed = found.temperature(z, CELL_RADIUS), found.velocity(z, CELL_RADIUS)
    return {
        "hottest_k": f"{temperature.max():.0f}",
        "exit_k": f"{temperature[-1]:.0f}",
        "exit_m_s": f"{speed[-1]:.0f}",
        "backflow_m_s": f"{speed.min():.0f}",
        "core_g_s": f"{1e3 * np.trapezoid(flux, r):.2f}",
        "core_kw": f"{np.trapezoid(flux * properties.enthalpy(hot)[0], r) / 1e3:.1f}",
        "back_wall_kw": f"{found.back_wall_heat / 1e3:.1f}",
    }


def main():
    gas, known = bench.air(), {}
    properties = gas_properties(gas, CASE["chamber_pressure"], bench.WALL)
    logging.warning("the published cells keep their mass with beta = %s m/s", leak_speed(gas).round(1))
    rows = [{"experiment": "published", **PUBLISHED, "back_wall_kw": ""}]
    for name, change in EXPERIMENTS.items():

        def compute(name=name, change=change):
            if not known:
                return bench.solve(gas, bench.reference(MESH, **FREE_JET), **CASE)
            with kind_of(change) as kind:
                base = known[change.get("after", next(iter(known)))]
                return experiment(base, gas, change | {"kind": kind}, name)

        try:
            known[name] = bench.stored("torch/" + name.replace(" ", "_").replace("%", "percent"), compute)
        except (NotConverged, KeyError) as fault:
            logging.warning("%s: %s", name, fault)
            continue
        rows.append({"experiment": name, **measures(of_dataset(known[name]), properties)})
        logging.warning("%s: %s", name, rows[-1])
        bench.write_table("flow_torch", rows)


if __name__ == "__main__":
    bench.begin(__doc__)
    main()
