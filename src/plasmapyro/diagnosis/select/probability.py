"""Stated probabilities made honest: flattened until the first answer has the share that was measured."""

import numpy as np
from scipy.optimize import brentq

from plasmapyro import tables

PRIOR_NONE, PRIOR_UNKNOWN = 0.5, 0.1  # before the data; the catalogue shares the rest
TABLE = "diagnosis/stated_probability"
FLATTEST, STEEPEST = 1e-4, 1e3  # power of the weights
LEAST = 1e-6  # probabilities below are not reported
WITH_RESERVE = 0.79  # the most that is stated of a name with reserve: what is doubted is not sure
CERTAIN = 0.9999  # nothing is stated as surer: no set of simulated cases could show it


def prior_share(count):
    """Logarithm of the probability of one of `count` effects before the data."""
    return float(np.log((1 - PRIOR_NONE - PRIOR_UNKNOWN) / count))


def measured_share(status, stated):
    """Share of simulated cases of a status in which an answer stated with some probability is right.

    Linear in the stated probability between the rows of the table, constant beyond them.

    Parameters
    ----------
    status : str
        Of the verdict.
    stated : float [1]

    Returns
    -------
    float [1]; `stated` itself where the table holds no such status
    """
    table = tables.load(TABLE)
    own = table["status"] == status
    if not own.any():
        return float(stated)
    return float(np.interp(stated, table["stated"][own], table["right"][own]))


def normalised(log):
    """Probabilities {answer: p} from logarithms of weights, and flattened ones for a power below 1."""
    top = max(log.values())
    weight = {answer: float(np.exp(value - top)) for answer, value in log.items()}
    total = sum(weight.values())
    return {answer: value / total for answer, value in weight.items()}


def honest(log, status):
    r"""Probabilities whose largest is the measured share of right answers, in the same order.

    .. math:: p_i \propto w_i^\beta

    Parameters
    ----------
    log : mapping answer -> logarithm of its weight
    status : str
        Of the verdict.

    Returns
    -------
    probability : dict answer -> p
    uncalibrated : float
        That of the first answer before.

    Notes
    -----
    Source: temperature scaling, C. Guo et al., Proc. Mach. Learn. Res. 70 (2017) 1321, with a power that
    follows from the share measured among simulated cases instead of one for all.
    """
    plain = normalised(log)
    first = max(plain, key=plain.get)
    stated = plain[first]
    most = WITH_RESERVE if status == "named+unknown" else CERTAIN
    wanted = float(np.clip(measured_share(status, stated), 1.001 / len(log), most))
    values = np.array(list(log.values()))
    values = values - values.max()

    def excess(power):
        return 1 / np.sum(np.exp(power * values)) - wanted

    if excess(FLATTEST) > 0 or excess(STEEPEST) < 0:  # answers of equal weight: no power tells them apart
        return _reported(plain), stated
    power = brentq(excess, FLATTEST, STEEPEST, xtol=1e-9)
    return _reported(normalised({answer: power * value for answer, value in log.items()})), stated


def _reported(probability):
    return {answer: value for answer, value in probability.items() if value > LEAST}
