"""The joint estimate where the light changes fast, or spans decades: right, or no temperature at all.

Histories of the example's sample, heated and cooled faster, behind its gas or a thousandth of it. The
generator knows the instruments without error, so a stated uncertainty covers the rest with room.
"""

import laboratory as lab
import numpy as np
import pytest
import xarray as xr

from plasmapyro import cli, contracts, io
from plasmapyro.commands.joint import by_joint_inference
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import status

LARGEST_PULL = 4.0  # standard uncertainties
SPAN, NODES = 0.5, np.linspace(-0.5, 0.5, 41)  # [s] of an exposure, and where the generator looks at it


@pytest.fixture(scope="module")
def instrument(tmp_path_factory):
    place = tmp_path_factory.mktemp("laboratory")
    lab.calibration_folder(place / "calibration")
    assert cli.main(["calibrate", str(place / "calibration"), "--out", str(place / "instrument")]) == 0
    return place / "instrument"


def history(rise, cooling):
    """Temperature [K]: `rise` [s] towards 1610 K, then `cooling` [K/s] by radiation at first."""

    def temperature(moment):
        hot = 350 + 1260 * (1 - np.exp(-np.clip(moment, 0, lab.OFF) / rise)) ** 2
        return (hot**-3.0 + 3 * cooling / 1610.0**4 * np.maximum(moment - lab.OFF, 0)) ** (-1 / 3)

    return temperature


def made(temperature, gas):
    """A test behind `gas` times that of the example, spectra of 0.1 % and counted noise."""
    random, time = np.random.default_rng(1), np.round(np.arange(-4.0, 60.0, 0.25), 9)
    bands, spectrum = lab.gas()
    signal = lab.EMITTANCE * lab.signals(temperature(time)) * (time >= 0)
    signal = signal + gas * bands[:, None] * lab.brightness(time) * (time <= lab.OFF)
    signal = signal * (1 + lab.NOISE * random.standard_normal(signal.shape))
    signal += lab.FLOOR * random.standard_normal(signal.shape)
    moments = np.arange(1.0, 60.0, 2.0)
    around = temperature(moments[:, None] + SPAN * NODES)
    light = lab.EMITTANCE * blackbody_radiance(lab.WAVELENGTH, around[..., None]).mean(axis=1)
    light += gas * spectrum * (lab.brightness(moments, SPAN) * (moments < lab.OFF))[:, None]
    light *= 1 + 1e-3 * random.standard_normal(light.shape)
    counts = [lab.raw(row, SPAN, seed) for seed, row in enumerate(light, 10)]
    test = xr.Dataset(
        {
            "signal_wide": ("time", signal[0]),
            "signal_narrow": ("time", signal[1]),
            "counts": (("spectrum_time", "wavelength"), np.array(counts)),
            "background_counts": ("wavelength", lab.raw(0 * lab.WAVELENGTH, SPAN, 9)),
        },
        {"time": time, "spectrum_time": moments, "wavelength": lab.WAVELENGTH},
        lab.ATTRIBUTES | {"condition": "90kW"},
    )
    return contracts.label(test, "test"), temperature(time)


@pytest.mark.parametrize(
    ("rise", "cooling", "gas"),
    [(3.0, 25.0, 1e-3), (9.0, 260.0, 1.0), (3.0, 260.0, 1e-2), (9.0, 25.0, 30.0)],
    ids=["steep", "quenched", "both", "bright gas"],
)
def test_no_temperature_is_valid_and_wrong(instrument, rise, cooling, gas):
    test, truth = made(history(rise, cooling), gas)
    names = ("calibration", "spectrometer_calibration")
    calibrations = {name: io.read(instrument / f"{name}.nc", name) for name in names}
    options = cli.parser(["correct"]).parse_args(["correct", "", "--instrument", str(instrument)])
    found = by_joint_inference(test, calibrations, options)
    assert found.attrs["contradictions"] == ""  # neither lamp nor emittance is at fault
    known = np.isin(found.estimate_status, status.WITH_VALUE)
    assert known.mean() > 0.75
    pull = (found.surface_temperature - truth) / found.surface_temperature_uncertainty
    assert float(np.abs(pull[known]).max()) < LARGEST_PULL
    steady = (found.time > 30) & (found.time < 49)
    assert float(np.abs(found.surface_temperature - truth)[steady].max()) < 3.0  # [K], one stated uncertainty
