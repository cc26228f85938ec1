"""The calibration holds on real counts of an FEL lamp and of a Hg(Ar) lamp, taken over three years."""

import csv
import hashlib
from pathlib import Path

import numpy as np
import pytest
import yaml

from plasmapyro.instrument import raw_counts
from plasmapyro.instrument.line_lamp import find_lines
from plasmapyro.instrument.shape import compare
from plasmapyro.refraction import vacuum_wavelength

REFERENCE = Path(__file__).resolve().parents[1] / "reference"
# Relative response of the sensor of MAYP11278, in rising powers of counts, as its maker states it.
COEFFICIENTS = [1.00237, -1.11854e-7, 5.50740e-11, -1.09558e-14]
COEFFICIENTS += [5.46964e-19, -1.29196e-23, 1.50047e-28, -6.88580e-34]
MASKED = [2, 3, -2, -1]
BAND = (750e-9, 900e-9)
SHAPE_LIMIT = 15.0  # [K] demanded between years of one lamp
EXPOSURE_LIMIT = 0.015  # demanded between exposures of 0.6 and 5 s
LINE_LIMIT = 0.3e-9  # [m] demanded of the wavelengths
RUNS = {"2013": 0.6, "2013_long": 5.0, "2014": 0.6, "2014_other": 0.6, "2016": 0.4}


def load(name):
    content = (REFERENCE / f"{name}.csv").read_bytes()
    certificate = yaml.safe_load((REFERENCE / f"{name}.yml").read_text(encoding="utf-8"))
    assert hashlib.sha256(content).hexdigest() == certificate["sha256"]
    header, *rows = csv.reader(content.decode().splitlines())
    table = np.array([[float(cell or "nan") for cell in row] for row in rows]).T
    return dict(zip((cell.split(" [")[0] for cell in header), table, strict=True))


@pytest.fixture(scope="module")
def lamp():
    return load("maya_lamp_counts")


def rate(lamp, run, follow_dark=True):
    suffix = "_2016" if run == "2016" else ""
    wavelength = vacuum_wavelength(lamp[f"wavelength_air{suffix}"] * 1e-9)
    dim = (wavelength > 196e-9) & (wavelength < 295e-9)
    found, *_, scale = raw_counts.net_rate(
        lamp[f"light_{run}"],
        lamp[f"dark_{run}"],
        integration_time=RUNS[run],
        coefficients=COEFFICIENTS,
        masked=MASKED,
        dim=dim if follow_dark else None,
        noise_block=50,
    )
    return wavelength, found, scale


def transferred(lamp, calibrated_with, seen):
    """Irradiance of a run, calibrated with another; beside that of the certificate."""
    certificate = lamp["wavelength_air"] * 1e-9, lamp["irradiance"]
    good = np.isfinite(certificate[1]) & (certificate[0] > 700e-9)
    own, reference, _ = rate(lamp, calibrated_with)
    wavelength, found, _ = rate(lamp, seen)
    points = vacuum_wavelength(certificate[0][good]), certificate[1][good]
    factor = raw_counts.certified_source(own, *points) / reference
    return (
        wavelength,
        np.interp(wavelength, own, factor) * found,
        raw_counts.certified_source(wavelength, *points),
    )


@pytest.mark.parametrize("calibrated_with", ["2013", "2014", "2016"])
@pytest.mark.parametrize("seen", ["2013", "2014", "2016"])
def test_another_year_of_the_same_lamp_keeps_its_shape(lamp, calibrated_with, seen):
    found = compare(*transferred(lamp, calibrated_with, seen), BAND)
    assert abs(found.temperature_difference) < SHAPE_LIMIT
    assert found.level == pytest.approx(1, abs=0.04)
    assert found.residual < 0.006


@pytest.mark.parametrize("calibrated_with", ["2013", "2014", "2016"])
def test_the_other_lamp_is_told_apart_by_its_shape(lamp, calibrated_with):
    found = compare(*transferred(lamp, calibrated_with, "2014_other"), BAND)
    assert abs(found.temperature_difference) > 5 * SHAPE_LIMIT


def windows(lamp, follow_dark):
    """Ratio of the rates of the short and the long exposure, medians over 20 nm."""
    wavelength, short, _ = rate(lamp, "2013", follow_dark)
    _, long, _ = rate(lamp, "2013_long", follow_dark)
    good = (lamp["light_2013_long"] < 63000) & (lamp["pixel"] > 10) & (lamp["pixel"] < 2055)
    for low in np.arange(200e-9, 460e-9, 20e-9):
        inside = good & (wavelength >= low) & (wavelength < low + 20e-9)
        if inside.sum() > 10:
            yield np.median(short[inside] / long[inside])


def test_short_and_long_exposures_agree_where_neither_is_saturated(lamp):
    ratios = np.array(list(windows(lamp, True)))
    assert ratios.size >= 8
    assert np.abs(ratios - 1).max() < EXPOSURE_LIMIT


def test_without_the_drift_of_the_dark_they_do_not(lamp):
    assert np.abs(np.array(list(windows(lamp, False))) - 1).max() > 0.15


def test_the_dark_current_had_drifted(lamp):
    assert rate(lamp, "2013")[2] == pytest.approx(0.925, abs=0.02)
    assert rate(lamp, "2016")[2] == pytest.approx(0.643, abs=0.02)


@pytest.mark.parametrize("year", ["2013", "2014"])
def test_lamp_lines_come_out_where_they_are_certified(year):
    table = load("maya_line_lamp_counts")
    wavelength = table["wavelength_air"] * 1e-9
    net = table[f"lamp_{year}"] - table[f"dark_{year}"]
    settings = {"expected_fwhm": 1.2e-9, "search": 1.5e-9, "least_signal_to_noise": 20}
    lines = find_lines(vacuum_wavelength(wavelength), net, **settings)
    error = np.array([line.wavelength - line.certified for line in lines])
    assert len(lines) >= 6
    assert np.abs(error).max() < LINE_LIMIT
    as_vacuum = find_lines(wavelength, net, **settings)
    worse = np.array([line.wavelength - line.certified for line in as_vacuum])
    assert np.abs(worse.mean()) > np.abs(error.mean())  # the maker's scale is in air
    assert 0.8e-9 < np.median([line.fwhm for line in lines]) < 1.5e-9
