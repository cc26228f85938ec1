import numpy as np
import pytest

from plasmapyro.diagnosis.fit.base import fit_base
from plasmapyro.diagnosis.fit.inference import Fitter
from plasmapyro.diagnosis.fit.prior import Normal, prior_of, with_prior
from plasmapyro.diagnosis.report.following import Following, following, measurements


@pytest.fixture(scope="module")
def base(model):
    return fit_base(model)


def test_the_best_measurement_leaves_what_a_fit_with_it_has(base):
    """The number is drawn about the truth, 0, and put into a new fit, which is not linear."""
    ranked = following(base.model, base.solution)
    random = np.random.default_rng(4)
    law = prior_of(base.model)
    for row in [one for one in ranked if one["id"] in ("calibration", "lamp", "emittance", "fixed_point")]:
        precision = np.linalg.inv(law.covariance)
        pull = precision @ law.mean
        for observes, sigma in measurements()[row["id"]][1]:
            mine = [
                p for p, name in enumerate(law.names) if name == observes or name.startswith(f"{observes}_")
            ]
            precision[mine, mine] += sigma**-2.0
            pull[mine] += sigma**-1.0 * random.normal(size=len(mine))
        covariance = np.linalg.inv(precision)
        known = Normal(law.names, covariance @ pull, covariance)
        made = Fitter(with_prior(base.model, known), base.fitter.noise).fit(base.solution.state)
        found = Following(base.model, base.solution).kelvin(made.covariance)
        assert found == pytest.approx(row["kelvin_after"], rel=0.03), row["id"]


def test_measurements_are_ranked_and_a_second_one_never_harms(base):
    ranked = following(base.model, base.solution)
    after = [row["kelvin_after"] for row in ranked]
    assert {row["id"] for row in ranked} == set(measurements())
    assert after == sorted(after) and after[-1] <= ranked[0]["kelvin_before"] * (1 + 1e-9)
    assert after[0] < 0.9 * ranked[0]["kelvin_before"]
    assert all(row["after_first"] <= after[0] * (1 + 1e-6) for row in ranked)
    assert min(row["after_first"] for row in ranked[1:]) < 0.99 * after[0]


def test_what_tells_causes_apart_takes_their_spread(base):
    groups, shifts = [["ripple", "P_eff"], ["winE"]], {"ripple": 0.0, "P_eff": 30.0}
    plain = {row["id"]: row for row in following(base.model, base.solution)}
    rows = following(base.model, base.solution, groups, shifts)
    told = {row["id"]: row for row in rows}
    assert told["photodiode"]["resolves"] == told["second_power"]["resolves"] == [groups[0]]
    assert told["calibration"]["resolves"] == []
    spread = np.hypot(plain["calibration"]["kelvin_after"], 30.0)
    assert told["calibration"]["kelvin_after"] == pytest.approx(spread)
    assert rows[0]["id"] in ("photodiode", "second_power")
    best = min(rows[1:], key=lambda row: row["after_first"])
    assert best["after_first"] < 0.9 * rows[0]["kelvin_after"]
