"""Which effects of the gas the measured light asks for, if the simulation errs no more than it states."""

from copy import copy
from dataclasses import dataclass, field, replace
from functools import cache
from types import MappingProxyType

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares
from scipy.special import chdtrc

from plasmapyro.diagnosis.fit.build import GAS_SIGMA
from plasmapyro.diagnosis.fit.setting import (
    FORMULA,
    KIN,
    LARGE,
    SPILL,
    Setting,
    free_numbers,
    log_prior,
    numbers_of,
    with_numbers,
)
from plasmapyro.diagnosis.fit.slit import SLIT, SeenSlit
from plasmapyro.diagnosis.simulation.simulated import Simulated
from plasmapyro.diagnosis.simulation.systems import CLEARER, brightest_line, leaks_of, lines_of, systems_of
from plasmapyro.radiation.path import CONTINUA

HOTTER = "P_eff"  # the effect that is another power by another name
FOREIGN = {"Ar", "Cu"}  # effects that are lines of an atom which the simulated gas has not
ANYWHERE = FOREIGN | {"wshift", SLIT, "second"}  # that act on lines alike, however strong these are
CONTINUUM = "contin"  # the effect that is more light of the systems `CONTINUA`
STEP = 1e-4  # of its amplitude
FAR = 3.0  # standard errors from which the simulated power is wrong
HELD = 1e-3  # [1] standard deviation of ln P where the simulated power is taken as right
LEAST, MOST = (-1.5, -3.0), (1.5, 3.0)  # of the logarithms of power and brightness
MOST_EFFECTS = 2
LEVEL = 0.01  # false alarms, if the errors of the simulation are those that it states
ALIKE = 9.2  # chi-squared by which the data tell two effects apart: 99 % of two degrees of freedom
ANY = 20.0  # times the stated error of a strength: any strength
AT_END = 1e-3  # [1], of the largest amplitude
MOST_WRONG = 3  # systems
MOST_GROUPS = 10  # the brightest, which may be of another strength,
MOST_FREE = 2  # and how many of them or of the systems together may stand for an effect
RARE = 7.4  # of the objective: an effect is one of forty, and before the data less probable than such errors
WRONG = 10.8  # chi-squared that a free strength must gain: 99.9 % of one degree of freedom
SYSTEM = "system"  # stands for one radiating system of another strength
ROUGHNESS = (0.0, 0.02, 0.035, 0.06, 0.1, 0.2)  # [1] of the light of bands from channel to channel
SCATTER = (1.0, 1.5, 2.0, 3.0)  # [1] of A values over what is stated
ROUNDS = 2  # of the fit without effects and the errors about it
ROUNDING = 1e-9  # [1], relative, added to a singular covariance


@dataclass(frozen=True)
class Fit:
    """A fit of the simulated to the measured light: logarithms of `power` and `brightness`, and `settings`.

    `covariance` of power, brightness and the numbers of the settings; `objective`: chi-squared with priors,
    and the logarithm of the determinant of the covariance of the data.
    """

    power: float
    brightness: float
    settings: tuple
    objective: float
    covariance: np.ndarray


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
    final, rivals = _names(fitter, base, alone, effects, wanted, holds)
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
    """The fit with the effects that a gas asks for, one after the other, and the rivals of each.

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
        used = {setting.id for setting in final.settings}
        tried = {i: fitter.best(final, effect) for i, effect in effects.items() if i not in used}
    return final, rivals


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
    simulated.roughness, objective = _likeliest(simulated, "roughness", ROUGHNESS, wrong)
    simulated.roughness = _beside(simulated, effects, wrong)[0]
    fitter, bare = settled(simulated, (), wrong)
    base = replace(bare, objective=objective)
    threshold = fitter.threshold(base, draws, seed)
    alone = {identity: fitter.best(base, effect) for identity, effect in effects.items()}

    def holds(before, fit):
        before, newest = before if before.settings else bare, fit.settings[-1].id
        seen = newest in ANYWHERE and base.objective - alone[newest].objective > threshold
        return seen and _may_be(fitter, before, fit)

    final, rivals = _names(fitter, base, alone, effects, threshold, holds)
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


def log_bayes(fit, base):
    """Log Bayes factor of a fit over the one without effects, by Laplace's approximation."""
    volume = [np.linalg.slogdet(one.covariance)[1] for one in (fit, base)]
    prior = log_prior(free_numbers(fit.settings), numbers_of(fit.settings), LARGE)
    return float(0.5 * (base.objective - fit.objective + volume[0] - volume[1]) + prior)


def settled(simulated, settings=(), wrong=()):
    """Fitter whose errors of the simulation are relative to the light that it fits, and the fit.

    Relative to the measured light, errors would be small where this one is, and fits would err downwards.
    `settings`: effects that are switched on; `wrong`: radiating systems that may have any strength.

    Source: S. Chiba & D. L. Smith, report ANL/NDM-121 (1991), on Peelle's pertinent puzzle.
    """
    fitter, fit = Fitter(simulated, simulated.measured.simulated, wrong), None
    for _ in range(ROUNDS):
        fit = fitter.fit(settings, fit)  # from the last one: far from it there are other minima
        fitter = Fitter(simulated, fitter.light(fit), wrong)
    return fitter, fitter.fit(settings, fit)


def raise_errors(simulated, effects):
    """Give the errors of the simulation that it states too small the size that makes the data most probable.

    Lines of bands stand as close as pixels do: constants of a molecule that err in the fifth digit, or a
    branch without strength, move light from channel to channel without any change of a band (`ROUGHNESS`).
    Classes of A values promise what compilations of other authors do not always keep (`SCATTER`), unless one
    of some `effects` explains as much. Lines of a foreign atom, left out, pass for rough bands: these are as
    rough as they are beside the best of the effects.

    Returns
    -------
    Simulated
        As rough as it is without effects, which fits without any are held to; the same one if as rough.
    """
    simulated.roughness = _likeliest(simulated, "roughness", ROUGHNESS)[0]
    base = settled(simulated)[1]
    rough, best = _beside(simulated, effects)
    scatter, objective = _likeliest(simulated, "scatter", SCATTER)
    if base.objective - objective > ALIKE and best > objective - CLEARER - RARE:
        simulated.scatter = scatter
        rough, best = _beside(simulated, effects)
    if rough == simulated.roughness:
        return simulated
    plain, simulated.roughness = copy(simulated), rough
    return plain


def _beside(simulated, effects, wrong=()):
    """The roughness of bands beside the best of some effects, no more than without, and the objective; what
    lines say of the slit counts as in the fit without effects: it is nothing that bands show."""
    fitter, base = settled(simulated, (), wrong)
    fits = [base, *(fitter.best(base, effect) for effect in effects.values())]
    alone = min(fits, key=fitter.by_light)
    unseen = fitter.of_slit(()) - fitter.of_slit(alone.settings)
    if fitter.by_light(base) - fitter.by_light(alone) < ALIKE:
        return simulated.roughness, alone.objective + unseen
    sizes = [size for size in ROUGHNESS if size <= simulated.roughness]
    rough, objective = _likeliest(simulated, "roughness", sizes, wrong, alone.settings)
    return rough, objective + unseen


def _likeliest(simulated, name, sizes, wrong=(), settings=()):
    """The size of an error by which the measured light is most probable, and the objective there, systems
    that are `wrong` of any strength; the error is left as it was."""
    before, found = getattr(simulated, name), {}
    for size in sizes:
        setattr(simulated, name, size)
        found[size] = settled(simulated, settings, wrong)[1].objective
    setattr(simulated, name, before)
    best = min(found, key=found.get)
    return best, found[best]


def least_likely(simulated, settings, wrong, kept=()):
    """The best of the fits in which one more radiating system may have any strength, with its fitter."""
    return min(_freed(simulated, settings, wrong, kept), key=lambda one: one[1].objective)


def spectroscopy(simulated, kept=()):
    """The objective of the best fit without effects in which up to `MOST_FREE` systems or groups of lines may
    have any strength, each the best beside those before it; those `kept` have what is stated."""
    wrong, best = (), np.inf
    for _ in range(MOST_FREE):
        fits = _freed(simulated, (), wrong, kept, groups=True)
        fitter, fit = min(fits, key=lambda one: one[1].objective)
        wrong, best = fitter.wrong, min(best, fit.objective)
    return best


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


def _freed(simulated, settings, wrong, kept=(), groups=False):
    """Fitters and fits in which one more radiating system, or with `groups` one of the brightest groups of
    lines, may have any strength; those `kept` have what is stated."""
    names = list(dict.fromkeys(simulated.systems))
    if groups:
        order = np.argsort(-simulated.group.sum(axis=1))[:MOST_GROUPS]
        names += [simulated.model.library.group_name[place] for place in order]
    names = [one for one in dict.fromkeys(names) if one not in (*wrong, *kept)]
    return [settled(simulated, settings, (*wrong, one)) for one in names]


def without_wrong(simulated, fitter, fit):
    """The fitter and fit in which systems whose strength is beyond what is stated may have any."""
    while len(fitter.wrong) < MOST_WRONG:
        tried = least_likely(simulated, fit.settings, fitter.wrong)
        if not fit.objective - tried[1].objective > WRONG:
            break
        fitter, fit = tried
    return fitter, fit


class Fitter:
    """Fits of power, brightness and effects to the measured gas.

    Errors of the simulation are relative to some light (C,); systems that are `wrong` may have any strength.
    """

    def __init__(self, simulated, light, wrong=()):
        self.simulated, self.measured, self.wrong = simulated, simulated.measured, tuple(wrong)
        self.scale, self.sigma = light, np.array([simulated.power[1], GAS_SIGMA])
        self.centre = np.array([simulated.power[0], 0.0])
        wide, groups = np.ones((len(simulated.systems), 1)), []
        for name in wrong:
            if name in simulated.systems:
                wide[simulated.systems.index(name)] = ANY  # the first mode of a system is all of it
            else:
                groups.append(simulated.model.library.group_name.index(name))
        self.root = self.root_of(
            simulated.strength * wide, simulated.shape, simulated.group[groups], seen=light
        )

    def root_of(self, *modes, seen=None):
        """Cholesky factor (C, C) of the covariance of the data and of the errors that modes (M, C) state.

        The data err relative to themselves, or to the light `seen` (C,).
        """
        total = self.measured.covariance if seen is None else self.measured.covariance_about(seen)
        total = total + self.simulated.covariance(np.concatenate(modes), self.scale)
        total[np.diag_indices_from(total)] *= 1 + ROUNDING
        return cholesky(total, lower=True)

    def p_value(self, fit):
        """Probability [1] of a chi-squared as large, all errors of simulation and measurement considered."""
        rest = self.white(self.measured.value - self.light(fit))[0]
        return float(chdtrc(rest.size, rest @ rest))

    def spread(self, fit):
        """The Birge ratio [1] of a fit, squared: its chi-squared per number where that is above 1.

        Source: R. T. Birge, Phys. Rev. 40, 207 (1932).
        """
        rest = self.white(self.measured.value - self.light(fit))[0]
        return max(float(rest @ rest) / max(rest.size - len(fit.covariance), 1), 1.0)

    def light(self, fit):
        """Light (C,) of a fit, over the level."""
        return self.simulated.light(fit.power, fit.brightness, fit.settings)

    def white(self, rows, root=None):
        """Rows (m, C) whitened."""
        return solve_triangular(self.root if root is None else root, np.atleast_2d(rows).T, lower=True).T

    def fit(self, settings, start=None):
        """Fit with effects, from their numbers."""
        free = free_numbers(settings)
        first = (0.0, 0.0) if start is None else (start.power, start.brightness)
        low = np.array([*LEAST, *(number.low for number in free)])
        high = np.array([*MOST, *(number.high for number in free)])
        scale = np.array([*self.sigma, *(number.sigma for number in free)])
        centre = np.array([*self.centre, *(number.centre for number in free)])

        def residual(x):
            light = self.simulated.light(x[0], x[1], with_numbers(settings, x[2:]))
            rest = [self.white(self.measured.value - light)[0], (x - centre) / scale]
            return np.concatenate([*rest, self._off_slit(with_numbers(settings, x[2:]))])

        begin = np.clip(np.append(first, numbers_of(settings)), low, high)
        found = least_squares(residual, begin, bounds=(low, high), x_scale=0.1 * scale, diff_step=1e-4)
        covariance = np.linalg.pinv(found.jac.T @ found.jac)
        power, brightness = (float(x) for x in found.x[:2])
        objective = float(2 * found.cost + 2 * np.sum(np.log(np.diag(self.root))))
        return Fit(power, brightness, with_numbers(settings, found.x[2:]), objective, covariance)

    def _off_slit(self, settings):
        """Standard errors by which settings miss the width that lines show: one number or none."""
        seen = self.measured.slit
        return np.array([] if seen is None else [seen.misfit(settings)])

    def of_slit(self, settings):
        """Chi-squared that the width of the slit alone adds to a fit with settings."""
        return float(np.sum(self._off_slit(settings) ** 2))

    def by_light(self, fit):
        """The objective of a fit without `of_slit`."""
        return fit.objective - self.of_slit(fit.settings)

    def best(self, beside, effect):
        """The best fit with one more effect, of all its shapes and either sign: from the fit beside it, and
        of twice the amplitude from the simulated power: that fit may have taken it for power."""
        size = min(effect.sigma, max(effect.bounds) / 2)
        signs = (1.0,) if effect.bounds[0] >= 0 else (1.0, -1.0)
        fits = [
            self.fit((*beside.settings, Setting(effect, sign * times * size, dict(shape))), start)
            for shape in effect.shapes
            for sign in signs
            for times, start in ((1, beside), (2, None))
        ]
        return min(fits, key=lambda fit: fit.objective)

    def threshold(self, fit, draws, seed):
        """Chi-squared that the best effect gains in a share `LEVEL` of spectra in which nothing is wrong."""
        light, step = self.light(fit), 1e-3
        moved = (fit.power + step, fit.brightness), (fit.power, fit.brightness + step)
        base = self.white([(self.simulated.light(*place, fit.settings) - light) / step for place in moved])
        more = self.white(
            [
                self.simulated.light(
                    fit.power, fit.brightness, (*fit.settings, Setting(effect, effect.step, dict(shape)))
                )
                - light
                for effect in self.simulated.effects.values()
                for shape in effect.shapes
            ]
        )
        more /= np.maximum(np.linalg.norm(more, axis=1, keepdims=True), 1e-300)
        inverse = np.linalg.inv(base @ base.T + np.diag(self.sigma**-2.0))
        cross = more @ base.T
        left = 1 - np.einsum("ij,jk,ik->i", cross, inverse, cross)
        generator = np.random.default_rng(seed)
        drawn = generator.standard_normal((draws, base.shape[1]))
        drawn += (generator.standard_normal((draws, 2)) * self.sigma) @ base  # what the priors allow
        score = drawn @ more.T - (drawn @ base.T) @ inverse @ cross.T
        gains = np.where(left > 1e-6, score**2 / np.maximum(left, 1e-6), 0.0)
        return float(np.quantile(gains.max(axis=1), 1 - LEVEL))
