"""The prediction of docs/plasmatron.md: docs/plasmatron_prediction.csv and .png.

    python benchmarks/plasmatron.py

What needs the facility's data is in benchmarks/real.py --plasmatron.
"""

import argparse
import csv
from pathlib import Path

import numpy as np

from plasmapyro import tables
from plasmapyro.facility.prediction import NOSES, QUANTITIES, Explanations, jets, predict
from plasmapyro.plots import style

DOCS = Path(__file__).parents[1] / "docs"
PITOT = (
    5.0,
    7.0,
    10.0,
    12.0,
    13.5,
    15.0,
    16.0,
    17.5,
    20.0,
    25.0,
    30.0,
    40.0,
    50.0,
    70.0,
    100.0,
    140.0,
    200.0,
)  # [Pa]
TICKS = (5, 10, 15, 30, 50, 100, 200)
JETS = (("air", 5e3), ("air", 1e4), ("N2", 5e3), ("N2", 1e4))  # gas, pressure of the chamber [Pa]
PAIR = {"pair": "Num-2", "flux_uncertainty": 0.1, "pressure_uncertainty": 0.05, "mixing_spread": 0.25}
PAIR |= {"draws": 2000, "seed": 1}
RIVALS = {  # recombination and Pitot nose [m] that are admitted
    "all admitted": ((0.01, 0.1), (0.005, 0.025)),
    "catalytic wall, nose 25 mm": ((0.1, 1.0), (0.0249, 0.025)),
    "poor wall, nose 5 mm": ((0.01, 0.0101), (0.005, 0.00501)),
}
NO_MIXING = "no mixing, poor wall, nose 5 mm"


def predictions():
    """Rows of the table: heat flux, temperature and enthalpy at each Pitot pressure, by rival."""
    rows = []
    for jet in JETS:
        for rival, (gamma, nose) in RIVALS.items():
            found = predict(PITOT, jet[1], gas=jet[0], recombination=gamma, nose=nose, **PAIR)
            ends = np.stack([found[name] for name in QUANTITIES])  # (quantity, end, pitot)
            rows += [row_of(jet, rival, k, ends[..., k], found["inside"][k]) for k in range(len(PITOT))]
        wall = Explanations(np.array([0.01]), np.array([0]), np.array([NOSES[0]]), warmth=0.0)
        values, inside = jets(jet[0]).at(PITOT, jet[1], wall)
        for k, value in enumerate(np.exp(values[0, 0])):
            ends = np.repeat(value[:, None], 3, axis=1)
            rows.append(row_of(jet, NO_MIXING, k, ends, inside[0, 0, k]))
    return rows


def row_of(jet, rival, k, ends, inside):
    """Row of the table; `ends` (quantity, 3) in SI."""
    row = {"gas": jet[0], "chamber_mbar": f"{jet[1] / 100:g}", "pitot_pa": f"{PITOT[k]:g}"}
    row["explanation"] = rival
    for name, factor, digits, values in zip(COLUMNS, FACTORS, DIGITS, ends, strict=True):
        for end, value in zip(("low", "median", "high"), values, strict=True):
            row[f"{name}_{end}"] = f"{factor * value:.{digits}f}"
    return row | {INSIDE: f"{float(inside):.2f}"}


COLUMNS = ("heat_flux_kw_m2", "temperature_k", "enthalpy_mj_kg", "speed_m_s", "power_kw")
INSIDE = "between_computed_flows"
FACTORS, DIGITS = (1e-3, 1.0, 1e-6, 1.0, 1e-3), (0, 0, 1, 0, 0)


def draw(rows):
    """Heat flux and temperature against Pitot pressure, by rival, and the measured pairs."""
    drawing, axes = style.figure(size=(11, 5.1), nrows=2, ncols=len(JETS), sharex=True, sharey="row")
    pairs = tables.load("facility/plasmatron_pairs")
    for column, (gas, pressure) in enumerate(JETS):
        for rival, colour in zip((*RIVALS, NO_MIXING), ("0.8", "#d62728", "#4e79a7", "0.1"), strict=True):
            ours = [row for row in rows if row["explanation"] == rival]
            ours = [row for row in ours if (row["gas"], row["chamber_mbar"]) == (gas, f"{pressure / 100:g}")]
            for panel, name in zip(axes[:, column], ("heat_flux_kw_m2", "temperature_k"), strict=True):
                low, middle, high = (
                    [float(row[f"{name}_{end}"]) for row in ours] for end in ("low", "median", "high")
                )
                if rival == next(iter(RIVALS)):
                    panel.fill_between(PITOT, low, high, color=colour, label="95 %, all admitted")
                    inside = [p for p, row in zip(PITOT, ours, strict=True) if float(row[INSIDE]) > 0.4]
                    panel.plot(
                        inside, [0.03] * len(inside), "k^", ms=4, transform=panel.get_xaxis_transform(),
                        label="between computed flows (elsewhere: carried on)",
                    )  # fmt: skip
                else:
                    panel.plot(
                        PITOT, middle, color=colour, ls="--" if rival == NO_MIXING else "-", label=rival
                    )
        upper, lower = axes[:, column]
        upper.set(xscale="log", yscale="log", title=f"{gas}, {pressure / 100:g} mbar")
        lower.set(xlabel="Pitot pressure [Pa]")
        for axis, ticks in ((upper.xaxis, TICKS), (upper.yaxis, (100, 200, 500, 1000, 2000, 5000))):
            axis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
            axis.set_minor_formatter("")
    known = 1e-3 * pairs["heat_flux"]
    axes[0, 0].errorbar(
        pairs["dynamic_pressure"], known, yerr=0.1 * known, fmt="s", color="k", ms=4, label="measured"
    )
    for name, x, y in zip(pairs["pair"], pairs["dynamic_pressure"], known, strict=True):
        axes[0, 0].annotate(name, (x, y), xytext=(6, -8), textcoords="offset points", fontsize=7)
    axes[0, 0].set(ylabel="Heat flux on a hemisphere\nof 25 mm [kW m$^{-2}$]")
    axes[1, 0].set(ylabel="Temperature ahead\nof the probe [K]")
    drawing.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=6, fontsize=7)
    style.save(axes[0, 0], [DOCS / "plasmatron_prediction.png"])


def prediction():
    """Write the table and the figure."""
    rows = predictions()
    with (DOCS / "plasmatron_prediction.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows)


if __name__ == "__main__":
    argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    ).parse_args()
    prediction()
