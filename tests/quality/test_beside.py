"""Intervals of what stands beside a better estimate, or beside none."""

import laboratory
import numpy as np
import pytest

from plasmapyro import cli, io
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.instrument.stage import band_response
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import status

METAL = 0.28  # emittance at the middle wavelength of the sample, as is stated
COLUMNS = {
    "corrected_temperature": "corrected_status",
    "scaled_temperature": "spectrum_status",
    "spectrometer_temperature": "spectrum_status",
}


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    place = tmp_path_factory.mktemp("metal")
    laboratory.calibration_folder(place / "calibration")
    assert cli.main(["calibrate", str(place / "calibration"), "--out", str(place / "lab")]) == 0
    return place


def corrected(lab, test):
    io.write(test, lab / "test.nc", "test")
    out = lab / "out.nc"
    words = [
        "correct",
        str(lab / "test.nc"),
        "--instrument",
        str(lab / "lab"),
        "--out",
        str(out),
        "--no-html",
    ]
    assert cli.main([*words, "--draws", "50"]) == 0
    return io.read(out, "correction")


def of_metal(power, lamp=0.0):
    """The laboratory's test with a sample whose emittance goes with the wavelength; from 54 s on a lamp."""
    test = laboratory.made()
    test.attrs |= {"condition": "90kW", "emittance": METAL, "emittance_uncertainty": 0.02}
    response = band_response(**RESPONSE)

    def emittance(wavelength):
        return METAL * (900e-9 / wavelength) ** power

    time, moments = test.time.values, test.spectrum_time.values
    share = [
        np.sum(emittance(response.wavelength.values) * response[f"responsivity_{band}"].values * light)
        / np.sum(response[f"responsivity_{band}"].values * light)
        for band in ("wide", "narrow")
        for light in [blackbody_radiance(response.wavelength.values, 1500.0)]
    ]
    surface = np.array(share)[:, None] * laboratory.signals(laboratory.temperature(time)) * (time >= 0)
    gas = laboratory.gas()[0][:, None] * laboratory.brightness(time) * (time <= laboratory.OFF)
    noise = 1 + laboratory.NOISE * np.random.default_rng(3).standard_normal(gas.shape)
    both = (surface + gas + lamp * laboratory.signals(np.full(time.size, 2800.0)) * (time > 54)) * noise
    axis = laboratory.WAVELENGTH
    body = emittance(axis) * blackbody_radiance(axis, laboratory.temperature(moments)[:, None])
    light = (
        body + laboratory.gas()[1] * ((moments <= laboratory.OFF) * laboratory.brightness(moments))[:, None]
    )
    light += lamp * blackbody_radiance(axis, 2800.0) * (moments > 54)[:, None]
    counts = np.array([laboratory.raw(row, 0.5, 10 + i) for i, row in enumerate(light)])
    return test.assign(
        signal_wide=("time", both[0]), signal_narrow=("time", both[1]), counts=(test.counts.dims, counts)
    )


def pulls(result):
    """Name -> errors over stated uncertainties of what is valid."""
    found = {}
    for name in (one for one in COLUMNS if one in result):
        column = result[name]
        off = (column - laboratory.temperature(column[column.dims[0]].values)) / result[f"{name}_uncertainty"]
        found[name] = np.abs(off.values[result[COLUMNS[name]].values == status.VALID])
    return found


def test_beside_no_recommendation_intervals_hold_the_temperature_of_the_level(lab):
    """The bands' ratio and the fits had been 4 to 25 stated uncertainties off, and valid."""
    result = corrected(lab, of_metal(1.2))
    assert result.attrs["recommended"] == "none"
    assert {name: row.size > 10 and row.max() < 2 for name, row in pulls(result).items()} == dict.fromkeys(
        COLUMNS, True
    )


def test_a_lamp_behind_the_end_leaves_no_valid_sample_that_is_five_uncertainties_off(lab):
    """The fits had been 20 to 90 off where the lamp was no brighter than a third of the fading light."""
    result = corrected(lab, of_metal(0.0, lamp=4e-4))
    after = result.spectrum_time.values > 54
    assert (result.spectrum_status.values[after] != status.VALID).all()
    assert all(row.size > 10 and row.max() < 2 for row in pulls(result).values())


def test_fits_to_spectra_alone_hold_temperature_and_emissivity_together(lab):
    test = of_metal(0.3)[["counts", "background_counts"]]
    result = corrected(lab, test)
    assert result.attrs["recommended"] == "emissivity"
    assert all(row.size > 0 and row.max() < 2 for row in pulls(result).values())


def test_spectra_whose_times_are_not_theirs_have_no_value_beside_no_recommendation(lab):
    """Files lost from a series ordered by name: fits were valid 24 stated uncertainties off."""
    place = laboratory.test_folder(lab / "lost")
    for number in (3, 4, 5):
        (place / "spectrometer" / f"spectrum_{number:03d}.txt").unlink()
    words = ["--instrument", str(lab / "lab"), "--out", str(lab / "lost.nc"), "--no-html", "--draws", "50"]
    assert cli.main(["correct", str(place), *words]) == 0
    result = io.read(lab / "lost.nc", "correction")
    assert "[missing_frame]" in result.attrs["findings"] and result.attrs["recommended"] == "none"
    assert not (result.spectrum_status.values == status.VALID).any()
