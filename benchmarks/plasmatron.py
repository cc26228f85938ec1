"""Numbers of docs/plasmatron.md.

python benchmarks/plasmatron.py FOLDER [RESULTS]     pairs of AblaNTIS rebuilt, its readings corrected
python benchmarks/plasmatron.py mixing [RESULTS]     probes in jets of more viscosity and conductivity

FOLDER holds the data set (doi 10.5281/zenodo.15938723, CC BY-NC, not shipped); RESULTS is a finished run. The
jets take some 10 CPU minutes.
"""

import argparse
from pathlib import Path

import numpy as np

from plasmapyro import io, tables
from plasmapyro.analysis.reading import correct_reading
from plasmapyro.commands.correct_reading import read_readings
from plasmapyro.facility.probes import Calorimeter
from plasmapyro.facility.rebuild import rebuild
from plasmapyro.facility.stage import probe_readings
from plasmapyro.flow.stage import condition

ASSUMED = (1.0, 0.1, 0.0265, 0.01)
SETTINGS = {"floor": 1263.0, "quantum": 1.0, "noise": 14.0, "emittance": 0.9, "draws": 200, "seed": 1}
UNCERTAINTY = {"emittance_uncertainty": 0.05, "power_uncertainty": 0.08, "engine_uncertainty": 0.1}
MIXED = {1.5: (90, 70, 60), 2.0: (90, 70, 55, 130, 180)}  # powers [kW], each from the ones before
PROBES = {"rates": ["kossyi"], "recombination": [0.1, 0.01], "probe_radius": 0.025}
PROBES |= {"wall_temperature": 350.0, "pitot_radius": [0.025, 0.005]}
FLOW = {
    "chamber_pressure": 5000.0,
    "mass_flow_rate": 0.016,
    "coil_frequency": 4e5,
    "probe_temperature": 350.0,
}
FLOW |= {"swirl_angle": 0.0, "radiation_factor": 0.0, "viscosity_limiter": 0.02, "power_step": 1e4}
FLOW |= {"error_mesh_ratio": 0.0, "velocity_tolerance": 0.2, "temperature_tolerance": 2e-3}
FLOW |= {"largest_step_count": 120}
CONDITIONS = ("50kW", "60kW", "80kW")


def pairs():
    table = tables.load("facility/plasmatron_pairs")
    for name, flux, pressure in zip(
        *(table[key] for key in ("pair", "heat_flux", "dynamic_pressure")), strict=True
    ):
        for gamma in ASSUMED:
            calorimeter = Calorimeter(0.025, recombination=gamma)
            found = rebuild(flux, pressure, 5000.0, calorimeter, chemistry="kossyi", pitot_factor=1.1)
            print(
                f"{name} {gamma:g}: {found.temperature:.0f} K, {found.enthalpy / 1e6 + 0.30:.2f} MJ/kg,"
                f" {found.speed:.1f} m/s"
            )


def readings(folder, results):
    names = {"gas_signal": "analysis/gas_signal", "response": "instrument/response"}
    names["ratio_curve"] = "instrument/ratio_curve"
    files = [io.read(results / f"{path}.nc", contract) for contract, path in names.items()]
    for path in sorted(folder.rglob("stag_point_temp*.dat")):
        time, shown = read_readings(path)
        for name in CONDITIONS:
            found = correct_reading(
                *files, condition=name, time=time, reading=shown, **SETTINGS, **UNCERTAINTY
            )
            moved = (found.apparent_temperature - found.surface_temperature).values
            low, middle, high = np.nanquantile(moved, (0, 0.5, 1))
            print(
                f"{path.parent.name} behind the air of {name}: {low:+.1f} to {high:+.1f} K,"
                f" median {middle:+.1f} K"
            )


def mixing(results):
    gas, start = io.read(results / "gas/air11.nc", "gas"), io.read(results / "flow/90kW.nc", "flow")
    for factor, powers in MIXED.items():
        mixed = gas.copy(deep=True)
        for name in ("viscosity", "thermal_conductivity"):
            mixed[name] = factor * gas[name]
        known = [start]
        for power in powers:
            known.append(
                condition(mixed, known[-1], neighbours=known[:-1], numerical_power=power * 1e3, **FLOW)
            )
            found = probe_readings(known[-1], gas, **PROBES)
            flux, pitot = found.stagnation_heat_flux.values[0] * 1e-3, found.pitot_pressure.values
            values = [float(found[name]) for name in ("edge_temperature", "edge_enthalpy", "jet_speed")]
            print(f"{factor:g}, {power} kW: K, J/kg, m/s {values}; Pitot [Pa] {pitot}")
            print(f"  kW/m2: {float(found.equilibrium_heat_flux) * 1e-3:.0f}, gamma 0.1 and 0.01 {flux}")


def parser():
    """The argument parser."""
    top = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    top.add_argument("what", metavar="FOLDER|mixing", help="folder of the data set, or the word mixing")
    top.add_argument("results", nargs="?", default="results", type=Path, help="a finished run (%(default)s)")
    return top


if __name__ == "__main__":
    options = parser().parse_args()
    if options.what == "mixing":
        mixing(options.results)
    else:
        pairs()
        readings(Path(options.what), options.results)
