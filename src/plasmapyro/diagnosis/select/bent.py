"""Whether the data want the column of a name another one: what a cause that is only alike leaves."""

import numpy as np
from scipy.linalg import cho_solve
from scipy.special import chdtri

from plasmapyro.diagnosis.fit.normal import gram, own_patterns
from plasmapyro.diagnosis.fit.setting import SPILL, free_numbers
from plasmapyro.diagnosis.select.reserve import WRONG_FORMULA
from plasmapyro.diagnosis.select.structures import SETTLED

RARE = 1e-3  # share of right formulas that would be called bent by chance
TWIN = 1e-6  # [1], of the information of a bend: what the fit leaves of it if it is one of its own columns
NOTHING = 1e-9  # and of a course: the path takes up nearly all of a clock, and of its courses
BENDS, MOST = 5, 500.0  # of a column; logarithm of a ratio beyond which it is not told
INSTRUMENT = ("optics", "detector", "clock")  # what the catalogue takes as constant, but may change
LIKELIER = 5.0  # times such a name: what changes in the course of a test, in its place
BEGUN = np.geomspace(0.01, 0.9, 40)  # [1] of the exposure: when that may be there at once


def bent(model, solution, alone):
    r"""Whether a name fits clearly better with its column bent, or with another course in time.

    Bends: columns :math:`e(t, \lambda)` times the first two Legendre polynomials of the wavelength, times
    the time, the temperature of the surface and the signal, together: a cause that the catalogue lacks is
    rarely alike along all four axes. Courses, of instruments alone: the column times what begins at
    nothing, in its place, as a clock that runs fast, a dark that warms, a lamp that is switched on: where a
    name rests on a part of the test, either of the two leaves little to the other.

    Parameters
    ----------
    model : Model
    solution : Solution
        With the effects that are named.
    alone : mapping id -> chi-squared that each of them explains alone

    Returns
    -------
    bool
        What bends gain is rare by chance and beyond what formulas may err by, or courses are `LIKELIER`.
    """
    total = sum(alone[setting.id] for setting in solution.settings)
    free, size = free_numbers(solution.settings), len(solution.covariance)
    for place, number in enumerate(free, start=size - len(free)):
        if number.name is None:
            setting = solution.settings[number.place]
            gained, degrees, likelier = _gained(model, solution, place - size)
            drifts = setting.effect.stage in INSTRUMENT and likelier > LIKELIER
            own = alone[setting.id]
            formulas = max(WRONG_FORMULA * own, SPILL * total)
            if drifts or gained > max(chdtri(max(degrees, 1), RARE), formulas):
                return True
    return False


def _gained(model, solution, place):
    r"""Chi-squared that the bends of the column at a place gain together, how many they are, and how many
    times likelier than the column what has another course is, in the mean.

    Beside a course, the best amplitude is a of variance V: without it chi-squared is :math:`a^2 / V` more.
    """
    columns = [
        column[..., [place]] * axes
        for column, axes in zip(solution.jacobian, _axes(model, solution), strict=True)
    ]
    mine = own_patterns(model.instruments, solution.plain, solution.gas_rows)
    fitted, more = solution.jacobian[0].shape[2], columns[0].shape[2]
    dense = [np.concatenate(parts, axis=2) for parts in zip(solution.jacobian, columns, strict=True)]
    matrix, vector = gram(dense, mine, solution.weighers, solution.residual)
    rest = np.arange(fitted, fitted + more)
    base = np.delete(np.arange(len(matrix)), rest)
    carried = cho_solve(solution.factor, matrix[np.ix_(base, rest)])
    own = np.diag(matrix)[rest]
    scale = np.sqrt(np.where(own > 0, own, np.inf))
    left = (matrix[np.ix_(rest, rest)] - matrix[np.ix_(rest, base)] @ carried) / np.outer(scale, scale)
    score = (vector[rest] - carried.T @ solution.score) / scale
    value, vectors = np.linalg.eigh(left[:BENDS, :BENDS])
    along, kept = vectors.T @ score[:BENDS], value > TWIN
    gained = float(np.sum(along[kept] ** 2 / value[kept]))
    value, across = np.diag(left)[BENDS:], (carried[fitted + place] / scale)[BENDS:]
    value = np.where(value > NOTHING, value, np.inf)
    beside = solution.state.amplitudes[place] - across * score[BENDS:] / value
    variance = solution.covariance[place, place] + across**2 / value
    more = score[BENDS:] ** 2 / value - beside**2 / variance
    grown, begun = np.split(np.exp(np.minimum(more / 2, MOST)), [-BEGUN.size])
    return gained, int(kept.sum()), float(grown.mean() + begun.mean()) / 2


def _axes(model, solution):
    """Factors (n, C, m) per instrument: `BENDS`, about -1 to 1 each, and courses that begin at nothing."""
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
            *_courses(np.maximum(time, 0.0) / model.off)[..., None],
        )
        yield np.stack(np.broadcast_arrays(*factors), axis=2)


def _courses(share):
    """Courses (m, n) over shares of the exposure: growing with them, settling, there from a moment on."""
    settling = -np.expm1(-share / np.array(SETTLED)[:, None])
    return np.vstack([share, settling, share > BEGUN[:, None]])
