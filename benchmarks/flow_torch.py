"""Our torch beside the published one at 90 kW, 100 mbar, one thing switched at a time.

    python benchmarks/flow_torch.py

Needs results/gas/air11.nc. Keeps its solutions in results/benchmark_flow, takes up where it stopped and
writes docs/flow_torch.csv, the table of docs/flow.md.

Published: test case Plasmatron/Torch of the ICP plug-in of COOLFluiD (90 kW, 100 mbar, 16 g/s, 370 kHz, the
torch alone, its exit extrapolated; convergence not stated), on the axis.
"""

import argparse
import logging

import flow as bench  # first: it sets one thread
import numpy as np
from flow_validation import CELL_RADIUS, FREE_JET, MESH, experiment, of_dataset

from plasmapyro.flow.continuation import NotConverged

CASE = {"numerical_power": 90e3, "chamber_pressure": 1e4, "coil_frequency": 3.7e5}
PUBLISHED = {"hottest_k": 10113, "exit_k": 9683, "exit_m_s": 190, "backflow_m_s": -138}
EXIT = 0.4851  # [m]: last cells of the published torch
EXPERIMENTS = {
    "back wall at 350 K": {},
    "at 2500 K": {"back_wall": 2500.0},
    "at 5000 K": {"back_wall": 5000.0, "after": "at 2500 K"},
    "at 6000 K": {"back_wall": 6000.0, "after": "at 5000 K"},
    "at 7200 K": {"back_wall": 7200.0, "after": "at 6000 K"},
    "at 7200 K, viscosity +20 %, conductivity +5 %": {
        "back_wall": 7200.0,
        "gas": {"viscosity": 1.2, "thermal_conductivity": 1.05},
        "after": "at 7200 K",
    },
    "viscosity -20 %": {"gas": {"viscosity": 0.8}},
    "conductivity +20 %": {"gas": {"thermal_conductivity": 1.2}},
    "viscosity -20 %, conductivity +30 %": {"gas": {"viscosity": 0.8, "thermal_conductivity": 1.3}},
}


def measures(found):
    """Numbers of the table, next to the axis as the published ones."""
    z = np.linspace(1e-3, EXIT, 400)
    temperature, speed = found.temperature(z, CELL_RADIUS), found.velocity(z, CELL_RADIUS)
    return {
        "hottest_k": f"{temperature.max():.0f}",
        "exit_k": f"{temperature[-1]:.0f}",
        "exit_m_s": f"{speed[-1]:.0f}",
        "backflow_m_s": f"{speed.min():.0f}",
        "back_wall_kw": f"{found.back_wall_heat / 1e3:.1f}",
    }


def main():
    gas, known = bench.air(), {}
    rows = [{"experiment": "published", **PUBLISHED, "back_wall_kw": ""}]
    for name, change in EXPERIMENTS.items():

        def compute(name=name, change=change):
            if not known:
                return bench.solve(gas, bench.reference(MESH, **FREE_JET), **CASE)
            return experiment(known[change.get("after", next(iter(known)))], gas, change, name)

        try:
            known[name] = bench.stored("torch/" + name.replace(" ", "_").replace("%", "percent"), compute)
        except (NotConverged, KeyError) as fault:
            logging.warning("%s: %s", name, fault)
            continue
        rows.append({"experiment": name, **measures(of_dataset(known[name]))})
        logging.warning("%s: %s", name, rows[-1])
        bench.write_table("flow_torch", rows)


if __name__ == "__main__":
    argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    ).parse_args()
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(message)s")
    main()
