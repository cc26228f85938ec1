"""What an extension is worth outside its fit: foretold gas, and the page that says so."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from small_laboratory import gas_components

from plasmapyro.claims.beside import beside
from plasmapyro.diagnosis.command import LIMITS
from plasmapyro.diagnosis.effects.condition import OF_CONDITION
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.diagnosis.fit.terms import Term
from plasmapyro.diagnosis.report.loop import loop_page
from plasmapyro.diagnosis.simulation.predicted import foretold
from plasmapyro.instrument import stage

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
    power = Term(Setting(OF_CONDITION["power"], -0.07), {"amplitude": 0.014})
    errors = np.stack([np.full((3, 20), 9.0), np.full((3, 20), 1.5), np.zeros((3, 20))])
    compared = SimpleNamespace(claims=(("It is hot. [K]", [1400.0, 1431.0, 1432.0]),), errors=errors)
    found = {"mine": pair, "other": pair}
    page = loop_page(
        "mine", base, extended, (corrected(5.0), corrected(4.98)), found, [power], {"other": compared}
    )
    rows = {line.split("|")[1].strip(): line for line in page.splitlines() if line.startswith("| ")}
    assert "better" in rows["log score"]
    assert "worse" in rows["pyrometer foretold by the spectrometer, log score"]
    assert "no change" in rows["pyrometer less spectrometer, K"]
    assert "better" in rows["read with the simulated gas, K"]
    assert rows["error map, K"].split("|")[2:4] == [" 9.00 ", " 1.50 "] and "better" in rows["error map, K"]
    assert rows["It is hot. [K]"].endswith("| 1400 | 1431 | 1432 |")
    assert term.sentence in page and "Nothing else is needed." in page
    assert "relative change of the power -7.0% ± 1.4%; the flow is solved again" in page
    wrong, right = (cell.strip() for cell in rows["read with the simulated gas, K"].split("|")[2:4])
    assert "which no fit saw: read with the simulated" in page
    assert f"errs by {right} K (rms), by {wrong} K with the base simulation" in page
    assert "1 became worse: one instrument against the other: pyrometer foretold" in page
    nothing = base | {"extended": None, "gain": None, "verdict": {"named": []}}
    assert "Nothing was named" in loop_page("mine", nothing, extended, (corrected(5.0),) * 2, {})


def test_claims_and_errors_of_equal_gases_are_equal_and_brighter_gas_disturbs_hotter_surfaces(response):
    curve = stage.ratio_curve(
        response,
        sensitivity_ratio=0.315,
        calibration_temperature=np.arange(400.0, 6000.0, 20.0),
        instrument_range=[973.0, 2073.0],
    )
    gas = np.array([30.0, 20.0])
    analysis = {
        "visibility_temperature_k": [500, 2000, 10],
        "visibility_level": [0.99],
        "apparent_temperature_k": [500, 2500, 10],
        "error_temperature_k": [500, 2500, 20],
        "error_emittance": [0.1, 1.0, 4],
        "error_level": 0.01,
        "transient": {
            "conditions": ["80kW"],
            "time_s": [-5, 100, 0.5],
            "initial_temperature_k": 350,
            "gain_k": 1250,
            "natural_frequency_per_s": 0.1,
        },
    }
    signals = {"base": 3 * gas, "extended": gas, "measured": gas}
    found = beside(signals, response, curve, emittance=0.85, analysis=analysis)
    brighter, *same = found.errors
    assert np.array_equal(*same, equal_nan=True) and np.nanmean(np.abs(brighter - same[0])) > 1
    claims = dict(found.claims)
    assert all(values[1] == values[2] or np.isnan(values[1:]).all() for values in claims.values())
    (limit,) = (values for said, values in claims.items() if "deviates considerably" in said)
    assert limit[0] > limit[1] + 10
    assert not [said for said in claims if "base" in said]
