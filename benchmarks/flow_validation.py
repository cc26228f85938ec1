"""Our torch against the published CF-ICP solution: what agrees, what differs, and which cause explains it.

    python benchmarks/flow_validation.py

Needs results/gas/air11.nc. Keeps its solutions in results/benchmark_flow and takes up where it stopped.
Writes docs/flow_validation.csv (one row per experiment) and docs/flow_validation.png for docs/flow.md.
"""

import logging
from dataclasses import dataclass, replace

import flow as bench  # first: it sets one thread
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from published_gas import COLUMNS, published_over_ours
from scipy.interpolate import PchipInterpolator

from plasmapyro.flow.balances import balances
from plasmapyro.flow.condition import Condition
from plasmapyro.flow.continuation import NotConverged, Schedule, march
from plasmapyro.flow.dataset import setup_of, state_from, to_dataset
from plasmapyro.flow.evaluate import transfer
from plasmapyro.flow.geometry import build_mesh
from plasmapyro.flow.problem import Problem
from plasmapyro.flow.properties import gas_properties
from plasmapyro.sightline.stage import on_line

matplotlib.use("agg")

# Cells of the public CF-ICP solution 282_5kW_70mbar_restart of COOLFluiD (70 mbar, 141.25 kW, 16 g/s,
# 370 kHz, no probe, 5130 quadrilaterals). How far it was converged is not stated there.
CELL_RADIUS = 3.75e-3  # [m]: centre of the cells next to the axis
# z [m], T [K], u_z [m/s] of the cells next to the axis
AXIS = (
    (0.049, 10831, -244), (0.232, 11245, -20), (0.399, 11257, 299),
    (0.506, 11119, 341), (0.601, 10825, 315), (0.700, 10300, 278), (0.797, 9477, 248), (0.875, 8481, 231),
    (0.991, 7152, 215), (1.195, 6457, 195),
)  # fmt: skip
# The jet: z [m], T [K] of the cells next to the axis, T of those beside them, u_z [m/s] of the former.
JET = (
    (1.138, 6599, 6506, 200.6), (1.111, 6666, 6562, 202.8), (1.085, 6739, 6622, 205.2),
    (1.060, 6821, 6688, 207.5), (1.036, 6915, 6761, 209.9), (1.013, 7024, 6843, 212.2),
    (0.991, 7152, 6937, 214.7), (0.970, 7307, 7047, 217.1), (0.949, 7493, 7178, 219.6),
    (0.929, 7713, 7334, 222.3), (0.911, 7962, 7518, 225.1), (0.892, 8224, 7728, 228.1),
    (0.875, 8481, 7956, 231.2), (0.858, 8722, 8188, 234.4), (0.842, 8943, 8414, 237.8),
    (0.826, 9141, 8627, 241.2), (0.811, 9319, 8823, 244.7), (0.797, 9477, 9002, 248.4),
    (0.783, 9620, 9164, 252.0), (0.770, 9748, 9311, 255.8), (0.757, 9863, 9445, 259.5),
    (0.745, 9968, 9566, 263.3), (0.733, 10063, 9677, 267.1), (0.722, 10149, 9778, 270.8),
    (0.711, 10228, 9871, 274.5), (0.700, 10300, 9956, 278.2), (0.690, 10366, 10035, 281.8),
    (0.680, 10427, 10107, 285.3), (0.671, 10482, 10174, 288.7), (0.662, 10534, 10236, 292.0),
    (0.653, 10581, 10293, 295.2), (0.645, 10624, 10346, 298.3), (0.637, 10665, 10396, 301.3),
)  # fmt: skip
BESIDE_AXIS, SIDE = 10.9e-3, 7.5e-3  # [m]: centre of the second cells, side between them and the first
# r [m], T [K] of the cells at the back wall, their centres 0.89 mm from it
WALL_CELLS = ((0.0109, 7630), (0.0287, 8774), (0.0458, 8901), (0.0575, 8690), (0.0654, 6927))
WALL_DISTANCE = 0.89e-3  # [m]
EXIT = 0.4851  # [m]: last cells of the torch; r [m], u_z [m/s], T [K]
EXIT_CELLS = (
    (0.00375, 342.5, 11160), (0.0109, 328.0, 11056), (0.0233, 261.4, 10292), (0.0287, 222.9, 9399),
    (0.0421, 142.4, 6248), (0.0458, 129.1, 5961), (0.0549, 111.1, 5225), (0.0575, 108.4, 4923),
    (0.0637, 103.3, 3234), (0.0654, 102.0, 3009), (0.0763, 75.6, 649), (0.0771, 66.4, 538), (0.080, 0.0, 350),
)  # fmt: skip
# Gauge pressure [Pa] where the flow stagnates on the axis, and beside it at r = 0.0637 m.
STAGNATION, BESIDE, PINCH = 0.25385, 0.0637, 62.4 - 6.9
POWER, PRESSURE = 141.25e3, 7e3
CASE = {"numerical_power": POWER, "chamber_pressure": PRESSURE, "coil_frequency": 3.7e5}
FREE_JET = {"probe_shape": "none", "chamber_length": 0.724}
MESH = 1.7
GENTLE = Schedule(
    20.0, 1e5, 60, growth=1.4, velocity_tolerance=3.0, temperature_tolerance=3e-2, linear_tolerance=1e-2
)
HOT_WALL = {"back_wall": 7200.0, "after": "back wall at 7200 K"}
AS_ON_AXIS = "back wall at 7200 K, published transport, conductivity as on its axis"
FINEST = "the same, back wall at 7500 K, finer mesh (1.2)"
CLOSED = "the same, 144 kW for the published enthalpy at the exit"
ON_AXIS = {"published": list(COLUMNS), "as_on_axis": True, **HOT_WALL}
# `after`: the experiment from which it continues; a hot back wall is reached in steps.
# `published`: properties of the gas that are those of the published code, see `published_gas.py`.
EXPERIMENTS = {
    "ours": {},
    "ours on a finer mesh (1.2)": {"mesh": 1.2},
    "back wall at 2500 K": {"back_wall": 2500.0},
    "back wall at 5000 K": {"back_wall": 5000.0, "after": "back wall at 2500 K"},
    "back wall at 6000 K": {"back_wall": 6000.0, "after": "back wall at 5000 K"},
    "back wall at 6700 K": {"back_wall": 6700.0, "after": "back wall at 6000 K"},
    "back wall at 7200 K": {"back_wall": 7200.0, "after": "back wall at 6700 K"},
    "back wall at 7200 K, published transport": {"published": list(COLUMNS), **HOT_WALL},
    AS_ON_AXIS: ON_AXIS,
    FINEST: {**ON_AXIS, "back_wall": 7500.0, "mesh": 1.2, "after": AS_ON_AXIS},
    CLOSED: {**ON_AXIS, "back_wall": 7500.0, "power": 144e3, "after": FINEST},
    "published transport": {"published": list(COLUMNS)},
    "viscosity x 2": {"gas": {"viscosity": 2.0}},
    "thermal conductivity +20 %": {"gas": {"thermal_conductivity": 1.2}},
    "electrical conductivity -20 %": {"gas": {"electrical_conductivity": 0.8}},
    "power +10 %": {"power": 155e3},
    "outer boundary at 0.30 m": {"torch": {"chamber_radius": 0.30}},
}
DRAWN = {  # and what the figure calls them
    "ours on a finer mesh (1.2)": "ours",
    "back wall at 7200 K": "and heat into the back wall as published",
    CLOSED: "and transport and heat through the exit as published",
}


@dataclass(frozen=True)
class Solution:
    """Fields as functions of (z, r) [m]: temperature [K], axial velocity [m/s], gauge pressure [Pa];
    heat into the back wall [W]."""

    temperature: object
    velocity: object
    gauge: object
    back_wall_heat: float


def of_dataset(found):
    def field(name, shift=0.0):
        def at(z, r):
            z, r = np.broadcast_arrays(np.asarray(z, float), np.asarray(r, float))
            return on_line(found, z, r, [name])[name] - shift

        return at

    heat = dict(zip(found.boundary.values, found.boundary_heat_flow.values, strict=True))
    return Solution(
        field("temperature"),
        field("axial_velocity"),
        field("pressure", float(found.chamber_pressure)),
        heat["back_wall"],
    )


def problem_of(setup, case, gas, change):
    """Problem of an experiment on a mesh of ours; `kind`: its class."""
    properties = gas_properties(gas, case.chamber_pressure, setup.wall_temperature)
    return change.get("kind", Problem)(
        build_mesh(setup.torch, setup.mesh_factor),
        setup.torch,
        properties,
        order=2,
        frequency=case.coil_frequency,
        mass_flow_rate=case.mass_flow_rate,
        wall_temperature=setup.wall_temperature,
        walls={
            "probe": case.probe_temperature,
            "back_wall": change.get("back_wall", setup.wall_temperature),
        },
        limiter=bench.TOLERANCES["viscosity_limiter"],
    )


def on_axis(properties, z, first, second, speed):
    r"""Thermal conductivity with which a jet cools on its axis over that of `properties`, by temperature.

    Balance of the cells next to the axis, of radius R: :math:`\rho u\,dh/dz = 2 k (T_2 - T_1)/(R\,\Delta r)`.
    """
    middle = (first + second) / 2
    gained = properties.density(first)[0] * speed * np.gradient(properties.enthalpy(first)[0], z)
    slope = 2 * (second - first) / ((BESIDE_AXIS - CELL_RADIUS) * SIDE)
    rising = np.argsort(middle)
    return middle[rising], (gained / slope / properties.thermal_conductivity(middle)[0])[rising]


def as_on_axis(library, gas, reference):
    """Factor on the conductivity of `gas` with which a flow of ours cools along its axis as the published.

    `library`, that of its properties, times what the published cells balance over what they would of
    `reference`, a flow in `gas`: so it holds what such cells do, too. Constant beyond the jet.
    """
    z, *jet = np.array(JET).T
    properties, found = gas_properties(gas, PRESSURE, bench.WALL), of_dataset(reference)
    fields = (found.temperature(z, CELL_RADIUS), found.temperature(z, BESIDE_AXIS))
    at, theirs = on_axis(properties, z, *jet)
    ours = np.interp(at, *on_axis(properties, z, *fields, found.velocity(z, CELL_RADIUS)))
    known = np.interp(at, gas["temperature"], library)
    table = np.stack([at, theirs, theirs / ours, known], axis=1)
    logging.warning("K, conductivity of its cells, with ours, of its library:\n%s", table[::3].round(3))
    return library * np.interp(gas["temperature"], at, theirs / ours / known)


def experiment(base, gas, change, label, reference=None):
    """Flow dataset of an experiment, continued from the flow dataset `base` of another one.

    With a `reference`, a flow in `gas`, the conductivity is that of `as_on_axis`.
    """
    old, case = setup_of(base), Condition.of(base)
    factors = published_over_ours(gas, case.chamber_pressure, change.get("published", []))
    if reference is not None:
        factors["thermal_conductivity"] = as_on_axis(factors["thermal_conductivity"], gas, reference)
    gas = bench.varied(gas, {**factors, **change.get("gas", {})})
    setup = replace(
        old,
        mesh_factor=change.get("mesh", old.mesh_factor),
        torch=replace(old.torch, **change.get("torch", {})),
    )
    source, target = problem_of(old, case, gas, {}), problem_of(setup, case, gas, change)
    state = transfer(state_from(base, source), source, target)
    result = march(target, state, change.get("power", case.numerical_power), GENTLE, label)
    found = balances(target, result.state, result.coupling)
    return to_dataset(target, setup, case, result, found)


def file_of(name):
    return "validation/" + name.replace(" ", "_").replace("%", "percent")


def flow_of(name, change, known):
    """The stored flow of an experiment; `known`: those before it, by name."""
    gas = bench.air()

    def compute():
        if name == "ours":
            return bench.solve(gas, bench.reference(MESH, **FREE_JET), **CASE)
        reference = known[HOT_WALL["after"]] if change.get("as_on_axis") else None
        return experiment(known[change.get("after", "ours")], gas, change, name, reference)

    return bench.stored(file_of(name), compute)


def flows(radius, velocity, temperature):
    """Mass [kg/s] and enthalpy [W] that a profile carries, quadrature of a monotone curve through it."""
    gas = gas_properties(bench.air(), PRESSURE, bench.WALL)
    fine = np.linspace(0, radius[-1], 2000)
    mirrored = np.concatenate([-radius[:1], radius])
    speed, heat = (
        PchipInterpolator(mirrored, np.concatenate([values[:1], values]))(fine)
        for values in (velocity, temperature)
    )
    flux = gas.density(heat)[0] * speed * 2 * np.pi * fine
    return np.trapezoid(flux, fine), np.trapezoid(flux * gas.enthalpy(heat)[0], fine)


def measures(found):
    """What a row of the table says of a solution, by column."""
    z = np.array([row[0] for row in AXIS])
    temperature, speed = found.temperature(z, CELL_RADIUS), found.velocity(z, CELL_RADIUS)
    at = {place: (t, u) for place, t, u in zip(z, temperature, speed, strict=True)}
    r = np.array([row[0] for row in EXIT_CELLS])[:-1]
    exit_speed, exit_temperature = found.velocity(EXIT, r), found.temperature(EXIT, r)
    _, enthalpy = flows(
        np.append(r, bench.TORCH["radius"]), np.append(exit_speed, 0), np.append(exit_temperature, bench.WALL)
    )
    pinch = np.diff(found.gauge(STAGNATION, np.array([BESIDE, CELL_RADIUS])))[0]
    near = found.temperature(WALL_DISTANCE, np.array([row[0] for row in WALL_CELLS]))
    return row_of(at, pinch, enthalpy, found.back_wall_heat, near)


def row_of(at, pinch, enthalpy, heat, near_wall):
    return {
        "backflow_m_s": f"{at[0.049][1]:.0f}",
        "torch_k": f"{at[0.049][0]:.0f}",
        "pinch_pa": f"{pinch:.1f}",
        "exit_m_s": f"{at[0.506][1]:.0f}",
        "station_m_s": f"{at[0.875][1]:.0f}",
        "station_k": f"{at[0.875][0]:.0f}",
        "end_k": f"{at[1.195][0]:.0f}",
        "exit_enthalpy_kw": f"{enthalpy / 1e3:.1f}",
        "back_wall_kw": f"{heat / 1e3:.1f}",
        "near_back_wall_k": f"{min(near_wall):.0f} to {max(near_wall):.0f}",
    }


def published():
    at = {z: (t, u) for z, t, u in AXIS}
    r, u, t = np.array(EXIT_CELLS).T
    mass, enthalpy = flows(r, u, t)
    logging.warning("published exit: %.2f g/s, %.1f kW", 1e3 * mass, enthalpy / 1e3)
    return row_of(at, PINCH, enthalpy, POWER - enthalpy, [row[1] for row in WALL_CELLS])


def draw(solutions):
    """Axis and exit profiles of the published solution and of the chosen ones."""
    figure, axes = plt.subplots(2, 2, figsize=(11, 7), layout="constrained")
    z, t, u = np.array(AXIS).T
    r, exit_u, exit_t = np.array(EXIT_CELLS).T
    for axis, x, y in ((axes[0, 0], z, t), (axes[1, 0], z, u), (axes[0, 1], 1e3 * r, exit_t),
                       (axes[1, 1], 1e3 * r, exit_u)):  # fmt: skip
        axis.plot(x, y, "ko", ms=4, label="published CF-ICP")
    fine_z, fine_r = np.linspace(5e-4, 1.2, 400), np.linspace(1e-4, 0.0799, 300)
    for colour, (name, found) in zip(("C0", "C3", "C1"), solutions.items(), strict=False):
        axes[0, 0].plot(fine_z, found.temperature(fine_z, CELL_RADIUS), color=colour, label=name)
        axes[1, 0].plot(fine_z, found.velocity(fine_z, CELL_RADIUS), color=colour)
        axes[0, 1].plot(1e3 * fine_r, found.temperature(EXIT, fine_r), color=colour)
        axes[1, 1].plot(1e3 * fine_r, found.velocity(EXIT, fine_r), color=colour)
    for axis, title, label in (
        (axes[0, 0], "next to the axis", "temperature [K]"),
        (axes[1, 0], "", "axial velocity [m/s]"),
        (axes[0, 1], "torch exit", ""),
        (axes[1, 1], "", ""),
    ):
        axis.set_title(title)
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    axes[1, 0].set_xlabel("axial position [m]")
    axes[1, 1].set_xlabel("radial position [mm]")
    axes[0, 0].legend(fontsize=8)
    figure.savefig(bench.DOCS / "flow_validation.png", dpi=150)
    plt.close(figure)


def main():
    rows, known = [{"experiment": "published", **published()}], {}
    for name, change in EXPERIMENTS.items():
        try:
            known[name] = flow_of(name, change, known)
        except (NotConverged, KeyError) as fault:
            logging.warning("%s: %s", name, fault)
            continue
        rows.append({"experiment": name, **measures(of_dataset(known[name]))})
        logging.warning("%s: %s", name, rows[-1])
        bench.write_table("flow_validation", rows)
    draw({called: of_dataset(known[name]) for name, called in DRAWN.items() if name in known})


if __name__ == "__main__":
    bench.begin(__doc__)
    logging.getLogger("plasmapyro").setLevel(logging.INFO)
    main()
