"""Figures of docs/diagnosis.md: what a diagnosis says of the default test, as its page shows it.

    python benchmarks/diagnosis_figures.py results/diagnosis/csic_160kW docs/figures

Writes diagnosis_temperature.svg and diagnosis_gas.svg.
"""

import argparse
import json
from pathlib import Path

import xarray as xr

from plasmapyro.page import figures
from plasmapyro.page.words import for_figures


def main(arguments=None):
    """Draw the figures from the files of a diagnosis."""
    top = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    top.add_argument("folder", type=Path, help="what `plasmapyro diagnose` or the workflow wrote")
    top.add_argument("out", type=Path)
    asked = top.parse_args(arguments)
    report = for_figures(json.loads((asked.folder / "diagnosis.json").read_text(encoding="utf-8")))
    with xr.open_dataset(asked.folder / "temperature.nc") as temperature:
        drawn = {
            "temperature": figures.temperature(report, temperature.load()),
            "gas": figures.systems(report),
        }
    for name, svg in drawn.items():
        text = svg.replace("<svg", '<svg style="background:#fff"', 1)
        (asked.out / f"diagnosis_{name}.svg").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
