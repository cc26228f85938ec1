"""Which species a spectrum shows: named one after the other, judged together."""

from dataclasses import dataclass, replace

import numpy as np

from plasmapyro.identification.evidence import NOTHING, Fit, Scene, together
from plasmapyro.identification.peaks import Peaks, find, one_detector
from plasmapyro.identification.species import AIR, catalogue

COMMON = tuple("H C N O Na K Li Rb Cs Mg Ca Sr Ba Al Si Ti Cr Mn Fe Ni Cu Zn CN C2 OH AlO".split())
ANYWHERE = ("Na", "K", "Ca", "Mg")  # traces on whatever was touched, with few lines, hard to miss
PRIOR, PRIOR_COMMON, PRIOR_ANYWHERE, PRIOR_AIR = 0.001, 0.05, 0.3, 0.5  # that a species shows lines
PRIOR_OTHER_STAGE = 0.3
NAMED = 0.9  # probability from which a species counts as certain beside others
LEAST = np.log(NAMED / (1 - NAMED))
PERHAPS = np.log(2.0)  # log odds from which one that is not certain is listed, beside those that are
SHARED = 0.5  # least share of the peaks of a species that a rival explains too
ALIKE = 3.0  # difference of log evidence below which two species are not told apart
CALIBRATED, UNCALIBRATED = 0.2, 1.2  # scatter of ln(response) between regions of a spectrum
QUICK = ((4000.0, 5.0), (9000.0, 50.0))
SHIFTS = np.arange(-3.0, 3.01, 0.5)  # of the wavelength scale, in widths of a line
# ASSUME: however wide its slit, a spectrometer is off by less; of eight wide lines some fit at any shift.
FARTHEST = 3e-9  # [m]
PLACES = (0.5, 0.35, 0.25, 0.17)  # error of a position in widths of a line while the scale is being found
EXPLAINED = 0.05  # least share of a peak that is there by chance, however well it is explained
PLACE = 0.12  # and after
CLEAR = 5.0  # standard deviations of peaks that tell the scale, and of lines that nobody knows
ELSEWHERE = tuple(1 + side * (0.0035 + 0.001 * step) for side in (-1, 1) for step in range(12))
RAREST = 1.5  # log evidence, the most that this may speak for a species
CERTAIN = 30.0  # log evidence from which chance is not asked
SEEN = 1.5  # log evidence from which a species tells the scale
TELLING = 6.9  # log evidence of the species that tells it best: a thousand to one, else all species are asked
NEIGHBOURS = 40e-9  # [m] over which the error of a wavelength scale changes


@dataclass(frozen=True)
class Named:
    """A species with its probability.

    Attributes
    ----------
    species : Species
    probability : float
    fit : Fit
        Given all others that are named.
    rivals : tuple of str
        Species that would explain the same peaks about as well ("one of these").
    """

    species: object
    probability: float
    fit: Fit
    rivals: tuple


@dataclass(frozen=True)
class Answer:
    """What a spectrum shows.

    Attributes
    ----------
    named : tuple of Named
        Strongest evidence first; odds of two and more each, unless it has rivals.
    peaks : Peaks
    unexplained : ndarray of int
        Peaks that none of these species explains and that noise does not make (`CLEAR`).
    scale : Scale
        What the wavelengths are too high by.
    """

    named: tuple
    peaks: Peaks
    unexplained: np.ndarray
    scale: object


def identify(axis, signal, noise=None, slit=None, calibrated=False):
    """`Answer` with the species whose lines or bands a spectrum shows.

    Parameters
    ----------
    axis : ndarray (N,) [m]
        Wavelengths in air, ascending.
    signal, noise, slit
        See `peaks.find`.
    calibrated : bool
        Whether the signal is proportional to radiance at all wavelengths.
    """
    axis, signal, *noise = one_detector(axis, signal, *([] if noise is None else [noise]))
    peaks = find(axis, signal, *(noise or [None]), slit)
    if peaks.wavelength.size < 2:
        return Answer((), peaks, np.arange(peaks.wavelength.size), Scale(0.0))
    response = CALIBRATED if calibrated else UNCALIBRATED
    margin = 2 * peaks.slit.max()
    inside = [one.between(axis[0] + margin, axis[-1] - margin) for one in catalogue()]
    inside = [one for one in inside if one is not None]
    anchors = [one for one in inside if one.element in COMMON + AIR]
    clear = _clear(peaks)
    scale, told = _scale(clear, response, anchors)
    if not told:  # a lamp, say: none of the common species shines
        scale, _ = _scale(clear, response, inside)
    scene = Scene(peaks, response, scale, PLACE)
    known = together(fit.explained for fit in _named(scene, inside).values())
    # Again, chance counted by the peaks that are left: those of a named species are no coincidences.
    weight = np.maximum(scene.chance / scene.without(known), EXPLAINED)
    scene, chance = scene.counted(weight), {}
    sure = _named(scene, inside, chance=chance)
    listed = _named(scene, inside, least=PERHAPS, chance=chance, given=sure)
    return _answer(scene, inside, listed, chance)


@dataclass(frozen=True)
class Scale:
    """Error of a wavelength scale: that of the lines around, and `mean` [m] where there are none.

    Attributes
    ----------
    mean : float [m]
    wavelength, off, error : ndarray (n,) [m]
        Of lines that were found.
    """

    mean: float
    wavelength: np.ndarray = ()
    off: np.ndarray = ()
    error: np.ndarray = ()

    def __call__(self, wavelength):
        if not len(self.off):
            return np.full(np.shape(wavelength), self.mean)
        distance = (np.asarray(wavelength)[..., None] - self.wavelength) / NEIGHBOURS
        weight = np.exp(-(distance**2) / 2) / np.square(self.error)
        least = 1 / np.median(self.error) ** 2  # as much as one line
        return (least * self.mean + weight @ self.off) / (least + weight.sum(axis=-1))

    def refined(self, scene, fits):
        """The scale from the lines of named species; those off by three deviations are left out."""
        if not fits:
            return self
        at = np.concatenate([scene.peaks.wavelength[fit.matched] for fit in fits.values()])
        off = np.concatenate([fit.shift for fit in fits.values()])
        error = np.concatenate([np.hypot(scene.error[f.matched], one.error) for one, f in fits.items()])
        if at.size < 3:
            return self
        off = off + self(at)
        for _ in range(3):
            found = Scale(float(np.median(off)), at, off, error)
            close = np.abs(off - found(at)) < 3 * error
            at, off, error = at[close], off[close], error[close]
        return found


def _clear(peaks):
    """The peaks that tell the scale: faint ones are many, and one taken for a line bends it."""
    sure = peaks.snr > CLEAR
    if sure.sum() < 2:
        return peaks
    kept = {name: getattr(peaks, name)[sure] for name in ("wavelength", "light", "width", "snr")}
    return replace(peaks, **kept)


def _scale(peaks, response, species):
    """The scale that suits the lines of species, and whether any of them told it."""
    scale, told = _offset(peaks, response, species), {}
    for place in PLACES:
        scene = Scene(peaks, response, scale, place, QUICK)
        told = _named(scene, species, _evidence, least=SEEN)
        scale = scale.refined(scene, told)
    return scale, max((fit.log_bayes for fit in told.values()), default=0.0) > TELLING


def _offset(peaks, response, species):
    """The constant shift under which species together find most lines, as a Scale."""
    width = np.median(peaks.slit)
    shifts = SHIFTS[np.abs(SHIFTS) * width < FARTHEST]
    scales = [Scale(shift * width) for shift in shifts]
    score = []
    for scale in scales:
        scene = Scene(peaks, response, scale, PLACES[0], QUICK)
        fits = [scene.fit(one) for one in species]
        score.append(sum(max(fit.log_bayes - 3.0, 0.0) for fit in fits if fit))
    return scales[int(np.argmax(np.array(score) - shifts**2 / 2))]


def _by_chance(scene, one, others):
    r"""Logarithm of the evidence that the lines of a species have where they are not.

    .. math:: \ln \frac{1 + \sum_k B(\lambda (1 + x_k))}{1 + K}

    of K shifts :math:`x_k` of all its lines together (`ELSEWHERE`): many lines among many peaks agree by
    chance. A factor that is one on average where nothing is there needs no correction.
    """
    moved = (replace(one, wavelength=one.wavelength * factor) for factor in ELSEWHERE)
    fits = [scene.fit(other, others) for other in moved]
    scores = [fit.log_bayes for fit in fits if fit]
    return max(float(np.logaddexp.reduce([0.0, *scores]) - np.log(1 + len(ELSEWHERE))), -RAREST)


def _log_odds(one, fit, fits):
    """Logarithm of the odds of a species beside those named."""
    chance = PRIOR_COMMON if one.element in COMMON else PRIOR
    if one.element in AIR + ANYWHERE:
        chance = PRIOR_AIR if one.element in AIR else PRIOR_ANYWHERE
    elif any(other.element == one.element and other is not one for other in fits):
        chance = PRIOR_OTHER_STAGE
    return fit.log_bayes + np.log(chance / (1 - chance)) if fit else -np.inf


def _evidence(_one, fit, _fits):
    """Log odds without a prior, to find the scale by."""
    return fit.log_bayes


def _named(scene, species, log_odds=_log_odds, least=LEAST, chance=None, given=None):
    """Species named one after the other: species -> fit, each given the others.

    `chance`: mapping to be filled, species -> `_by_chance` where it was asked for. `given`: such a mapping of
    those that are named already and stay as they are.
    """
    given = given or {}
    fits = dict(given)
    waiting = [one for one in species if one not in given]
    chance = {} if chance is None else chance
    judged = log_odds is _log_odds
    while waiting:
        others = together(fit.explained for fit in fits.values())
        odds = {}
        for one in waiting:
            fit = scene.fit(one, others)
            odds[one] = (log_odds(one, fit, fits) if fit else -np.inf, fit)
        waiting = [one for one in waiting if odds[one][0] > -4.0]  # explained peaks only take evidence away
        best = max(waiting, key=lambda one: odds[one][0], default=None)
        if best is None or (not judged and odds[best][0] < least):
            return fits
        waiting.remove(best)
        found, fit = odds[best]
        if judged and found < least:
            fit = _before(scene, best, fits)
            found = max(found, log_odds(best, fit, fits))
        if judged and found >= least - RAREST and best not in chance and fit.log_bayes < CERTAIN:
            chance[best] = _by_chance(scene, best, others)
        if found - chance.get(best, 0.0) < least:
            continue
        fits[best] = fit
        for one in [one for one in fits if one not in given]:  # again, each beside the others
            others = together(fit.explained for other, fit in fits.items() if other is not one)
            fits[one] = scene.fit(one, others)
            if log_odds(one, fits[one], fits) - chance.get(one, 0.0) < least:
                del fits[one]
    return fits


def _before(scene, one, fits):
    r"""The fit of a species named before those whose peaks it shares, with the evidence that it brings so.

    Of the species :math:`a` and others :math:`b` it is :math:`\ln B(a) + \ln B(b|a) - \ln B(b)`, which would
    be :math:`\ln B(a|b)` if :math:`b` were not held to what it explains without :math:`a`.
    """
    near = scene.near(one)
    shared = [other for other, fit in fits.items() if np.isin(fit.matched, near).any()]
    fit = scene.fit(one, together(fit.explained for other, fit in fits.items() if other not in shared))
    lost = 0.0
    for other in shared:
        beside = [f.explained for key, f in fits.items() if key is not other]
        lost += scene.fit(other, together(beside)).log_bayes
        lost -= scene.fit(other, together([*beside, fit.explained])).log_bayes
    return fit.less(lost)


def _shared(fit, peaks):
    """Whether at least the share `SHARED` of the peaks of a species is among these."""
    return fit.matched.size > 0 and np.isin(fit.matched, peaks).mean() >= SHARED


def _answer(scene, species, fits, chance):
    """Probabilities, rivals and what remains."""
    named = []
    for one, fit in fits.items():
        others = together(
            other for key, other in ((k, f.explained) for k, f in fits.items()) if key is not one
        )
        own = _log_odds(one, fit, fits) - chance.get(one, 0.0)
        beside = {}
        for other in species:
            if other.element != one.element and other not in fits:
                if not _shared(fit, scene.near(other)):  # most have no line there: they need no fit
                    continue
                rival = scene.fit(other, others)
                if _shared(fit, rival.matched):
                    beside[other.name] = _log_odds(other, rival, fits)
        rivals = tuple(name for name, odds in beside.items() if odds > max(own - ALIKE, 0.0))
        weights = np.logaddexp.reduce([0.0, own, *(beside[name] for name in rivals)])
        named.append(Named(one, float(np.exp(own - weights)), fit, rivals))
    named.sort(key=lambda item: -item.fit.log_bayes)
    light = together(fit.explained for fit in fits.values())
    seen = np.zeros(scene.peaks.wavelength.size, bool)
    if light is not NOTHING:
        seen = scene.without(light) > 2 * scene.chance
    left = ~seen & (scene.peaks.snr > CLEAR)
    return Answer(tuple(named), scene.peaks, np.flatnonzero(left), scene.shift)
