"""The stages of a test on light made by hand: surfaces of known temperature behind a known gas."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.experiment.stage import correct_pyrometer, correct_spectra, middle_exposure
from plasmapyro.instrument.calibration import quadratic_ratio
from plasmapyro.instrument.stage import spectrometer_calibration
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import status
from plasmapyro.refraction import vacuum_wavelength

TIME = np.round(np.arange(-4.0, 60.0, 0.25), 9)
FRAMES = np.arange(-2.0, 60.0, 2.0)
PIXELS = np.linspace(750e-9, 1030e-9, 300)
COEFFICIENT, FIT, INSTRUMENT = np.array([0.40, 0.12, -0.003]), (973.0, 1773.0), (973.0, 2073.0)
GAS_SIGNAL = np.array([2e-8, 1e-8])
GAS_RADIANCE = 1e9 * (1 + 3 * np.exp(-(((PIXELS - 777e-9) / 1e-9) ** 2)))
PYROMETER = {
    "signal_uncertainty": 0.01,
    "gas_variation": 0.03,
    "detection_level": 2.0,
    "least_surface_share": 0.5,
    "draws": 300,
    "seed": 4,
}
SPECTROMETER = {
    "reference_time": 2.0,
    "normalisation_wavelength": 1030e-9,
    "normalisation_half_width": 1e-9,
    "temperature_range": (600.0, 3500.0),
    "saturation_counts": 65000.0,
    "gas_variation": 0.03,
    "least_signal_to_noise": 10.0,
    "noise_block": 50,
    "draws": 40,
    "seed": 4,
}
SENSITIVITY = 1e-6  # [count s-1 / (W m-2 sr-1 m-1)]


def truth(time):
    """350 K in the window, then a straight rise to 1600 K, and a fall after the plasma is off at 50 s."""
    rise = np.clip(900 + (np.asarray(time) - 6) * 35, 900, 1600)
    return np.where(time <= 6, 350.0, np.where(time > 50, 1600 - 20 * (time - 50), rise))


def calibration():
    return xr.Dataset(
        {
            "fit_coefficient": ("fit_power", COEFFICIENT),
            "fit_covariance": (("fit_power", "other_fit_power"), np.diag([1e-6, 2e-6, 2e-6])),
            "fit_range": ("bound", list(FIT)),
            "instrument_range": ("bound", list(INSTRUMENT)),
        }
    )


def made(gas=1.0, ambient=0.0):
    """Noise-free test; `ambient` is added to everything the plasma lights."""
    lit = ((TIME >= 0) & (TIME <= 50)) | (TIME < 0)
    narrow = 1e-6 * np.exp(14000 * (1 / 1600 - 1 / truth(TIME))) * (TIME >= 0)
    ratio = np.maximum(quadratic_ratio(truth(TIME), COEFFICIENT, FIT), 0.01)
    signals = np.stack([ratio * narrow, narrow]) + lit * (gas * GAS_SIGNAL[:, None] + ambient)
    shining = (FRAMES <= 50)[:, None]
    body = 0.85 * blackbody_radiance(PIXELS, truth(FRAMES)[:, None]) * (FRAMES >= 0)[:, None]
    noise = 1e5 * np.random.default_rng(1).standard_normal(body.shape)
    return xr.Dataset(
        {
            "signal_wide": ("time", signals[0], {"units": "A"}),
            "signal_narrow": ("time", signals[1], {"units": "A"}),
            "spectral_radiance": (
                ("spectrum_time", "wavelength"),
                body + shining * gas * GAS_RADIANCE + noise,
                {"units": "W m-2 sr-1 m-1"},
            ),
        },
        {
            "time": ("time", TIME, {"units": "s"}),
            "spectrum_time": ("spectrum_time", FRAMES, {"units": "s"}),
            "wavelength": ("wavelength", PIXELS, {"units": "m"}),
        },
        {
            "origin": "synthetic",
            "condition": "none",
            "injection_time": 0.0,
            "plasma_off_time": 50.0,
            "reference_window": [0.0, 5.0],
            "emittance": 0.85,
            "emittance_uncertainty": 0.05,
            "window_transmittance_pyrometer": 0.87,
            "window_transmittance_spectrometer": 0.95,
            "pyrometer_integration_time": 0.01,
            "spectrometer_integration_time": 1.0,
            "spectrometer_fwhm": 0.75e-9,
        },
    )


@pytest.fixture(scope="module")
def pyrometer():
    return correct_pyrometer(made(), calibration(), **PYROMETER)


@pytest.fixture(scope="module")
def spectrometer():
    return correct_spectra(made(), None, **SPECTROMETER)


def test_results_honour_their_contracts(pyrometer, spectrometer):
    for dataset, contract in ((pyrometer, "pyrometer_correction"), (spectrometer, "spectrometer_correction")):
        contracts.check(contracts.label(dataset, contract), contract)
        assert dataset.attrs["origin"] == "synthetic" and dataset.attrs["plasma_off_time"] == 50.0


def test_reference_is_the_gas(pyrometer, spectrometer):
    # 350 K add nothing: 14000 (1/1600 - 1/350) is -31.
    np.testing.assert_allclose(pyrometer.reference_signal, GAS_SIGNAL, rtol=1e-9)
    line = int(np.argmin(np.abs(PIXELS - 777e-9)))
    assert float(spectrometer.reference_radiance[line]) == pytest.approx(GAS_RADIANCE[line], rel=1e-3)


def test_corrected_temperature_is_the_true_one_and_the_measured_is_not(pyrometer):
    heating = (TIME > 12) & (TIME <= 50)
    np.testing.assert_allclose(pyrometer.corrected_temperature[heating], truth(TIME)[heating], rtol=1e-6)
    early, later = (TIME > 12) & (TIME < 14), (TIME > 20) & (TIME < 22)
    assert (pyrometer.measured_status[early] == status.ABOVE).all()
    assert (pyrometer.measured_temperature[later] - truth(TIME)[later] > 10).all()


def test_nothing_is_taken_away_after_the_plasma_is_off(pyrometer):
    cooling = TIME > 50
    assert (pyrometer.relative_error[cooling] == 0).all()
    np.testing.assert_allclose(pyrometer.corrected_temperature[cooling], truth(TIME)[cooling], rtol=1e-9)
    assert (pyrometer.surface_share[:, cooling] == 1).all()


def test_samples_without_a_temperature_say_why(pyrometer):
    state = pyrometer.corrected_status.values
    assert (state[TIME < 0] == status.NOT_INJECTED).all()
    assert (state[(TIME >= 0) & (TIME < 5)] == status.NO_SIGNAL).all()
    value = np.isin(state, (status.VALID, status.EXTRAPOLATED, status.GAS_DOMINATED))
    assert (np.isfinite(pyrometer.corrected_temperature) == value).all()


def test_no_temperature_is_given_without_an_uncertainty():
    found = correct_pyrometer(
        made(), calibration(), **PYROMETER | {"detection_level": 0.0, "gas_variation": 1.0}
    )
    given = np.isfinite(found.corrected_temperature.values)
    np.testing.assert_array_equal(given, np.isfinite(found.corrected_temperature_uncertainty.values))
    np.testing.assert_array_equal(given, np.isin(found.corrected_status.values, status.WITH_VALUE))


def test_light_added_to_everything_the_plasma_lights_cancels(pyrometer):
    brighter = correct_pyrometer(made(ambient=3e-8), calibration(), **PYROMETER)
    hot = TIME > 25
    np.testing.assert_allclose(
        brighter.corrected_temperature[hot], pyrometer.corrected_temperature[hot], rtol=1e-9
    )


def test_uncertain_gas_matters_early_and_not_late(pyrometer):
    calm = correct_pyrometer(made(), calibration(), **{**PYROMETER, "gas_variation": 0.0})
    ratio = (pyrometer.corrected_temperature_uncertainty / calm.corrected_temperature_uncertainty).values
    early, late = (TIME > 9) & (TIME < 11), (TIME > 40) & (TIME < 50)
    assert np.nanmedian(ratio[early]) > 1.02 and np.nanmedian(ratio[late]) == pytest.approx(1, abs=0.02)


def test_a_window_that_is_dark_in_part_makes_the_gas_uncertain(pyrometer):
    test, dark = made(), (TIME >= 0) & (TIME < 1.5)  # of 5 s
    for name in ("signal_wide", "signal_narrow"):
        test[name] = ("time", np.where(dark, 0.0, test[name].values), test[name].attrs)
    found = correct_pyrometer(test, calibration(), **PYROMETER)
    early = (TIME > 6) & (TIME < 20) & (found.corrected_status == 0).values
    off = np.abs(found.corrected_temperature - truth(TIME)) / found.corrected_temperature_uncertainty
    assert float(off[early].max()) < 2.5
    wider = (found.corrected_signal_uncertainty / pyrometer.corrected_signal_uncertainty).values[0]
    assert np.nanmin(wider[(TIME > 6) & (TIME < 8)]) > 5


def test_error_is_relative_to_the_corrected_temperature(pyrometer):
    one = pyrometer.sel(time=22.0)
    expected = float(one.measured_temperature) / float(one.corrected_temperature) - 1
    assert float(one.relative_error) == pytest.approx(expected, rel=1e-9) and expected > 0.01


def test_both_uncertainties_are_one_where_nothing_is_taken_away():
    grey = made().assign_attrs(emittance_slope_uncertainty=0.0)  # else one error in all
    pyrometer = correct_pyrometer(grey, calibration(), **PYROMETER)
    cooling = TIME > 50
    ratio = pyrometer.corrected_temperature_uncertainty / pyrometer.measured_temperature_uncertainty
    assert float(ratio[cooling].mean()) == pytest.approx(1, abs=0.04)  # two sets of 300 draws, 39 samples


def test_missing_sample_stays_missing_and_touches_nothing_else(pyrometer):
    test = made()
    test["signal_wide"][200] = np.nan
    holed = correct_pyrometer(test, calibration(), **PYROMETER)
    assert holed.corrected_status[200] == holed.measured_status[200] == status.MISSING
    assert np.isnan(holed.corrected_temperature[200])
    xr.testing.assert_identical(
        holed.corrected_temperature.drop_isel(time=200), pyrometer.corrected_temperature.drop_isel(time=200)
    )


def test_spectra_give_the_true_temperature_and_emittance(spectrometer):
    hot = (FRAMES > 20) & (FRAMES < 50)
    usable = spectrometer.spectrum_status.values == status.VALID
    assert usable[hot].all() and not usable[FRAMES < 6].any()
    for name, rtol in (("spectrometer_temperature", 2e-3), ("scaled_temperature", 2e-4)):  # noise of the fit
        np.testing.assert_allclose(spectrometer[name][hot], truth(FRAMES)[hot], rtol=rtol)
    np.testing.assert_allclose(spectrometer.apparent_emittance[hot], 0.85, rtol=2e-3)


def test_uncertain_gas_widens_the_early_temperatures():
    calm, restless = (
        correct_spectra(made(), None, **{**SPECTROMETER, "gas_variation": size}).sel(spectrum_time=20.0)
        for size in (0.0, 0.1)
    )
    name = "spectrometer_temperature_uncertainty"
    assert float(restless[name]) > 3 * float(calm[name])


def test_pivot_signal_to_noise_counts_the_gas(spectrometer):
    frame = spectrometer.sel(spectrum_time=20.0)
    # The noise of 1e5 is nothing beside 3 % of a gas radiance of 1e9.
    expected = 0.85 * blackbody_radiance(1029.5e-9, truth(20.0)) / (0.03 * 1e9)
    assert float(frame.signal_to_noise) == pytest.approx(float(expected), rel=0.02)


def test_brighter_gas_line_hardly_moves_the_scaled_fit_that_expects_it():
    test, late = made(), 20
    values = test.spectral_radiance.values.copy()
    values[late] += 2.0 * (GAS_RADIANCE - 1e9)  # the line three times as bright, the rest as it was
    test["spectral_radiance"] = (test.spectral_radiance.dims, values, test.spectral_radiance.attrs)
    naive, wary = (
        correct_spectra(test, None, **{**SPECTROMETER, "gas_variation": size, "draws": 10})
        for size in (0.0, 0.5)
    )
    shift = [abs(float(found.scaled_temperature[late]) - truth(FRAMES)[late]) for found in (naive, wary)]
    assert shift[1] < 0.3 * shift[0]


def test_exposures_that_hold_a_switch_are_not_used(spectrometer):
    state = spectrometer.spectrum_status.sel(spectrum_time=[0.0, 50.0, -2.0]).values
    assert state.tolist() == [status.STRADDLING, status.STRADDLING, status.NOT_INJECTED]
    assert np.isnan(spectrometer.spectrometer_temperature.sel(spectrum_time=[0.0, 50.0])).all()


@pytest.mark.parametrize(("off", "expected"), [(50.25, status.STRADDLING), (50.75, status.VALID)])
def test_an_exposure_holds_what_is_nearer_than_half_of_it(off, expected):
    test = made()  # the exposure at 50 s lasts from 49.5 s to 50.5 s
    test.attrs["plasma_off_time"] = off
    found = correct_spectra(test, None, **{**SPECTROMETER, "draws": 2})
    assert found.spectrum_status.sel(spectrum_time=50.0) == expected


def test_a_pivot_is_not_where_the_noise_of_the_reference_made_all_spectra_bright():
    """Chosen by single pixels it was up to 3 deviations too bright, and all temperatures 50 to 80 K off."""
    test, bright = made(gas=0.0), []
    blue = test.sel(wavelength=PIXELS[PIXELS < 1020e-9])
    hot = blue.spectral_radiance.values[-1]
    at = int(np.abs(FRAMES - SPECTROMETER["reference_time"]).argmin())
    for seed in range(12):
        noise = 0.1 * hot * np.random.default_rng(seed).standard_normal(hot.size)
        values = blue.spectral_radiance.values.copy()
        values[at] += noise
        spoilt = blue.assign(
            spectral_radiance=(blue.spectral_radiance.dims, values, blue.spectral_radiance.attrs)
        )
        found = correct_spectra(spoilt, None, **SPECTROMETER | {"normalisation_wavelength": None, "draws": 2})
        place = found.attrs["normalisation_wavelength"]
        pixels = np.abs(blue.wavelength.values - place) <= SPECTROMETER["normalisation_half_width"]
        bright.append(-np.mean(noise[pixels] / hot[pixels]) / 0.1 * np.sqrt(pixels.sum()))
    assert np.mean(bright) < 0.9  # 1.3 by single pixels


def test_normalised_curves_meet_at_the_pivot(spectrometer):
    frame = spectrometer.sel(spectrum_time=40.0)
    pivot = np.abs(PIXELS - 1030e-9) <= 1e-9
    assert float(frame.normalised_radiance[pivot].mean()) == pytest.approx(1, rel=1e-12)
    assert float(frame.normalised_fit[pivot].mean()) == pytest.approx(1, rel=1e-12)
    assert float(np.abs(frame.normalised_radiance - frame.normalised_fit).mean()) < 1e-3


def counted():
    """The same light as raw counts, with its calibration."""
    test, dark = made(), np.full(PIXELS.size, 1000.0)
    counts = dark + test.spectral_radiance.values * SENSITIVITY * 1.0
    lamp = xr.Dataset(
        {
            "calibration_counts": (
                "wavelength",
                dark + 0.5 * SENSITIVITY * blackbody_radiance(PIXELS, 1773.0),
            ),
            "calibration_background": ("wavelength", dark),
        },
        {"wavelength": PIXELS},
        {"source_temperature": 1773.0, "integration_time": 0.5},
    )
    test = test.drop_vars("spectral_radiance")
    test["counts"] = (("spectrum_time", "wavelength"), counts, {"units": "count"})
    test["background_counts"] = ("wavelength", dark, {"units": "count"})
    calibrated = spectrometer_calibration(
        lamp,
        source_temperature_uncertainty=3.0,
        saturation_counts=65000.0,
        least_net_counts=1.0,
        noise_block=50,
    )
    return test, calibrated


def test_counts_and_radiances_are_two_ways_to_the_same_result(spectrometer):
    found = correct_spectra(*counted(), **SPECTROMETER)
    for name in ("spectral_radiance", "scaled_temperature", "apparent_emittance"):
        np.testing.assert_allclose(found[name], spectrometer[name], rtol=1e-6)


def test_source_error_reaches_temperature_and_emittance(monkeypatch):
    monkeypatch.setattr("plasmapyro.experiment.frame.scale_draws", lambda *_: 0.0)
    sure = counted()[1].assign(source_temperature_uncertainty=0.0)
    doubtful = counted()[1].assign(source_temperature_uncertainty=3.0)
    many = {**SPECTROMETER, "draws": 200}
    pair = [correct_spectra(counted()[0], one, **many).sel(spectrum_time=40.0) for one in (sure, doubtful)]
    extra = np.sqrt(
        float(pair[1].scaled_temperature_uncertainty) ** 2
        - float(pair[0].scaled_temperature_uncertainty) ** 2
    )
    # In the Wien limit 1/T shifts as 1/T_source does: dT = 3 K (1600/1773)^2.
    assert extra == pytest.approx(3.0 * (1600 / 1773) ** 2, rel=0.2)  # 3 sigma of 200 draws


def test_saturated_pixels_are_left_out():
    test, calibrated = counted()
    values = test.counts.values.copy()
    values[-10:, 40:60] = 65535.0
    test["counts"] = (test.counts.dims, values, test.counts.attrs)
    found = correct_spectra(test, calibrated, **SPECTROMETER)
    assert np.isnan(found.spectral_radiance[-10:, 40:60]).all()
    late = FRAMES > 52
    np.testing.assert_allclose(found.scaled_temperature[late], truth(FRAMES)[late], rtol=5e-4)


def test_a_spectrum_with_a_saturated_pivot_says_so():
    test, calibrated = counted()
    values = test.counts.values.copy()
    values[-1, -3:] = 65535.0
    test["counts"] = (test.counts.dims, values, test.counts.attrs)
    found = correct_spectra(test, calibrated, **SPECTROMETER)
    assert found.spectrum_status[-1] == status.SATURATED and np.isnan(found.scaled_temperature[-1])
    assert found.spectrum_status[-2] == status.VALID


def test_what_the_reader_found_saturated_is_not_used(spectrometer):
    test = made()
    lost = np.zeros(test.spectral_radiance.shape, dtype="int8")
    lost[-1] = 1
    test["saturated"] = (test.spectral_radiance.dims, lost, {"units": "1"})
    found = correct_spectra(test, None, **SPECTROMETER)
    assert found.spectrum_status[-1] == status.SATURATED
    np.testing.assert_array_equal(found.scaled_temperature[:-1], spectrometer.scaled_temperature[:-1])


def test_signals_at_the_limit_of_the_pyrometer_are_not_read(pyrometer):
    test = made()
    limit = float(test.signal_wide.max()) * 0.9
    test.attrs["signal_saturation_wide"] = limit
    found = correct_pyrometer(test, calibration(), **PYROMETER)
    over = test.signal_wide.values >= limit
    assert over.any() and (found.measured_status[over] == status.SATURATED).all()
    assert (found.corrected_status[over & (TIME >= 0)] == status.SATURATED).all()
    np.testing.assert_array_equal(found.corrected_temperature[~over], pyrometer.corrected_temperature[~over])


def test_a_saturated_sample_does_not_enter_the_reference(pyrometer):
    test = made()
    values = test.signal_wide.values.copy()
    values[np.searchsorted(TIME, 2.0)] = 1e-3
    test["signal_wide"] = ("time", values, test.signal_wide.attrs)
    test.attrs["signal_saturation_wide"] = 1e-3
    found = correct_pyrometer(test, calibration(), **PYROMETER)
    np.testing.assert_allclose(found.reference_signal, pyrometer.reference_signal, rtol=1e-12)


def test_the_reference_window_is_judged(pyrometer):
    assert pyrometer.attrs["pyrometer_reference_verdict"] == "clean"
    # The surface jumps from 350 K at 6 s to 900 K just after, a tenth of the gas in the narrow band.
    assert 6 < pyrometer.attrs["pyrometer_surface_onset"] < 9
    late = made()
    late.attrs["reference_window"] = [0.0, 12.0]
    found = correct_pyrometer(late, calibration(), **PYROMETER)
    assert found.attrs["pyrometer_reference_verdict"] == "surface_shows"
    assert found.attrs["pyrometer_proposed_window"][1] < 6


@pytest.mark.parametrize(("window", "middle"), [([0.0, 5.0], 2.0), ([0.6, 3.4], 2.0), ([1.6, 2.4], None)])
def test_a_reference_spectrum_is_looked_for_in_the_window(window, middle):
    test = made()
    test.attrs["reference_window"] = window
    assert middle_exposure(test) == middle


def test_same_seed_same_result(pyrometer, spectrometer):
    xr.testing.assert_identical(pyrometer, correct_pyrometer(made(), calibration(), **PYROMETER))
    xr.testing.assert_identical(spectrometer, correct_spectra(made(), None, **SPECTROMETER))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"reference_time": 20.0}, "exposure nearest to reference_time 20 s, 19.5 to 20.5 s, is not inside"),
        (
            {"normalisation_wavelength": 1.1e-6},
            "no usable pixel within 1 nm of the wavelength at which the spectra are normalised, 1100",
        ),
    ],
)
def test_impossible_settings_are_refused(settings, message):
    with pytest.raises(ValueError, match=message):
        correct_spectra(made(), None, **{**SPECTROMETER, **settings})


def test_counts_without_calibration_are_refused():
    with pytest.raises(ValueError, match="holds counts: a spectrometer calibration is needed"):
        correct_spectra(counted()[0], None, **SPECTROMETER)


def test_calibration_on_other_pixels_is_refused():
    test, calibrated = counted()
    with pytest.raises(ValueError, match="not on the same wavelengths"):
        correct_spectra(test, calibrated.isel(wavelength=slice(1, None)), **SPECTROMETER)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda axis: vacuum_wavelength(axis), "apart, as air from vacuum: state `wavelengths`"),
        (lambda axis: axis + 3e-11, "up to 0.03 nm apart: were they printed with fewer digits"),
        (lambda axis: axis + 5e-8, "up to 50 nm apart$"),
    ],
)
def test_by_how_much_wavelengths_differ_and_why_is_said(change, words):
    test, calibrated = counted()
    with pytest.raises(ValueError, match=words):
        moved = calibrated.assign_coords(wavelength=change(calibrated.wavelength.values))
        correct_spectra(test, moved, **SPECTROMETER)


@pytest.mark.parametrize(("shift", "accepted"), [(5e-12, True), (2e-11, False)])
def test_other_printed_digits_are_the_same_pixels(shift, accepted):
    test, calibrated = counted()
    moved = calibrated.assign_coords(wavelength=PIXELS + shift)
    if accepted:
        found = correct_spectra(test, moved, **{**SPECTROMETER, "draws": 2})
        np.testing.assert_array_equal(found.wavelength, PIXELS)
    else:
        with pytest.raises(
            ValueError, match="300 pixels from 750.020 to 1030.020 nm against 300 pixels from"
        ):
            correct_spectra(test, moved, **SPECTROMETER)


def test_calibration_that_turns_over_is_refused():
    bent = calibration()
    bent["fit_coefficient"] = ("fit_power", [0.4, 0.12, -0.1])
    with pytest.raises(ValueError, match="must rise over the instrument range"):
        correct_pyrometer(made(), bent, **PYROMETER)


@pytest.mark.parametrize("by", [10.0, 30.0, -5.0, 1e4])
def test_the_clock_of_the_test_does_not_matter(by):
    test = made()
    moved = test.assign_coords(
        time=("time", TIME + by, test.time.attrs),
        spectrum_time=("spectrum_time", FRAMES + by, test.spectrum_time.attrs),
    ).assign_attrs(
        {
            name: np.asarray(test.attrs[name]) + by
            for name in ("injection_time", "plasma_off_time", "reference_window")
        }
    )
    later = SPECTROMETER | {"reference_time": SPECTROMETER["reference_time"] + by}
    for plain, shifted, axis in (
        (
            correct_pyrometer(test, calibration(), **PYROMETER),
            correct_pyrometer(moved, calibration(), **PYROMETER),
            "time",
        ),
        (correct_spectra(test, None, **SPECTROMETER), correct_spectra(moved, None, **later), "spectrum_time"),
    ):
        np.testing.assert_array_equal(shifted[axis], plain[axis] + by)
        for name in plain.data_vars:
            np.testing.assert_array_equal(shifted[name].values, plain[name].values, err_msg=name)
        for name, value in plain.attrs.items():
            on_clock = name in ("injection_time", "plasma_off_time", "reference_window", "reference_time")
            if on_clock or name.endswith(("_surface_onset", "_proposed_window")):
                np.testing.assert_allclose(shifted.attrs[name], np.asarray(value) + by, atol=1e-9)
            elif not name.endswith("_bias"):
                assert np.array_equal(shifted.attrs[name], value), name
