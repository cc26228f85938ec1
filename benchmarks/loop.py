"""Draw the loop shown, named, extended, measured from the results of a run.

    python benchmarks/loop.py results docs/figures/loop.png

Above: light of the gas of the test that is diagnosed, simulated over measured, in blocks of wavelength, and
what was named and changed. Below: the same light of the test that no fit saw, and its temperature, read with
the simulated in place of the measured gas.
"""

import json
import sys
from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro import io
from plasmapyro.commands.terms import read_terms
from plasmapyro.diagnosis.command import LIMITS
from plasmapyro.diagnosis.simulation.predicted import foretold
from plasmapyro.plots import style

FIRST, OTHER = ("csic_160kW", "80kW"), ("csic_220kW", "110kW")
BASE, EXTENDED = "#c1440e", "#1f6f8b"
SATURATION = 65000.0  # [count]


def predictions(results):
    """Of both tests, by the base and by the extended simulation."""
    folders = "radiation", "extended/radiation"
    read = {
        test: [
            io.read(results / f"twin/{test}/test.nc", "test"),
            *(io.read(results / folder / f"{condition}.nc", "radiation") for folder in folders),
        ]
        for test, condition in (FIRST, OTHER)
    }
    names = "calibration", "spectrometer_calibration"
    instrument = [io.read(results / f"instrument/{name}.nc", name) for name in names]
    return foretold(read, *instrument, limits=LIMITS, saturation_counts=SATURATION)


def spectrum(axes, pair, title):
    """Simulated over measured light in blocks of wavelength."""
    for one, colour, name in zip(pair, (BASE, EXTENDED), ("base simulation", "extended"), strict=True):
        axes.step(1e9 * one.wavelength, np.exp(one.spectrum), where="mid", color=colour, label=name)
    axes.axhline(1.0, color="0.3", lw=0.8)
    axes.set(xlabel="wavelength (nm)", ylabel="gas, simulated / measured", title=title, ylim=(0.8, 1.75))
    axes.legend(loc="upper right")


def main(results, target):
    """Write the figure."""
    with xr.open_dataset(results / f"twin/{FIRST[0]}/truth.nc") as truth:
        told = json.loads(truth.attrs["hidden"])
    pairs = predictions(results)
    (term,) = read_terms(results / f"diagnosis/{FIRST[0]}/terms.yaml", "condition")
    size, error = 100 * term.setting.amplitude, 100 * term.uncertainty["amplitude"]
    figure, rows = style.figure((7.2, 4.6), nrows=2, ncols=2)
    spectrum(rows[0, 0], pairs[FIRST[0]], "1  Shown: a test at 80 kW against its simulation")
    named = rows[0, 1]
    hidden = 100 * next(one["amplitude"] for one in told if one["effect"] == "power")
    named.axvline(hidden, color="0.3", lw=0.8, ls="--")
    named.errorbar(0, 1, fmt="o", color=BASE)
    named.errorbar(size, 0, xerr=2 * error, fmt="o", color=EXTENDED, capsize=4)
    named.set(
        ylim=(-0.7, 1.7),
        yticks=[0, 1],
        yticklabels=["found, flow\nsolved again", "believed"],
        xlabel=f"power of the gas, change (%); dashed: hidden, {hidden:.0f} %",
        title=f"2  Named: {-size:.1f} ± {error:.1f} % less power",
    )
    spectrum(rows[1, 0], pairs[OTHER[0]], "3  Foretold: a test at 110 kW that no fit saw")
    kelvin = rows[1, 1]
    with xr.open_dataset(results / f"twin/{OTHER[0]}/test.nc") as test:
        time = test["time"].values
    shown = zip(pairs[OTHER[0]], (BASE, EXTENDED), ("base simulation", "extended"), strict=True)
    both = np.all([np.isfinite(one.temperature) for one in pairs[OTHER[0]]], axis=0)
    for one, colour, name in shown:
        rms = np.sqrt(np.mean(one.temperature[both] ** 2))
        kelvin.plot(time, one.temperature, color=colour, lw=0.8, label=f"{name}: {rms:.1f} K rms")
    kelvin.axhline(0.0, color="0.3", lw=0.8)
    kelvin.set(
        xlim=(15, 120),
        xlabel="time after injection (s)",
        ylabel="error of the temperature (K)",
        title="4  Measured: what that is worth there",
    )
    kelvin.legend(loc="best")
    figure.savefig(target, dpi=160)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
