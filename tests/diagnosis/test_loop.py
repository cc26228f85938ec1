"""What an extension is worth outside its fit: foretold gas, and the page that says so."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from small_laboratory import gas_components

from plasmapyro.diagnosis.command import LIMITS
from plasmapyro.diagnosis.report.loop import loop_page
from plasmapyro.diagnosis.simulation.predicted import foretold

BRIGHTER = 1.3


def simulated(axis, response, power, brightness=1.0):
    """The gas of the generator of these tests, in its bands by the trapezoidal rule."""
    light = brightness * gas_components(axis, power).sum(axis=0)
    wavelength = response.wavelength.values
    seen = np.interp(wavelength, axis, light)
    bands = [np.trapezoid(response[f"responsivity_{band}"] * seen, wavelength) for band in ("wide", "narrow")]
    return xr.Dataset(
        {"gas_radiance_slit": ("wavelength_slit", light), "band_signal": ("band", bands)},
        {"wavelength_slit": axis},
    )


@pytest.fixture(scope="module")
def pair(record, axis, response, calibration):
    """Foretold by a simulation 30 % too bright, and by the true one."""
    both = [simulated(axis, response, 80e3, factor) for factor in (BRIGHTER, 1.0)]
    tests = {"mine": (record(), *both)}
    return foretold(tests, calibration, None, limits=LIMITS, saturation_counts=65000.0)["mine"]


def test_the_true_simulation_foretells_the_gas_within_its_noise(pair):
    wrong, right = pair
    assert np.abs(right.signal).max() < 0.01 and np.abs(right.spectrum).max() < 0.01  # the surface shows
    assert wrong.signal - right.signal == pytest.approx(np.log(BRIGHTER))
    assert wrong.spectrum - right.spectrum == pytest.approx(np.log(BRIGHTER))
    assert right.kelvin < 0.2 * wrong.kelvin
    assert right.log_score.sum() - wrong.log_score.sum() == pytest.approx(
        0.5 * (np.log(BRIGHTER) / 0.1) ** 2 * right.log_score.size, rel=0.1
    )


def test_the_page_says_what_became_better_and_what_did_not(pair):
    time, frames = np.arange(0.0, 100, 0.5), np.arange(0.5, 100, 1.0)

    def corrected(error):
        bands = {
            "corrected_temperature": ("time", 1500 + error * np.sin(time)),
            "corrected_status": ("time", 0 * time),
        }
        spectra = {
            "scaled_temperature": ("spectrum_time", np.full(frames.size, 1500.0)),
            "spectrum_status": ("spectrum_time", 0 * frames),
        }
        return xr.Dataset(bands, {"time": time}), xr.Dataset(spectra, {"spectrum_time": frames})

    term = SimpleNamespace(id="winE", sentence="Deposit on window E: loss 0.05.")
    base = {
        "extended": {"terms": [{"id": term.id}]},
        "candidates": [vars(term)],
        "verdict": {"named": [term.id]},
        "gain": {
            "heldout_log_score": 40.0,
            "heldout_standard_error": 10.0,
            "cross_instrument": -9.0,
            "cross_condition": None,
        },
    }
    extended = {"verdict": {"sentences": ["Nothing else is needed."]}}
    page = loop_page("mine", base, extended, (corrected(5.0), corrected(5.0)), {"mine": pair})
    rows = {line.split("|")[1].strip(): line for line in page.splitlines() if line.startswith("| ")}
    assert "better" in rows["blocks of time left out, log score"]
    assert "worse" in rows["pyrometer foretold by the spectrometer, log score"]
    assert "no change" in rows["pyrometer against spectrometer, K"]
    assert "better" in rows["this test: read with the simulated gas, K"]
    assert term.sentence in page and "Nothing else is needed." in page
    nothing = base | {"extended": None, "gain": None, "verdict": {"named": []}}
    assert "Nothing was named" in loop_page("mine", nothing, extended, (corrected(5.0),) * 2, {})
