"""Time `plasmapyro correct` or `check` on a long log: 2 hours at 10 Hz with 3600 spectra of 2068 pixels.

    python benchmarks/correct_log.py FOLDER [--hours 2] [--spectra 3600] [--raw] [--only check]

Makes a synthetic test and both calibrations in FOLDER, corrects it with the command, writes the wall time,
the CPU time and the peak memory of that command to FOLDER/correct_log.json and to standard output. With
--raw the test is a folder of raw files: a CSV and a text file per spectrum, as SpectraSuite writes it.
"""

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import xarray as xr

from plasmapyro import io
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.instrument.stage import band_response, pyrometer_calibration, spectrometer_calibration
from plasmapyro.radiation.planck import blackbody_radiance

PIXELS, RATE, EXPOSURE = 2068, 10.0, 1.0
SOURCE, LAMP_EXPOSURE = 1773.0, 0.4
GAIN = 1e-6  # [A m2 sr W-1]
COUNTS = 8e-6  # [count s-1 / (W m-2 sr-1 m-1)]
WINDOW, OFF_BEFORE_END = (0.0, 6.0), 60.0


def surface(moment, off):
    """Temperature [K] of the surface: dark in the window, heated to 1600 K, cooling at the end."""
    heated = 350 + 1250 * -np.expm1(-np.maximum(moment, 0) / 20) * (moment > 0)
    return np.where(moment > off, np.maximum(1600 - 8 * (moment - off), 350), heated)


def instruments(folder):
    """Write calibration.nc and spectrometer_calibration.nc; return the response and the wavelengths."""
    response = band_response(**RESPONSE)
    io.write(response, folder / "response.nc", "response")
    source = np.arange(973.0, 1774.0, 100.0)
    wide, narrow = signals(response, source)
    points = xr.Dataset(
        {
            "source_temperature": ("calibration_point", source),
            "signal_wide": ("calibration_point", wide),
            "signal_narrow": ("calibration_point", narrow),
        }
    )
    calibration = pyrometer_calibration(
        response,
        points,
        source_temperature_uncertainty=3.0,
        signal_uncertainty=0.01,
        instrument_range=(973.0, 2073.0),
        calibration_temperature=np.arange(400.0, 4001.0, 10.0),
        draws=500,
        seed=1,
    )
    io.write(calibration, folder / "calibration.nc", "calibration")
    wavelength = np.linspace(750e-9, 1030e-9, PIXELS)
    light = blackbody_radiance(wavelength, SOURCE) * COUNTS * LAMP_EXPOSURE * 0.4
    light += np.random.default_rng(0).normal(0, 10, PIXELS)
    counts = xr.Dataset(
        {
            "calibration_counts": ("wavelength", 1000 + light),
            "calibration_background": ("wavelength", np.full(PIXELS, 1000.0)),
        },
        {"wavelength": wavelength},
        {"source_temperature": SOURCE, "integration_time": LAMP_EXPOSURE * 0.4, "origin": "synthetic"},
    )
    factor = spectrometer_calibration(
        counts,
        source_temperature_uncertainty=3.0,
        saturation_counts=65000.0,
        least_net_counts=50.0,
        noise_block=50,
    )
    io.write(factor, folder / "spectrometer_calibration.nc", "spectrometer_calibration")
    return response, wavelength


def signals(response, temperature):
    """Band signals (2, t) [A] of a black body."""
    return np.stack(
        [
            GAIN * blackbody_signal(temperature, response.wavelength.values, response[name].values)
            for name in ("responsivity_wide", "responsivity_narrow")
        ]
    )


def made(response, wavelength, hours, spectra):
    """Synthetic test of the given length."""
    end, generator = hours * 3600.0, np.random.default_rng(1)
    off = end - OFF_BEFORE_END
    moment = np.arange(-20.0, end, 1 / RATE)
    exposed = np.linspace(1.0, end - 2.0, spectra)
    grid = np.linspace(300.0, 1700.0, 1401)
    table = signals(response, grid)
    gas = table[:, int(1000 - 300)]
    plume = 1e8 * (1 + 30 * np.exp(-(((wavelength - 777e-9) / 1e-9) ** 2)))
    temperature = surface(moment, off)
    both = np.stack([np.interp(temperature, grid, row) for row in 0.85 * table]) * (moment >= 0)
    both += gas[:, None] * (moment <= off)
    both *= 1 + 0.01 * generator.standard_normal(both.shape)
    radiance = 0.85 * blackbody_radiance(wavelength, surface(exposed, off)[:, None])
    radiance += plume * (exposed <= off)[:, None]
    counts = 1000 + radiance * COUNTS * EXPOSURE
    counts += np.sqrt(np.maximum(counts, 1) / 10) * generator.standard_normal(counts.shape)
    return xr.Dataset(
        {
            "signal_wide": ("time", both[0]),
            "signal_narrow": ("time", both[1]),
            "counts": (("spectrum_time", "wavelength"), np.round(counts)),
            "background_counts": ("wavelength", np.full(wavelength.size, 1000.0)),
        },
        {"time": moment, "spectrum_time": exposed, "wavelength": wavelength},
        {
            "origin": "synthetic",
            "condition": "none",
            "injection_time": 0.0,
            "plasma_off_time": off,
            "reference_window": list(WINDOW),
            "emittance": 0.85,
            "emittance_uncertainty": 0.05,
            "window_transmittance_pyrometer": 0.9,
            "window_transmittance_spectrometer": 0.9,
            "pyrometer_integration_time": 0.01,
            "spectrometer_integration_time": EXPOSURE,
            "spectrometer_fwhm": 0.75e-9,
        },
    )


def write_raw(test, folder):
    """The test as test.yaml, pyrometer.csv and a text file per spectrum."""
    (folder / "spectrometer").mkdir(parents=True, exist_ok=True)
    attributes = {k: v for k, v in test.attrs.items() if k != "spectrometer_integration_time"}
    time = test.spectrum_time.values
    described = {
        "attributes": attributes,
        "pyrometer": {
            "columns": {
                "time": {"name": "t", "unit": "s"},
                "signal_wide": {"name": "S1", "unit": "A"},
                "signal_narrow": {"name": "S2", "unit": "A"},
            }
        },
        "spectrometer": {
            "quantity": "counts",
            "background": "dark.txt",
            "wavelengths": "vacuum",
            "time": {"from": "order", "first": float(time[0]), "period": float(np.diff(time).mean())},
        },
    }
    io.write_text(json.dumps(described, default=float), folder / "test.yaml")  # JSON is YAML
    columns = (test[name].values for name in ("time", "signal_wide", "signal_narrow"))
    rows = "".join(f"{t:.2f},{a:.8e},{b:.8e}\n" for t, a, b in zip(*columns, strict=True))
    io.write_text("t,S1,S2\n" + rows, folder / "pyrometer.csv")
    pixels = [f"{w * 1e9:.6f}" for w in test.wavelength.values]

    def spectrum(counts, path):
        body = "".join(f"{w}\t{c:.2f}\n" for w, c in zip(pixels, counts, strict=True))
        head = f"SpectraSuite Data File\nIntegration Time (usec): {EXPOSURE * 1e6:.0f} (X)\n"
        head += f"Number of Pixels in Processed Spectrum: {PIXELS}\n>>>>>Begin Processed Spectral Data<<<<<\n"
        io.write_text(f"{head}{body}>>>>>End Processed Spectral Data<<<<<\n", path)

    spectrum(test.background_counts.values, folder / "dark.txt")
    for index, counts in enumerate(test.counts.values):
        spectrum(counts, folder / "spectrometer" / f"{index:05d}.txt")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("folder", type=Path)
    words.add_argument("--hours", type=float, default=2.0)
    words.add_argument("--spectra", type=int, default=3600)
    words.add_argument("--raw", action="store_true")
    words.add_argument("--only", choices=("check", "correct"), default="correct")
    options = words.parse_args()
    (options.folder / "instrument").mkdir(parents=True, exist_ok=True)
    test = made(*instruments(options.folder / "instrument"), options.hours, options.spectra)
    place = options.folder / ("raw" if options.raw else "test.nc")
    if options.raw:
        write_raw(test, place)
    else:
        io.write(test, place, "test")
    sizes = dict(test.sizes)
    del test
    command = [
        sys.executable,
        "-c",
        "import sys; from plasmapyro.cli import main; sys.exit(main())",
        options.only,
        str(place),
    ]
    if options.only == "correct":
        command += ["--instrument", str(options.folder / "instrument")]
        command += ["--out", str(options.folder / "corrected.nc"), "--saturation-counts", "1e9"]
    begin = time.perf_counter()
    subprocess.run(command, check=True)
    wall, used = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    found = {
        "samples": sizes["time"],
        "spectra": sizes["spectrum_time"],
        "pixels": sizes["wavelength"],
        "wall_s": round(wall, 1),
        "cpu_s": round(used.ru_utime + used.ru_stime, 1),
        "peak_memory_mb": round(used.ru_maxrss / 1024),
    }
    io.write_text(json.dumps(found, indent=2) + "\n", options.folder / "correct_log.json")
    sys.stdout.write(json.dumps(found) + "\n")


if __name__ == "__main__":
    main()
