"""Instruments of different bands in one estimate, each with a clock and a window of its own."""

import inspect
import re
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from plasmapyro.commands.joint import SETTINGS
from plasmapyro.estimate.stage import estimate
from plasmapyro.instrument.bands import radiometer_calibration
from plasmapyro.instrument.calibration import EXTRAPOLATED, VALID

sys.path.insert(0, str(Path(__file__).parents[1] / "commands"))
import laboratory

H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23
BANDS = {"b1": (795, 805), "b2": (895, 905), "b3": (995, 1005)}
KELVIN = np.arange(1100.0, 1701.0, 100.0)


def light(edges, kelvin):
    """Radiance of a band by Gauss and Legendre's rule."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    low, high = np.array(edges) * 1e-9
    at = (low + high) / 2 + (high - low) / 2 * nodes
    body = 2 * H * C**2 / at**5 / np.expm1(H * C / (at * K * np.asarray(kelvin)[..., None]))
    return np.sum(weights * body, axis=-1) * (high - low) / 2


@pytest.fixture(scope="module")
def calibration():
    wavelength = np.arange(790e-9, 1010e-9, 0.1e-9)
    curves = [(wavelength > low * 1e-9) & (wavelength < high * 1e-9) for low, high in BANDS.values()]
    facts = {"instrument": "three", "calibration": "absolute", "signal_uncertainty": 0.003}
    response = xr.Dataset(
        {"responsivity": (("band", "wavelength"), np.array(curves, dtype=float))},
        {"wavelength": wavelength, "band": list(BANDS)},
        facts | {"origin": "synthetic", "instrument_range": (900.0, 2600.0)},
    )
    points = {"source_temperature": KELVIN} | {name: light(edge, KELVIN) for name, edge in BANDS.items()}
    return radiometer_calibration(response, points, source_temperature_uncertainty=2.0)


def with_radiometer(test, seed=4):
    """The test of the laboratory with three bands besides, at odd times and behind another window."""
    time = np.arange(-2.1, 58.0, 0.37)
    rng = np.random.default_rng(seed)
    signal = [
        0.5
        * (
            laboratory.EMITTANCE * light(edges, laboratory.temperature(time)) * (time >= 0)
            + light(edges, 1150.0) * (time <= 50)
        )
        * rng.normal(1, 0.003, time.size)
        for edges in BANDS.values()
    ]
    test["radiometer_signal"] = ("radiometer_time", "band"), np.array(signal).T, {"units": "1"}
    own = {"window_transmittance_radiometer": 0.5, "radiometer_integration_time": 0.01}
    return test.assign_coords(radiometer_time=time, band=list(BANDS)).assign_attrs(own)


def joint(test, calibration, lab=(None, None), **more):
    for name, unit in (("time", "s"), ("radiometer_time", "s")):
        if name in test:
            test[name].attrs["units"] = unit
    for name in ("signal_wide", "signal_narrow"):
        if name in test:
            test[name].attrs["units"] = "A"
    return estimate(
        test,
        *lab,
        None,
        **SETTINGS,
        saturation_counts=6e4,
        noise_block=50,
        radiometer_calibration=calibration,
        **more,
    )


def judged(found, least):
    """Whether hot temperatures are given, and lie inside their 95 % intervals as often as `least`."""
    time = found.time.values
    hot = (time > 20) & (time < 57) & (np.abs(time - 50) > 1)
    good = np.isin(found.estimate_status.values, (VALID, EXTRAPOLATED))
    assert good[hot].mean() > 0.98
    low, high = found.surface_temperature_interval.values
    truth = laboratory.temperature(time)
    inside = (low < truth) & (truth < high)
    assert inside[hot & good].mean() > least
    return np.sqrt(np.mean((found.surface_temperature.values - truth)[hot & good] ** 2))


def test_bands_beside_a_pyrometer_join_it(tmp_path, calibration):
    import plasmapyro.cli as cli
    from plasmapyro import io

    folder = laboratory.calibration_folder(tmp_path / "calibration")
    assert cli.main(["calibrate", str(folder), "--out", str(tmp_path / "lab")]) == 0
    lab = [io.read(tmp_path / f"lab/{name}.nc", name) for name in ("calibration", "response")]
    test = laboratory.made(spectrometer=False).assign_attrs(condition="90kW")
    both = joint(with_radiometer(test), calibration, lab)
    assert both.attrs["instruments"] == "pyrometer radiometer"
    assert judged(both, 0.95) < 10
    assert both.sizes["time"] == test.sizes["time"]
    # What the bands say of the emissivity bounds the gains of the pyrometer, which are 1 here.
    assert np.abs(both.gain_correction).max() < 0.01


@pytest.mark.parametrize("bands", [["b1", "b2", "b3"], ["b2", "b3"], ["b3"]], ids=["three", "two", "one"])
def test_any_number_of_bands_makes_a_joint_estimate(calibration, bands):
    test = with_radiometer(xr.Dataset(attrs=laboratory.ATTRIBUTES | {"condition": "90kW"}))
    found = joint(test.sel(band=bands), calibration)
    assert list(found.band.values) == bands
    judged(found, 0.9)
    gas = [0.5 * light(BANDS[band], 1150.0) for band in bands]
    np.testing.assert_allclose(found.radiometer_gas, gas, rtol=0.02)


def test_a_level_that_is_not_known_is_left_to_the_ratios(calibration):
    test = with_radiometer(xr.Dataset(attrs=laboratory.ATTRIBUTES | {"condition": "90kW"}))
    test["radiometer_signal"] = 30.0 * test.radiometer_signal
    test.radiometer_signal.attrs["units"] = "1"
    stated = joint(test.copy(), calibration)
    assert "the data pull" in stated.attrs["contradictions"]
    assert not np.isfinite(stated.surface_temperature).any()
    relative = calibration.assign_attrs(calibration="relative")
    judged(joint(test.copy(), relative, emissivity_shape=0.02), 0.9)


def test_the_rule_gives_its_inputs_in_the_order_in_which_the_estimate_takes_them(pytestconfig):
    text = (pytestconfig.rootpath / "workflow/rules/experiment.smk").read_text()
    (block,) = re.findall(r"rule joint_estimate:\n    input:\n(.*?)    output:", text, re.DOTALL)
    given = re.findall(r"^        (\w+)=", block, re.MULTILINE)
    assert given == list(inspect.signature(estimate).parameters)[: len(given)]
