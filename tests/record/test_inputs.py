"""A bad test is refused with everything that is wrong with it; a sound one is not."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.record import inputs

TIME, FRAMES, PIXELS = (
    np.arange(-5.0, 50.0, 0.5),
    np.arange(-4.0, 50.0, 2.0),
    np.linspace(750e-9, 1030e-9, 40),
)


def sound():
    spectra = np.ones((FRAMES.size, PIXELS.size))
    return xr.Dataset(
        {
            "signal_wide": ("time", np.ones(TIME.size), {"units": "A"}),
            "signal_narrow": ("time", np.ones(TIME.size), {"units": "A"}),
            "spectral_radiance": (("spectrum_time", "wavelength"), spectra, {"units": "W m-2 sr-1 m-1"}),
        },
        {
            "time": ("time", TIME, {"units": "s"}),
            "spectrum_time": ("spectrum_time", FRAMES, {"units": "s"}),
            "wavelength": ("wavelength", PIXELS, {"units": "m"}),
        },
        {
            "origin": "measured",
            "injection_time": 0.0,
            "plasma_off_time": 40.0,
            "reference_window": [0.0, 6.0],
            "emittance": 0.85,
            "emittance_uncertainty": 0.0,
            "window_transmittance_pyrometer": 0.87,
            "window_transmittance_spectrometer": 0.95,
            "pyrometer_integration_time": 0.01,
            "spectrometer_integration_time": 1.0,
            "spectrometer_fwhm": 0.75e-9,
        },
    )


def test_sound_test_has_no_fault_and_honours_its_contract():
    assert inputs.faults(sound()) == []
    assert inputs.instruments(sound()) == ["pyrometer", "spectrometer"]
    contracts.check(contracts.label(sound(), "test"), "test")


@pytest.mark.parametrize(
    ("absent", "left"),
    [
        (["signal_wide", "signal_narrow", "time"], ["spectrometer"]),
        (["spectral_radiance", "spectrum_time", "wavelength"], ["pyrometer"]),
    ],
)
def test_either_instrument_may_be_absent_but_not_asked_for(absent, left):
    test = sound().drop_vars(absent)
    assert inputs.faults(test) == [] and inputs.instruments(test) == left
    other = ({"pyrometer", "spectrometer"} - set(left)).pop()
    with pytest.raises(ValueError, match=f"holds no data of the {other}"):
        inputs.require(test, other)


def test_missing_samples_are_no_fault():
    test = sound()
    test["signal_wide"][20] = np.nan
    test["spectral_radiance"][3, 4] = np.nan
    assert inputs.faults(test) == []


def change(**attributes):
    def applied(test):
        test.attrs.update(attributes)
        return test

    return applied


def put(name, index, value):
    def applied(test):
        values = test[name].values.copy()
        values[index] = value
        test[name] = (test[name].dims, values, test[name].attrs)
        return test

    return applied


def unit(name, value):
    def applied(test):
        test[name].attrs["units"] = value
        return test

    return applied


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda test: test.drop_vars("signal_wide"), "signal_wide: missing"),
        (lambda test: test.drop_vars("wavelength"), "wavelength: missing"),
        (lambda test: test.rename(spectral_radiance="counts"), "background_counts: missing"),
        (unit("signal_narrow", "mA"), "signal_narrow: units 'mA', expected 'A'"),
        (unit("wavelength", "nm"), "wavelength: units 'nm', expected 'm'"),
        (put("time", 4, -9.0), "time: must increase strictly"),
        (put("spectrum_time", 4, np.nan), "spectrum_time: must increase strictly, without NaN"),
        (put("signal_wide", 3, np.inf), "signal_wide: infinite samples; a missing sample is NaN"),
        (put("signal_wide", slice(None), np.nan), "signal_wide: holds no sample"),
        (
            put("signal_narrow", slice(9, 24), np.nan),
            "signal_narrow: 0 samples in the reference window 0 to 6 s",
        ),
        (change(plasma_off_time=-1.0), "plasma_off_time -1 s must come after injection_time 0 s"),
        (change(reference_window=[-2.0, 6.0]), "reference_window -2 to 6 s must lie between injection"),
        (change(reference_window=[3.0, 45.0]), "reference_window 3 to 45 s must lie between injection"),
        (change(reference_window=[6.0, 0.0]), "reference_window: must be two rising times"),
        (change(reference_window="0-6"), "reference_window: must be two rising times"),
        (change(emittance=1.2), r"attribute emittance: 1.2 is not in \(0, 1\]"),
        (change(emittance=0.0), r"attribute emittance: 0 is not in \(0, 1\]"),
        (change(injection_time="now"), "attribute injection_time: must be one number; got 'now'"),
        (change(spectrometer_fwhm=0.75e-6 * 2), "attribute spectrometer_fwhm: 1.5e-06 m is not in"),
        (change(origin="guessed"), "attribute origin: 'guessed', must be one of measured"),
    ],
)
def test_each_fault_is_named(spoil, message):
    with pytest.raises(ValueError, match=message):
        inputs.require(spoil(sound()), "pyrometer")


def test_missing_attribute_is_named():
    for name in ("plasma_off_time", "spectrometer_integration_time"):
        test = sound()
        del test.attrs[name]
        (fault,) = inputs.faults(test)
        assert fault.startswith(f"attribute {name}: missing")


def test_all_faults_come_at_once():
    test = unit("time", "min")(change(origin="guessed", emittance=2.0)(sound())).drop_vars("signal_wide")
    assert len(inputs.faults(test)) == 4


def test_empty_test_says_that_it_is_empty():
    assert inputs.faults(xr.Dataset())[0].startswith("no signals of a pyrometer")
