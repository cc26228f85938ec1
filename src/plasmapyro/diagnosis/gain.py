"""What an extension is worth on data that the fit has not seen."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from plasmapyro.diagnosis.inference import gram, own_patterns

BLOCKS = (  # [s] after injection
    (-20.0, -1.0),
    (3.0, 9.0),
    (12.0, 18.0),
    (24.0, 32.0),
    (40.0, 52.0),
    (64.0, 84.0),
    (108.0, 140.0),
    (180.0, 220.0),
    (252.0, 290.0),
)
AFTER_BLOCKS = ((2.0, 6.0), (10.0, 18.0), (22.0, 40.0))  # [s] after the end of the plasma
ENOUGH = 3.0  # log score by which held-out data must improve: odds of 20


@dataclass(frozen=True)
class Gain:
    """Log score of held-out blocks with terms less without them."""

    blocks: tuple  # (start, end, difference)
    total: float
    standard_error: float
    cross_instrument: float | None

    @property
    def improves(self):
        """Whether held-out data speak for the terms by more than `ENOUGH`.

        The standard error, from the scatter of the blocks, is reported, not asked for: a term that acts in
        one
        phase gains in few blocks, and the scatter is then as large as the gain.
        """
        return self.total > ENOUGH


def blocks_of(off):
    """Blocks (start, end) [s] that are held out, one at a time."""
    return tuple(block for block in BLOCKS if block[1] < off) + tuple(
        (off + a, off + b) for a, b in AFTER_BLOCKS
    )


def log_score(model, solution, chosen):
    r"""Log density of some bins given all others, linearised about the fit.

    .. math:: \ln p(y_b | y_{-b}) = -\tfrac12\left[ r'^T (\Sigma_b + J_b M^{-1} J_b^T)^{-1} r'
              + \ln\det(\Sigma_b + J_b M^{-1} J_b^T)\right], \qquad M = A - A_b

    with the residuals :math:`r'` of the fit without the block; :math:`\ln\det\Sigma_b`, the same for all
    models, is
    left out.

    Parameters
    ----------
    model : Model
    solution : Solution
    chosen : list per instrument of bool (n,)

    Notes
    -----
    Source: Sherman-Morrison-Woodbury; A. Vehtari, A. Gelman & J. Gabry, Stat. Comput. 27 (2017) 1413.
    """
    columns = [c[s] for c, s in zip(solution.jacobian, chosen, strict=True)]
    residuals = [r[s] for r, s in zip(solution.residual, chosen, strict=True)]
    weighers = [w.of(s) for w, s in zip(solution.weighers, chosen, strict=True)]
    patterns = [
        (place, row[chosen[place]])
        for place, row in own_patterns(model.instruments, solution.plain, solution.gas)
    ]
    block, vector = gram(columns, patterns, weighers, residuals)
    whole = np.triu(solution.factor[0])
    matrix = whole.T @ whole
    rest = cho_factor(matrix - block + 1e-12 * np.diag(np.diag(matrix)))
    # The whole fit balances: without the block its pull is missing, and the parameters move by -M^-1 g_b.
    moved = -cho_solve(rest, vector)
    chi2 = sum(float(np.sum(r * w(r))) for r, w in zip(residuals, weighers, strict=True))
    # r' = r - J_b moved; its weighted square and its projection on J_b
    chi2 = chi2 - 2 * moved @ vector + moved @ block @ moved
    pull = vector - block @ moved
    full = (solution.factor[0], solution.factor[1])
    quadratic = chi2 - pull @ cho_solve(full, pull)
    log_determinant = 2 * (
        np.sum(np.log(np.abs(np.diag(full[0])))) - np.sum(np.log(np.abs(np.diag(rest[0]))))
    )
    return -0.5 * (quadratic + log_determinant)


def gain(model, base, extended):
    """Gain of the extended fit over the base fit.

    Parameters
    ----------
    model : Model
    base, extended : Solution
        Of the same data under the same noise.

    Returns
    -------
    Gain
    """
    found = []
    times = [one.moment.mean(axis=1) for one in model.instruments]
    for start, end in blocks_of(model.off):
        chosen = [(time >= start) & (time < end) for time in times]
        if not any(part.any() for part in chosen):
            continue
        difference = log_score(model, extended, chosen) - log_score(model, base, chosen)
        found.append((start, end, float(difference)))
    values = np.array([row[2] for row in found])
    spread = float(np.std(values, ddof=1) * np.sqrt(values.size)) if values.size > 1 else float("inf")
    cross = None
    if len(model.instruments) == 2:
        chosen = [
            np.full(time.size, one.kind == "pyrometer")
            for time, one in zip(times, model.instruments, strict=True)
        ]
        cross = float(log_score(model, extended, chosen) - log_score(model, base, chosen))
    return Gain(tuple(found), float(values.sum()), spread, cross)
