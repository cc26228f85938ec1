"""Linearised tests around a fit: every term of the catalogue, and structures that no term describes."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve, cholesky, eigh
from scipy.special import ndtr

from plasmapyro.diagnosis.catalogue import EFFECTS
from plasmapyro.diagnosis.inference import gram, own_patterns
from plasmapyro.diagnosis.model import Setting
from plasmapyro.radiation.slit import FWHM_PER_SIGMA

SCALES = (3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1)  # [1] relative size of an unknown structure
MAP_WAVES = 8
WALK_STEPS = 40
SHORTEST_PERIOD = 24.0  # [s]; the bins of the steady state are 8 s long
ROUNDING = 1e-5  # [1], relative, added to a singular covariance
GROWTH = 12.0  # of matter that a hot surface releases, at 1600 K
LEAST_LEFT = 1e-6  # [1], of the information of a direction that the base parameters must leave


@dataclass(frozen=True)
class Candidate:
    """A term at one shape, linearised: `column` its place among the columns."""

    id: str
    shape: dict
    sigma: float  # of the prior of the amplitude


@dataclass(frozen=True)
class Structure:
    """A class of unknown structures: its columns, all at once or one of them, to be scaled by `SCALES`.

    With `basis` (columns, b) one of b combinations of them stands for a single column.
    """

    id: str
    name: str
    columns: slice
    single: bool = False
    basis: np.ndarray | None = None


@dataclass(frozen=True)
class Screen:
    """What the data say about directions beside the base fit.

    `score` (m,) and `information` (m, m) of all columns (candidates first) with the fitted parameters
    projected out;
    `left` (m,) the share of each column's information that the base parameters leave.
    """

    candidates: tuple
    structures: tuple
    score: np.ndarray
    information: np.ndarray
    left: np.ndarray
    shift: np.ndarray  # (K, candidates) [K] change of the fitted knots per amplitude that is left out

    @property
    def count(self):
        """Number of candidates, each at each of its shapes."""
        return len(self.candidates)

    def gains(self):
        """Chi-squared gained by each candidate alone (candidates,)."""
        return gain(
            self.score[: self.count], np.diag(self.information)[: self.count], self.left[: self.count]
        )

    def linear(self):
        """Best number of each candidate alone along its column, see `Effect.linear_of`."""
        own = np.diag(self.information)[: self.count]
        return self.score[: self.count] / np.where(own > 0, own, np.inf)

    def amplitudes(self):
        """Best amplitude of each candidate alone."""
        return np.array(
            [EFFECTS[one.id].amplitude_of(x) for one, x in zip(self.candidates, self.linear(), strict=True)]
        )

    def ends(self):
        """Least and largest number of each candidate along its column (2, candidates)."""
        bounds = [[EFFECTS[c.id].linear_of(end) for end in EFFECTS[c.id].bounds] for c in self.candidates]
        return np.array(bounds).T

    def signed_gains(self):
        """As `gains`, but 0 where the best amplitude lies outside what the term allows."""
        low, high = self.ends()
        size = self.linear()
        # One standard deviation of slack: the linear estimate is not the last word.
        slack = 1 / np.sqrt(np.maximum(np.diag(self.information)[: self.count], 1e-300))
        allowed = (size > low - slack) & (size < high + slack) | (low < 0) & (high > 0)
        return np.where(allowed, self.gains(), 0.0)


def gain(score, information, left):
    """Chi-squared gained along directions."""
    usable = (information > 0) & (left > LEAST_LEFT)
    return np.where(usable, score**2 / np.where(usable, information, 1.0), 0.0)


def columns_of_candidates(model, solution, exclude=()):
    """Linearised columns (n, C, m) per instrument of every term at every shape, and who they are."""
    candidates = tuple(
        Candidate(effect.id, dict(shape), effect.sigma)
        for effect in EFFECTS.values()
        if effect.id not in exclude and set(effect.instruments) & {one.kind for one in model.instruments}
        for shape in effect.shapes
    )
    state, base = solution.state, solution.settings
    columns = []
    for which, one in enumerate(model.instruments):
        plain = model.evaluate(which, state.knots, state.values, base)
        rows = np.zeros((*plain.shape, len(candidates)))
        for j, candidate in enumerate(candidates):
            effect = EFFECTS[candidate.id]
            if one.kind not in effect.instruments:
                continue
            changed = model.evaluate(
                which, state.knots, state.values, (*base, Setting(candidate.id, effect.step, candidate.shape))
            )
            rows[..., j] = (changed - plain) / effect.step
        columns.append(rows)
    return candidates, columns


class _Products:
    """Columns of one instrument as rows (n, C) times shares (n,): few rows, many columns."""

    def __init__(self, shape):
        self.shape, self.rows, self.shares, self.size = shape, [], [], 0

    def row(self, values):
        """A row (n, C) to be shared; its number."""
        self.rows.append(np.broadcast_to(values, self.shape))
        return len(self.rows) - 1

    def add(self, size, *parts):
        """`size` columns: the sum of rows times shares over (number of a row, shares (n, size))."""
        self.shares.append((slice(self.size, self.size + size), parts))
        self.size += size

    def whole(self):
        """Rows (n, C, r) and shares (n, r, m)."""
        shares = np.zeros((self.shape[0], len(self.rows), self.size))
        for place, parts in self.shares:
            for number, own in parts:
                shares[:, number, place] += own
        return np.stack(self.rows, axis=2), shares


def structures_of(model, solution):
    """Unknown structures: columns per instrument as products, patterns over the channels, and their classes.

    Smooth over time and wavelength; a pattern over the channels that multiplies everything, the surface, or
    adds to
    the gas (always, or as a hot surface releases it); random walks of the gain of each instrument, of the
    ratio
    of the bands and of each band.

    Returns
    -------
    classes : tuple of Structure, whose columns count from the first product; patterns follow
    products : list of (rows (n, C, r), shares (n, r, m)): the columns `rows @ shares`
    patterns : list of (instrument, row (n, C)): one column per channel, the row at that channel
    """
    instruments = model.instruments
    classes, patterns, named = [], [], []
    products = [_Products(one.value.shape) for one in instruments]
    total = 0

    def add(identity, name, per_instrument):
        """A class from (number of a row, shares) of each instrument it touches."""
        nonlocal total
        size = next(iter(per_instrument.values()))[0][1].shape[1]
        for place, own in enumerate(products):
            own.add(size, *per_instrument.get(place, ()))
        classes.append(Structure(identity, name, slice(total, total + size)))
        total += size

    gas_rows, smooth = [], {}
    for place, (one, value, gas) in enumerate(
        zip(instruments, solution.prediction, solution.gas, strict=True)
    ):
        own, time = products[place], one.moment.mean(axis=1)
        walk, wave = _walk(time), _waves(time, model.off)
        gas_rows.append(own.row(gas))
        if one.kind == "spectrometer":
            whole = own.row(value)
            add("walk_spectrometer", "wandering gain of the spectrometer", {place: [(whole, walk)]})
            add("wave_spectrometer", "periodic gain of the spectrometer", {place: [(whole, wave)]})
            for identity, name, row in _spectral_patterns(model, solution, time, value, gas):
                patterns.append((place, row))
                named.append((identity, name, one.channels))
        else:
            bands = [own.row(value * np.eye(2)[band]) for band in (0, 1)]
            for identity, name, signs in _BANDS:
                walks, waves = (
                    {place: [(band, sign * steps) for band, sign in zip(bands, signs, strict=True)]}
                    for steps in (walk, wave)
                )
                add(identity, name, walks)
                if identity in ("walk_pyrometer", "walk_ratio"):
                    add(identity.replace("walk", "wave"), name.replace("wandering", "periodic"), waves)
        if one.weight is None:
            smooth[place] = [
                (own.row(value * wave), shares) for wave, shares in zip(*_smooth(model, one), strict=True)
            ]
    walks = _common_walk(instruments, model.off)
    add(
        "walk_gas",
        "wandering brightness of the gas",
        {place: [(row, walk)] for place, (row, walk) in enumerate(zip(gas_rows, walks, strict=True))},
    )
    if smooth:
        add("smooth", "smooth map over time and wavelength", smooth)
    spectral = []
    for (place, _), (identity, name, channels) in zip(patterns, named, strict=True):
        classes.append(Structure(identity, name, slice(total, total + channels)))
        spectral.append((place, classes[-1]))
        total += channels
    singles = [
        Structure(
            f"one_{one.id}", SINGLE_NAMES[one.id.split("_")[0]].format(name=one.name), one.columns, True
        )
        for one in classes
        if one.id.split("_")[0] in SINGLE_NAMES and one.id != "walk_gas"
    ]
    singles += [
        Structure(f"line_{one.id}", f"one line: {one.name}", one.columns, True, _line_shapes(model, place))
        for place, one in spectral
        if one.id != "pattern"
    ]
    singles += [
        Structure(
            "fringe_pattern", "fringes over wavelength, always", one.columns, True, _fringes(model, place)
        )
        for place, one in spectral
        if one.id == "pattern"
    ]
    classes = [one for one in classes if not one.id.startswith("wave")] + singles
    return tuple(classes), [own.whole() for own in products], patterns


SINGLE_NAMES = {
    "walk": "one step: {name}",
    "wave": "{name}",
    "pattern": "one channel: {name}",
    "gas": "one channel: {name}",
    "released": "one channel: {name}",
}
FRINGE_PHASES = np.arange(3) * np.pi / 3
_BANDS = (
    ("walk_pyrometer", "wandering gain of the pyrometer", (1.0, 1.0)),
    ("walk_ratio", "wandering ratio of the pyrometer", (1.0, -1.0)),
    ("walk_wide", "wandering wide band of the pyrometer", (1.0, 0.0)),
    ("walk_narrow", "wandering narrow band of the pyrometer", (0.0, 1.0)),
)


def _walk(time):
    """Steps (n, m) of a random walk of unit variance over the whole record, at most `WALK_STEPS` of them."""
    places = np.unique(np.linspace(1, time.size - 1, min(WALK_STEPS, time.size - 1)).astype(int))
    span = np.diff(np.append(time[places], time[-1] + 1.0))
    return (np.arange(time.size)[:, None] >= places[None]) * np.sqrt(span / span.sum())


def _waves(time, off):
    """Oscillations (n, m) with periods from `SHORTEST_PERIOD` to the length of the test, at three phases
    each."""
    span = max(off, 4 * SHORTEST_PERIOD)
    periods = span / np.arange(1.0, span / SHORTEST_PERIOD + 0.01, 0.5)
    phases = np.arange(3) * np.pi / 3
    angle = 2 * np.pi * time[:, None, None] / periods[:, None] + phases
    return np.sin(angle).reshape(time.size, -1)


def _fringes(model, place):
    r"""Fringes (C, b) :math:`\sin(2\pi n x + \varphi)` over the wavenumber x, 0 to 1 over the spectrum.

    From 4 fringes (slower ones are no fringes but a slope) to what the median channel can follow.
    """
    wavenumber = 1 / model.instruments[place].wavelength
    x = (wavenumber - wavenumber.min()) / np.ptp(wavenumber)
    fastest = 0.5 / np.median(np.abs(np.diff(x)))
    count = np.arange(4.0, max(fastest, 4.5), 0.5)
    angle = 2 * np.pi * x[:, None, None] * count[:, None] + FRINGE_PHASES
    return np.sin(angle).reshape(x.size, -1)


def _line_shapes(model, place):
    """Shapes (C, b) of single lines behind the slit, at the middle of each channel and between two."""
    centre = model.instruments[place].wavelength
    edges = np.concatenate([centre[:1], (centre[1:] + centre[:-1]) / 2, centre[-1:]])
    where = np.sort(np.concatenate([centre, edges[1:-1]]))
    sigma = model.library.slit_fwhm / FWHM_PER_SIGMA
    mean = np.diff(ndtr((edges[:, None] - where) / sigma), axis=0) / np.diff(edges)[:, None]
    return mean / mean.max(axis=0)


def _common_walk(instruments, off):
    """Steps (n, m) per instrument of a random walk of the brightness of the gas that all see."""
    ends = np.linspace(0.0, off, WALK_STEPS + 1)[:-1]
    return [(one.moment.mean(axis=1)[:, None] >= ends) / np.sqrt(WALK_STEPS) for one in instruments]


def _spectral_patterns(model, solution, time, value, gas):
    """Rows (n, C) of the classes of patterns over wavelength."""
    temperature = np.maximum(model.history.basis(time) @ solution.state.knots, 250.0)
    burning = time < model.off
    level = np.median(gas[burning], axis=0).mean()
    grown = -np.expm1(-np.maximum(time, 0) / 20.0)
    released = np.exp(np.clip(GROWTH * (1 - 1600.0 / temperature), -60, 2)) * ((time > 0) & burning)
    one = np.ones(value.shape[1])
    yield "pattern", "fixed pattern over wavelength", value
    yield (
        "surface_pattern",
        "pattern in the light of the surface",
        np.maximum(value - gas, 0.0) * grown[:, None],
    )
    yield "gas_pattern", "unknown light over wavelength, with the plasma", gas.mean(axis=1)[:, None] * one
    yield (
        "released_pattern",
        "unknown light over wavelength, with a hot surface",
        released[:, None] * level * one,
    )


def _smooth(model, one):
    """Waves (w, C) over the channels of a spectrometer and, for each, shares (n, m) of the columns of a
    smooth map: hats in time."""
    time = np.clip(one.moment.mean(axis=1), -20, None)
    x = np.clip((one.wavelength - one.wavelength[0]) / (one.wavelength[-1] - one.wavelength[0]), 0, 1)
    waves = np.cos(np.pi * np.arange(1, MAP_WAVES + 1)[:, None] * x)
    places = np.array([-10.0, 3.0, 10.0, 25.0, 60.0, 150.0, model.off - 1, model.off + 5, model.off + 30])
    hats = np.stack([np.interp(time, places, row) for row in np.eye(places.size)], axis=1)
    return waves, [np.kron(own, hats) for own in np.eye(MAP_WAVES)]


def screen(model, solution, exclude=(), structures=True):
    """Score and information of all candidates and structures, base parameters projected out.

    Parameters
    ----------
    model : Model
    solution : Solution
    exclude : ids of terms that are not looked for
    structures : bool
        Whether unknown structures are looked for as well.

    Returns
    -------
    Screen
    """
    candidates, columns = columns_of_candidates(model, solution, exclude)
    classes, patterns, products, more = (), [], None, 0
    if structures:
        classes, products, patterns = structures_of(model, solution)
        more = products[0][1].shape[2]
    fitted = solution.jacobian[0].shape[2]
    dense = [np.concatenate(parts, axis=2) for parts in zip(solution.jacobian, columns, strict=True)]
    mine = own_patterns(model.instruments, solution.plain, solution.gas)
    matrix, vector = gram(dense, [*mine, *patterns], solution.weighers, solution.residual, products)
    tests = dense[0].shape[2] - fitted + more
    base_patterns = sum(row.shape[1] for _, row in mine)
    first = fitted + tests
    base = np.r_[0:fitted, first : first + base_patterns]
    rest = np.r_[fitted:first, first + base_patterns : matrix.shape[0]]
    cross = matrix[np.ix_(base, rest)]
    own = matrix[np.ix_(rest, rest)]
    carried = cho_solve(solution.factor, cross)
    projected = own - cross.T @ carried
    projected = (projected + projected.T) / 2
    plain = np.diag(own)
    left = np.diag(projected) / np.where(plain > 0, plain, np.inf)
    # What the fit has left undone is none of the others' business.
    score = vector[rest] - carried.T @ solution.score
    return Screen(candidates, classes, score, projected, left, carried[: model.size, : len(candidates)])


def angles(information):
    """Angles (m, m) [degrees] between directions in the metric of the data, 90 where one is invisible."""
    length = np.sqrt(np.maximum(np.diag(information), 0))
    safe = np.where(length > 0, length, np.inf)
    cosine = np.abs(information) / np.outer(safe, safe)
    return np.degrees(np.arccos(np.clip(cosine, 0, 1)))


class Unknowns:
    """Log Bayes factors of the classes of unknown structures, for one or many scores."""

    def __init__(self, found):
        self.parts = []
        for structure in found.structures:
            place = slice(found.count + structure.columns.start, found.count + structure.columns.stop)
            if structure.basis is not None:
                kept = structure.basis * (found.left[place] > LEAST_LEFT)[:, None]
                value = np.einsum("cb,cd,db->b", kept, found.information[place, place], kept)
                self.parts.append((place, value, kept, True))
            elif structure.single:
                value = np.where(found.left[place] > LEAST_LEFT, np.diag(found.information)[place], 0.0)
                self.parts.append((place, value, None, True))
            else:
                value, vector = eigh(found.information[place, place])
                good = value > 1e-10 * max(value.max(), 1e-300)
                self.parts.append((place, value[good], vector[:, good], False))

    def __call__(self, scores):
        """Log Bayes factors (..., classes) of scores (..., m): the best scale, less the price of having
        tried."""
        result = []
        for place, value, vector, single in self.parts:
            q = scores[..., place] if vector is None else scores[..., place] @ vector
            best = np.full(scores.shape[:-1], -np.inf)
            for scale in SCALES:
                loss, won = np.log1p(scale**2 * value), q**2 / (value + scale**-2)
                if single:
                    log_bayes = 0.5 * np.max(np.where(value > 0, won - loss, 0.0), axis=-1) - np.log(
                        value.size
                    )
                else:
                    log_bayes = 0.5 * np.sum(won, axis=-1) - 0.5 * np.sum(loss)
                best = np.maximum(best, log_bayes)
            result.append(best - np.log(len(SCALES)))
        return np.stack(result, axis=-1)

    def gains_beside(self, found, which):
        """Chi-squared gained by each candidate (candidates,) when the unknown structure `which` is there too.

        A structure with a Gaussian prior of its best scale joins the covariance; of a class of single columns
        the best column does.
        """
        place, value, vector, single = self.parts[which]
        score = found.score[place] if vector is None else vector.T @ found.score[place]
        cross = found.information[: found.count, place]
        cross = cross if vector is None else cross @ vector
        worth = []
        for scale in SCALES:
            loss, won = np.log1p(scale**2 * value), score**2 / (value + scale**-2)
            each = 0.5 * np.where(value > 0, won - loss, 0.0)
            worth.append(each.max() if single else each.sum())
        inverse = SCALES[int(np.argmax(worth))] ** -2.0
        if single:
            kept = int(np.argmax(np.where(value > 0, score**2 / (value + inverse), 0.0)))
            score, value, cross = score[[kept]], value[[kept]], cross[:, [kept]]
        own = np.diag(found.information)[: found.count]
        less = own - np.sum(cross**2 / (value + inverse), axis=1)
        rest = found.score[: found.count] - cross @ (score / (value + inverse))
        share = found.left[: found.count] * less / np.where(own > 0, own, np.inf)
        return gain(rest, less, share)


def simulated(found, draws, generator):
    """Scores (draws, m) if nothing were wrong: normal with the information as covariance."""
    alive = (found.left > LEAST_LEFT) & (np.diag(found.information) > 0)
    length = np.sqrt(np.where(alive, np.diag(found.information), 1.0))
    relative = np.where(alive[:, None] & alive[None], found.information / np.outer(length, length), 0.0)
    relative[np.diag_indices_from(relative)] = 1 + ROUNDING
    length = np.where(alive, length, 0.0)
    root = cholesky(relative, lower=True, check_finite=False)
    return (generator.standard_normal((draws, length.size)) @ root.T) * length
