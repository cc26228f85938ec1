"""Do coil or Lorentz force give the jet more momentum for its heat, or move it along the curve of the flows?

    python benchmarks/flow_momentum.py

On 5 000 triangles, 90 kW, 50 mbar, 16 g/s, one thing changed at a time; 100 kW gives the direction of the
curve. Needs results/gas/air11.nc. Keeps its flows in results/benchmark_flow, takes up where it stopped,
writes docs/flow_momentum.csv. About two CPU minutes.
"""

import logging
from dataclasses import replace

import flow as bench  # first: it sets one thread
import numpy as np
from flow_validation import experiment

from plasmapyro.facility.jet import own_heat_flux, own_pressure
from plasmapyro.flow.problem import Problem

MESH = 2.0
EXIT = bench.TORCH["length"]


class Pushed(Problem):
    """Equations with the Lorentz force multiplied by `factor`."""

    factor = 1.0

    def couple(self, state, power):
        found, current = super().couple(state, power)
        forces = {name: self.factor * getattr(found, name) for name in ("force_axial", "force_radial")}
        return replace(found, **forces), current


def coil(shift):
    return {"torch": {"coil_positions": tuple(round(z + shift, 6) for z in bench.TORCH["coil_positions"])}}


EXPERIMENTS = {
    "power +11 %": {"power": 100e3},
    "Lorentz force +20 %": {"kind": type("More", (Pushed,), {"factor": 1.2})},
    "Lorentz force -20 %": {"kind": type("Less", (Pushed,), {"factor": 0.8})},
    "coil 20 mm downstream": coil(0.02),
    "coil 20 mm upstream": coil(-0.02),
}


def row_of(name, flow, gas):
    speed, kelvin = bench.on_axis(flow, np.array([EXIT]), "axial_velocity", "temperature")
    return {
        "experiment": name,
        "exit_k": f"{kelvin[0]:.0f}",
        "exit_m_s": f"{speed[0]:.0f}",
        "stagnation_pressure_pa": f"{own_pressure(flow):.2f}",
        "heat_flux_kw_m2": f"{own_heat_flux(flow, gas) / 1e3:.0f}",
    }


def main():
    gas, start = bench.air(), bench.reference(MESH)
    rows = [row_of("90 kW", start, gas)]
    for name, change in EXPERIMENTS.items():
        key = "momentum/" + name.replace(" ", "_").replace("%", "percent")
        flow = bench.stored(key, lambda name=name, change=change: experiment(start, gas, change, name))
        rows.append(row_of(name, flow, gas))
        logging.warning("%s", rows[-1])
        points = [[float(row[key]) for key in ("heat_flux_kw_m2", "stagnation_pressure_pa")] for row in rows]
        (q, p), (q_more, p_more) = np.log(points[:2])
        slope = (p_more - p) / (q_more - q)
        for row, (flux, read) in zip(rows, np.log(points), strict=True):
            row["pressure_off_curve"] = f"{np.expm1(read - p - slope * (flux - q)):+.3f}"
        bench.write_table("flow_momentum", rows)


if __name__ == "__main__":
    bench.begin(__doc__)
    main()
