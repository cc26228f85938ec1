"""What the flow solver can do and what its inputs are worth.

    python benchmarks/flow.py sweep | probes | starts | matters | validation

Each part keeps its solutions in results/benchmark_flow and takes up where it stopped. Needs
results/gas/air11.nc; `matters` also results/gas/net_emission.nc, and results/instrument and results/flow of
the main job. One thread; CPU
seconds. Writes docs/flow_*.csv, which docs/flow.md quotes, and docs/flow_matters.png.
"""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import argparse  # noqa: E402
import csv  # noqa: E402
import itertools  # noqa: E402
import logging  # noqa: E402
from pathlib import Path  # noqa: E402
from time import process_time  # noqa: E402

import matplotlib  # noqa: E402
import numpy as np  # noqa: E402
import xarray as xr  # noqa: E402

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402

from plasmapyro import io  # noqa: E402
from plasmapyro.analysis.stage import apparent_temperature  # noqa: E402
from plasmapyro.flow import stage  # noqa: E402
from plasmapyro.flow.condition import Condition  # noqa: E402
from plasmapyro.flow.continuation import NotConverged  # noqa: E402
from plasmapyro.gas.equilibrium import number_density  # noqa: E402
from plasmapyro.gas.species import SPECIES  # noqa: E402
from plasmapyro.radiation.bandsignal import gridded_signal  # noqa: E402
from plasmapyro.radiation.grid import log_grid  # noqa: E402
from plasmapyro.radiation.path import gas_path  # noqa: E402
from plasmapyro.radiation.systems import line_lists  # noqa: E402
from plasmapyro.radiation.table import emission_table, table_nodes, table_radiance  # noqa: E402
from plasmapyro.sightline import sampling  # noqa: E402
from plasmapyro.sightline.stage import line_of_sight  # noqa: E402

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
SWEEP_MESH = 2.0
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
    """Cold start on a mesh, with another torch or probe if given."""
    name = "_".join(["reference", f"{mesh_factor:g}", *(f"{key}-{value}" for key, value in torch.items())])
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
    """5 pressures x 5 powers x 3 mass flows, each from the nearest solutions at hand."""
    gas, start = air(), reference(SWEEP_MESH)
    rows = read_table(DOCS / "flow_sweep.csv")
    known = {
        row["case"]: io.read(STORE / "sweep" / f"{row['case']}.nc", "flow")
        for row in rows
        if row["converged"] == "yes"
    }
    left = {}
    for pressure, power, flow in itertools.product(SWEEP_PRESSURES, SWEEP_POWERS, SWEEP_FLOWS):
        name = f"{pressure / 100:g}mbar_{power / 1e3:g}kW_{flow * 1e3:g}g_s"
        left[name] = {
            **REFERENCE, "chamber_pressure": pressure, "numerical_power": power, "mass_flow_rate": flow
        }  # fmt: skip
    for row in rows:
        left.pop(row["case"])

    def hard(case):
        return case["mass_flow_rate"] > 0.02 or case["numerical_power"] < 40e3

    while left:

        def way(one, target):
            return Condition.of(one).parts_to(target, POWER_STEP)

        near = {
            name: min(way(one, Condition(**case)) for one in (start, *known.values()))
            for name, case in left.items()
        }
        # Much gas and little power come last: these cases cost several tries.
        name = min(near, key=lambda one: (hard(left[one]), near[one]))
        case = left.pop(name)
        target = Condition(**case)
        neighbours = sorted(known.values(), key=lambda one: way(one, target))[:NEIGHBOURS]  # noqa: B023
        began = process_time()
        row = {"case": name, "converged": "yes", "reason": ""}

        def compute(neighbours=neighbours, case=case):
            return solve(gas, start, neighbours, **{**case, **SWEEP})

        try:
            known[name] = stored(f"sweep/{name}", compute)
            row |= {
                "hottest_k": round(float(known[name].temperature.max())),
                "coil_current_a": round(float(known[name].coil_current)),
                "mass_imbalance": f"{float(known[name].mass_imbalance):.2e}",
                "energy_imbalance": f"{float(known[name].energy_imbalance):.2e}",
            }
        except NotConverged as fault:
            row |= {
                "converged": "no", "reason": str(fault).replace("\n", " / "), "hottest_k": "",
                "coil_current_a": "", "mass_imbalance": "", "energy_imbalance": "",
            }  # fmt: skip
        row["cpu_s"] = round(process_time() - began, 1)
        rows.append(row)
        write_table("flow_sweep", rows)
        logging.warning("%s: %s, %s s; %d left", name, row["converged"], row["cpu_s"], len(left))


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
    place = sampling.locate(
        flow.node_z.values, flow.node_r.values, flow.face_node.values, z, np.full_like(z, 1e-7)
    )
    return [
        sampling.interpolate(flow[name].values, flow.face_node.values, flow.face_midnode.values, place)
        for name in names
    ]


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


# What may be wrong with a simulated flow: inputs, and properties by the tolerances of their tests.
CAUSES = {
    "probe wall 1000 K": {"probe_temperature": 1000.0},
    "probe wall 1800 K": {"probe_temperature": 1800.0},
    "viscosity +5 %": {"gas": {"viscosity": 1.05}},
    "thermal conductivity +10 %": {"gas": {"thermal_conductivity": 1.10}},
    "electrical conductivity +10 %": {"gas": {"electrical_conductivity": 1.10}},
    "enthalpy +1 %": {"gas": {"enthalpy": 1.01}},
    "swirl 10 deg": {"swirl_angle": np.radians(10.0)},
    "radiation loss (lower bound)": {"radiation_factor": 1.0},
    "power efficiency +5 %": {"numerical_power": 1.05},
    "power efficiency -5 %": {"numerical_power": 0.95},
    "mass flow +5 %": {"mass_flow_rate": 0.016 * 1.05},
    "pressure +2 %": {"chamber_pressure": 5e3 * 1.02},
}
MATTERS_MESH = 2.0
MATTERS_POWERS = (90e3, 130e3)
OBJECTS = (1000.0, 1500.0, 2000.0)
EMITTANCE = 0.85
PATH = {
    "angle": np.radians(35.0),
    "points": 250,
    "window_distance": 0.8,
    "instrument_distance": 1.0,
    "laboratory_temperature": 300.0,
    "laboratory_pressure": 101325.0,
}


class Bench:
    """Band signals of the gas on a line of sight, from one emission table."""

    def __init__(self):
        self.response = io.read(ROOT / "results/instrument/response.nc", "response")
        self.curve = io.read(ROOT / "results/instrument/ratio_curve.nc", "ratio_curve")
        grid, nodes = log_grid((700e-9, 1200e-9), 160_000), table_nodes(1000.0, 12000.0)
        density = dict(zip(SPECIES, number_density(nodes, 5e3).T, strict=True))
        self.table = emission_table(line_lists(grid), grid, nodes, density)

    def signals(self, temperature, sightline):
        """Signals (2,) of the path with `temperature` (S,) in place of its own."""
        density = number_density(temperature, sightline.pressure.values)
        path = gas_path(
            sightline.path_distance.values, temperature, dict(zip(SPECIES, density.T, strict=True))
        )
        radiance = table_radiance(self.table, path)[0].sum(axis=0)[::-1]
        wavelength = self.table.grid.wavelength[::-1]
        return [
            gridded_signal(
                wavelength,
                radiance,
                self.response.wavelength.values,
                self.response[f"responsivity_{band}"].values,
            )
            for band in ("wide", "narrow")
        ]

    def readings(self, signals):
        """Apparent temperature (cases, OBJECTS) [K] for gas signals (cases, 2)."""
        gas = xr.Dataset(
            {
                "gas_signal": (("condition", "band"), np.array(signals)),
                "numerical_power": ("condition", np.ones(len(signals))),
                "sample_emittance": ("condition", np.full(len(signals), EMITTANCE)),
            },
            {"band": ["wide", "narrow"]},
        )
        found = apparent_temperature(gas, self.response, self.curve, object_temperature=np.array(OBJECTS))
        return found.apparent_temperature.values


def varied(gas, factors):
    """The gas table with some properties multiplied."""
    return gas.assign({name: gas[name] * factor for name, factor in factors.items()})


def matters():
    """Change of gas signal and pyrometer reading per cause, at two powers."""
    gas, start, bench = air(), reference(MATTERS_MESH), Bench()
    emission = io.read(ROOT / "results/gas/net_emission.nc", "net_emission")
    rows = []
    for power in MATTERS_POWERS:
        folder = f"matters/{power / 1e3:g}kW"
        base = stored(f"{folder}/base", lambda: solve(gas, start, numerical_power=power))  # noqa: B023
        paths, powers = {"base": line_of_sight(base, **PATH)}, {"base": power}
        for cause, change in CAUSES.items():
            change = dict(change)
            table = varied(gas, change.pop("gas", {}))
            share = change.pop("numerical_power", 1.0)

            def compute(change=change, table=table, share=share, power=power, base=base):
                inputs = {"numerical_power": power * share, **change}
                return solve(table, start, [base], emission, **inputs)

            name = cause.replace(" ", "_").replace("%", "percent")
            paths[cause] = line_of_sight(stored(f"{folder}/{name}", compute), **PATH)
            powers[cause] = power * share
        signals = {cause: bench.signals(path.temperature.values, path) for cause, path in paths.items()}
        exact = ROOT / "results" / "flow" / f"{power / 1e3:g}kW.nc"
        if exact.exists() and "temperature_error" in (own := io.read(exact, "flow")):
            path = line_of_sight(own, **PATH)
            warmer = path.temperature.values + path.temperature_error.values
            signals["mesh"] = bench.signals(warmer, path)
            signals["mesh, base"] = bench.signals(path.temperature.values, path)
        readings = dict(zip(signals, bench.readings(list(signals.values())), strict=True))
        for cause in signals:
            if cause.endswith("base"):
                continue
            zero = "mesh, base" if cause == "mesh" else "base"
            row = {"power_kw": f"{power / 1e3:g}", "cause": cause.replace("mesh", "mesh (estimated error)")}
            if cause in paths:
                hot, cold = (float(paths[each].temperature.max()) for each in (cause, zero))
                row["hottest_on_path_k"] = f"{hot - cold:+.0f}"
            else:
                row["hottest_on_path_k"] = f"{(warmer - path.temperature.values).max():+.0f} (largest)"
            row["gas_signal_percent"] = f"{100 * (signals[cause][0] / signals[zero][0] - 1):+.1f}"
            for place, target in enumerate(OBJECTS):
                change = readings[cause][place] - readings[zero][place]
                row[f"reading_at_{target:g}_k"] = "no reading" if np.isnan(change) else f"{change:+.1f}"
            rows.append(row)
        for place, target in enumerate(OBJECTS):
            logging.warning("%g kW: base reads %.1f K at %g K", power / 1e3, readings["base"][place], target)
        rows.append(
            {
                "power_kw": f"{power / 1e3:g}",
                "cause": "(error of the base reading)",
                "hottest_on_path_k": f"{float(paths['base'].temperature.max()):.0f} (value)",
                "gas_signal_percent": "",
                **{
                    f"reading_at_{target:g}_k": (
                        "no reading"
                        if np.isnan(readings["base"][place])
                        else f"{readings['base'][place] - target:+.1f}"
                    )
                    for place, target in enumerate(OBJECTS)
                },
            }
        )
    write_table("flow_matters", rows)
    draw_matters(rows)


def draw_matters(rows):
    figure, axes = plt.subplots(1, len(MATTERS_POWERS), figsize=(11, 4.5), sharey=True, layout="constrained")
    for axis, power in zip(axes, MATTERS_POWERS, strict=True):
        own = [r for r in rows if r["power_kw"] == f"{power / 1e3:g}" and not r["cause"].startswith("(")]
        place = np.arange(len(own))
        for shift, target, colour in zip((-0.27, 0, 0.27), OBJECTS, ("C0", "C1", "C3"), strict=True):
            cells = [row[f"reading_at_{target:g}_k"] for row in own]
            change = [np.nan if cell == "no reading" else float(cell) for cell in cells]
            axis.barh(place + shift, change, 0.26, color=colour, label=f"object at {target:g} K")
        axis.set_yticks(place, [row["cause"] for row in own])
        axis.set_xscale("symlog", linthresh=1.0)
        axis.axvline(0, color="0.3", lw=0.7)
        axis.set_xlabel("change of the pyrometer's reading [K]")
        axis.set_title(f"{power / 1e3:g} kW")
        axis.grid(axis="x", alpha=0.3)
    axes[0].invert_yaxis()
    axes[-1].legend(fontsize=8)
    figure.savefig(DOCS / "flow_matters.png", dpi=150)
    plt.close(figure)


# Axis of the public CF-ICP solution 282_5kW_70mbar_restart of COOLFluiD (70 mbar, 141.25 kW, 16 g/s,
# 370 kHz, no probe): z [m], T [K], u_z [m/s]. How far it was converged is not stated there.
PUBLISHED = (
    (0.049, 10831, -244),
    (0.232, 11245, -20),
    (0.399, 11257, 299),
    (0.506, 11119, 341),
    (0.601, 10825, 315),
    (0.700, 10300, 278),
    (0.797, 9477, 248),
    (0.875, 8481, 231),
    (0.991, 7152, 215),
    (1.195, 6457, 195),
)
PUBLISHED_CASE = {
    "numerical_power": 141.25e3,
    "chamber_pressure": 7e3,
    "coil_frequency": 3.7e5,
}
FREE_JET = {"probe_shape": "none", "chamber_length": 0.724}
VARIANTS = {
    "base": {},
    "viscosity x 2": {"gas": {"viscosity": 2.0}},
    "electrical conductivity -20 %": {"gas": {"electrical_conductivity": 0.8}},
    "thermal conductivity +20 %": {"gas": {"thermal_conductivity": 1.2}},
    "limiter 0.2 behind the torch": {"viscosity_limiter": 0.2},
    "outer boundary at 0.30 m": {"torch": {"chamber_radius": 0.30}},
    "finer mesh (1.41)": {"mesh": 1.41},
}
VALIDATION_MESH = 2.0


def validation():
    """The published CF-ICP axis profile, and what moves ours towards it."""
    gas = air()
    axis = np.array([row[0] for row in PUBLISHED])
    rows = []
    for variant, change in VARIANTS.items():
        mesh, torch = change.get("mesh", VALIDATION_MESH), {**FREE_JET, **change.get("torch", {})}

        def compute(change=change, mesh=mesh, torch=torch, variant=variant):
            start = reference(mesh, **torch)
            known = [] if variant == "base" else [stored("validation/base", compute)]
            limiter = {name: change[name] for name in ("viscosity_limiter",) if name in change}
            return solve(varied(gas, change.get("gas", {})), start, known, **{**PUBLISHED_CASE, **limiter})

        try:
            found = stored("validation/" + variant.replace(" ", "_").replace("%", "percent"), compute)
        except NotConverged as fault:
            logging.warning("%s: %s", variant, fault)
            continue
        place = sampling.locate(
            found.node_z.values, found.node_r.values, found.face_node.values, axis, np.full_like(axis, 1e-7)
        )
        temperature, speed = (
            sampling.interpolate(found[name].values, found.face_node.values, found.face_midnode.values, place)
            for name in ("temperature", "axial_velocity")
        )
        for (z, published_t, published_u), t, u in zip(PUBLISHED, temperature, speed, strict=True):
            rows.append(
                {
                    "variant": variant,
                    "z_m": z,
                    "published_k": published_t,
                    "temperature_k": round(float(t)),
                    "published_m_s": published_u,
                    "velocity_m_s": round(float(u)),
                }
            )
        write_table("flow_validation", rows)
        logging.warning("%s: %s K, %s m/s", variant, np.round(temperature), np.round(speed))


PARTS = {"sweep": sweep, "probes": probes, "starts": starts, "matters": matters, "validation": validation}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=PARTS)
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(message)s")
    logging.getLogger("plasmapyro").setLevel(logging.INFO)
    PARTS[parser.parse_args().part]()
