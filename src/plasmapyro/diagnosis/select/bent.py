"""Whether the data want the column of a name another one: what a cause that is only alike leaves."""

import numpy as np
from scipy.linalg import cho_solve
from scipy.stats import chi2

from plasmapyro.diagnosis.fit.normal import gram, own_patterns
from plasmapyro.diagnosis.fit.setting import free_numbers
from plasmapyro.diagnosis.select.prices import SPILL
from plasmapyro.diagnosis.select.reserve import WRONG_FORMULA

RARE = 1e-3  # share of right formulas that would be called bent by chance
TWIN = 1e-6  # [1], of the information of a bend: what the fit leaves of it if it is one of its own columns


def bent(model, solution, alone):
    r"""Whether a name fits clearly better with its column bent.

    Columns :math:`e(t, \lambda)` times the first two Legendre polynomials of the wavelength, times the time,
    the temperature of the surface and the signal, together: a cause that the catalogue lacks is rarely
    alike along all four axes.

    Parameters
    ----------
    model : Model
    solution : Solution
        With the effects that are named.
    alone : mapping id -> chi-squared that each of them explains alone

    Returns
    -------
    bool
        What they gain is rare by chance and beyond what formulas may err by.
    """
    total = sum(alone[setting.id] for setting in solution.settings)
    free, size = free_numbers(solution.settings), len(solution.covariance)
    for place, number in enumerate(free, start=size - len(free)):
        if number.name is None:
            gained, degrees = _gained(model, solution, place - size)
            own = alone[solution.settings[number.place].id]
            formulas = max(WRONG_FORMULA * own, SPILL * total)
            if gained > max(chi2.isf(RARE, max(degrees, 1)), formulas):
                return True
    return False


def _gained(model, solution, place):
    """Chi-squared that the bends of the column at a place gain together, and how many they are."""
    columns = [
        column[..., [place]] * axes
        for column, axes in zip(solution.jacobian, _axes(model, solution), strict=True)
    ]
    mine = own_patterns(model.instruments, solution.plain, solution.gas_rows, solution.gas)
    fitted, more = solution.jacobian[0].shape[2], columns[0].shape[2]
    dense = [np.concatenate(parts, axis=2) for parts in zip(solution.jacobian, columns, strict=True)]
    matrix, vector = gram(dense, mine, solution.weighers, solution.residual)
    rest = np.arange(fitted, fitted + more)
    base = np.delete(np.arange(len(matrix)), rest)
    carried = cho_solve(solution.factor, matrix[np.ix_(base, rest)])
    own = np.diag(matrix)[rest]
    scale = np.sqrt(np.where(own > 0, own, np.inf))
    left = (matrix[np.ix_(rest, rest)] - matrix[np.ix_(rest, base)] @ carried) / np.outer(scale, scale)
    value, vectors = np.linalg.eigh(left)
    score = vectors.T @ ((vector[rest] - carried.T @ solution.score) / scale)
    kept = value > TWIN
    return float(np.sum(score[kept] ** 2 / value[kept])), int(kept.sum())


def _axes(model, solution):
    """Factors (n, C, 5) per instrument, about -1 to 1 each."""
    for instrument, value in zip(model.instruments, solution.prediction, strict=True):
        channels, time = np.linspace(-1, 1, instrument.channels), instrument.time
        if instrument.kind == "spectrometer":
            channels = 2 * (instrument.wavelength - instrument.wavelength.min())
            channels = channels / np.ptp(instrument.wavelength) - 1
        hot = model.history.basis(time) @ solution.state.knots
        factors = (
            channels[None],
            1.5 * channels[None] ** 2 - 0.5,
            2 * np.clip(time / model.off, 0, 1)[:, None] - 1,
            (2 * hot / hot.max() - 1)[:, None],
            2 * value / value.max(axis=0) - 1,
        )
        yield np.stack(np.broadcast_arrays(*factors), axis=2)
