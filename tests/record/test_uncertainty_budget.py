"""The uncertainty budget against the worked numbers of the GUM and exact Gaussian estimation."""

import numpy as np
import pytest

from plasmapyro.record import budget
from plasmapyro.record.budget import Input, combined, freedom, moments, of_family, remainder

H1 = {  # JCGM 100:2008, table H.1 (end gauge), contributions [nm] and degrees of freedom
    "standard": (25.0, 18.0),
    "repeated observations": (5.8, 24.0),
    "random effects of comparator": (3.9, 5.0),
    "systematic effects of comparator": (6.7, 8.0),
    "difference in expansion": (2.9, 50.0),
    "difference in temperature": (16.6, 2.0),
}


def test_the_end_gauge_of_the_gum_has_its_combined_uncertainty_and_freedom():
    inputs = [Input(name, "noise", np.array([u]), freedom=nu) for name, (u, nu) in H1.items()]
    assert combined(inputs)[0] == pytest.approx(31.7, abs=0.1)  # printed: 32 nm (from the rounded ones 31.7)
    assert freedom(inputs, 0) == pytest.approx(16.7, abs=0.3)  # printed: 16.7, truncated to 16
    assert freedom([Input("stated", "noise", np.array([1.0]))], 0) == np.inf


def test_noise_and_statements_share_the_variance_of_a_linear_estimate():
    generator = np.random.default_rng(5)
    jacobian, sigma = generator.normal(size=(9, 4)), np.array([np.inf, 0.5, 0.2, 3.0])
    weight = np.diag(generator.uniform(0.5, 4.0, 9))
    covariance = np.linalg.inv(jacobian.T @ weight @ jacobian + np.diag(sigma**-2.0))
    stated = [of_family(f"{i}", "gas", covariance[:1, [i]], sigma[[i]]) for i in (1, 2, 3)]
    gain = covariance @ jacobian.T @ weight  # of the estimate by the data
    noise = np.sqrt(np.diag(gain @ np.linalg.inv(weight) @ gain.T))[0]
    assert remainder(covariance[:1, 0], stated)[0] == pytest.approx(noise, rel=1e-10)
    whole = of_family("all", "gas", covariance[:1, 1:], sigma[1:])
    assert whole.contribution[0] == pytest.approx(combined(stated)[0], rel=1e-12)


def test_a_budget_is_told_at_the_first_the_hottest_and_the_last_value():
    kelvin = np.array([np.nan, 900.0, 1000.0, 1250.0, 1400.0, 1600.0, 1300.0, np.nan])
    assert moments(kelvin) == [1, 3, 5, 6]
    assert moments(np.full(4, np.nan)) == []
    assert moments(np.array([np.nan, 1000.0])) == [1]


def test_variables_come_back_as_inputs():
    inputs = [Input("a", "noise", np.array([1.0, 2.0]), 0.01, "1"), Input("b", "gas", np.array([0.5, 0.1]))]
    import xarray as xr

    found = budget.inputs_of(xr.Dataset(budget.variables(inputs), {"time": [0.0, 1.0]}))
    assert [one.name for one in found] == ["a", "b"]
    np.testing.assert_array_equal(found[0].contribution, [1.0, 2.0])
    assert np.isnan(found[1].uncertainty)
    assert found[1].freedom == np.inf
