"""Every unit that a laboratory may write, with its size in SI as definitions and prefixes give it."""

from types import SimpleNamespace

import numpy as np
import pytest

from plasmapyro.readers import columns, units

RTOL = 1e-15  # powers of ten and one product each
SIZES = {  # variable -> unit as written -> value of 1 in SI, written out
    "time": {"s": 1, "sec": 1, "ms": 0.001, "us": 0.000001, "\u00b5s": 0.000001, "\u03bcs": 0.000001}
    | {"ns": 0.000000001, "min": 60, "h": 3600, "d": 86400},
    "signal_wide": {"A": 1, "mA": 0.001, "uA": 0.000001, "nA": 0.000000001, "pA": 0.000000000001},
    "electric_power": {"W": 1, "kW": 1000, "MW": 1000000},
    # 760 Torr are one standard atmosphere, 101325 Pa.
    "chamber_pressure": {"Pa": 1, "hPa": 100, "mbar": 100, "kPa": 1000, "bar": 100000}
    | {"Torr": 133.32236842105263},
    "mass_flow_rate": {"kg s-1": 1, "kg/s": 1, "kg s^-1": 1, "g s-1": 0.001, "g/s": 0.001, "mg/s": 0.000001}
    | {"g/min": 1.6666666666666667e-05},
    "source_temperature": {"K": 1, "degC": 1, "C": 1, "\u00b0C": 1},
    "wavelength": {"m": 1, "um": 0.000001, "\u00b5m": 0.000001, "nm": 0.000000001, "Angstrom": 0.0000000001},
    "counts": {"count": 1, "counts": 1},
    # A signal of a radiometer stays in the unit of its calibration; a share may come in per cent.
    "radiometer_signal": dict.fromkeys(("1", "V", "mV", "uV", "count", "counts"), 1)
    | dict.fromkeys(("A", "mA", "uA", "nA", "pA", "W"), 1)
    | {"%": 0.01},
    "spectral_radiance": {
        "W m-2 sr-1 m-1": 1,
        "W/m2/sr/m": 1,
        "W m-2 sr-1 nm-1": 1e9,
        "W/m2/sr/nm": 1e9,
        "W/m\u00b2/sr/nm": 1e9,
        "W m-2 sr-1 um-1": 1e6,
        "W/m2/sr/um": 1e6,
        "mW/m2/sr/nm": 1e6,
        "W/cm2/sr/nm": 1e13,  # 1e4 cm2 in a m2, 1e9 nm in a m
        "W/cm2/sr/um": 1e10,
        "uW/cm2/sr/nm": 1e7,
        "mW/m2/sr/um": 1e3,
        "uW/m2/sr/nm": 1e3,
        "mW/cm2/sr/nm": 1e10,
        "mW/cm2/sr/um": 1e7,
        "uW/cm2/sr/um": 1e4,
        "W/m2/um/sr": 1e6,  # in another order, or with other signs
        "mW/(m^2*sr*nm)": 1e6,
        "W/cm2-sr-um": 1e10,
        "W\u00b7m\u207b\u00b2\u00b7sr\u207b\u00b9\u00b7nm\u207b\u00b9": 1e9,
    },
}
CASES = [(name, unit, size) for name, sizes in SIZES.items() for unit, size in sizes.items()]


@pytest.mark.parametrize(("name", "unit", "size"), CASES)
def test_one_of_each_unit_is_this_much_in_si(name, unit, size):
    np.testing.assert_allclose(units.factor(unit, name), size, rtol=RTOL)
    assert units.offset(unit) == (273.15 if unit in ("degC", "C", "\u00b0C") else 0.0)


@pytest.mark.parametrize("unit", ["W/m2/nm", "mW m-2 nm-1", "W/m2/sr", "W/sr/nm", "W/m2/m2/sr"])
def test_an_irradiance_is_no_radiance(unit):
    assert units.factor(unit, "spectral_radiance") is None
    assert "reflectance of the diffuser" in units.known("spectral_radiance")


def test_a_scale_acts_before_the_zero_of_celsius():
    """Tenths of a degree Celsius: 12000 are 1200 degC, 1473.15 K."""
    stated = SimpleNamespace(name="source_temperature", header="T", unit="degC", scale=0.1)
    assert columns.to_si("points.csv", stated, np.array([12000.0]), None) == pytest.approx(1473.15, rel=RTOL)


def test_no_unit_is_left_out_here():
    written = {units.normalised(unit) for sizes in SIZES.values() for unit in sizes}
    assert written == {units.normalised(unit) for sizes in units.TO_SI.values() for unit in sizes}


def test_a_unit_of_another_quantity_has_no_factor():
    for name, sizes in SIZES.items():
        for other, foreign in SIZES.items():
            shared = set(sizes) & set(foreign)
            assert name == other or all(units.factor(u, name) is None for u in set(foreign) - shared)
