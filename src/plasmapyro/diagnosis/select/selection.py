"""Which effects the data ask for, which others they do not tell from them, and how certain that is."""

from dataclasses import dataclass, replace

import numpy as np

from plasmapyro import progress
from plasmapyro.diagnosis.fit.inference import Solution
from plasmapyro.diagnosis.fit.setting import FORMULA
from plasmapyro.diagnosis.select.alternatives import by_other_window, by_pair
from plasmapyro.diagnosis.select.bent import bent
from plasmapyro.diagnosis.select.prices import MARGIN, outdone
from plasmapyro.diagnosis.select.probability import PRIOR_NONE, prior_share
from plasmapyro.diagnosis.select.reserve import BEATEN, reserve
from plasmapyro.diagnosis.select.rounds import left, walk
from plasmapyro.diagnosis.select.screen import LEAST_LEFT, angles, best_by_id, screen
from plasmapyro.diagnosis.select.search import Search
from plasmapyro.diagnosis.select.structures import may_be_gas, multiplies, seen_by
from plasmapyro.diagnosis.select.thresholds import Thresholds, calibrated
from plasmapyro.diagnosis.select.unknowns import Unknowns

ALIKE = 9.2  # chi-squared by which the data tell two effects apart: 99 % of two degrees of freedom
CLEAR, TINY = 20.0, 1e-300  # standard deviations of an effect that no structure is taken for by chance
MOST_STEPS = 150  # of a walk that is held against a change along the signal
SAME_ANGLE, ALIKE_ANGLE = 15.0, 45.0  # [degree] below which two are one class, or may explain the same


def in_bands(identity):
    """Whether a class of structures lies in the pyrometer alone."""
    return seen_by(identity)["instrument"] == "pyrometer"


@dataclass(frozen=True)
class Selection:
    """The outcome: rounds, the effects and their fit, who could stand in for each, and what remains."""

    steps: tuple
    final: Solution
    sets: tuple  # per effect, ids of the candidates that explain the same, itself first
    trials: dict  # id -> log evidence of its refit as the first effect
    status: str
    unknown_class: str | None
    thresholds: Thresholds
    effects: dict  # that were looked for
    reserve: str = ""  # why the names are not certain, see `reserve`
    evidence: float = 0.0  # log Bayes factor of the final over the base fit
    faulty: frozenset | None = None  # instruments that show something alone; None if that was not asked

    def unnamed(self):
        """The same without names: something is wrong, and the effects found are not what it is; or nothing
        is, if they are little more than chance may reach and no structure is there either."""
        first, limits, unknown = self.steps[0], self.thresholds, self.unknown_class
        if first.unknown.max() > limits.unknown or np.max(first.gains, initial=0.0) > limits.third:
            unknown = unknown or self._behind()
        return replace(
            self,
            steps=(first,),
            final=first.solution,
            sets=(),
            status="unknown" if unknown else "null",
            unknown_class=unknown,
            reserve="",
            evidence=0.0,
        )

    @property
    def outweighs_unknown(self):
        """Whether something is there beyond chance, and the names explain it clearly better than any
        structure does: where gains may wander, blocks left out foretell themselves as well without a name."""
        most = float(self.steps[0].unknown.max())
        return most > self.thresholds.unknown and self.evidence > most + MARGIN

    @property
    def suspect(self):
        """Id of the structure that says where something unknown is: of what is left, or of what names with
        reserve explain; None where nothing is unknown. What a wrong name leaves says little of it, unless it
        is in the instrument that alone shows something."""
        if self.status != "named+unknown":
            return self.unknown_class
        alone = self.faulty if self.faulty is not None and len(self.faulty) < 2 else None
        if not self.unknown_class:
            return self.steps[0].structure if self.reserve == BEATEN and not alone else self._behind()
        structures = [structure.id for structure in self.steps[0].screen.structures]
        if alone is None or self.unknown_class not in structures:
            return self.unknown_class
        return self.unknown_class if seen_by(self.unknown_class)["instrument"] in alone else self._behind()

    def hides(self, gained):
        """Whether what is unknown may be what changed the spectrum of the gas, where a cause of that explains
        `gained` of chi-squared: what explains no more than such a cause has not made it."""
        if self.unknown_class is None or not may_be_gas(self.unknown_class):
            return False
        last = self.steps[-1]
        ids = [structure.id for structure in last.screen.structures]
        return self.unknown_class not in ids or 0.5 * gained < float(last.unknown.max()) + MARGIN

    def channels(self):
        """Pattern (C, 1) over the channels of the spectrometer of what is unknown, the most likely one, and
        whether it multiplies light or adds some; None where it is no pattern over wavelength."""
        last, identity = self.steps[-1], self.unknown_class
        ids = [one.id for one in last.screen.structures]
        if identity not in ids or "pattern" not in identity:
            return None
        unknowns, which = Unknowns(last.screen), ids.index(identity)
        score, value, inverse, columns = unknowns.most_likely(last.screen, which)
        if not last.screen.structures[which].single:
            columns = columns @ (score / (value + inverse))[:, None]
        return columns, multiplies(identity)

    @property
    def in_bands(self):
        """Whether what is unknown lies in the pyrometer."""
        return self.unknown_class is not None and in_bands(self.unknown_class)

    def _behind(self):
        """Id of the structure that a cause behind the effects that were found is.

        The most likely one in the data, in the instrument that alone shows something, or where all names
        act, if it is one; where none is beyond chance, the one that the effects would be taken for if they
        were `CLEAR` standard deviations large: of less the likeliest is what says the least. What neither
        instrument shows alone lies in how they go together, wherever names act.
        """
        first, named = self.steps[0], {one.id: one for one in self.final.settings}
        acting = {kind for one in named.values() for kind in one.effect.instruments}
        if self.faulty is not None and len(self.faulty) < 2:
            acting = self.faulty
        places = [seen_by(structure.id)["instrument"] for structure in first.screen.structures]
        elsewhere = [len(acting) == 1 and place not in acting for place in places]
        unknown = np.where(elsewhere, -np.inf, first.unknown)
        if unknown.max() > self.thresholds.unknown or not named:
            return first.likeliest(unknown)
        screen = first.screen
        chosen = [i for i in best_by_id(screen.candidates, first.gains) if screen.candidates[i].id in named]
        numbers = [
            screen.candidates[i].effect.linear_of(named[screen.candidates[i].id].amplitude) for i in chosen
        ]
        score = screen.information[:, chosen] @ numbers
        size = np.sqrt(max(score[chosen] @ numbers, TINY))
        alike = np.where(elsewhere, -np.inf, Unknowns(screen)(CLEAR / size * score))
        return screen.structures[int(np.argmax(alike))].id

    def doubted(self, reason):
        """The same, its names with reserve: a key of `reserve.SENTENCES`; what is doubtful already stays."""
        if self.status not in ("named", "one-of"):
            return self
        return replace(self, status="named+unknown", reserve=reason)

    def beside(self, structure):
        """The same, and something unknown besides."""
        status = "named+unknown" if self.final.settings else "unknown"
        return replace(self, status=status, unknown_class=self.unknown_class or structure, reserve="")

    def with_rest(self, left):
        """The same, and what a final fit leaves (id, or None): to a spectrometer where nothing of its own is
        unknown already, what is unknown of the pyrometer then comes of what it is held against; to a
        pyrometer where nothing is."""
        known = self.unknown_class and (not self.in_bands or in_bands(left or self.unknown_class))
        if left is None or known:
            return self
        return replace(self, unknown_class=None).beside(left)


def select(base, effects, *, thresholds=None, draws=2000, seed=1):
    """Select effects beside a base fit.

    Parameters
    ----------
    base : Base
    effects : mapping id -> Effect, those that are looked for
    thresholds : Thresholds, optional
        Of an alike data set, instead of new ones.
    draws, seed : int
        Simulated nulls behind the thresholds.

    Returns
    -------
    Selection
    """
    progress.step("diagnosis: effects one by one against simulated nulls", draws)
    search, trials = Search(base.model, base.fitter, effects, thresholds), {}
    first = search.look(base.solution)
    if thresholds is None:
        search.thresholds = calibrated(first.screen, draws, seed)
    steps, unknown = walk(search, [first], trials)
    if steps[-1].settings or unknown:
        steps, unknown = by_pair(search, steps, unknown)
        steps, unknown = by_other_window(search, steps, unknown)
    if steps[-1].settings and not unknown and not _likelier(search, first, steps[-1]):
        steps, unknown = [first], left(search, first)
    evidence = search.evidence(steps[-1].solution) - search.evidence(first.solution)
    if outdone(steps[-1].settings, evidence, float(first.unknown.max())) and left(search, first):
        steps, unknown, evidence = [first], left(search, first), 0.0
    if unknown and seen_by(unknown)["axis"] == "signal":
        unknown = _along_time(search, steps[-1], unknown)
    final = steps[-1].solution
    sets = tuple(alike(first, setting.id) for setting in final.settings)
    doubt = "" if unknown else reserve(steps, search.thresholds.third, sets)
    if sets and not unknown and not doubt and float(first.unknown.max()) > evidence + MARGIN:
        doubt = BEATEN
    if not unknown and not doubt and bent(base.model, final, _alone(first, final)):
        doubt = "bent"
    status = _status(final, unknown or doubt, sets)
    return Selection(
        tuple(steps),
        final,
        sets,
        trials,
        status,
        unknown,
        search.thresholds,
        effects,
        doubt,
        evidence,
    )


def shows(base, effects, *, draws=2000, seed=1):
    """Whether a base fit asks for any of some effects, or for a structure."""
    search = Search(base.model, base.fitter, effects)
    step = search.look(base.solution)
    limits = calibrated(step.screen, draws, seed)
    return bool(step.gains.max(initial=0.0) > limits.effect or step.unknown.max() > limits.unknown)


def _likelier(search, first, last):
    """Whether the effects of a round are likelier than nothing: thresholds ask what chance may reach, this
    how probable an effect was before the data."""
    evidence = search.evidence(last.solution) - search.evidence(first.solution)
    return evidence + prior_share(len(search.effects)) > np.log(PRIOR_NONE)


def _alone(first, final):
    """Chi-squared {id: value} that each effect of a fit gains alone, by the tangent."""
    found = {}
    for index in best_by_id(first.screen.candidates, first.gains):
        found[first.screen.candidates[index].id] = float(first.gains[index])
    return {setting.id: found.get(setting.id, 0.0) for setting in final.settings}


def _along_time(search, step, identity):
    """A structure along the signal, or the one along time that explains clearly more where a walk may step at
    every sample: while a signal hardly changes, its levels are as close in time, and such a walk follows
    whatever changes along a signal too."""
    every = max(instrument.time.size for instrument in search.model.instruments)
    seen = screen(search.model, step.solution, {}, steps=min(every, MOST_STEPS))
    value, along = Unknowns(seen)(seen.score), [seen_by(one.id)["axis"] for one in seen.structures]
    in_time, in_signal = (np.where(np.array(along) == axis, value, 0.0) for axis in ("time", "signal"))
    best = seen.structures[int(np.argmax(in_time))].id
    return best if in_time.max() > (1 + FORMULA) * in_signal.max() else identity


def alike(step, identity):
    """Ids that the data do not tell from an effect: nearly the same gain, or nearly the same direction."""
    screen, gains = step.screen, step.gains
    order = best_by_id(screen.candidates, gains)
    mine = next((i for i in order if screen.candidates[i].id == identity), None)
    if mine is None:
        return (identity,)
    angle = angles(screen.information[: screen.count, : screen.count])[mine]
    alike = (angle < SAME_ANGLE) | (gains[mine] - gains < ALIKE) & (angle < ALIKE_ANGLE)
    alike &= screen.left[: screen.count] > LEAST_LEFT
    return (identity, *(screen.candidates[i].id for i in order if i != mine and alike[i]))


def _status(final, unknown, sets):
    if not final.settings:
        return "unknown" if unknown else "null"
    if unknown:
        return "named+unknown"
    return "one-of" if any(len(ids) > 1 for ids in sets) else "named"
