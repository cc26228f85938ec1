"""How gains of instruments wander during a record: slowly, as the noise of their samples does not."""

import numpy as np

WANDER = {  # [1] standard deviations of gains about their means, ASSUME: amplifiers, fibre and window warm up
    "pyrometer": 2e-3,
    "ratio": 1e-3,
    "spectrometer": 3e-3,
}
STEP, LEAST_KNOTS, MOST_KNOTS = 8.0, 10, 40  # [s] between knots of what wanders, and how many there may be
MEMORY = 0.25  # [1], of the record: correlation time of the gains


def wandering(start, end, *times, more=(), step=STEP):
    """Knots (K,) [s], `more` among them, and a root (K, K) of the covariance of what wanders with variance 1,
    alike in parts over some times [s]."""
    knots = np.linspace(start, end, int(np.clip((end - start) / step, LEAST_KNOTS, MOST_KNOTS)))
    knots = np.union1d(knots, more)
    apart = np.abs(np.subtract.outer(knots, knots))
    return knots, np.linalg.cholesky(sum(np.exp(-apart / one) for one in times) / len(times))
