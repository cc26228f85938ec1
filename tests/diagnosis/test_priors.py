from copy import copy
from dataclasses import replace

import numpy as np
import pytest

from plasmapyro.diagnosis.fit.base import fit_base
from plasmapyro.diagnosis.fit.prior import (
    SMOOTH,
    Normal,
    posterior_of,
    prior_of,
    relative,
    shared_rows,
    with_prior,
)


def narrowed(model):
    """The law of the instruments as a campaign may know it: correlated, off the middle, half as wide."""
    law = prior_of(model)
    size = len(law.names)
    turn = np.eye(size) + 0.3 * np.tri(size, k=-1)
    root = 0.5 * np.diag(law.sigma) @ turn / np.linalg.norm(turn, axis=1)[:, None]
    return Normal(law.names, law.mean + 0.4 * law.sigma, root @ root.T)


def test_a_model_has_the_prior_that_it_was_given(model):
    known = narrowed(model)
    told = prior_of(with_prior(model, known))
    assert told.names == known.names
    np.testing.assert_allclose(told.mean, known.mean, rtol=1e-6, atol=1e-6 * known.sigma.max())
    np.testing.assert_allclose(
        told.covariance, known.covariance, rtol=1e-5, atol=1e-6 * known.sigma.min() ** 2
    )


def test_what_tests_share_of_a_scale_is_all_that_is_wrong_with_it(model):
    """What is left open by the numbers that tests share would count anew in each test of a campaign."""
    errors, place = model.persistent[1], model.places[1]
    names, rows = shared_rows(model)
    own = rows[[name.startswith("scale_") for name in names]][:, place]
    smooth = np.array([one.id == SMOOTH for one in errors.parameters])
    curve = errors.channel * smooth
    left = curve - curve @ np.linalg.pinv(own, rcond=1e-9) @ own
    assert np.abs(left).max() < 1e-6 * np.abs(curve).max()


def test_its_own_prior_changes_no_model(model):
    same = with_prior(model, prior_of(model))
    np.testing.assert_allclose(same.precision, model.precision, rtol=1e-6, atol=1e-6)


def test_a_fit_with_a_prior_is_the_fit_without_times_what_the_prior_adds(model, monkeypatch):
    """Gauss: information adds up, within a fifth of each standard deviation: fits are not linear, and each
    estimates its noise anew. How far gains wander, which a fit estimates too, is held: it is no number of
    the law, and with knots 3 s apart it moved one of the means by 0.6 deviations."""
    monkeypatch.setattr("plasmapyro.diagnosis.fit.base.steadier", lambda *_: {})
    plain = fit_base(model)
    known = posterior_of(plain.model, plain.solution)
    other = Normal(known.names, known.mean + 0.3 * known.sigma, 0.5 * known.covariance)
    prior = prior_of(model)
    found = posterior_of(*_fitted(with_prior(model, other)))
    data = np.linalg.inv(known.covariance) - np.linalg.inv(prior.covariance)
    covariance = np.linalg.inv(data + np.linalg.inv(other.covariance))
    np.testing.assert_allclose(found.sigma, np.sqrt(np.diag(covariance)), rtol=0.03)
    mean = covariance @ (
        np.linalg.solve(known.covariance, known.mean)
        - np.linalg.solve(prior.covariance, prior.mean)
        + np.linalg.solve(other.covariance, other.mean)
    )
    assert (np.abs(found.mean - mean) < 0.2 * known.sigma).all()


def _fitted(model):
    found = fit_base(model)
    return found.model, found.solution


@pytest.mark.parametrize("kind", ["edge_wide", "ratio"])
def test_a_prior_on_one_number_narrows_it_and_no_other_widens(model, kind):
    law = prior_of(model)
    one = law.of([kind])
    told = prior_of(
        with_prior(
            model,
            Normal((kind, "power"), np.append(one.mean, 0.1), np.diag([1e-2 * one.sigma[0] ** 2, 0.03**2])),
        )
    )
    assert told.of([kind]).sigma[0] == pytest.approx(0.1 * one.sigma[0])
    assert (told.sigma <= law.sigma * (1 + 1e-9)).all()


def test_a_ratio_from_other_tests_leaves_the_slope_of_this_sample_open(model):
    """A surface whose colour no spectra see: what a campaign knows of the instrument says nothing of it."""
    law = Normal(("ratio", "tail"), np.array([0.004, 0.0]), np.diag([0.001, 0.01]) ** 2)
    record = replace(model.record, emittance_slope=1.0, emittance_slope_uncertainty=0.01)
    sloped = replace_record(model, record)
    assert relative(law, sloped).sigma == pytest.approx([np.hypot(0.001, 0.01), 0.01])
    told = replace_record(model, replace(record, emittance_slope_uncertainty=0.0))
    assert relative(law, told).sigma == pytest.approx(law.sigma)


def replace_record(model, record):
    """The model of another record."""
    other = copy(model)
    other.record = record
    return other
