"""Which effects of the gas the measured light asks for, if the simulation errs no more than it states."""

from dataclasses import dataclass, field, replace
from functools import cache
from types import MappingProxyType

import numpy as np

from plasmapyro.diagnosis.fit.build import GAS_SIGMA
from plasmapyro.diagnosis.fit.setting import FORMULA, KIN, SPILL, free_numbers
from plasmapyro.diagnosis.fit.slit import SLIT, SeenSlit
from plasmapyro.diagnosis.simulation.errors import (
    ALIKE,
    RARE,
    ROUGHNESS,
    least_likely,
    likeliest,
    raise_errors,
    roughness_beside,
    spectroscopy,
    without_wrong,
)
from plasmapyro.diagnosis.simulation.fitter import Fit, log_bayes, settled
from plasmapyro.diagnosis.simulation.simulated import MOVING, SCALE, Simulated
from plasmapyro.diagnosis.simulation.systems import CLEARER, brightest_line, leaks_of, lines_of, systems_of
from plasmapyro.radiation.path import CONTINUA

HOTTER = "P_eff"  # the effect that is another power by another name
FOREIGN = {"Ar", "Cu"}  # effects that are lines of an atom which the simulated gas has not
ANYWHERE = FOREIGN | {SCALE, SLIT, "second"}  # that act on lines alike, however strong these are
CONTINUUM = "contin"  # the effect that is more light of the systems `CONTINUA`
REFITS = 5  # of a scale or slit and the errors that it moves, each half as far as the one before
STEP = 1e-4  # of its amplitude
FAR = 3.0  # standard errors from which the simulated power is wrong
HELD = 1e-3  # [1] standard deviation of ln P where the simulated power is taken as right
MOST_EFFECTS = 2
AT_END = 1e-3  # [1], of the largest amplitude
SYSTEM = "system"  # stands for one radiating system of another strength


@dataclass(frozen=True)
class Comparison:
    """What the measured gas says about the simulation.

    `base` and `final` fits without and with `final.settings`, the covariance of the latter by its Birge ratio
    larger; `systems` and `lines` that differ; `rivals`
    {id of a named effect: ids that explain as much}; `gains` {id: chi-squared gained alone}; `threshold` of
    it; `p_value` of the base fit, all errors of simulation and measurement considered; `evidence`
    {id: log Bayes factor over the base fit}, that of `SYSTEM` if one system may have any strength.
    """

    base: Fit
    final: Fit
    systems: tuple
    lines: tuple
    gains: dict
    threshold: float
    p_value: float
    ratio: np.ndarray  # (K,) measured over simulated light on the axis of the library
    rivals: dict = field(default_factory=dict)
    evidence: dict = field(default_factory=dict)
    power: tuple = (0.0, np.inf)  # logarithm of it over the simulated one, error; a hotter gas counted in
    rivals_of_power: tuple = ()  # ids of effects that at the simulated power explain as much as another one
    silence: str = ""  # a sentence: why no cause in the gas is looked for
    slit: SeenSlit | None = None  # what lines of atoms say of it

    @property
    def gained(self):
        """Chi-squared that the first effect that is named gains alone, 0 without one."""
        return max((self.gains[one.id] for one in self.final.settings[:1]), default=0.0)

    @property
    def power_is_wrong(self):
        """Whether the simulated power is more than `FAR` standard errors off."""
        change, error = self.power
        return abs(change) > FAR * error

    @property
    def unlike(self):
        """Whether the gas is more than `FAR` prior standard deviations brighter or fainter than simulated,
        the power and what is named apart."""
        return abs(self.final.brightness) > FAR * GAS_SIGMA

    def without_names(self, why=""):
        """The same, no effect named: where something unknown may lie behind what the gas looks like."""
        return replace(self, final=self.base, rivals={}, silence=why)


def compare(
    model,
    measured,
    effects,
    *,
    beside=MappingProxyType({}),
    away=(0.0, 0.0),
    leaks=(),
    sure=(),
    draws=1000,
    seed=1,
):
    """Hold the measured gas against the simulated one.

    .. math:: y \\sim N\\left(L(P, b, a),\\; S + E\\right)

    with the measured light y and its covariance S, the simulated light L at the power P, brightness b and
    amplitudes a of effects, and the covariance E of the error that the simulation states of itself.

    Parameters
    ----------
    model : Model
    measured : MeasuredGas
    effects : mapping id -> Effect
        That change the light of the gas, alike at all times.
    beside : mapping id -> Effect
        More that are asked only whether they look like a wrong power.
    away : mean and standard deviation
        Of ln P of the gas over the simulated one at the power that was simulated.
    leaks : effects, lines of a gas each, that are asked only whether they are there
    sure : ids of effects, lines of an atom each, that the places of their lines have told already
    draws, seed : int
        Simulated spectra behind the threshold.

    Returns
    -------
    Comparison
    """
    simulated = Simulated(model, measured, effects, away)
    plain = raise_errors(simulated, effects)
    fitter, bare = settled(simulated)
    without, base = (fitter, bare) if plain is simulated else settled(plain)
    threshold = fitter.threshold(base, draws, seed)
    alone = {identity: fitter.best(base, effect) for identity, effect in effects.items()}
    same = CONTINUA if CONTINUUM in effects else ()  # the effect itself, by another name
    free = cache(lambda: min(spectroscopy(one, same) for one in {simulated, plain}))

    def holds(before, fit):
        before, seen = before if before.settings else bare, fit.objective
        if fit.settings[-1].id != SLIT:  # what lines say of the slit is no reason for another cause
            seen = fitter.by_light(fit) + fitter.of_slit(())
        return seen <= free() - CLEARER and _may_be(fitter, before, fit, sure)

    wanted = threshold if simulated.scatter == 1.0 else threshold + RARE
    fitter, final, rivals = _names(fitter, base, alone, effects, wanted, holds)
    if not final.settings:
        simulated, fitter = plain, without
    lines = (*lines_of(fitter, final, threshold), *leaks_of(fitter, final, threshold, leaks))
    told = replace(final, covariance=fitter.spread(final) * final.covariance)
    evidence = {identity: log_bayes(fit, base) for identity, fit in alone.items()}
    evidence |= {one.id: log_bayes(final, base) for one in final.settings[:1]}
    system = least_likely(simulated, (), (), same)[1]
    # Systems beyond what is stated must not bend the power that the others are held against.
    held, freed = without_wrong(simulated, fitter, final)
    found = Comparison(
        base=base,
        final=told if final.settings else base,
        systems=tuple(systems_of(held, freed)),
        lines=lines,
        gains={identity: base.objective - fit.objective for identity, fit in alone.items()},
        threshold=threshold,
        p_value=without.p_value(base),
        ratio=measured.ratio_on(model.library.wavelength),
        rivals=rivals,
        power=_power(told, model.library, away),
        evidence=evidence | {SYSTEM: log_bayes(system, base)},
        slit=measured.slit,
    )
    if not found.power_is_wrong:
        return found
    fitter.centre, fitter.sigma = np.array([away[0], 0.0]), np.array([HELD, GAS_SIGMA])
    asked, right = {**effects, **beside}, replace(base, power=away[0])
    held = {identity: fitter.best(right, effect) for identity, effect in asked.items()}
    least = fitter.by_light(base) + ALIKE
    alike = tuple(i for i, fit in held.items() if fitter.by_light(fit) < least and i not in rivals)
    return replace(found, rivals_of_power=alike)


def _names(fitter, base, alone, effects, wanted, holds):
    """The fit with the effects that a gas asks for, one after the other, its fitter, and rivals of each.

    `alone` {id: fit with one effect}; `wanted`: chi-squared that one must bring; `holds` (fit before, fit):
    whether the newest effect of a fit may be named.
    """
    final, tried, rivals = base, alone, {}
    while tried and len(final.settings) < MOST_EFFECTS:
        best = min(tried, key=lambda identity: tried[identity].objective)
        price = wanted * fitter.spread(tried[best]) + _of_formulas(fitter, base, final, tried[best])
        if not final.objective - tried[best].objective > price or not holds(final, tried[best]):
            break
        least = tried[best].objective
        near = least + ALIKE + FORMULA * (base.objective - least)
        rivals[best] = tuple(i for i, fit in tried.items() if i != best and fit.objective < near)
        final = tried[best]
        for _ in range(REFITS if best in MOVING else 0):
            fitter = fitter.about(final)
            final = fitter.fit(final.settings, final)
        used = {setting.id for setting in final.settings}
        tried = {i: fitter.best(final, effect) for i, effect in effects.items() if i not in used}
    return fitter, final, rivals


def _of_formulas(fitter, base, final, further):
    """Chi-squared that inexact formulas of the effects of a fit, `final`, may leave to one more."""
    explained = fitter.by_light(base) - fitter.by_light(final)
    if not final.settings:
        return 0.0
    lights = fitter.white([fitter.light(one) for one in (base, final, further)])
    first, more = np.diff(lights, axis=0)
    cosine = abs(first @ more) / max(np.linalg.norm(first) * np.linalg.norm(more), 1e-300)
    return (FORMULA if cosine > KIN else SPILL) * max(explained, 0.0)


def _may_be(fitter, before, fit, sure=()):
    """Whether the simulated gas could have the newest amplitude of a fit, and an atom has all its lines;
    that those of `sure` are there is known, but not how strong each is."""
    atom = fit.settings[-1].id in FOREIGN.difference(sure)
    return admissible(fit, fitter.simulated.model.library) and (not atom or all_lines(fitter, before, fit))


def anywhere(model, measured, effects, found, why, *, draws=1000, seed=1):
    """A `Comparison` `found` with a gas of another pressure, with the names that such a gas may have.

    Every radiating system and group of lines may have any strength. Where lines stand, how wide a slit shows
    them and what is none of the gas stay: effects `ANYWHERE` are named where no other one explains
    more, and none that shows only beside another, whose formula errs. `why`: a sentence on the rest; further
    parameters as of `compare`.
    """
    simulated = Simulated(model, measured, effects)
    wrong = tuple(dict.fromkeys((*simulated.systems, *model.library.group_name)))
    simulated.roughness, objective = likeliest(simulated, "roughness", ROUGHNESS, wrong)
    simulated.roughness = roughness_beside(simulated, effects, wrong)[0]
    fitter, bare = settled(simulated, (), wrong)
    base = replace(bare, objective=objective)
    threshold = fitter.threshold(base, draws, seed)
    alone = {identity: fitter.best(base, effect) for identity, effect in effects.items()}

    def holds(before, fit):
        before, newest = before if before.settings else bare, fit.settings[-1].id
        seen = newest in ANYWHERE and base.objective - alone[newest].objective > threshold
        return seen and _may_be(fitter, before, fit)

    fitter, final, rivals = _names(fitter, base, alone, effects, threshold, holds)
    told = replace(final, covariance=fitter.spread(final) * final.covariance)
    return replace(
        found,
        final=told if rivals else found.base,
        gains={identity: base.objective - fit.objective for identity, fit in alone.items()},
        threshold=threshold,
        rivals=rivals,
        evidence={identity: log_bayes(fit, base) for identity, fit in alone.items() if identity in ANYWHERE},
        silence=why,
        power=model.power,
        rivals_of_power=(),
    )


def nothing_to_compare(model):
    """The `Comparison` of a test without a gas."""
    nothing = Fit(0.0, 0.0, (), 0.0, np.zeros((2, 2)))
    ratio = np.ones(model.library.wavelength.size)
    return Comparison(nothing, nothing, (), (), {}, 0.0, 1.0, ratio, power=model.power)


def _power(fit, library, away):
    """Logarithm of the power of a fit over the simulated one, and its error: a hotter gas counted in, and how
    far `away` the gas is expected."""
    change, slope = fit.power, np.zeros(len(fit.covariance))
    slope[0] = 1.0
    for place, number in enumerate(free_numbers(fit.settings)):
        if fit.settings[number.place].id == HOTTER:
            here, beside = library.power_of_warmth(fit.settings[number.place].amplitude + np.array([0, STEP]))
            change, slope[2 + place] = change + here, (beside - here) / STEP
    error = np.sqrt(max(slope @ fit.covariance @ slope, 0.0))
    return float(change - away[0]), float(np.hypot(error, away[1]))


def all_lines(fitter, before, fit):
    """Whether the newest effect of a fit, the lines of an atom, explains clearly more than one line does,
    wherever it shines: another atom may have one of them, and not the others."""
    return before.objective - fit.objective > brightest_line(fitter, before) + CLEARER


def admissible(fit, library):
    """Whether the gas that is simulated could have the newest amplitude of a fit: within what the simulation
    itself allows, and not at the end of the range, where something else wants more."""
    one = fit.settings[-1]
    low, high = library.admitted(one.id)
    number = free_numbers((one,))[0]
    return bool(low <= one.amplitude <= high) and not number.exhausted(one.amplitude, AT_END)
