"""What wanders more than assumed, or is rougher, is believed; a drift, an event change no prior."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import cho_factor

from plasmapyro.diagnosis.fit import restless
from plasmapyro.diagnosis.fit.parameter import Parameter
from plasmapyro.diagnosis.fit.persistent import GAS_WANDER, WANDER, persistent, wandering_gas
from plasmapyro.diagnosis.fit.restless import (
    LEAST_RATIO,
    LEAST_WANDER,
    MOST,
    OF_SERIES,
    darker,
    rougher,
    steadier,
    wandering,
)

SPREAD = 0.3  # [1]: 39 second differences, the largest left out, know a standard deviation to 15 %


def fitted(values, covariance):
    """A model whose gas may wander, and what a fit says of it."""
    own = wandering_gas(-20.0, 330.0)
    model = SimpleNamespace(own=own, wandering=list(range(len(own))), size=0)
    return model, SimpleNamespace(state=SimpleNamespace(values=values), covariance=covariance)


def found(history=None, seed=1, size=0.015, error=1e-4):
    """Standard deviation that a record tells, in which the gas has a history, or wanders by a size [1]."""
    own = wandering_gas(-20.0, 330.0)
    root = np.array([one.history[1] for one in own]).T
    values = size * np.random.default_rng(seed).standard_normal(len(own))
    if history is not None:
        values = np.linalg.solve(root, history(np.array(own[0].history[0])))
    inverse = np.linalg.inv(root)
    return wandering(*fitted(values, error**2 * inverse @ inverse.T))


@pytest.mark.parametrize("seed", range(4))
def test_a_gas_that_wanders_by_a_per_cent_and_a_half_is_believed(seed):
    assert found(seed=seed) == pytest.approx(0.015, rel=SPREAD)


def test_a_gas_is_not_believed_to_wander_without_end():
    assert found(size=0.1) == MOST


@pytest.mark.parametrize("seed", range(4))
def test_a_gas_as_quiet_as_assumed_stays_so(seed):
    assert found(seed=seed, size=0.8 * GAS_WANDER) is None


def test_a_drift_is_no_wandering():
    assert found(lambda time: 0.1 * time / 300) is None
    assert found(lambda time: -0.1 * np.expm1(-np.maximum(time, 0) / 100)) is None


def test_an_event_is_no_wandering():
    assert found(lambda time: 0.1 * (time > 150)) is None
    assert found(lambda time: 0.1 * np.exp(-(((time - 100) / 8) ** 2))) is None


def test_data_that_say_nothing_change_nothing():
    count = len(wandering_gas(-20.0, 330.0))
    assert wandering(*fitted(np.zeros(count), GAS_WANDER**2 * np.eye(count))) is None


def steady(true, error, drift=0.0, seed=1):
    """Factor of the gain of a pyrometer that wanders by `true` of what is assumed and drifts besides, its
    knots seen with an error, both in units of that; the posterior of a normal law."""
    pyrometer = SimpleNamespace(kind="pyrometer", channels=2, band=(), known=None)
    errors = persistent(pyrometer, -20.0, 330.0)
    own = [one.id == "wander_pyrometer" for one in errors.parameters]
    sigma, root = WANDER["pyrometer"], errors.time[:, own]
    random = np.random.default_rng(seed)
    gain = true * root @ random.standard_normal(len(root)) + drift * errors.knots / 300
    seen = gain + error * random.standard_normal(len(root))
    covariance = np.linalg.inv(np.eye(len(root)) + root.T @ root / error**2)
    values, block = np.zeros(len(own)), np.eye(len(own)) * WANDER["ratio"] ** 2
    values[own] = sigma * covariance @ root.T @ seen / error**2
    block[np.ix_(own, own)] = sigma**2 * covariance
    model = SimpleNamespace(persistent=[errors], places=[slice(0, len(own))], size=0)
    found = steadier(model, SimpleNamespace(state=SimpleNamespace(values=values), covariance=block))
    assert "wander_ratio" not in found  # of which the data say nothing
    return found.get("wander_pyrometer", 1.0)


@pytest.mark.parametrize("seed", range(4))
def test_gains_that_wander_less_than_assumed_do_so(seed, monkeypatch):
    monkeypatch.setattr(restless, "LEAST_WANDER", 0.1)
    assert steady(0.5, 0.02, seed=seed) == pytest.approx(0.5, rel=SPREAD)
    assert steady(0.5, 0.02, drift=5.0, seed=seed) == pytest.approx(0.5, rel=SPREAD)


@pytest.mark.parametrize("seed", range(4))
def test_gains_as_steady_as_assumed_stay_so(seed):
    assert steady(1.0, 0.02, seed=seed) > 1 - SPREAD


def test_no_gain_is_as_steady_as_its_seconds():
    assert steady(0.01, 0.02) == LEAST_WANDER


def test_noise_tells_no_steady_gain():
    assert steady(0.01, 3.0) == 1.0


@pytest.mark.parametrize(("true", "error"), [(3.0, 0.5), (3.0, 2.0), (0.8, 0.5)])
def test_series_are_as_rough_as_they_are(true, error):
    """Numbers seen with some error, by the formulas of a normal law; 200 know their size to 5 to 15 %. Of the
    other numbers the data say nothing."""
    count = 200
    seen = np.random.default_rng(3).normal(0, np.hypot(true, error), count)
    sigma = np.repeat([1.0, 1.0, 1.0], count)
    for _ in range(20):
        own = [
            Parameter(name, name, sigma[count * k]) for k, name in enumerate(OF_SERIES) for _ in range(count)
        ]
        variance = 1 / (sigma**-2 + np.repeat([0.0, error**-2, 0.0], count))
        values = np.repeat([0.0, 1.0, 0.0], count) * variance / error**2 * np.tile(seen, 3)
        model = SimpleNamespace(parameters=own, size=0)
        state = SimpleNamespace(values=values)
        factors = rougher(model, SimpleNamespace(state=state, covariance=np.diag(variance)))
        sigma *= np.repeat([factors.get(name, 1.0) for name in OF_SERIES], count)
        if not factors:
            break
    assert sigma[0] == sigma[-1] == 1.0
    expected = pytest.approx(true, rel=0.2) if true > np.sqrt(LEAST_RATIO) else 1.0
    assert sigma[count] == expected


def test_one_series_tells_no_fault_from_roughness():
    own = [Parameter(name, name, 1.0) for name in OF_SERIES[:2]]
    solution = SimpleNamespace(state=SimpleNamespace(values=np.full(2, 9.0)), covariance=0.01 * np.eye(2))
    assert rougher(SimpleNamespace(parameters=own, size=0), solution) == {}


def dark_factor(true, error, common=0.0, channels=200, seed=1):
    """Factor of the uncertainty of darks that err by `true` of it in each channel, and by `common` of it in
    all, each seen with an error in that unit; beside a number of the model and a pattern of scale."""
    random = np.random.default_rng(seed)
    sigma = random.uniform(0.5, 2.0, channels)  # unlike pixels
    dark = sigma * (true * random.standard_normal(channels) + common)
    seen = dark + error * sigma * random.standard_normal(channels)
    value = seen / (1 + error**2)
    one = SimpleNamespace(
        channels=channels, pattern=np.ones(channels), dark=sigma, gas_error=0 * sigma, before_error=0 * sigma
    )
    bands = SimpleNamespace(
        channels=2, pattern=np.zeros(2), dark=np.zeros(2), gas_error=np.ones(2), before_error=np.zeros(2)
    )
    information = np.concatenate([np.ones(1 + 2 + channels), (1 + error**-2.0) / sigma**2])
    solution = SimpleNamespace(
        state=SimpleNamespace(dark=(np.zeros(2), value)),
        score=np.zeros(information.size),
        factor=cho_factor(np.diag(information)),
    )
    first, second = darker(SimpleNamespace(instruments=[bands, one]), solution)
    assert first == 1.0
    return second


@pytest.mark.parametrize("seed", range(4))
def test_darks_are_known_as_well_as_they_scatter(seed):
    assert dark_factor(0.3, 0.1, seed=seed) == pytest.approx(0.3, rel=SPREAD)
    assert dark_factor(0.3, 0.1, common=5.0, seed=seed) == pytest.approx(0.3, rel=SPREAD)


def test_darks_that_nothing_tells_stay_as_they_are():
    assert dark_factor(0.1, 30.0) == pytest.approx(1.0, abs=0.1)
    assert dark_factor(3.0, 0.1) == 1.0  # nor are they raised


@pytest.mark.parametrize(("wander", "least", "most"), [(0.0, 0.2, 0.3), (0.5, 0.4, 0.6), (1.0, 0.85, 1.0)])
def test_a_course_over_wavelength_wanders_as_little_as_its_knots_show(wander, least, most):
    """Numbers drawn `wander` times as large as assumed, and known exactly; more than assumed is left."""
    wavelength = np.linspace(7e-7, 1e-6, 90)
    one = SimpleNamespace(kind="spectrometer", channels=90, known=None, wavelength=wavelength)
    errors = persistent(one, 0.0, 360.0)
    course = np.array([parameter.id == "wander_course" for parameter in errors.parameters])
    sigma = np.array([parameter.sigma for parameter in errors.parameters])
    drawn = np.random.default_rng(4).standard_normal(sigma.size)
    values = sigma * drawn * np.where(course, wander, 1.0)
    model = SimpleNamespace(persistent=[errors], places=[slice(0, sigma.size)], size=0)
    solution = SimpleNamespace(
        state=SimpleNamespace(values=values), covariance=np.zeros((sigma.size, sigma.size))
    )
    assert least <= steadier(model, solution).get("wander_course", 1.0) <= most
