"""How finely gains may wander."""

import numpy as np

from plasmapyro.diagnosis.fit.persistent import GAIN_STEP
from plasmapyro.instrument.wander import MEMORY, wandering


def test_knots_of_a_usual_record_follow_noise_of_seconds():
    """Knots 8 s apart do not follow 1/f noise: five of seven sound tests had been unknown."""
    knots, root = wandering(-15.0, 100.0, MEMORY * 115.0, step=GAIN_STEP)
    assert np.diff(knots).max() < 3.2
    # Two knots of an exponential covariance part by sqrt(2 (1 - exp(-d/m))) of a standard deviation.
    change = np.sqrt(np.sum(np.diff(root, axis=0) ** 2, axis=1))
    np.testing.assert_allclose(change, np.sqrt(-2 * np.expm1(-np.diff(knots) / (MEMORY * 115.0))), rtol=1e-9)


def test_knots_of_a_long_record_stay_few():
    assert wandering(0.0, 3600.0, 900.0, step=GAIN_STEP)[0].size == 40
