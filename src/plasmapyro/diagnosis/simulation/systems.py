"""Measured over simulated light: by radiating system and multiplet, and lines that nobody simulated."""

from dataclasses import dataclass, replace

import numpy as np

from plasmapyro.diagnosis.fit.observation import line_shapes
from plasmapyro.diagnosis.fit.setting import Setting
from plasmapyro.radiation.uncertainty import LEAST_STRENGTH

FREE = 2.0  # [1] prior of the relative change of a group where the data alone are to speak
ROUNDS = 4  # of the ratios and the light that errors are relative to
FAINTEST, BRIGHTEST = 0.1, 10.0  # [1], of a system over what is expected, for its errors to follow it
TINY = 1e-300
LEAST = 1e-3  # [1] of the simulated light: what a fit leaves of a group, for its logarithm
BEYOND = 3.0  # standard deviations from which a system is off
UNSEEN = 0.5  # [1] error of a ratio beyond which a group counts as not measured
NEAR = 3.0  # slits
BRIGHT = 0.3  # [1] of the mean light
OF_NAMED = 0.3  # [1] of a line: a named effect that is as bright there may leave it, by its formula
CLEARER = 6.0  # of the objective, by which all lines of an atom must beat one: log odds of 3
LITTLE = 1e-4  # of an effect
OF_ATOMS = ("N I", "O I", "faint lines of N I", "faint lines of O I")
MIDDLE = (0.05, 0.95)  # shares of the light of a group between which it is said to lie


@dataclass(frozen=True)
class System:
    """One radiating system or multiplet.

    `ratio` measured over simulated light at the simulated power, `error` its standard deviation as the data
    know it, `stated` the relative one of the simulation; `by_power`: the ratio that the best power and
    brightness would make; `wavelength` (first, last) [m] between which most of its light lies; `beyond`
    whether what remains is more than three standard deviations of both.
    """

    name: str
    wavelength: tuple
    ratio: float
    error: float
    stated: float
    by_power: float
    beyond: bool


@dataclass(frozen=True)
class Line:
    """Light at one wavelength [m] that the simulation lacks, or has too much of: over its mean light [1].

    `strange`: where neither the simulation nor what is named has light that could err by it.
    """

    wavelength: float
    strength: float
    error: float
    strange: bool = False


def systems_of(fitter, fit):
    """Each `System` of the light of a condition, those that are too faint to be measured left out.

    They are held against power and brightness of the fit, those free whose strength is beyond what is stated.
    """
    simulated, library = fitter.simulated, fitter.simulated.model.library
    ratio, by_power, error = _shares(fitter, fit)
    by_power = np.maximum(by_power, LEAST)
    for place, name in enumerate(library.group_name):
        if not 0 < error[place] < UNSEEN:  # 0 of a group without light
            continue
        light = library.group[place]
        first, last = library.wavelength[np.searchsorted(np.cumsum(light) / light.sum(), MIDDLE)]
        stated = _stated(simulated, name, simulated.group[place])
        yield System(
            name,
            (float(first), float(last)),
            float(ratio[place]),
            float(error[place]),
            stated,
            float(by_power[place]),
            _beyond(ratio[place], error[place], by_power[place], stated)
            or any(name.startswith(one) for one in fitter.wrong),
        )


def _beyond(ratio, error, expected, stated):
    """Whether a ratio is more than `BEYOND` standard deviations from what is expected: its own error is
    normal, that of the simulation of its logarithm, for no light is below zero."""
    edge = expected * abs(np.expm1(np.copysign(BEYOND * stated, ratio - expected)))
    return bool(abs(ratio - expected) > np.hypot(BEYOND * error, edge))


def _shares(fitter, fit):
    """Measured over simulated light of groups, that of a fit over it, and the error of the first (G,).

    Both lights are shared among the groups by the same weights. Errors of data and shapes are relative to the
    light that is found; what the shapes leave beyond their errors makes ratios less certain (R. T. Birge,
    Phys. Rev. 40, 207 (1932)).
    """
    simulated, groups, factors = fitter.simulated, fitter.simulated.group, {}
    whole, systems = groups.sum(axis=0), set(simulated.shape_systems) - {""}
    seen = fitter.light(fit)
    least, lights = FAINTEST * seen, np.stack([fitter.measured.value, seen]) - whole
    for _ in range(ROUNDS):
        root = fitter.root_of(simulated.stronger(factors), seen=seen)
        white, rest = fitter.white(groups, root), fitter.white(lights, root)
        covariance = np.linalg.inv(white @ white.T + FREE**-2.0 * np.eye(len(white)))
        change = covariance @ (white @ rest.T)
        seen = np.maximum(whole + change[:, 0] @ groups, least)
        for name in systems:
            own = simulated.groups_of(name)
            if own.any():
                weights = groups[own].sum(axis=1) + TINY
                found, by_power = np.average(1 + change[own], axis=0, weights=weights)
                factors[name] = float(np.clip(found / max(by_power, LEAST), FAINTEST, BRIGHTEST))
    left = rest[0] - change[:, 0] @ white
    spread = max(float(left @ left) / max(left.size - len(groups), 1), 1.0)
    return *(1 + change.T), np.sqrt(spread * np.diag(covariance))


def _stated(simulated, name, light):
    """Relative error that the simulation states of the light (C,) of a group: of its own system alone."""
    own = [f"{system} " in f"{name} " for system in simulated.systems]
    weight = light / max(float(light @ light), 1e-300)
    return float(np.linalg.norm(simulated.strength[own] @ weight)) or LEAST_STRENGTH


def lines_of(fitter, fit, threshold):
    """Each `Line` that a fit leaves, beyond what chance reaches somewhere in the spectrum."""
    library, spread = fitter.simulated.model.library, fitter.spread(fit)
    shines = _named_light(fitter, fit)
    for centres, strength, information in _single_lines(fitter, fit):
        gain = strength**2 * information
        limit = spread * (threshold + 2 * np.log(centres.size))
        for place in np.flatnonzero(gain > limit):
            if gain[place] == gain[max(place - 3, 0) : place + 4].max():
                known = _beside_lines(library, centres[place])
                known |= shines(centres[place]) > OF_NAMED * strength[place]
                strange = strength[place] > 0 and not known
                error = float(np.sqrt(spread / information[place]))
                yield Line(float(centres[place]), float(strength[place]), error, bool(strange))


def leaks_of(fitter, fit, threshold, leaks):
    """The brightest `Line` of each of some effects, lines of gases in the jet, that together stand out beside
    a fit, beyond chance and clearly beyond what one line does, wherever it shines."""
    measured, spread, plain = fitter.measured, fitter.spread(fit), fitter.light(fit)
    if fitter.simulated.model.instruments[-1].weight is not None:
        return
    fine = np.where(measured.instrument == measured.instrument[-1], measured.level, 0.0)
    mean, shines = np.mean((measured.simulated * fine)[fine > 0]), _named_light(fitter, fit)
    rest = fitter.white(measured.value - plain)[0]
    least = max(spread * (threshold + 2 * np.log(max(len(leaks), 1))), brightest_line(fitter, fit) + CLEARER)
    for effect in leaks:
        more = replace(fit, settings=(*fit.settings, Setting(effect, LITTLE, {})))
        row = (fitter.light(more) - plain) / LITTLE
        white, place = fitter.white(row)[0], int(np.argmax(row * fine))
        information, brightest = float(white @ white), float(row[place] * fine[place] / mean)
        if white @ rest > np.sqrt(least * information) > 0:
            strength = brightest * float(white @ rest) / information
            strange = shines(measured.wavelength[place]) <= OF_NAMED * strength
            error = brightest * float(np.sqrt(spread / information))
            yield Line(float(measured.wavelength[place]), strength, error, bool(strange))


def brightest_line(fitter, fit):
    """Chi-squared that one line more, wherever it shines, gains beside a fit."""
    gains = [
        np.max(np.maximum(strength, 0) ** 2 * information)
        for _, strength, information in _single_lines(fitter, fit)
    ]
    return max(gains, default=0.0)


def _single_lines(fitter, fit):
    """Wavelengths (k,) [m] of lines within each spectrometer, their strengths (k,) over the mean light, each
    the only one beside a fit, and the inverse variances (k,) of these."""
    model, measured = fitter.simulated.model, fitter.measured
    rest = fitter.white(measured.value - fitter.light(fit))[0]
    for which, one in enumerate(model.instruments):
        if one.weight is not None:
            continue
        inside = measured.instrument == which
        level = measured.level[inside]
        mean = float(np.mean(measured.simulated[inside] * level))
        shapes, centres = line_shapes(one.wavelength, model.library.slit_fwhm)
        rows = np.zeros((centres.size, measured.value.size))
        rows[:, inside] = shapes.T * mean / level
        white = fitter.white(rows)
        information = np.sum(white**2, axis=1)
        yield centres, white @ rest / information, information


def _named_light(fitter, fit):
    """Function of a wavelength [m]: the most light there, over the mean, of effects that are named."""
    measured, slit = fitter.measured, fitter.simulated.model.library.slit_fwhm
    fine = measured.instrument == measured.instrument[-1]
    own = np.abs(fitter.light(fit) - fitter.light(replace(fit, settings=()))) + measured.named
    light = (own * measured.level)[fine] / np.mean((measured.simulated * measured.level)[fine])

    def there(wavelength):
        near = np.abs(measured.wavelength[fine] - wavelength) < NEAR * slit
        return light[near].max(initial=0.0)

    return there


def _beside_lines(library, wavelength):
    """Whether bright simulated lines of atoms lie within `NEAR` slits of a wavelength [m]."""
    near = np.abs(library.wavelength - wavelength) < NEAR * library.slit_fwhm
    atomic = np.array([name.startswith(OF_ATOMS) for name in library.group_name])
    return bool(library.group[atomic][:, near].max(initial=0.0) > BRIGHT * library.base.mean())
