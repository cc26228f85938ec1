"""What the inputs of a simulated flow are worth: kelvin of the pyrometer's reading per cause.

    python benchmarks/flow_matters.py

Needs results/gas/air11.nc, results/instrument and results/flow of the main job. Keeps
its solutions in results/benchmark_flow and takes up where it stopped. Writes docs/flow_matters.csv and
docs/flow_matters.png, which docs/flow.md shows.
"""

import logging

import flow as bench  # first: it sets one thread
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from plasmapyro import io
from plasmapyro.analysis.stage import apparent_temperature
from plasmapyro.flow.continuation import NotConverged
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.radiation.bandsignal import band_signal, respond, responsivities
from plasmapyro.radiation.grid import log_grid
from plasmapyro.radiation.net_emission import net_emission
from plasmapyro.radiation.path import gas_path
from plasmapyro.radiation.systems import line_lists
from plasmapyro.radiation.table import emission_table, table_nodes, table_radiance
from plasmapyro.sightline.stage import line_of_sight

matplotlib.use("agg")

# What may be wrong with a simulated flow: inputs, what is left out, and properties by the tolerances of their
# tests.
CAUSES = {
    "power into the gas +5 %": {"numerical_power": 1.05},
    "power into the gas -5 %": {"numerical_power": 0.95},
    "mass flow +5 %": {"mass_flow_rate": 1.05},
    "pressure +2 %": {"chamber_pressure": 1.02},
    "swirl 10 deg": {"swirl_angle": np.radians(10.0)},
    "radiation loss": {"radiation_factor": 1.0},
    "back wall 7200 K": {"back_wall_temperature": 7200.0},
    "adiabatic back wall": {"adiabatic_walls": ["back_wall"]},
    "thermal conductivity +10 %": {"gas": {"thermal_conductivity": 1.10}},
    "electrical conductivity +10 %": {"gas": {"electrical_conductivity": 1.10}},
    "viscosity +5 %": {"gas": {"viscosity": 1.05}},
    "enthalpy +1 %": {"gas": {"enthalpy": 1.01}},
    "probe wall 1000 K": {"probe_temperature": 1000.0},
    "probe wall 1800 K": {"probe_temperature": 1800.0},
}
MESH_CAUSE = "mesh of the main job (estimated error)"
FACTORS = ("numerical_power", "mass_flow_rate", "chamber_pressure")  # of the value, not values
MESH, MESH_ORDER = 1.41, 2
POWERS = (90e3, 130e3)
OBJECTS = (1000.0, 1500.0, 2000.0)
SHOWN = {90e3: (1000.0, 1500.0), 130e3: (1500.0, 2000.0)}  # objects of the two panels
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
        self.response = io.read(bench.ROOT / "results/instrument/response.nc", "response")
        self.curve = io.read(bench.ROOT / "results/instrument/ratio_curve.nc", "ratio_curve")
        grid, nodes = log_grid((700e-9, 1200e-9), 160_000), table_nodes(1000.0, 12000.0)
        density = dict(zip(SPECIES, number_density(nodes, 5e3).T, strict=True))
        self.table = emission_table(line_lists(grid), grid, nodes, density)

    def signals(self, temperature, sightline):
        """Signals (2,) of the path with `temperature` (S,) in place of its own."""
        density = number_density(temperature, sightline.pressure.values)
        path = gas_path(
            sightline.path_distance.values, temperature, dict(zip(SPECIES, density.T, strict=True))
        )
        return self.in_bands(path)

    def in_bands(self, path):
        """Signals (2,) of a GasPath."""
        radiance = table_radiance(self.table, path)[0].sum(axis=0)[::-1]
        wavelength = self.table.grid.wavelength[::-1]
        return [
            band_signal(wavelength, respond(wavelength, self.response.wavelength.values, curve), radiance)
            for curve in responsivities(self.response)
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


def varied_flow(name, change, base, gas, start, emission):
    """The stored flow of one cause, continued from `base`."""
    change = dict(change)
    table = bench.varied(gas, change.pop("gas", {}))
    own = {"numerical_power": float(base.numerical_power)}
    values = {**bench.REFERENCE, **own}
    inputs = {key: values[key] * value if key in FACTORS else value for key, value in change.items()}
    return bench.stored(
        name.replace(" ", "_").replace("%", "percent"),
        lambda: bench.solve(table, start, [base], emission, **{**own, **inputs}),
    )


def mesh_error(power, path):
    """Path through the flow of the main job and its estimated error (S,) [K].

    Where the file holds no estimate: the difference to the flow on the mesh of this study, of second order.
    """
    own = io.read(bench.ROOT / "results/flow" / f"{power / 1e3:g}kW.nc", "flow")
    fine = line_of_sight(own, **PATH)
    if "temperature_error" in fine:
        return fine, fine.temperature_error.values
    coarse = np.interp(fine.path_distance.values, path.path_distance.values, path.temperature.values)
    return fine, np.abs(fine.temperature.values - coarse) / (MESH**MESH_ORDER - 1)


def words(kelvin):
    return "no reading" if np.isnan(kelvin) else f"{kelvin:+.1f}"


def table_of(power, gas, start, emission, lamp):
    """Rows of one power."""
    folder = f"matters/{power / 1e3:g}kW_{MESH:g}"
    base = bench.stored(f"{folder}/base", lambda: bench.solve(gas, start, numerical_power=power))
    paths = {"base": line_of_sight(base, **PATH)}
    for cause, change in CAUSES.items():
        try:
            flow = varied_flow(f"{folder}/{cause}", change, base, gas, start, emission)
        except NotConverged as fault:
            logging.warning("%s: %s", cause, fault)
            continue
        paths[cause] = line_of_sight(flow, **PATH)
    signals = {cause: lamp.signals(path.temperature.values, path) for cause, path in paths.items()}
    fine, error = mesh_error(power, paths["base"])
    signals["mesh base"] = lamp.signals(fine.temperature.values, fine)
    signals[MESH_CAUSE] = lamp.signals(fine.temperature.values + error, fine)
    readings = dict(zip(signals, lamp.readings(list(signals.values())), strict=True))
    hottest = {cause: float(path.temperature.max()) for cause, path in paths.items()}
    hottest |= {"mesh base": float(fine.temperature.max())}
    hottest[MESH_CAUSE] = hottest["mesh base"] + float(error[fine.temperature.values.argmax()])
    rows = [
        {
            "power_kw": f"{power / 1e3:g}",
            "cause": "(error of the reading itself)",
            "triangles": str(base.sizes["face"]),
            "hottest_on_path_k": f"{hottest['base']:.0f}",
            "gas_signal_percent": "",
            **{
                f"reading_at_{target:g}_k": words(readings["base"][place] - target)
                for place, target in enumerate(OBJECTS)
            },
        }
    ]
    for cause in (*CAUSES, MESH_CAUSE):
        if cause not in signals:
            continue
        zero = "mesh base" if cause == MESH_CAUSE else "base"
        change = readings[cause] - readings[zero]
        rows.append(
            {
                "power_kw": f"{power / 1e3:g}",
                "cause": cause,
                "triangles": "16600" if cause == MESH_CAUSE else str(base.sizes["face"]),
                "hottest_on_path_k": f"{hottest[cause] - hottest[zero]:+.0f}",
                "gas_signal_percent": f"{100 * (signals[cause][0] / signals[zero][0] - 1):+.1f}",
                **{f"reading_at_{target:g}_k": words(change[place]) for place, target in enumerate(OBJECTS)},
            }
        )
        logging.warning("%s", rows[-1])
    return rows


def draw(rows):
    """Size of the change per cause, the largest on top; one panel per power, two objects each."""
    figure, axes = plt.subplots(1, len(POWERS), figsize=(12, 5.2), sharey=True, layout="constrained")

    def change(cause, power, target):
        for row in rows:
            if row["cause"] == cause and row["power_kw"] == f"{power / 1e3:g}":
                word = row[f"reading_at_{target:g}_k"]
                return np.nan if word == "no reading" else float(word)
        return np.nan

    causes = sorted(
        {row["cause"] for row in rows if not row["cause"].startswith("(")},
        key=lambda cause: np.nanmax([abs(change(cause, power, SHOWN[power][0])) for power in POWERS]),
    )
    place = np.arange(len(causes))
    for axis, power in zip(axes, POWERS, strict=True):
        for rank, target in enumerate(SHOWN[power]):
            values = np.array([change(cause, power, target) for cause in causes])
            size = np.maximum(np.abs(values), LEAST)
            colours = np.where(values > 0, "C3", "C0")
            if rank == 0:
                axis.barh(place, size, 0.62, left=0, color=colours, alpha=0.85)
                for y, value, end in zip(place, values, size, strict=True):
                    axis.text(end * 1.12, y, f"{value:+.3g} K", va="center", fontsize=8)
            else:
                shown = np.where(np.abs(values) > LEAST, size, np.nan)
                axis.scatter(shown, place, marker="D", s=26, color="white", edgecolor=colours, zorder=3)
        axis.set_xscale("log")
        axis.set_xlim(LEAST, 2000)
        axis.set_xlabel("size of the change of the reading [K]")
        first, second = SHOWN[power]
        axis.set_title(
            f"{power / 1e3:g} kW: object at {first:g} K (bar), {second:g} K (diamond)", fontsize=10
        )
        axis.grid(axis="x", alpha=0.3)
    axes[0].set_yticks(place, causes)
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for colour in ("C3", "C0")]
    axes[1].legend(handles, ["reads more", "reads less"], loc="lower right", fontsize=9)
    figure.savefig(bench.DOCS / "flow_matters.png", dpi=150)
    plt.close(figure)


LEAST = 0.05  # [K]: left end of the axis


def main():
    gas, start, lamp = bench.air(), bench.reference(MESH), Bench()
    emission = net_emission(gas, absorption_radius=bench.ABSORPTION_RADIUS)
    rows = []
    for power in POWERS:
        rows += table_of(power, gas, start, emission, lamp)
        bench.write_table("flow_matters", rows)
    draw(rows)


if __name__ == "__main__":
    bench.begin(__doc__)
    logging.getLogger("plasmapyro").setLevel(logging.INFO)
    main()
