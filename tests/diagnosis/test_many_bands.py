"""A radiometer of 25 narrow bands behind the gas that comes with the package."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from plasmapyro import shipped
from plasmapyro.diagnosis import command
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.fit.inference import Fitter
from plasmapyro.diagnosis.fit.radiometer import covered
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.fit.whole import fit_test
from plasmapyro.diagnosis.select.screen import screen
from plasmapyro.instrument.bands import radiometer_calibration
from plasmapyro.radiation.planck import blackbody_radiance

CENTRES, HALF = np.linspace(710e-9, 1180e-9, 25), 5e-9
NAMES = [f"c{place + 1}" for place in range(CENTRES.size)]
OFF, EMITTANCE = 30.0, 0.8
FACTS = {"instrument": "many", "calibration": "absolute", "signal_uncertainty": 0.003, "origin": "synthetic"}


def light(kelvin):
    return 2 * HALF * blackbody_radiance(CENTRES, np.asarray(kelvin, dtype=float)[:, None])


@pytest.fixture(scope="module")
def base():
    """The base fit of a test whose surface stays cold for seconds and then heats, as a logistic."""
    axis = np.arange(700e-9, 1190e-9, 0.25e-9)
    curves = (np.abs(axis - CENTRES[:, None]) < HALF).astype(float)
    response = xr.Dataset(
        {"responsivity": (("band", "wavelength"), curves)},
        {"wavelength": axis, "band": NAMES},
        FACTS | {"instrument_range": (900.0, 2600.0)},
    )
    source = np.arange(1100.0, 2001.0, 150.0)
    points = {"source_temperature": source} | dict(zip(NAMES, light(source).T, strict=True))
    calibration = radiometer_calibration(response, points, source_temperature_uncertainty=1.0)
    gases = shipped.by_condition()
    one, random = gases["80kW"], np.random.default_rng(5)
    gas = 2 * HALF * np.interp(CENTRES, one.wavelength_slit.values, one.gas_radiance_slit.values)
    time = np.arange(-5.0, 40.0, 0.5)
    kelvin = 350 + 1200 / (1 + np.exp(-(time - 13.3) / 1.6))
    signal = EMITTANCE * light(kelvin) * (time >= 0)[:, None] + gas * (time < OFF)[:, None]
    signal *= random.normal(1, 0.003, signal.shape)
    test = xr.Dataset(
        {"radiometer_signal": (("radiometer_time", "band"), signal, {"units": "1"})},
        {"radiometer_time": ("radiometer_time", time, {"units": "s"}), "band": NAMES},
        {
            "origin": "synthetic",
            "condition": "80kW",
            "injection_time": 0.0,
            "plasma_off_time": OFF,
            "reference_window": [0.0, 4.0],
            "emittance": EMITTANCE,
            "emittance_uncertainty": 0.08,
            "window_transmittance_radiometer": 1.0,
            "radiometer_integration_time": 0.01,
        },
    )
    given = {"saturation_counts": 65000.0, "radiometer_calibration": calibration}
    return fit_test(test, gases, one, None, **given)


@pytest.mark.parametrize(
    "beside, nanometres, left_out",
    [(True, (1300, 1550), True), (True, (1150, 1550), False), (False, (1300, 1550), False)],
    ids=["outside", "one band within", "alone"],
)
def test_a_radiometer_outside_the_simulation_is_left_out_beside_spectra(beside, nanometres, left_out, caplog):
    """The whole diagnosis had been refused; alone it still is, by what takes the bands."""
    axis = np.arange(1100e-9, 1600e-9, 1e-9)
    near = [np.abs(axis - 1e-9 * centre) < 10e-9 for centre in nanometres]
    bands = xr.Dataset(
        {"responsivity": (("band", "wavelength"), np.array(near, dtype=float))},
        {"wavelength": axis, "band": ["a", "b"]},
        FACTS,
    )
    gases = shipped.by_condition()
    inputs = command.Inputs(gases, gases, None, None, None, "synthetic", {}, bands)
    signal = ("radiometer_time", "band"), np.ones((3, 2))
    test = xr.Dataset({"radiometer_signal": signal}, {"band": ["a", "b"]}, {"condition": "80kW"})
    if beside:
        test["counts"] = ("spectrum_time", "wavelength"), np.ones((2, 2))
    kept = command.without_unseen(test, inputs)
    assert ("radiometer_signal" not in kept) == left_out
    assert ("the radiometer is left out: a diagnosis needs a band within" in caplog.text) == left_out
    if not beside:
        with pytest.raises(ValueError, match="the radiometer has none"):
            covered(SimpleNamespace(band=("a", "b")), bands, gases["80kW"]["wavelength_slit"].values)


def test_a_surface_that_heats_late_and_fast_is_followed(base):
    """Bins of 1 s left 11 times the noise where it heats by 190 K/s, and a gain that wanders was said."""
    z = base.solution.residual[0] / (0.003 * base.model.instruments[0].value)
    z *= np.sqrt(base.model.instruments[0].number)
    assert np.nanmean(z**2, axis=1).max() < 2.5


def test_reflected_light_of_bands_is_finite_though_nothing_is_seen_beside_their_edges(base):
    """Nodes beside an edge see no gas, and of none there is no share: 0/0 had stopped every diagnosis."""
    model, state = base.model, base.solution.state
    error, seen = state.error_of_gas(0), Setting(CATALOGUE["refl"], 0.1, {"contrast": 1.0})
    assert np.any(error)
    plain, more = (
        model.evaluate(0, state.knots, state.values, settings, gas_error=error) for settings in ((), (seen,))
    )
    lit = (model.instruments[0].moment[:, 0] > 0) & (model.instruments[0].moment[:, -1] < OFF)
    assert np.isfinite(more).all() and (more[lit] > plain[lit]).all()


SHARE = 0.02


def test_light_of_one_band_in_the_others_is_told_from_what_else_lifts_the_short_waves(base):
    """One per cent of it had been a gradient over the spot, or a bent scale with emittance."""
    model, values = base.model, base.solution
    names = ("crosstalk", "grad", "eps_T", "nonlin_p", "bl")
    plain = model.evaluate(0, values.state.knots, values.state.values)
    seen = (1 - SHARE) * plain + SHARE * plain.mean(axis=1, keepdims=True)
    fitter = Fitter(model, base.fitter.noise, [seen])
    fit = fitter.fit(fitter.start(values.state.knots))
    found = screen(model, fit, {one: CATALOGUE[one] for one in names}, structures=False)
    best = int(np.argmax(found.gains()))
    assert found.candidates[best].id == "crosstalk"
    assert found.amplitudes()[best] == pytest.approx(SHARE, rel=0.25)
