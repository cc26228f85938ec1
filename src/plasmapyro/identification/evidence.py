r"""Evidence for a species: its lines among the peaks of a spectrum, against chance.

Peaks that have nothing to do with a species lie anywhere (:math:`\rho` per metre, as many as there are
around) and have any strength. A line of a species that is there gives a peak at its place, within its error,
as strong as the Boltzmann distribution makes it within a factor :math:`e^{\pm s}`, or none where it would not
stand out. For the peaks :math:`k` of its lines and the lines :math:`l` without a peak

.. math:: \ln B = \ln \left\langle \prod_k \frac{\rho\,f(\ln h_k) + N(\lambda_k; \lambda, s_\lambda)\,
   N(\ln h_k; \ln m_k, s)}{\rho f(\ln h_k)} \prod_l P(h < h_{min} | m_l) \right\rangle

averaged over amount, temperature of excitation and optical depth. What species already named explain of a
peak, on the same average, belongs to the chance side, so that all are judged together. The logarithm of the
factor of a faint peak counts by the share to which it is believed (`BELIEVED`), nothing at the limit of
detection: a line that noise lifts above the limit in one spectrum and not in the next changes little.
"""

from copy import copy
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product

import numpy as np
from scipy.special import log_ndtr

TEMPERATURES = (2500.0, 4500.0, 8000.0, 13000.0)  # [K]
DEPTHS = (0.1, 10.0, 200.0)  # of the line of most optical depth
SETTINGS = tuple(product(TEMPERATURES, DEPTHS))
STEP, ABOVE = 0.7, 3.0  # of ln(amount), and the span above the strongest peak
REGION = 60e-9  # [m] over which the response of an instrument hardly changes
LOST = 0.02  # share of lines that are missing against expectation: wrong probability, dead pixels
TOLERANCE = 0.7  # scatter of ln(strength) of a line about its expectation
ODD, ODD_WIDER = 0.15, 3.0  # share of lines, and of chance peaks, with a scatter so many times larger
BRIGHT = 0.1  # the same share above expectation: absorption and neighbours take light, little adds any
STARK = 0.2  # shift of a line broadened by electrons, of its width; Griem has 0.1 to 0.5
KERNEL = 1.0  # of ln(strength), over which the strengths of the peaks around are smoothed
ANY = 0.05  # density of ln(strength) of one peak more than those around, which may have any
SPREAD = 0.05  # least density of chance peaks, per width of a sharp line
HOLE = 6e-9  # [m] longer clipped stretches are blind
DOUBTFUL = -2.0, 30.0  # log evidence at which it is asked how many peaks a species leaves to chance
AROUND = 12e-9  # [m] within which peaks tell how many there are by chance
THICK = 0.03  # of the brightest peak: least light of a line that absorbs itself; zones differ in temperature
BELIEVED = 4.0, 7.0  # standard deviations of a peak from which it speaks, and speaks in full
FAINT = 1e-3  # lines below this share of the strongest of their species are left out


def _absent(short):
    """Log probability that a line is not seen whose light is below the limit by `short`, in logarithms."""
    seen = np.logaddexp(
        np.log1p(-ODD) + log_ndtr(short / TOLERANCE), np.log(ODD) + log_ndtr(short / (ODD_WIDER * TOLERANCE))
    )
    return np.minimum(np.logaddexp(np.log(LOST), np.log1p(-LOST) + seen), 0.0)


SHORT, FINE = -15.0, 0.01  # least shortness of the table, and its step
ABSENT = _absent(np.arange(SHORT, 10.0, FINE))


@lru_cache(maxsize=512)
def _lights(species, settings):
    """Light (settings, L) of the lines of a species, which the scenes of a spectrum ask for again."""
    return np.array([species.light(*setting) for setting in settings])


@dataclass(frozen=True)
class Explained:
    """What a species makes of the peaks: expected light (P,) and the place [m] it expects them at."""

    light: np.ndarray
    place: np.ndarray


NOTHING = Explained(0.0, 0.0)


class Fit:
    """Evidence of a species, and what it makes of the peaks.

    Attributes
    ----------
    log_bayes : float
        Natural logarithm of the Bayes factor for it.
    temperature, depth : float
        Those of most likelihood [K], [1].
    explained : Explained
        Of the peaks, on average over amounts, settings and responses; as the two below made when asked for.
    matched : ndarray of int
        Peaks of its lines, those that speak for it.
    shift : ndarray [m]
        Peak less line, for each of these.
    """

    def __init__(self, log_bayes, temperature, depth, explain):
        self.log_bayes, self.temperature, self.depth, self._explain = log_bayes, temperature, depth, explain

    @cached_property
    def _all(self):
        return self._explain()

    def less(self, lost):
        """The same with less evidence."""
        return Fit(self.log_bayes - lost, self.temperature, self.depth, self._explain)

    explained = property(lambda self: self._all[0])
    matched = property(lambda self: self._all[1])
    shift = property(lambda self: self._all[2])


class Scene:
    """Peaks, what is chance among them, and where and how strong lines are expected.

    Parameters
    ----------
    peaks : Peaks
    response : float [1]
        Standard deviation of ln(response of the instrument) from one `REGION` to another.
    shift : callable
        Wavelength (n,) [m] -> what the scale of the spectrum is too high by [m] there.
    place : float [1]
        Error of a position in widths of a sharp line.
    settings : sequence of (temperature [K], optical depth)
    """

    def __init__(self, peaks, response, shift, place, settings=SETTINGS):
        self.peaks, self.response, self.shift, self.settings = peaks, response, shift, settings
        at = peaks.wavelength
        self.log = np.log(peaks.light)
        # Few settings, all of absorbed light, stand for all depths where the scale is sought.
        self.thick = THICK * peaks.light.max() if settings is SETTINGS else 0.0
        highest, lowest = self.log.max() + ABOVE, np.log(np.quantile(peaks.light, 0.1)) - 1
        self.amount = np.exp(np.arange(highest, lowest, -STEP))[:, None, None]
        slit = np.interp(at, peaks.axis, peaks.slit)
        self.chance = self._chance(np.ones(at.size))
        self.believed = np.clip((peaks.snr - BELIEVED[0]) / (BELIEVED[1] - BELIEVED[0]), 0.0, 1.0)
        self.error = np.hypot(place * slit, STARK * (peaks.width - slit))
        self.expected = {}  # of species: what does not depend on the others
        self.fits = {}  # of species: what others explained of its peaks when it was fitted last, and the fit

    def counted(self, by_chance):
        """The same, its chance counted by what probability (P,) a peak has to be there by chance."""
        scene = copy(self)
        scene.chance, scene.fits = scene._chance(by_chance), {}
        return scene

    def _chance(self, known):
        """Density of the peaks (P,) by chance [m-1], counted by peaks of weights `known`; how strong such
        peaks are say the others: none is chance because it is there itself."""
        at, axis = self.peaks.wavelength, self.peaks.axis
        slit = np.interp(at, axis, self.peaks.slit)
        seen = np.diff(axis) * _open(self.peaks)[1:]
        reach = np.concatenate([[0.0], np.cumsum(seen)])
        reach = np.interp(at + AROUND, axis, reach) - np.interp(at - AROUND, axis, reach)
        wide = (np.abs(at[:, None] - at) < REGION) * known
        np.fill_diagonal(wide, 0.0)
        alike = np.sum(wide * _normal(self.log[:, None], self.log, KERNEL), axis=1)
        self.alike = (alike + ANY) / (wide.sum(axis=1) + 1)
        self.known, self.least = known, SPREAD / slit
        self.around = (np.abs(at[:, None] - at) < AROUND) / np.maximum(reach, slit)[:, None]
        return self.alike * np.maximum(self.around @ known, self.least)

    def _beside(self, fit):
        r"""Density of the peaks (P,) by chance [m-1] beside those of a species, as its fit tells them.

        Of :math:`n` peaks around :math:`k` are its own. Chance of an unknown rate (exponential prior)
        makes :math:`n` instead of :math:`n - k` as :math:`n!/(n - k)! \approx (n - (k - 1)/2)^k` to one.
        """
        own = self.known * (1 - self.chance / self.without(fit.explained)) / 2
        count = self.around @ (self.known - own) + np.diag(self.around) * own
        return self.alike * np.maximum(count, self.least)

    def without(self, explained, chance=None):
        """Density of the peaks (P,) by chance or by what is explained [m-1]."""
        chance = self.chance if chance is None else chance
        if explained is NOTHING:
            return chance
        own = self._strength(self.log, explained.light)
        return chance + own * _normal(self.peaks.wavelength, explained.place, self.error)

    @staticmethod
    def _strength(log, expected):
        """Density of ln(strength) of lines about their expectation, with tails."""
        with np.errstate(divide="ignore"):
            off = log - np.log(expected)
        odd = np.where(off > 0, BRIGHT, ODD)
        return (1 - odd) * _normal(off, 0.0, TOLERANCE) + odd * _normal(off, 0.0, ODD_WIDER * TOLERANCE)

    def near(self, species):
        """Peaks (G,) that lines of a species lie beside."""
        if species not in self.expected:
            self.expected[species] = self._expect(species)
        expected = self.expected[species]
        return np.zeros(0, int) if expected is None else expected[0]

    def fit(self, species, others=NOTHING):
        """Evidence of a species, given what others explain.

        Parameters
        ----------
        species : Species
            Its lines of the range of the spectrum.
        others : Explained

        Returns
        -------
        Fit or None
            None where no line lies beside a peak.
        """
        groups = self.near(species)
        expected = self.expected[species]
        if expected is None:
            return None
        beside = np.zeros((2, groups.size))
        if others is not NOTHING:
            beside[:] = others.light[groups], others.place[groups]
        known = self.fits.get(species)  # most of what is named has no line among these peaks
        if known is None or not np.array_equal(known[0], beside):
            fit = self._fit(species, expected, others, beside, self.chance)
            if self.settings is SETTINGS and DOUBTFUL[0] < fit.log_bayes < DOUBTFUL[1]:
                fit = self._fit(species, expected, others, beside, self._beside(fit))
            known = self.fits[species] = beside, fit
        return known[1]

    def _fit(self, species, expected, others, before, chance):
        """As `fit`; `before` (2, G): light and place of what others explain of its peaks; `chance` (P,)."""
        peaks, groups, own, place, (lost, absent), prior = self.peaks, *expected
        total = own + before[0]
        centre = (own * place + before[0] * before[1]) / np.maximum(total, 1e-300)
        sigma = np.hypot(self.error[groups], species.error)
        there = self._strength(self.log[groups], total) * _normal(peaks.wavelength[groups], centre, sigma)
        gain = np.log((chance[groups] + (1 - LOST) * there) / self.without(others, chance)[groups])
        gain = self.believed[groups] * gain
        regions = (np.concatenate([peaks.wavelength[groups], lost]) / REGION).astype(int)
        score, shares = self._over_regions(regions, np.concatenate([gain, absent], axis=2), prior)
        a, s = np.unravel_index(score.argmax(), score.shape)

        def explain():
            share = shares()[:, :, : groups.size]
            light = share * own
            full, where = np.zeros((2, peaks.light.size))
            full[groups] = light.sum(axis=(0, 1))
            where[groups] = (light * place).sum(axis=(0, 1)) / np.maximum(full[groups], 1e-300)
            for_it = (share * gain).sum(axis=(0, 1)) > 0.5
            return Explained(full, where), groups[for_it], (peaks.wavelength - where)[groups][for_it]

        log_bayes = np.log(np.mean(np.exp(score - score[a, s]))) + score[a, s]
        return Fit(float(log_bayes), *self.settings[s], explain)

    def _expect(self, species):
        """Peaks of a species (G,), its light (amounts, settings, G) and place of it (settings, G) in them,
        log probability (amounts, settings, M) that lines without a peak are not seen, and that of amount
        and setting; or None. A line that absorbs itself shines as a black body does: it is not faint."""
        peaks = self.peaks
        light = _lights(species, self.settings)
        keep = (light > FAINT * light.max(axis=1, keepdims=True)).any(axis=0)
        line, light = species.wavelength[keep], light[:, keep]
        line = line + self.shift(line)
        nearest = _nearest(peaks.wavelength, line)
        away = np.abs(line - peaks.wavelength[nearest])
        hit = away < 3 * np.hypot(self.error[nearest], species.error)
        if not hit.any():
            return None
        groups, index = np.unique(nearest[hit], return_inverse=True)
        sums, place = np.zeros((2, len(light), groups.size))
        np.add.at(sums.T, index, light[:, hit].T)
        np.add.at(place.T, index, (light[:, hit] * line[hit]).T)
        place = np.where(sums > 1e-250, place / np.maximum(sums, 1e-250), peaks.wavelength[groups])
        where, blind, missed = self._unseen(line[~hit], light[:, ~hit])
        amount = self.amount
        with np.errstate(divide="ignore"):
            short = np.log(blind) - np.log(missed) - np.log(amount)
            brightest = np.log(amount[:, :, 0] * light.max(axis=1)) - np.log(self.thick)
        prior = np.where(np.array(self.settings)[:, 1] > 1, np.minimum(2 * brightest, 0.0), 0.0)
        row = np.clip((short - SHORT) / FINE, 0, ABSENT.size - 1).astype(np.int32)
        return groups, amount * sums, place, (where, ABSENT[row]), prior

    def _over_regions(self, regions, parts, prior):
        """Sum (amounts, settings) of log probabilities (amounts, settings, lines) and a `prior`, each region
        with a response of its own; and what makes of each line the share (amounts, settings, lines) that an
        amount there and a setting have in it."""
        rows = np.arange(parts.shape[0])
        apart = (rows[:, None] - rows) * STEP / self.response
        weight = np.exp(-(apart**2) / 2) / (self.response / STEP * np.sqrt(2 * np.pi))
        order = np.argsort(regions, kind="stable")
        _, first, region = np.unique(regions[order], return_index=True, return_inverse=True)
        own = np.add.reduceat(parts[:, :, order], first, axis=2)
        top = own.max(axis=(0, 1))
        own = np.exp(own - top)
        mean = np.maximum(np.tensordot(weight, own, axes=1), 1e-300)
        total = np.sum(top + np.log(mean), axis=2) + prior

        def shares():
            whole = np.exp(total - total.max())
            whole = (whole / whole.sum())[:, :, None]
            share = own * np.tensordot(weight.T, whole / mean, axes=1)
            return share[:, :, region[np.argsort(order)]]

        return total, shares

    def _unseen(self, line, light):
        """Places (M,), limits (M,) and light (settings, M) of lines without a peak, one for each width."""
        if not line.size:
            return np.zeros(0), np.ones(0), np.zeros((len(light), 0))
        width = np.interp(line, self.peaks.axis, self.peaks.slit)
        group = np.cumsum(np.concatenate([[0], np.diff(line) > 0.7 * width[1:]])).astype(int)
        sums = np.zeros((len(light), group[-1] + 1))
        np.add.at(sums.T, group, light.T)
        limits = np.zeros(group[-1] + 1)
        np.maximum.at(limits, group, np.interp(line, self.peaks.axis, self.peaks.limit))
        return line[np.searchsorted(group, np.arange(limits.size))], limits, sums


def _open(peaks):
    """Where (N,) a record may hold peaks by chance: not in long clipped stretches, which are blind, but in
    short ones, where only what is broad has sunk below zero between two lines."""
    clipped = np.concatenate([[0], ~np.isfinite(peaks.limit), [0]]).astype(int)
    first, last = (np.flatnonzero(np.diff(clipped) == sign) for sign in (1, -1))
    result = np.ones(peaks.axis.size, bool)
    for begin, end in zip(first, last, strict=True):
        result[begin:end] = peaks.axis[end - 1] - peaks.axis[begin] < HOLE
    return result


def together(explained):
    """What several species explain, as one."""
    explained = list(explained)
    if not explained:
        return NOTHING
    light = sum(part.light for part in explained)
    place = sum(part.light * part.place for part in explained) / np.maximum(light, 1e-300)
    return Explained(light, place)


def _normal(value, mean, sigma):
    return np.exp(-(((value - mean) / sigma) ** 2) / 2) / (np.sqrt(2 * np.pi) * sigma)


def _nearest(sorted_values, wanted):
    right = np.clip(np.searchsorted(sorted_values, wanted), 1, sorted_values.size - 1)
    return right - (wanted - sorted_values[right - 1] < sorted_values[right] - wanted)
