"""The temperature to take away: one rule over every state of the estimates."""

import itertools

import numpy as np
import pytest
import xarray as xr

from plasmapyro.quality import agreement
from plasmapyro.quality.rule import CONTRADICTION, rules_of
from plasmapyro.radiation.planck import blackbody_radiance
from plasmapyro.record import budget, status
from plasmapyro.record.recommended import (
    BEST_FIRST,
    CONTRADICTIONS,
    Facts,
    of_correction,
    recommended,
    series,
)

VERDICTS = ("null", "named", "one-of", "named+unknown", "unknown", "not-adequate")
TIME = np.arange(5.0)


def test_the_rules_that_speak_against_a_recommendation_are_those_between_instruments_or_bands():
    between = {one.name for one in rules_of(agreement) if one.severity == CONTRADICTION}
    itself = {"estimate_contradicted"}  # says which samples
    assert set(CONTRADICTIONS) == (between - itself) | {"two_clocks", "swapped_bands"}


@pytest.mark.parametrize(
    ("given", "best"),
    [
        (("joint", "subtraction", "spectra"), "joint"),
        (("subtraction", "spectra"), "subtraction"),
        (("spectra",), "spectra"),
        (("emissivity",), "emissivity"),
        ((), None),
    ],
)
def test_without_a_diagnosis_the_estimate_of_most_light_is_taken(given, best):
    found = recommended(Facts(given, instruments=("pyrometer", "spectrometer")))
    assert found.estimate == best
    assert found.why.endswith(".")
    assert ("beside it" in found.why) == (len(given) > 1)


def test_instruments_that_contradict_each_other_for_some_time_do_not_simply_agree():
    names = ("pyrometer", "spectrometer")
    assert "which agree;" in recommended(Facts(("joint", "spectra"), instruments=names)).why
    partly = recommended(Facts(("joint", "spectra"), instruments=names, partly=True)).why
    assert "which agree but where the status is contradicted;" in partly


def test_the_reason_why_a_better_estimate_is_missing_is_said():
    found = recommended(Facts(("subtraction",), missing={"joint": "it did not converge"}))
    assert "the joint estimate is not to be had: it did not converge" in found.why


def test_contradicting_instruments_leave_nothing_but_a_confirmed_cause():
    against = ("the instruments differ by 40 K",)
    assert recommended(Facts(BEST_FIRST, against)) == (
        None,
        "No temperature is recommended: the instruments differ by 40 K.",
    )
    assert recommended(Facts(BEST_FIRST, against, verdict="named")).estimate is None
    assert recommended(Facts(BEST_FIRST, against, verdict="named", applied=True)).estimate == "extended"


@pytest.mark.parametrize(
    ("names", "best"), [(("pyrometer",), None), (("pyrometer", "spectrometer"), "extended")]
)
def test_a_single_instrument_confirms_no_cause_of_its_own_contradiction(names, best):
    """A gain of two in a pyrometer alone was named a slope of the emittance, 90 K off."""
    found = recommended(Facts(BEST_FIRST, ("level",), verdict="named", applied=True, instruments=names))
    assert found.estimate == best


@pytest.mark.parametrize(
    ("verdict", "applied", "strained", "paper"),
    list(itertools.product(VERDICTS, (False, True), ((), ("sensitivity ratio",)), (False, True))),
)
def test_a_diagnosis_recommends_by_what_it_found(verdict, applied, strained, paper):
    given = ("extended", "base", "subtraction") if paper else ("extended", "base")
    found = recommended(Facts(given, verdict=verdict, applied=applied, strained=strained))
    if verdict == "not-adequate":
        expected = "subtraction" if paper else None
    elif applied:
        expected = "extended"
    else:
        expected = "subtraction" if strained and paper else "base"
    assert found.estimate == expected
    assert found.why.startswith("Recommended: " if expected else "No temperature")


def test_a_series_is_nan_but_for_samples_with_a_value_and_its_squares_add_up():
    state = np.array(
        [status.NOT_INJECTED, status.NO_SIGNAL, status.GAS_DOMINATED, status.VALID, status.CONTRADICTED]
    )
    rows = [budget.Input("a", "noise", np.full(5, 3.0)), budget.Input("b", "gas", np.full(5, -4.0))]
    found = series(TIME, np.full(5, 1500.0), state, rows)
    assert np.isfinite(found.recommended_temperature).values.tolist() == [False, False, True, True, False]
    np.testing.assert_allclose(found.recommended_temperature_uncertainty[2:4], 5.0, rtol=1e-12)
    np.testing.assert_allclose(found.recommended_temperature_interval[:, 3], [1490.2, 1509.8], atol=0.01)
    parts = budget.by_group(found)
    assert list(parts) == ["noise", "gas"]
    assert parts["gas"][3] == 4.0


def a_correction():
    rows = [budget.Input("signals", "noise", np.full(5, 20.0))]
    return xr.Dataset(
        {
            "corrected_temperature": ("time", np.full(5, 1500.0)),
            "corrected_status": ("time", np.full(5, status.VALID)),
            **budget.variables(rows),
        },
        {"time": TIME},
    )


def a_joint_estimate(temperature, contradictions=""):
    rows = [budget.Input("noise", "noise", np.full(5, 2.0))]
    return xr.Dataset(
        {
            "surface_temperature": ("time", temperature),
            "estimate_status": ("time", np.where(np.isnan(temperature), status.CONTRADICTED, status.VALID)),
            **budget.variables(rows),
        },
        {"time": TIME},
        {"instruments": "pyrometer spectrometer", "contradictions": contradictions},
    )


def test_one_sample_that_is_contradicted_has_no_value_and_all_of_them_leave_no_recommendation():
    some = np.where(TIME == 2, np.nan, 1490.0)
    found = of_correction([a_correction(), a_joint_estimate(some, "the spectrometer lies off at 2 s")])
    assert found.attrs["recommended"] == "joint"
    assert found.recommended_status.values.tolist() == [0, 0, status.CONTRADICTED, 0, 0]
    none = a_joint_estimate(np.full(5, np.nan), "the data pull a gain by 18 standard uncertainties")
    found = of_correction([a_correction(), none])
    assert found.attrs["recommended"] == "none"
    assert "pull a gain by 18" in found.attrs["recommended_because"]
    assert np.isnan(found.recommended_temperature).all()
    assert (found.recommended_status == status.CONTRADICTED).all()


def test_a_finding_between_instruments_takes_the_recommendation_away():
    entries = [{"rule": "instruments_disagree", "saw": "they differ"}, {"rule": "stuck", "saw": "stuck"}]
    parts = [a_correction(), a_joint_estimate(np.full(5, 1490.0))]
    assert of_correction(parts, entries[1:]).attrs["recommended"] == "joint"
    found = of_correction(parts, entries)
    assert found.attrs["recommended_because"] == "No temperature is recommended: they differ."
    assert (found.recommended_status == status.CONTRADICTED).all()


def test_a_temperature_that_differs_over_the_spot_is_in_the_interval():
    """Against Planck's law over the spot: what its level reads too much, and what a ratio of bands does."""
    spread, kelvin, waves = 0.05, 1500.0, np.array([[0.9e-6], [1.0e-6]])
    nodes, weights = np.polynomial.hermite_e.hermegauss(9)
    light = blackbody_radiance(waves, kelvin * (1 + spread * nodes)) @ weights / weights.sum()
    axis = np.linspace(1400.0, 1700.0, 3001)
    alone = blackbody_radiance(waves, axis)
    level = axis[np.argmin(np.abs(alone[1] - light[1]))] - kelvin
    ratio = axis[np.argmin(np.abs(alone[0] / alone[1] - light[0] / light[1]))] - kelvin
    stated = a_joint_estimate(np.full(5, kelvin)).assign_attrs(temperature_spread=spread)
    found = budget.by_group(of_correction([stated]))["unnamed misfit"]
    assert found == pytest.approx(level, rel=0.1) and 1.7 * level < ratio < 1.96 * found[0] * 1.25
    assert "unnamed misfit" not in budget.by_group(of_correction([a_joint_estimate(np.full(5, kelvin))]))
