"""A small model of both instruments, built from the package's own response and an invented gas."""

import numpy as np
import pytest
import xarray as xr
from two_bands import RESPONSE

from plasmapyro.forward.stage import forward_model


@pytest.fixture(scope="session")
def response():
    return RESPONSE


def gas(level):
    """Lines of 20 pm at the places of N I and O I on a smooth hump; lines grow faster than the hump."""
    wavelength = np.linspace(0.70e-6, 1.20e-6, 60001)
    radiance = level * 2e6 * np.exp(-(((wavelength - 1.05e-6) / 0.15e-6) ** 2))
    for centre, peak in ((746.8, 8e9), (777.4, 4e10), (844.6, 4e10), (868.0, 2e10), (939.0, 5e9)):
        radiance += level**3 * peak / (1 + ((wavelength - centre * 1e-9) / 1e-11) ** 2)
    slit = np.linspace(0.745e-6, 1.035e-6, 3000)
    return xr.Dataset(
        {
            "gas_radiance": ("wavelength", radiance),
            "gas_radiance_slit": ("wavelength_slit", np.interp(slit, wavelength, radiance)),
        },
        {"wavelength": wavelength, "wavelength_slit": slit},
        {"slit_fwhm": 0.75e-9},
    )


@pytest.fixture(scope="session")
def gases():
    return {70e3: gas(0.7), 80e3: gas(1.0)}


@pytest.fixture(scope="session")
def calibration():
    return xr.Dataset({"absolute_sensitivity": ("band", [3.15e-9, 1e-8])}, {"band": ["wide", "narrow"]})


@pytest.fixture(scope="session")
def model(response, calibration, gases):
    return forward_model(response, calibration, gases, np.linspace(750e-9, 1030e-9, 2068), 0.75e-9)
