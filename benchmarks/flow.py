"""What the flow solver can do and what its inputs are worth.

    python benchmarks/flow.py sweep | probes | starts | modes

Each part keeps its solutions in results/benchmark_flow and takes up where it stopped. Needs
results/gas/air11.nc. One thread; CPU seconds. Writes docs/flow_*.csv, which docs/flow.md quotes.
`flow_matters.py` and `flow_validation.py` use its tools.
"""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import csv
import itertools
import logging
from pathlib import Path
from time import process_time

import numpy as np

from plasmapyro import io
from plasmapyro.flow import stage
from plasmapyro.flow.condition import Condition
from plasmapyro.flow.continuation import NotConverged
from plasmapyro.radiation.net_emission import net_emission
from plasmapyro.sightline.stage import on_line

ROOT = Path(__file__).parents[1]
DOCS, STORE = ROOT / "docs", ROOT / "results" / "benchmark_flow"
TORCH = {
    "length": 0.486,
    "radius": 0.080,
    "slot_inner_radius": 0.075,
    "chamber_length": 0.500,
    "chamber_radius": 0.160,
    "probe_distance": 0.385,
    "probe_radius": 0.025,
    "coil_radius": 0.109,
    "coil_positions": (0.127, 0.177, 0.227, 0.277, 0.327, 0.377),
    "probe_shape": "hemisphere",
    "shoulder_radius": 0.0,
}
REFERENCE = {
    "numerical_power": 90e3,
    "chamber_pressure": 5e3,
    "mass_flow_rate": 0.016,
    "coil_frequency": 4e5,
    "probe_temperature": 350.0,
}
TOLERANCES = {
    "viscosity_limiter": 0.02,
    "velocity_tolerance": 0.2,
    "temperature_tolerance": 2e-3,
    "largest_step_count": 120,
}
WALL = 350.0
POWER_STEP = 25e3  # parts that fail are halved
SWEEP = {"velocity_tolerance": 0.5, "temperature_tolerance": 5e-3}
SWEEP_MESH, FINE_MESH = 2.0, 1.0
SWEEP_PRESSURES = (15e2, 30e2, 65e2, 140e2, 300e2)
SWEEP_POWERS = (30e3, 50e3, 80e3, 125e3, 200e3)
SWEEP_FLOWS = (0.005, 0.012, 0.030)
NEIGHBOURS = 2


def air():
    return io.read(ROOT / "results/gas/air11.nc", "gas")


def stored(name, compute):
    """The flow file `name` of the store; computed first if it is not there."""
    path = STORE / f"{name}.nc"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        io.write(compute(), path, "flow")
    return io.read(path, "flow")


def reference(mesh_factor, gas=None, **torch):
    """Cold start on a mesh, in another gas, with another torch or probe if given."""
    kind = [] if gas is None else [gas.attrs["gas"]]
    name = "_".join(["reference", f"{mesh_factor:g}", *kind, *(f"{key}-{one}" for key, one in torch.items())])
    return stored(
        name,
        lambda: stage.cold_start(
            air() if gas is None else gas,
            torch={**TORCH, **torch},
            wall_temperature=WALL,
            mesh_factor=mesh_factor,
            start_mesh_factor=1.5,
            **REFERENCE,
            **TOLERANCES,
        ),
    )


def solve(gas, start, neighbours=(), emission=None, error_mesh_ratio=0.0, **changes):
    """Steady flow at the reference condition but for `changes`."""
    inputs = {**REFERENCE, "swirl_angle": 0.0, "radiation_factor": 0.0, **TOLERANCES, **changes}
    return stage.condition(
        gas,
        start,
        neighbours=neighbours,
        emission=emission,
        power_step=POWER_STEP,
        error_mesh_ratio=error_mesh_ratio,
        **inputs,
    )


def begin(words):
    """Help of a command without options, and a log with times."""
    argparse.ArgumentParser(
        description=words, formatter_class=argparse.RawDescriptionHelpFormatter
    ).parse_args()
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(message)s")


def write_table(name, rows):
    with (DOCS / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read_table(path):
    if not path.exists():
        return []
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def sweep():
    """5 pressures x 5 powers x 3 mass flows, each from the nearest solutions at hand.

    A case that the mesh of the sweep refuses, or finds no flow for, is solved again on that of the main job,
    as are at once those whose hot edge is thinner than the cells of the former. Whatever lies in the store
    serves as a beginning.
    """
    gas, starts = air(), {mesh: reference(mesh) for mesh in (SWEEP_MESH, FINE_MESH)}
    rows = {row["case"]: row for row in read_table(DOCS / "flow_sweep.csv")}
    cases = {}
    for pressure, power, flow in itertools.product(SWEEP_PRESSURES, SWEEP_POWERS, SWEEP_FLOWS):
        name = f"{pressure / 100:g}mbar_{power / 1e3:g}kW_{flow * 1e3:g}g_s"
        cases[name] = {
            **REFERENCE, "chamber_pressure": pressure, "numerical_power": power, "mass_flow_rate": flow
        }  # fmt: skip
    known = {path.stem: io.read(path, "flow") for path in sorted((STORE / "sweep").glob("*.nc"))}

    def left(name):
        row = rows.get(name)
        return row is None or (row["converged"] == "no" and float(row["mesh_factor"]) > FINE_MESH)

    def mesh_of(name):
        thin = cases[name]["numerical_power"] > 100e3 and cases[name]["chamber_pressure"] > 50e2
        return FINE_MESH if thin or name in rows else SWEEP_MESH

    def order(name):
        case = cases[name]
        near = min(way(one, Condition(**case)) for one in (*starts.values(), *known.values()))
        # Cheap cases first. On the fine mesh, the thinner the hot edge the later; on the coarse one much gas
        # or little power come late: these cases cost several tries.
        if mesh_of(name) == FINE_MESH:
            return 1, case["numerical_power"] * case["chamber_pressure"], near
        return 0, 2 * (case["mass_flow_rate"] > 0.02) + (case["numerical_power"] < 40e3), near

    def way(one, target):
        return Condition.of(one).parts_to(target, POWER_STEP)

    while waiting := [name for name in cases if left(name)]:
        name = min(waiting, key=order)
        mesh, began = mesh_of(name), process_time()
        earlier = rows.pop(name, {"cpu_s": 0.0})
        fresh = _solved(name, mesh, gas, starts[mesh], known, cases[name])
        known |= fresh.pop("known")
        rows[name] = fresh | {"cpu_s": round(process_time() - began + float(earlier["cpu_s"]), 1)}
        write_table("flow_sweep", list(rows.values()))
        logging.warning("%s: %s, %s s", name, fresh["converged"], rows[name]["cpu_s"])


def _swept(name, mesh):
    return f"sweep/{name}" + ("" if mesh == SWEEP_MESH else f"_mesh-{mesh:g}")


def _solved(name, mesh, gas, start, known, case):
    """Row of the table of one case of the sweep, and its solution under `known`."""
    target = Condition(**case)
    near = sorted(known.values(), key=lambda one: Condition.of(one).parts_to(target, POWER_STEP))
    row = {
        "case": name, "mesh_factor": f"{mesh:g}", "converged": "yes", "reason": "", "hottest_k": "",
        "coil_current_a": "", "mass_imbalance": "", "energy_imbalance": "", "known": {},
    }  # fmt: skip
    try:
        flow = stored(_swept(name, mesh), lambda: solve(gas, start, near[:NEIGHBOURS], **{**case, **SWEEP}))
    except NotConverged as fault:
        return row | {"converged": "no", "reason": str(fault).replace("\n", " / ")}
    return row | {
        "hottest_k": round(float(flow.temperature.max())),
        "coil_current_a": round(float(flow.coil_current)),
        "mass_imbalance": f"{float(flow.mass_imbalance):.2e}",
        "energy_imbalance": f"{float(flow.energy_imbalance):.2e}",
        "known": {Path(_swept(name, mesh)).name: flow},
    }


PROBES = {
    "hemisphere": {},
    "flat": {"probe_shape": "flat"},
    "blunt, shoulder of 11 mm": {"probe_shape": "blunt", "shoulder_radius": 0.011},
    "none": {"probe_shape": "none"},
}
PROBE_MESH = 2.0
AHEAD = (1e-3, 2e-3, 5e-3, 20e-3)  # [m] upstream of the stagnation point, on the axis


def on_axis(flow, z, *names):
    """Fields `names` of a flow at axial positions `z`, a list of arrays."""
    return list(on_line(flow, z, np.full_like(z, 1e-7), names).values())


def probes():
    """Every probe shape, and none, at the reference condition."""
    rows = []
    for probe, torch in PROBES.items():
        flow = reference(PROBE_MESH, **torch)
        nose = float(flow.attrs["stagnation_point_z"])
        temperature, pressure, speed = on_axis(
            flow, nose - np.array(AHEAD)[::-1], "temperature", "pressure", "axial_velocity"
        )
        heat = dict(zip(flow.boundary.values, flow.boundary_heat_flow.values, strict=True))
        rows.append(
            {
                "probe": probe,
                **{
                    f"temperature_{1e3 * ahead:g}_mm_k": round(float(value))
                    for ahead, value in zip(AHEAD, temperature[::-1], strict=True)
                },
                "speed_20_mm_m_s": round(float(speed[0]), 1),
                "stagnation_pressure_pa": round(float(pressure[-1] - flow.chamber_pressure), 1),
                "heat_to_probe_w": round(float(heat["probe"])),
                "mass_imbalance": f"{float(flow.mass_imbalance):.2e}",
                "energy_imbalance": f"{float(flow.energy_imbalance):.2e}",
            }
        )
        write_table("flow_probes", rows)
        logging.warning("%s", rows[-1])


AWAY = (80e3, 130e3)


def starts():
    """The reference condition on the default mesh from cold and back from other powers: what differs."""
    gas, cold = air(), reference(1.0)
    for power in AWAY:
        name = f"{power / 1e3:g}kW"
        away = stored(f"starts/{name}", lambda power=power: solve(gas, cold, numerical_power=power))
        back = stored(f"starts/back_from_{name}", lambda away=away: solve(gas, away))
        logging.warning(
            "90 kW back from %s: %.2g K, %.2g m/s, %.2g A from the cold start; %s itself %.2g K",
            name,
            np.abs(back.temperature - cold.temperature).max(),
            np.abs(back.axial_velocity - cold.axial_velocity).max(),
            abs(back.coil_current - cold.coil_current),
            name,
            np.abs(away.temperature - cold.temperature).max(),
        )


ABSORPTION_RADIUS, TURNS = 0.04, 2  # [m], 1


def modes():
    """What `flow.model: best` costs beside `paper`: one condition with its error estimate, both in turn."""
    gas, start, began = air(), reference(FINE_MESH), process_time()
    emission = net_emission(gas, absorption_radius=ABSORPTION_RADIUS)
    once, spent = process_time() - began, np.empty((TURNS, 2))
    for turn, factor in np.ndindex(spent.shape):
        began = process_time()
        solve(gas, start, (), emission, 1.41, numerical_power=AWAY[0], radiation_factor=float(factor))
        spent[turn, factor] = process_time() - began
    paper, best = spent.min(axis=0)
    logging.warning("80 kW from 90 kW: paper %.1f, best %.1f, its table once %.1f CPU s", paper, best, once)
    ratios = (best + once) / paper, (best + once / 9) / paper
    logging.warning("best over paper: %.2f for one condition, %.2f for nine", *ratios)


def varied(gas, factors):
    """The gas table with some properties multiplied."""
    return gas.assign({name: gas[name] * factor for name, factor in factors.items()})


PARTS = {"sweep": sweep, "probes": probes, "starts": starts, "modes": modes}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=PARTS)
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(message)s")
    logging.getLogger("plasmapyro").setLevel(logging.INFO)
    PARTS[parser.parse_args().part]()
