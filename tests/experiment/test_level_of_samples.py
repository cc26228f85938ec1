"""A furnace before a pyrometer whose shutter opens: dark samples, a zero left in, noise without light."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro import contracts
from plasmapyro.commands.calibrate import RESPONSE
from plasmapyro.experiment.stage import correct_pyrometer
from plasmapyro.instrument.pyrometer import blackbody_signals
from plasmapyro.instrument.stage import band_response
from plasmapyro.record import level, status
from plasmapyro.record.noise import floor_of

C2 = 6.62607015e-34 * 299792458.0 / 1.380649e-23  # [m K]
AXIS = np.arange(760e-9, 1100e-9, 1e-9)
CURVES = np.stack([np.exp(-(((AXIS - middle) / 5e-8) ** 2)) for middle in (9.2e-7, 1.02e-6)])
GAIN, FLOOR, EMITTANCE = 5e-9, 1e-9, 0.85  # [A m2 sr W-1], [A], [1]
TIME = np.arange(0.0, 60.0, 0.2)
OPEN = (TIME > 10) & (TIME < 50)
SETTINGS = {
    "signal_uncertainty": 0.01,
    "gas_variation": 0.03,
    "detection_level": 2.0,
    "least_surface_share": 0.5,
    "draws": 300,
    "seed": 4,
}


def light(kelvin):
    """Signals (2, t) [A] of black bodies."""
    body = 1.191042972e-16 / AXIS**5 / np.expm1(C2 / (AXIS * np.reshape(kelvin, (-1, 1))))
    return GAIN * np.trapezoid(CURVES[:, None] * body, AXIS)


def calibration():
    kelvin, fit_range = np.linspace(1000.0, 1800.0, 30), np.array([1000.0, 1800.0])
    place = (2 * kelvin - fit_range.sum()) / np.diff(fit_range)
    wide, narrow = light(kelvin)
    return xr.Dataset(
        {
            "fit_coefficient": ("fit_power", np.polynomial.polynomial.polyfit(place, wide / narrow, 2)),
            "fit_covariance": (("fit_power", "other_fit_power"), 1e-7 * np.eye(3)),
            "fit_range": ("bound", fit_range),
            "instrument_range": ("bound", [900.0, 2000.0]),
            "absolute_sensitivity": ("band", [GAIN, GAIN]),
        },
        {"band": ["wide", "narrow"]},
    )


def response():
    names = ("responsivity_wide", "responsivity_narrow")
    rows = {name: ("wavelength", row) for name, row in zip(names, CURVES, strict=True)}
    return xr.Dataset(rows, {"wavelength": AXIS})


def corrected(kelvin, zero=(0.0, 0.0), share=1.0, known=True):
    """Correction of a furnace at a temperature [K] behind a shutter, with a zero (2,) [A] left in."""
    both = share * EMITTANCE * light(kelvin) * OPEN + np.reshape(zero, (2, 1))
    both = both + FLOOR * np.random.default_rng(3).standard_normal(both.shape)
    attributes = {
        "condition": "none",
        "injection_time": 0.0,
        "emittance": EMITTANCE,
        "emittance_uncertainty": 0.03,
        "window_transmittance_pyrometer": 0.95,
        "pyrometer_integration_time": 0.01,
        "origin": "synthetic",
    }
    rows = {f"signal_{name}": ("time", row) for name, row in zip(("wide", "narrow"), both, strict=True)}
    test = xr.Dataset(rows, {"time": TIME}, attributes)
    test = contracts.label(test, "test")
    return correct_pyrometer(test, calibration(), response() if known else None, **SETTINGS)


def with_value(found):
    return np.isfinite(found.corrected_temperature.values)


@pytest.mark.parametrize("zero", [0.0, 100.0])
def test_behind_a_shutter_nothing_is_valid(zero):
    """A zero whose ratio is that of 1300 K read 1300 K: 16 of 25 invented furnaces held such samples."""
    zero = zero * FLOOR * light([1300.0])[:, 0] / light([1300.0])[1, 0]
    found, blind = (corrected(1700.0, zero, known=known) for known in (True, False))
    assert with_value(found)[OPEN].all() and not with_value(found)[~OPEN].any()
    np.testing.assert_allclose(found.corrected_temperature.values[OPEN], 1700.0, atol=25.0)
    assert with_value(blind)[~OPEN].any() == any(zero)  # without the responses a level tells nothing
    assert (found.corrected_status.values[~OPEN] == status.CONTRADICTED).any() == any(zero)


def test_a_level_that_is_another_one_in_all_samples_is_left_to_the_rule():
    assert with_value(corrected(1500.0, share=0.3))[OPEN].all()


def test_noise_without_light_widens_faint_samples_and_no_others():
    """At 1050 K the wide band gives 25 times its noise: 4 % beside 1 % of each signal and of the slope."""
    for kelvin in (1050.0, 1600.0):
        found = corrected(kelvin)
        signal = EMITTANCE * light([kelvin])[:, 0]
        of_ratio = np.sqrt(3 * 0.01**2 + np.sum((FLOOR / signal) ** 2))
        slope = np.diff(np.log(np.divide(*light([kelvin - 1, kelvin + 1]))))[0] / 2
        own = found.corrected_temperature_uncertainty.values[OPEN]
        assert np.nanmedian(own) == pytest.approx(of_ratio / slope, rel=0.15)
    assert (FLOOR / light([1050.0]) > 0.02).any() and (FLOOR / light([1600.0]) < 1e-3).all()


def test_the_noise_without_light_is_that_of_dark_samples():
    dark = FLOOR * np.array([[1.0], [4.0]]) * np.random.default_rng(5).standard_normal((2, 400))
    np.testing.assert_allclose(floor_of(dark), [FLOOR, 4 * FLOOR], rtol=0.25)
    assert not floor_of(dark[:, :20]).any() and not floor_of(np.ones((2, 400))).any()


def test_a_long_record_takes_its_black_bodies_from_a_table(monkeypatch):
    """As many integrals over wavelengths as nodes, whatever the length; the table is as good as they are."""
    response, kelvin = band_response(**RESPONSE), np.linspace(700.0, 2500.0, 100_003)
    asked = []

    def counted(temperature, of):
        asked.append(np.size(temperature))
        return blackbody_signals(temperature, of)

    monkeypatch.setattr(level, "blackbody_signals", counted)
    np.testing.assert_allclose(
        level._black(kelvin, response)[:, ::1000], blackbody_signals(kelvin[::1000], response), rtol=1e-8
    )
    assert asked == [level.NODES]


def test_a_long_record_of_one_temperature_has_a_black_body():
    response, kelvin = band_response(**RESPONSE), np.full(600, 1500.0)
    np.testing.assert_allclose(
        level._black(kelvin, response), blackbody_signals(kelvin, response), rtol=1e-12
    )
