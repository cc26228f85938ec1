"""A small laboratory of our own making: raw calibration files and a test, of known truth.

A sample heats up and cools as radiating bodies do, behind the gas that the shipped simulation of 90 kW
gives, which flickers; `docs/example` holds its files.
"""

import numpy as np
import xarray as xr
from scipy.signal import lfilter

from plasmapyro import io, shipped
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.instrument.pyrometer import blackbody_signal
from plasmapyro.instrument.stage import band_response
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.refraction import vacuum_wavelength

AIR = np.round(np.linspace(750.0, 1030.0, 150), 3)  # [nm]
WAVELENGTH = vacuum_wavelength(AIR * 1e-9)
GAIN = 2e-6  # [count s-1 / (W m-2 sr-1 m-1)]
DARK, BASELINE = 700.0, 2000.0  # [count]
CURVE = (1.02, -8e-6, -5e-12)  # relative response of the detector
FILTER = 0.5
SENSITIVITY = 1e-6  # [A m2 sr W-1]
EMITTANCE = 0.8
POWER = "90kW"  # the shipped simulation that is the gas
FWHM, SLIT = 4e-9, 0.75e-9  # [m] of the spectrometer, of the simulation
FLICKER, FLICKER_TIME = 0.006, 0.15  # [1], [s] of the light of the gas, an Ornstein-Uhlenbeck process
NOISE, FLOOR = 1e-3, 1e-9  # [1], [A] of one sample of a signal
OFF = 50.0  # [s] end of the plasma
ATTRIBUTES = {
    "origin": "synthetic",
    "condition": "none",
    "injection_time": 0.0,
    "plasma_off_time": 50.0,
    "reference_window": [0.0, 5.0],
    "emittance": EMITTANCE,
    "emittance_uncertainty": 0.05,
    "window_transmittance_pyrometer": 0.9,
    "window_transmittance_spectrometer": 0.9,
    "pyrometer_integration_time": 0.01,
    "spectrometer_integration_time": 0.5,
    "spectrometer_fwhm": 4e-9,
}
CALIBRATION = """origin: synthetic
pyrometer:
  file: points.csv
  columns:
    source_temperature: {name: T, unit: degC}
    signal_wide: {name: S1}
    signal_narrow: {name: S2}
spectrometer:
  source: {temperature_k: 1700, temperature_uncertainty_k: 2}
  exposures:
    - {light: long.txt, dark: long_dark.txt}
    - {light: short.txt, dark: short_dark.txt}
  linearity_coefficients: [1.02, -8e-6, -5e-12]
  masked_pixels: [0, -1]
  filter_transmittance: 0.5
"""
FILE = """SpectraSuite Data File
Integration Time (usec): {time:.0f} (X)
Correct for Detector Non-linearity: No (X)
Number of Pixels in Processed Spectrum: 150
>>>>>Begin Processed Spectral Data<<<<<
{body}>>>>>End Processed Spectral Data<<<<<
"""


def temperature(moment):
    """Of the surface [K]: it heats up from 350 towards 1610 K, and cools by radiation, 25 K/s at first."""
    moment = np.asarray(moment, dtype=float)
    heated = 350 + 1260 * (1 - np.exp(-np.clip(moment, 0, OFF) / 9)) ** 2
    return (heated**-3.0 + 1.2e-11 * np.maximum(moment - OFF, 0)) ** (-1 / 3)


def gas():
    """Light of the gas: signals of the bands (2,) [A], radiance of the pixels (W,) [W m-2 sr-1 m-1]."""
    found = shipped.by_condition()[POWER]
    axis = found.wavelength_slit.values
    width = np.sqrt(FWHM**2 - SLIT**2) / np.sqrt(8 * np.log(2))
    share = np.exp(-0.5 * ((WAVELENGTH[:, None] - axis) / width) ** 2)
    spectrum = share @ found.gas_radiance_slit.values / share.sum(axis=1)
    return SENSITIVITY * found.gas_signal.values, spectrum


def brightness(moment, span=0.0):
    """Of the gas over its mean, averaged over `span` [s] about each moment."""
    axis = np.arange(-10.0, 70.0, 0.02)
    random, keep = np.random.default_rng(7), np.exp(-0.02 / FLICKER_TIME)
    steps = np.sqrt(1 - keep**2) * random.standard_normal(axis.size)
    value = lfilter([1.0], [1.0, -keep], steps)
    around = np.asarray(moment, dtype=float)[..., None] + span * np.linspace(-0.5, 0.5, 9)
    return 1 + FLICKER * np.interp(around, axis, value).mean(axis=-1)


def raw(radiance, seconds, seed):
    """Raw counts of a detector that is not linear."""
    charge = np.where([False, *[True] * (WAVELENGTH.size - 2), False], radiance * GAIN * seconds + DARK, 0.0)
    measured = charge
    for _ in range(60):  # solves measured / polynomial(measured) = charge
        measured = charge * np.polynomial.polynomial.polyval(measured, CURVE)
    noise = np.random.default_rng(seed).standard_normal(measured.shape)
    return measured + BASELINE + noise


def spectrum(counts, seconds):
    """Text of one spectrum file."""
    body = "".join(f"{w:.3f}\t{c:.3f}\n" for w, c in zip(AIR, counts, strict=True))
    return FILE.format(time=seconds * 1e6, body=body)


def signals(kelvin):
    """Band signals (2, T) [A] of a black body."""
    response = band_response(**RESPONSE)
    return np.stack(
        [
            SENSITIVITY
            * blackbody_signal(kelvin, response.wavelength.values, response[f"responsivity_{band}"].values)
            for band in ("wide", "narrow")
        ]
    )


def calibration_folder(place):
    """Write the raw calibration files of both instruments."""
    place.mkdir(parents=True)
    (place / "calibration.yaml").write_text(CALIBRATION)
    celsius = np.arange(700.0, 1501.0, 100.0)
    wide, narrow = signals(celsius + 273.15) * 1e9
    rows = [f"{t:g};{a:.6f};{b:.6f}\n" for t, a, b in zip(celsius, wide, narrow, strict=True)]
    (place / "points.csv").write_text("T;S1 [nA];S2 [nA]\n" + "".join(rows))
    light = FILTER * blackbody_radiance(WAVELENGTH, 1700.0)
    for index, (name, seconds) in enumerate((("long", 0.2), ("short", 0.1))):
        (place / f"{name}.txt").write_text(spectrum(raw(light, seconds, index), seconds))
        (place / f"{name}_dark.txt").write_text(spectrum(raw(0 * light, seconds, index + 5), seconds))
    return place


def seen(moment, span=0.5):
    """Radiance (..., W) of surface and gas in an exposure about a moment."""
    around = np.asarray(moment, dtype=float)[..., None] + span * np.linspace(-0.5, 0.5, 9)
    surface = blackbody_radiance(WAVELENGTH, temperature(around)[..., None]).mean(axis=-2)
    shining = np.mean(around <= OFF, axis=-1) * brightness(moment, span)
    return EMITTANCE * surface + gas()[1] * shining[..., None]


def made(pyrometer=True, spectrometer=True):
    """A test of known truth, spectra as raw counts."""
    test = xr.Dataset(attrs=ATTRIBUTES)
    if pyrometer:
        time = np.round(np.arange(-4.0, 60.0, 0.25), 9)
        surface = EMITTANCE * signals(temperature(time)) * (time >= 0)
        both = surface + gas()[0][:, None] * brightness(time) * (time <= OFF)
        random = np.random.default_rng(1)
        both *= 1 + NOISE * random.standard_normal(both.shape)
        both += FLOOR * random.standard_normal(both.shape)
        test["signal_wide"], test["signal_narrow"] = ("time", both[0]), ("time", both[1])
        test = test.assign_coords(time=time)
    if spectrometer:
        time = np.arange(1.0, 60.0, 2.0)
        light = seen(time)
        test["counts"] = (
            ("spectrum_time", "wavelength"),
            np.array([raw(row, 0.5, 10 + i) for i, row in enumerate(light)]),
        )
        test["background_counts"] = ("wavelength", raw(0 * WAVELENGTH, 0.5, 9))
        test = test.assign_coords(spectrum_time=time, wavelength=WAVELENGTH)
    return test


def test_file(place, **parts):
    """Write the test as netCDF; return the path."""
    io.write(made(**parts), place, "test")
    return place


TEST_YAML = """attributes:
  title: an invented test, to try the program with
  condition: 90kW
  origin: synthetic
  injection_time: 0.0
  plasma_off_time: 50.0
  reference_window: [0.0, 5.0]
  emittance: 0.8
  emittance_uncertainty: 0.05
  window_transmittance_pyrometer: 0.9
  window_transmittance_spectrometer: 0.9
  pyrometer_integration_time: 0.01
  spectrometer_fwhm: 4e-9
pyrometer:
  file: pyrometer.csv
  columns:
    time: {name: Time}
    signal_wide: {name: S1}
    signal_narrow: {name: S2}
spectrometer:
  folder: spectrometer
  background: dark.txt
  quantity: counts
  time: {from: order, first: 2.0, period: 4.0}
"""


def test_folder(place):
    """Write a test of known truth as raw files with test.yaml."""
    (place / "spectrometer").mkdir(parents=True)
    (place / "test.yaml").write_text(TEST_YAML)
    test = made()
    columns = zip(
        test.time.values, *(test[n].values * 1e9 for n in ("signal_wide", "signal_narrow")), strict=True
    )
    rows = "".join(f"{t:.2f};{a:.4f};{b:.4f}\n" for t, a, b in columns)
    (place / "pyrometer.csv").write_text("Time [s];S1 [nA];S2 [nA]\n" + rows)
    for index, moment in enumerate(np.arange(2.0, 60.0, 4.0)):
        light = seen(moment)
        name = f"spectrum_{index:03d}.txt"
        (place / "spectrometer" / name).write_text(spectrum(raw(light, 0.5, 50 + index), 0.5))
    (place / "dark.txt").write_text(spectrum(raw(0 * WAVELENGTH, 0.5, 9), 0.5))
    return place
