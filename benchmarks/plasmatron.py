"""Numbers of docs/plasmatron.md.

    python benchmarks/plasmatron.py prediction           docs/plasmatron_prediction.csv and .png
    python benchmarks/plasmatron.py FOLDER [RESULTS]     pairs of AblaNTIS rebuilt, its readings corrected

FOLDER holds the data set (doi 10.5281/zenodo.15938723, CC BY-NC, not shipped); RESULTS is a finished run.
"""

import argparse
import csv
from pathlib import Path

import numpy as np

from plasmapyro import io, tables
from plasmapyro.analysis.reading import correct_reading
from plasmapyro.commands.correct_reading import read_readings
from plasmapyro.facility.prediction import NOSES, QUANTITIES, Explanations, jets, predict
from plasmapyro.facility.probes import Calorimeter
from plasmapyro.facility.rebuild import rebuild
from plasmapyro.plots import style

DOCS = Path(__file__).parents[1] / "docs"
ASSUMED = (1.0, 0.1, 0.0265, 0.01)
SETTINGS = {"floor": 1263.0, "quantum": 1.0, "noise": 14.0, "emittance": 0.9, "draws": 200, "seed": 1}
UNCERTAINTY = {"emittance_uncertainty": 0.05, "power_uncertainty": 0.08, "engine_uncertainty": 0.1}
PITOT = (5.0, 10.0, 15.0, 20.0, 30.0, 50.0, 100.0, 150.0, 200.0)  # [Pa]
PRESSURES = (5e3, 1e4)  # [Pa] of the chamber
PAIR = {"pair": "Num-2", "flux_uncertainty": 0.1, "pressure_uncertainty": 0.05, "draws": 1000, "seed": 1}
RIVALS = {  # recombination and Pitot nose [m] that are admitted
    "all admitted": ((0.01, 0.1), (0.005, 0.025)),
    "catalytic wall, nose 25 mm": ((0.1, 1.0), (0.0249, 0.025)),
    "poor wall, nose 5 mm": ((0.01, 0.0101), (0.005, 0.00501)),
}
NO_MIXING = "no mixing, poor wall, nose 5 mm"
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


def predictions():
    """Rows of the table: heat flux, temperature and enthalpy at each Pitot pressure, by rival."""
    rows = []
    for pressure in PRESSURES:
        for rival, (gamma, nose) in RIVALS.items():
            found = predict(PITOT, pressure, recombination=gamma, nose=nose, **PAIR)
            ends = np.stack([found[name] for name in QUANTITIES])  # (quantity, end, pitot)
            rows += [row_of(pressure, rival, k, ends[..., k], found["inside"][k]) for k in range(len(PITOT))]
        wall = Explanations(np.array([0.01]), np.array([0]), np.array([NOSES[0]]))
        values, inside = jets().at(PITOT, pressure, wall)
        for k, value in enumerate(np.exp(values[0, 0])):
            ends = np.repeat(value[:, None], 3, axis=1)
            rows.append(row_of(pressure, NO_MIXING, k, ends, inside[0, 0, k]))
    return rows


def row_of(pressure, rival, k, ends, inside):
    """Row of the table; `ends` (quantity, 3) in SI."""
    row = {"chamber_mbar": f"{pressure / 100:g}", "pitot_pa": f"{PITOT[k]:g}", "explanation": rival}
    for name, factor, digits, values in zip(COLUMNS, FACTORS, DIGITS, ends, strict=True):
        for end, value in zip(("low", "median", "high"), values, strict=True):
            row[f"{name}_{end}"] = f"{factor * value:.{digits}f}"
    return row | {"between_computed_flows": f"{float(inside):.2f}"}


COLUMNS = ("heat_flux_kw_m2", "temperature_k", "enthalpy_mj_kg", "speed_m_s", "power_kw")
FACTORS, DIGITS = (1e-3, 1.0, 1e-6, 1.0, 1e-3), (0, 0, 1, 0, 0)


def draw(rows):
    """Heat flux and temperature against Pitot pressure, by rival, and the measured pairs."""
    drawing, axes = style.figure(size=(7.2, 4.8), nrows=2, ncols=2, sharex=True)
    pairs = tables.load("facility/plasmatron_pairs")
    for column, pressure in enumerate(PRESSURES):
        for rival, colour in zip((*RIVALS, NO_MIXING), ("0.8", "#d62728", "#4e79a7", "0.1"), strict=True):
            ours = [row for row in rows if row["explanation"] == rival]
            ours = [row for row in ours if row["chamber_mbar"] == f"{pressure / 100:g}"]
            for panel, name in zip(axes[:, column], ("heat_flux_kw_m2", "temperature_k"), strict=True):
                low, middle, high = (
                    [float(row[f"{name}_{end}"]) for row in ours] for end in ("low", "median", "high")
                )
                if rival == next(iter(RIVALS)):
                    panel.fill_between(PITOT, low, high, color=colour, label="95 %, all admitted")
                else:
                    panel.plot(
                        PITOT, middle, color=colour, ls="--" if rival == NO_MIXING else "-", label=rival
                    )
        upper, lower = axes[:, column]
        upper.set(xscale="log", yscale="log", title=f"air, {pressure / 100:g} mbar")
        lower.set(xlabel="Pitot pressure [Pa]")
        for axis in (upper.xaxis, upper.yaxis):
            axis.set_major_formatter("{x:g}")
    known = 1e-3 * pairs["heat_flux"]
    axes[0, 0].errorbar(
        pairs["dynamic_pressure"], known, yerr=0.1 * known, fmt="s", color="k", ms=4, label="measured"
    )
    for name, x, y in zip(pairs["pair"], pairs["dynamic_pressure"], known, strict=True):
        axes[0, 0].annotate(name, (x, y), xytext=(6, -8), textcoords="offset points", fontsize=7)
    axes[0, 0].set(ylabel="Heat flux [kW m$^{-2}$], hemisphere 25 mm")
    axes[1, 0].set(ylabel="Temperature ahead of the probe [K]")
    axes[0, 0].legend(loc="upper left", fontsize=6)
    style.save(drawing, [DOCS / "plasmatron_prediction.png"])


def prediction():
    """Write the table and the figure."""
    rows = predictions()
    with (DOCS / "plasmatron_prediction.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows)


def parser():
    """The argument parser."""
    top = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    top.add_argument(
        "what", metavar="FOLDER|prediction", help="folder of the data set, or the word prediction"
    )
    top.add_argument("results", nargs="?", default="results", type=Path, help="a finished run (%(default)s)")
    return top


if __name__ == "__main__":
    options = parser().parse_args()
    if options.what == "prediction":
        prediction()
    else:
        pairs()
        readings(Path(options.what), options.results)
