"""What a test says about the numbers that it shares with other tests: for a campaign of them."""

import numpy as np

from plasmapyro.diagnosis.fit.prior import POWER, Normal, posterior_of, prior_of, shared_rows, stated

MOST_TIMES = 40


def posterior(findings):
    r"""Entry of the report: laws of the shared numbers after and before the data, and the temperature.

    `slope` (t, d) [K] is :math:`B = \mathrm{cov}(T, \theta)\,\mathrm{cov}(\theta)^{-1}`: other tests that
    move the numbers by x move the temperature by B x.
    """
    model, fit = findings.model, findings.final if findings.applied else findings.base.solution
    after, before, at_hand = posterior_of(model, fit), prior_of(model), stated(model)
    misfit = max(fit.objective / fit.count, 1.0)
    after_gas = before_gas = None
    if POWER in at_hand:
        change, error = findings.comparison.power
        after_gas, before_gas = _one(change, error), _one(*model.power)
    times = findings.times[findings.times >= 0]
    times = times[:: -(-times.size // MOST_TIMES)]
    basis, size = model.history.basis(times), model.size
    slope = basis @ _covariance(model, fit, size) @ np.linalg.inv(after.covariance)
    variance = np.einsum("tk,kl,tl->t", basis, fit.covariance[:size, :size], basis)
    after, before = (
        (law if gas is None else law.beside(gas)).moved(at_hand)
        for law, gas in ((after, after_gas), (before, before_gas))
    )
    slope = np.pad(slope, ((0, 0), (0, len(after.names) - slope.shape[1])))
    return {
        "names": list(after.names),
        "mean": after.mean.tolist(),
        "covariance": after.covariance.tolist(),
        "prior": {"mean": before.mean.tolist(), "covariance": before.covariance.tolist()},
        "misfit": float(misfit),
        "with_priors": False,
        "temperature": {
            "time": times.tolist(),
            "value": (basis @ fit.state.knots).tolist(),
            "sigma": np.sqrt(misfit * variance).tolist(),
            "slope": slope.tolist(),
        },
    }


def _one(mean, sigma):
    return Normal((POWER,), np.array([mean]), np.array([[sigma**2]]))


def _covariance(model, fit, size):
    """Covariance (K, d) of the knots and the shared numbers."""
    _, rows = shared_rows(model)
    return fit.covariance[:size, size : size + rows.shape[1]] @ rows.T
