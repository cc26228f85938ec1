"""Gases much stronger than simulated: the first guess, the base fit, and which term may stand behind it."""

import numpy as np
import pytest
from small_laboratory import POWERS

from plasmapyro.diagnosis import strengths
from plasmapyro.diagnosis.base import fit_base
from plasmapyro.diagnosis.build import base_model
from plasmapyro.diagnosis.library import gas_library


@pytest.fixture(scope="module")
def build(radiation, variations, response, calibration):
    def make(test):
        library = gas_library("80kW", radiation, POWERS, variations, fwhm=0.75e-9)
        return base_model(test, library, calibration, response)

    return make


@pytest.mark.parametrize("power", [60e3, 105e3])
def test_a_gas_several_times_as_strong_is_found_and_fitted(build, record, power):
    """Lines change by factors of 0.1 to 7; a fit that starts from the simulated gas ends far away."""
    test = record(power=power)
    model = build(test)
    wanted = np.log(power / 80e3)
    assert strengths.guess(model)[model.index["power"]] == pytest.approx(wanted, abs=0.08)  # its prior
    with np.errstate(all="ignore"):
        base = fit_base(model)
    solution = base.solution
    assert solution.converged and solution.chi2 / solution.count < 1.1
    assert solution.state.values[model.index["power"]] == pytest.approx(wanted, abs=0.08)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_gas_that_drowns_in_noise_is_guessed_as_simulated(build, record, seed):
    """Channels weigh by their scatter: by a hundredth of their light each, the power would be off by 0.3."""
    model = build(record(noise=40.0, seed=seed))
    assert strengths.guess(model)[model.index["power"]] == pytest.approx(0.0, abs=0.08)  # its prior


def test_brightness_before_and_after_the_injection_is_guessed(build, record):
    model = build(record())
    found = strengths.guess(model)
    assert found[model.index["before_injection"]] == pytest.approx(np.log(1.6), abs=0.02)
    assert found[model.index["gas"]] == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize(("term", "amplitude"), [("T_exc", 0.08), ("T_exc", -0.08), ("P_eff", 0.08)])
def test_the_term_that_moved_the_strengths_is_first(build, record, term, amplitude):
    model = build(record())
    library, values = model.library, np.zeros(len(model.parameters))
    factor = np.log(library.factor(strengths.BEHIND[term][0], amplitude))
    for row, name in enumerate(model.groups):
        light = library.group[row]
        values[model.index[name]] = light @ factor / light.sum() if light.sum() else 0.0
    gain, first, size, start = strengths.behind(model, values)[0]
    assert first == term and size == pytest.approx(amplitude, abs=0.25 * abs(amplitude))
    sigma = np.array([one.sigma for one in model.parameters])
    left, before = np.sum((start / sigma)[5:] ** 2), np.sum((values / sigma)[5:] ** 2)
    assert gain > 4 and left < 0.2 * before


def test_nothing_stands_behind_strengths_as_simulated(build, record):
    model = build(record())
    assert all(gain < 1e-6 for gain, *_ in strengths.behind(model, np.zeros(len(model.parameters))))
