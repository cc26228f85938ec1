"""Intervals of what stands beside a better estimate, or beside none."""

import laboratory
import numpy as np
import pytest
import xarray as xr

from plasmapyro import cli, io
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.instrument.stage import band_response
from plasmapyro.quality.agreement import level_jumps, level_steps
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import status

METAL = 0.28  # emittance at the middle wavelength of the sample, as is stated
COLUMNS = {
    "corrected_temperature": "corrected_status",
    "scaled_temperature": "spectrum_status",
    "spectrometer_temperature": "spectrum_status",
    "spectral_temperature": "spectral_status",
    "recommended_temperature": "recommended_status",
}
PLAIN = ("counts", "background_counts")


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
    found = {name: row.size > 10 and row.max() < 2 for name, row in pulls(result).items()}
    assert found.pop("recommended_temperature") is False and len(found) == 3 and all(found.values())


def test_a_lamp_behind_the_end_leaves_no_valid_sample_that_is_five_uncertainties_off(lab):
    """The fits had been 20 to 90 off where the lamp was no brighter than a third of the fading light."""
    result = corrected(lab, of_metal(0.0, lamp=4e-4))
    after = result.spectrum_time.values > 54
    assert (result.spectrum_status.values[after] != status.VALID).all()
    assert all(row.size > 10 and row.max() < 2 for row in pulls(result).values() if row.size)


def rescaled(factor, begin, end=np.inf):
    """The laboratory's test; spectra and their dark charge by a factor from `begin` to `end` [s]."""
    test, place = laboratory.made(), laboratory.made().spectrum_time.values
    test.attrs["condition"] = "90kW"
    light = laboratory.seen(place)
    seconds = np.where((place > begin) & (place < end), 0.5 * factor, 0.5)
    rows = [
        laboratory.raw(row, length, 10 + i)
        for i, (row, length) in enumerate(zip(light, seconds, strict=True))
    ]
    return test.assign(counts=(test.counts.dims, np.array(rows)))


@pytest.mark.parametrize("alone", [True, False], ids=["spectra alone", "beside a pyrometer"])
@pytest.mark.parametrize("factor", [0.5, 1.25])
def test_an_integration_time_that_changes_unsaid_is_said_once_and_nothing_valid_is_wrong(lab, factor, alone):
    """Temperature and emissivity had been valid 11 uncertainties off, and 3.6 off recommended."""
    test = rescaled(factor, 29.0)
    result = corrected(lab, test[[*PLAIN]] if alone else test)
    said = result.attrs["findings"].split("\n")
    (first,) = (words for words in said if words.endswith("[emittance_jumps]"))
    further = (
        "[emittance_jumps]",
        "[plasma_off_time]",
        "[emittance_of_spectra]",
    )  # a fall by half is one, too
    assert "was the integration time changed" in first and all(words.endswith(further) for words in said)
    assert float(first.split("becomes ")[1].split()[0]) == pytest.approx(factor, rel=0.01)
    assert result.attrs["recommended"] == "none"
    found = pulls(result)
    assert found["scaled_temperature"].size > 10
    assert all(row.max(initial=0.0) < 2 for row in found.values())


def test_a_level_that_stays_is_told_to_some_per_cent_and_nothing_is_said(lab):
    result = corrected(lab, rescaled(1.0, 29.0))
    place, step, error = level_steps(result)
    assert result.attrs["findings"] == "" and place.shape == (step.size, 2) and step.size > 20
    assert (np.abs(step) < np.maximum(0.01, 4 * error)).all()


def test_exposures_as_long_as_the_sample_takes_to_heat_show_no_step():
    """A mean over a ramp bends the spectrum: the first pair had a step of 0.19, 600 of its errors."""
    wavelength, middle = np.linspace(750e-9, 1025e-9, 600), np.arange(10.0, 60.0, 4.0)
    moment = middle[:, None] + np.linspace(-1.9, 1.9, 39)
    kelvin = 1900 - 1580 * np.exp(-moment / 20.0)
    light = blackbody_radiance(wavelength, kelvin[..., None]).mean(axis=1)
    rows = ("spectrum_time", "wavelength")
    result = xr.Dataset(
        {
            "spectrum_status": ("spectrum_time", np.full(middle.size, status.VALID)),
            "corrected_radiance": (rows, light),
            "radiance_noise": (rows, np.full(light.shape, 1e-4 * light[0].mean())),
            "reference_radiance": ("wavelength", np.zeros(wavelength.size)),
        },
        {"wavelength": wavelength, "spectrum_time": middle},
    )
    assert len(level_steps(result)[1]) == middle.size - 1
    assert [one.size for one in level_steps(result.isel(spectrum_time=[0]))[1:]] == [0, 0]
    assert level_jumps(result, 0.15)[1].size == 0


@pytest.mark.parametrize("seed", [5, 8])
def test_noise_of_a_surface_that_begins_to_outshine_the_gas_is_no_step(lab, seed):
    """Pixels that were taken where noise made them bright had a step of 1.4."""
    test = laboratory.made().assign_attrs(condition="90kW").isel(spectrum_time=slice(None, None, 3))
    noise = 2.0 * np.random.default_rng(seed).standard_normal(test.counts.shape)
    result = corrected(lab, test.assign(counts=test.counts + noise))
    assert "[emittance_jumps]" not in result.attrs["findings"]


def test_a_window_that_fogs_costs_no_fit_whose_colour_the_level_of_the_pyrometer_confirms(lab):
    """Beyond a factor of 1.5 they were contradicted, and samples of the pyrometer beside them."""
    test = laboratory.made()
    moment = test.spectrum_time
    through = 1 - 0.55 * ((moment - 35) / 20).clip(0, 1)
    dark = test.background_counts
    test["counts"] = ((test.counts - dark) * through + dark).transpose(*test.counts.dims)
    sound = corrected(lab, laboratory.made().assign_attrs(condition="90kW"))
    result = corrected(lab, test.assign_attrs(condition="90kW"))
    for state in ("spectrum_status", "corrected_status"):
        assert (result[state] == status.VALID).sum() >= (sound[state] == status.VALID).sum()
    assert all(row.max(initial=0.0) < 2 for row in pulls(result).values())


def test_repeats_of_a_logger_that_asks_too_often_are_no_later_samples(lab):
    """Each sample held up to half a second longer: the joint estimate was 6.5 stated uncertainties off."""
    test = laboratory.made().assign_attrs(condition="90kW")
    place = np.arange(test.time.size)
    held = test[["signal_wide", "signal_narrow"]].isel(time=place - place % 3).assign_coords(time=test.time)
    result = corrected(lab, test.assign(held.data_vars))
    assert "[asked_too_often]" in result.attrs["findings"] and result.attrs["recommended"] != "none"
    assert all(row.max(initial=0.0) < 2 for row in pulls(result).values())


def test_fits_to_spectra_near_the_end_of_a_detector_hold_each_other(lab):
    """One that is bent at the top leaves the fits to scale and to shape 3.5 stated uncertainties apart."""
    test = laboratory.made().assign_attrs(condition="90kW")
    above = (test.counts - 12000).clip(0)
    test["counts"] = (test.counts - above + 8000 * (1 - np.exp(-above / 8000))).transpose(*test.counts.dims)
    found = pulls(corrected(lab, test))
    assert found["spectrometer_temperature"].size > 10
    assert found["spectrometer_temperature"].max() < 3 and found["scaled_temperature"].max() < 3


@pytest.mark.parametrize("power", [0.3, 0.5])
def test_the_subtraction_of_a_pyrometer_alone_whose_level_is_in_doubt_holds_the_other_estimate(lab, power):
    """Beside a recommendation it had been 3 to 4 stated uncertainties too hot for metals."""
    result = corrected(lab, of_metal(power)[["signal_wide", "signal_narrow"]])
    assert "[throughput_in_doubt]" in result.attrs["findings"] and result.attrs["recommended"] == "joint"
    found = pulls(result)
    assert found["corrected_temperature"].size > 100
    assert all(row.max(initial=0.0) < 3 for row in found.values())


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
