"""Lets the tests import the scoreboard and, through it, the twin; an invented gas for both."""

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from two_bands import RESPONSE

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))


@pytest.fixture(scope="session")
def response():
    return RESPONSE


def plume(power):
    """Lines of O I and N I that grow steeply with the power [kW], on a hump that grows slowly."""
    wavelength = np.linspace(0.70e-6, 1.20e-6, 60001)
    radiance = (power / 80) * 2.5e6 * np.exp(-(((wavelength - 1.05e-6) / 0.15e-6) ** 2))
    for centre, peak in ((746.8, 8e9), (777.4, 4e10), (844.6, 4e10), (868.0, 2e10), (939.0, 5e9)):
        radiance += (power / 80) ** 5 * peak / (1 + ((wavelength - centre * 1e-9) / 1e-11) ** 2)
    slit = np.linspace(0.745e-6, 1.035e-6, 3000)
    seen = np.interp(slit, wavelength, np.convolve(radiance, np.ones(91) / 91, "same"))  # 0.75 nm wide
    return xr.Dataset(
        {"gas_radiance": ("wavelength", radiance), "gas_radiance_slit": ("wavelength_slit", seen)},
        {"wavelength": wavelength, "wavelength_slit": slit},
        {"slit_fwhm": 0.75e-9},
    )


@pytest.fixture(scope="session")
def radiations():
    return {power: plume(power) for power in (50.0, 130.0)}
