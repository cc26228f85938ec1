"""What the gas does to instruments of one, two and five bands."""

import numpy as np
import pytest
import xarray as xr

from plasmapyro.analysis import stage
from plasmapyro.instrument.stage import band_response, pyrometer_calibration, ratio_curve
from plasmapyro.readers.instrument import read_instrument

SILICON = {
    "silicon_table": "silicon_green_2008",
    "top_thickness": 200e-6,
    "bottom_thickness": 400e-6,
    "short_wavelength_edge": 750e-9,
    "edge_sigma": 5e-9,
    "long_wavelength_limit": 1150e-9,
    "wavelength_step": 2e-9,
}
CURVE = {
    "sensitivity_ratio": 0.315,
    "calibration_temperature": np.arange(300.0, 6001.0, 10.0),
    "instrument_range": (973.0, 2073.0),
}
KELVIN, EMITTANCE = np.arange(1000.0, 2001.0, 100.0), np.array([0.3, 0.6, 1.0])


def gas_of(signals, names):
    """Two conditions with next to no gas and with much, as the stage gathers them from radiation files."""
    files = {
        name: xr.Dataset(
            {"band_signal": ("band", scale * np.asarray(signals))},
            {"band": np.array(names, dtype=object)},
            {"numerical_power": 1e4 * (1 + scale)},
        )
        for name, scale in (("none", 1e-9), ("much", 1.0))
    }
    return stage.gather(files, emittance=[0.8, 0.8])


def maps(gas, response, curve):
    keys = {"object_temperature": KELVIN, "emittance": EMITTANCE, "error_level": 0.01}
    return stage.error_map(gas, response, curve, **keys).relative_error


SAME = 1e-12  # relative: rounding of a ratio of signals, some ten times in 1/T, and of its interpolation


@pytest.mark.parametrize("order", [("wide", "narrow"), ("narrow", "wide")])
def test_two_bands_of_any_instrument_are_the_two_colour_pyrometer(order):
    """The two-colour pyrometer described as one of any bands: signals, visibility, readings, errors."""
    response = band_response(**SILICON)
    bands = xr.Dataset(
        {"responsivity": (("band", "wavelength"), [response[f"responsivity_{band}"] for band in order])},
        {"wavelength": response.wavelength, "band": list(order)},
        {"instrument_range": (973.0, 2073.0)},
    )
    signals = {"wide": 30.0, "narrow": 3.0}
    gases = gas_of([30.0, 3.0], list(signals)), gas_of([signals[one] for one in order], order)
    curves = [ratio_curve(one, **CURVE) for one in (response, bands)]
    keys = {"object_temperature": KELVIN, "emittance": EMITTANCE, "error_level": 0.01}
    heating = {"time": np.arange(0.0, 40.0, 1.0), "initial_temperature": 300.0, "gain": 1500.0}
    heating |= {"conditions": ["none", "much"], "natural_frequency": 0.2}
    shown = {"object_temperature": KELVIN, "visibility_level": [0.5, 0.9]}
    of_both = [
        (
            stage.visibility(gas, one, **shown),
            stage.apparent_temperature(gas, one, curve, object_temperature=KELVIN),
            stage.error_map(gas, one, curve, **keys),
            stage.transient(gas, one, curve, **heating),
        )
        for gas, one, curve in zip(gases, (response, bands), curves, strict=True)
    ]
    for own, found in zip(*of_both, strict=True):
        for name, values in own.data_vars.items():
            if values.dtype.kind == "f":
                other = found[name]
                other = other.sel(band=values.band) if "band" in values.dims else other
                np.testing.assert_allclose(other, values, rtol=SAME, atol=SAME, err_msg=name)
    assert float(of_both[0][2].relative_error.max()) > 0.02


@pytest.mark.parametrize("name", ["one_colour", "five_band"])
def test_readings_of_other_instruments_are_right_without_gas(pytestconfig, name):
    response = read_instrument(pytestconfig.rootpath / f"config/instruments/{name}.yaml")
    names = list(response.band.values)
    gas = gas_of(np.full(len(names), 5.0), names)
    error = maps(gas, response, ratio_curve(response, **CURVE))
    clean = error.sel(condition="none")
    assert np.abs(clean.sel(emittance=1.0)).max() < 1e-5
    if name == "one_colour":  # 0.6 of the light at 1000 K and 1 um: dT/T = lambda T / c2 ln(0.6) = -3.4 %
        assert float(clean.sel(emittance=0.6, object_temperature=1000.0)) == pytest.approx(-0.034, abs=0.004)
    else:
        assert np.abs(clean).max() < 1e-5  # a grey surface is what it assumes
    assert (error.sel(condition="much", object_temperature=1000.0) > 0.01).any()
    seen = stage.visibility(gas, response, object_temperature=KELVIN, visibility_level=[0.9])
    assert seen.sizes["band"] == len(names)


def test_what_needs_two_bands_says_so(pytestconfig):
    response = read_instrument(pytestconfig.rootpath / "config/instruments/five_band.yaml")
    with pytest.raises(ValueError, match="two-colour pyrometer; got b1, b2, b3, b4, b5"):
        pyrometer_calibration(
            response,
            None,
            source_temperature_uncertainty=3.0,
            signal_uncertainty=0.01,
            instrument_range=(973.0, 2073.0),
            calibration_temperature=np.arange(400.0, 4001.0, 10.0),
            draws=10,
            seed=1,
        )
