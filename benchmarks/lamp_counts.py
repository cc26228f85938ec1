"""Prove the spectrometer's calibration on a folder of real lamp counts: figure and numbers for the docs.

    python benchmarks/lamp_counts.py FOLDER docs/figures

FOLDER holds the raw files of the spectrometer MAYP11278 as the R package ooacquire carries them, and the
irradiance of the lamp as a CSV. Writes lamp_counts.png and lamp_counts.json.
"""

import argparse
import csv
import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from plasmapyro.instrument import raw_counts
from plasmapyro.instrument.line_lamp import find_lines
from plasmapyro.instrument.shape import compare, planck_shape
from plasmapyro.readers.ocean import clipped, read_spectrum
from plasmapyro.refraction import vacuum_wavelength

COEFFICIENTS = [1.00237, -1.11854e-7, 5.50740e-11, -1.09558e-14]
COEFFICIENTS += [5.46964e-19, -1.29196e-23, 1.50047e-28, -6.88580e-34]
MASKED = [2, 3, -2, -1]
DIM = (196e-9, 300e-9)
BAND = (750e-9, 900e-9)
RUNS = {  # name -> (light, dark)
    "2013": ("cal2013a01", "cal2013a05"),
    "2013, 5 s": ("cal2013a02", "cal2013a04"),
    "2014": ("cal2014a01", "cal2014a05"),
    "2014, other": ("cal2014b01", "cal2014b05"),
    "2016": ("cal2016b01", "cal2016b05"),
}
SAME_LAMP = ("2013", "2014", "2016")
COLOURS = {"2013": "#0072B2", "2014": "#D55E00", "2016": "#009E73", "2014, other": "#CC79A7"}


def counts(folder, name):
    """Spectrum and raw counts of a file, NaN where the converter clipped."""
    spectrum = read_spectrum(folder / f"{name}.txt")
    values = next(iter(spectrum.columns.values()))
    return spectrum, np.where(clipped(values), np.nan, values)


def rate(folder, run, follow_dark=True):
    """Wavelength [m], linear count rate [count s-1] and dark scale of a run."""
    spectrum, light = counts(folder, RUNS[run][0])
    _, dark = counts(folder, RUNS[run][1])
    wavelength = vacuum_wavelength(spectrum.wavelength)
    found, *_, scale = raw_counts.net_rate(
        light,
        dark,
        integration_time=spectrum.integration_time,
        coefficients=COEFFICIENTS,
        masked=MASKED,
        dim=(wavelength > DIM[0]) & (wavelength < DIM[1]) if follow_dark else None,
        noise_block=60,
    )
    return wavelength, found, scale


def certificate(folder):
    """Vacuum wavelength [m] and irradiance [W m-2 m-1] of the lamp."""
    with open(folder / "fel2013a_from_xlsx.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["FEL_spectrum_W_cm2_nm"]]
    air = np.array([float(row["wavelength_nm"]) for row in rows]) * 1e-9
    return vacuum_wavelength(air), np.array([float(row["FEL_spectrum_W_cm2_nm"]) for row in rows]) * 1e13


def exposures(folder, axis):
    """Ratio of the rates of 0.6 s and 5 s, with and without the drift of the dark."""
    numbers = {}
    for follow, colour, label in ((False, "0.6", "dark as recorded"), (True, "#0072B2", "dark followed")):
        wavelength, short, _ = rate(folder, "2013", follow)
        _, long, _ = rate(folder, "2013, 5 s", follow)
        ratio = short / long
        ratio[:10], ratio[-6:] = np.nan, np.nan
        axis.plot(wavelength * 1e9, ratio, ".", ms=2, color=colour, label=label)
        windows = [
            float(np.median(ratio[inside]))
            for low in np.arange(200e-9, 1120e-9, 20e-9)
            if (inside := (wavelength >= low) & (wavelength < low + 20e-9) & np.isfinite(ratio)).sum() > 10
        ]
        numbers[label] = max(abs(value - 1) for value in windows)
    axis.axhspan(0.985, 1.015, color="0.9", zorder=0)
    axis.set(ylim=(0.7, 1.15), xlabel="wavelength / nm", ylabel="rate at 0.6 s over that at 5 s")
    axis.set_title("Two exposures of one lamp", loc="left")
    axis.legend(markerscale=5, loc="lower right", frameon=False)
    return numbers


def years(folder, axis):
    """Each run calibrated with that of 2013; differences of shape for every pair."""
    points, lamp = certificate(folder), {run: rate(folder, run) for run in RUNS if run != "2013, 5 s"}
    numbers = {"certificate": planck_shape(*points, BAND)._asdict()}
    for reference, (own, response, _) in lamp.items():
        factor = raw_counts.certified_source(own, *points) / response
        for run, (wavelength, found, _) in lamp.items():
            if run == reference:
                continue
            truth = raw_counts.certified_source(wavelength, *points)
            seen = np.interp(wavelength, own, factor) * found
            numbers[f"{run} calibrated with {reference}"] = compare(wavelength, seen, truth, BAND)._asdict()
            if reference == "2013":
                inside = (wavelength > 700e-9) & (wavelength < 930e-9)
                axis.plot(wavelength[inside] * 1e9, (seen / truth)[inside], color=COLOURS[run], label=run)
    axis.axvspan(BAND[0] * 1e9, BAND[1] * 1e9, color="0.93", zorder=0)
    axis.set(xlabel="wavelength / nm", ylabel="irradiance over certificate", ylim=(0.98, 1.2))
    axis.set_title("Other years, calibrated with 2013", loc="left")
    axis.legend(loc="upper left", frameon=False)
    numbers["dark scale"] = {run: scale for run, (_, _, scale) in lamp.items()}
    return numbers


def lines(folder, axis):
    """Deviation of the lines of the Hg(Ar) lamp from their certified wavelengths."""
    numbers = {}
    for year in ("2013", "2014"):
        spectrum, light = counts(folder, f"hg{year}a01")
        _, dark = counts(folder, f"hg{year}a02")
        for medium in ("air", "vacuum"):
            scale = spectrum.wavelength if medium == "vacuum" else vacuum_wavelength(spectrum.wavelength)
            found = find_lines(
                scale, light - dark, expected_fwhm=1.2e-9, search=1.5e-9, least_signal_to_noise=20
            )
            error = np.array([line.wavelength - line.certified for line in found]) * 1e9
            numbers[f"{year}, scale taken as {medium}"] = {
                "lines": len(found),
                "mean_nm": float(error.mean()),
                "largest_nm": float(np.abs(error).max()),
                "median_fwhm_nm": float(np.median([line.fwhm for line in found]) * 1e9),
            }
            if medium == "air":
                axis.plot(
                    [line.certified * 1e9 for line in found], error, "o", color=COLOURS[year], label=year
                )
    axis.axhspan(-0.3, 0.3, color="0.93", zorder=0)
    axis.axhline(0, color="0.4", lw=0.8)
    axis.set(xlabel="wavelength / nm", ylabel="found minus certified / nm", ylim=(-0.5, 0.5))
    axis.set_title("Lines of a Hg(Ar) lamp", loc="left")
    axis.legend(loc="lower right", frameon=False)
    return numbers


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("out", type=Path)
    asked = parser.parse_args()
    figure, axes = plt.subplots(3, 1, figsize=(6.4, 8.6), layout="constrained")
    parts = (exposures, years, lines)
    numbers = {part.__name__: part(asked.folder, axis) for part, axis in zip(parts, axes, strict=True)}
    for axis in axes:
        axis.spines[["top", "right"]].set_visible(False)
    figure.savefig(asked.out / "lamp_counts.png", dpi=130, metadata={"Software": None})
    (asked.out / "lamp_counts.json").write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
